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

#include "fix_fsi_watch.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "fix_fsi.h"
#include "fsi_check.h"
#include "fsi_find.h"
#include "fsi_gather.h"
#include "fsi_hub.h"
#include "fsi_keywords.h"
#include "fsi_rows.h"
#include "group.h"
#include "math_extra.h"
#include "neigh_list.h"
#include "output.h"
#include "pair_fsi_solid_tl.h"
#include "thermo.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace FSI;

static constexpr double OFF = 1.0e20, FOLLOWS = -1.0;    // a limit; FOLLOWS: the scene

// sign: -1 where what is small is wrong
struct FixFSIWatch::Row {
  Trouble trouble;
  const char *key, *what;
  double sign, standard, off;
  Range range;
  double limit = OFF, seen = 0.0;    // seen: on all ranks at the last check
  Finding worst = {};                // of this rank
  bool warned = false;
};
enum { NEAREST, DENSEST, GROWTH, GONE, NROW };

FixFSIWatch::FixFSIWatch(LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg)
{
  if (!atom->style_match("fsi")) error->all(FLERR, "Fix fsi/watch requires atom_style fsi");
  for (int k = 4; k < narg; k++)
    if (std::string(arg[k]) == "reflected")
      error->all(FLERR,
                 "Fix fsi/watch has no keyword reflected: fix fsi/wall/mirror counts reflections, "
                 "f_ID, for fix halt");
  rows = {{DISTANCE, "distance", "distance over particle spacing", -1.0, 0.0, FOLLOWS,
           Range::inside(0.0, 1.0)},
          {DENSITY, "density", "density error |rho/rho0-1|", 1.0, 0.3, OFF, Range::above(0.0)},
          {ENERGY, "energy", "growth of the kinetic energy", 1.0, 10.0, OFF, Range::above(1.0)},
          {LOST, "lost", "number of lost particles", 1.0, FOLLOWS, OFF, Range::from(0.0)}};
  Keywords keywords(lmp, "fix fsi/watch");
  keywords.argument("interval").integer(interval, 1, 1);
  for (auto &row : rows)
    keywords.key(row.key).number(row.limit, row.standard, row.range).or_word("off", row.off);
  keywords.key("action").choice(warn, 0, {"stop", "warn"});
  keywords.parse(narg - 3, arg + 3);
  loses = rows[GONE].limit != FOLLOWS;
  if (!loses) rows[GONE].limit = 0.0;

  scalar_flag = vector_flag = 1;
  size_vector = NROW;
  extscalar = extvector = 0;
  global_freq = 1;
  dynamic_group_allow = 1;
}

FixFSIWatch::~FixFSIWatch() = default;

double FixFSIWatch::compute_vector(int k)
{
  return rows[k].seen;
}

void FixFSIWatch::init()
{
  auto *const fix_fsi = FixFSI::find(lmp, "Fix fsi/watch")->link(disc, step);
  halt = std::make_unique<Stop>(lmp, "Fix fsi/watch", *disc, *step, fix_fsi->parts);
}

void FixFSIWatch::find_idle(const Census &, const Idle &nothing) const
{
  // of walls there are distances alone
  const auto watched = find_particles(atom, world, [this](int i) {
    const int species = disc->state[atom->type[i]].species;
    return atom->mask[i] & groupbit && (species == FLUID || species == SOLID);
  });
  if (watched.count == 0 && rows[NEAREST].limit <= 0.0)
    nothing("Fix fsi/watch",
            fmt::format("group {} has no fluid and no solid", group->names[igroup]));
}

void FixFSIWatch::setup(int)
{
  energy_before = -1.0;
  look(true);
}

// Positions of local and ghost atoms are those of the middle of the step, velocities those of its
// start, and both can be brought back: from here a run is stopped with a state that can be written.
void FixFSIWatch::post_force(int)
{
  if (update->ntimestep % interval == 0) look(false);
}

void FixFSIWatch::enter(int row, int i, double value, int j)
{
  Row &r = rows[row];
  if (!(r.sign * value > r.sign * r.worst.value)) return;    // or not a number
  r.worst = halt->finding(r.trouble, i, value, j);
}

