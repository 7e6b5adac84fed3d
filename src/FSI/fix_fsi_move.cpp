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
#include "fsi_record.h"
#include "input.h"
#include "lattice.h"
#include "math_const.h"
#include "memory.h"
#include "modify.h"
#include "update.h"
#include "variable.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace FSI;

/* ----------------------------------------------------------------------
   the words of the command, one after the other
------------------------------------------------------------------------- */

class FixFSIMove::Words : protected Pointers {
 public:
  Words(LAMMPS *lmp, int narg, char **arg) : Pointers(lmp), word(arg, arg + narg), at(0) { motion = next(); }
  std::string motion;

  bool any() const { return at < word.size(); }
  bool skip_null()
  {
    const bool null = any() && word[at] == "NULL";
    at += null;
    return null;
  }
  std::string next()
  {
    if (!any()) utils::missing_cmd_args(FLERR, "fix fsi/move" + (motion.empty() ? "" : " " + motion), error);
    return word[at++];
  }
  double number()
  {
    const auto text = next();
    const double x = utils::numeric(FLERR, text, false, lmp);
    if (!std::isfinite(x)) error->all(FLERR, "Fix fsi/move {} {} must be finite", motion, text);
    return x;
  }
  double period()
  {
    const double t = number();
    if (t <= 0.0) error->all(FLERR, "Fix fsi/move {} period {} must be > 0", motion, word[at - 1]);
    return t;
  }
  std::string variable()    // without v_; empty: NULL
  {
    if (skip_null()) return "";
    const auto text = next();
    if (!utils::strmatch(text, "^v_")) error->all(FLERR, "Fix fsi/move variable {} must be NULL or v_name", text);
    return text.substr(2);
  }

 private:
  std::vector<std::string> word;
  size_t at;
};

/* ---------------------------------------------------------------------- */

FixFSIMove::FixFSIMove(LAMMPS *lmp, int narg, char **arg) :
    FixFields(lmp, narg, arg), rate{}, point{}, axis{}, omega(0.0), source{FREE, FREE, FREE}, of_velocity{FREE, FREE, FREE}, origin(now()),
    original(nullptr), values(nullptr), nmax(0)
{
  if (!atom->style_match("fsi")) error->all(FLERR, "Fix fsi/move requires atom_style fsi");
  Words words(lmp, narg - 3, arg + 3);
  read_motion(words);
  read_units(words);
  if (domain->dimension == 2 && (rate[2] != 0.0 || !position[2].empty() || !velocity[2].empty()))
    error->all(FLERR, "Fix fsi/move {} cannot move along z in 2D", words.motion);

  time_integrate = 1;
  restart_global = 1;
  fields.set("place before the motion", Fields::RESTART, true, original, 3);
  register_fields();
  for (int i = 0; i < atom->nlocal; i++) domain->unmap(atom->x[i], atom->image[i], original[i]);
}

/* ---------------------------------------------------------------------- */

void FixFSIMove::read_motion(Words &words)
{
  const auto components = [&]() {
    for (int k = 0; k < 3; k++) {
      if (words.skip_null()) continue;
      rate[k] = words.number();
      source[k] = GIVEN;
    }
  };
  const auto turn = [&]() {
    for (double &p : point) p = words.number();
    for (double &a : axis) a = words.number();
    const double length = std::sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    if (length == 0.0) error->all(FLERR, "Fix fsi/move {} axis must not be of length 0", words.motion);
    for (double &a : axis) a /= length;
    if (domain->dimension == 2 && (axis[0] != 0.0 || axis[1] != 0.0)) error->all(FLERR, "Fix fsi/move {} axis must be z in 2D", words.motion);
    for (auto &s : source) s = GIVEN;
    omega = MathConst::MY_2PI / words.period();
  };

  if (words.motion == "linear") {
    style = LINEAR;
    components();
  } else if (words.motion == "wiggle") {
    style = WIGGLE;
    components();
    omega = MathConst::MY_2PI / words.period();
  } else if (words.motion == "rotate") {
    style = ROTATE;
    turn();
  } else if (words.motion == "transrot") {
    style = TRANSROT;
    for (double &r : rate) r = words.number();
    turn();
  } else if (words.motion == "variable") {
    style = VARIABLE;
    for (auto &v : position) v = words.variable();
    for (auto &v : velocity) v = words.variable();
    for (int k = 0; k < 3; k++)
      if (!position[k].empty() && velocity[k].empty())
        error->all(FLERR, "Fix fsi/move variable {} needs the variable of its velocity, too: fluid feels how fast a wall moves", position[k]);
  } else
    error->all(FLERR, "Unknown fix fsi/move style {}: expected linear, wiggle, rotate, transrot or variable", words.motion);
}

