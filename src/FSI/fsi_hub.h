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

// What those that take part in a step share: what is the same in a whole run, what a step has, and
// the balance of energy. Fix fsi has these objects; a style takes those that it needs once, when a
// run begins, const where it only reads, and keeps no pointer to the fix.

#ifndef LMP_FSI_HUB_H
#define LMP_FSI_HUB_H

#include "fix.h"
#include "fsi_material.h"
#include "fsi_part.h"
#include "fsi_walls.h"

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace LAMMPS_NS::FSI {
class Cells;
class Keywords;
class Profile;
class Record;
class Sight;

// How finely an atom type is resolved: the spacing of its lattice, and what follows from it. The
// smoothing length over the spacing is the same for all types. Fluids of two spacings meet with
// the kernel of their mean, fluids and others with the fluid's, each with its own volume.
struct Resolution {
  double dx = 0.0, h = 0.0;      // spacing of the initial lattice, smoothing length
  double cut = 0.0;              // support radius of the kernel
  double psi_bulk = 0.0;         // number density inside the lattice: the volume of a particle is
                                 // 1/psi_bulk
  double wdx = 0.0, w0 = 0.0;    // W(dx), W(0)
};

// distance of neighbors of two lattices that face each other, cell by cell
inline double spacing_between(const Resolution &a, const Resolution &b)
{
  return 0.5 * (a.dx + b.dx);
}

// Constant from init() on. Of itself the resolution of the coarsest fluid.
struct Discretization : Resolution {
  Discretization(const Fix *mover, int ntypes) : mover(mover), state(ntypes + 1) {}
  Discretization(const Discretization &) = delete;

  const Fix *const mover;    // fix fsi, whose group is what it moves
  int article;               // the article's scheme: what it sets where a style says nothing else
  enum Density { CONTINUITY, SUMMATION, RATIO };
  static std::vector<std::string> density_names(int species);    // of these
  int density_fluid, density_solid;                              // Density
  int dim;
  int kernel;                            // KernelKind
  double central_length_sq;              // l^2/h^2 of central laminar viscosity
  std::vector<Resolution> resolution;    // per atom type
  double largest_cut;                    // support of the coarsest
  double dx_of(int type) const { return resolution[type].dx; }
  double h_of(int type) const { return resolution[type].h; }
  // within which a wall of particles or a solid of this type pushes off fluid of that spacing
  double guard_of(int type, double spacing) const
  {
    if (state[type].species == SOLID) return solids_guard * 0.5 * (spacing + dx_of(type));
    return state[type].guard * ((spacing + dx_of(type)) / (dx + dx_of(type)));
  }
  double solids_guard = 0.0;    // in mean spacings
  // the way out of the guards around a place, of the particles in cells
  std::array<double, 3> out_of_guards(const Atom *, const Cells &, double spacing,
                                      const double *at) const;
  // The spacings of fluids, from the above on, the coarsest; which of them a fluid type has
  std::vector<Resolution> levels;
  std::vector<int> level_of;
  bool has_levels() const { return levels.size() > 1; }
  void find_levels();    // from the states
  // e of Kernel::sharper() for fluids of this spacing beside particles of this type
  double sharper_of(int type, double spacing) const
  {
    const double ratio = dx_of(type) / spacing, per_h = dx / h;
    return (1.0 - ratio * ratio) / 24.0 * per_h * per_h;
  }
  // its dimension; returns the words of fix fsi, with the kernel of the fluid's preset if they
  // name none
  std::vector<std::string> begin(LAMMPS *, const Keywords &, std::vector<std::string> words);
  bool kernel_named;
  double hdx;                           // h over dx
  std::vector<double> given_spacing;    // those that differ from dx, by type, or 0
  void resolve() { resolve(given_spacing); }
  // with these types of the fluid's levels, from the coarsest on, where none is given
  void resolve_levels(const std::vector<int> &types);

  // per atom type; pair styles enter theirs in init_style()
  std::vector<State> state;
  bool states_entered = false;    // in this init()
  void enter_state(int type, const State &);
  bool several_stiffnesses() const;    // do fluids differ in rho0 c^2?
  std::vector<int> types_of_levels;    // the first fluid, and those left to fix fsi/refine
  std::vector<double> thin;            // per atom type, 1: fluids do not see each other through it
  std::shared_ptr<Sight> sight;    // past those and segments of mirror walls; null: there are none
  bool has_thin() const { return std::count(thin.begin(), thin.end(), 1.0) > 0; }
  bool noslip_walls = false;
  double mach;    // largest Mach number of fluids

  // Free-surface rule: p = 0 where psi is below this part of the largest one of fluids; 0: off
  double surface_ratio = 0.0;
  bool need_psi = false;    // for any mode or rule

 private:
  void resolve(const std::vector<double> &spacing);
};

// a skin of 0.4 spacings, in place of the one that LAMMPS has before any command neighbor
void choose_skin(LAMMPS *, double dx);

// Body forces per mass: each fix gravity as it acts in this step.
class BodyForces : protected Pointers {
 public:
  explicit BodyForces(LAMMPS *lmp) : Pointers(lmp) {}
  void find();                                  // before a run
  void evaluate(const std::vector<State> &);    // at the time of the step
  // Energy that this rank's particles have lost because fields changed in the last evaluate(),
  // taken in the middle between two steps. Those of the group are half a step further.
  double work(const std::vector<State> &, int groupbit) const;
  std::array<double, 3> on(int i) const;    // atom i, over its mass
  double potential(int i) const;            // its gravitational energy, where it is now

  struct Field {
    Fix *fix = nullptr;
    int mask = 0;    // of its group; 0 if it is disabled
    bool varies = false;
    double g[3] = {}, change[3] = {};
  };
  std::vector<Field> all;
  std::vector<std::array<double, 3>> of_type;    // sum of those that act on all its particles

 private:
  void find_whole_types(const std::vector<State> &);
  std::vector<int> acts_on_all, warned;    // each field, type by type
};

// What fix fsi/kk has in the place of loops on the host.
struct OnDevice {
  virtual void to_host() = 0;      // all of the particles, for those that read it there
  virtual void from_host() = 0;    // what was changed there
  // Are the forces on this rank's particles below that and, looked at closely, components of
  // velocities below that, and all that a run needs finite?
  virtual bool is_calm(bool closely, double force, double speed) = 0;

 protected:
  ~OnDevice() = default;
};

// Of one step.
struct StepState {
  StepState(LAMMPS *lmp, const std::vector<Part *> &parts) : body_forces(lmp), parts(parts) {}
  StepState(const StepState &) = delete;

  BodyForces body_forces;
  Profile *profile = nullptr;    // of fix fsi/report; null: there is none
  OnDevice *device = nullptr;    // of fix fsi/kk; null: all loops are on the host
  // of an /omp style: calls loop(first, last) in threads, for parts of n particles; or null
  std::function<void(int n, const std::function<void(int, int)> &loop)> threads;
  // each(i) for i below n
  template <class Each> void for_particles(int n, Each each) const
  {
    const auto loop = [=](int first, int last) {
      for (int i = first; i < last; i++) each(i);
    };
    threads ? threads(n, loop) : loop(0, n);
  }
  // what of(first, last) finds in parts of n particles, at once: in their order
  template <class Of> auto in_parts(int n, Of of) const
  {
    std::map<int, decltype(of(0, 0))> parts;    // by their first particle
    std::mutex one_at_a_time;
    const auto loop = [&](int first, int last) {
      auto found = of(first, last);
      const std::lock_guard<std::mutex> guard(one_at_a_time);
      parts.emplace(first, std::move(found));
    };
    threads ? threads(n, loop) : loop(0, n);
    return parts;
  }
  // those i below n for which choose(i), in order
  template <class Choose> std::vector<int> those(int n, Choose choose) const
  {
    const auto parts = in_parts(n, [=](int first, int last) {
      std::vector<int> here;
      for (int i = first; i < last; i++)
        if (choose(i)) here.push_back(i);
      return here;
    });
    std::vector<int> all;
    for (const auto &part : parts) all.insert(all.end(), part.second.begin(), part.second.end());
    return all;
  }
  int substeps = 1;    // of total-Lagrangian solids: as given or chosen by fix fsi/dt
  bool takes_substeps(LAMMPS *) const;    // or may take
  // What moves by rates between the middles of two steps takes update->dt + dt_offset: their
  // distance, where dt has changed, by a command between runs, too. substep_offset: likewise of
  // sub-steps, the first of this step and the last one before.
  double dt_offset = 0.0, substep_offset = 0.0;
  void begin_run();
  void begin(double dt);
  void write(Record &) const;
  void read(const Record &);
  double behind = 0.0;           // how far forces, walls and densities are behind positions between
                                 // steps: half of the last one, 0 after setup
  bool shifts = false;           // is it one of the steps that have shifting?
  double psi_reference = 0.0;    // of the free-surface rule
  Walls walls;                   // at the time of the positions in atom->x
  std::vector<WallForce> wall_forces;    // on each of them, counted by its fix
  void gather_walls(LAMMPS *);           // from all fixes fsi/wall/mirror, where they are now
  void find_near_walls(const Atom *, const Discretization &);    // wmask
  // f on the fluid
  void add_wall_force(int wall, int axis, double f) { wall_forces[wall][axis] -= f; }
  // A total-Lagrangian solid that this step found turned inside out, det F <= 0: -1 if there is
  // none; its density
  int inverted = -1;
  double inverted_density = 0.0;

  // Per atom, local and ghost; valid from pre_force on. Null: nothing needs it.
  double *psi = nullptr;       // number density
  double **shift = nullptr;    // fluids, pair_style fsi/fluid shift: displacement and change of
                               // velocity at the end of the step
  // per component: displacement of the last step that had one over the time it is for, which
  // density follows between open ends where fluid fills the box
  double *shift_velocity[3] = {};
  int *wmask = nullptr;                // bits of the mirror walls that an atom has images in
  double **wall_velocity = nullptr;    // viscous velocity of no-slip walls of particles (fix
                                       // fsi/wall/particle) and solids
  // Of solids with sub-steps: how fluid resists a change of their velocity within the step (xx yy
  // zz xy xz yz; empty: there is none), the mean of this change
  std::vector<double> impedance[6], swerve[3];
  // of fluids in the last force, local and ghost; null: none depends on the shear rate
  const double *viscosity = nullptr;
  // Of implicit viscosity. Per atom, of fluids: force of the last step that its system lacked,
  // as that of other fixes, which act later; null: viscosity is explicit
  double **unforeseen = nullptr;
  // what brings a component of a local particle's velocity to a value
  struct Pull {
    int i, d;
    double rate, to;     // force: m rate (to - velocity at the end); HUGE_VAL: it has that
    double end = 0.0;    // velocity at the end of the step, when pairs have their forces
  };
  std::vector<Pull> pulls;
  double *wall_stiffness = nullptr;    // rho dp/drho of wall particles, that of the fluid around
                                       // them; null: it is the same for all fluids, and in the
                                       // wall's state

 private:
  const std::vector<Part *> &parts;        // what takes part in a step
  double last_dt = 0.0, last_sub = 0.0;    // of the last step taken and of its sub-steps; 0: none
};

// Energy balance (compute fsi/energy): what each term took from the particles' energy since fix
// fsi was defined, this rank's part; kept only while such a compute exists.
struct Ledger : Part {
  // clang-format off
    enum Term {
      ARTIFICIAL, LAMINAR, DIFFUSION, STRESS, WALLS, COUPLING, GRADIENT, INELASTIC, FIELDS,
      LEVELS, NTERM
    };
  // clang-format on
  bool kept = false;
  double energy_out[NTERM] = {};
  double guarding[2] = {};    // that pairs held off by walls of particles and by solids have
  double *account(Term term) { return kept ? &energy_out[term] : nullptr; }    // of one term
  // adds a power of the pair loops, which counts only in steps, not in setup
  void tally(Term term, double power) { energy_out[term] += tally_dt * power; }
  void set_tally(double dt) { tally_dt = kept ? dt : 0.0; }    // time that powers act for

  // a step that is taken back: all but what it has made or deleted, which stays so
  Rank rank() const override { return PAIRS; }
  void start_step() override { std::copy_n(energy_out, NTERM, before); }
  void follow_exchange()
  {
    for (const auto term : {FIELDS, LEVELS}) before[term] = energy_out[term];
  }
  void go_back() override { std::copy_n(before, NTERM, energy_out); }

 private:
  double before[NTERM] = {};    // the step
  double tally_dt = 0.0;
};

// Of local or ghost atom i: its pressure from its density (paper eq. 16), 0 at a free surface if
// that rule is on; its compressive energy
double pressure_of(int i, const Atom *, const Discretization &, const StepState &);
double stored(int i, const Atom *, const Discretization &);
// the energy that it takes is in the balance
void set_density(int i, double rho, Atom *, const Discretization &, Ledger &, Ledger::Term);
// mass of a particle of this type's stress-free lattice; mass and density, where there are none
double lattice_mass(const Discretization &, int type);
void give_defaults(int i, Atom *, const Discretization &);
bool is_moved(int i, const LAMMPS *);    // by fix fsi or by another that integrates

// the rows of a per-atom array, which LAMMPS allocates in one piece, without the way through its
// pointers to them
typedef double Vector[3];
inline Vector *vectors(double **a)
{
  return reinterpret_cast<Vector *>(a[0]);
}

// The shortest of a difference's periodic images, as Domain::minimum_image() gives it, whose
// arguments differ between releases of LAMMPS; boxes are orthogonal
void to_nearest_image(const Domain &, double *d);
bool is_periodic(const Domain &);    // along any axis: else there is one image of each particle

// between runs: particles where they belong, with ghosts, whatever was created or moved
void renew_ghosts(LAMMPS *);

// 0 to 0.5, what tells particles with the same key apart on any number of ranks
double part_by_place(const double *x, const Domain *);

}    // namespace LAMMPS_NS::FSI

#endif
