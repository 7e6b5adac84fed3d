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

// Before the first step, and when the list of effects changes: this list; numbers that are legal
// and most likely not what was meant, with what to type; what has nothing to act on.

#include "fsi_part.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix_fsi_dt.h"
#include "fsi_cells.h"
#include "fsi_find.h"
#include "fsi_gather.h"
#include "fsi_hub.h"
#include "fsi_kernel.h"
#include "fsi_keywords.h"
#include "fsi_limits.h"
#include "fsi_preset.h"
#include "fsi_sight.h"
#include "group.h"
#include "math_extra.h"
#include "modify.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <iterator>
#include <set>
#include <vector>

using namespace LAMMPS_NS;
using namespace FSI;

static constexpr double BIG = 1.0e300;
static constexpr double SAME_PLACE = 1.0e-3;    // of the spacing
static constexpr double NEIGHBORS = 1.25;       // spacings within which a particle has some

namespace {

// clang-format off
enum Kind {    // of particles that are counted
  FLUIDS, SOLIDS, HELD_FLUID, BODIES, GOING_BODIES, INTEGRATED_BODIES, EXCLUDED, ACTED_ON,
  TEARING, FALLING, WEIGHTLESS_FLUID, WEIGHTLESS_SOLID, WEIGHTLESS_RIGID, STANDING_WALLS, NKIND
};
// clang-format on

struct Near {    // two particles, or bodies
  double r;      // spacings
  tagint a, b;
  int around;    // direction in which they meet around the box, or -1
};

// What there is, on all ranks, and what is asked of each particle
struct Census : public Pointers {
  // clang-format off
  using Pointers::atom, Pointers::comm, Pointers::domain, Pointers::error, Pointers::group,
      Pointers::lmp, Pointers::modify, Pointers::neighbor, Pointers::update, Pointers::world;
  // clang-format on
  const Discretization &disc;
  const Walls &walls;
  const BodyForces &body_forces;
  const std::vector<Part *> &parts;
  const int substeps;
  const Facts fluids, solids;    // of their pair styles
  std::vector<int> present;      // types that are fluid or move
  Found found[NKIND];
  double fastest = 0.0;    // speed of fluids

  Census(LAMMPS *, const Discretization &, const StepState &, const std::vector<Part *> &);
  const State &state(int i) const { return disc.state[atom->type[i]]; }
  double dx(int i) const { return disc.dx_of(atom->type[i]); }
  bool fluid(int i) const { return state(i).species == FLUID; }
  bool solid(int i) const { return state(i).species == SOLID; }
  bool moves(int i) const { return solid(i) && atom->mask[i] & disc.mover->groupbit; }
  bool weighs(int i) const
  {
    const auto g = body_forces.on(i);
    return g[0] != 0.0 || g[1] != 0.0 || g[2] != 0.0;
  }
  bool goes(int i) const
  {
    const double *const v = atom->v[i];
    return v[0] != 0.0 || v[1] != 0.0 || v[2] != 0.0;
  }
  int kinds_of(int i, bool moved, bool streams, int bodies) const;
  bool excludes_neighbors(int i) const;
  bool acted_on(int i, bool moved) const;
  bool at_first() const { return update->ntimestep == 0; }
  bool any(Kind kind) const { return found[kind].count > 0; }
  template <class Choose> Cells cells(double size, Choose choose) const
  {
    return {atom, disc.dim, size, choose};
  }
  double coarsest() const;
  std::vector<int> types_of(int species) const;
  template <class... T> void warn(const char *format, const T &...values) const
  {
    if (comm->me == 0)
      error->warning(FLERR, "Fix fsi: " + fmt::vformat(format, fmt::make_format_args(values...)));
  }
};

}    // namespace

Census::Census(LAMMPS *lmp, const Discretization &disc, const StepState &step,
               const std::vector<Part *> &parts) :
    Pointers(lmp),
    disc(disc), walls(step.walls), body_forces(step.body_forces), parts(parts),
    substeps(step.substeps), fluids(facts_of_fluids(lmp)), solids(facts_of_solids(lmp)),
    present(atom->ntypes + 1)
{
  int rigid = 0;
  for (const auto &fix : modify->get_fix_by_style("^rigid")) rigid |= fix->groupbit;
  const bool streams = fluids.style && std::any_of(parts.begin(), parts.end(), [](const Part *p) {
                         return p->rank() == Part::STREAMS || p->rank() == Part::OPEN_ENDS;
                       });
  Found of_rank[NKIND];
  for (int i = 0; i < atom->nlocal; i++) {
    const bool moved = is_moved(i, lmp);
    if (fluid(i) || moves(i)) present[atom->type[i]] = 1;    // what is held limits nothing
    if (fluid(i)) fastest = std::max(fastest, std::sqrt(MathExtra::lensq3(atom->v[i])));
    const int kinds = kinds_of(i, moved, streams, rigid);
    for (int k = 0; k < NKIND; k++) {
      if (!(kinds & 1 << k)) continue;
      of_rank[k].count++;
      of_rank[k].first = std::min(of_rank[k].first, atom->tag[i]);
    }
  }
  present = over_ranks(present, MPI_MAX, world);
  fastest = over_ranks(fastest, MPI_MAX, world);
  for (int k = 0; k < NKIND; k++) found[k] = total_of(of_rank[k], world);
}

