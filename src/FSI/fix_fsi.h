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
#include "fsi_body_forces.h"
#include "fsi_fields.h"
#include "fsi_keywords.h"
#include "fsi_material.h"
#include "fsi_profile.h"
#include "fsi_resolution.h"
#include "fsi_walls.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace LAMMPS_NS {
namespace FSI {
  class Check;
  class Part;
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
  std::vector<FSI::Resolution> resolution;    // per atom type: that of fluids is the above
  double largest_cut;                         // support of the coarsest
  double h_of(int type) const { return resolution[type].h; }
  double dx_of(int type) const { return resolution[type].dx; }
  bool several_spacings() const;
  int density_fluid, density_solid;    // Density
  FSI::Keywords keywords;

  // state per atom type; pair styles enter theirs in init_style()
  std::vector<FSI::State> state;
  void enter_state(int type, const FSI::State &);

  // per atom, local and ghost; valid from pre_force on
  double *psi;      // number density, if any mode or rule needs it
  double **shift;   // fluids, pair_style fsi/fluid shift: displacement at the end of the step; null: there is none
  int *wmask;       // bits of the mirror walls that an atom is near

  // energy ledger (compute fsi/energy): what each term took from the particles' energy since the fix was defined, this
  // rank's part; kept only while such a compute exists
  enum Term { ARTIFICIAL, LAMINAR, DIFFUSION, STRESS, WALLS, COUPLING, GRADIENT, PLASTIC, FIELDS, NTERM };
  bool ledger;
  double taken[NTERM];
  // adds a power of the pair loops, which counts only in steps, not in setup
  void tally(Term term, double power) { taken[term] += tally_dt * power; }
  void set_tally(double dt) { tally_dt = ledger ? dt : 0.0; }    // time that powers act for
  double potential(int i) const;    // gravitational energy of atom i at the positions in atom->x
  double stored(int i) const;       // compressive energy of atom i

  // viscous velocity of no-slip walls of particles (fix fsi/wall/particle) and solids; null: there are none
  double **wall_velocity;
  bool noslip_walls;
  // rho dp/drho of wall particles, that of the fluid around them; null: it is the same for all fluids, and in the wall's state
  double *wall_stiffness;

  FSI::Walls walls;     // at the time of the positions in atom->x

  FSI::BodyForces body_forces;
  // what takes part in a step, in the order of its calls: pair styles, then fixes as they are defined; from init() on
  std::vector<FSI::Part *> parts;
  int substeps;    // of total-Lagrangian solids in each step: as given, or as fix fsi/dt has chosen
  int surface_every;    // steps from one number density to the next of the free-surface rule
  FSI::Profile *profile;     // of fix fsi/report; null: there is none
  FSI::Check *check;         // stops a run that has lost its meaning
  double mach;               // largest Mach number of fluids
  std::vector<std::string> effects_on;    // what is simulated, in words; from setup on
  std::string announced;                  // the list of effects as last printed
  // what moves by rates between the middles of two steps takes update->dt + stagger: their distance, if dt changes
  double stagger;

  // pressure of a local or ghost atom from its density (paper eq. 16), 0 at a free surface if that rule is on
  double pressure(int i) const;
  // free-surface rule of pair_style fsi/fluid: p = 0 where psi is below this part of a reference; 0: off. The largest psi of fluids, or the lattice's
  double surface_ratio;
  bool surface_max;
  double psi_reference;
  bool has_number_density() const { return need_psi; }
  bool number_density_is_kept() const { return keep_psi; }    // from one surface/every to the next

  double density_ratio(int i) const { return atom->rho[i] / state[atom->type[i]].rho0; }    // not of a total-Lagrangian solid
  bool is_total_lagrangian(int i) const { return state[atom->type[i]].form == FSI::TOTAL_LAGRANGIAN; }
  bool is_moved(int i) const;    // by this fix or by another that integrates

  // number density of local atoms into n[0..nlocal-1], for ghosts as they are in atom->x; n has room for ghosts
  void number_density(double *n);
  void add_ghosts(double *n);    // to local atoms what pairs left on their ghosts
  bool several_stiffnesses() const;    // do fluids differ in rho0 c^2?
  void add_wall_force(int wall, int axis, double f);    // f on the fluid; counted by the wall's fix

 private:
  FSI::Message forward, back, scalar_back;    // to ghosts, and sums from them; of one array of numbers per atom
  double *summed;                             // that array; null: the other
  void set_fields();
  double *ratio;    // density mode ratio: rho/psi of the reference state; 0 = not taken yet
  double hdx;    // h over dx
  std::vector<double> given_spacing;    // per type; 0: dx
  void check_spacings() const;
  int given_substeps;
  double tally_dt;
  bool need_psi;
  bool keep_psi;    // number density is that of some steps only: it travels with its atom and through restarts
  bool send_psi;    // in this step
  // simulated time as the restart file has it, which LAMMPS forgets where it has no timestep command after reading
  struct Clock {
    bigint step, first_step;
    double dt, time;
  };
  std::optional<Clock> clock;    // until the first run
  bool states_entered;    // since the last init()
  int nlocal_ready;            // atoms when the state was last brought up to date; -1: not since init()
  bool ids_checked;

 public:
  void restore_clock();

 private:
  bool psi_is_due(bool advance) const;

  template <int D> void drift();
  template <int D> void kick();
  void find_parts();
  void density_from_psi();
  void update_state(bool);
  void gather_walls();
  std::vector<FSI::WallForce> wall_forces;    // on each mirror wall
  bool fresh_start() const;
  void give_defaults(int);
};

}    // namespace LAMMPS_NS

#endif
#endif
