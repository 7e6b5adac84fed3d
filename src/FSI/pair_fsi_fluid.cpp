/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   Copyright (2003) Sandia Corporation.  Under the terms of Contract
   DE-AC04-94AL85000 with Sandia Corporation, the U.S. Government retains
   certain rights in this software.  This software is distributed under
   the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "pair_fsi_fluid.h"

#include "atom.h"
#include "comm.h"
#include "compute_fsi_force.h"
#include "error.h"
#include "fix_fsi.h"
#include "fix_fsi_move.h"
#include "fix_fsi_stress.h"
#include "force.h"
#include "fsi_fields.h"
#include "fsi_find.h"
#include "fsi_fluid_loops.h"
#include "fsi_implicit_viscosity.h"
#include "fsi_kernel.h"
#include "fsi_pair_laws.h"
#include "fsi_pair_sets.h"
#include "fsi_preset.h"
#include "fsi_profile.h"
#include "fsi_refusals.h"
#include "fsi_shear.h"
#include "fsi_sight.h"
#include "fsi_wet_solids.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>

using namespace LAMMPS_NS;
using namespace FSI;

static const std::vector<std::string> coupling_names = {"wall", "full"};    // Couple

struct PairFSIFluid::Members {
  Fields fields;
  PairSets pairs;
  // from init_style() on
  std::optional<CutSolids> cut_solids;
  std::optional<LightSolids> light_solids;
  std::optional<Shear> shear;
  std::optional<ImplicitViscosity> implicit;
  WallShift wall_shift;
  Thin thin_bodies = {};    // loops get its address
  explicit Members(LAMMPS *lmp) : fields(lmp), pairs(lmp) {}
};

PairFSIFluid::PairFSIFluid(LAMMPS *lmp) :
    PairFSI(lmp, "fsi/fluid"), members(new Members(lmp)), pairs(members->pairs), couple(WALL),
    fields(members->fields)
{
  std::vector<std::string> presets = {"none"};
  for (const Preset &s : PRESETS) presets.push_back(s.name);
  keywords.key("preset")
      .choice(preset, 0, presets, "name")
      .number(speed, 0.0, Range::above(0.0), "speed");
  keywords.key("sound").number(sound, 0.0, Range::above(0.0));
  keywords.key("eos").choice(tait, 0, {"linear", "tait"});
  artificial_row("fluid");
  keywords.key("laminar/visc").set(laminar, PLAIN_LAMINAR).effect("laminar viscosity");
  keywords.key("laminar/visc/central").set(laminar, CENTRAL_LAMINAR);
  keywords.key("laminar/implicit").logical(implicit, false).effect("laminar viscosity, implicit");
  keywords.key("smagorinsky")
      .number(eddies, 0.0, Range::between(0.0, 1.0))
      .effect("eddy viscosity, C_s {}");
  keywords.key("solid/slip").logical(solids_slip, false);
  keywords.key("solid/guard").number(solids_guard, 0.5, Range::between(0.0, 1.0));
  keywords.key("density/diffusion")
      .number(delta, 0.0, Range::between(0.0, 0.5))    // more is unstable at the usual step
      .effect("density diffusion {}");
  keywords.key("density/surface").logical(surfaces, false);
  keywords.key("shift")
      .number(shifting, 0.0, Range::between(0.0, 1.0))
      .effect("particle shifting {}");
  keywords.key("shift/every").integer(shift_every, 1, 1);
  keywords.key("surface")
      .number(surface_ratio, 0.0, Range::from_to_below(0.0, 1.0))
      .effect("free surface where psi is below {}");
  keywords.key("tension").logical(tension, false).effect("tension in the fluid");
  keywords.key("background").number(background, 0.0).effect("background pressure {}");
  keywords.key("background/speed")
      .number(background_speed, 0.0, Range::above(0.0))
      .effect("background pressure rho U^2, U {}");
  keywords.key("couple").choice(given_couple, WALL, coupling_names);
  keywords.key("extrapolate").logical(extrapolate, false);
}

PairFSIFluid::~PairFSIFluid()
{
  take_virial(nullptr);
}

// with those of the preset that the script does not name itself
void PairFSIFluid::settings(int narg, char **arg)
{
  PairFSI::settings(narg, arg);
  if (preset == 0) return;
  const Preset &s = PRESETS[preset - 1];
  const auto named = [=](const std::string &word) {
    return std::find(arg, arg + narg, word) != arg + narg;
  };
  std::string text = fmt::format("sound {} ", SOUND_OVER_SPEED * speed);
  if (s.background && !named("background")) text += fmt::format("background/speed {} ", speed);
  std::vector<std::string> all;
  bool open = false;
  for (const auto &word : utils::split_words(text + s.keywords)) {
    if (keywords.knows(word)) open = !named(word);
    if (open) all.push_back(word);
  }
  if (comm->me == 0)
    utils::logmesg(lmp, "  preset {} {:g}: {}\n", s.name, speed, utils::join_words(all, " "));
  all.insert(all.end(), arg, arg + narg);
  keywords.parse(all);
}

void PairFSIFluid::check_settings()
{
  if (background != 0.0 && background_speed > 0.0)
    error->all(FLERR,
               "Pair style fsi/fluid background and background/speed both say the pressure: "
               "expected one of them");
}

// of the densest fluid, one for all
double PairFSIFluid::background_pressure() const
{
  double rho = 0.0;
  for (const Material &m : material)
    if (m.species == FLUID) rho = std::max(rho, m.rho0);
  return background + rho * background_speed * background_speed;
}