// bits of the kinds that a particle is of; bodies: bit of the groups of rigid ones
int Census::kinds_of(int i, bool moved, bool streams, int bodies) const
{
  const bool heavy = weighs(i);
  const auto bit = [](bool is, int kind) {
    return is ? 1 << kind : 0;
  };
  int kinds = bit(fluids.style && acted_on(i, moved), ACTED_ON) |
      bit(state(i).species == RIGID && !moved && goes(i), STANDING_WALLS);
  const bool sums = fluid(i) || (solid(i) && solids.style == Facts::OF_SOLIDS);
  kinds |= bit(sums && excludes_neighbors(i), EXCLUDED);
  if (fluid(i))
    kinds |= bit(true, FLUIDS) | bit(!moved, HELD_FLUID) |
        bit(streams && moved && state(i).floor == 0.0 && !heavy, TEARING);
  if (solid(i))
    kinds |= bit(true, SOLIDS) | bit(solids.style, BODIES) | bit(moved || goes(i), GOING_BODIES) |
        bit(moves(i), INTEGRATED_BODIES);
  const bool falls = fluid(i) ? moved : solid(i) ? moves(i) : (atom->mask[i] & bodies) != 0;
  if (falls)
    kinds |= bit(heavy, FALLING) |
        bit(!heavy && state(i).species != NONE, WEIGHTLESS_FLUID + state(i).species - FLUID);
  return kinds;
}

// neigh_modify exclude takes from sums over neighbors what is beside it
bool Census::excludes_neighbors(int i) const
{
  const int t = atom->type[i], mask = atom->mask[i];
  for (int k = 0; k < neighbor->nex_type; k++)
    if (t == neighbor->ex1_type[k] || t == neighbor->ex2_type[k]) return true;
  for (int k = 0; k < neighbor->nex_group; k++)
    if (mask & (neighbor->ex1_bit[k] | neighbor->ex2_bit[k])) return true;
  for (int k = 0; k < neighbor->nex_mol; k++)
    if (mask & neighbor->ex_mol_bit[k]) return true;
  return false;
}

bool Census::acted_on(int i, bool moved) const
{
  static constexpr double LITTLE = 1.0e-9;    // of what sound would do in a spacing
  const double *const f = atom->f[i];
  if (goes(i)) return true;
  if (!moved) return false;
  const double most = LITTLE * atom->rmass[i] * state(i).wave_speed_sq() / dx(i);
  return weighs(i) || std::fabs(f[0]) + std::fabs(f[1]) + std::fabs(f[2]) > most;
}

double Census::coarsest() const
{
  double most = 0.0;
  for (size_t t = 1; t < disc.resolution.size(); t++) most = std::max(most, disc.dx_of(t));
  return most;
}

// that are present
std::vector<int> Census::types_of(int species) const
{
  std::vector<int> types;
  for (size_t t = 1; t < present.size(); t++)
    if (present[t] && disc.state[t].species == species) types.push_back(t);
  return types;
}

// a density that no material has in the units of the script, or a solid softer than jelly
static void units(const Census &c)
{
  const char *const style = c.update->unit_style;
  const bool si = strcmp(style, "si") == 0;
  double water = si ? 1000.0 : 0.0;    // 0: units are not those of continua
  for (const char *other : {"cgs", "micro", "nano"})
    if (strcmp(style, other) == 0) water = 1.0;
  for (size_t t = 1; t < c.present.size(); t++) {
    if (!c.present[t] || water == 0.0) continue;
    const State &s = c.disc.state[t];
    const double longitudinal = std::sqrt(s.wave_speed_sq());
    if (s.rho0 < 1.0e-4 * water || s.rho0 > 30.0 * water)
      c.warn("the density {:g} of type {} is that of no material in units {}, in which "
             "water has {:g}",
             s.rho0, t, style, water);
    else if (si && s.species == SOLID && longitudinal < 1.0)
      c.warn("elastic waves in type {} run at {:.2g} m/s only: moduli are in pascal, 1 MPa = 1e6",
             t, longitudinal);
  }
}

// A background pressure is a numerical choice, but compresses bodies as any other pressure does
static void background(const Census &c)
{
  static constexpr double MUCH = 0.05;    // of the volume
  double p = 0.0;
  for (const int t : c.types_of(FLUID)) p = std::max(p, c.disc.state[t].p0);
  for (const int t : c.types_of(SOLID)) {
    const State &s = c.disc.state[t];
    if (p > MUCH * s.rho0 * s.csq)
      c.warn(
          "the background pressure {:g} compresses bodies of type {}, of bulk modulus {:.3g}, by "
          "{:.0f} % of their volume: take less of it, or a larger Poisson's ratio",
          p, t, s.rho0 * s.csq, 100.0 * p / (s.rho0 * s.csq));
  }
}

static void box(const Census &c)
{
  for (int d = 0; d < c.disc.dim; d++)
    if (c.domain->periodicity[d] && c.domain->prd[d] < 2.0 * c.disc.cut)
      c.warn("the periodic box is {:g} long in {}, less than twice the kernel's "
             "support {:g}: particles see the same neighbor on both sides",
             c.domain->prd[d], "xyz"[d], c.disc.cut);
}

// direction of the periodic face beyond which a particle is; -1: it is in the box
static int around_box(const Census &c, int i)
{
  for (int d = 0; d < c.disc.dim; d++)
    if (c.domain->periodicity[d] &&
        (c.atom->x[i][d] < c.domain->boxlo[d] || c.atom->x[i][d] >= c.domain->boxhi[d]))
      return d;
  return -1;
}

