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

#include "fix_fsi_dt.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "fix_fsi.h"
#include "force.h"
#include "fsi_find.h"
#include "fsi_gather.h"
#include "fsi_hub.h"
#include "fsi_keywords.h"
#include "fsi_limits.h"
#include "fsi_record.h"
#include "fsi_refusals.h"
#include "group.h"
#include "modify.h"
#include "output.h"
#include "pair.h"
#include "timer.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace FSI;

static constexpr double BIG = Limits::UNLIMITED;
static constexpr int NLIMIT = Limits::NLIMIT, MAXSUBSTEPS = 1000;
enum Cause { MAXIMUM = NLIMIT, GROWTH };      // beyond the limits
static constexpr double ROUNDING = 1.0e-9;    // of the time left, in steps
static constexpr double PRINT =
    0.95;    // causes whose limits differ by less than this are not worth a line each

FixFSIDt::FixFSIDt(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), keywords(lmp, "fix fsi/dt"), limits(new Limits(lmp)), target(BIG),
    cause(MAXIMUM)
{
  if (!atom->style_match("fsi")) error->all(FLERR, "Fix fsi/dt requires atom_style fsi");
  keywords.argument("interval").integer(interval, 1, 1);
  keywords.key("cfl").number(cfl, 0.0, Range::above(0.0));
  keywords.key("cfl/fluid").number(of_fluid, 0.0, Range::above(0.0));
  keywords.key("cfl/solid").number(of_solid, 0.0, Range::above(0.0));
  keywords.key("min").number(low, 0.0, Range::above(0.0));
  keywords.key("max").number(high, BIG, Range::above(0.0));
  keywords.key("growth").number(growth, 1.1, Range::above(1.0));
  keywords.key("substeps").choice(automatic, 0, {"keep", "auto"});
  keywords.key("stop").number(end, BIG, Range::above(0.0)).of_a_run();
  keywords.key("check").choice(check, NO_CHECK, {"no", "warn", "error"});
  keywords.parse(narg - 3, arg + 3);
  if (of_fluid == 0.0) of_fluid = cfl > 0.0 ? cfl : Limits::FLUID_FACTOR;
  if (of_solid == 0.0) of_solid = cfl > 0.0 ? cfl : Limits::SOLID_FACTOR;
  if (low >= high) error->all(FLERR, "Fix fsi/dt min {} must be below max {}", low, high);
  if (automatic && check) refuse(error, Refused::CHECK_SUBSTEPS);
  if (end < BIG && check) refuse(error, Refused::CHECK_STOP);

  nevery = end < BIG ? 1 : interval;
  limit.assign(NLIMIT, BIG);
  scalar_flag = vector_flag = 1;
  size_vector = NLIMIT + 2;
  extscalar = extvector = 0;
  global_freq = 1;
  dynamic_group_allow = 1;
  time_depend = restart_global = check == NO_CHECK;
}

FixFSIDt::~FixFSIDt() = default;

void FixFSIDt::stop_at(double time)
{
  if (check) refuse(error, Refused::CHECK_STOP);
  end = time;
  nevery = 1;
}

void FixFSIDt::init()
{
  auto *const fix_fsi = FixFSI::find(lmp, "Fix fsi/dt")->link(disc, step);
  if (fixes_of<FixFSIDt>(lmp).size() > 1) error->all(FLERR, "There can be only one fix fsi/dt");
  if (update->dt <= 0.0 || update->dt >= BIG)
    error->all(FLERR, "Fix fsi/dt: timestep {} must be > 0 and below {:g}", update->dt, BIG);
  if (check) return;
  if (!modify->get_fix_by_style("^dt/reset$").empty()) refuse(error, Refused::RESET_STEP);
  for (auto &fix : modify->get_fix_by_style("^move$"))
    refuse(error, Refused::MOVE_STEP, fix->id, fix->style);
  // the time step changes when fix fsi begins its step: what moves earlier would take the old one
  for (auto &fix : modify->get_fix_list()) {
    if (fix == fix_fsi) break;
    if (modify->get_fix_mask(fix) & INITIAL_INTEGRATE)
      refuse(error, Refused::STEP_ORDER, fix->id, fix->style, fix_fsi->id);
  }
  if (restored) {
    // whatever a timestep command between read_restart and here has said
    dt = std::min(dt, high);
    next_dt = std::min(next_dt, high);
    set_step(dt, this);    // who was asked before has taken the other one
    fix_fsi->clock.restore();
  }
}

// pair styles, and fixes before that one, hear of it
void FixFSIDt::set_step(double dt, const Fix *before) const
{
  update->update_time();
  update->dt = dt;
  update->dt_default = 0;
  if (force->pair) force->pair->reset_dt();
  for (auto &fix : modify->get_fix_list()) {
    if (fix == before) break;
    fix->reset_dt();
  }
}

