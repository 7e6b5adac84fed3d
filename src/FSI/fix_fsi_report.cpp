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

#include "fix_fsi_report.h"

#include "atom.h"
#include "comm.h"
#include "compute_fsi_energy.h"
#include "error.h"
#include "fix_fsi.h"
#include "fix_fsi_wall_mirror.h"
#include "force.h"
#include "fsi_find.h"
#include "fsi_gather.h"
#include "fsi_hub.h"
#include "fsi_kernel.h"
#include "fsi_keywords.h"
#include "fsi_population.h"
#include "fsi_profile.h"
#include "fsi_record.h"
#include "group.h"
#include "math_extra.h"
#include "modify.h"
#include "neighbor.h"
#include "output.h"
#include "timer.h"
#include "update.h"

#include <algorithm>
#include <cctype>
#include <cmath>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace FSI;

// "density of solids" -> density_of_solids
static std::string word(const std::string &text)
{
  std::string w;
  for (const char c : text) w += isalnum(static_cast<unsigned char>(c)) ? c : '_';
  return w;
}

FixFSIReport::FixFSIReport(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), profile(new Profile())
{
  if (!atom->style_match("fsi")) error->all(FLERR, "Fix fsi/report requires atom_style fsi");
  if (igroup)
    error->all(FLERR, "Fix fsi/report must use group all: times and energies have no group");

  std::string file;
  Keywords keywords(lmp, "fix fsi/report");
  keywords.key("file").word(file, "");
  keywords.parse(narg - 3, arg + 3);
  if (!file.empty() && comm->me == 0) {
    fp = fopen(file.c_str(), "w");
    if (!fp)
      error->one(FLERR, "Fix fsi/report cannot write file {}: {}", file, utils::getsyserror());
  }

  nevery = 1;
  vector_flag = 1;
  size_vector = 3;
  extvector = 0;
  global_freq = 1;
  dynamic_group_allow = 1;
}

FixFSIReport::~FixFSIReport()
{
  if (fp) fclose(fp);
  for (auto *fix : fixes_of<FixFSI>(lmp)) fix->step.profile = nullptr;
}

void FixFSIReport::init()
{
  auto *const fix_fsi = FixFSI::find(lmp, "Fix fsi/report")->link(disc, step, population);
  fix_fsi->step.profile = profile.get();
  if (fixes_of<FixFSIReport>(lmp).size() > 1)
    error->all(FLERR, "There can be only one fix fsi/report");
  energy = first_of(computes_of<ComputeFSIEnergy>(lmp));
}

// where a run starts; one with "pre no" has no setup and starts where the one before ended
void FixFSIReport::begin()
{
  first_step = update->ntimestep;
  first_time = Clock::now(update);
  natoms = particles();
  for (auto &given : impulse) given = {};
  momentum = momentum_of_moving();
  fields.clear();
  for (const auto &field : step->body_forces.all)
    if (field.mask) {
      double moved = 0.0;
      for (int i = 0; i < atom->nlocal; i++)
        if (atom->mask[i] & field.mask && atom->mask[i] & disc->mover->groupbit)
          moved += atom->rmass[i];
      fields.push_back({field.g, sum_of(moved, world)});
    }
  any_held = group->count(0) > group->count(disc->mover->igroup);
  listed = -1;
  if (energy) {
    energy->compute_vector();
    ledger.assign(energy->vector, energy->vector + energy->size_vector);
  }
  profile->clear();
}

// that there are, less those that inlets and outlets have made
bigint FixFSIReport::particles() const
{
  return count_of(atom->nlocal, world) - population->net;
}

// Of the first n atoms, local and ghost
FixFSIReport::Vector FixFSIReport::force_on_held(int n) const
{
  Vector sum{};
  for (const int i : held) {
    if (i >= n) break;
    for (int d = 0; d < disc->dim; d++) sum[d] += atom->f[i][d];
  }
  return sum;
}

// What moves has the opposite of what pairs do to the held, not of what fixes do: before those,
// where ghosts still have their part
void FixFSIReport::pre_reverse(int, int)
{
  if (!any_held) return;
  if (listed != neighbor->lastcall) {
    listed = neighbor->lastcall;
    held.clear();
    for (int i = 0; i < atom->nlocal + atom->nghost; i++)
      if (!(atom->mask[i] & disc->mover->groupbit)) held.push_back(i);
  }
  of_fixes = force_on_held(atom->nlocal + (force->newton_pair ? atom->nghost : 0));
}