// distances to nearest neighbors: sum[0] over sum[1] particles that have one, of sum[2];
// particles of bodies and walls beside each
static Near find_nearest(const Census &c, double *sum, std::vector<double> &of_bodies)
{
  const Atom *const atom = c.atom;
  Near closest = {BIG, 0, 0, -1};
  double here[3] = {0.0, 0.0, 0.0};
  const Cells cells = c.cells(NEIGHBORS * c.coarsest(), [&](int i) {
    return c.state(i).species != NONE;
  });
  for (int i = 0; i < atom->nlocal; i++) {
    if (c.state(i).species == NONE) continue;
    double nearest = NEIGHBORS * NEIGHBORS;    // over the spacing between the two lattices
    int next = -1;
    cells.around(atom->x[i], [&](int j, double rsq) {
      const double apart = 0.5 * (c.dx(i) + c.dx(j));
      if (c.fluid(i) && !c.fluid(j) && rsq < NEIGHBORS * NEIGHBORS * apart * apart)
        of_bodies[i] += std::pow(std::min(1.0, c.dx(j) / apart), c.disc.dim);    // finer: more
      if (j == i || rsq >= nearest * apart * apart) return;
      nearest = rsq / (apart * apart);
      next = j;
    });
    here[2]++;
    if (next < 0) continue;
    const double r = std::sqrt(nearest);
    const bool wall = !c.fluid(i) && !c.solid(i);
    if (r < SAME_PLACE && !wall)
      c.error->one(FLERR,
                   "Fix fsi: atoms {} and {} are at the same place, {}: were they "
                   "created twice? delete_atoms overlap",
                   atom->tag[i], atom->tag[next], place_text(atom->x[i]));
    here[0] += r;
    here[1]++;
    if (r < closest.r && !(wall && !c.fluid(next) && !c.solid(next)))    // walls may cross
      closest = {r, std::min(atom->tag[i], atom->tag[next]),
                 std::max(atom->tag[i], atom->tag[next]), around_box(c, next)};
  }
  MPI_Allreduce(here, sum, 3, MPI_DOUBLE, MPI_SUM, c.world);
  return closest;
}

// are particles as far apart as they were said to be (returned), no two of them at one place?
static bool spacing(const Census &c)
{
  double sum[3];
  std::vector<double> of_bodies(c.atom->nlocal, 0.0);
  const Near closest = find_nearest(c, sum, of_bodies);
  const double dx = c.disc.dx, mean = sum[1] > 0.0 ? sum[0] / sum[1] : 0.0;
  if (sum[2] < 2.0) return true;
  const Near all = of_least(closest.r, closest, c.world);
  // of water that flows it is 0.85; of lattices that overlap few are near each other
  const bool fine = c.at_first() && all.r > 0.6 && mean < 0.82, sparse = sum[1] < 0.5 * sum[2],
             other = fine || mean < 0.6 || mean > 1.1;
  if (sparse)
    c.warn("most particles have no neighbor within {:g}: is {:g} the spacing of the lattice?",
           NEIGHBORS * dx, dx);
  else if (other)
    c.warn("nearest neighbors are {:.3g} apart on average, but the spacing is {:g}: is that of the "
           "lattice?",
           mean * dx, dx);
  if (sparse || other) return false;
  const auto inside = find_particles(c.atom, c.world, [&](int i) {
    return of_bodies[i] >= (c.disc.dim == 2 ? 3.5 : 6.5);    // beside a face are 3, 6 at most
  });
  if (inside.count)
    c.warn("{} fluid particles, the first of them atom {}, are inside a body or wall: fsi/displace "
           "takes out the fluid in whose place a body is",
           inside.count, inside.first);
  else if (c.at_first() && all.r < (c.disc.has_levels() ? 0.35 : 0.4))    // halves: 0.39 in 3D
    c.warn("atoms {} and {} are {:.2g} spacings apart{}", all.a, all.b, all.r,
           all.around < 0
               ? std::string(": do bodies or phases overlap? Put them on one lattice, or "
                             "fsi/displace")
               : fmt::format(" around the periodic box: make it a whole number of "
                             "spacings long in {}",
                             "xyz"[all.around]));
  return true;
}

// Bodies that begin within each other's range of contact are pushed apart with its energy at once.
static void contact(const Census &c)
{
  static constexpr double LITTLE = 0.02, OVERLAP = 0.8;    // of the range; spacings
  const double range = c.solids.contact;
  Near least = {BIG, 0, 0, -1};
  const Cells cells = c.cells(range * c.coarsest(), [&](int i) {
    return c.solid(i);
  });
  for (int i = 0; i < c.atom->nlocal; i++) {
    if (!c.solid(i)) continue;
    const tagint body = c.atom->molecule[i];
    cells.around(c.atom->x[i], [&](int j, double rsq) {
      const double apart = std::sqrt(rsq) / (0.5 * (c.dx(i) + c.dx(j)));
      const tagint other = c.atom->molecule[j];
      if (apart >= std::min(least.r, (1.0 - LITTLE) * range) || other == body ||
          !(c.moves(i) || c.moves(j)))
        return;
      least = {apart, std::min(body, other), std::max(body, other), -1};
    });
  }
  const auto all = of_least(least.r, least, c.world);
  if (all.r == BIG) return;
  return c.warn(
      "bodies {} and {} {} {:.2g} spacings apart at the start, and contact reaches {:.3g}: it "
      "pushes at once. Move them apart{}",
      all.a, all.b, all.r < OVERLAP ? "overlap, with particles" : "begin", all.r, range,
      all.r < 1.0 - 1.0e-6
          ? ""
          : fmt::format(", or contact {:.3g}", std::floor(10.0 * all.r + 1.0e-6) / 10.0));
}

