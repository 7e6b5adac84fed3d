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

#include "fix_fsi_wall_mirror.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix_fsi.h"
#include "fsi_find.h"
#include "fsi_gather.h"
#include "fsi_hub.h"
#include "fsi_keywords.h"
#include "fsi_profile.h"
#include "fsi_record.h"
#include "fsi_walls.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <map>

using namespace LAMMPS_NS;
using namespace FSI;

static constexpr double BIG = 1.0e300, EDGE = HUGE_VAL;    // stand for INF, EDGE

FixFSIWallMirror::FixFSIWallMirror(LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg)
{
  if (!atom->style_match("fsi")) error->all(FLERR, "Fix fsi/wall/mirror requires atom_style fsi");

  read_walls(narg, arg);
  check_symmetry();
  for (const auto &w : walls) start.push_back(w.position);
  force_on.resize(walls.size());
  begin_state(false);
  dynamic_group_allow = 1;
  scalar_flag = array_flag = 1;
  size_array_rows = walls.size();
  size_array_cols = 3;
  extscalar = extarray = 1;
  global_freq = 1;
  restart_global = 1;
  nevery = force_reneighbor = 1;
  next_reneighbor = -1;
}

// one keyword at a time, and the values that follow it
void FixFSIWallMirror::read_walls(int narg, char **arg)
{
  static const std::vector<std::string> faces = {"xlo", "xhi", "ylo", "yhi", "zlo", "zhi"};
  double place, low, high, velocity[3], distance;
  int axis, slip, joins, hydrostatic;
  Keywords words(lmp, "fix fsi/wall/mirror");
  for (const auto &name : faces) words.key(name).number(place, 0.0).or_word("EDGE", EDGE);
  words.key("range").choice(axis, 0, {"x", "y", "z"}, "axis");
  words.number(low, 0.0).or_word("INF", -BIG).number(high, 0.0).or_word("INF", BIG);
  words.key("velocity");
  for (double &v : velocity) words.number(v, 0.0);
  words.key("slip").logical(slip, true);
  words.key("symmetry").logical(joins, false);
  words.key("hydrostatic").logical(hydrostatic, false);
  words.key("guard").number(distance, guard, Range::between(0.0, 0.45));

  std::vector<bool> slip_given;    // of each wall
  for (int iarg = 3, next; iarg < narg; iarg = next) {
    const std::string key = arg[iarg];
    next = iarg + 1;
    while (next < narg && !words.knows(arg[next])) next++;
    words.parse(next - iarg, arg + iarg);
    if (std::find(faces.begin(), faces.end(), key) != faces.end()) {
      add_wall(key, place);
      slip_given.push_back(false);
    } else if (key == "guard") {
      guard = distance;
    } else if (walls.empty()) {
      error->all(FLERR, "Fix fsi/wall/mirror {} must follow the wall that it belongs to", key);
    } else if (key == "range") {
      add_range(walls.back(), axis, low, high);
    } else if (key == "velocity") {
      std::copy_n(velocity, 3, walls.back().velocity);
    } else if (key == "slip") {
      walls.back().noslip = !slip;
      slip_given.back() = true;
    } else if (key == "hydrostatic") {
      walls.back().hydrostatic = hydrostatic;
    } else
      walls.back().joins = joins ? groupbit : 0;
  }
  if (walls.empty())
    error->all(FLERR, "Fix fsi/wall/mirror needs at least one of xlo, xhi, ylo, yhi, zlo, zhi");
  warn_of_slip(slip_given);
}

// key: xlo to zhi
void FixFSIWallMirror::add_wall(const std::string &key, double place)
{
  Wall w = {};
  w.axis = key[0] - 'x';
  w.side = key[1] == 'l' ? 1.0 : -1.0;
  if (w.axis == 2 && domain->dimension == 2)
    error->all(FLERR, "Fix fsi/wall/mirror {} is not possible for dimension 2", key);
  w.position = place != EDGE ? place : w.side > 0.0 ? domain->boxlo[w.axis] : domain->boxhi[w.axis];
  std::fill_n(w.lo, 3, -BIG);
  std::fill_n(w.hi, 3, BIG);
  walls.push_back(w);
}

