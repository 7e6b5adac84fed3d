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
#include "fix_fsi_inlet.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix_fsi.h"
#include "force.h"
#include "fsi_cells.h"
#include "fsi_find.h"
#include "fsi_gather.h"
#include "fsi_gradient.h"
#include "fsi_kernel.h"
#include "fsi_keywords.h"
#include "fsi_nearest_image.h"
#include "fsi_nodes.h"
#include "fsi_number_density.h"
#include "fsi_population.h"
#include "fsi_record.h"
#include "fsi_shift.h"
#include "fsi_value.h"
#include "group.h"
#include "math_extra.h"
#include "neighbor.h"
#include "output.h"
#include "pair_fsi_fluid.h"
#include "region.h"
#include "thermo.h"
#include "update.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace FSI;

static constexpr double AUTO = -1.0;
static constexpr int PRESSURE = 3, NVALUES = 4;    // after the components of the velocity
static constexpr double STARVED = 1.0 / 3.0;    // of what the buffer began with; a column more or
                                                // less is there at any time
static constexpr double FIT_INDEPENDENCE = 0.05;    // a monomial is fitted if this part of its norm
                                                    // is orthogonal to the lower ones
static constexpr double NEXT = 1.01;    // in spacings along the plane: rows on both sides of a node
static constexpr double LITTLE = 1.0e-3;    // of the lattice's number density: no fluid to speak of
static constexpr double OCCUPIED = 0.5;     // of the spacing: a place is taken by who is as near
static constexpr double STIFF = 40.0;    // absorb auto over c/2L between given pressures: a channel
                                         // c/K longer, L/20
static constexpr double FAR = 0.1;    // of rho c^2: a pressure that is not one of a fluid that is
                                      // hardly compressed
static constexpr double SPARSE = 0.75;       // of the particles at the plane: a slice with fewer is
                                             // not full
static constexpr double FEW_FINER = 0.25;    // of a buffer, that are alone
static constexpr double AT_SURFACE = 0.9;    // of the density: m psi of a particle at a free
                                             // surface is less
static constexpr double EXCESS = 0.02;       // of the mass near the plane that is worth a word
static constexpr double MOST_ADDED = 0.05;    // of a pressure that is given
// Time in h/c in which particles and room come together before the plane; steps between two looks,
// and of how many looks the mean is that is told
static constexpr double SETTLE = 50.0;
static constexpr int LOOK_EVERY = 20, LOOKS = 20;
// Spacing of what comes in: part of an error that a buffer's length of inflow mends; what a lattice
// that is sheared or bent shows of one; and the range, where particles stay a fluid
static constexpr double MEND = 0.2, DISORDER = 0.005, NARROW = 0.85, WIDE = 1.15;

FixFSIInlet::FixFSIInlet(LAMMPS *lmp, int narg, char **arg) :
    FixFields(lmp, narg, arg), who(std::string("Fix ") + style), name(who + " " + id),
    outlet(who == "Fix fsi/outlet"), keywords(lmp, keywords_name()),
    given(new Values(lmp, keywords_name(), NVALUES)), nodes_held(new Nodes(lmp)), nodes(*nodes_held)
{
  if (!atom->style_match("fsi")) error->all(FLERR, "{} requires atom_style fsi", who);
  if (narg < 5) utils::missing_cmd_args(FLERR, keywords_name(), error);
  const std::string face = arg[3];
  if (face.size() != 3 || face[0] < 'x' || face[0] > 'z' ||
      (face.substr(1) != "lo" && face.substr(1) != "hi"))
    error->all(FLERR, "Unknown {} face {}: expected xlo, xhi, ylo, yhi, zlo or zhi",
               keywords_name(), face);
  axis = face[0] - 'x';
  side = face[1] == 'l' ? 1.0 : -1.0;
  if (axis >= domain->dimension)
    error->all(FLERR, "{} {} is not possible for dimension 2", who, face);
  position = numeric(lmp, who + " " + face, arg[4]);

  keywords.key("velocity").word(words[0], "").word(words[1], "").word(words[2], "");
  keywords.key("pressure").word(words[PRESSURE], "");
  keywords.key("absorb")
      .number(absorb, outlet ? AUTO : 0.0, Range::from(0.0))
      .or_word("auto", AUTO);
  keywords.key("buffer").number(given_length, AUTO, Range::above(0.0)).or_word("auto", AUTO);
  keywords.key("region").word(region_id, "");
  keywords.parse(narg - 5, arg + 5);

  const std::string p = words[PRESSURE];
  if (!words[0].empty() && !p.empty())
    error->all(FLERR,
               "{} {} takes velocity or pressure, not both: the other one is that of the fluid",
               who, face);
  if (words[0].empty() && p.empty() && !outlet)
    error->all(FLERR, "{} {} requires keyword velocity or pressure", who, face);
  if (words[0].empty()) {
    background = p.empty();
    if (!background && p != "free") given->read(PRESSURE, p, "pressure", "v_name or free");
  } else {
    for (int d = 0; d < 3; d++) {
      given->read(d, words[d], "velocity");
      if (d >= domain->dimension && (given->source(d) != Values::NUMBER || given->number(d) != 0.0))
        error->all(FLERR, "{} velocity along z must be 0 in 2D, not {}", who, words[d]);
    }
  }
  if (p == "free" && absorb > 0.0)
    error->all(FLERR, "{} absorb is not for pressure free, which has no value to go back to", who);

  force_reneighbor = 1;
  next_reneighbor = -1;    // whenever lists are built
  scalar_flag = vector_flag = 1;
  size_vector = 11;
  extscalar = 1;
  extvector = 0;
  global_freq = 1;
  restart_global = 1;
  fields.set("of the buffer", Fields::RESTART, true, of_buffer);
  fields.set("place of the copy", Fields::RESTART, true, behind, 3);
  fields.set("velocity of the copy", Fields::RESTART, true, follower, 4);
  register_fields();
}

FixFSIInlet::~FixFSIInlet()
{
  forget_ends();
}

double FixFSIInlet::reach_of_nodes() const
{
  return 2.0 * std::max(nodes.distance[0], nodes.distance[1]);
}

bool FixFSIInlet::has_own_velocity() const
{
  return !given->given(0);
}

bool FixFSIInlet::has_own_pressure() const
{
  return !given->given(PRESSURE) && !background;
}

double FixFSIInlet::value(int k, int i) const
{
  const double x = (*given)(k, i);
  if (!std::isfinite(x))
    error->one(FLERR, "{}: {} {} of atom {} at {:g} {:g} {:g} is no number{}", name,
               k == PRESSURE ? "pressure" : fmt::format("velocity along {}", "xyz"[k]), x,
               atom->tag[i], atom->x[i][0], atom->x[i][1], atom->x[i][2], given->see(k));
  return x;
}