// A body that ends at a mirror wall is free there: mirror walls act on fluid. Not where weight acts
// along the wall's normal (that is a floor, and without weight it may be one), nor where the body
// fills what is between two walls.
static void cut_by_walls(const Census &c)
{
  static constexpr double NEAR = 0.75;
  const auto &walls = c.walls.wall;
  std::vector<std::set<tagint>> ends(walls.size()), through(walls.size());    // bodies
  for (int i = 0; i < c.atom->nlocal; i++) {
    if (!c.moves(i) || !c.weighs(i)) continue;
    const auto g = c.body_forces.on(i);
    for (size_t k = 0; k < walls.size(); k++) {
      const double apart = walls[k].distance(c.atom->x[i]) / c.dx(i);
      if (walls[k].noslip || c.atom->mask[i] & walls[k].joins || apart >= NEAR ||
          g[walls[k].axis] != 0.0 || !walls[k].spans(c.atom->x[i], 0.0))
        continue;
      (apart > 0.0 ? ends : through)[k].insert(c.atom->molecule[i]);
    }
  }
  for (size_t k = 0; k < walls.size(); k++) {
    ends[k] = gather(ends[k], c.world);
    for (const tagint body : gather(through[k], c.world)) ends[k].erase(body);
  }
  for (size_t k = 0; k < walls.size(); k++)
    for (const tagint body : ends[k]) {
      bool both = false;
      for (size_t n = 0; n < walls.size(); n++)
        both |=
            walls[n].axis == walls[k].axis && walls[n].side != walls[k].side && ends[n].count(body);
      if (!both)
        return c.warn(
            "body {} ends at the mirror wall at {} = {:.10g}, and its face there is free, since "
            "these walls act on fluid alone: a body cut by a plane of symmetry needs symmetry yes, "
            "or must be held there",
            body, "xyz"[walls[k].axis], walls[k].position);
    }
}

// Hourglass control of pair_style fsi/solid turns forces of a pair with each particle by itself:
// their sum and moment do not vanish, which a clamp bears.
static void hourglass(const Census &c)
{
  if (!c.solids.hourglass) return;
  std::set<tagint> held, moving;
  for (int i = 0; i < c.atom->nlocal; i++)
    if (c.solid(i)) (c.moves(i) ? moving : held).insert(c.atom->molecule[i]);
  held = gather(held, c.world);
  for (const tagint body : gather(moving, c.world))
    if (!held.count(body))
      return c.warn("body {} has no held particles: hourglass of pair_style fsi/solid does not "
                    "keep its energy and momentum. Leave it out, or take pair_style fsi/solid/tl",
                    body);
}

// law svk and neohookean know no yield stress, and fix fsi/stress only where it is told to
static void yields(const Census &c)
{
  for (const auto *part : c.parts)
    for (const auto &effect : part->effects())
      if (effect.keyword == "fix fsi/stress plastic" && effect.on && c.solids.by_rate) return;
  for (const int t : c.types_of(SOLID))
    if (c.disc.state[t].yield > 0.0)
      c.warn("the material of type {} has a yield stress, but stays elastic: it acts "
             "with law hypo of pair_style fsi/solid/tl, or with pair_style fsi/solid, "
             "and fix fsi/stress ... plastic",
             t);
}

// A scene that is at rest and stays so: no velocity, no force, no fix but those that only watch.
static void nothing_acts(const Census &c)
{
  static const char *const watching[] = {"fsi/dt",       "fsi/watch", "fsi/report", "fsi/stress",
                                         "fsi/spectrum", "fsi/wall/", "gravity",    "ave/",
                                         "print",        "halt",      "vector",     "balance",
                                         "store/",       "STORE/",    "FSI_"};
  for (const auto &fix : c.modify->get_fix_list())
    if (fix != c.disc.mover &&
        std::none_of(std::begin(watching), std::end(watching), [&](const char *s) {
          return strncmp(fix->style, s, strlen(s)) == 0;
        }))
      return;
  const bool moving = std::any_of(c.walls.wall.begin(), c.walls.wall.end(), [](const Wall &w) {
    return w.velocity[0] != 0.0 || w.velocity[1] != 0.0 || w.velocity[2] != 0.0;
  });
  if (c.found[ACTED_ON].count || moving) return;
  c.warn("nothing moves this scene: no gravity, no velocity, no moving wall, no force at the "
         "start. "
         "Is fix gravity missing?");
}

// of the fluid along a direction, from face to face
static double extent(const Census &c, const std::array<double, 3> &e)
{
  double here[2] = {-BIG, -BIG}, ends[2];
  for (int i = 0; i < c.atom->nlocal; i++) {
    if (!c.fluid(i)) continue;
    double s = 0.0;
    for (int d = 0; d < c.disc.dim; d++) s += e[d] * c.atom->x[i][d];
    here[0] = std::max(here[0], s + 0.5 * c.dx(i));
    here[1] = std::max(here[1], -s + 0.5 * c.dx(i));
  }
  MPI_Allreduce(here, ends, 2, MPI_DOUBLE, MPI_MAX, c.world);
  return ends[0] + ends[1];
}

// What artificial viscosity is worth: half of alpha h c/2(d+2), since it acts on approach only
// (doc/src/theory.rst)
static void viscosity(const Census &c, int type, double speed, double length)
{
  const State &s = c.disc.state[type];
  const double alpha = c.fluids.alpha,
               nu = 0.25 * alpha * c.disc.h_of(type) * s.c / (c.disc.dim + 2);
  if (alpha == 0.0) return;
  std::string text = fmt::format("  artificial viscosity, alpha {:g}, of type {} acts like a "
                                 "kinematic viscosity of about {:.2g}",
                                 alpha, type, nu);
  if (speed > 0.0)
    text +=
        fmt::format(": Reynolds number {:.2g} with speed {:.3g} and the fluid's least width {:.3g}",
                    speed * length / nu, speed, length);
  if (c.comm->me == 0) utils::logmesg(c.lmp, text + "\n");
  const double laminar = s.viscosity / s.rho0;
  if (c.fluids.laminar && laminar > 0.0 && nu > laminar)
    c.warn("artificial viscosity of type {} is worth {:.2g}, {:.2g} times its laminar "
           "viscosity {:.2g}: take alpha {:.1g} or less, or a finer spacing",
           type, nu, nu / laminar, laminar, 0.1 * alpha * laminar / nu);
}

