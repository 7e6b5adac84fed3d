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

#include "fsi_check.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "fsi_gather.h"
#include "fsi_hub.h"
#include "fsi_keywords.h"
#include "fsi_lammps_access.h"
#include "fsi_pack.h"
#include "fsi_part.h"
#include "fsi_record.h"
#include "fsi_refusals.h"
#include "modify.h"
#include "neighbor.h"
#include "output.h"
#include "thermo.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

using namespace LAMMPS_NS;
using namespace FSI;

static constexpr int EVERY = 10;    // steps from one close look to the next; and at each list build
// A body may move as a whole, faster than its waves; one that blows up passes this in a step or two
static constexpr double SOLID_OVER_FLUID = 10.0;
static constexpr int BLOCK = 256;
static constexpr int FIXED = 1;    // face of the box: LAMMPS loses what leaves it
static constexpr double COMPRESSED =
    1.2;    // density over that at rest: Mach numbers of the limit make it in head-on impacts
// Of densities, relative to those at rest: their standard deviation where the pressure changes
// linearly by 0.1 rho c^2. An impact has so much in few particles only.
static constexpr double SOFT = 0.03;

// Is no number of these larger than that? A comparison that NaN fails. In a form that compilers
// turn into vector instructions.
static bool all_below(int n, const double *a, double most)
{
  static const bool packed = have_packs();
  int64_t any = 0;
  const auto look = [=, &any](auto) FSI_INLINE_LAMBDA {
    int64_t above = 0;
    const int64_t yes = 0, no = -1;    // as wide as a number
    for (int k = 0; k < n; k++) above |= std::abs(a[k]) <= most ? yes : no;
    any = above;
  };
  packed ? run_loop<Pack>(look) : run_loop<double>(look);
  return !any;
}

Check::Check(LAMMPS *lmp, const Discretization &disc, const StepState &step,
             const std::vector<Part *> &parts) :
    Pointers(lmp),
    disc(disc), step(step), stop(lmp, "Fix fsi", disc, step, parts)
{
}

void Check::before_init()
{
  if (update->whichflag == 2)
    error->all(FLERR,
               "Fix fsi does not support minimize: there is no energy of all particles; run with "
               "fix viscous or artificial/visc to a state of rest");
  if (utils::strmatch(update->integrate_style, "^respa"))
    error->all(FLERR, "Fix fsi does not support run_style respa");
  const Facts solids = facts_of_solids(lmp);
  const bool fluid = facts_of_fluids(lmp).style;
  if (fluid || solids.by_rate)
    for (const auto *fix : modify->get_fix_list())
      if (fix->box_change & ~(Fix::BOX_CHANGE_ANY | Fix::BOX_CHANGE_DOMAIN))
        refuse(error, Refused::DEFORM, fix->id, fix->style);
  if (neighbor->includegroup) refuse(error, Refused::INCLUDE);
  if (fluid && neighbor->build_once) refuse(error, Refused::ONCE);
  if (has_reduced_ghosts(comm)) refuse(error, Refused::REDUCED_GHOSTS);
  if (atom->ellipsoid_flag || atom->line_flag || atom->tri_flag || atom->body_flag)
    refuse(error, Refused::SHAPES);
  if (utils::strmatch(force->pair_style, "^hybrid/scaled")) refuse(error, Refused::SCALED);
  if (force->ftm2v != 1.0)
    error->all(FLERR,
               "Fix fsi does not support units {}, in which force is not mass times acceleration: "
               "expected lj, si, cgs, micro or nano",
               update->unit_style);
  if (update->dt < 0.0) error->all(FLERR, "Fix fsi: timestep {} must be >= 0", update->dt);
  if (comm->cutghostuser > 0.0 && comm->cutghostuser < disc.largest_cut)
    error->all(FLERR, "Kernel support {} of fix fsi is larger than the comm_modify cutoff {}",
               disc.largest_cut, comm->cutghostuser);
  if (domain->triclinic) refuse(error, Refused::TRICLINIC);

  const bool solid_tl = solids.style == Facts::OF_TOTAL_LAGRANGIAN_SOLIDS;
  if (!solids.style && !fluid)
    error->all(FLERR, "Fix fsi requires pair_style fsi/fluid, fsi/solid or fsi/solid/tl");
  if (step.substeps > 1 && !solid_tl) refuse(error, Refused::SUBSTEPS);
  if (solid_tl && disc.density_solid != Discretization::CONTINUITY)
    refuse(error, Refused::SUMS_OF_SOLIDS);
}