void FixFSIInlet::init()
{
  fix_fsi = FixFSI::find(lmp, who);
  if (!facts_of_fluids(lmp).style)
    error->all(FLERR, "{} requires pair_style fsi/fluid: it is for fluids", who);
  if (fix_fsi->density_fluid != FixFSI::CONTINUITY)
    error->all(FLERR,
               "{} requires density by continuity, as fix fsi scheme standard has it: a sum cannot "
               "be prescribed",
               who);
  if (!neighbor->dist_check)
    error->all(FLERR,
               "{} requires neigh_modify check yes: particles are made and deleted when lists are "
               "built, before they have moved far",
               who);
  if (domain->periodicity[axis])
    error->all(FLERR, "{} is in periodic dimension {}: its boundary must be fixed (f)", name,
               "xyz"[axis]);

  // lists hold for half a skin; a place that becomes free at the end is filled when a column has
  // gone by. As long for any skin up to a spacing
  const double least = fix_fsi->cut + fix_fsi->dx + 0.5 * neighbor->skin,
               usual = std::max(least, fix_fsi->cut + 1.5 * fix_fsi->dx);
  length = fix_fsi->dx * std::ceil(usual / fix_fsi->dx - 1.0e-9);
  if (given_length != AUTO) {
    length = fix_fsi->dx * std::round(given_length / fix_fsi->dx);
    if (std::fabs(length - given_length) > 1.0e-6 * fix_fsi->dx)
      error->all(
          FLERR,
          "{} buffer {} must be a multiple of the spacing {}: its end is where the lattice goes on",
          who, given_length, fix_fsi->dx);
    if (length < least - 1.0e-9 * fix_fsi->dx)
      error->all(FLERR,
                 "{} buffer {} is too short: expected at least {:g}, the kernel's support {:g}, a "
                 "spacing and half the skin",
                 who, given_length, fix_fsi->dx * std::ceil(least / fix_fsi->dx - 1.0e-9),
                 fix_fsi->cut);
  }
  if (!made.empty() &&
      (std::fabs(position - made[0]) > 1.0e-6 * fix_fsi->dx ||
       std::fabs(length - made[1]) > 1.0e-6 * fix_fsi->dx))
    error->all(FLERR,
               "{}: {} has its plane at {:g} with a buffer of {:g}, here it is {:g} with {:g}: "
               "expected the same, since the buffer is full. Give keyword buffer if the skin has "
               "changed",
               name, of_file ? "the restart file" : "the last run", made[0], made[1], position,
               length);
  check_plane();
  find_region();
  given->find();
  driven = false;
  for (const auto *end : fixes_of<FixFSIInlet>(lmp)) driven = driven || !end->has_own_velocity();
  told = {};
  if (given->source(PRESSURE) == Values::NUMBER && is_far(given->number(PRESSURE))) {
    const State &soft = softest();
    const double away = std::fabs(given->number(PRESSURE) - soft.p0);
    error->all(FLERR,
               "{}: pressure {:g} is {:.3g} rho c^2 from the background, {:g}: expected {:g} at "
               "most. Is it in units {}? Else take sound {:.3g} or more in pair_style fsi/fluid",
               name, given->number(PRESSURE), away / (soft.rho0 * soft.csq), soft.p0, FAR,
               update->unit_style, std::sqrt(away / (FAR * soft.rho0)));
  }
  fix_fsi->population.leave_an_id_free();
  forget_ends();
}

// plane and buffer are inside the box
void FixFSIInlet::check_plane()
{
  // a number in a script may be that of the box but for its last digits
  const double end = position - side * length, little = 1.0e-9 * domain->prd[axis],
               lo = domain->boxlo[axis], hi = domain->boxhi[axis];
  if (position < lo - little || position > hi + little)
    error->all(FLERR, "{}: its plane at {} is outside the box, from {} to {}", name, at(position),
               lo, hi);
  // what has passed the end of the buffer is deleted with the next list
  const double half_skin = 0.5 * neighbor->skin, last = end - side * half_skin;
  if (domain->boundary[axis][side < 0.0] == 1 && (last < lo - little || last > hi + little))
    error->all(FLERR,
               "{}: its buffer, {} to {:g}, and half the neighbor skin, {:g}, must be inside the "
               "box, from {} to {}",
               name, at(position), end, half_skin, lo, hi);
}

// the part of the plane that is open
void FixFSIInlet::find_region()
{
  region = nullptr;
  if (!region_id.empty()) {
    region = domain->get_region_by_id(region_id);
    if (!region) error->all(FLERR, "Region {} of {} does not exist", region_id, keywords_name());
    if (region->dynamic_check())
      error->all(FLERR, "Region {} of {} must not move nor change", region_id, keywords_name());
    if (region->bboxflag) {
      const double from[] = {region->extent_xlo, region->extent_ylo, region->extent_zlo},
                   to[] = {region->extent_xhi, region->extent_yhi, region->extent_zhi};
      for (int d = 0; d < fix_fsi->dim; d++)
        if (d != axis && (from[d] > domain->boxhi[d] || to[d] < domain->boxlo[d]))
          error->all(FLERR, "Region {} of {}, from {} to {} along {}, is outside the box",
                     region_id, keywords_name(), from[d], to[d], "xyz"[d]);
      if (from[axis] > position || to[axis] < position)
        error->all(FLERR, "Region {} of {}, from {} to {} along {}, does not reach its plane at {}",
                   region_id, keywords_name(), from[axis], to[axis], "xyz"[axis], position);
    }
  }
}

// the fluid that a pressure compresses most; is a pressure out of its range?
const State &FixFSIInlet::softest() const
{
  const State *soft = nullptr;
  for (const auto &s : fix_fsi->state)
    if (s.species == FLUID && (!soft || s.rho0 * s.csq < soft->rho0 * soft->csq)) soft = &s;
  return soft ? *soft : fix_fsi->state[0];
}

// of what is slower than sound through the box
double FixFSIInlet::slow_rate() const
{
  double c = 0.0;
  for (const auto &s : fix_fsi->state)
    if (s.species == FLUID) c = std::max(c, s.c);
  return 0.5 * c / domain->prd[axis];
}

// hat functions, which a lattice sums to a constant
double FixFSIInlet::hat_at(double s, double spacings) const
{
  const double width = spacings * fix_fsi->dx;
  return std::max(0.0, 1.0 - std::fabs(s) / width) / width;
}

bool FixFSIInlet::is_far(double p) const
{
  const State &soft = softest();
  return soft.species == FLUID && std::fabs(p - soft.p0) > FAR * soft.rho0 * soft.csq;
}

bool FixFSIInlet::is_fluid(int i) const
{
  return (atom->mask[i] & groupbit) && fix_fsi->state[atom->type[i]].species == FLUID;
}

// a region says which part of the plane is open
bool FixFSIInlet::in_patch(const double *x) const
{
  if (!region) return true;
  double at[3] = {x[0], x[1], x[2]};
  at[axis] = position;
  domain->remap(at);
  return region->match(at[0], at[1], at[2]);
}

bool FixFSIInlet::holds(const double *x) const
{
  const double s = inside(x);
  return s <= 0.0 && s > -2.0 * length && in_patch(x);
}

// Before the first run: in an empty buffer the fluid before it goes on
void FixFSIInlet::setup_pre_exchange()
{
  for (const auto &w : fix_fsi->walls.wall) {
    const double s = side * (w.position - position);
    if (w.axis == axis && !w.finite && s < 0.5 * fix_fsi->dx && s > -length)
      error->all(FLERR, "{}: the mirror wall {}{} at {} closes it", name, "xyz"[axis],
                 w.side > 0.0 ? "lo" : "hi", w.position);
  }
  const bool has_one = filled;
  filled = true;
  made = {position, length};
  of_file = false;
  if (has_one) return;
  if (region) region->prematch();
  fill_buffer();
}

// Its slices are those of dx, the coarsest fluid's spacing. In a buffer that is there some may be
// who have found no partner on their way out
void FixFSIInlet::check_levels(bool is_empty) const
{
  const auto is_there = [this, is_empty](int i) {
    const double s = inside(atom->x[i]);
    return is_fluid(i) && in_patch(atom->x[i]) && s > -length && s < (is_empty ? length : 0.0);
  };
  const auto all = find_particles(atom, world, is_there),
             finer = find_particles(atom, world, [&](int i) {
               return fix_fsi->level_of[atom->type[i]] > 0 && is_there(i);
             });
  if (finer.count > (is_empty ? 0.0 : FEW_FINER * all.count))
    error->all(FLERR,
               "{}: {} particles of fluid finer than dx, {:g}, the first of them atom {}, are "
               "within {:g} of its plane: the fluid that comes and goes is the coarsest",
               name, finer.count, fix_fsi->dx, finer.first, length);
}