/* ---------------------------------------------------------------------- */

void FixFSIMove::read_units(Words &words)
{
  bool lattice = style != VARIABLE;
  while (words.any()) {
    const auto key = words.next();
    if (key != "units") error->all(FLERR, "Unknown fix fsi/move keyword {}: expected units", key);
    const auto value = words.next();
    if (value != "box" && value != "lattice") error->all(FLERR, "Unknown fix fsi/move units {}: expected box or lattice", value);
    lattice = style != VARIABLE && value == "lattice";
  }
  if (!lattice) return;
  const double scale[] = {domain->lattice->xlattice, domain->lattice->ylattice, domain->lattice->zlattice};
  for (int k = 0; k < 3; k++) {
    rate[k] *= scale[k];
    point[k] *= scale[k];
  }
}

/* ---------------------------------------------------------------------- */

FixFSIMove::~FixFSIMove()
{
  memory->destroy(values);
}

/* ---------------------------------------------------------------------- */

int FixFSIMove::setmask()
{
  return INITIAL_INTEGRATE | PRE_EXCHANGE | FINAL_INTEGRATE;
}

/* ---------------------------------------------------------------------- */

double FixFSIMove::now() const
{
  return update->atime + (update->ntimestep - update->atimestep) * update->dt;
}

/* ---------------------------------------------------------------------- */

void FixFSIMove::init()
{
  const auto *const fix_fsi = FixFSI::find(lmp, "Fix fsi/move");
  int mine = 0, any;
  for (int i = 0; i < atom->nlocal; i++)
    if ((atom->mask[i] & groupbit) && (atom->mask[i] & fix_fsi->groupbit)) mine = 1;
  MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, world);
  if (any) error->all(FLERR, "Particles of fix fsi/move {} are also in the group of fix fsi, which moves them, too: leave them out", id);
  if (style != VARIABLE) return;
  const auto find = [&](const std::string &name, int &n) {
    if (name.empty()) return FREE;
    n = input->variable->find(name.c_str());
    if (n < 0) error->all(FLERR, "Variable {} of fix fsi/move does not exist", name);
    if (input->variable->equalstyle(n)) return EQUAL;
    if (!input->variable->atomstyle(n)) error->all(FLERR, "Variable {} of fix fsi/move must be equal-style or atom-style", name);
    return ATOM;
  };
  for (int k = 0; k < 3; k++) {
    source[k] = find(position[k], index[k]);
    of_velocity[k] = find(velocity[k], velocity_index[k]);
  }
}

/* ----------------------------------------------------------------------
   velocities that the first forces feel
------------------------------------------------------------------------- */

void FixFSIMove::setup_pre_exchange()
{
  move(START);
}

void FixFSIMove::initial_integrate(int)
{
  move(MIDDLE);
  double shift[3];
  if (style == VARIABLE) evaluate(shift, end_speed, false);
}

void FixFSIMove::final_integrate()
{
  move(END);
}

/* ----------------------------------------------------------------------
   variables at the time that LAMMPS has
------------------------------------------------------------------------- */

void FixFSIMove::evaluate(double *shift, double *speed, bool everywhere)
{
  if (everywhere && atom->nmax > nmax) {
    nmax = atom->nmax;
    memory->destroy(values);
    memory->create(values, nmax, 6, "fsi/move:values");
  }
  modify->clearstep_compute();
  for (int k = 0; k < 3; k++) {
    if (source[k] == EQUAL) shift[k] = input->variable->compute_equal(index[k]);
    if (of_velocity[k] == EQUAL) speed[k] = input->variable->compute_equal(velocity_index[k]);
    if (everywhere && source[k] == ATOM) input->variable->compute_atom(index[k], igroup, &values[0][k], 6, 0);
    if (everywhere && of_velocity[k] == ATOM) input->variable->compute_atom(velocity_index[k], igroup, &values[0][3 + k], 6, 0);
  }
  modify->addstep_compute(update->ntimestep + 1);
}

/* ----------------------------------------------------------------------
   where a particle that started there is after the time t, and how fast
------------------------------------------------------------------------- */

