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

#include "fix_fsi_move.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix_fsi.h"
#include "force.h"
#include "fsi_gather.h"
#include "fsi_hub.h"
#include "fsi_keywords.h"
#include "fsi_record.h"
#include "lattice.h"
#include "math_const.h"
#include "math_extra.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace FSI;

// as in the command, in the order of Motion
static const std::vector<std::string> MOTIONS = {"linear", "wiggle", "rotate", "transrot",
                                                 "variable"};
static constexpr double FREE = HUGE_VAL;    // stands for NULL

FixFSIMove::FixFSIMove(LAMMPS *lmp, int narg, char **arg) :
    FixFields(lmp, narg, arg, "fix fsi/move"), rate{}, point{}, axis{}, omega(0.0), driven{},
    given(new Values(lmp, "fix fsi/move", 2 * VELOCITY)), evaluated(-1), origin(Clock::now(update)),
    original(nullptr), begun(false)
{
  if (narg < 4) utils::missing_cmd_args(FLERR, "fix fsi/move", error);
  const auto found = std::find(MOTIONS.begin(), MOTIONS.end(), arg[3]);
  if (found == MOTIONS.end())
    error->all(FLERR, "Unknown fix fsi/move style {}: expected {}", arg[3], list_of(MOTIONS));
  motion = static_cast<int>(found - MOTIONS.begin());
  Keywords words(lmp, "fix fsi/move " + *found);
  motion == VARIABLE ? read_variables(words, narg - 4, arg + 4)
                     : read_motion(words, narg - 4, arg + 4);
  if (domain->dimension == 2 && (rate[2] != 0.0 || (motion == VARIABLE && sets_velocity(2))))
    error->all(FLERR, "Fix fsi/move {} cannot move along z in 2D", *found);

  time_integrate = time_depend = 1;
  fields.set("place before the motion", Fields::RESTART, true, original, 3);
  register_fields();
  for (int i = 0; i < atom->nlocal; i++) domain->unmap(atom->x[i], atom->image[i], original[i]);
}

void FixFSIMove::read_motion(Keywords &words, int narg, char **arg)
{
  const bool turns = motion == ROTATE || motion == TRANSROT;
  double period = 0.0;
  int lattice;
  for (int k = 0; k < 3 && motion != ROTATE; k++) {
    words.argument(std::string("along ") + "xyz"[k]).number(rate[k], 0.0);
    if (motion != TRANSROT) words.or_word("NULL", FREE);
  }
  for (int k = 0; k < 3 && turns; k++) words.argument("point").number(point[k], 0.0);
  for (int k = 0; k < 3 && turns; k++) words.argument("axis").number(axis[k], 0.0);
  if (motion != LINEAR) words.argument("period").number(period, 1.0, Range::above(0.0));
  words.key("units").choice(lattice, 1, {"box", "lattice"});
  words.parse(narg, arg);

  for (int k = 0; k < 3; k++) {
    driven[k] = rate[k] != FREE;
    if (!driven[k]) rate[k] = 0.0;
  }
  if (motion != LINEAR) omega = MathConst::MY_2PI / period;
  if (turns) {
    const double length = MathExtra::len3(axis);
    if (length == 0.0)
      error->all(FLERR, "Fix fsi/move {} axis must not be of length 0", MOTIONS[motion]);
    for (double &a : axis) a /= length;
    if (domain->dimension == 2 && (axis[0] != 0.0 || axis[1] != 0.0))
      error->all(FLERR, "Fix fsi/move {} axis must be z in 2D", MOTIONS[motion]);
  }
  if (!lattice) return;
  const double scale[] = {domain->lattice->xlattice, domain->lattice->ylattice,
                          domain->lattice->zlattice};
  for (int k = 0; k < 3; k++) {
    rate[k] *= scale[k];
    point[k] *= scale[k];
  }
}