void FixFSIInlet::fill_buffer()
{
  enum { BEHIND, AHEAD, BEYOND, WALLS_BEHIND, WALLS_AHEAD, NCOUNT };
  bigint own[NCOUNT] = {}, all[NCOUNT];
  bool has_some = false;
  std::vector<int> slices(number_of_slices(), 0);
  for (int i = 0; i < atom->nlocal; i++) {
    const double s = inside(atom->x[i]);
    if (s <= -2.0 * length || s >= length) continue;
    has_some = true;
    if (fix_fsi->state[atom->type[i]].species == RIGID && s > -length)
      own[s > 0.0 ? WALLS_AHEAD : WALLS_BEHIND]++;
    if (!is_fluid(i) || !in_patch(atom->x[i])) continue;
    if (s > 0.0) {
      own[AHEAD]++;
    } else {
      own[s > -length - 0.5 * fix_fsi->dx ? BEHIND : BEYOND]++;
      of_buffer[i] = MEMBER;
      const size_t k = slice(-s);
      if (k < slices.size()) slices[k]++;
    }
  }
  MPI_Allreduce(own, all, NCOUNT, MPI_LMP_BIGINT, MPI_SUM, world);
  const auto end = at(position - side * length);
  if (all[BEHIND] == 0 && all[AHEAD] == 0 && !outlet)
    error->all(FLERR,
               "{}: there is no fluid of group {} at its plane {}: fill the buffer, to {}, or what "
               "is before it",
               name, group->names[igroup], at(position), end);
  if (all[BEYOND] > 0)
    error->all(FLERR,
               "{}: {} particles of fluid are beyond the end of its buffer, {}: {}{} has the fluid "
               "at {} {} {}",
               name, all[BEYOND], end, "xyz"[axis], side > 0.0 ? "lo" : "hi", "xyz"[axis],
               side > 0.0 ? ">" : "<", position);
  if (all[WALLS_AHEAD] > 0 && 2 * all[WALLS_BEHIND] < all[WALLS_AHEAD] && comm->me == 0)
    error->warning(FLERR,
                   "{}: {} wall particles are within {:g} before its plane, {} behind it: walls "
                   "should go on along the buffer, to {}",
                   name, all[WALLS_AHEAD], length, all[WALLS_BEHIND], end);
  check_levels(all[BEHIND] == 0);
  renew_ends(has_some);
  if (all[BEHIND] > 0) {
    slices.back() += find_last_of_rows();
    check_slices(slices);
  }
  if (all[BEHIND] == 0 && all[AHEAD] > 0) {
    const auto copies = go_on_behind();
    fix_fsi->population.begin();
    make(copies, true);
    fix_fsi->population.end();
  }
  find_places();    // of which variables are asked
  double at_plane = 0.0;
  for (const auto &place : places)
    at_plane += hat_at(inside(atom->x[place.i])) *
        std::pow(fix_fsi->dx_of(atom->type[place.i]), fix_fsi->dim);
  area = sum_of(at_plane, world);
  given->evaluate_for(places, 0, 3);
  for (int i = 0; i < atom->nlocal; i++)
    if (of_buffer[i])
      for (int d = 0; d < fix_fsi->dim; d++)
        if (given->given(d)) atom->v[i][d] = value(d, i);
}

// Slices of a spacing, counted from the plane
int FixFSIInlet::number_of_slices() const
{
  return static_cast<int>(std::round(length / fix_fsi->dx));
}

int FixFSIInlet::slice(double distance) const
{
  return std::max(0, static_cast<int>(std::ceil(distance / fix_fsi->dx - 1.0e-6)) - 1);
}

// of a buffer that the script has filled: a hole would come in again and again
void FixFSIInlet::check_slices(std::vector<int> &mine) const
{
  std::vector<int> all(mine.size());
  MPI_Allreduce(mine.data(), all.data(), (int) mine.size(), MPI_INT, MPI_SUM, world);
  const int most = *std::max_element(all.begin(), all.end());
  const auto few = std::find_if(all.begin(), all.end(), [&](int n) {
    return n < 0.5 * most;
  });
  if (few == all.end() || comm->me) return;
  const double from = position - side * (few - all.begin()) * fix_fsi->dx;
  error->warning(FLERR,
                 "{}: its buffer has {} particles from {} to {:g} and {} elsewhere: what is not "
                 "there will not come in. Fill it to {}, or leave it empty",
                 name, *few, at(from), from - side * fix_fsi->dx, most,
                 at(position - side * length));
}

// Calls visit(particle, offset from x) for those of a list, sorted by the plane's first axis, that
// are as near along it as who takes a place; images, too
template <class Visit>
void FixFSIInlet::beside(const std::vector<Particle> &sorted, const double *x, Visit visit) const
{
  const int a = first_axis(), periodic = domain->periodicity[a];
  const double reach = OCCUPIED * fix_fsi->dx;
  for (int image = -periodic; image <= periodic; image++) {
    const double from = x[a] + image * domain->prd[a] - reach;
    auto p = std::lower_bound(sorted.begin(), sorted.end(), from, [a](const Particle &b, double y) {
      return b.x[a] < y;
    });
    for (; p != sorted.end() && p->x[a] < from + 2.0 * reach; p++) {
      double d[3] = {p->x[0] - x[0], p->x[1] - x[1], p->x[2] - x[2]};
      to_nearest_image(*domain, d);
      visit(*p, d);
    }
  }
}

void FixFSIInlet::sort_along_plane(std::vector<Particle> &list) const
{
  const int a = first_axis();
  std::sort(list.begin(), list.end(), [a](const Particle &b, const Particle &c) {
    return b.x[a] < c.x[a] || (b.x[a] == c.x[a] && b.parent < c.parent);
  });
}

// In a buffer of a fix before this one: who is last of a row is to be followed, also if he has come
// a spacing from the end meanwhile, and the one behind him would have been made with the next list.
// How many those are on this rank
int FixFSIInlet::find_last_of_rows()
{
  const double nobody = fix_fsi->dx - length, low = nobody + neighbor->skin,
               reach = OCCUPIED * fix_fsi->dx;
  int missing = 0;
  std::vector<Particle> own, all;
  for (int i = 0; i < atom->nlocal; i++)
    if (of_buffer[i] && inside(atom->x[i]) <= low) own.push_back(fix_fsi->population.copy_of(i));
  if (ends != MPI_COMM_NULL) all = gather(own, ends);
  sort_along_plane(all);
  const auto is_last = [&](const double *x) {
    bool last = true;
    beside(all, x, [&](const Particle &, double *d) {
      const bool behind = side * d[axis] < 0.0;
      d[axis] = 0.0;
      if (behind && MathExtra::lensq3(d) < reach * reach) last = false;
    });
    return last;
  };
  for (int i = 0; i < atom->nlocal; i++) {
    const double s = inside(atom->x[i]);
    if (!of_buffer[i] || s > low) continue;
    if (s > nobody && !(side * atom->v[i][axis] > 0.0 && is_last(atom->x[i]))) continue;
    of_buffer[i] = LAST;
    missing += s > nobody;
  }
  return missing;
}

// Copies of the fluid at the plane that fill the buffer: of as many slices as are full, again and
// again, so that its lattice goes on. A slice is not where the fluid ends, or where a body stands
// in the way of the fluid at the plane.
std::vector<Particle> FixFSIInlet::go_on_behind() const
{
  const int most = number_of_slices(), full = full_slices();
  if (full == 0 && !outlet)
    error->all(FLERR,
               "{}: there is fluid of group {} before its plane {}, but none within a spacing of "
               "it: fill what is between, or the buffer, to {}",
               name, group->names[igroup], at(position), at(position - side * length));
  std::vector<Particle> copies;
  if (full == 0) return copies;
  const double period = fix_fsi->dx * full;
  for (int i = 0; i < atom->nlocal; i++) {
    const double *const x = atom->x[i], s = inside(x);
    if (s <= 0.0 || s >= length || !is_fluid(i) || !in_patch(x) || slice(s) >= full) continue;
    Particle c = fix_fsi->population.copy_of(i);
    for (int k = 1; slice(k * period - s) < most; k++) {
      c.x[axis] = x[axis] - side * k * period;
      copies.push_back(c);
    }
  }
  return copies;
}

// places along the plane of the fluid within a spacing of it
std::vector<FixFSIInlet::Column> FixFSIInlet::columns_at_plane() const
{
  std::vector<Column> own;
  for (int i = 0; i < atom->nlocal; i++) {
    const double *const x = atom->x[i], s = inside(x);
    if (s > 0.0 && slice(s) == 0 && is_fluid(i) && in_patch(x)) own.push_back(along(x));
  }
  return ends == MPI_COMM_NULL ? std::vector<Column>() : gather(own, ends);
}