void Check::materials()
{
  int walls = 0;    // bits of their groups
  for (const auto *fix : modify->get_fix_list()) {
    const auto *const part = dynamic_cast<const Part *>(fix);
    if (part && part->facts().particle_walls) walls |= fix->groupbit;
  }
  for (int i = 0; i < atom->nlocal; i++)
    if (disc.state[atom->type[i]].species == RIGID && !(atom->mask[i] & walls))
      error->one(FLERR, "Atom {} of type {} is of a wall, but in no fix fsi/wall/particle",
                 atom->tag[i], atom->type[i]);
  compare_densities();
  spacings();
  thin_bodies();
  if (update->whichflag) held_parts();    // who moves it may come after fsi/set
  integrators();
}

// Another material for particles that have a mass: it stays that of their lattice with the
// density of before. (Fix FSI_REFERENCE looks at total-Lagrangian solids itself.)
void Check::compare_densities()
{
  densities.resize(atom->ntypes + 1, 0.0);
  for (int i = 0; i < atom->nlocal; i++) {
    const int t = atom->type[i];
    const State &s = disc.state[t];
    const bool same = densities[t] == 0.0 || densities[t] == s.rho0;
    if (same || atom->rmass[i] == 0.0 || s.form == TOTAL_LAGRANGIAN) continue;
    error->one(
        FLERR,
        "Atom {} of type {} has the mass of a material of density {:g}, but that of its type "
        "has {:g} now: make the particles anew",
        atom->tag[i], t, densities[t], s.rho0);
  }
  for (int t = 1; t <= atom->ntypes; t++)
    if (disc.state[t].species != NONE) densities[t] = disc.state[t].rho0;
}

// A particle has the volume of its cell, or one that fsi/set gave. A mass by a command of LAMMPS,
// or that of another type, may be that of no material.
void Check::compare_masses()
{
  constexpr double FACTOR = 1.8, ROUND = 1.0 + 1.0e-9;    // levels: half the volume
  masses.resize(2 * (atom->ntypes + 1), -OFF);
  for (int i = 0; i < atom->nlocal; i++) {
    const int t = atom->type[i];
    const State &s = disc.state[t];
    const double m = atom->rmass[i], cell = std::pow(disc.dx_of(t), disc.dim);
    if (s.species == NONE) continue;
    const auto fits = [=](double rho) {
      return m < FACTOR * rho * cell && m * FACTOR > rho * cell;
    };
    const bool known = m <= ROUND * masses[2 * t] && -m * ROUND <= masses[2 * t + 1];
    if (fits(s.rho0) || (s.species == FLUID && fits(atom->rho[i])) || known || !std::isfinite(m))
      continue;
    error->one(FLERR,
               "Atom {} of type {} has the mass {:g}, a volume of {:g} with its material, but its "
               "cell has {:g}: expected materials and types as they were when masses were made, or "
               "other volumes by fsi/set volume",
               atom->tag[i], t, m, m / s.rho0, cell);
  }
  know_masses();
}

void Check::know_masses()
{
  masses.assign(2 * (atom->ntypes + 1), -OFF);
  for (int i = 0; i < atom->nlocal; i++) {
    double *const of_type = &masses[2 * atom->type[i]];
    of_type[0] = std::max(of_type[0], atom->rmass[i]);
    of_type[1] = std::max(of_type[1], -atom->rmass[i]);
  }
  masses = over_ranks(masses, MPI_MAX, world);
}