void FixFSIReport::prescribe()
{
  if (!any_held) return;
  if (step->device) step->device->to_host();
  const Vector now = force_on_held(atom->nlocal);
  for (int d = 0; d < 3; d++) of_fixes[d] = now[d] - of_fixes[d];
}

// this rank's impulses of this step
void FixFSIReport::end_of_step()
{
  const double dtf = update->dt * force->ftm2v;
  for (const auto &field : fields)
    for (int d = 0; d < 3 && comm->me == 0; d++)
      impulse[GRAVITY][d] += dtf * field.mass * field.g[d];
  for (const auto *mirror : fixes_of<FixFSIWallMirror>(lmp))
    for (const auto &f : mirror->force_on)
      for (int d = 0; d < 3; d++) impulse[WALLS][d] -= dtf * f[d];
  if (!any_held) return;
  const Vector sum = force_on_held(atom->nlocal);
  for (int d = 0; d < 3; d++) impulse[HELD][d] -= dtf * (sum[d] - of_fixes[d]);
}

FixFSIReport::Vector FixFSIReport::momentum_of_moving(double *scale) const
{
  double local[4] = {}, all[4];
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & disc->mover->groupbit)) continue;
    const double m = atom->rmass[i], *const v = atom->v[i];
    for (int d = 0; d < 3; d++) local[d] += m * v[d];
    local[3] += m * MathExtra::len3(v);
  }
  MPI_Allreduce(local, all, 4, MPI_DOUBLE, MPI_SUM, world);
  if (scale) *scale = all[3];
  return {all[0], all[1], all[2]};
}

// what moves gains what gravity, walls and held particles give it, and nothing else
FixFSIReport::Balance FixFSIReport::balance() const
{
  Balance b;
  const Vector now = momentum_of_moving(&b.scale);
  auto local = impulse;
  for (int d = 0; d < 3; d++) {
    local[WALLS][d] += profile->reflected[d];
    local[HELD][d] -= force->ftm2v * profile->impulse_held[d];
  }
  MPI_Allreduce(local.data(), b.from.data(), 3 * NGIVER, MPI_DOUBLE, MPI_SUM, world);
  for (int d = 0; d < 3; d++) {
    b.change[d] = now[d] - momentum[d];
    b.rest[d] = b.change[d] - b.from[GRAVITY][d] - b.from[WALLS][d] - b.from[HELD][d];
    for (const auto &part : b.from) b.scale = std::max(b.scale, std::abs(part[d]));
  }
  return b;
}

// momentum unaccounted for, so far in this run
double FixFSIReport::compute_vector(int k)
{
  // before the first run, or with a new fix fsi
  if (!FixFSI::has(lmp, disc)) return 0.0;
  if (collected != update->ntimestep) output = balance().rest;
  collected = update->ntimestep;
  return output[k];
}

// the report
void FixFSIReport::post_run()
{
  if (update->whichflag != 1 || update->ntimestep == first_step) return;

  double loop = timer->get_wall(Timer::TOTAL);
  if (!timer->has_loop()) {
    profile->enter(Profile::OUTSIDE);
    loop = 0.0;
    for (const double s : profile->seconds) loop += s;
  }
  loop = sum_of(loop, world) / comm->nprocs;
  const double time = Clock::now(update) - first_time;
  const bigint left = particles(), now = left + population->net, lost = natoms - left;
  lines.clear();
  enter_line("first_step", first_step);
  enter_line("last_step", update->ntimestep);
  enter_line("ranks", comm->nprocs);
  enter_line("particles", now);
  enter_line("lost", lost);
  enter_line("time", time);
  enter_line("loop_seconds", loop);
  const auto text =
      fmt::format(
          "\nFSI report: steps {} to {}, a time of {:.6g}; {} particles{} on {} rank{}, {:.4g} s\n",
          first_step, update->ntimestep, time, now, lost ? fmt::format(" ({} lost)", lost) : "",
          comm->nprocs, comm->nprocs > 1 ? "s" : "", loop) +
      time_table(loop) + momentum_table(lost != 0) + energy_table() + "\n";
  if (comm->me == 0) {
    utils::logmesg(lmp, text);
    FILE *const to = fp ? fp : logfile;
    if (to) {
      utils::print(to, lines);
      fflush(to);
    }
  }
  begin();
}

template <class T> void FixFSIReport::enter_line(const std::string &name, const T &value)
{
  if constexpr (std::is_same_v<T, double>)
    lines += fmt::format("FSI report {} {:.10g}\n", name, value);
  else
    lines += fmt::format("FSI report {} {}\n", name, value);
}

// parts that the package times itself; of LAMMPS' own those that hold nothing of ours
enum { NEIGH = Profile::NPART, OUTPUT, REST, NROW };