int FixFSIInlet::full_slices() const
{
  const int most = number_of_slices();
  const double dx = fix_fsi->dx;
  std::vector<int> mine(most, 0), count(most);
  for (int i = 0; i < atom->nlocal; i++) {
    const double s = inside(atom->x[i]);
    if (s > 0.0 && slice(s) < most && is_fluid(i) && in_patch(atom->x[i])) mine[slice(s)]++;
  }
  MPI_Allreduce(mine.data(), count.data(), most, MPI_INT, MPI_SUM, world);
  int full = 0, limit = most, all;
  while (full < most && count[full] > 0 && count[full] >= SPARSE * count[0]) full++;

  const auto columns = columns_at_plane();
  int hole = 0;
  for (int i = 0; i < atom->nlocal; i++) {
    const State &state = fix_fsi->state[atom->type[i]];
    const double s = inside(atom->x[i]);
    if (s <= 0.0 || s >= length || state.species == FLUID || state.species == NONE) continue;
    const Column here = along(atom->x[i]);
    bool below = false, above = false;    // is there fluid on the same line?
    for (const Column &c : columns) {
      if (std::fabs(c[1] - here[1]) >= 0.5 * dx) continue;
      below = below || c[0] < here[0];
      above = above || c[0] > here[0];
      if (std::fabs(c[0] - here[0]) < 0.5 * dx)
        limit = std::min(limit,
                         static_cast<int>((s - 0.5 * fix_fsi->dx_of(atom->type[i])) / dx + 1.0e-6));
    }
    if (state.species == SOLID && slice(s) == 0 && below && above && !hole++)
      error->warning(FLERR,
                     "{}: atom {} of a solid is within a spacing of its plane {}: behind it the "
                     "buffer has a hole, and what is not there will not come in. Move the solid or "
                     "the plane, or fill the buffer, to {}",
                     name, atom->tag[i], at(position), at(position - side * length));
  }
  limit = std::max(limit, 1);
  MPI_Allreduce(&limit, &all, 1, MPI_INT, MPI_MIN, world);
  return std::min(full, all);
}

// sorts copies along the plane; is there somebody already where they will be?
std::vector<int> FixFSIInlet::find_occupied(std::vector<Particle> &copies, bool at_start)
{
  double low = inside(copies[0].x), high = low;
  for (auto &c : copies) {
    domain->remap(c.x);
    low = std::min(low, inside(c.x));
    high = std::max(high, inside(c.x));
  }

  sort_along_plane(copies);
  const double reach = OCCUPIED * fix_fsi->dx;
  std::vector<int> is_occupied(copies.size(), 0), occupied(copies.size());
  for (int i = 0; i < atom->nlocal; i++) {
    const double *const x = atom->x[i], s = inside(x);
    if (s < low - reach || s > high + reach) continue;
    const int species = fix_fsi->state[atom->type[i]].species;
    if (species != FLUID && !at_start) continue;    // as near as its parent is in front
    beside(copies, x, [&](const Particle &c, double *d) {
      if (MathExtra::lensq3(d) >= reach * reach) return;
      if (species != FLUID)
        error->one(FLERR,
                   "{}: atom {} of a {} at {:g} {:g} {:g} is where fluid of its buffer should be",
                   name, atom->tag[i], species == RIGID ? "wall" : "solid", x[0], x[1], x[2]);
      is_occupied[&c - copies.data()] = 1;
    });
  }
  MPI_Allreduce(is_occupied.data(), occupied.data(), occupied.size(), MPI_INT, MPI_MAX, ends);
  return occupied;
}

// Makes copies: IDs in the order in which they came to be followed, and of those of the parents,
// whatever rank has them. Fluid that is in the place keeps it.
void FixFSIInlet::make(const std::vector<Particle> &own, bool at_start)
{
  std::vector<Particle> all, copies;
  std::vector<int> occupied;
  if (ends != MPI_COMM_NULL) all = gather(own, ends);
  if (!all.empty()) occupied = find_occupied(all, at_start);
  for (size_t k = 0; k < all.size(); k++)
    if (!occupied[k]) copies.push_back(all[k]);
  std::sort(copies.begin(), copies.end(), [&](const Particle &b, const Particle &c) {
    return std::make_tuple(b.since, b.parent, -inside(b.x)) <
        std::make_tuple(c.since, c.parent, -inside(c.x));
  });
  const int first = atom->nlocal;
  fix_fsi->population.make(copies, name, at_start ? nullptr : fix_fsi->account(FixFSI::FIELDS));
  for (int i = first; i < atom->nlocal; i++) of_buffer[i] = MEMBER;
}

// when lists are built: who has passed the plane, or the end of the buffer
void FixFSIInlet::pre_exchange()
{
  if (region) region->prematch();
  const auto others = fixes_of<FixFSIInlet>(lmp);
  std::vector<Particle> copies;
  std::vector<int> gone;
  double own[5] = {}, all[5];    // in, out, net mass, made, deleted
  bool has_some = false;
  for (int i = 0; i < atom->nlocal; i++) {
    const double *const x = atom->x[i], s = inside(x);
    if (s > 0.0 && !of_buffer[i]) continue;
    has_some = true;
    if (!is_fluid(i)) {
      stranger(i);
      continue;
    }
    if (of_buffer[i] == FOLLOWED) {
      copies.push_back(fix_fsi->population.copy_of(i));
      std::copy_n(behind[i], 3, copies.back().x);
      std::copy_n(follower[i], 3, copies.back().v);
      copies.back().since = follower[i][3];
      of_buffer[i] = MEMBER;
    }
    if (of_buffer[i] && s > 0.0) {
      of_buffer[i] = NOT;
      own[0]++;
      own[2] += atom->rmass[i];
      continue;
    }
    if (!of_buffer[i] && holds(x)) {
      of_buffer[i] = MEMBER;
      own[1]++;
      own[2] -= atom->rmass[i];
    }
    if (!of_buffer[i]) continue;
    for (const auto *other : others)
      if (other != this && other->holds(x))
        error->one(FLERR,
                   "Atom {} at {:g} {:g} {:g} is in the buffers of fix {} and fix {}: keep them "
                   "apart, with keyword region",
                   atom->tag[i], x[0], x[1], x[2], id, other->id);
    if (s <= -length) gone.push_back(i);
  }
  own[3] = copies.size();
  own[4] = gone.size();
  MPI_Allreduce(own, all, 5, MPI_DOUBLE, MPI_SUM, world);
  passed_in += all[0];
  passed_out += all[1];
  mass_in += all[2];
  if (all[3] == 0.0 && all[4] == 0.0) return;

  auto &population = fix_fsi->population;
  std::vector<Particle> left;
  for (const int i : gone) left.push_back(population.copy_of(i));
  population.begin();
  population.remove(gone, fix_fsi->account(FixFSI::FIELDS));
  renew_ends(has_some);
  if (all[3] > 0.0) make(copies, false);
  population.end();
  if (all[4] > 0.0) find_next_of_rows(left);
}

// Before those that have left at the end: where flow turns before the next one of a row has come a
// spacing from the end, it is that one which another follows
void FixFSIInlet::find_next_of_rows(const std::vector<Particle> &gone)
{
  if (ends == MPI_COMM_NULL) return;
  auto all = gather(gone, ends);
  sort_along_plane(all);
  const double reach = OCCUPIED * fix_fsi->dx, far = 2.0 * fix_fsi->dx;
  std::vector<double> mine(all.size(), far), nearest(all.size());
  // visit(distance along the axis, to which one) for who is before such a one
  const auto before = [&](int i, const auto &visit) {
    if (!of_buffer[i] || inside(atom->x[i]) > far - length) return;
    beside(all, atom->x[i], [&](const Particle &p, double *d) {
      const double ahead = -side * d[axis];
      d[axis] = 0.0;
      if (ahead > 0.0 && MathExtra::lensq3(d) < reach * reach) visit(ahead, &p - all.data());
    });
  };
  for (int i = 0; i < atom->nlocal; i++)
    before(i, [&](double ahead, size_t k) {
      mine[k] = std::min(mine[k], ahead);
    });
  MPI_Allreduce(mine.data(), nearest.data(), (int) mine.size(), MPI_DOUBLE, MPI_MIN, ends);
  for (int i = 0; i < atom->nlocal; i++)
    before(i, [&](double ahead, size_t k) {
      if (of_buffer[i] == MEMBER && ahead == nearest[k]) of_buffer[i] = NEXT_OF_ROW;
    });
}