void FixFSIMove::read_variables(Keywords &words, int narg, char **arg)
{
  std::string name[2 * VELOCITY];
  int lattice;    // variables are in units of the box
  for (auto &n : name) words.argument("v_name").word(n, "").or_word("NULL");
  words.key("units").choice(lattice, 1, {"box", "lattice"});
  words.parse(narg, arg);
  for (int k = 0; k < 2 * VELOCITY; k++) {
    if (name[k].empty()) continue;
    if (!utils::strmatch(name[k], "^v_"))
      error->all(FLERR, "Fix fsi/move variable {} must be NULL or v_name", name[k]);
    given->set_variable(k, name[k].substr(2));
    if (k >= VELOCITY) continue;
    driven[k] = true;
    if (name[VELOCITY + k].empty())
      error->all(
          FLERR,
          "Fix fsi/move variable {} needs the variable of its velocity, too: fluid feels how "
          "fast a wall moves",
          given->name(k));
  }
}

FixFSIMove::~FixFSIMove() = default;

bool FixFSIMove::sets_velocity(int k) const
{
  return driven[k] || given->given(VELOCITY + k);
}

bool FixFSIMove::of_atom(int k) const
{
  return given->source(k) == Values::ATOM || given->source(VELOCITY + k) == Values::ATOM;
}

void FixFSIMove::init()
{
  const auto *const fix_fsi = FixFSI::find(lmp, "Fix fsi/move");
  bool both = false;
  for (int i = 0; i < atom->nlocal; i++)
    both |= (atom->mask[i] & groupbit) && (atom->mask[i] & fix_fsi->groupbit);
  if (anywhere(both, world))
    error->all(FLERR,
               "Particles of fix fsi/move {} are also in the group of fix fsi, which moves them, "
               "too: leave them out",
               id);
  refuse_free(fix_fsi->disc, fix_fsi->step.takes_substeps(lmp));
  given->find();
}

// Nothing holds the particles of a wall together: forces would take each its own way. Those in a
// solid that takes sub-steps are seen once in a step: a part that they move would gain energy
void FixFSIMove::refuse_free(const Discretization &disc, bool substeps) const
{
  for (int k = 0; k < domain->dimension; k++) {
    if (sets_velocity(k)) continue;
    const char name = "xyz"[k];
    for (int i = 0; i < atom->nlocal; i++) {
      const State &s = disc.state[atom->type[i]];
      const bool wall = s.species == RIGID, solid = substeps && s.form == TOTAL_LAGRANGIAN;
      if (!(atom->mask[i] & groupbit) || !(wall || solid)) continue;
      error->one(FLERR,
                 "Fix fsi/move {} leaves {} of atom {} free, which is of a {}. Write 0 instead of "
                 "NULL to hold that component{}",
                 id, name, atom->tag[i],
                 wall ? "wall: forces would take each wall particle its own way"
                      : "solid with sub-steps: what moves it would gain energy",
                 motion == VARIABLE ? ", a variable that is 0" : "");
    }
  }
}

// velocities that the first forces feel
void FixFSIMove::setup_pre_exchange()
{
  if (!begun) origin = Clock::now(update);    // the clock of a restart file is right from init() on
  begun = true;
  go_on_from_here();
  move(START);
}

// The motion goes on from there, whatever variables are when it begins, and wherever commands
// between runs have put particles
void FixFSIMove::go_on_from_here()
{
  constexpr double ROUND = 1.0e-6;
  const double round = ROUND * FixFSI::find(lmp, "Fix fsi/move")->disc.dx,
               t = Clock::now(update) - origin;
  if (motion == VARIABLE) given->evaluate(igroup, 0, 2 * VELOCITY);
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    double to[3], v[3], off[3] = {};
    where(i, t, to, v);
    for (int k = 0; k < domain->dimension; k++)
      if (driven[k]) off[k] = atom->x[i][k] - to[k];
    to_nearest_image(*domain, off);
    if (MathExtra::lensq3(off) <= round * round) continue;
    for (int k = 0; k < 3; k++) original[i][k] += off[k];
    if (motion != ROTATE && motion != TRANSROT) continue;
    domain->unmap(atom->x[i], atom->image[i], original[i]);
    turn_back(original[i], t);
  }
}

void FixFSIMove::initial_integrate(int)
{
  double before[2 * VELOCITY];
  for (int k = 0; k < 2 * VELOCITY; k++) before[k] = given->number(k);
  move(MIDDLE);
  if (motion != VARIABLE) return;
  given->evaluate(igroup, 0, 2 * VELOCITY, false);
  evaluated = update->ntimestep;
  compare_velocities(before);
}