void FixFSIMove::follow(const double *from, double t, double *x, double *v) const
{
  const double c = std::cos(omega * t), s = std::sin(omega * t);
  if (style == LINEAR || style == WIGGLE) {
    for (int k = 0; k < 3; k++) {
      x[k] = from[k] + rate[k] * (style == LINEAR ? t : s);
      v[k] = rate[k] * (style == LINEAR ? 1.0 : omega * c);
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

/* ---------------------------------------------------------------------- */

bool FixFSIMove::velocity_at_end(int i, double *v) const
{
  double x[3];
  if (style != VARIABLE) follow(original[i], now() - origin, x, v);
  for (int k = 0; k < domain->dimension; k++) {
    if (!sets_velocity(k) || of_velocity[k] == ATOM) return false;
    if (of_velocity[k] == EQUAL) v[k] = end_speed[k];
  }
  return true;
}

/* ----------------------------------------------------------------------
   In a step: positions to its middle, where forces are; velocities and positions to its end. What is free goes with position
   Verlet, as fix fsi has it.
------------------------------------------------------------------------- */

void FixFSIMove::move(When when)
{
  const double dt = update->dt, back = when == MIDDLE ? 0.5 * dt : 0.0, t = now() - origin - back;
  double shift[3], speed[3];
  if (style == VARIABLE) {
    update->atime -= back;
    evaluate(shift, speed, std::count(source, source + 3, ATOM) + std::count(of_velocity, of_velocity + 3, ATOM));
    update->atime += back;
  }
  double **f = atom->f;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    double *const x = atom->x[i], *const v = atom->v[i];
    double old[3] = {x[0], x[1], x[2]};
    double to[3], fast[3];
    if (style != VARIABLE) follow(original[i], t, to, fast);
    for (int k = 0; k < domain->dimension; k++) {
      if (style == VARIABLE) {
        to[k] = original[i][k] + (source[k] == ATOM ? values[i][k] : shift[k]);
        fast[k] = of_velocity[k] == ATOM ? values[i][3 + k] : speed[k];
      }
      if (when != MIDDLE && sets_velocity(k)) v[k] = fast[k];
      if (when == START) continue;
      if (when == END && !sets_velocity(k)) v[k] += dt * force->ftm2v / atom->rmass[i] * f[i][k];
      if (source[k] != FREE) x[k] = to[k];
      else x[k] += 0.5 * dt * v[k];
    }
    if (when != START) domain->remap_near(x, old);
  }
}

/* ---------------------------------------------------------------------- */

double FixFSIMove::memory_usage()
{
  return FixFields::memory_usage() + 6.0 * nmax * sizeof(double);
}

/* ---------------------------------------------------------------------- */

void FixFSIMove::write_restart(FILE *fp)
{
  Record record(lmp, "fix fsi/move");
  record.add("origin", std::vector<double>{origin});
  fields.write(record);
  record.write(fp);
}

void FixFSIMove::restart(char *buf)
{
  const Record record(lmp, "fix fsi/move", buf);
  origin = record.numbers("origin")[0];
  fields.read(record);
}

/* ----------------------------------------------------------------------
   a particle that was made in a run: where it was at the start of the motion
------------------------------------------------------------------------- */

void FixFSIMove::set_arrays(int i)
{
  domain->unmap(atom->x[i], atom->image[i], original[i]);
  const double t = now() - origin;
  if (!(atom->mask[i] & groupbit) || t == 0.0) return;
  double shift[3] = {0.0, 0.0, 0.0}, speed[3];
  if (style == VARIABLE) {
    for (const Source s : source)
      if (s == ATOM) error->one(FLERR, "Cannot add atoms to fix fsi/move {} with an atom-style variable", id);
    evaluate(shift, speed, false);
  } else if (style == ROTATE || style == TRANSROT) {
    // the turn alone, backwards, of what has not been shifted; follow() shifts it back once more
    double from[3], v[3];
    for (int k = 0; k < 3; k++) from[k] = original[i][k] - rate[k] * t;
    follow(from, -t, original[i], v);
    for (int k = 0; k < 3; k++) original[i][k] += rate[k] * t;
    return;
  } else
    for (int k = 0; k < 3; k++) shift[k] = rate[k] * (style == LINEAR ? t : std::sin(omega * t));
  for (int k = 0; k < 3; k++)
    if (source[k] != FREE) original[i][k] -= shift[k];
}