// behind the plane, and no fluid that this end lets pass: LAMMPS would say of it that it is lost,
// and no more
void FixFSIInlet::stranger(int i)
{
  const double *const x = atom->x[i];
  const int species = fix_fsi->state[atom->type[i]].species;
  if (!in_patch(x)) return;
  if (species == SOLID && inside(x) > -length)
    error->one(FLERR, "Atom {} of a solid is in the buffer of {} {}, which is for fluid alone",
               atom->tag[i], keywords_name(), id);
  const std::string what = fmt::format(
      "{}: atom {} of type {}, {},", name, atom->tag[i], atom->type[i],
      species == FLUID       ? fmt::format("a fluid that is not of group {}", group->names[igroup])
          : species == SOLID ? "of a solid"
          : species == NONE  ? "without a material"
                             : "of a wall or rigid body");
  const bool out = side > 0.0 ? x[axis] < domain->boxlo[axis] : x[axis] >= domain->boxhi[axis];
  if (out && domain->boundary[axis][side < 0.0] == 1 && output->thermo->lostflag == Thermo::ERROR)
    error->one(FLERR, "{} leaves the box through this end, which lets only fluid of its group pass",
               what);
  if (told.stranger || !fix_fsi->is_moved(i) || side * atom->v[i][axis] >= 0.0) return;
  told.stranger = true;
  error->warning(FLERR,
                 "{} moves into the buffer, which only fluid of its group can pass: it will be "
                 "lost at the end of the box",
                 what);
}

// The last of a row has come a spacing from the end: another follows it, from the next list on, but
// where it would be had it been made now, so that it does not matter when lists are built. The
// spacing is that at which particles have the room of their density (Copies made a buffer's length
// behind those that pass the plane would bring each gap again and again.)
void FixFSIInlet::follow(int i, double s)
{
  const State &state = fix_fsi->state[atom->type[i]];
  const double spacing = column * fix_fsi->dx * state.rho0 / atom->rho[i];
  const bool at_end = s <= spacing - length, is_next = of_buffer[i] == NEXT_OF_ROW;
  if (at_end && (is_next || of_buffer[i] == MEMBER)) of_buffer[i] = LAST;
  if (at_end || !(of_buffer[i] == LAST || (is_next && side * atom->v[i][axis] > 0.0))) return;
  of_buffer[i] = FOLLOWED;
  std::copy_n(atom->x[i], 3, behind[i]);
  behind[i][axis] -= side * spacing;
  std::copy_n(atom->v[i], 3, follower[i]);
  follower[i][3] = (double) update->ntimestep;
}

// to the middle of the step, whose length may be new
void FixFSIInlet::start_step()
{
  for (const auto &place : places)
    for (int d = 0; of_buffer[place.i] == FOLLOWED && d < fix_fsi->dim; d++)
      behind[place.i][d] += 0.5 * update->dt * follower[place.i][d];
}

// A velocity that is given by atom-style variables: where those who follow are
bool FixFSIInlet::find_followers()
{
  if (has_own_velocity() || !given->of_atoms()) return false;
  std::vector<Place> followed;
  for (const auto &place : places)
    if (of_buffer[place.i] == FOLLOWED) followed.push_back(place);
  if (!anywhere(!followed.empty(), world)) return true;
  const auto swap = [&]() {
    for (const auto &one : followed)
      std::swap_ranges(behind[one.i], behind[one.i] + 3, atom->x[one.i]);
  };
  swap();
  given->evaluate_for(followed, 0, 3);
  for (const auto &one : followed)
    for (int d = 0; d < 3; d++) follower[one.i][d] = value(d, one.i);
  swap();
  return true;
}

// Fluid at the plane and in the buffer, of this rank: from one list to the next
void FixFSIInlet::find_places()
{
  places.clear();
  if (region) region->prematch();
  const double from = -2.0 * length, to = zone() + neighbor->skin;
  for (int i = 0; i < atom->nlocal; i++) {
    const double s = inside(atom->x[i]);
    if (s > from && s < to && is_fluid(i) && in_patch(atom->x[i]))
      places.push_back({i, 0.0, 0.0, false});
  }

  renew_ends(!places.empty());
  if (ends == MPI_COMM_NULL) return;
  nodes.place(axis, fix_fsi->dx);
  // until the next lists particles move by half a skin, and a little
  const double moved = 0.5 * neighbor->skin + fix_fsi->dx;
  std::vector<const double *> before, behind_plane;
  for (const auto &place : places) {
    const double *const x = atom->x[place.i];
    if (inside(x) > -moved) before.push_back(x);
    if (inside(x) < moved) behind_plane.push_back(x);
  }
  nodes.share(before, fix_fsi->cut + moved, behind_plane, reach_of_nodes() + moved, ends);
}

// The ranks whose part of the box the zone of this end reaches, or who have particles there: these
// make particles and know the plane. Those that were among them stay so until the next run.
void FixFSIInlet::renew_ends(bool has_some)
{
  const double low = inside(domain->sublo), high = inside(domain->subhi);
  const bool there = has_some || domain->triclinic ||
      (std::max(low, high) > -2.0 * length - neighbor->skin &&
       std::min(low, high) < zone() + 2.0 * neighbor->skin);
  if (!anywhere(there && ends == MPI_COMM_NULL, world)) return;
  const int color = there || ends != MPI_COMM_NULL ? 0 : MPI_UNDEFINED;
  forget_ends();
  MPI_Comm_split(world, color, comm->me, &ends);
}

void FixFSIInlet::forget_ends()
{
  if (ends != MPI_COMM_NULL) MPI_Comm_free(&ends);
  ends = MPI_COMM_NULL;
}

// Pressure or normal velocity of the fluid at the nodes of a lattice in the plane: a fit, quadratic
// along the plane, of the fluid within the kernel's support, which is on one side only. (A linear
// one takes 12 U sigma^2/2 from Poiseuille's profile, and what does not come in is missing in the
// pressure, too.) Terms that the fluid there cannot tell from
// lower ones are left out.
// Where pressure is given the profile of the velocity is that of the fluid a buffer's length before
// the plane, as in a channel that goes on behind it (a mapped inlet: Tabor and Baba-Ahmadi 2010,
// Comput. Fluids 39, 553), and only its mean is that at the plane. A profile taken at the plane
// keeps itself: jets and vortices that come in grow, and a row of the buffer that pushes the
// particle before it follows what it pushes. (Half as far away some of it was left.)

// the row of a fit's inverse that gives its value at the node: terms 1, x, xx; 1, x, y, xx, xy, yy
template <int TERMS> static void value_weights(const double *moment, double *row)
{
  constexpr bool PLANE = TERMS == 6;
  constexpr int degree[] = {0, 1, PLANE ? 1 : 2, 2, 2, 2},
                power_of_y[] = {0, 0, PLANE ? 1 : 0, 0, 1, 2};
  double A[packed_size(TERMS)];
  for (int a = 0, k = 0; a < TERMS; a++)
    for (int b = 0; b <= a; b++, k++) {
      const int n = degree[a] + degree[b];
      A[k] = moment[PLANE ? n * (n + 1) / 2 + power_of_y[a] + power_of_y[b] : n];
    }
  gradient_coefficients<1, TERMS>(A, row, FIT_INDEPENDENCE);
}

// the fields at the nodes, from the sums there; first whether there is fluid at all
void FixFSIInlet::fit_nodes(int nmoment, int nfit, int nfields)
{
  for (int node = 0; node < nodes.taken.size(); node++) {
    double *const c = &nodes.sums[(size_t) node * nodes.row()], *const moment = c, row[6];
    if (moment[0] <= LITTLE * fix_fsi->psi_bulk) {
      c[0] = 0.0;
      continue;
    }
    nodes.nlateral == 2 ? value_weights<6>(moment, row) : value_weights<3>(moment, row);
    for (int field = 0; field < nfields; field++) {
      const double *const F = c + nmoment + field * nfit;
      double result = 0.0;
      for (int k = 0; k < nfit; k++) result += row[k] * F[k];
      c[1 + field] = result;
    }
    c[0] = 1.0;
  }
}