// kinetic energy, and what of it is small: that of a hundredth of the speed of waves
void FixFSIWatch::look_at_particles(double &kinetic, double &little)
{
  const PairFSISolidTL *const solid_tl = first_of(pairs_of<PairFSISolidTL>(lmp));
  std::vector<double> mass(atom->ntypes + 1, 0.0);
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    const State &s = disc->state[atom->type[i]];
    const double *const v = atom->v[i], m = atom->rmass[i], rho = atom->rho[i];
    // a wall is neither compressed nor integrated
    if (s.species == NONE || s.species == RIGID) continue;
    const double vsq = MathExtra::lensq3(v);
    kinetic += 0.5 * m * vsq;
    mass[atom->type[i]] += m;
    enter(GROWTH, i, vsq);
    // spray without tension loses density, which then means nothing
    if (s.species == FLUID && rho < s.rho0 && pressure_of(i, atom, *disc, *step) == s.floor)
      continue;
    const double ratio = s.form == TOTAL_LAGRANGIAN ? 1.0 / solid_tl->volume_ratio(i)
                                                    : rho / s.rho0;
    enter(DENSEST, i, std::abs(ratio - 1.0));
  }
  for (int t = 1; t <= atom->ntypes; t++)
    if (mass[t] > 0.0) little += 0.5e-4 * mass[t] * disc->state[t].wave_speed_sq();
}

// pairs whose neighbor lists are at hand: all but those inside one total-Lagrangian body
void FixFSIWatch::look_at_pairs()
{
  const std::vector<Resolution> &resolution = disc->resolution;
  double smallest = OFF;
  for (const auto *const pair : pairs_of<PairFSI>(lmp)) {
    const NeighList *const list = pair->list;
    for (int ii = 0; list && ii < list->inum; ii++) {
      const int i = list->ilist[ii];
      if (!(atom->mask[i] & groupbit)) continue;
      const FSI::Row row = {i, list->numneigh[i], list->firstneigh[i]};
      for_near(row, atom->x, 3, HUGE_VAL, [&](int j, const double *, double rsq) {
        const double apart = spacing_between(resolution[atom->type[i]], resolution[atom->type[j]]);
        if (rsq >= smallest * apart * apart) return;
        smallest = rsq / (apart * apart);
        enter(NEAREST, i, std::sqrt(rsq) / apart, j);
      });
    }
  }
}

void FixFSIWatch::look(bool at_start)
{
  for (auto &row : rows) {
    row.worst = {};
    row.worst.value = row.sign < 0.0 ? OFF : -1.0;
  }
  double sums[3] = {0.0, 0.0, (double) atom->nlocal}, all[3];
  look_at_particles(sums[0], sums[1]);
  if (rows[NEAREST].limit != FOLLOWS) look_at_pairs();
  MPI_Allreduce(sums, all, 3, MPI_DOUBLE, MPI_SUM, world);
  const double scale = std::max(energy_before, all[1]);
  double most[NROW], seen[NROW];
  for (int k = 0; k < NROW; k++)
    most[k] = rows[k].worst.tag ? rows[k].sign * rows[k].worst.value : k == NEAREST ? -OFF : 0.0;
  most[GROWTH] = energy_before >= 0.0 && scale > 0.0 ? all[0] / scale : 0.0;
  most[GONE] = (double) atom->natoms - all[2];
  energy_before = all[0];
  MPI_Allreduce(most, seen, NROW, MPI_DOUBLE, MPI_MAX, world);
  for (int k = 0; k < NROW; k++) rows[k].seen = rows[k].sign * seen[k];
  for (auto &row : rows) judge(row, at_start);
}

// all ranks know what is wrong, and warn or stop together
void FixFSIWatch::judge(Row &row, bool at_start)
{
  // particles may be meant to leave
  const bool leaves = row.trouble == LOST && !loses && output->thermo->lostflag == Thermo::IGNORE;
  const double limit = leaves ? OFF : std::max(row.limit, 0.0);
  if (row.sign * row.seen <= row.sign * limit) return;
  violations++;
  if (row.warned) return;
  Finding all = halt->worst(row.worst, row.sign * row.worst.value);
  all.trouble = row.trouble;
  all.value = row.seen;
  const auto what = fmt::format("{} {:.4g} is {} the limit {:g}", row.what, all.value,
                                row.sign < 0.0 ? "below" : "above", limit);
  const auto when = at_start ? Stop::START : Stop::MIDDLE;
  const auto text = halt->describe(what, all, when);
  if (!warn) halt->stop(text, all, when);
  row.warned = true;
  if (comm->me == 0) error->warning(FLERR, text);
}