// Where it points, and its size; 0 where it drives a flow along a channel
static double gravity(const Census &c, int type, std::array<double, 3> &down)
{
  down = c.body_forces.of_type[type];
  double g = 0.0;
  for (int d = 0; d < c.disc.dim; d++) g += down[d] * down[d];
  g = std::sqrt(g);
  for (double &component : down) component /= g > 0.0 ? g : 1.0;
  for (int d = 0; d < c.disc.dim; d++)
    if (down[d] != 0.0 && c.domain->periodicity[d]) return 0.0;
  return g;
}

// Speed of sound against that of the fluid, or what falling through its own height makes. Of what
// swings by so little the frequency decides
static void speeds(const Census &c)
{
  static constexpr double LINEAR = 1.0e5;
  const auto types = c.types_of(FLUID);
  if (types.empty()) return;
  std::array<double, 3> down;
  const double g = gravity(c, types[0], down);
  double width = BIG;
  const double height = g > 0.0 ? extent(c, down) : 0.0, falls = std::sqrt(2.0 * g * height),
               expected = std::max(c.fastest, falls);
  for (int d = 0; d < c.disc.dim; d++) {
    std::array<double, 3> axis = {};
    axis[d] = 1.0;
    width = std::min(width, extent(c, axis));
  }
  const bool swings = g == 0.0 && c.found[INTEGRATED_BODIES].count > 0;
  bool said = expected == 0.0;
  for (const int t : types) {
    const double sound = c.disc.state[t].c, times = sound / expected;
    const bool fast = sound > 50.0 * expected, slow = sound < (7.0 - 1.0e-3) * expected;
    if (!said && fast && !(swings && sound > LINEAR * expected))
      c.warn("the speed of sound {:g} of the fluid is {:.2g} times the speed {:.3g} that there is "
             "or falling gives: 10 times is enough. If the fluid should be faster: velocity ... "
             "units box (its default are lattice units per time)",
             sound, times, expected);
    else if (!said && slow)
      c.warn("the speed of sound {:g} of the fluid is {:.1f} times {}, {:.3g}: it should be 7 to "
             "10 times the fastest flow, sound {:.3g}",
             sound, times,
             c.fastest > falls ? std::string("its speed at the start")
                               : fmt::format("sqrt(2gH) of its height H = {:.3g}", height),
             expected, 10.0 * expected);
    said = said || fast || slow;
    viscosity(c, t, expected, width);
  }
}

// Fluids of several spacings: where those that meet differ by much, or see each other through a
// band, pressure is noisy. What bodies and walls may differ by is as in Check.
static void levels(const Census &c)
{
  static constexpr double JUMP = 1.45, COARSEST = 2.0, FINEST = 4.0, ROUND = 1.0 + 1.0e-6;
  const Cells cells = c.cells(c.disc.cut, every);
  // fluid for which meets(i, j) holds with any of its neighbors
  const auto fluid_that = [&](auto meets) {
    return find_particles(c.atom, c.world, [&](int i) {
      if (!c.fluid(i)) return false;
      bool found = false;
      const double cut_i = c.disc.resolution[c.atom->type[i]].cut;
      cells.around(c.atom->x[i], [&](int j, double rsq) {
        const double cut = c.fluid(j) ? 0.5 * (cut_i + c.disc.resolution[c.atom->type[j]].cut)
                                      : cut_i;
        found = found || (rsq < cut * cut && meets(i, j));
      });
      return found;
    });
  };
  const auto bad = fluid_that([&](int i, int j) {
    return c.state(j).species != NONE && !c.fluid(j) &&
        (c.dx(j) > ROUND * COARSEST * c.dx(i) || ROUND * FINEST * c.dx(j) < c.dx(i));
  });
  if (bad.count)
    c.error->all(FLERR,
                 "Fix fsi: {} fluid particles, the first of them atom {}, meet a body or wall that "
                 "is more than {:g} times coarser or {:g} times finer: put fluid of another "
                 "spacing there",
                 bad.count, bad.first, COARSEST, FINEST);
  if (!c.at_first()) return;
  const auto jumps = fluid_that([&](int i, int j) {
    return c.fluid(j) && c.dx(i) > JUMP * c.dx(j);
  });
  if (!jumps.count) return;
  return c.warn("{} fluid particles, the first of them atom {}, meet fluid more than {:g} "
                "times finer: pressure is noisy there. Put a band of a spacing between them, "
                "wider than the kernel's support",
                jumps.count, jumps.first, JUMP);
}