// Fluid feels a wall's velocity, and would not know of another one by which its place changes
// of equal-style variables; before: at the start of the step
void FixFSIMove::compare_velocities(const double *before) const
{
  for (int k = 0; k < domain->dimension; k++) {
    const int v = VELOCITY + k;
    const double d = given->number(k), size = std::max(std::fabs(d), std::fabs(before[k]));
    if (given->source(k) == Values::EQUAL && given->source(v) == Values::EQUAL)
      compare_velocity(k, d - before[k], update->dt, before[v], given->number(v), size);
  }
}

// moved in the time dt, with velocities v and v_end; round: the size of what it is a difference of
void FixFSIMove::compare_velocity(int k, double moved, double dt, double v, double v_end,
                                  double round, int i) const
{
  constexpr double TOLERANCE = 0.05, ROUND = 1.0e-14;
  if (dt == 0.0) return;
  const double mean = moved / dt, low = std::min(v, v_end), high = std::max(v, v_end);
  const double most = std::max({std::fabs(v), std::fabs(v_end), std::fabs(mean)});
  // what a velocity may do in a step
  const double slack = high - low + TOLERANCE * most + ROUND * round / dt;
  if (mean >= low - slack && mean <= high + slack) return;
  const auto text =
      fmt::format("Fix fsi/move {}: on step {} the displacement v_{} changes by {:g} per time, but "
                  "the velocity v_{} is {:g}: expected its derivative{}",
                  id, update->ntimestep, given->name(k), mean, given->name(VELOCITY + k), v_end,
                  i < 0 ? "" : fmt::format(" (atom {})", atom->tag[i]));
  if (i < 0) error->all(FLERR, text);
  error->one(FLERR, text);
}

// where a particle that started there is after the time t, and how fast
void FixFSIMove::follow(const double *from, double t, double *x, double *v) const
{
  const double c = std::cos(omega * t), s = std::sin(omega * t);
  if (motion == LINEAR || motion == WIGGLE) {
    for (int k = 0; k < 3; k++) {
      x[k] = from[k] + rate[k] * (motion == LINEAR ? t : s);
      v[k] = rate[k] * (motion == LINEAR ? 1.0 : omega * c);
    }
    return;
  }
  // about the axis: from P + C, its foot on the axis, with A across to it and B = axis x A
  double d[3], along = 0.0, a[3];
  for (int k = 0; k < 3; k++) {
    d[k] = from[k] - point[k];
    along += d[k] * axis[k];
  }
  for (int k = 0; k < 3; k++) a[k] = d[k] - along * axis[k];
  for (int k = 0; k < 3; k++) {
    const int l = (k + 1) % 3, m = (k + 2) % 3;
    const double b = axis[l] * a[m] - axis[m] * a[l];
    x[k] = point[k] + along * axis[k] + a[k] * c + b * s + rate[k] * t;
    v[k] = omega * (b * c - a[k] * s) + rate[k];
  }
}

void FixFSIMove::where(int i, double t, double *x, double *v) const
{
  if (motion != VARIABLE) return follow(original[i], t, x, v);
  for (int k = 0; k < 3; k++) {
    x[k] = original[i][k] + (*given)(k, i);
    v[k] = (*given)(VELOCITY + k, i);
  }
}

bool FixFSIMove::velocity_at_end(int i, double *v) const
{
  double x[3];
  if (motion != VARIABLE) follow(original[i], Clock::now(update) - origin, x, v);
  for (int k = 0; k < domain->dimension; k++) {
    if (!sets_velocity(k) || given->source(VELOCITY + k) == Values::ATOM) return false;
    if (motion == VARIABLE) v[k] = given->number(VELOCITY + k);
  }
  return true;
}