// A hybrid style would take the virial of images, too, with that of pairs: pairs have to count
// their own. What an earlier one had is given back.
void PairFSIFluid::take_virial(Pair *of)
{
  if (hybrid) hybrid->no_virial_fdotr_compute = no_fdotr_before;
  hybrid = of;
  if (!hybrid) return;
  no_fdotr_before = hybrid->no_virial_fdotr_compute;
  hybrid->no_virial_fdotr_compute = 1;
}

void PairFSIFluid::for_rows_with_walls(const UseOfRows &use)
{
  if (pairs.sets.empty()) return;    // not set up yet
  pairs.for_walls(step->walls,
                  [&](const PairSet &set, const std::vector<Row> &rows, const Mirror *mirror) {
                    use(set.level, rows, mirror ? *mirror : Mirror());
                  });
}

State PairFSIFluid::make_state(const Material &m) const
{
  // a solid's state is that of pair_style fsi/solid, if there is one: it enters its own afterwards
  if (m.species == SOLID) return solid_state(m, false);
  State s;
  s.species = m.species;
  s.rho0 = m.rho0;
  s.inv_rho0 = 1.0 / s.rho0;
  if (m.species == RIGID) {
    // its density is what says its pressure, its volume should be that of fluid under this
    // pressure; if fluids differ in this, that of the fluid that is near (fix fsi/wall/particle)
    const auto first = std::find_if(material.begin(), material.end(), [](const Material &other) {
      return other.species == FLUID;
    });
    s.csq = sound_of(*first) * sound_of(*first) * first->rho0 / m.rho0;
    s.c = std::sqrt(s.csq);
  } else {
    s.c = sound_of(m);
    s.csq = s.c * s.c;
    s.tait = tait;
  }
  s.inv_csq = 1.0 / s.csq;
  s.p0 = background_pressure();
  if (!tension) s.floor = 0.0;
  s.viscosity = m.viscosity;
  s.law = m.law;
  return s;
}

double PairFSIFluid::sound_of(const Material &m) const
{
  if (m.sound > 0.0) return m.sound;
  if (sound == 0.0)
    error->all(FLERR,
               "Fluid {} has no speed of sound: give it keyword sound in its material file, or "
               "pair_style fsi/fluid one for all fluids that have none of their own",
               m.name);
  return sound;
}

void PairFSIFluid::check_effects(const Facts &of_solids) const
{
  const bool rates = disc->density_fluid == Discretization::CONTINUITY, full = couple != WALL;
  const struct {
    bool so;
    const Refusal &why;
    const char *what;
  } refused[] = {
      {delta > 0.0 && !rates, Refused::CONTINUITY, "density/diffusion"},
      {surfaces && !rates, Refused::CONTINUITY, "density/surface"},
      {shifting > 0.0 && !(rates && disc->density_solid == Discretization::CONTINUITY),
       Refused::CONTINUITY, "shift"},
      {surfaces && (tension || background_pressure() != 0.0), Refused::SURFACES, ""},
      {implicit && laminar != PLAIN_LAMINAR, Refused::IMPLICIT, ""},
      {full && of_solids.style == Facts::OF_TOTAL_LAGRANGIAN_SOLIDS, Refused::FULL_TOTAL, ""},
      // the plain forces of a solid end at its face with half a kernel of neighbors missing, which
      // the fluid's pairs supply
      {full && of_solids.corrected_gradients, Refused::FULL_CORRECTED, ""},
  };
  for (const auto &r : refused)
    if (r.so) refuse(error, r.why, r.what);

  const bool viscous = std::any_of(material.begin(), material.end(), [](const Material &m) {
    return m.viscosity > 0.0 || m.law.varies();    // one that thickens has none at rest
  });
  const bool solids = has_solids();
  const struct {
    bool so;
    const char *what, *why;
  } idle[] = {
      {laminar && !viscous && eddies == 0.0 && !by_preset("laminar/visc"), "laminar/visc",
       "no fluid has a viscosity"},
      {extrapolate && !solids, "extrapolate", "there is no solid"},
      {extrapolate && solids && full, "extrapolate", "it is for couple wall"},
      {eddies > 0.0 && !laminar, "smagorinsky", "there is no laminar/visc"},
      {solids_slip && !solids, "solid/slip", "there is no solid"},
      {solids_slip && solids && !laminar, "solid/slip", "there is no laminar/visc"},
  };
  for (const auto &r : idle)
    if (r.so && comm->me == 0)
      error->warning(FLERR, "Pair style fsi/fluid {} has nothing to act on: {}", r.what, r.why);
}

bool PairFSIFluid::by_preset(const char *keyword) const
{
  return preset && strstr(PRESETS[preset - 1].keywords, keyword);
}

