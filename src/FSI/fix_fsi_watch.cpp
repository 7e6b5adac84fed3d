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
#include "domain.h"
#include "error.h"
#include "fix_fsi.h"
#include "fix_fsi_dt.h"
#include "force.h"
#include "fsi_keywords.h"
#include "group.h"
#include "modify.h"
#include "neigh_list.h"
#include "output.h"
#include "pair_fsi_solid_tl.h"
#include "thermo.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace FSI;

static constexpr double BIG = 1.0e20;

struct Description {
  const char *key, *what;
};
// clang-format off
static constexpr Description about[] = {
    {"", ""},
    {"mach", "Mach number"},
    {"distance", "distance over particle spacing"},
    {"density", "density error |rho/rho0-1|"},
    {"courant", "Courant number"},
    {"energy", "growth of the kinetic energy"},
    {"lost", "number of lost particles"},
    {"reflected", "number of reflections at mirror walls"}};
// clang-format on

/* ---------------------------------------------------------------------- */

FixFSIWatch::FixFSIWatch(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), fix_fsi(nullptr), halt(lmp, "Fix fsi/watch"), energy_before(-1.0),
    reflected_before(-1.0), warned(0), violations(0)
{
  if (!atom->style_match("fsi")) error->all(FLERR, "Fix fsi/watch requires atom_style fsi");
  static constexpr double FOLLOWS = -1.0;    // the scene, see allowed()
  Keywords keywords(lmp, "fix fsi/watch");
  keywords.argument("interval").integer(interval, 1, 1);
  const auto row = [&](Trouble q, double start, const Range &range, double off = BIG) {
    keywords.key(about[q].key).number(limit[q], start, range).or_word("off", off);
  };
  row(MACH, 0.5, Range::above(0.0));
  row(DISTANCE, 0.0, Range::inside(0.0, 1.0), FOLLOWS);
  row(DENSITY, 0.3, Range::above(0.0));
  row(COURANT, FOLLOWS, Range::above(0.0));
  row(ENERGY, 10.0, Range::above(1.0));
  row(LOST, FOLLOWS, Range::from(0.0));
  row(REFLECTED, BIG, Range::from(0.0));
  keywords.key("action").choice(warn, 0, {"stop", "warn"});
  const auto file = [lmp](const char *name) {
    return Stop::of_partition(lmp, name);
  };
  keywords.key("restart").word(halt.restart_file, file("fsi_watch.restart")).or_word("off");
  keywords.key("dump").word(halt.dump_file, file("fsi_watch.dump")).or_word("off");
  keywords.parse(narg - 3, arg + 3);
  distances = limit[DISTANCE] != FOLLOWS;
  if (!distances) limit[DISTANCE] = 0.0;
  for (int q = 0; q < NTROUBLE; q++) given[q] = limit[q] != FOLLOWS;
  if (!given[COURANT]) limit[COURANT] = 0.45;
  if (!given[LOST]) limit[LOST] = 0.0;
  limit[FINITE] = BIG;
  if (halt.restart_file.find_first_of("*%") != std::string::npos)
    error->all(FLERR, "Fix fsi/watch restart {} must be the name of one file, without * and %",
               halt.restart_file);

  clear();
  for (double &s : seen) s = 0.0;
  scalar_flag = vector_flag = 1;
  size_vector = NTROUBLE - 1;
  extscalar = extvector = 0;
  global_freq = 1;
  dynamic_group_allow = 1;
}

/* ---------------------------------------------------------------------- */

int FixFSIWatch::setmask()
{
  return POST_FORCE;
}

/* ---------------------------------------------------------------------- */