void Check::write(Record &record) const
{
  record.add("densities", densities);
  record.add("masses", masses);
}

void Check::read(const Record &record)
{
  if (record.has("densities")) densities = record.numbers("densities");
  if (record.has("masses")) masses = record.numbers("masses");
}

// A part of a body that has a velocity, but that nothing moves, strains the rest of it for ever.
// (A whole body is a surface that drags fluid along.)
void Check::held_parts() const
{
  std::set<tagint> bodies;
  std::vector<int> suspects;
  for (int i = 0; i < atom->nlocal; i++) {
    if (disc.state[atom->type[i]].species != SOLID) continue;
    const double *const v = atom->v[i];
    if (is_moved(i, lmp))
      bodies.insert(atom->molecule[i]);
    else if (v[0] != 0.0 || v[1] != 0.0 || v[2] != 0.0)
      suspects.push_back(i);
  }
  const auto moving = gather(bodies, world);
  for (const int i : suspects)
    if (moving.count(atom->molecule[i])) {
      const double *const v = atom->v[i];
      error->one(FLERR,
                 "Atom {} of a solid has the velocity {:g} {:g} {:g}, but neither fix fsi nor "
                 "another fix moves it: it would strain its body "
                 "{} without end. Set it to 0, or let a fix move it",
                 atom->tag[i], v[0], v[1], v[2], atom->molecule[i]);
    }
}

static bool moves_as_a_whole(const Fix *fix)
{
  for (const char *style : {"^rigid", "^poems", "^move", "^python/move", "^nve/noforce"})
    if (utils::strmatch(fix->style, style)) return true;
  return false;
}

// Another integrator of what fix fsi moves: it would move twice in a step. One of a wall that does
// not move it as a whole: nothing holds its particles together
void Check::integrators() const
{
  for (const auto &fix : modify->get_fix_list()) {
    if (!fix->time_integrate || utils::strmatch(fix->style, "^fsi")) continue;
    if (!moves_as_a_whole(fix)) {
      const auto apart = find_particles(atom, world, [&](int i) {
        return disc.state[atom->type[i]].species == RIGID && atom->mask[i] & fix->groupbit;
      });
      if (apart.count)
        error->all(FLERR,
                   "Fix {} (style {}) would take each of {} wall particles, the first of them atom "
                   "{}, its own way: move walls with fix fsi/move or fix rigid",
                   fix->id, fix->style, apart.count, apart.first);
    }
    const auto twice = find_particles(atom, world, [&](int i) {
      return atom->mask[i] & disc.mover->groupbit && atom->mask[i] & fix->groupbit;
    });
    if (twice.count)
      error->all(FLERR,
                 "Fix {} (style {}) and fix {} (style fsi) both move {} particles, the first of "
                 "them atom {}: leave out one of the two for them",
                 fix->id, fix->style, disc.mover->id, twice.count, twice.first);
  }
}