// extent along another axis
void FixFSIWallMirror::add_range(Wall &w, int along, double low, double high) const
{
  if (along == w.axis)
    error->all(FLERR, "Fix fsi/wall/mirror range axis {} is the normal of its wall", "xyz"[along]);
  if (low >= high) error->all(FLERR, "Fix fsi/wall/mirror range {} {} is empty", low, high);
  w.lo[along] = low;
  w.hi[along] = high;
  w.finite = true;
}

// a plane of symmetry is unlimited, at rest, and without friction
void FixFSIWallMirror::check_symmetry() const
{
  for (const auto &w : walls) {
    if (!w.joins) continue;
    const bool moves = w.velocity[0] != 0.0 || w.velocity[1] != 0.0 || w.velocity[2] != 0.0;
    if (w.finite || w.noslip || moves)
      error->all(
          FLERR,
          "Fix fsi/wall/mirror symmetry: wall {} is unlimited, at rest and slips, expected no {}",
          w.face(),
          w.finite       ? "range"
              : w.noslip ? "slip no"
                         : "velocity");
  }
}

// a channel of which one wall slips is most likely one whose script says slip once for both
void FixFSIWallMirror::warn_of_slip(const std::vector<bool> &slip_given) const
{
  for (size_t a = 0; a < walls.size() && comm->me == 0; a++)
    for (size_t b = 0; b < walls.size(); b++)
      if (walls[a].axis == walls[b].axis && walls[a].noslip && !walls[b].noslip && !slip_given[b])
        error->warning(FLERR,
                       "Fix fsi/wall/mirror {}: slip no is of wall {} alone, wall {} slips: slip "
                       "belongs to the wall that it follows",
                       id, walls[a].face(), walls[b].face());
}

void FixFSIWallMirror::init()
{
  for (const auto &w : walls)
    if (domain->periodicity[w.axis])
      error->all(FLERR, "Cannot use fix fsi/wall/mirror {} in periodic dimension {}", w.face(),
                 "xyz"[w.axis]);
  FixFSI::find(lmp, "Fix fsi/wall/mirror")->link(disc, step, ledger);
  for (const auto *other : fixes_of<FixFSIWallMirror>(lmp))
    for (const auto &w : walls) check_same(w, *other);
}

// images of a plane that is there twice would count twice
void FixFSIWallMirror::check_same(const Wall &w, const FixFSIWallMirror &of) const
{
  for (const auto &o : of.walls) {
    bool same = &o != &w && o.axis == w.axis && o.side == w.side &&
        std::fabs(o.position - w.position) < 1.0e-6 * disc->dx;
    for (int d = 0; d < domain->dimension; d++)
      same = same && o.lo[d] < w.hi[d] && w.lo[d] < o.hi[d];
    if (same)
      error->all(FLERR,
                 "Fix fsi/wall/mirror {}: wall {} at {:.10g} is twice there, also in fix {}: its "
                 "images would count twice, since they act on all fluids",
                 id, w.face(), w.position, of.id);
  }
}

// a fluid particle that starts behind a wall is a mistake in the script, and so is one of a wall
// where its images are
void FixFSIWallMirror::setup(int)
{
  static constexpr double LEAST = 0.25;    // spacings, half a one is meant
  double **x = atom->x;
  const int *const mask = atom->mask, *const type = atom->type;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(mask[i] & groupbit)) continue;
    const int species = disc->state[type[i]].species;
    for (const auto &w : walls) {
      if (species == FLUID && !w.finite && w.distance(x[i]) < -disc->dx)
        error->one(FLERR, "Fluid atom {} at {} is behind the {} wall of fix {}", atom->tag[i],
                   place_text(x[i]), w.face(), id);
      if (species == RIGID && w.joins && w.distance(x[i]) < LEAST * disc->dx_of(type[i]))
        error->one(
            FLERR,
            "Wall atom {} is {:g} before the plane of symmetry {} of fix {}: expected half a "
            "spacing, {:g}, or more",
            atom->tag[i], w.distance(x[i]), w.face(), id, 0.5 * disc->dx_of(type[i]));
    }
  }
}

std::vector<int> FixFSIWallMirror::find_outside(const InnerBox &inner)
{
  const auto *const x = vectors(atom->x);
  const int *const mask = atom->mask, *const type = atom->type;
  return step->those(atom->nlocal, [&](int i) {
    return !inner.contains(x[i]) && (mask[i] & groupbit) && disc->state[type[i]].species == FLUID;
  });
}