// f[0] times monomials of y: 1, x, xx, ...; 1, x, y, xx, xy, yy, ...; up to the fourth degree
static void times_monomials(bool plane, const double *y, double *f)
{
  for (int degree = 1, k = 1, before = 0; degree <= 4; degree++) {
    const int from = k;
    for (; k - from < (plane ? degree : 1); k++) f[k] = f[before + k - from] * y[0];
    if (plane) {
      f[k] = f[from - 1] * y[1];
      k++;
    }
    before = from;
  }
}

void FixFSIInlet::measure()
{
  const int dim = fix_fsi->dim;
  const bool wants_velocity = has_own_velocity(), wants_pressure = has_own_pressure();
  // monomials of the offset over dx, by their degree: those of the fit, and all that its matrix has
  const bool plane = nodes.nlateral == 2;
  const int nfit = plane ? 6 : 3, nmoment = plane ? 15 : 5;
  nbounds = nmoment + nfit * (wants_velocity + wants_pressure);
  nodes.begin(nbounds, wants_velocity ? 2 : 0);
  double total[NMEAN] = {};
  const bool pressure_varies = !told.far && !given->name(PRESSURE).empty();

  with_kernel(fix_fsi->kernel, dim, fix_fsi->h, [&](const auto &kernel) {
    for (auto &place : places) {
      const int i = place.i;
      const double *const x = atom->x[i];
      const double s = place.inside = inside(x), u = atom->v[i][axis], m = atom->rmass[i];
      const State &state = fix_fsi->state[atom->type[i]];
      const double hat = hat_at(s);
      total[MASS_FLOW] += m * side * u * hat;
      total[VOLUME_FLOW] += m / atom->rho[i] * side * u * hat;
      if (s <= 0.0) {
        if (s > -fix_fsi->cut) total[BUFFER]++;
        if (pressure_varies && is_far((*given)(PRESSURE, i))) total[TOO_FAR]++;
        continue;
      }
      double p = state.pressure(atom->rho[i]);
      // a variable need not know a value before the plane
      const double q = wants_pressure ? NAN : p - (background ? state.p0 : (*given)(PRESSURE, i));
      if (std::isfinite(q) && s < zone()) {
        total[MASS] += m;
        total[BEYOND] += m * q;
        total[FIRST] += m * s;
        total[SECOND] += m * s * s;
        total[SLOPE] += m * q * s;
      }
      const double near = std::max(0.0, 1.0 - s / fix_fsi->cut), w = m * near * near,
                   from_inner = std::fabs(s - length),
                   inner = m * std::max(0.0, 1.0 - from_inner / fix_fsi->cut);
      p -= atom->rho[i] * fix_fsi->body_forces.of_type[atom->type[i]][axis] * side * s;
      total[WEIGHT] += w;
      total[SPEED] += w * side * u;
      total[MEAN_PRESSURE] += w * p;
      total[OVER_IMPEDANCE] += w * p / (state.rho0 * state.c);
      total[INNER_WEIGHT] += inner;
      total[INNER_SPEED] += inner * side * u;
      const double away = wants_pressure ? s : from_inner;
      if (away >= fix_fsi->cut) continue;
      const auto add_to = [&](int node, const double *d) {
        const double r = std::sqrt(std::min(away * away + d[0] * d[0] + d[1] * d[1], kernel.cutsq)),
                     W = kernel.W(r);
        const double y[] = {d[0] / fix_fsi->dx, d[1] / fix_fsi->dx};
        double f[15] = {W};
        times_monomials(plane, y, f);
        double *c = &nodes.sums_given[(size_t) node * nodes.row()];
        if (wants_velocity && std::fabs(y[0]) <= NEXT && std::fabs(y[1]) <= NEXT) {
          c[nbounds] = std::max(c[nbounds], u);
          c[nbounds + 1] = std::max(c[nbounds + 1], -u);
        }
        for (int a = 0; a < nmoment; a++) *c++ += f[a];
        if (wants_velocity)
          for (int a = 0; a < nfit; a++) *c++ += f[a] * u;
        if (wants_pressure)
          for (int a = 0; a < nfit; a++) *c++ += f[a] * p;
      };
      nodes.at(nodes.given, x, std::sqrt(kernel.cutsq - away * away), add_to);
    }
  });
  MPI_Allreduce(total, mean, NMEAN, MPI_DOUBLE, MPI_SUM, world);
  nodes.add_up();
  fit_nodes(nmoment, nfit, wants_velocity + wants_pressure);
}

// exact for quadratics (Keys 1981, IEEE Trans. Acoust. Speech Signal Process. 29, 1153, eq. 15);
// linear interpolation cuts maxima
static double cubic_convolution(double t)
{
  if (t < 1.0) return 1.0 + t * t * (1.5 * t - 2.5);
  return t < 2.0 ? 2.0 - t * (4.0 - t * (2.5 - 0.5 * t)) : 0.0;
}

// Fit of a place from the nodes around it: normal velocity, pressure. The velocity is one that the
// fluid has there: the first row at a wall would else go back for as much as a parabola falls below
// it, and bring in more and more.
bool FixFSIInlet::at_plane(const double *x, double *values) const
{
  const int n = has_own_velocity() + has_own_pressure();
  double weight = 0.0, most = -HUGE_VAL, least = HUGE_VAL;
  std::fill_n(values, n, 0.0);
  nodes.at(nodes.taken, x, reach_of_nodes(), [&](int node, const double *d) {
    const double *const c = &nodes.sums[(size_t) node * nodes.row()];
    if (c[0] == 0.0) return;
    double w = 1.0;
    for (int k = 0; k < nodes.nlateral; k++)
      w *= cubic_convolution(std::fabs(d[k]) / nodes.distance[k]);
    weight += w;
    for (int k = 0; k < n; k++) values[k] += w * c[1 + k];
    if (!has_own_velocity()) return;
    most = std::max(most, c[nbounds]);
    least = std::min(least, -c[nbounds + 1]);
  });
  if (weight < 0.5) return false;    // no fluid near
  for (int k = 0; k < n; k++) values[k] /= weight;
  if (least <= most) values[0] = std::clamp(values[0], least, most);
  return true;
}