// The coarsest fluid's spacing is dx. Bodies and walls meet fluids with the fluid's kernel: they
// may be coarser as long as its support holds so many of their spacings. With fewer it tells their
// particles one by one (theory.rst). Which of several fluids they meet is seen at the start.
void Check::spacings() const
{
  constexpr double FINEST = 4.0, COARSEST = 2.0, HELD = 1.5, ROUND = 1.0 + 1.0e-6;
  const Facts fluid = facts_of_fluids(lmp);
  for (int t = 1; t <= atom->ntypes; t++) {
    const double of_type = disc.dx_of(t), dx = disc.dx, finest = disc.levels.back().dx;
    const State &s = disc.state[t];
    if (of_type == dx || s.species == NONE) continue;
    const auto what = fmt::format("Fix fsi spacing {:g} of type {}", of_type, t);
    if (s.species == FLUID) {
      if (of_type > dx)
        error->all(FLERR, "{}, a fluid: dx, {:g}, is to be that of the coarsest fluid", what, dx);
      fluid_spacings(of_type, t);
      continue;
    }
    if (s.form == UPDATED_LAGRANGIAN) refuse(error, Refused::SPACING_UPDATED, of_type, t);
    if (disc.density_solid != Discretization::CONTINUITY)
      refuse(error, Refused::SPACING_DENSITY, of_type, t);
    if (!fluid.style) continue;
    if (of_type > ROUND * std::min(COARSEST * dx, disc.cut / HELD))
      error->all(FLERR,
                 "{} is {:.3g} times coarser than the fluid's dx {:g}: expected {:g} at most, and "
                 "the kernel's support, {:g}, to be {:g} of its "
                 "spacings",
                 what, of_type / dx, dx, COARSEST, disc.cut, HELD);
    if (ROUND * FINEST * of_type < finest)
      error->all(FLERR, "{} is {:.3g} times finer than the fluid's dx {:g}: expected {:g} at most",
                 what, finest / of_type, finest, FINEST);
    if (fluid.couples_stress) refuse(error, Refused::SPACING_COUPLE, of_type, t);
  }
}

// what one lattice alone has a number density for
void Check::fluid_spacings(double dx, int t) const
{
  const Facts fluid = facts_of_fluids(lmp);
  if (disc.density_fluid != Discretization::CONTINUITY)
    refuse(error, Refused::SPACING_FLUIDS, dx, t);
  if (disc.density_solid == Discretization::SUMMATION)
    refuse(error, Refused::SPACING_SOLIDS, dx, t);
  if (fluid.density_at_surfaces) refuse(error, Refused::SPACING_SURFACES, dx, t);
  if (fluid.couples_stress) refuse(error, Refused::SPACING_FLUIDS_COUPLE, dx, t);
}

void Check::thin_bodies() const
{
  const bool standard = disc.density_fluid == Discretization::CONTINUITY &&
      disc.density_solid == Discretization::CONTINUITY;
  for (int t = 1; t <= atom->ntypes; t++) {
    const int species = disc.state[t].species;
    if (disc.thin[t] == 0.0 || species == NONE) continue;
    if (species == FLUID)
      error->all(
          FLERR,
          "Fix fsi thin {}: atom type {} is a fluid, expected a solid or a wall of particles", t,
          t);
    if (!standard) refuse(error, Refused::THIN_DENSITY, t);
    if (facts_of_fluids(lmp).couples_stress) refuse(error, Refused::THIN_COUPLE, t);
  }
}

void Check::init()
{
  const auto before = limit_sq;
  limit_sq.assign(atom->ntypes + 1, HUGE_SQUARE);
  dense.assign(atom->ntypes + 1, OFF);
  for (int t = 1; t <= atom->ntypes; t++) {
    const State &s = disc.state[t];
    if (s.species == FLUID) dense[t] = COMPRESSED * s.rho0;
    if (disc.mach == OFF || (s.species != FLUID && s.species != SOLID)) continue;
    const double most = disc.mach * (s.species == SOLID ? SOLID_OVER_FLUID : 1.0);
    limit_sq[t] = most * most * s.wave_speed_sq();
  }
  // |v + dv| is below a limit if components of v are below 0.9, of dv below 0.1, of it over root 3
  const double component = std::sqrt(*std::min_element(limit_sq.begin() + 1, limit_sq.end()) / 3.0);
  calm_speed = 0.9 * component;
  calm_kick = 0.1 * component;

  // once, and again for another sound: run ... every begins many runs
  if (limit_sq != before) warned_dense = warned_soft = false;
  densest = {};
  deviations.assign(2 * dense.size(), 0.0);

  found = {};
  for (int i = 0; i < atom->nlocal; i++) enter(stop.not_finite(i, false));
  judge(Stop::BEFORE);
}