void FixFSIWatch::init()
{
  fix_fsi = FixFSI::find(lmp, "Fix fsi/watch");
  auto dt = modify->get_fix_by_style("^fsi/dt$");
  fix_dt = dt.empty() ? nullptr : dynamic_cast<FixFSIDt *>(dt[0]);
  if (fix_dt && !fix_dt->chooses()) fix_dt = nullptr;
  solid_tl = PairFSISolidTL::find(lmp);
  const auto &file = halt.restart_file;
  for (auto &fix : modify->get_fix_by_style("^fsi/watch$"))
    if (fix != this && static_cast<FixFSIWatch *>(fix)->halt.restart_file == file && !file.empty())
      error->all(FLERR, "Two fixes fsi/watch ({} and {}) would write the same file {}", id, fix->id,
                 file);
}

/* ---------------------------------------------------------------------- */

void FixFSIWatch::find_idle(const Census &, const Idle &nothing) const
{
  if (group->count(igroup) == 0)
    nothing("Fix fsi/watch", fmt::format("group {} is empty", group->names[igroup]));
}

/* ---------------------------------------------------------------------- */

void FixFSIWatch::setup(int)
{
  energy_before = reflected_before = -1.0;
  look(Stop::START);
}

/* ----------------------------------------------------------------------
   Positions of local and ghost atoms are those of the middle of the step, velocities those of
   its start, and both can be brought back: from here a run is stopped with a state that can be
   written.
------------------------------------------------------------------------- */

void FixFSIWatch::post_force(int)
{
  if (update->ntimestep % interval == 0) look(Stop::MIDDLE);
}

/* ----------------------------------------------------------------------
   Limits that the script did not set follow what it chose: the time step of fix fsi/dt with some
   room for what changes until it looks again, none before its first choice; and particles that
   are meant to leave.
------------------------------------------------------------------------- */

double FixFSIWatch::allowed(Trouble q) const
{
  if (given[q]) return limit[q];
  if (q == COURANT && fix_dt) return std::max(limit[q], 1.5 * fix_dt->largest_courant());
  if (q == LOST && output->thermo->lostflag == Thermo::IGNORE) return BIG;
  return limit[q];
}

/* ---------------------------------------------------------------------- */

void FixFSIWatch::clear()
{
  for (Finding &w : worst) w = {};
  worst[DISTANCE].value = BIG;
  for (double &t : total) t = 0.0;
}

/* ---------------------------------------------------------------------- */

void FixFSIWatch::enter(Trouble q, int i, double value, int j)
{
  Finding &w = worst[q];
  if (w.tag && (q == DISTANCE ? value >= w.value : value <= w.value)) return;
  w = halt.finding(q, i, value, j);
}

/* ---------------------------------------------------------------------- */

// kinetic energy, and what of it is small: that of a hundredth of the speed of waves
void FixFSIWatch::look_at_particles(double &kinetic, double &little)
{
  double **v = atom->v;
  const double *const rmass = atom->rmass, *const rho = atom->rho;
  const int *const mask = atom->mask, *const type = atom->type;
  const double dt = update->dt;

  struct TypeState {
    double csq, rho0, mass, fastest;    // of a type Mach and Courant number grow with the speed
    int species;
  };
  std::vector<TypeState> all_of(atom->ntypes + 1, {0.0, 1.0, 0.0, -1.0, NONE});
  for (int t = 1; t <= atom->ntypes; t++) {
    const State &s = fix_fsi->state[t];
    all_of[t] = {s.species == NONE ? 0.0 : s.wave_speed_sq(), s.rho0, 0.0, -1.0, s.species};
  }
  double furthest = -1.0;    // furthest from the density at rest
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(mask[i] & groupbit)) continue;
    TypeState &of = all_of[type[i]];
    if (of.species == RIGID) continue;    // neither compressed nor integrated
    const double vsq = v[i][0] * v[i][0] + v[i][1] * v[i][1] + v[i][2] * v[i][2];
    kinetic += 0.5 * rmass[i] * vsq;
    of.mass += rmass[i];
    if (vsq > of.fastest) {
      of.fastest = vsq;
      const double c = std::sqrt(of.csq), speed = std::sqrt(vsq);
      enter(MACH, i, speed / c);
      if (of.species == FLUID)
        enter(COURANT, i, dt * (c + speed) / fix_fsi->h_of(type[i]));
      else
        enter(COURANT, i,
              dt * c / (fix_fsi->is_total_lagrangian(i) ? fix_fsi->substeps : 1) /
                  fix_fsi->h_of(type[i]));
      enter(ENERGY, i, vsq);
    }
    // spray without tension loses density, which then means nothing
    if (of.species == FLUID && rho[i] < of.rho0 &&
        fix_fsi->pressure(i) == fix_fsi->state[type[i]].floor)
      continue;
    const double error = std::abs((fix_fsi->is_total_lagrangian(i) ? 1.0 / solid_tl->volume_ratio(i)
                                                                   : fix_fsi->density_ratio(i)) -
                                  1.0);
    if (error > furthest) {
      furthest = error;
      enter(DENSITY, i, error);
    }
  }
  for (const TypeState &of : all_of) little += 0.5e-4 * of.mass * of.csq;
}