// after the first drift: walls move along, and a fluid particle nearer than its guard distance, or
// behind the wall, is reflected. A segment acts on what has come through it in this step, not on
// what flows behind it. The ledger has velocities of the middle of a step, half a kick on, of which
// the kick of gravity is not reflected. What that of the other forces differs by, density takes up.
void FixFSIWallMirror::post_integrate()
{
  const Phase phase(step->profile, Profile::WALLS);
  auto *const x = vectors(atom->x), *const v = vectors(atom->v);
  const double dth = 0.5 * update->dt;

  double fastest = 0.0;
  for (auto &w : walls) {
    w.position += dth * w.velocity[w.axis];
    if (w.finite) fastest = std::max(fastest, std::fabs(w.velocity[w.axis]));
  }
  // before one passes through pairs that were not listed as those that it may divide
  if (fastest * update->dt * (neighbor->ago + 2) > 0.5 * neighbor->skin)
    next_reneighbor = update->ntimestep;
  turns.clear();

  // dx is the coarsest fluid's
  for (const int i : find_outside(InnerBox(walls, guard * disc->dx))) {
    const double near = guard * disc->dx_of(atom->type[i]);
    for (const auto &w : walls) {
      const double a = w.distance(x[i]);
      if (a >= near || (w.finite && !w.spans(x[i], 0.0))) continue;
      // behind a segment already at the last step: it flows there by right
      const double ahead = update->dt * w.side * (v[i][w.axis] - w.velocity[w.axis]);
      if (w.finite && a < 0.0 && a < ahead) continue;
      const double before = ledger->kept ? step->body_forces.potential(i) : 0.0;
      x[i][w.axis] += w.side * 2.0 * (near - a);
      if (ledger->kept)
        ledger->energy_out[Ledger::WALLS] += before - step->body_forces.potential(i);
      const double vn = v[i][w.axis] - w.velocity[w.axis];
      if (vn * w.side < 0.0) {
        if (ledger->kept)
          ledger->energy_out[Ledger::WALLS] += 2.0 * vn * atom->rmass[i] *
              (v[i][w.axis] - vn + dth * step->body_forces.on(i)[w.axis]);
        v[i][w.axis] -= 2.0 * vn;
        if (step->profile) step->profile->reflected[w.axis] -= 2.0 * vn * atom->rmass[i];
      }
      reflected++;
      turns.push_back({atom->tag[i], static_cast<int>(&w - walls.data()), vn * w.side < 0.0, near});
    }
  }
}

void FixFSIWallMirror::end_of_step()
{
  for (size_t k = 0; k < walls.size(); k++) {
    Wall &w = walls[k];
    w.position += 0.5 * update->dt * w.velocity[w.axis];
    if (ledger->kept)
      for (int d = 0; d < 3; d++)
        ledger->energy_out[Ledger::WALLS] += update->dt * force_on[k][d] * w.velocity[d];
  }
}

Facts FixFSIWallMirror::facts() const
{
  Facts facts = only(&Facts::mirror_walls);
  facts.segments = std::any_of(walls.begin(), walls.end(), [](const Wall &w) {
    return w.finite;
  });
  return facts;
}

void FixFSIWallMirror::add_walls(Walls &all, std::vector<WallForce> &forces)
{
  all.wall.insert(all.wall.end(), walls.begin(), walls.end());
  for (auto &f : force_on) forces.push_back(f.data());
}

void FixFSIWallMirror::begin_state(bool)
{
  for (auto &f : force_on) f = {0.0, 0.0, 0.0};
}

// Particles that this step has reflected, on whatever rank they are now, are back in front of it
// with their own velocity: they have been moved back by half a step with the reflected one.
void FixFSIWallMirror::go_back()
{
  reflected -= turns.size();
  const auto all = gather(turns, world);
  std::map<tagint, int> place;
  for (const Turn &t : all) place[t.tag] = -1;
  for (int i = 0; i < atom->nlocal && !place.empty(); i++)
    if (const auto it = place.find(atom->tag[i]); it != place.end()) it->second = i;
  for (auto t = all.rbegin(); t != all.rend(); ++t) {
    const int i = place[t->tag];
    if (i < 0) continue;
    const Wall &w = walls[t->wall];
    double &x = atom->x[i][w.axis], &v = atom->v[i][w.axis];
    const double dth = atom->mask[i] & disc->mover->groupbit ? 0.5 * update->dt : 0.0;
    x = 2.0 * (w.position + w.side * t->near) - (x + dth * v);
    if (t->turned) v = 2.0 * w.velocity[w.axis] - v;
    x -= dth * v;
  }
  for (auto &w : walls) w.position -= 0.5 * update->dt * w.velocity[w.axis];
}

