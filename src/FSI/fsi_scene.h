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

// What everybody reads of a simulation: discretisation, the state of each atom type, walls, body
// forces, what is on. Fix fsi is a Scene and fills it in; whoever only reads takes a Scene and need
// not know fix fsi.

#ifndef LMP_FSI_SCENE_H
#define LMP_FSI_SCENE_H

#include "fsi_body_forces.h"
#include "fsi_material.h"
#include "fsi_resolution.h"
#include "fsi_walls.h"

#include <memory>
#include <string>
#include <vector>

namespace LAMMPS_NS {
class Fix;
class LAMMPS;

namespace FSI {
  class Part;
  class Profile;
  class Sight;

  class Scene {
   public:
    Scene(LAMMPS *, const Fix *fix_fsi);
    Scene(const Scene &) = delete;

    const Fix *const mover;    // fix fsi, whose group is what it moves

    // discretisation
    enum Density { CONTINUITY, SUMMATION, RATIO };
    static std::vector<std::string> density_names(int species);    // of these
    int dim;
    int kernel;         // KernelKind
    double dx, h;       // spacing of the initial lattice, smoothing length
    double cut;         // support radius of the kernel
    double psi_bulk;    // number density inside the lattice: the volume of a particle is 1/psi_bulk
    double wdx, w0;     // W(dx), W(0)
    int density_fluid, density_solid;      // Density
    std::vector<Resolution> resolution;    // per atom type; that of fluids is the above
    double largest_cut;                    // support of the coarsest
    double dx_of(int type) const { return resolution[type].dx; }
    double h_of(int type) const { return resolution[type].h; }
    // e of Kernel::sharper() for fluids beside particles of this type
    double sharper_of(int type) const
    {
      const double ratio = dx_of(type) / dx, per_h = dx / h;
      return (1.0 - ratio * ratio) / 24.0 * per_h * per_h;
    }
    std::vector<double> thin;        // per atom type, 1: fluids do not see each other through it
    std::shared_ptr<Sight> sight;    // past those; null: there are none

    // per atom type; pair styles enter theirs in init_style()
    std::vector<State> state;
    void enter_state(int type, const State &);
    bool several_stiffnesses() const;    // do fluids differ in rho0 c^2?

    // what takes part in a step, in the order of its calls: pair styles, then fixes as they are
    // defined; from init() on
    std::vector<Part *> parts;
    int substeps;    // of total-Lagrangian solids in each step: as given or chosen by fix fsi/dt
    double mach;     // largest Mach number of fluids
    Walls walls;     // at the time of the positions in atom->x
    std::vector<WallForce> wall_forces;    // on each of them, counted by its fix
    // f on the fluid
    void add_wall_force(int wall, int axis, double f) { wall_forces[wall][axis] -= f; }
    BodyForces body_forces;
    Profile *profile;    // of fix fsi/report; null: there is none
    // what moves by rates between the middles of two steps takes update->dt + dt_offset: their
    // distance, if dt changes
    double dt_offset;

    // Per atom, local and ghost; valid from pre_force on. Null: nothing needs it.
    double *psi;       // number density
    double **shift;    // fluids, pair_style fsi/fluid shift: displacement and change of velocity at
                       // the end of the step
    bool shifts;       // is it one of the steps that have them?
    // per component: displacement of the last step that had one over the time it is for, which
    // density follows between open ends where fluid fills the box
    double *shift_velocity[3];
    bool density_follows_shift() const;
    bool has_open_ends() const;    // fixes fsi/inlet and fsi/outlet
    int *wmask;                    // bits of the mirror walls that an atom is near
    double **wall_velocity;        // viscous velocity of no-slip walls of particles (fix
                                   // fsi/wall/particle) and solids
    double *wall_stiffness;        // rho dp/drho of wall particles, that of the fluid around them;
                                   // null: it is the same for all fluids, and in the wall's state
    bool noslip_walls;

    // Free-surface rule of pair_style fsi/fluid: p = 0 where psi is below this part of a reference,
    // the largest psi of fluids, or the lattice's; 0: off
    double surface_ratio, psi_reference;
    bool surface_max;
    int surface_every;    // steps from one number density to the next of that rule
    bool need_psi;        // for any mode or rule
    bool keep_psi;    // it is that of some steps only: it travels with its atom, to restarts too

    // A total-Lagrangian solid that this step found turned inside out, det F <= 0: -1 if there is
    // none; its density
    int inverted;
    double inverted_density;

    // Energy ledger (compute fsi/energy): what each term took from the particles' energy since fix
    // fsi was defined, this rank's part; kept only while such a compute exists
    // clang-format off
    enum Term {
      ARTIFICIAL, LAMINAR, DIFFUSION, STRESS, WALLS, COUPLING, GRADIENT, INELASTIC, FIELDS,
      LEVELS, NTERM
    };
    // clang-format on
    bool ledger;
    double energy_out[NTERM];
    double *account(Term term) { return ledger ? &energy_out[term] : nullptr; }    // of one term
    double guarding[2];    // energy that pairs held off by walls of particles and by solids have,
                           // if there is a ledger
    // adds a power of the pair loops, which counts only in steps, not in setup
    void tally(Term term, double power) { energy_out[term] += tally_dt * power; }
    void set_tally(double dt) { tally_dt = ledger ? dt : 0.0; }    // time that powers act for

    std::string announced;    // the list of effects as last printed

    // Of a local or ghost atom
    // from its density (paper eq. 16), 0 at a free surface if that rule is on
    double pressure(int i) const;
    double density_ratio(int i) const;    // rho/rho0; not of a total-Lagrangian solid
    double potential(int i) const;        // gravitational energy at the positions in atom->x
    double stored(int i) const;           // compressive energy
    bool is_total_lagrangian(int i) const;
    bool is_moved(int i) const;    // by fix fsi or by another that integrates

    // the rows of a per-atom array, which LAMMPS allocates in one piece, without the way through
    // its pointers to them
    typedef double Row[3];
    static Row *rows(double **a) { return reinterpret_cast<Row *>(a[0]); }

   protected:
    // h over dx; spacings that differ from dx, by type, or 0
    void resolve(double hdx, const std::vector<double> &spacing);
    double tally_dt;
    bool states_entered;    // in this init()
    void gather_walls();    // one list from all fixes fsi/wall/mirror

   private:
    LAMMPS *const instance;
  };

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