// pairs whose neighbor lists are at hand: all but those inside one total-Lagrangian body
void FixFSIWatch::look_at_pairs()
{
  double **x = atom->x;
  const int *const mask = atom->mask, *const type = atom->type;
  double smallest = BIG;
  for (const char *style : {"^fsi/fluid", "^fsi/solid"}) {
    const Pair *const pair = force->pair_match(style, 0);
    if (!pair || !pair->list) continue;
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

/* ---------------------------------------------------------------------- */

void FixFSIWatch::look(Stop::When when)
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
  double reflected = 0.0;
  for (auto *fix : modify->get_fix_by_style("^fsi/wall/mirror$"))
    reflected += fix->compute_scalar();
  total[REFLECTED] = reflected_before >= 0.0 ? reflected - reflected_before : 0.0;
  reflected_before = reflected;

  double own[NTROUBLE];
  for (int q = 0; q < NTROUBLE; q++)
    own[q] = q == DISTANCE ? -worst[q].value : q >= ENERGY ? total[q] : worst[q].value;
  MPI_Allreduce(own, seen, NTROUBLE, MPI_DOUBLE, MPI_MAX, world);
  seen[DISTANCE] = -seen[DISTANCE];
  judge(when);
}

/* ----------------------------------------------------------------------
   all ranks know what is wrong, and warn or stop together
------------------------------------------------------------------------- */

void FixFSIWatch::judge(Stop::When when)
{
  for (int k = MACH; k < NTROUBLE; k++) {
    const auto q = static_cast<Trouble>(k);
    if (q == COURANT && when == Stop::START && fix_dt) continue;    // its first choice comes later
    if (q == DISTANCE ? seen[q] >= allowed(q) : seen[q] <= allowed(q)) continue;
    violations++;
    if (warned & 1 << k) continue;
    Finding all = halt.worst(worst[q], q == DISTANCE ? -worst[q].value : worst[q].value);
    all.trouble = q;
    all.value = seen[q];
    const auto what = fmt::format("{} {:.4g} is {} the limit {:g}", about[q].what, all.value,
                                  q == DISTANCE ? "below" : "above", allowed(q));
    const auto text = halt.describe(*fix_fsi, what, all, when);
    if (!warn) halt.stop(*fix_fsi, text, all, when);
    warned |= 1 << k;
    if (comm->me == 0) error->warning(FLERR, text);
  }
}

/* ----------------------------------------------------------------------
   number of checks that found something, so far
------------------------------------------------------------------------- */

double FixFSIWatch::compute_scalar()
{
  return static_cast<double>(violations);
}

/* ----------------------------------------------------------------------
   of the last check: Mach number, distance, density error, Courant number, energy growth, lost,
   reflected
------------------------------------------------------------------------- */

double FixFSIWatch::compute_vector(int k)
{
  return seen[k + 1];
}