// In a step: positions to its middle, where forces are; velocities and positions to its end. What
// is free goes with position Verlet, as fix fsi has it.
void FixFSIMove::move(When when)
{
  const double dt = update->dt;
  const double back = when == MIDDLE ? 0.5 * dt : when == BACK ? dt : 0.0;
  const double t = Clock::now(update) - origin - back;
  if (motion == VARIABLE) {
    const double clock = update->atime;
    update->atime -= back;
    given->evaluate(igroup, 0, 2 * VELOCITY);
    update->atime = clock;
    if (back == 0.0) evaluated = update->ntimestep;
  }
  double **f = atom->f;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    double *const x = atom->x[i], *const v = atom->v[i];
    double old[3] = {x[0], x[1], x[2]};
    double to[3], fast[3];
    where(i, t, to, fast);
    for (int k = 0; k < domain->dimension; k++) {
      if (when == END && driven[k] && of_atom(k)) {
        double moved[3] = {};
        moved[k] = to[k] - x[k];
        to_nearest_image(*domain, moved);
        compare_velocity(k, moved[k], 0.5 * dt, v[k], fast[k], std::fabs(x[k]) + std::fabs(to[k]),
                         i);
      }
      if (when != MIDDLE && sets_velocity(k)) v[k] = fast[k];
      if (when == START) continue;
      if (when == END && !sets_velocity(k)) v[k] += dt * force->ftm2v / atom->rmass[i] * f[i][k];
      if (driven[k])
        x[k] = to[k];
      else
        x[k] += (when == BACK ? -0.5 : 0.5) * dt * v[k];
    }
    if (when != START) domain->remap_near(x, old);
  }
}

double FixFSIMove::memory_usage()
{
  return FixFields::memory_usage() + given->memory_usage();
}

std::string FixFSIMove::text() const
{
  std::string words = MOTIONS[motion];
  if (motion == VARIABLE) return words + " " + given->text();
  for (int k = 0; k < 3; k++) words += driven[k] ? fmt::format(" {}", rate[k]) : " NULL";
  if (motion == ROTATE || motion == TRANSROT)
    words += fmt::format(" about {} {} {} along {} {} {}", point[0], point[1], point[2], axis[0],
                         axis[1], axis[2]);
  return words + (motion == LINEAR ? "" : fmt::format(" with {} radians per time", omega));
}

void FixFSIMove::write_restart(FILE *fp)
{
  Record record(lmp, command);
  record.add("motion", text());
  record.add("origin", std::vector<double>{origin});
  fields.write(record);
  record.write(fp);
}

// another motion begins here
void FixFSIMove::restart(char *buf)
{
  const Record record(lmp, command, buf);
  begun = !record.has("motion") || record.value("motion") == text();
  if (begun) {
    origin = record.numbers("origin")[0];
    fields.read(record);
    return;
  }
  if (comm->me == 0)
    error->warning(FLERR,
                   "Fix fsi/move {}: the motion was {} {}, and is {} now: it begins anew, with the "
                   "time and the places of the file",
                   id, record.value("motion"), Keywords::OF_RESTART, text());
  fields.read(record, {"place before the motion"});
}

// a particle that was made in a run: where it was at the start of the motion
void FixFSIMove::set_arrays(int i)
{
  domain->unmap(atom->x[i], atom->image[i], original[i]);
  const double t = Clock::now(update) - origin;
  if (!(atom->mask[i] & groupbit) || !begun || t == 0.0) return;
  double shift[3] = {0.0, 0.0, 0.0};
  if (motion == VARIABLE) {
    // not evaluated here: a variable may sum over ranks, and only this one makes the atom
    if (given->of_atoms())
      error->one(FLERR, "Cannot add atoms to fix fsi/move {} with an atom-style variable", id);
    if (evaluated != update->ntimestep)
      error->one(FLERR,
                 "Cannot add atoms to fix fsi/move {} now: its variables are known from the setup "
                 "of a run on. Give run 0 before",
                 id);
    for (int k = 0; k < 3; k++) shift[k] = given->number(k);
  } else if (motion == ROTATE || motion == TRANSROT) {
    turn_back(original[i], t);
    return;
  } else
    for (int k = 0; k < 3; k++) shift[k] = rate[k] * (motion == LINEAR ? t : std::sin(omega * t));
  for (int k = 0; k < 3; k++)
    if (driven[k]) original[i][k] -= shift[k];
}

// a place after the time t to that at the start of the motion
void FixFSIMove::turn_back(double *x, double t) const
{
  // the turn alone, backwards, of what has not been shifted; follow() shifts it back once more
  double from[3], v[3];
  for (int k = 0; k < 3; k++) from[k] = x[k] - rate[k] * t;
  follow(from, -t, x, v);
  for (int k = 0; k < 3; k++) x[k] += rate[k] * t;
}