std::string FixFSIReport::time_table(double loop)
{
  static constexpr const char *about[NROW][2] = {
      {"density", "rates, diffusion, shifting, number density, with images at walls"},
      {"stress", "velocity gradient, stress and hourglass control of solids"},
      {"force of fluid", "pairs with a fluid, with images at walls"},
      {"force of solids", "pairs, bonds, contact, sub-steps"},
      {"walls", "which walls are near, reflections"},
      {"communication", "ghosts, exchange; waiting for slower ranks"},
      {"neighbor lists", ""},
      {"output", "thermo, dumps, restarts, computes they need"},
      {"rest", "drift and kick, other fixes, their computes, LAMMPS"}};
  double local[NROW], sum[NROW], most[NROW];
  std::copy_n(profile->seconds, (int) Profile::NPART, local);
  const bool known = timer->has_normal();
  local[Profile::MESSAGES] += known ? timer->get_wall(Timer::COMM) : 0.0;
  local[NEIGH] = known ? timer->get_wall(Timer::NEIGH) : 0.0;
  local[OUTPUT] = known ? timer->get_wall(Timer::OUTPUT) : 0.0;
  local[REST] = loop;
  for (int k = 0; k < REST; k++) local[REST] -= local[k];
  MPI_Allreduce(local, sum, NROW, MPI_DOUBLE, MPI_SUM, world);
  MPI_Allreduce(local, most, NROW, MPI_DOUBLE, MPI_MAX, world);
  const double busiest = over_ranks(loop - local[Profile::MESSAGES], MPI_MAX, world);

  std::string text =
      fmt::format("  {:<16} {:>7} {:>10} {:>10}\n", "time", "share", "mean, s", "max, s");
  for (int k = 0; k < NROW; k++) {
    const double mean = sum[k] / comm->nprocs;
    enter_line("seconds_" + word(about[k][0]), mean);
    enter_line("seconds_max_" + word(about[k][0]), most[k]);
    enter_line("share_" + word(about[k][0]), loop > 0.0 ? mean / loop : 0.0);
    if (k < OUTPUT && mean < 1.0e-3 * loop) continue;    // not in this scene
    text += fmt::format("    {:<14} {:>6.1f}% {:>10.4g} {:>10.4g}   {}\n", about[k][0],
                        loop > 0.0 ? 100.0 * mean / loop : 0.0, mean, most[k], about[k][1]);
  }
  if (!known)
    text += "    (timer off or loop: the rest holds neighbor lists, output and LAMMPS' "
            "communication)\n";
  for (double &s : sum) s /= comm->nprocs;
  return text + what_to_change(loop, sum, busiest);
}

// Of what took more than its usual share of the time, the dearest first: what a script can change
std::string FixFSIReport::what_to_change(double loop, const double *mean, double busiest)
{
  if (loop <= 0.0) return "";
  const double steps = update->ntimestep - first_step, skin = neighbor->skin / disc->dx,
               a_list = steps / std::max<bigint>(neighbor->ncalls, 1),
               work = loop - mean[Profile::MESSAGES];
  const bool waits = busiest > 1.1 * work;
  const double of_fluid = mean[Profile::FLUID_FORCES];
  struct Hint {
    const char *name;
    double seconds;
    std::string text;
  };
  std::vector<Hint> hints;
  const auto add = [&](bool helps, const char *name, double seconds, double usual,
                       const std::string &text) {
    if (helps && seconds > usual * loop) hints.push_back({name, seconds, text});
  };
  add(waits, "waiting", busiest - work, 0.05,
      fmt::format("the busiest rank works {:.2f} times as long as the mean: fix balance",
                  busiest / work));
  add(!waits, "communication", mean[Profile::MESSAGES], 0.25,
      fmt::format("{} particles on each rank: fewer ranks", natoms / comm->nprocs));
  add(true, "neighbor lists", mean[NEIGH], 0.2,
      fmt::format("new ones every {:.3g} steps: a {} skin than {:.3g} dx", a_list,
                  a_list < 10.0 ? "larger" : "smaller", skin));
  add(true, "output", mean[OUTPUT], 0.1,
      fmt::format("thermo every {} steps, {} dumps: less often", lmp->output->thermo_every,
                  lmp->output->ndump));
  add(true, "force of solids", mean[Profile::SOLID_FORCES], 0.4,
      step->substeps == 1
          ? "fewer particles through the body"
          : fmt::format(
                "{} sub-steps in each step: fewer particles through the body, a softer body",
                step->substeps));
  add(facts_of_fluids(lmp).shift_every == 1, "density", mean[Profile::DENSITY], 0.3,
      "shifting in every step: shift/every 4");
  add(disc->kernel == QUINTIC, "force of fluid", of_fluid, 0.3,
      "kernel quintic: wendland is faster");
  add(skin > 1.5, "force of fluid", of_fluid, 0.3,
      fmt::format("a skin of {:.3g} dx: neighbor {:.2g} bin", skin, 0.3 * disc->dx));
  std::stable_sort(hints.begin(), hints.end(), [](const Hint &a, const Hint &b) {
    return a.seconds > b.seconds;
  });
  std::string text = "  what to change first\n";
  if (hints.empty())
    text += "    nothing stands out: fewer particles, or longer steps (fix fsi/dt says what limits "
            "them)\n";
  for (const auto &h : hints)
    text += fmt::format("    {:<14} {:>6.1f}%   {}\n", h.name, 100.0 * h.seconds / loop, h.text);
  enter_line("change_first", hints.empty() ? "nothing" : word(hints[0].name));
  return text;
}

