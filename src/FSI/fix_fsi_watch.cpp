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
#include "fsi_find.h"
#include "fsi_keywords.h"
#include "fsi_stop.h"
#include "group.h"
#include "neigh_list.h"
#include "output.h"
#include "pair_fsi_solid_tl.h"
#include "thermo.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace FSI;

static constexpr double BIG = 1.0e20;

struct Description {
  const char *key, *what;
};
// clang-format off
static constexpr Description about[] = {    // from DISTANCE on
    {"distance", "distance over particle spacing"},
    {"density", "density error |rho/rho0-1|"},
    {"energy", "growth of the kinetic energy"},
    {"lost", "number of lost particles"}};
// clang-format on

FixFSIWatch::FixFSIWatch(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), fix_fsi(nullptr), halt(new Stop(lmp, "Fix fsi/watch")), limit(NTROUBLE),
    worst(NTROUBLE), total(NTROUBLE), seen(NTROUBLE, 0.0), energy_before(-1.0), warned(0),
    violations(0)
{
  if (!atom->style_match("fsi")) error->all(FLERR, "Fix fsi/watch requires atom_style fsi");
  for (int k = 4; k < narg; k++)
    if (std::string(arg[k]) == "reflected")
      error->all(FLERR,
                 "Fix fsi/watch has no keyword reflected: fix fsi/wall/mirror counts reflections, "
                 "f_ID, for fix halt");
  static constexpr double FOLLOWS = -1.0;    // the scene, see allowed()
  Keywords keywords(lmp, "fix fsi/watch");
  keywords.argument("interval").integer(interval, 1, 1);
  const auto row = [&](Trouble q, double start, const Range &range, double off = BIG) {
    keywords.key(about[q - DISTANCE].key).number(limit[q], start, range).or_word("off", off);
  };
  row(DISTANCE, 0.0, Range::inside(0.0, 1.0), FOLLOWS);
  row(DENSITY, 0.3, Range::above(0.0));
  row(ENERGY, 10.0, Range::above(1.0));
  row(LOST, FOLLOWS, Range::from(0.0));
  keywords.key("action").choice(warn, 0, {"stop", "warn"});
  keywords.parse(narg - 3, arg + 3);
  distances = limit[DISTANCE] != FOLLOWS;
  if (!distances) limit[DISTANCE] = 0.0;
  loses = limit[LOST] != FOLLOWS;
  if (!loses) limit[LOST] = 0.0;

  clear();
  scalar_flag = vector_flag = 1;
  size_vector = NTROUBLE - DISTANCE;
  extscalar = extvector = 0;
  global_freq = 1;
  dynamic_group_allow = 1;
}

FixFSIWatch::~FixFSIWatch() = default;

double FixFSIWatch::compute_vector(int k)
{
  return seen[DISTANCE + k];
}

void FixFSIWatch::init()
{
  fix_fsi = FixFSI::find(lmp, "Fix fsi/watch");
  solid_tl = PairFSISolidTL::find(lmp);
}

void FixFSIWatch::find_idle(const Census &, const Idle &nothing) const
{
  if (group->count(igroup) == 0)
    nothing("Fix fsi/watch", fmt::format("group {} is empty", group->names[igroup]));
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

// particles may be meant to leave

double FixFSIWatch::allowed(int q) const
{
  return q == LOST && !loses && output->thermo->lostflag == Thermo::IGNORE ? BIG : limit[q];
}

void FixFSIWatch::clear()
{
  worst.assign(NTROUBLE, {});
  worst[DISTANCE].value = BIG;
  total.assign(NTROUBLE, 0.0);
}

void FixFSIWatch::enter(int q, int i, double value, int j)
{
  Finding &w = worst[q];
  if (w.tag && (q == DISTANCE ? value >= w.value : value <= w.value)) return;
  w = halt->finding((Trouble) q, i, value, j);
}

// kinetic energy, and what of it is small: that of a hundredth of the speed of waves
void FixFSIWatch::look_at_particles(double &kinetic, double &little)
{
  double **v = atom->v;
  const double *const rmass = atom->rmass, *const rho = atom->rho;
  const int *const mask = atom->mask, *const type = atom->type;
  std::vector<double> mass(atom->ntypes + 1, 0.0);
  double fastest = -1.0, furthest = -1.0;    // furthest from the density at rest
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(mask[i] & groupbit)) continue;
    const State &s = fix_fsi->state[type[i]];
    // a wall is neither compressed nor integrated
    if (s.species == NONE || s.species == RIGID) continue;
    const double vsq = v[i][0] * v[i][0] + v[i][1] * v[i][1] + v[i][2] * v[i][2];
    kinetic += 0.5 * rmass[i] * vsq;
    mass[type[i]] += rmass[i];
    if (vsq > fastest) {
      fastest = vsq;
      enter(ENERGY, i, vsq);
    }
    // spray without tension loses density, which then means nothing
    if (s.species == FLUID && rho[i] < s.rho0 && fix_fsi->pressure(i) == s.floor) continue;
    const double error = std::abs((fix_fsi->is_total_lagrangian(i) ? 1.0 / solid_tl->volume_ratio(i)
                                                                   : fix_fsi->density_ratio(i)) -
                                  1.0);
    if (error > furthest) {
      furthest = error;
      enter(DENSITY, i, error);
    }
  }
  for (int t = 1; t <= atom->ntypes; t++)
    if (mass[t] > 0.0) little += 0.5e-4 * mass[t] * fix_fsi->state[t].wave_speed_sq();
}