// chooses the loops for kernel, dimension and the effects that the script names
void PairFSIFluid::init_style()
{
  NeighList *const lists = list;    // LAMMPS makes no others where all is asked for as before
  PairFSI::init_style();
  list = lists;
  force_computes = computes_of<ComputeFSIForce>(lmp);
  walls_of_particles.clear();
  for (auto *p : fixes_of<Part>(lmp))
    if (p->facts().particle_walls) walls_of_particles.push_back(p);
  const Facts of_solids = facts_of_solids(lmp);
  couple = disc->article && of_solids.style == Facts::OF_SOLIDS ? FULL : given_couple;
  check_effects(of_solids);
  const KernelChoice advised = kernel_of(facts().preset, disc->dim);
  if (preset && !disc->kernel_named && advised.kernel != disc->kernel)
    error->all(FLERR,
               "Fix fsi without a kernel takes the one of preset {}: expected the pair style "
               "before the fix, or the kernel named there",
               PRESETS[preset - 1].name);
  FixFSI *const fix = FixFSI::find(lmp, style);
  fix->disc.find_levels();
  fix->disc.solids_guard = couple == WALL ? solids_guard : 0.0;
  if (!disc->has_thin() && !any_is(fixes_of<Part>(lmp), &Facts::segments))
    fix->disc.sight.reset();
  else if (!disc->sight)
    fix->disc.sight = std::make_shared<Sight>(lmp, *disc, step->walls, disc->thin);
  pairs.init(*disc, *step, couple != WALL);
  members->cut_solids.emplace(lmp, *disc, has_solids());
  members->light_solids.emplace(lmp, *disc, *step, *ledger, *ghosts,
                                implicit && sticks_to_solids());
  members->shear.emplace(lmp, *disc, *step, *ghosts, eddies);
  members->implicit.emplace(lmp, *disc, *step, *ghosts);
  const ChosenKernel kernel(disc->kernel, disc->dim, disc->h);
  members->wall_shift = disc->dim == 2 ? Shift<2>::find_walls(kernel, disc->dx)
                                       : Shift<3>::find_walls(kernel, disc->dx);
  step->viscosity = nullptr;
  step->threads = nullptr;
  const bool mirrors = any_is(fixes_of<Part>(lmp), &Facts::mirror_walls);
  take_virial(force->pair != this && mirrors ? force->pair : nullptr);
  double &ghosts = comm->cutghostuser;    // 0: LAMMPS chooses; too small: fix fsi says so
  if (ghosts == raised_ghosts) ghosts = given_ghosts;
  given_ghosts = ghosts;
  if (has_solids() && mirrors && (ghosts == 0.0 || ghosts >= disc->largest_cut))
    ghosts = std::max(ghosts, pairs.beyond_lists() + neighbor->skin);
  raised_ghosts = ghosts;
  open_ends = has_open_ends(lmp);
  fix_stress = first_of(fixes_of<FixFSIStress>(lmp));
}

Facts PairFSIFluid::facts() const
{
  Facts facts = PairFSI::facts();
  facts.style = Facts::OF_FLUIDS;
  facts.preset = preset ? &PRESETS[preset - 1] : nullptr;
  facts.laminar = laminar;
  facts.implicit_viscosity = implicit;
  facts.couples_stress = couple != WALL;
  facts.density_at_surfaces = surfaces;
  facts.density_follows_shift = shifting > 0.0 && fills();
  facts.shift_every = shifting > 0.0 ? shift_every : 0;
  return facts;
}

// what density follows: between open ends, where nothing else holds the number of particles
double *const *PairFSIFluid::velocity_of_shifting() const
{
  return step->shift_velocity[0] && open_ends ? step->shift_velocity : nullptr;
}

// numbers of an atom in the array of shifting, and those of them that are sums

int PairFSIFluid::nshift() const
{
  return disc->dim == 2 ? Shift<2>::row(fills()) : Shift<3>::row(fills());
}

int PairFSIFluid::shift_sums() const
{
  return disc->dim == 2 ? Shift<2>::sums(fills()) : Shift<3>::sums(fills());
}

void PairFSIFluid::set_fields(Discretization &of_run)
{
  check_pairs();
  if (hybrid_style()) neighbor->add_request(this);    // after init_style()
  fields.set("density rate", Fields::STEP, disc->density_fluid == Discretization::CONTINUITY, rate);
  fields.set("shift", Fields::STEP, shifting > 0.0, step->shift, nshift());
  fields.set("fade of shifting", Fields::STEP, shifting > 0.0 && disc->has_levels(), fade);
  fields.set("velocity beyond solids", Fields::STEP, sticks_to_solids(), beyond, disc->dim + 1);
  fields.set("room behind thin bodies", Fields::STEP, disc->sight != nullptr, backfill);
  fields.set("weight behind thin bodies", Fields::STEP, disc->sight != nullptr, backfill_weight);
  of_run.noslip_walls = of_run.noslip_walls || sticks_to_solids();
  of_run.surface_ratio = surface_ratio == 0.0 && disc->article ? 0.9 : surface_ratio;
}

void PairFSIFluid::add_messages(Message &to_ghosts, Message &back)
{
  if (sticks_to_solids()) to_ghosts.add(step->wall_velocity, 0, disc->dim, {SOLID});
  if (sticks_to_solids()) back.add(beyond, 0, disc->dim + 1, {SOLID});
  if (disc->density_fluid == Discretization::CONTINUITY) back.add(rate, {FLUID, RIGID});
  if (shifting > 0.0) back.add(step->shift, 0, shift_sums(), {FLUID, RIGID}, &step->shifts);
}

void PairFSIFluid::find_idle(const Census &all, const Idle &nothing) const
{
  if (shift_every > 1 && shifting == 0.0 && !by_preset("shift/every"))
    nothing("Pair style fsi/fluid shift/every", "keyword shift is 0");
  if (all.fluids == 0) nothing("Pair style fsi/fluid" + named_effects(), "no particle is a fluid");
}

void PairFSIFluid::begin_state(bool advance)
{
  pairs.begin_step();
  step->shifts = advance && shifting > 0.0 && update->ntimestep % shift_every == 0;
  if (neighbor->ago) return;
  fields.grow();
  if (disc->sight) disc->sight->find_bodies();
  find_guards();
  pairs.find_rows(list);
  if (!backfill) return;
  std::fill_n(backfill, atom->nlocal + atom->nghost, 1.0);
  std::fill_n(backfill_weight, atom->nlocal + atom->nghost, 1.0);
}