void Check::setup()
{
  compare_masses();    // after all that know more of some
  look(true, 0.0);
  judge(Stop::START);
}

// LAMMPS would say that a position is not finite, or that an atom is lost, but not which. (What
// leaves by an open end is deleted within the box.)
void Check::positions()
{
  const bool keeps = output->thermo->lostflag == Thermo::ERROR;
  double lo[3], hi[3];
  for (int d = 0; d < 3; d++) {
    lo[d] = keeps && domain->boundary[d][0] == FIXED ? domain->boxlo[d] : -OFF;
    hi[d] = keeps && domain->boundary[d][1] == FIXED ? domain->boxhi[d] : OFF;
  }
  const auto *const x = vectors(atom->x);
  found = {};
  const auto outside = step.those(atom->nlocal, [&](int i) {
    bool in = true;
    for (int d = 0; d < 3; d++) in = in && x[i][d] >= lo[d] && x[i][d] < hi[d];
    return !in;    // nor what is not a number
  });
  for (const int i : outside) {
    const Finding wrong = stop.not_finite(i, false);
    enter(wrong.tag ? wrong : stop.finding(LOST, i, 1.0));
  }
  judge(Stop::DRIFTED);
}

// Positions of local and ghost atoms are those of the middle of the step, velocities those of its
// start, and both can be brought back. Forces are looked at in each step, what follows from them
// every few: what the kicks between two looks add up to is finite. (Stress that is not finite makes
// forces that are not, too; a position does not, since pairs do not see each other any more.)
void Check::before_kick()
{
  look(neighbor->ago == 0 || update->ntimestep % EVERY == 0, update->dt * force->ftm2v);
  if (step.substeps == 1) judge(Stop::MIDDLE);
}

// sub-steps may take solids anywhere: keep a state to go back to before the fluid is kicked
void Check::before_substeps(const std::vector<int> &solids)
{
  substepped = &solids;
  kept.resize(6 * solids.size());
  const auto *const x = vectors(atom->x), *const v = vectors(atom->v);
  double *to = kept.data();
  for (const int i : solids) {
    to = std::copy_n(x[i], 3, to);
    to = std::copy_n(v[i], 3, to);
  }
}

void Check::after_substeps()
{
  const auto *const v = vectors(atom->v);
  const int *const type = atom->type;
  for (const int i : *substepped)
    if (!(v[i][0] * v[i][0] + v[i][1] * v[i][1] + v[i][2] * v[i][2] <= limit_sq[type[i]]))
      examine(i, 0.0);
  inside_out();
  judge(Stop::MIDDLE);
}

// blocks of particles in which all is small are passed over
void Check::look(bool closely, double kick)
{
  const int n = atom->nlocal;
  found = {};
  if (n == 0) return;
  if (closely && step.device) step.device->to_host();
  const double *const x = atom->x[0], *const v = atom->v[0], *const f = atom->f[0],
                      *const rho = atom->rho;
  if (closely) lightest = *std::min_element(atom->rmass, atom->rmass + n);
  const double force = kick > 0.0 ? std::min(OFF, calm_kick * lightest / kick) : OFF;
  const bool all_calm = step.device && step.device->is_calm(closely, force, calm_speed);
  if (step.device && !all_calm) step.device->to_host();
  const auto wild = step.those(all_calm ? 0 : (n + BLOCK - 1) / BLOCK, [=](int block) {
    const int i = BLOCK * block, m = std::min(BLOCK, n - i);
    const bool calm = all_below(3 * m, f + 3 * i, force) &&
        (!closely ||
         (all_below(3 * m, v + 3 * i, calm_speed) && all_below(3 * m, x + 3 * i, OFF) &&
          std::all_of(rho + i, rho + i + m, [](double r) {
            return r > 0.0 && r < OFF;
          })));
    return !calm;
  });
  for (const int block : wild)
    for (int i = BLOCK * block; i < std::min(n, BLOCK * (block + 1)); i++) examine(i, kick);
  inside_out();
  if (closely && !(warned_dense && warned_soft)) look_at_densities();
}