// Fluids that see each other through a body or wall thinner than the kernel's support, less what
// hardly counts, where thin would be accepted; of one type after the other, while those that it
// goes on in count as well (fsi_sight.h). Some of the fluid beside it are enough.
static tagint first_that_sees_through(const Census &c, int type, const Cells &fluids)
{
  static constexpr double PART = 0.95, HIDDEN = 0.5;
  static constexpr size_t ENOUGH = 2000;
  const Atom *const atom = c.atom;
  std::vector<double> types(c.present.size(), 0.0);
  types[type] = 1.0;
  Sight sight(c.lmp, c.disc, c.walls, types);
  sight.find_bodies();
  std::vector<int> beside;
  for (int i = 0; i < atom->nlocal; i++)
    if (c.fluid(i) && sight.near(atom->x[i])) beside.push_back(i);
  tagint least = MAXTAGINT;
  for (size_t k = 0; k < beside.size(); k += beside.size() / ENOUGH + 1) {
    const int i = beside[k];
    sight.look_from(atom->x[i], c.disc.cut);
    fluids.around(atom->x[i], PART * c.disc.cut, [&](int j, double rsq) {
      const double cut =
          0.5 * (c.disc.resolution[atom->type[i]].cut + c.disc.resolution[atom->type[j]].cut);
      if (j != i && atom->tag[i] < least && rsq < PART * cut * PART * cut &&
          !c.walls.row().divide(atom->x[i], atom->x[j]) && sight.may_hide(atom->x[j], 0.0) &&
          sight.visible(atom->x[j], cut) < HIDDEN)
        least = atom->tag[i];
    });
  }
  return over_ranks(least, MPI_MIN, c.world);
}

static void seen_through(const Census &c)
{
  const Discretization &disc = c.disc;
  if (disc.density_fluid != Discretization::CONTINUITY ||
      disc.density_solid != Discretization::CONTINUITY || c.fluids.couples_stress)
    return;
  const Cells fluids = c.cells(0.5 * 0.95 * disc.cut, [&](int i) {
    return c.fluid(i);
  });
  for (size_t t = 1; t < c.present.size(); t++) {
    if (disc.thin[t] != 0.0 || !disc.state[t].is_body()) continue;
    const tagint first = first_that_sees_through(c, t, fluids);
    if (first < MAXTAGINT)
      c.warn("fluid atom {} sees fluid on the other side of a body or wall of type {}, "
             "which is thinner than the kernel's support {:g}: if pressures on its two "
             "sides differ, they mix. Then fix {} ... thin {}",
             first, t, disc.cut, c.disc.mover->id, t);
  }
}

// In water on a mirror wall the lowest row is pressed against its own image, which does not push it
// any more; where few rows are above it, water that rests on the wall's repulsion loses volume.
static void shallow(const Census &c)
{
  static constexpr double BESIDE = 1.0;    // spacings
  for (const auto &w : c.walls.wall) {
    const int rows = w.hydrostatic ? 4 : 8;    // that rest
    double here[2] = {-BIG, -BIG}, all[2];     // top, minus bottom
    for (int i = 0; i < c.atom->nlocal; i++) {
      const double s = w.distance(c.atom->x[i]) / c.dx(i);
      if (!c.fluid(i) || w.side * c.body_forces.on(i)[w.axis] >= 0.0 || !w.spans(c.atom->x[i], 0.0))
        continue;
      here[0] = std::max(here[0], s);
      here[1] = std::max(here[1], -s);
    }
    MPI_Allreduce(here, all, 2, MPI_DOUBLE, MPI_MAX, c.world);
    if (-all[1] < BESIDE && all[0] + all[1] + 1.5 < rows)
      c.warn("fluid is {:.2g} spacings deep on the mirror wall at {} = {:g}: under its "
             "weight less than {} rows sink there, by 4 to 48 % in 30 s. {}build the "
             "wall of particles",
             all[0] + all[1] + 1.0, "xyz"[w.axis], w.position, rows,
             w.hydrostatic ? "Better " : "Give it hydrostatic yes, or ");
  }
}

// Walls of particles that have a velocity and that no fix moves: along its face such a wall is a
// belt, with others before and behind each of its particles; across it, what presses never comes
static void standing_walls(const Census &c)
{
  static constexpr double BESIDE = 1.5, NEXT = 0.6;    // spacings
  if (!c.any(STANDING_WALLS)) return;
  const Cells fluids = c.cells(BESIDE * c.coarsest(), [&](int i) {
    return c.fluid(i);
  });
  const Cells walls = c.cells(NEXT * c.coarsest(), [&](int i) {
    return c.state(i).species == RIGID;
  });
  bigint stand = 0;
  const auto across = find_particles(c.atom, c.world, [&](int i) {
    const double *const x = c.atom->x[i], *const v = c.atom->v[i], dx = c.dx(i);
    if (c.state(i).species != RIGID || !c.goes(i) || is_moved(i, c.lmp) ||
        !fluids.any_within(x, BESIDE * dx))
      return false;
    stand++;
    const auto next = [&](double step) {
      const double way = step / MathExtra::len3(v);
      const double p[3] = {x[0] + way * v[0], x[1] + way * v[1], x[2] + way * v[2]};
      return walls.any_within(p, NEXT * dx);
    };
    return !next(dx) || !next(-dx);
  });
  if (2 * across.count > count_of(stand, c.world))
    c.warn("{} wall particles, the first of them atom {}, have a velocity across their face, and "
           "no fix moves them: fix move or fix fsi/move",
           across.count, across.first);
}