bool PairFSIFluid::add_rates(bool advance)
{
  fields.grow();
  if (backfill) {
    pairs.look_past_thin_bodies(backfill, backfill_weight);
    ghosts->send(backfill);
    ghosts->send(backfill_weight);
  }
  members->cut_solids->find(*step);
  if (rate || step->walls.any()) pairs.find_reach(rate != nullptr);
  const size_t nall = atom->nlocal + atom->nghost;
  if (rate) std::fill_n(rate, nall, 0.0);
  if (step->shifts && nall) std::fill_n(step->shift[0], nall * nshift(), 0.0);
  const Phase phase(step->profile, Profile::DENSITY);
  if (step->shifts && fade) find_fades();
  if (rate && advance)
    disc->dim == 2 ? add_density_rate<2>(update->dt) : add_density_rate<3>(update->dt);
  if (beyond) {
    if (nall) std::fill_n(beyond[0], nall * (disc->dim + 1), 0.0);
    add_velocities_at_solids();
  }
  return (rate && advance) || beyond;
}

void PairFSIFluid::advance(bool advance)
{
  const Phase phase(step->profile, Profile::DENSITY);
  if (beyond) extrapolate_velocities();
  if (!rate || !advance) return;
  advance_density();
  if (!step->shifts) return;
  const double dt = update->dt * shift_every;
  if (disc->dim == 2)
    fills() ? displacements<2, true>(dt) : displacements<2, false>(dt);
  else
    fills() ? displacements<3, true>(dt) : displacements<3, false>(dt);
}

// the sums of find_fades over some rows; seen: how much of pairs, or of all of them all
template <class T, class K>
void PairFSIFluid::add_fades(const K &kernel, const std::vector<Row> &rows, const Visible &seen)
{
  constexpr int D = K::DIM;
  const auto *const x = vectors(atom->x), *const v = vectors(atom->v);
  const double *const volume = volumes.data();
  double *const sums = fade;
  run_loop<T>([&](auto number) FSI_INLINE_LAMBDA {
    using Number = decltype(number);
    for (const Row &row : rows) {
      const double *const xi = x[row.i], *const vi = v[row.i];
      Number sum = 0.0;
      for_neighbors<Number, false>(row, [&](const int *j, const Number &there) FSI_INLINE_LAMBDA {
        Number rsq = 0.0, vx = 0.0;
        for (int d = 0; d < D; d++) {
          const auto of = [&](const auto *rows, double own) FSI_INLINE_LAMBDA {
            return own - Lanes<Number>::make([&](int k) FSI_INLINE_LAMBDA {
                     return rows[j[k]][d];
                   });
          };
          const Number away = of(x, xi[d]);
          rsq += away * away;
          vx += away * of(v, vi[d]);
        }
        // no direction where both are at one place
        Number w = there * kernel.W(root(rsq)) * (vx * vx / greater(rsq, Number(1.0e-300)));
        if constexpr (std::is_same_v<Number, double>)
          if (seen.part) w *= seen.part[j - seen.first];
        sum += Lanes<Number>::read(volume, j) * w;
        Lanes<Number>::add(volume[row.i] * w, sums, j);
      });
      sums[row.i] += Lanes<Number>::sum(sum);
    }
  });
}

// Shifting's factor 1 + 0.2 (W_ij/W(dx))^4 gives it another state of rest than the force of
// pressure has. Where particles stand on one lattice both are at rest; where two lattices meet they
// would work against each other without end. Where the flow distorts the order of particles the
// factor keeps them apart. So of it is left min(1, (u/u0)^2), u^2 = sum_j V_j W_ij (v_ij.e_ij)^2
// over fluid, e_ij the direction from one to the other: the speed with which neighbors come and go.
void PairFSIFluid::find_fades()
{
  static constexpr double SLOW = 0.003;    // u0 over the speed of sound (doc/notes/levels.md)
  const int nlocal = atom->nlocal, nall = nlocal + atom->nghost, *const type = atom->type;
  std::fill_n(fade, nall, 0.0);
  volumes.resize(nall);
  for (int i = 0; i < nall; i++) volumes[i] = atom->rmass[i] / atom->rho[i];
  for (const auto &m : pairs.sets) {
    const std::vector<Row> &rows = m.rows.rows;
    if ((m.what != PairSet::FLUIDS && m.what != PairSet::HIDDEN) || rows.empty()) continue;
    with_kernel(disc->kernel, disc->dim, m.h, [&](const auto &kernel) {
      if (m.what == PairSet::HIDDEN)
        add_fades<double>(kernel, rows, {m.visible.data(), rows[0].j});
      else
        have_packs() ? add_fades<Pack>(kernel, rows, {}) : add_fades<double>(kernel, rows, {});
    });
  }
  ghosts->add(fade);
  for (int i = 0; i < nlocal; i++) {
    const State &s = disc->state[type[i]];
    if (s.species == FLUID) fade[i] = std::min(1.0, fade[i] / (SLOW * SLOW * s.csq));
  }
  ghosts->send(fade);
}

void PairFSIFluid::advance_density()
{
  double *const rho = atom->rho;
  const int *const type = atom->type;
  const double dt = update->dt + step->dt_offset, *const rmass = atom->rmass;
  const State *const state = disc->state.data();
  double *const rates = rate;
  step->for_particles(atom->nlocal, [=](int i) {
    const State &s = state[type[i]];
    if (s.species == FLUID) rho[i] = next_density(rho[i], rmass[i], s.w0, dt, rates[i]);
  });
}

void PairFSIFluid::prescribe()
{
  if (implicit) members->implicit->find_unforeseen();
}

void PairFSIFluid::integrate_substeps()
{
  if (members->light_solids->resisted())
    members->light_solids->find_impedances(pairs, particles_at(points.data()));
}