// pairs whose neighbor lists are at hand: all but those inside one total-Lagrangian body
void FixFSIWatch::look_at_pairs()
{
  double **x = atom->x;
  const int *const mask = atom->mask, *const type = atom->type;
  double smallest = BIG;
  for (const auto *const pair : pairs_of<PairFSI>(lmp)) {
    if (!pair->list) continue;
    const NeighList *const list = pair->list;
    for (int ii = 0; ii < list->inum; ii++) {
      const int i = list->ilist[ii];
      if (!(mask[i] & groupbit)) continue;
      for (int jj = 0; jj < list->numneigh[i]; jj++) {
        const int j = list->firstneigh[i][jj] & NEIGHMASK;
        const double a = x[i][0] - x[j][0], b = x[i][1] - x[j][1], c = x[i][2] - x[j][2];
        const double rsq = a * a + b * b + c * c;
        const double apart =
            spacing_between(fix_fsi->resolution[type[i]], fix_fsi->resolution[type[j]]);
        if (rsq >= smallest * apart * apart) continue;
        smallest = rsq / (apart * apart);
        enter(DISTANCE, i, std::sqrt(rsq) / apart, j);
      }
    }
  }
}

void FixFSIWatch::look(bool at_start)
{
  clear();
  double mine[3] = {0.0, 0.0, (double) atom->nlocal}, all[3];
  look_at_particles(mine[0], mine[1]);
  if (distances) look_at_pairs();

  MPI_Allreduce(mine, all, 3, MPI_DOUBLE, MPI_SUM, world);
  const double scale = std::max(energy_before, all[1]);
  total[ENERGY] = energy_before >= 0.0 && scale > 0.0 ? all[0] / scale : 0.0;
  energy_before = all[0];
  total[LOST] = (double) atom->natoms - all[2];

  double own[NTROUBLE];
  for (int q = 0; q < NTROUBLE; q++)
    own[q] = q == DISTANCE ? -worst[q].value : q >= ENERGY ? total[q] : worst[q].value;
  MPI_Allreduce(own, seen.data(), NTROUBLE, MPI_DOUBLE, MPI_MAX, world);
  seen[DISTANCE] = -seen[DISTANCE];
  judge(at_start);
}

// all ranks know what is wrong, and warn or stop together
void FixFSIWatch::judge(bool at_start)
{
  const auto when = at_start ? Stop::START : Stop::MIDDLE;
  for (int k = DISTANCE; k < NTROUBLE; k++) {
    const auto q = static_cast<Trouble>(k);
    if (q == DISTANCE ? seen[q] >= allowed(q) : seen[q] <= allowed(q)) continue;
    violations++;
    if (warned & 1 << k) continue;
    Finding all = halt->worst(worst[q], q == DISTANCE ? -worst[q].value : worst[q].value);
    all.trouble = q;
    all.value = seen[q];
    const auto what = fmt::format("{} {:.4g} is {} the limit {:g}", about[q - DISTANCE].what,
                                  all.value, q == DISTANCE ? "below" : "above", allowed(q));
    const auto text = halt->describe(*fix_fsi, what, all, when);
    if (!warn) halt->stop(*fix_fsi, text, all, when);
    warned |= 1 << k;
    if (comm->me == 0) error->warning(FLERR, text);
  }
}