// A lattice of fluid ends half a spacing from a mirror wall, and closes around the periodic box: if
// not, their distance is no whole number of spacings, and what is missing expands.
static void ends(const Census &c)
{
  static constexpr double OFF = 0.15, CLOSE = 0.4, FEW = 5.0;    // spacings; particles of a row
  const auto &walls = c.walls.wall;
  const size_t faces = walls.size() + 2 * c.disc.dim;
  std::vector<double> here(2 * faces);    // how many are next to each; distances
  for (int i = 0; i < c.atom->nlocal; i++) {
    if (!c.fluid(i)) continue;
    const double *const x = c.atom->x[i];
    const auto add = [&](size_t face, double apart) {
      if (apart < 0.0 || apart > 1.0) return;
      here[2 * face]++;
      here[2 * face + 1] += apart;
    };
    for (size_t k = 0; k < walls.size(); k++)
      if (walls[k].spans(x, 0.0)) add(k, walls[k].distance(x) / c.dx(i));
    for (int d = 0; d < c.disc.dim; d++) {
      if (!c.domain->periodicity[d]) continue;
      add(walls.size() + 2 * d, (x[d] - c.domain->boxlo[d]) / c.dx(i));
      add(walls.size() + 2 * d + 1, (c.domain->boxhi[d] - x[d]) / c.dx(i));
    }
  }
  const auto row = over_ranks(here, MPI_SUM, c.world);
  const auto is_row = [&](size_t face) {
    return row[2 * face] >= FEW;
  };
  const auto mean = [&](size_t face) {
    return row[2 * face + 1] / row[2 * face];
  };
  for (size_t k = 0; k < walls.size(); k++)
    if (is_row(k) && std::fabs(mean(k) - 0.5) > OFF)
      c.warn(
          "the first row of fluid is {:.2g} spacings from the mirror wall at {} = {:g}, not half "
          "of one: is the distance of the walls a whole number of spacings?",
          mean(k), "xyz"[walls[k].axis], walls[k].position);
  for (int d = 0; d < c.disc.dim; d++) {
    const size_t lo = walls.size() + 2 * d, hi = lo + 1;
    if (!is_row(lo) || !is_row(hi)) continue;
    const double apart = mean(lo) + mean(hi);
    if (apart >= CLOSE && std::fabs(apart - 1.0) > OFF)    // closer ones: spacing()
      c.warn("the fluid's rows are {:.2g} spacings apart around the periodic box: make it a whole "
             "number of spacings long in {}",
             apart, "xyz"[d]);
  }
}

// Where runs begin to fail (doc/notes/fluid.md, Courant number), over the limit of fix fsi/dt
static void time_step(const Census &c)
{
  static constexpr struct {
    int cause;
    double fails;
  } causes[] = {{Limits::SOUND, 2.0}, {Limits::ELASTIC, 1.6}, {Limits::LAMINAR, 2.0}};
  if (!fixes_of<FixFSIDt>(c.lmp).empty()) return;
  Limits limits(c.lmp);
  limits.find(c.disc, nullptr, c.disc.mover->groupbit, c.substeps > 1);
  limits.reduce();
  double good = Limits::UNLIMITED, most = good;
  const char *what = "";
  for (const auto &cause : causes) {
    const double limit = std::min(limits.step[cause.cause], c.substeps * limits.sub[cause.cause]);
    good = std::min(good, limit);
    if (cause.fails * limit < most) {
      most = cause.fails * limit;
      what = Limits::names[cause.cause];
    }
  }
  const double dt = c.update->dt;
  if (good == Limits::UNLIMITED) return;
  if (dt > most)
    return c.warn(
        "the time step {:g} is too long for {}, {:.3g} at most: timestep {:.3g}, or fix fsi/dt", dt,
        what, most, good);
  if (dt >= 0.02 * good || dt == 0.0) return;
  return c.warn("the time step {:g}{} is {:.2g} times shorter than it has to be: timestep "
                "{:.3g}, or fix fsi/dt",
                dt, c.update->dt_default ? ", LAMMPS' default," : "", good / dt, good);
}

// Pressure that is large beside rho u^2 works against shifting at walls of particles
static void pressed(const Census &c)
{
  const auto *const preset = c.fluids.preset;
  if (preset && preset->full && c.fluids.shift_every > 0 && c.any(FALLING) &&
      any_is(c.parts, &Facts::particle_walls))
    c.warn("with gravity shifting at walls of particles feeds the fluid energy: leave fix gravity "
           "out, which moves nothing in a vessel full of one fluid, or give preset {} shift 0",
           preset->name);
}

// Particles that are counted: there are {0}, the first is {1}; {2} is the group of fix {3}. Said
// where there are some of the kind `given`, and none of `but`; NKIND: in any case.
// Flow behind a body draws: where no weight keeps the pressure above 0, water that cannot bear
// tension opens holes there, and with shifting loses particles.
static constexpr struct {
  Kind of, given, but;
  const char *text;
} COUNTED[] = {
    {HELD_FLUID, NKIND, NKIND,
     "{0} fluid particles, the first of them atom {1}, are not in group {2} of fix {3}: they stay "
     "where they are"},
    {BODIES, NKIND, GOING_BODIES,
     "all {0} particles of elastic bodies, the first of them atom {1}, are not in group {2} of fix "
     "{3}: they stay where they are"},
    {EXCLUDED, NKIND, NKIND,
     "neigh_modify exclude hides neighbors from {0} particles, the first of them atom {1}: "
     "their sums over neighbors are wrong"},
    {TEARING, NKIND, NKIND,
     "a stream without tension opens holes where its pressure falls to 0, as behind a body: unless "
     "it is a jet in air, give pair_style fsi/fluid background of about rho U^2, U being its "
     "largest speed, and tension yes"},
    {WEIGHTLESS_FLUID, FALLING, NKIND,
     "{0} moving particles of fluids, the first of them atom {1}, are in the group of no fix "
     "gravity, while others are: they weigh nothing"},
    {WEIGHTLESS_SOLID, FALLING, NKIND,
     "{0} moving particles of elastic bodies, the first of them atom {1}, are in the group of no "
     "fix gravity, while others are: they weigh nothing"},
    {WEIGHTLESS_RIGID, FALLING, NKIND,
     "{0} moving particles of rigid bodies, the first of them atom {1}, are in the group of no fix "
     "gravity, while others are: they weigh nothing"}};