// The ledger's powers have velocities of the start of the step. With those of its middle, which are
// known now, they are second order in time: of what waits for its kick by its force, of what has
// moved since, in sub-steps or with a rigid body, by the way it went.
void PairFSIFluid::react()
{
  if (members->light_solids->any())
    members->light_solids->react(pairs, particles_at(points.data()), force_computes);
  if (!ledger->kept || !force->pair->compute_flag) return;
  disc->dim == 2 ? correct_powers<2>() : correct_powers<3>();
}

template <int D> void PairFSIFluid::correct_powers()
{
  const int nlocal = atom->nlocal, nall = nlocal + atom->nghost, *const type = atom->type;
  const double dt = update->dt, half = 0.5 * dt * force->ftm2v;
  const auto *const point = reinterpret_cast<const Point<D> *>(points.data());
  const auto movers = fixes_of<FixFSIMove>(lmp);    // move walls after this
  double next[3];
  const auto change = [&](int i, int d) {
    for (const auto *mover : movers)
      if ((atom->mask[i] & mover->groupbit) && mover->velocity_at_end(i, next))
        return 0.5 * (next[d] - atom->v[i][d]);
    const bool waits = disc->state[type[i]].species == FLUID || step->substeps == 1;
    if (waits && (atom->mask[i] & disc->mover->groupbit))
      return half * atom->f[i][d] / atom->rmass[i];
    const double way = atom->x[i][d] - point[i].x[d];
    return way == 0.0 ? 0.0 : way / dt - 0.5 * point[i].v[d];
  };
  std::vector<double> one(nall);
  for (const auto term : {Ledger::COUPLING, Ledger::ARTIFICIAL, Ledger::WALLS}) {
    double power = 0.0;
    for (int d = 0; d < D; d++) {
      for (int i = 0; i < nall; i++)
        one[i] = term == Ledger::COUPLING           ? taken[row_of_points(D) * i + d]
            : term == Ledger::ARTIFICIAL            ? taken[row_of_points(D) * i + D + d]
            : disc->state[type[i]].species == RIGID ? forces[row_of_forces(D) * i + d]
                                                    : 0.0;
      ghosts->add(one.data());
      for (int i = 0; i < nlocal; i++) power += one[i] * change(i, d);
    }
    ledger->tally(term, power);
  }
}

void PairFSIFluid::undo_advance()
{
  if (!rate) return;
  const double dt = update->dt + step->dt_offset;
  for (int i = 0; i < atom->nlocal; i++)
    if (disc->state[atom->type[i]].species == FLUID) atom->rho[i] -= dt * rate[i];
}

// What keeps fluid out of walls and solids: the energy K d^(D-2) (d-r)^2/2 of a pair nearer than d.
// Of a finer solid the more particles push the finer it is: with K dx^(D-2) (dx_s/dx)^(D-1) for K
// d^(D-2) its face is as stiff, and a pair swings slower than the step of sound allows.
Contact PairFSIFluid::guard_of(int t, double dx) const
{
  const State &s = disc->state[t];
  Contact guard(disc->dim, disc->guard_of(t, dx));
  if (s.species != SOLID) return guard;
  const double ratio = disc->dx_of(t) / dx;
  guard.scale = disc->dim == 3 ? dx * ratio * ratio : ratio;
  return guard;
}

void PairFSIFluid::find_guards()
{
  guards.assign(disc->levels.size(), {});
  for (size_t l = 0; l < guards.size(); l++)
    for (size_t t = 0; t < disc->state.size(); t++)
      guards[l].push_back(guard_of(t, disc->levels[l].dx));
}

FluidParticles PairFSIFluid::particles_at(const double *points)
{
  members->thin_bodies = {backfill, backfill_weight};
  return {points,
          atom->type,
          disc->state.data(),
          atom->nlocal,
          nullptr,
          false,
          backfill ? &members->thin_bodies : nullptr,
          members->cut_solids->of_particles(),
          force->newton_pair != 0};
}

template <int D, class Complete> FluidParticles PairFSIFluid::gather(double t, Complete complete)
{
  constexpr size_t SIZE = sizeof(Point<D>) / sizeof(double);
  const int nall = atom->nlocal + atom->nghost;
  if (points.size() < nall * SIZE) points.resize(atom->nmax * SIZE);
  auto *const point = reinterpret_cast<Point<D> *>(points.data());
  const auto *const x = vectors(atom->x), *const v = vectors(atom->v);
  const double *const rho = atom->rho, *const rmass = atom->rmass;
  step->for_particles(nall, [=](int i) {
    Point<D> &p = point[i];
    p.place(x[i], v[i], t);
    p.fill(rho[i], rmass[i]);
    complete(i, p);
  });
  return particles_at(points.data());
}

// particles at time n, half a step before atom->x, with what density diffusion reads
template <int D> FluidParticles PairFSIFluid::gather_for_rates(double dth)
{
  double **x = atom->x;
  const int *const type = atom->type, nall = atom->nlocal + atom->nghost;
  double *const *const by_shifting = velocity_of_shifting();
  if (by_shifting)
    for (int d = 0; d < D; d++) ghosts->send(by_shifting[d]);
  const FluidParticles particles = gather<D>(-dth, [&](int i, Point<D> &p) {
    if (by_shifting)
      for (int d = 0; d < D; d++) p.v[d] += by_shifting[d][i];
    p.diffuse(delta, disc->state[type[i]], step->body_forces.of_type[type[i]].data(), x[i][2]);
  });
  // the density of walls is that of the pressures in the last step or setup, which a restart does
  // not know
  if (!step->shifts || !pairs.has_rows_with_walls()) return particles;
  auto *const point = reinterpret_cast<Point<D> *>(points.data());
  for (int i = 0; i < nall; i++)
    if (disc->state[type[i]].species == RIGID)
      point[i].vol = atom->rmass[i] * disc->state[type[i]].inv_rho0;
  return particles;
}