// The first run, or one for which the script gave another time step, begins with the limits.
// Others go on with what was chosen before: two runs are one, and so is a restarted one.
void FixFSIDt::setup(int)
{
  const bool go_on = restored || (dt > 0.0 && update->dt == dt);
  restored = false;
  if (!go_on) {
    find_outside();
    // down at once; up only where no time step was given
    find_limits(update->dt_default ? BIG : update->dt);
  }
  if (end < BIG) approach_end();
}

// particles that move, but do not limit the step
void FixFSIDt::find_outside() const
{
  const auto outside = [&](int i, int species) {
    return !(atom->mask[i] & groupbit) && (atom->mask[i] & disc->mover->groupbit) &&
        disc->state[atom->type[i]].species == species;
  };
  const auto found = find_particles(atom, world, [&](int i) {
    return outside(i, FLUID) || outside(i, SOLID);
  });
  if (found.count == 0) return;
  const auto text = fmt::format(
      "Fix fsi/dt: {} particles that fix {} moves, the first of them atom {}, are not in group {}",
      found.count, disc->mover->id, found.first, group->names[igroup]);
  if (automatic && find_particles(atom, world, [&](int i) {
                     return outside(i, SOLID);
                   }).count)
    error->all(FLERR, "{}: substeps auto must know all solids", text);
  if (comm->me == 0) error->warning(FLERR, "{}: they do not limit the time step", text);
}

void FixFSIDt::end_of_step()
{
  if (update->ntimestep % interval == 0) find_limits(growth * update->dt);
  if (end < BIG) approach_end();
}

// What is left of the time is taken in one step, or, to have no tiny one, in two equal ones.
// LAMMPS is told which step will be the last, by and by more exactly: for the time that remains
// and for the last thermo output. Then the run is cut as by fix halt.
void FixFSIDt::approach_end()
{
  const bigint now = update->ntimestep, last = update->firststep + update->nsteps;
  const double time = Clock::now(update);
  const double next = next_dt > 0.0 ? next_dt : update->dt, left = end - time;
  if (left <= ROUNDING * next) {
    if (comm->me == 0 && now > update->firststep)
      utils::logmesg(lmp, "Fix fsi/dt: time {:.8g} reached on step {}\n", end, now);
    else if (comm->me == 0 && update->nsteps > 0)
      error->warning(FLERR,
                     "Fix fsi/dt stop {:.8g}: the time is {:.8g} already, there is nothing to run. "
                     "To go on give a later time, or unfix {}",
                     end, time, id);
    timer->force_timeout();
    cut = true;
    return;
  }
  const double steps = std::ceil(left / next * (1.0 - ROUNDING));
  if (steps <= 2.0) next_dt = left / steps;
  // not from the first guess: what LAMMPS never writes, restarts or dumps, it puts one step behind
  // the last when a run is set up and would write nothing more beyond
  if (now > update->firststep || steps <= 2.0)
    update->laststep = steps < last - now ? now + static_cast<bigint>(steps) : last;
  if (steps > 1.0 || output->next_thermo <= now || now == update->firststep)
    return;    // output will see to it
  output->next_thermo = update->laststep;
  output->next = std::min(output->next, output->next_thermo);
  modify->addstep_compute_all(output->next_thermo);    // also those that this step did not invoke
}

// another run may follow
void FixFSIDt::post_run()
{
  if (cut) timer->reset_timeout();
  cut = false;
}

// A new time step begins with a step, between two of position Verlet, each of which is second order
// on its own: positions and velocities need no more care. What lives at the middle of steps, the
// density of continuity and the stress of fsi/solid, goes from t^n - dt_old/2 to t^n + dt_new/2 by
// the rate of t^n: by the mean of the two, or every change would add an error of first order,
// (dt_new - dt_old)/2 times the rate: StepState::dt_offset. (The rates' positions, dt/2 v before
// those in atom->x, are of the new step, as they should.) Other styles hear of it as from fix
// dt/reset; the clock and the dumps by time count from the end of the last step.
void FixFSIDt::start_step()
{
  if (check) return;
  if (next_substeps) step->substeps = next_substeps;
  if (next_dt > 0.0 && next_dt != update->dt) {
    update->ntimestep--;
    set_step(next_dt, nullptr);
    output->reset_dt();
    update->ntimestep++;
  }
  dt = update->dt;
}

// the limits (fsi_limits.cpp) with the factors, and what follows: a step of so much at most
void FixFSIDt::find_limits(double most)
{
  const bool substeps = facts_of_solids(lmp).style == Facts::OF_TOTAL_LAGRANGIAN_SOLIDS &&
      (automatic || step->substeps > 1);
  limits->find(*disc, step->viscosity, groupbit, substeps, of_fluid, of_solid);
  limits->reduce();
  check ? report() : choose(most);
}