static void advise(const Census &c)
{
  units(c);
  background(c);
  box(c);
  if (spacing(c) && c.solids.style) {
    if (c.at_first()) contact(c);
    cut_by_walls(c);
    yields(c);
    hourglass(c);
  }
  for (const auto &[of, given, but, text] : COUNTED)
    if (c.any(of) && (given == NKIND || c.any(given)) && (but == NKIND || !c.any(but)))
      c.warn(text, c.found[of].count, c.found[of].first, c.group->names[c.disc.mover->igroup],
             c.disc.mover->id);
  if (c.fluids.style) {
    nothing_acts(c);
    speeds(c);
    if (c.disc.has_levels()) levels(c);
    if (c.at_first()) {
      seen_through(c);
      shallow(c);
      pressed(c);
      standing_walls(c);
      ends(c);
    }
  }
  time_step(c);
}

static std::vector<Part::Effect> effects_of(const Census &c, bool keeps_account)
{
  const auto modes = Discretization::density_names(SOLID);
  std::vector<Part::Effect> effects;
  const auto add = [&](const std::string &name, const char *keyword, bool on) {
    effects.push_back({name, keyword, on});
  };
  if (c.fluids.style)
    add(fmt::format("density of the fluid by {}", modes[c.disc.density_fluid]), "", true);
  if (c.solids.style == Facts::OF_SOLIDS)
    add(fmt::format("density of the solid by {}", modes[c.disc.density_solid]), "", true);
  for (const auto *p : c.parts)
    for (const auto &e : p->effects()) effects.push_back(e);
  if (c.fluids.style) {
    int planes = 0, groups = 0;
    for (const auto &w : c.walls.wall) planes += w.joins != 0;
    for (const auto *p : c.parts) groups += p->facts().particle_walls;
    add(fmt::format("{} mirror walls", c.walls.wall.size()), "fix fsi/wall/mirror", c.walls.any());
    add(fmt::format("{} planes of symmetry of solids", planes), "fix fsi/wall/mirror symmetry",
        planes > 0);
    add(fmt::format("{} groups of wall particles", groups), "fix fsi/wall/particle", groups > 0);
  }
  if (c.solids.style == Facts::OF_TOTAL_LAGRANGIAN_SOLIDS) {
    const bool chosen = any_is(c.parts, &Facts::chooses_substeps);
    add(chosen ? "solid sub-steps, as many as fix fsi/dt chooses"
               : fmt::format("{} solid sub-steps", c.substeps),
        "fix fsi substeps", chosen || c.substeps > 1);
  }
  if (c.disc.article) add("what the article's scheme sets where nothing else is said", "", true);
  add("energy balance", "compute fsi/energy", keeps_account);
  return effects;
}

static std::string list_effects(const Census &c, bool keeps_account)
{
  static const char *const kernels[] = {"cubic spline", "quintic spline", "Wendland C2"};
  const Discretization &disc = c.disc;
  std::string on, off, finer;
  for (const auto &e : effects_of(c, keeps_account))
    if (e.on)
      on += "\n    " + e.name;
    else
      off += (off.empty() ? "" : ", ") + e.keyword;
  for (size_t t = 1; t < disc.resolution.size(); t++)
    if (disc.dx_of(t) != disc.dx)
      finer += fmt::format("{} {:g} of type {}", finer.empty() ? "," : " and", disc.dx_of(t), t);
  auto text = fmt::format(
      "FSI: {}, h = {:g} dx, dx = {:g}{}\n  on: {}\n  off (keyword that turns it on): {}\n",
      kernels[disc.kernel], disc.h / disc.dx, disc.dx, finer, on, off.empty() ? "none" : off);
  if (c.fluids.style) {
    const auto s = lattice_stiffness(ChosenKernel(disc.kernel, disc.dim, disc.h), disc.dx);
    text += fmt::format("  a lattice of the fluid under a pressure p has a modulus of {:.3f} p "
                        "when stretched, {:.3f} p in shear (a fluid: 0)\n",
                        s.stretch, s.shear);
  }
  return text;
}

// effects that a script names and that have nothing to act on
static void warn_idle(const Census &c)
{
  const bigint solids = c.found[SOLIDS].count;
  const auto nothing = [&](const std::string &what, const std::string &why) {
    if (c.comm->me == 0) c.error->warning(FLERR, what + " has nothing to act on: " + why);
  };
  auto parts = c.parts;
  for (auto *p : computes_of<Part>(c.lmp)) parts.push_back(p);
  for (const auto *p : parts) p->find_idle({c.found[FLUIDS].count, solids}, nothing);
  if (c.substeps > 1 && solids == 0) nothing("Fix fsi substeps", "no particle is a solid");
  if (c.disc.article) return;
  if (c.disc.density_fluid != Discretization::CONTINUITY && !c.fluids.style)
    nothing("Fix fsi fluid density", "there is no pair_style fsi/fluid");
  if (c.disc.density_solid != Discretization::CONTINUITY && !c.solids.style)
    nothing("Fix fsi solid density", "there is no pair_style fsi/solid");
}

void FSI::announce(LAMMPS *lmp, const Discretization &disc, const StepState &step,
                   const std::vector<Part *> &parts, bool keeps_account, std::string &announced)
{
  const Census c(lmp, disc, step, parts);
  const auto text = list_effects(c, keeps_account);
  // commands may have made fluid that nothing moves
  const auto now = fmt::format("{}{}", text, c.found[HELD_FLUID].count);
  if (now == announced) return;
  announced = now;
  if (c.comm->me == 0) utils::logmesg(lmp, text);
  advise(c);
  warn_idle(c);
}