// Positions are those to which the velocities belong: the density leapfrogs from n-1/2 to n+1/2,
// second order in time.
template <int D> void PairFSIFluid::add_density_rate(double dt)
{
  const double dth = 0.5 * dt;
  const int nall = atom->nlocal + atom->nghost;
  const Walls walls = step->walls.moved(-dth);
  const FluidParticles particles = gather_for_rates<D>(dth);
  const bool sums_up = ledger->kept || disc->has_levels();
  if (sums_up) pressure_over_density.resize(atom->nmax);
  if (ledger->kept)
    for (int i = 0; i < nall; i++)
      pressure_over_density[i] = pressure_of(i, atom, *disc, *step) / atom->rho[i];

  RateLaws laws = {delta,   sums_up ? pressure_over_density.data() : nullptr,
                   0.0,     members->wall_shift,
                   fills(), 0.0};
  double *const shift = step->shifts ? step->shift[0] : nullptr;
  PairSums sums;
  pairs.for_rates(walls, particles,
                  [&](const PairSet &set, FluidPairs of_set, double reach, std::vector<Row> *near) {
                    if (shift && fade) {
                      of_set.in.fade = fade;
                      of_set.in.unlike = true;
                    }
                    laws.wdx = set.wdx;
                    laws.reach = reach;
                    set.loops->rates(of_set, laws, rate, shift, ledger->kept ? &sums : nullptr,
                                     near);
                  });
  // Neighbors' rates ride behind the sums of shifting, which are added to memory in fours: of their
  // own they would be one more load, addition and store for each pair of the dearest loop.
  const int row = nshift(), rate_in_row = shift_sums();
  for (int i = 0; shift && i < nall; i++) rate[i] += shift[row * i + rate_in_row];
  ledger->tally(Ledger::DIFFUSION, sums.diffusion);
  ledger->tally(Ledger::WALLS, sums.walls);
}

// as the last loop had it
template <int D> double PairFSIFluid::volume_of(int i) const
{
  return reinterpret_cast<const Point<D> *>(points.data())[i].vol;
}

template <int D, bool FILLS> void PairFSIFluid::displacements(double dt)
{
  double *const *const velocity = velocity_of_shifting();
  const int *const type = atom->type;
  double *const *const sums = step->shift;
  for (int i = 0; i < atom->nlocal; i++) {
    const State &s = disc->state[type[i]];
    if (s.species != FLUID) continue;
    // lattices overshoot from 0.51 h on (theory.rst)
    const double most = std::min(shifting * s.c * dt, 0.5 * s.h);
    Shift<D>::template displacement<FILLS>(sums[i], volume_of<D>(i), most * s.h, 0.25 * most);
    if (velocity && dt > 0.0)
      for (int d = 0; d < D; d++) velocity[d][i] = sums[i][d] / dt;
  }
}

void PairFSIFluid::add_number_density(double *psi, bool solids_too)
{
  pairs.for_all(step->walls, particles_at(nullptr),
                [&](const PairSet &set, const FluidPairs &of_set, int) {
                  const bool both = set.kind == WITH_FLUID || solids_too;
                  set.loops->distances(of_set, both, vectors(atom->x), nullptr, psi);
                });
}

void PairFSIFluid::add_position_divergence(double *div)
{
  std::vector<double> volume(atom->nlocal + atom->nghost);
  for (size_t i = 0; i < volume.size(); i++) volume[i] = atom->rmass[i] / atom->rho[i];
  pairs.for_all(
      step->walls, particles_at(nullptr), [&](const PairSet &set, const FluidPairs &of_set, int) {
        set.loops->distances(of_set, set.kind == WITH_FLUID, vectors(atom->x), volume.data(), div);
      });
}

void PairFSIFluid::add_gradient_sum(double *s)
{
  disc->dim == 2 ? add_gradients<2>(s) : add_gradients<3>(s);
}

// the plain sums of particle shifting, all volumes those of the lattice
template <int D> void PairFSIFluid::add_gradients(double *s)
{
  constexpr int ROW = Shift<D>::row(false);
  const size_t nall = atom->nlocal + atom->nghost;
  const int *const type = atom->type;
  const FluidParticles particles = gather<D>(0.0, [&](int i, Point<D> &p) {
    p.vol = 1.0 / disc->resolution[type[i]].psi_bulk;
  });
  std::vector<double> sums(ROW * nall, 0.0);
  pairs.for_all(step->walls, particles, [&](const PairSet &set, const FluidPairs &of_set, int) {
    set.loops->shifts(of_set, sums.data());
  });
  for (size_t i = 0; i < nall; i++)
    for (int d = 0; d < D; d++) s[d * nall + i] += sums[ROW * i + D + d] / -volume_of<D>(i);
}

// a solid that a plane of symmetry cuts, a wall that slips, has the images of fluids around it, too
void PairFSIFluid::add_velocities_at_solids()
{
  const int dim = disc->dim;
  const auto add = [&](const PairSet &set, const FluidPairs &of_set, int) {
    const Mirror mirror = of_set.mirror ? *of_set.mirror : Mirror();
    if (set.what != PairSet::SOLIDS || !mirror.slips()) return;
    const ChosenKernel kernel(disc->kernel, dim, set.h);
    for (const Row &row : of_set.rows) {
      double x[3], v[3];
      mirror.reflect(atom->x[row.i], x);
      mirror.reflect_velocity(atom->v[row.i], v);
      for (const int *j = row.j; j < row.j + row.n; j++) {
        double rsq = 0.0;
        for (int d = 0; d < dim; d++) rsq += (atom->x[*j][d] - x[d]) * (atom->x[*j][d] - x[d]);
        if (rsq >= kernel.cutsq) continue;
        const double W = kernel.W(std::sqrt(rsq));
        for (int d = 0; d < dim; d++) beyond[*j][d] += W * v[d];
        beyond[*j][dim] += W;
      }
    }
  };
  pairs.for_all(step->walls, particles_at(nullptr), add);
}