// The density of the buffer is that of its pressure: the fluid's at the plane with the weight of
// what lies between, or as given. Sound that leaves meets its own impedance: to a change of the
// fluid's velocity the pressure at the plane answers with rho c times that, or the velocity to one
// of its pressure, and goes back to what is given at the rate of absorption. Of the mean over the
// plane: vortices that pass do not change it. A pressure that is given is that of the plane; along
// the buffer it goes on as the mean of the fluid does, or the fluid would be pushed by less than
// its gradient for as long as it sees the buffer. What is slower than sound through the box counts.
void FixFSIInlet::advance(bool advance)
{
  if (neighbor->ago == 0) find_places();
  if (!advance) return;
  const double dt = update->dt + fix_fsi->dt_offset;
  const bool wants_velocity = has_own_velocity(), wants_pressure = has_own_pressure();
  if (!given->name(PRESSURE).empty()) given->evaluate_for(places, PRESSURE, 1);
  measure();
  keep_full();    // knows the flow of now, after a restart, too

  const double slow = slow_rate();
  const double rate = wants_velocity && wants_pressure ? 0.0
      : absorb == AUTO                                 ? (driven ? slow : STIFF * slow)
                                                       : absorb;
  const double spread = mean[MASS] * mean[SECOND] - mean[FIRST] * mean[FIRST];
  if (spread > LITTLE * std::pow(mean[MASS] * fix_fsi->dx, 2))
    gradient += (1.0 - std::exp(-slow * dt)) *
        ((mean[MASS] * mean[SLOPE] - mean[FIRST] * mean[BEYOND]) / spread - gradient);
  if (rate > 0.0 && mean[WEIGHT] > 0.0) {
    const double now = (wants_velocity ? mean[SPEED] : mean[OVER_IMPEDANCE]) / mean[WEIGHT];
    if (has_before) wave -= now - before;
    before = now;
    has_before = true;
  } else
    has_before = false;
  wave *= std::exp(-rate * dt);
  const double speed = side * average(SPEED), inner = side * average(INNER_SPEED, INNER_WEIGHT);

  if (mean[TOO_FAR] > 0.0 && !told.far && comm->me == 0)
    error->warning(FLERR,
                   "{}: pressure of variable {} is more than {} rho c^2 from the background: the "
                   "fluid is no longer hardly compressed. Is it in units {}? Else take a higher "
                   "sound in pair_style fsi/fluid",
                   name, given->name(PRESSURE), FAR, update->unit_style);
  told.far = told.far || mean[TOO_FAR] > 0.0;
  check_supply();

  for (auto &place : places) {
    const int i = place.i;
    hold_shift(place);
    if (place.inside > 0.0) continue;
    const State &state = fix_fsi->state[atom->type[i]];
    double values[2] = {0.0, 0.0};
    place.known = at_plane(atom->x[i], values);
    place.normal = values[0];
    if (!wants_pressure) {
      place.normal += place.known ? speed - inner : speed;
      place.known = mean[WEIGHT] > 0.0;
    }
    double p;
    if (wants_pressure)
      p = place.known ? values[wants_velocity] +
              state.rho0 * fix_fsi->body_forces.of_type[atom->type[i]][axis] * side * place.inside
                      : state.p0;
    else
      p = (background ? state.p0 : value(PRESSURE, i)) + gradient * place.inside +
          state.rho0 * state.c * wave + added;
    set_density(i, state.density(std::max(p, state.floor)));
    follow(i, place.inside);    // by that density: rates at the buffer's end depend on lists
  }
}

// the energy that it takes is in the balance
void FixFSIInlet::set_density(int i, double rho)
{
  const double stored = fix_fsi->kept ? fix_fsi->stored(i) : 0.0;
  atom->rho[i] = rho;
  if (fix_fsi->kept) fix_fsi->energy_out[FixFSI::FIELDS] += stored - fix_fsi->stored(i);
}

// What has a given velocity goes without the fluid where that does not follow, and has nothing to
// come back with. A given pressure may let the fluid run dry, which is worth a word.
void FixFSIInlet::check_supply()
{
  // with a given velocity it may begin without any
  if (served < 0.0 || (served == 0.0 && !has_own_velocity())) served = mean[BUFFER];
  const bool begins = update->ntimestep == update->firststep + 1;
  if (begins && last_buffer > 0.0) taken = std::max(0.0, last_buffer - mean[BUFFER]);
  last_buffer = mean[BUFFER];
  if (mean[BUFFER] >= STARVED * served || told.empty) return;
  std::string why;
  if (taken > STARVED * served)
    why = fmt::format("{} were deleted, or have left group {}, between the runs", taken,
                      group->names[igroup]);
  else if (has_own_velocity() && mean[WEIGHT] == 0.0)
    why = "There is no fluid within the kernel's support before it either";
  else if (has_own_velocity())
    why = fmt::format("Fluid before it, which comes in with {:g} in the mean, meets nothing there",
                      average(SPEED));
  else if (softest().floor == 0.0 && softest().p0 <= 0.0)
    why = "The fluid does not follow the velocity that is given: it tears under suction, without "
          "keyword tension yes or background of pair_style fsi/fluid";
  else
    why = fmt::format("The fluid does not follow the velocity that is given: within the kernel's "
                      "support it comes in with {:g} in the mean, so there is too little of it, or "
                      "what is given goes out where none is",
                      average(SPEED));
  const auto text = fmt::format("{} {}: of {} particles behind its plane {} there are {}. {}", name,
                                has_own_velocity() ? "runs empty" : "starves", served, at(position),
                                mean[BUFFER], why);
  if (!has_own_velocity()) error->all(FLERR, text);
  told.empty = true;
  if (comm->me == 0) error->warning(FLERR, text);
}

// Shifting carries nobody through the plane: the buffer, which moves as it is told to, could not
// give back what comes. Along the axis it fades over the kernel's support before the plane; what is
// left there is less than the distance from it.
void FixFSIInlet::hold_shift(const Place &place)
{
  double *const *const velocity = fix_fsi->shift_velocity;
  const bool fills = velocity[0];
  if (place.inside <= 0.0) {
    if (fix_fsi->shifts) std::fill_n(fix_fsi->shift[place.i], 2 * fix_fsi->dim, 0.0);
    for (int d = 0; fills && d < fix_fsi->dim; d++) velocity[d][place.i] = 0.0;
  } else if (fix_fsi->shifts && place.inside < fix_fsi->cut) {
    double *const shift = fix_fsi->shift[place.i];
    const double part = place.inside / fix_fsi->cut;
    fix_fsi->dim == 2 ? Shift<2>::reduce(shift, fills, axis, part)
                      : Shift<3>::reduce(shift, fills, axis, part);
    if (fills) velocity[axis][place.i] *= part;
  }
}

// Is there as much fluid as there is room? Continuity keeps rho - m psi of a particle, density less
// that of its number. But what comes in through the plane has the density that is given, and the
// neighbors with which it went out when pressure was another: where flow reverses each time adds to
// their number, since it goes out when pressure is higher. And diffusion passes between fluid and
// buffer what has no volume. So mass is compared with density times room, 1/psi, of the fluid
// before the plane. Particles at a free surface do not count; where there is one, a lack says
// nothing. Of fluid of several spacings it is the coarsest that is there, but for those that see
// another: where two meet, numbers are those of neither lattice.
void FixFSIInlet::end_state(bool advance)
{
  if (advance ? update->ntimestep % LOOK_EVERY : fill > 0.0) return;
  enum { MASS, ROOM, MEMBERS, SURFACE, NSUM };
  std::vector<std::array<double, NSUM>> own(fix_fsi->levels.size()), all(own.size());
  std::vector<double> psi(atom->nmax);
  fix_fsi->number_density.find(psi.data());
  const auto level = [this](int i) {
    return fix_fsi->level_of[atom->type[i]];
  };
  const bool one_level = !fix_fsi->has_levels();
  const Cells near_zone(atom->x, one_level ? 0 : atom->nlocal + atom->nghost, fix_fsi->dim,
                        fix_fsi->cut, [&](int i) {
                          return is_fluid(i) && inside(atom->x[i]) < zone() + fix_fsi->cut;
                        });
  const auto sees_another = [&](int i) {
    bool sees = false;
    near_zone.around(atom->x[i], [&](int j, double rsq) {
      const double cut =
          fix_fsi->resolution[atom->type[i]].cut + fix_fsi->resolution[atom->type[j]].cut;
      sees = sees || (level(j) != level(i) && 4.0 * rsq < cut * cut);
    });
    return sees;
  };
  for (const auto &place : places) {
    const int i = place.i, type = atom->type[i];
    const double s = inside(atom->x[i]), m = atom->rmass[i], rho = atom->rho[i];
    // those that do not see the buffer, whose particles may be as near to each other as they like
    if (s <= fix_fsi->cut || s >= zone() || (!one_level && sees_another(i))) continue;
    const double n = psi[i] * (fix_fsi->resolution[type].psi_bulk / fix_fsi->psi_bulk);
    auto &sum = own[fix_fsi->level_of[type]];
    const bool at_surface = m * n < AT_SURFACE * rho;
    sum[at_surface ? SURFACE : MEMBERS]++;
    if (at_surface) continue;
    sum[MASS] += m;
    sum[ROOM] += rho / n;
  }
  MPI_Allreduce(own.data(), all.data(), (int) own.size() * NSUM, MPI_DOUBLE, MPI_SUM, world);
  const bool first = fill == 0.0;
  fill = 1.0;
  double members = 0.0, at_surface = 0.0;
  for (const auto &sum : all) {
    if (members == 0.0 && sum[MEMBERS] > 0.0) fill = sum[MASS] / sum[ROOM];
    members += sum[MEMBERS];
    at_surface += sum[SURFACE];
  }
  mean_fill += (fill - mean_fill) / (first ? 1 : LOOKS);
  warn_of_fill(at_surface < EXCESS * members);
  if (advance) meet_pressure();
}