// What is pressed together far more than sound allows for is no fluid of this method: a pressure
// in wrong units, two inlets against each other, a force that holds particles where others come; or
// sound that is too slow for the pressures. It goes on, but not without a word.
void Check::look_at_densities()
{
  struct Look {
    std::vector<double> sums;
    double most = 1.0;
    int at = -1;
  };
  const double *const rho = atom->rho;
  const auto parts = step.in_parts(atom->nlocal, [&](int first, int last) {
    Look here;
    here.sums.assign(deviations.size(), 0.0);
    for (int i = first; i < last; i++) {
      const int t = atom->type[i];
      if (dense[t] == OFF) continue;
      const double beyond = rho[i] * (COMPRESSED / dense[t]) - 1.0;
      // torn fluid without tension has any density
      if (beyond > 0.0 || disc.state[t].floor < 0.0) here.sums[2 * t] += beyond * beyond;
      here.sums[2 * t + 1] += 1.0;
      if (rho[i] <= here.most * dense[t]) continue;
      here.most = rho[i] / dense[t];
      here.at = i;
    }
    return here;
  });
  densest = {};
  std::fill(deviations.begin(), deviations.end(), 0.0);
  double most = 1.0;
  for (const auto &[first, part] : parts) {
    for (size_t k = 0; k < deviations.size(); k++) deviations[k] += part.sums[k];
    if (part.most <= most) continue;
    most = part.most;
    densest = stop.finding(DENSITY, part.at, rho[part.at]);
  }
}

bool Check::any_soft() const
{
  for (size_t k = 0; k < deviations.size() && !warned_soft; k += 2)
    if (deviations[k] > SOFT * SOFT * deviations[k + 1]) return true;
  return false;
}

// where it holds for the particles of all ranks
void Check::warn_of_sound()
{
  const auto all = over_ranks(deviations, MPI_SUM, world);
  std::fill(deviations.begin(), deviations.end(), 0.0);    // until the next look
  for (size_t t = 0; t < dense.size() && !warned_soft; t++) {
    const double square = all[2 * t + 1] > 0.0 ? all[2 * t] / all[2 * t + 1] : 0.0;
    if (square <= SOFT * SOFT) continue;
    warned_soft = true;
    const double c = disc.state[t].c, p = std::sqrt(12.0 * square);    // over rho c^2
    if (comm->me == 0)
      error->warning(FLERR,
                     "Fix fsi: densities of the fluid of type {} differ from that at rest by "
                     "{:.2g} % (standard deviation) at step {}: its pressures are too large for "
                     "the speed of sound {:g}. Expected sound {:.2g}, 10 times sqrt(p/rho)",
                     t, 100.0 * std::sqrt(square), update->ntimestep, c, 10.0 * std::sqrt(p) * c);
  }
}

void Check::warn_of_density()
{
  const Finding worst =
      stop.worst(densest, densest.tag ? densest.value / dense[densest.type] : 0.0);
  warned_dense = warned_soft = true;
  const double rest = dense[worst.type] / COMPRESSED;
  if (comm->me == 0)
    error->warning(FLERR,
                   "Fix fsi: fluid atom {} (type {}) at {} has {:.3g} times its "
                   "density at rest, {:g}, at step {}: fluids are to be compressed by a few per "
                   "cent at most. Look at the pressures and velocities that are given, at forces "
                   "that hold particles, and at sound",
                   worst.tag, worst.type, place_text(worst.x), worst.value / rest, rest,
                   update->ntimestep);
}

void Check::inside_out()
{
  if (step.inverted >= 0) enter(stop.finding(DENSITY, step.inverted, step.inverted_density));
}