// velocity of solids in viscous forces: where fluid would be inside the solid, that with which the
// face has the solid's, 2 v_s - sum v W/sum W, as for walls of particles
void PairFSIFluid::extrapolate_velocities()
{
  const int dim = disc->dim;
  for (int i = 0; i < atom->nlocal; i++) {
    if (disc->state[atom->type[i]].species != SOLID) continue;
    const double *const s = beyond[i], *const v = atom->v[i];
    for (int d = 0; d < dim; d++)
      step->wall_velocity[i][d] = s[dim] > 0.0 ? 2.0 * v[d] - s[d] / s[dim] : v[d];
  }
}

void PairFSIFluid::compute(int eflag, int vflag)
{
  FixFSI::check_pre_no(lmp, disc);
  const Phase phase(step->profile, Profile::FLUID_FORCES);
  ev_init(eflag, vflag);
  check_tally();

  const auto measure = [this](double sign) {
    for (auto *compute : force_computes) compute->tally(sign);
    for (auto *walls : walls_of_particles) walls->tally_fluids(sign);
  };
  measure(-1.0);
  disc->dim == 2 ? compute_forces<2>() : compute_forces<3>();
  measure(1.0);

  if (vflag_fdotr && !step->walls.any()) virial_fdotr_compute();
}

ForceLaws PairFSIFluid::laws_of_forces()
{
  ForceLaws laws;
  laws.alpha = alpha;
  laws.beta = beta;
  laws.laminar = laminar;
  if (laminar == CENTRAL_LAMINAR) laws.central_length_sq = disc->central_length_sq;
  laws.gravity = step->body_forces.of_type.data();
  if (extrapolate) laws.extrapolate = laws.gravity;
  laws.stored = disc->density_solid == Discretization::SUMMATION ? 1.0 : 0.0;
  laws.solids_slip = !sticks_to_solids();
  laws.wall_velocity = vectors(step->wall_velocity ? step->wall_velocity : atom->v);
  if (fix_stress) laws.stress = fix_stress->stress;
  if (ledger->kept) laws.taken = taken.data();
  laws.viscosity = step->viscosity;
  if (implicit) laws.before = vectors(atom->v);
  return laws;
}

// where the last gather() was
void PairFSIFluid::find_viscosities(const FluidParticles &particles, ForceLaws &laws)
{
  Shear &shear = *members->shear;
  const bool found = laminar && shear.varies();
  if (found) shear.find_viscosities(pairs, particles, laws);
  step->viscosity = laws.viscosity = found ? shear.viscosities() : nullptr;
}

const Shear &PairFSIFluid::find_shear()
{
  const auto no_more = [](int, const auto &) {
  };
  disc->dim == 2 ? gather<2>(0.0, no_more) : gather<3>(0.0, no_more);
  members->shear->find_gradients(pairs, particles_at(points.data()), laws_of_forces());
  return *members->shear;
}

// of images: each wall of a reflection has the force along its axis
template <int D>
void PairFSIFluid::add_wall_forces(const Walls::Reflection &s, const double (&total)[D])
{
  for (int d = 0; d < D; d++) step->add_wall_force(step->walls.row().pushed(s, d), d, total[d]);
}

// F_ij = -(p_i V_i^2 + p_j V_j^2 + Q_ij) grad_i W_ij + laminar viscosity (paper eq. 14),
// antisymmetric between fluid and solid:
//   couple wall  both pressures are the fluid's: the solid is a moving wall to the fluid and
//                takes the reaction
//   couple full  the whole stress of the solid crosses, as in the paper
template <int D> void PairFSIFluid::compute_forces()
{
  constexpr int ROW = row_of_forces(D);
  const int *const type = atom->type, nall = atom->nlocal + atom->nghost;
  // newton off, or a hybrid style with solids that need it, or images, which are no particles: like
  // LAMMPS' own walls they do not count in the virial, and forces times positions would have them
  const bool tally_pairs = vflag_fdotr ? step->walls.any() : evflag != 0;
  const bool own_pressure = disc->surface_ratio > 0.0 || step->wall_stiffness;
  forces.resize((size_t) ROW * nall);
  const FluidParticles particles = gather<D>(0.0, [&, none = forces.data()](int i, Point<D> &p) {
    std::fill_n(none + ROW * i, ROW, 0.0);
    p.press(own_pressure ? pressure_of(i, atom, *disc, *step)
                         : disc->state[type[i]].pressure(p.rho));
  });

  if (ledger->kept) taken.assign((size_t) row_of_points(D) * nall, 0.0);
  ForceLaws viscous = laws_of_forces();
  find_viscosities(particles, viscous);
  ForceLaws laws = viscous;
  if (implicit) {    // by itself, when the other forces are there
    laws.laminar = NO_LAMINAR;
    laws.viscosity = nullptr;
  }
  PairSums sums, *const of_pairs = ledger->kept || tally_pairs ? &sums : nullptr;
  double guarding[PairSet::NKINDS] = {};
  pairs.for_all(step->walls, particles, [&](const PairSet &set, const FluidPairs &of_set, int k) {
    const double before = sums.guard;
    double total[D] = {};
    laws.guard = guards[set.level].data();
    set.of_forces->forces(of_set, laws, forces.data(), total, of_pairs);
    guarding[set.what] += sums.guard - before;
    if (of_set.mirror) add_wall_forces(step->walls.reflections[k], total);
  });
  if (implicit) add_implicit_viscosity<D>(particles, viscous, of_pairs);
  split_forces<D>(particles, viscous);
  pairs.forget_near();    // a second force evaluation at other positions must not use these lists

  // LAMMPS sends what ghosts have home even without newton_pair, if newton_bond is on
  auto *const f = vectors(atom->f);
  const double *const found = forces.data();
  step->for_particles(force->newton_pair ? nall : atom->nlocal, [=](int i) {
    for (int d = 0; d < D; d++) f[i][d] += found[ROW * i + d];
  });
  ledger->tally(Ledger::ARTIFICIAL, sums.artificial);
  ledger->tally(Ledger::LAMINAR, sums.laminar);
  ledger->tally(Ledger::COUPLING, sums.coupling);
  ledger->tally(Ledger::WALLS, sums.walls);
  ledger->guarding[0] = guarding[PairSet::WALLS];
  ledger->guarding[1] = guarding[PairSet::SOLIDS];
  if (tally_pairs && (vflag_global || vflag_fdotr))
    for (int k = 0; k < 6; k++) virial[k] += sums.virial[k];
}