// What pushes the fluid is the stress at the plane, the mean of p sum_j V_j x_ji.grad_i W_ij/D. It
// goes with the square of number density times volume, of which 0.5 % are 5 % of what drives a flow
// if pressure is five times its difference: what the stress lacks is added to the buffer's pressure
void FixFSIInlet::meet_pressure()
{
  if (has_own_pressure() || softest().p0 <= 0.0 || area == 0.0) return;
  enum { PRESSURES, GIVEN, WEIGHTS, NSUM };
  double own[NSUM] = {}, all[NSUM];
  std::vector<double> div(atom->nmax, 0.0);
  first_of(pairs_of<PairFSIFluid>(lmp))->add_position_divergence(div.data());
  fix_fsi->add_ghosts(div.data());
  for (const auto &place : places) {
    const int i = place.i;
    const State &state = fix_fsi->state[atom->type[i]];
    // those who do not see the end of the buffer, where others wait for lists
    const double hat = hat_at(inside(atom->x[i]), 1.0), volume = atom->rmass[i] / atom->rho[i];
    own[PRESSURES] += hat * volume * state.pressure(atom->rho[i]) * div[i] / fix_fsi->dim;
    if (place.inside > 0.0) continue;
    own[GIVEN] += hat * (background ? state.p0 : (*given)(PRESSURE, i));
    own[WEIGHTS] += hat;
  }
  MPI_Allreduce(own, all, NSUM, MPI_DOUBLE, MPI_SUM, world);
  if (all[WEIGHTS] == 0.0) return;
  const State &soft = softest();
  const double p = all[GIVEN] / all[WEIGHTS], most = MOST_ADDED * std::fabs(p),
               time = LOOK_EVERY * (update->dt + fix_fsi->dt_offset),
               lacks = p + soft.rho0 * soft.c * wave - all[PRESSURES] / area;
  added += (1.0 - std::exp(-slow_rate() * time)) * lacks;
  added = std::clamp(added, -most, most);
}

void FixFSIInlet::warn_of_fill(bool full)
{
  const bool few = full && mean_fill < 1.0 - EXCESS;
  if (told.fill || comm->me || !(mean_fill > 1.0 + EXCESS || few)) return;
  told.fill = true;
  error->warning(
      FLERR,
      "{}: within {:g} before its plane there is {:.2g} % {} mass than the fluid's density has "
      "room for, at step {}: particles {}. {}",
      name, zone(), 100.0 * std::fabs(mean_fill - 1.0), few ? "less" : "more", update->ntimestep,
      few ? "are missing" : "pile up",
      softest().p0 > 0.0
          ? "Vortices, bodies or a valve near the plane do so: move it away from them, or take a "
            "lower shift in pair_style fsi/fluid"
          : "Nothing holds their number without keyword background of pair_style fsi/fluid");
}

// Where fluid fills the box: too many particles before the plane get a density that presses them
// out, and those that come in follow each other at another spacing
void FixFSIInlet::keep_full()
{
  const State &soft = softest();
  if (soft.p0 <= 0.0 || fill == 0.0) return;
  const double dt = update->dt + fix_fsi->dt_offset;
  const double inflow = std::max(0.0, average(SPEED));
  const double excess = std::max(0.0, std::fabs(fill - 1.0) - DISORDER);
  column = std::clamp(column + std::copysign(MEND * excess * inflow * dt / length, fill - 1.0),
                      NARROW, WIDE);
  const double rise = (fill - 1.0) * soft.c * dt / (SETTLE * fix_fsi->h);
  // what is dense where a pressure draws in would press the fluid on, and draw in more of itself
  if (rise == 0.0 || (inflow > 0.0 && !has_own_pressure())) return;
  for (const auto &place : places) {
    const int i = place.i;
    const double part = 1.0 - inside(atom->x[i]) / zone();
    if (part <= 0.0 || part >= 1.0) continue;
    set_density(i, atom->rho[i] * (1.0 + part * rise));
  }
}

// forces that give the buffer its velocity at the end of the step; where there is no fluid at the
// plane it keeps what it has
void FixFSIInlet::prescribe()
{
  std::fill_n(push_sum, 4, 0.0);
  const double dt = update->dt;
  if (dt == 0.0) return;
  const bool wants_velocity = has_own_velocity();
  const bool found = find_followers();
  if (!wants_velocity) given->evaluate_for(places, 0, 3);
  for (const auto &place : places) {
    const int i = place.i;
    if (place.inside > 0.0) continue;
    const double m = atom->rmass[i];
    double *const f = atom->f[i], *const v = atom->v[i];
    for (int d = 0; d < fix_fsi->dim; d++) {
      const double more = d == axis ? side * wave : 0.0;
      const double u = !wants_velocity ? value(d, i) + more
          : !place.known               ? v[d]
          : d == axis                  ? place.normal
                                       : 0.0;
      if (of_buffer[i] == FOLLOWED) {
        follower[i][d] = found ? follower[i][d] + more : u;
        behind[i][d] += 0.5 * dt * follower[i][d];
      }
      const double to = m * (u - v[d]) / (dt * force->ftm2v), push = to - f[d];
      f[d] = to;
      push_sum[d] += push;
      push_sum[3] += push * 0.5 * (u + v[d]);
    }
  }
  fix_fsi->tally(FixFSI::FIELDS, -push_sum[3]);
}

double FixFSIInlet::compute_vector(int n)
{
  double own = 0.0;
  switch (n) {
    case 1:
      return passed_in;
    case 2:
      return passed_out;
    case 3:
      return mean[MASS_FLOW];
    case 4:
      return mean[VOLUME_FLOW];
    case 5:
      return average(MEAN_PRESSURE);
    case 10:
      return mean_fill;
    case 0:
      own = atom->nlocal - std::count(of_buffer, of_buffer + atom->nlocal, double(NOT));
      break;
    default:
      own = push_sum[n - 6];
  }
  return sum_of(own, world);
}

void FixFSIInlet::write_restart(FILE *fp)
{
  Record record(lmp, style);
  record.add("filled", std::vector<double>{double(filled), served});
  record.add("buffer", std::vector<double>{position, length});
  record.add("absorption", std::vector<double>{wave, before, double(has_before)});
  record.add("gradient", std::vector<double>{gradient, added, area});
  record.add("fill", std::vector<double>{fill, mean_fill, column});
  record.add("passed", std::vector<double>{passed_in, passed_out, mass_in});
  record.add("mean", std::vector<double>(mean, mean + NMEAN));
  fields.write(record);
  record.write(fp);
}

void FixFSIInlet::restart(char *buf)
{
  const Record record(lmp, style, buf);
  auto numbers = record.numbers("filled");
  filled = numbers[0] != 0.0;
  served = numbers[1];
  if (record.has("buffer")) made = record.numbers("buffer");
  of_file = true;
  numbers = record.numbers("absorption");
  wave = numbers[0];
  before = numbers[1];
  has_before = numbers[2] != 0.0;
  if (record.has("gradient")) {
    numbers = record.numbers("gradient");
    gradient = numbers[0];
    if (numbers.size() > 2) {    // else of a version without
      added = numbers[1];
      area = numbers[2];
    }
  }
  if (record.has("fill")) {
    numbers = record.numbers("fill");
    fill = numbers[0];
    mean_fill = numbers[1];
    column = numbers[2];
  }
  numbers = record.numbers("passed");
  passed_in = numbers[0];
  passed_out = numbers[1];
  mass_in = numbers[2];
  if (record.has("mean")) {
    numbers = record.numbers("mean");
    std::copy_n(numbers.begin(), std::min(numbers.size(), (size_t) NMEAN), mean);
  }
  fields.read(record);
}

double FixFSIInlet::memory_usage()
{
  return FixFields::memory_usage() + given->memory_usage() + nodes.memory_usage() +
      (double) places.capacity() * sizeof(Place);
}