void Check::examine(int i, double kick)
{
  const double *const v = atom->v[i], *const f = atom->f[i];
  const State &s = disc.state[atom->type[i]];
  const double rho = atom->rho[i];
  const bool kicked =
      (atom->mask[i] & disc.mover->groupbit) && (step.substeps == 1 || s.species != SOLID);
  const double k = kicked ? kick / atom->rmass[i] : 0.0;
  const double a = v[0] + k * f[0], b = v[1] + k * f[1], c = v[2] + k * f[2];
  const double vsq = a * a + b * b + c * c;    // not a number if a force is not
  const double *const x = atom->x[i];
  // torn fluid without tension has no pressure, whatever its density: spray whose density says
  // nothing until it comes together
  const bool torn = s.species == FLUID && s.floor == 0.0 && pressure_of(i, atom, disc, step) == 0.0;
  if (vsq <= limit_sq[atom->type[i]] && rho > 0.0 && rho < OFF && std::isfinite(x[0] + x[1] + x[2]))
    return;
  const Finding lost = stop.not_finite(i, true);
  if (lost.tag)
    enter(lost);
  else if (!(vsq < HUGE_SQUARE) || !(rho < OFF)) {
    Finding large = stop.finding(FINITE, i, vsq < HUGE_SQUARE ? rho : vsq);
    large.field = vsq < HUGE_SQUARE ? Stop::MASS_DENSITY : Stop::VELOCITY;
    enter(large);
  } else if (rho <= 0.0 && !torn)
    enter(stop.finding(DENSITY, i, rho));
  else if (vsq > limit_sq[atom->type[i]] && (s.species == FLUID || s.species == SOLID))
    enter(stop.finding(MACH, i, std::sqrt(vsq / s.wave_speed_sq())));
}

// what is not finite comes first
static double weight_of(const Finding &f)
{
  if (!f.tag) return 0.0;
  return f.trouble == FINITE ? 3.0e200
      : f.trouble == DENSITY ? 2.0e200
                             : std::min(f.value, 1.0e200);
}

void Check::enter(const Finding &other)
{
  if (weight_of(other) > weight_of(found)) found = other;
}

// by which a place is outside of the box
std::string Check::face_of(const double *x) const
{
  for (int d = 0; d < 3; d++) {
    const double lo = domain->boxlo[d], hi = domain->boxhi[d];
    if (domain->periodicity[d] || (x[d] >= lo && x[d] < hi)) continue;
    return fmt::format("{}{} at {:g}", "xyz"[d], x[d] < lo ? "lo" : "hi", x[d] < lo ? lo : hi);
  }
  return "";
}

// all ranks stop together
void Check::judge(Stop::When when)
{
  enum { CALM, PRESSED, DENSE, LOST_MEANING };
  const int here = found.tag         ? LOST_MEANING
      : densest.tag && !warned_dense ? DENSE
      : any_soft()                   ? PRESSED
                                     : CALM;
  const int all = over_ranks(here, MPI_MAX, world);
  if (all == PRESSED) warn_of_sound();
  if (all == DENSE) warn_of_density();
  if (all != LOST_MEANING) return;
  // back to before the sub-steps, if there were any
  if (when == Stop::MIDDLE && step.substeps > 1) {
    const double *from = kept.data();
    for (const int i : *substepped) {
      std::copy_n(from, 3, atom->x[i]);
      std::copy_n(from + 3, 3, atom->v[i]);
      from += 6;
    }
  }
  const Finding worst = stop.worst(found, weight_of(found));
  std::string what;
  if (worst.trouble == DENSITY) what = fmt::format("density {:.4g} is not above 0", worst.value);
  if (worst.trouble == MACH)
    what =
        fmt::format("Mach number {:.4g} is above the limit {:g}", worst.value,
                    disc.mach * (disc.state[worst.type].species == SOLID ? SOLID_OVER_FLUID : 1.0));
  if (worst.trouble == LOST)
    what = "particle leaves the box through its fixed face " + face_of(worst.x);
  stop.stop(stop.describe(what, worst, when), worst, when);
}