void FixFSIWallMirror::find_idle(const Census &all, const Idle &nothing) const
{
  const Facts fluid = facts_of_fluids(lmp);
  bool joins = false, noslip = false;
  for (const auto &w : walls) {
    joins = joins || w.joins;
    noslip = noslip || w.noslip;
  }
  if (joins && all.solids > 0) return;
  if (!fluid.style)
    nothing("Fix fsi/wall/mirror", "walls mirror fluids, and there is no pair_style fsi/fluid");
  else if (all.fluids == 0)
    nothing("Fix fsi/wall/mirror", "no particle is a fluid");
  else if (noslip && !fluid.laminar)
    nothing("Fix fsi/wall/mirror slip no", "pair_style fsi/fluid has no laminar/visc");
}

// number of reflections since the fix was defined
double FixFSIWallMirror::compute_scalar()
{
  return static_cast<double>(count_of(reflected, world));
}

// force of the fluid on wall i
double FixFSIWallMirror::compute_array(int i, int j)
{
  return sum_of(force_on[i][j], world);
}

// restart: count of reflections and where the walls are; a wall that the command puts elsewhere
// than before stands there
std::string FixFSIWallMirror::settings(int k) const
{
  const Wall &w = walls[k];
  std::string text = fmt::format("velocity {} {} {} slip {} guard {}", w.velocity[0], w.velocity[1],
                                 w.velocity[2], w.noslip ? "no" : "yes", guard);
  if (w.joins) text += " symmetry yes";
  if (w.hydrostatic) text += " hydrostatic yes";
  for (int b = 0; b < 3; b++)
    if (w.lo[b] > -BIG || w.hi[b] < BIG)
      text += fmt::format(" range {} {} {}", "xyz"[b], w.lo[b], w.hi[b]);
  return text;
}

std::string FixFSIWallMirror::faces() const
{
  std::string all;
  for (const auto &w : walls) all += (all.empty() ? "" : " ") + w.face();
  return all;
}

void FixFSIWallMirror::write_restart(FILE *fp)
{
  Record record(lmp, "fix fsi/wall/mirror");
  record.add("reflections", std::vector<double>{compute_scalar()});
  record.add("walls", faces());
  for (size_t k = 0; k < walls.size(); k++) {
    record.add(fmt::format("place {}", k), std::vector<double>{start[k], walls[k].position});
    record.add(fmt::format("settings {}", k), settings(k));
  }
  record.write(fp);
}

void FixFSIWallMirror::restart(char *buf)
{
  const Record record(lmp, "fix fsi/wall/mirror", buf);
  if (faces() != record.value("walls"))
    error->all(FLERR,
               "Fix fsi/wall/mirror {} has the walls {}, the restart file {} of it: give it "
               "another ID to place all walls anew",
               id, faces(), record.value("walls"));
  reflected = (comm->me == 0) ? static_cast<bigint>(record.numbers("reflections")[0]) : 0;
  for (size_t k = 0; k < walls.size(); k++) {
    const auto place = record.numbers(fmt::format("place {}", k));
    const auto &before = record.value(fmt::format("settings {}", k));
    if (place[0] == start[k])
      walls[k].position = place[1];
    else if (comm->me == 0)
      error->warning(FLERR,
                     "Fix fsi/wall/mirror {}: wall {} was put at {} when the restart file was "
                     "written, and is at {} now",
                     id, walls[k].face(), place[0], start[k]);
    if (before != settings(k) && comm->me == 0)
      error->warning(FLERR,
                     "Fix fsi/wall/mirror {}: wall {} had {} when the restart file was written, "
                     "and has {} now",
                     id, walls[k].face(), before, settings(k));
  }
}