std::string FixFSIReport::momentum_table(bool lost)
{
  const auto b = balance();
  const double relative =
      std::sqrt(b.rest[0] * b.rest[0] + b.rest[1] * b.rest[1] + b.rest[2] * b.rest[2]) /
      (b.scale > 0.0 ? b.scale : 1.0);
  std::string others = lost ? " lost particles," : "";
  if (has_open_ends(lmp)) others += " flow through open ends,";
  for (auto &fix : modify->get_fix_list())
    if ((modify->get_fix_mask(fix) & POST_FORCE) && !utils::strmatch(fix->style, "^gravity") &&
        find_particles(atom, world, [&](int i) {
          return atom->mask[i] & fix->groupbit && atom->mask[i] & disc->mover->groupbit;
        }).count)
      others += fmt::format(" fix {},", fix->id);
  std::string text = fmt::format("  {:<46} {:>12} {:>12}{}\n", "momentum", "x", "y",
                                 disc->dim == 3 ? fmt::format(" {:>12}", "z") : "");
  const auto row = [&](const char *name, const std::string &label, const Vector &p, bool shown) {
    for (int d = 0; d < 3; d++) enter_line(fmt::format("momentum_{}_{}", name, "xyz"[d]), p[d]);
    if (!shown) return;
    text += fmt::format("    {:<44}", label);
    for (int d = 0; d < disc->dim; d++) text += fmt::format(" {:>12.4g}", p[d]);
    text += "\n";
  };
  row("change", "change", b.change, true);
  row("gravity", "from gravity", b.from[GRAVITY], !fields.empty());
  row("walls", "from walls, reflections too", b.from[WALLS], step->walls.any());
  row("held", "from held particles", b.from[HELD], any_held);
  row("rest",
      others.empty() ? "unaccounted for: error" : fmt::format("unaccounted for:{} error", others),
      b.rest, true);
  enter_line("momentum_rest_relative", relative);
  text += fmt::format("    {:<44} {:>12.2g}\n", "this over the sum of m|v| or largest impulse",
                      relative);
  return text;
}

std::string FixFSIReport::energy_table()
{
  if (!energy) return "  energy: the ledger is off (compute fsi/energy)\n";
  energy->compute_vector();
  const int n = energy->size_vector;
  std::string text = fmt::format("  {:<46} {:>12} {:>12} {:>12}\n",
                                 "energy (from artificial viscosity on: what was taken)", "start",
                                 "end", "change");
  double start = 0.0, end = 0.0, exchanged = 0.0;
  for (int k = 0; k < n; k++) {
    const double now = energy->vector[k], change = now - ledger[k];
    start += ledger[k];
    end += now;
    exchanged = std::max(exchanged, std::abs(change));
    enter_line(fmt::format("energy_{}", word(ComputeFSIEnergy::name(k))), now);
    enter_line(fmt::format("energy_change_{}", word(ComputeFSIEnergy::name(k))), change);
    if (now != 0.0 || ledger[k] != 0.0)
      text += fmt::format("    {:<44} {:>12.5g} {:>12.5g} {:>12.4g}\n", ComputeFSIEnergy::name(k),
                          ledger[k], now, change);
  }
  const double relative = exchanged > 0.0 ? (end - start) / exchanged : 0.0;
  enter_line("energy_sum", end);
  enter_line("energy_change_sum", end - start);
  enter_line("energy_drift_relative", relative);
  text += fmt::format("    {:<44} {:>12.5g} {:>12.5g} {:>12.4g}, {:.2g} of the largest\n",
                      "sum: changes by the error only", start, end, end - start, relative);
  return text;
}