// Viscous forces alone, of which bodies only those on them if so: the same loops without pressures,
// guard and stress
template <int D>
void PairFSIFluid::add_viscous_forces(const FluidParticles &particles, ForceLaws laws,
                                      bool on_bodies, PairSums *sums)
{
  constexpr int ROW = row_of_forces(D);
  const int nall = atom->nlocal + atom->nghost;
  auto *const point = reinterpret_cast<Point<D> *>(points.data());
  for (int i = 0; i < nall; i++) point[i].p = point[i].pv2 = 0.0;
  const std::vector<Contact> no_guards(atom->ntypes + 1, Contact(D, 0.0));
  laws.guard = no_guards.data();
  laws.extrapolate = laws.gravity = nullptr;
  laws.taken = nullptr;
  laws.stress = nullptr;
  viscous_forces.assign((size_t) ROW * nall, 0.0);
  pairs.for_all(step->walls, particles, [&](const PairSet &set, const FluidPairs &of_set, int k) {
    if (on_bodies && set.kind == WITH_FLUID) return;
    double total[D] = {};
    set.of_forces->forces(of_set, laws, viscous_forces.data(), total, sums);
    if (of_set.mirror && !on_bodies) add_wall_forces(step->walls.reflections[k], total);
  });
}

// for those who ask for them, forces of viscosity on solids and walls
template <int D>
void PairFSIFluid::split_forces(const FluidParticles &particles, const ForceLaws &laws)
{
  if (std::none_of(force_computes.begin(), force_computes.end(), [](const auto *measure) {
        return measure->split;
      }))
    return;
  add_viscous_forces<D>(particles, laws, true, nullptr);
  for (auto *measure : force_computes)
    if (measure->split) measure->tally_viscosity(viscous_forces.data(), row_of_forces(D));
}

// those of the velocities that it leaves at the end of the step
template <int D>
void PairFSIFluid::add_implicit_viscosity(const FluidParticles &particles, ForceLaws laws,
                                          PairSums *sums)
{
  constexpr int ROW = row_of_forces(D);
  std::vector<double> others = forces;
  ghosts->add(others.data(), ROW);
  const std::vector<double> &w =
      members->implicit->solve(pairs, particles, laws, others.data(), ROW);
  auto *const point = reinterpret_cast<Point<D> *>(points.data());
  for (size_t i = 0; i < w.size() / D; i++)
    for (int d = 0; d < D; d++) point[i].v[d] = w[D * i + d];
  laws.alpha = laws.beta = 0.0;
  add_viscous_forces<D>(particles, laws, false, sums);
  const int nall = atom->nlocal + atom->nghost, counted = force->newton_pair ? nall : atom->nlocal;
  double late = 0.0;    // the work is that of the mean velocity of the step
  for (int i = 0; i < nall; i++)
    for (int d = 0; d < D; d++) {
      forces[ROW * i + d] += viscous_forces[ROW * i + d];
      if (i < counted && particles.state[particles.type[i]].species == FLUID)
        late += 0.5 * viscous_forces[ROW * i + d] * (w[D * i + d] - atom->v[i][d]);
    }
  ledger->tally(Ledger::LAMINAR, late);
}

bool PairFSIFluid::has_solids() const
{
  for (const auto &m : material)
    if (m.species == SOLID) return true;
  return false;
}

std::vector<PairFSI::Effect> PairFSIFluid::effects() const
{
  auto list = keywords.effects();
  list.push_back({fmt::format("coupling of fluid and solid: {}{}", coupling_names[couple],
                              extrapolate ? ", extrapolated" : ""),
                  "couple", has_solids()});
  if (shifting > 0.0 && shift_every > 1)
    list.push_back({fmt::format("shifted every {} steps", shift_every), "shift/every", true});
  if (disc && disc->has_thin())
    list.push_back(
        {"line of sight: thin bodies hide fluids from each other", "fix fsi thin", true});
  list.push_back({"no slip at solids", "solid/slip no", sticks_to_solids()});
  return list;
}

double PairFSIFluid::memory_usage()
{
  return fields.memory_usage() + pairs.memory_usage() + members->cut_solids->memory_usage() +
      members->shear->memory_usage() + members->implicit->memory_usage() +
      bytes_of(points, forces, viscous_forces, pressure_over_density) +
      (disc && disc->sight ? disc->sight->memory_usage() : 0.0);
}
