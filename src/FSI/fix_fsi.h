/* -*- c++ -*- ----------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   Copyright (2003) Sandia Corporation.  Under the terms of Contract
   DE-AC04-94AL85000 with Sandia Corporation, the U.S. Government retains
   certain rights in this software.  This software is distributed under
   the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifdef FIX_CLASS
// clang-format off
FixStyle(fsi,FixFSI);
// clang-format on
#else

#ifndef LMP_FIX_FSI_H
#define LMP_FIX_FSI_H

#include "atom.h"
#include "fsi_fields.h"
#include "fsi_keywords.h"
#include "fsi_material.h"
#include "fsi_profile.h"
#include "fsi_walls.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace LAMMPS_NS {
namespace FSI {
  class Check;
}

// The centre of the package: holds the discretisation (spacing, kernel), integrates in time (position Verlet) and
// brings density and stress of every particle to the middle of the step before forces are computed.

class FixFSI : public FSI::FixFields {
 public:
  enum Density { CONTINUITY, SUMMATION, RATIO };

  FixFSI(class LAMMPS *, int, char **);
  ~FixFSI() override;
  // the fix fsi of this LAMMPS; an error that names who needs it if there is none
  static FixFSI *find(class LAMMPS *, const std::string &who);
  // the same, for who needs what the setup of a run finds: an error if there was none since atoms were made or deleted
  static FixFSI *ready(class LAMMPS *, const std::string &who);
  // once, before the first run after a restart file was read: what the file keeps for fixes that go by another ID now
  void check_restart_ids();
  int setmask() override;
  void init() override;
  void setup(int) override;
  void setup_pre_force(int) override;
  void initial_integrate(int) override;
  void pre_exchange() override;
  void pre_force(int) override;
  void final_integrate() override;
  int pack_forward_comm(int, int *, double *, int, int *) override;
  void unpack_forward_comm(int, int, double *) override;
  int pack_reverse_comm(int, int, double *) override;
  void unpack_reverse_comm(int, int *, double *) override;
  void set_arrays(int) override;
  void write_restart(FILE *) override;
  void restart(char *) override;

  // the rows of a per-atom array, which LAMMPS allocates in one piece, without the way through its pointers to them
  typedef double Row[3];
  static Row *rows(double **a) { return reinterpret_cast<Row *>(a[0]); }

  // discretisation
  int dim;
  int kernel;          // FSI::KernelKind
  double dx, h;        // spacing of the initial lattice, smoothing length
  double cut;          // support radius of the kernel
  double psi_bulk;     // number density inside the lattice: the volume of a particle is 1/psi_bulk
  double wdx, w0;      // W(dx), W(0)
  int density_fluid, density_solid;    // Density
  FSI::Keywords keywords;

  // state per atom type; pair styles enter theirs in init_style()
  std::vector<FSI::State> state;
  void enter_state(int type, const FSI::State &);

  // per atom, local and ghost; valid from pre_force on
  double *psi;      // number density, if any mode or rule needs it
  double *rate;     // density rate of fluids (continuity), local after the reverse communication
  double **shift;   // fluids, pair_style fsi/fluid shift: its sums; afterwards the displacement at the end of the step
  double **grad;    // solids: the sums of pair_style fsi/solid's velocity_gradient(); afterwards L and coefficients (fsi_gradient.h)
  int *wmask;       // bits of the mirror walls that an atom is near

  // energy ledger (compute fsi/energy): what each term took from the particles' energy since the fix was defined, this
  // rank's part; kept only while such a compute exists
  enum Term { ARTIFICIAL, LAMINAR, DIFFUSION, STRESS, WALLS, COUPLING, GRADIENT, PLASTIC, FIELDS, NTERM };
  bool ledger;
  double taken[NTERM];
  // adds a power of the pair loops, which counts only in steps, not in setup
  void tally(Term term, double power) { taken[term] += tally_dt * power; }
  double potential(int i) const;    // gravitational energy of atom i at the positions in atom->x
  double stored(int i) const;       // compressive energy of atom i
  double shear_energy(int i) const;
  double density_ratio(int i) const;    // rho/rho0; that of a total-Lagrangian solid is in its deformation

  // viscous velocity of no-slip walls of particles (fix fsi/wall/particle) and solids; null: there are none
  double **wall_velocity;
  // rho dp/drho of wall particles, that of the fluid around them; null: it is the same for all fluids, and in the wall's state
  double *wall_stiffness;

  FSI::Walls walls;     // at the time of the positions in atom->x

  // body forces per mass: each fix gravity as it acts in this step, and for each type the sum of those that act on all its particles
  struct BodyForce {
    Fix *fix;
    int mask;    // of its group; 0 if it is disabled
    bool varies;
    double g[3];
  };
  std::vector<BodyForce> body_forces;
  std::vector<std::array<double, 3>> gravity;
  void update_gravity(bool advance);
  std::array<double, 3> body_force(int i) const;    // on atom i, over its mass
  class FixFSIStress *fix_stress;
  std::vector<class FixFSIWallMirror *> wall_fixes;
  std::vector<class FixFSIWallParticle *> particle_walls;
  std::vector<class FixFSIStream *> streams;
  class PairFSIFluid *fluid;
  class PairFSISolid *solid;
  class PairFSISolidTL *solid_tl;
  int substeps;    // of total-Lagrangian solids in each step: as given, or as fix fsi/dt has chosen
  int surface_every;    // steps from one number density to the next of the free-surface rule
  class FixFSIDt *fix_dt;    // changes the time step; null: nothing does
  FSI::Profile *profile;     // of fix fsi/report; null: there is none
  FSI::Check *check;         // stops a run that has lost its meaning
  double mach;               // largest Mach number of fluids
  std::vector<std::string> effects_on;    // what is simulated, in words; from setup on
  // what moves by rates between the middles of two steps takes update->dt + stagger: their distance, if dt changes
  double stagger;

  // pressure of a local or ghost atom from its density (paper eq. 16), 0 at a free surface if that rule is on
  double pressure(int i) const;
  double psi_reference;    // of the free-surface rule

  bool is_total_lagrangian(int i) const { return solid_tl && state[atom->type[i]].species == FSI::SOLID; }
  bool is_moved(int i) const;    // by this fix or by another that integrates
  // does atom i have a deviatoric stress?
  bool has_stress(int i) const { return solid && state[atom->type[i]].species == FSI::SOLID; }

  // sums of the velocity gradient per solid particle, and what replaces them: L, then the coefficients of its weights
  int ngrad() const;
  int nshift() const { return 2 * dim + 1; }
  // number density of local atoms into n[0..nlocal-1], for ghosts as they are in atom->x; n has room for ghosts
  void number_density(double *n);
  // sum of position_divergence() of pair_style fsi/fluid, likewise
  void position_divergence(double *n);
  bool several_stiffnesses() const;    // do fluids differ in rho0 c^2?
  void add_wall_force(int wall, int axis, double f);    // f on the fluid; counted by the wall's fix

 private:
  FSI::Message forward, back, scalar_back;    // to ghosts, and sums from them; of one array of numbers per atom
  double *summed;                             // that array; null: the other
  void set_fields();
  double **beyond;    // solids with no slip: sums of v W and W over the fluid around
  double *ratio;    // density mode ratio: rho/psi of the reference state; 0 = not taken yet
  double hdx;    // h over dx
  int given_substeps;
  double tally_dt;
  bool need_psi, need_grad, need_shift;
  bool keep_psi;    // number density is that of some steps only: it travels with its atom and through restarts
  bool send_psi;    // in this step
  // simulated time as the restart file has it, which LAMMPS forgets where it has no timestep command after reading
  struct Clock {
    bigint step, first_step;
    double dt, time;
  };
  std::optional<Clock> clock;    // until the first run
  int nlocal_ready;            // atoms when the state was last brought up to date; -1: not since init()
  bool ids_checked;

 public:
  void restore_clock();

 private:
  bool psi_is_due(bool advance) const;
  bool restores_volumes() const;

  template <int D> void drift();
  template <int D> void kick();
  void substep_solids();
  std::string announced;    // the list of effects as last printed
  template <int D, int TERMS> void advance_solids(bool advance);
  void advance_density();
  void density_from_psi();
  std::vector<double> crowd;    // number density of the steps in which volumes are restored
  void restore_volumes();
  void extrapolate_velocities();
  void update_state(bool);
  void gather_walls();
  void announce();
  void find_gravity();
  std::vector<int> acts_on_all;    // each field, type by type
  bool fresh_start() const;
  void give_defaults(int);
  void sort_by_place();
  void warn_idle() const;    // fix_fsi_idle.cpp
  void add_ghosts(double *);
};

}    // namespace LAMMPS_NS

#endif
#endif