// the next time step, at most that much; with a given number of sub-steps the solid limits the
// step, else the step gives the number
void FixFSIDt::choose(double most)
{
  const double *const whole = limits->step, *const sub = limits->sub,
                      shortest = *std::min_element(sub, sub + NLIMIT);
  int n = step->substeps;
  const bool free = automatic && *std::min_element(whole, whole + NLIMIT) < BIG;
  target = high;
  cause = MAXIMUM;
  const auto combine = [&]() {
    for (int k = 0; k < NLIMIT; k++) limit[k] = std::min(whole[k], n * sub[k]);
  };
  if (automatic && !free) n = 1;    // nothing but sub-stepped solids
  combine();
  const double *const ruled = free ? whole : limit.data();
  for (int k = 0; k < NLIMIT; k++)
    if (ruled[k] < target) {
      target = ruled[k];
      cause = k;
    }
  if (target >= BIG) {    // no particles
    next_dt = update->dt;
    return;
  }
  if (!check && target < low)
    error->all(FLERR,
               "Fix fsi/dt: on step {} the limit {:.4g} of {} is below the smallest time step {}",
               update->ntimestep, target, name(cause), low);

  const bool fell_behind = ruling < 0 ||
      (cause != ruling && target < PRINT * (ruling == MAXIMUM ? high : ruled[ruling]));
  if (!check && fell_behind) {
    if (comm->me == 0)
      utils::logmesg(lmp, "Fix fsi/dt: from step {} on {} limits the time step, to {:.4g}\n",
                     update->ntimestep, name(cause), target);
    ruling = cause;
  }
  next_dt = std::min(target, most);
  if (next_dt < target) cause = GROWTH;
  if (automatic) {
    const double count = std::ceil(next_dt / shortest * (1.0 - 1.0e-12));
    if (count > MAXSUBSTEPS)
      error->all(FLERR,
                 "Fix fsi/dt: on step {} the solid needs {:.0f} sub-steps of {:.4g}, more than {}",
                 update->ntimestep, count, shortest, MAXSUBSTEPS);
    // implicit viscosity asks for sub-steps
    const bool two = facts_of_fluids(lmp).implicit_viscosity &&
        facts_of_solids(lmp).style == Facts::OF_TOTAL_LAGRANGIAN_SOLIDS;
    n = next_substeps = std::max(two ? 2 : 1, static_cast<int>(count));
    combine();
  }
}

std::string FixFSIDt::name(int k) const
{
  std::string text = k < NLIMIT ? Limits::names[k] : "the upper bound";
  if (k == Limits::SOUND) text += fmt::format(" (atom {})", limits->culprit[0][0]);
  if (k == Limits::ACCELERATION)
    text += fmt::format(" (atom {})", limits->culprit[limits->step[k] > limit[k]][1]);
  return text;
}

// check: the time step is not touched
void FixFSIDt::report()
{
  choose(BIG);
  next_dt = 0.0;
  if (update->dt <= target * (1.0 + 1.0e-12) || warned & 1 << cause) return;
  warned |= 1 << cause;
  const auto text =
      fmt::format("Fix fsi/dt: on step {} the time step {:.4g} is above {:.4g}, the limit of {}",
                  update->ntimestep, update->dt, target, name(cause));
  if (check == STOP) error->all(FLERR, text);
  if (comm->me == 0) error->warning(FLERR, text);
}

// time step that the next step takes
double FixFSIDt::compute_scalar()
{
  return next_dt > 0.0 ? next_dt : update->dt;
}

// the limits; number of what sets the time step, from 1; sub-steps
double FixFSIDt::compute_vector(int k)
{
  if (k < NLIMIT) return limit[k];
  if (k == NLIMIT) return cause + 1;
  const auto *const now = FixFSI::there(lmp);
  return next_substeps ? next_substeps : disc && now ? now->step.substeps : 0;
}

void FixFSIDt::write_restart(FILE *fp)
{
  Record record(lmp, "fix fsi/dt");
  keywords.write(record);
  record.add("steps", std::vector<double>{dt, next_dt, (double) next_substeps, (double) ruling});
  record.write(fp);
}

void FixFSIDt::restart(char *buf)
{
  const Record record(lmp, "fix fsi/dt", buf);
  keywords.compare(record);
  const auto list = record.numbers("steps");
  dt = list[0];
  next_dt = list[1];
  if (automatic) next_substeps = static_cast<int>(list[2]);
  ruling = static_cast<int>(list[3]);
  restored = dt > 0.0;
}

Facts FixFSIDt::facts() const
{
  Facts facts;
  facts.chooses_step = check == NO_CHECK;
  facts.chooses_substeps = automatic;
  return facts;
}

void FixFSIDt::find_idle(const Census &, const Idle &nothing) const
{
  if (automatic && facts_of_solids(lmp).style != Facts::OF_TOTAL_LAGRANGIAN_SOLIDS)
    nothing("Fix fsi/dt substeps auto", "there is no pair_style fsi/solid/tl");
  if (group->count(igroup) == 0)
    nothing("Fix fsi/dt", fmt::format("group {} is empty", group->names[igroup]));
}
