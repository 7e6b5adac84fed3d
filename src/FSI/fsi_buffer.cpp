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

#include "fsi_open_end.h"

#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "fsi_fields.h"
#include "fsi_gather.h"
#include "group.h"
#include "math_extra.h"
#include "neighbor.h"
#include "update.h"

#include <tuple>

using namespace LAMMPS_NS;
using namespace FSI;

static constexpr double STARVED = 1.0 / 3.0;    // of what it began with, to a column more or less
static constexpr double OCCUPIED = 0.5;         // of the spacing: as near a particle takes a place
static constexpr double SPARSE = 0.75;       // of the particles at the plane: fewer fill no slice
static constexpr double FEW_FINER = 0.25;    // of a buffer, that are alone

void Buffer::set_fields(Fields &fields)
{
  fields.set("of the buffer", Fields::RESTART, true, members);
  fields.set("place of the copy", Fields::RESTART, true, behind, 3);
  fields.set("velocity of the copy", Fields::RESTART, true, follower, 4);
}

void Buffer::init(Ledger &ledger_in, Population &population_in)
{
  ledger = &ledger_in;
  population = &population_in;
  warned_of_stranger = warned_of_supply = false;
  population->leave_an_id_free();
}

int Buffer::count() const
{
  return atom->nlocal - std::count(members, members + atom->nlocal, double(NOT));
}

// The buffer's slices are those of dx, the coarsest fluid's spacing. In one that is there some may
// be that have found no partner on their way out
void Buffer::check_levels(bool is_empty) const
{
  const double length = end.length;
  const auto is_there = [&](int i) {
    const double s = end.inside(atom->x[i]);
    return end.is_fluid(i) && end.in_patch(atom->x[i]) && s > -length &&
        s < (is_empty ? length : 0.0);
  };
  const auto all = find_particles(atom, world, is_there),
             finer = find_particles(atom, world, [&](int i) {
               return end.disc->level_of[atom->type[i]] > 0 && is_there(i);
             });
  if (finer.count > (is_empty ? 0.0 : FEW_FINER * all.count))
    error->all(FLERR,
               "{}: {} particles of fluid finer than dx, {:g}, the first of them atom {}, are "
               "within {:g} of its plane: the fluid that comes and goes is the coarsest",
               end.name, finer.count, end.disc->dx, finer.first, length);
}

void Buffer::populate()
{
  end.match_region();
  bool has_some = false;
  std::vector<int> slices(number_of_slices(), 0);
  const Census all = take_census(slices, has_some);
  check_census(all);
  check_levels(all.behind == 0);
  end.renew_ranks(has_some);
  if (all.behind > 0) {
    slices.back() += find_last_of_rows();
    check_slices(slices);
  } else if (all.ahead > 0) {
    const auto copies = go_on_behind();
    population->begin();
    make(copies, true);
    population->end();
  }
  end.find_places();    // of which variables are asked
  end.given.evaluate_for(end.places, 0, 3);
  for (int i = 0; i < atom->nlocal; i++)
    for (int d = 0; member(i) && d < end.disc->dim; d++)
      if (end.given.given(d)) atom->v[i][d] = end.value(d, i);
}

// of all ranks; and of this one fluid behind the plane by slices, and is there anything near?
Buffer::Census Buffer::take_census(std::vector<int> &slices, bool &has_some)
{
  Census local, all;
  const double length = end.length;
  for (int i = 0; i < atom->nlocal; i++) {
    const double s = end.inside(atom->x[i]);
    if (s <= -2.0 * length || s >= length) continue;
    has_some = true;
    if (end.disc->state[atom->type[i]].species == RIGID && s > -length)
      (s > 0.0 ? local.walls_ahead : local.walls_behind)++;
    if (!end.is_fluid(i) || !end.in_patch(atom->x[i])) continue;
    if (s > 0.0) {
      local.ahead++;
      continue;
    }
    (s > -length - 0.5 * end.disc->dx ? local.behind : local.beyond)++;
    members[i] = MEMBER;
    const size_t k = slice(-s);
    if (k < slices.size()) slices[k]++;
  }
  MPI_Allreduce(&local, &all, sizeof(Census) / sizeof(bigint), MPI_LMP_BIGINT, MPI_SUM, world);
  return all;
}

void Buffer::check_census(const Census &all) const
{
  const auto last = end.at(end.end());
  const char axis = "xyz"[end.axis];
  if (all.behind == 0 && all.ahead == 0 && !end.outlet)
    error->all(FLERR,
               "{}: there is no fluid of group {} at its plane {}: fill the buffer, to {}, or what "
               "is before it",
               end.name, group->names[end.igroup], end.at(end.position), last);
  if (all.beyond > 0)
    error->all(FLERR,
               "{}: {} particles of fluid are beyond the end of its buffer, {}: {}{} has the fluid "
               "at {} {} {}",
               end.name, all.beyond, last, axis, end.side > 0.0 ? "lo" : "hi", axis,
               end.side > 0.0 ? ">" : "<", end.position);
  if (all.walls_ahead > 0 && 2 * all.walls_behind < all.walls_ahead && comm->me == 0)
    error->warning(FLERR,
                   "{}: {} wall particles are within {:g} before its plane, {} behind it: walls "
                   "should go on along the buffer, to {}",
                   end.name, all.walls_ahead, end.length, all.walls_behind, last);
}

// of a buffer that the script has filled: a hole would come in again and again
void Buffer::check_slices(const std::vector<int> &of_rank) const
{
  const auto all = over_ranks(of_rank, MPI_SUM, world);
  const int most = *std::max_element(all.begin(), all.end());
  const auto few = std::find_if(all.begin(), all.end(), [&](int n) {
    return n < 0.5 * most;
  });
  if (few == all.end() || comm->me) return;
  const double from = end.position - end.side * (few - all.begin()) * end.disc->dx;
  error->warning(FLERR,
                 "{}: its buffer has {} particles from {} to {:.10g} and {} elsewhere: what is not "
                 "there will not come in. Fill it to {}, or leave it empty",
                 end.name, *few, end.at(from), from - end.side * end.disc->dx, most,
                 end.at(end.end()));
}

// Calls visit(particle, offset from x) for those of a list, sorted by the plane's first axis, that
// are as near along it as what takes a place; images, too
template <class Visit>
void Buffer::beside(const std::vector<Particle> &sorted, const double *x, Visit visit) const
{
  const int a = first_axis(), periodic = domain->periodicity[a];
  const double reach = OCCUPIED * end.disc->dx;
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

void Buffer::sort_along_plane(std::vector<Particle> &list) const
{
  const int a = first_axis();
  std::sort(list.begin(), list.end(), [a](const Particle &b, const Particle &c) {
    return b.x[a] < c.x[a] || (b.x[a] == c.x[a] && b.parent < c.parent);
  });
}

// In a buffer of a fix before this one: the last of a row is to be followed, also if it has come a
// spacing from the end meanwhile, and the next one would have been made with the next list. How
// many those are on this rank
int Buffer::find_last_of_rows()
{
  const double at_end = end.disc->dx - end.length, low = at_end + neighbor->skin,
               reach = OCCUPIED * end.disc->dx;
  int missing = 0;
  std::vector<Particle> local, all;
  for (int i = 0; i < atom->nlocal; i++)
    if (member(i) && end.inside(atom->x[i]) <= low) local.push_back(population->copy_of(i));
  if (end.ranks != MPI_COMM_NULL) all = gather(local, end.ranks);
  sort_along_plane(all);
  const auto is_last = [&](const double *x) {
    bool last = true;
    beside(all, x, [&](const Particle &, double *d) {
      const bool is_behind = end.side * d[end.axis] < 0.0;
      d[end.axis] = 0.0;
      if (is_behind && MathExtra::lensq3(d) < reach * reach) last = false;
    });
    return last;
  };
  for (int i = 0; i < atom->nlocal; i++) {
    const double s = end.inside(atom->x[i]);
    if (!member(i) || s > low) continue;
    if (s > at_end && !(end.side * atom->v[i][end.axis] > 0.0 && is_last(atom->x[i]))) continue;
    members[i] = LAST;
    missing += s > at_end;
  }
  return missing;
}

// Copies of the fluid at the plane that fill the buffer: of as many slices as are full, again and
// again, so that its lattice goes on. A slice is not where the fluid ends, or where a body stands
// in the way of the fluid at the plane.
std::vector<Particle> Buffer::go_on_behind() const
{
  const int most = number_of_slices(), full = full_slices();
  if (full == 0 && !end.outlet)
    error->all(FLERR,
               "{}: there is fluid of group {} before its plane {}, but none within a spacing of "
               "it: fill what is between, or the buffer, to {}",
               end.name, group->names[end.igroup], end.at(end.position), end.at(end.end()));
  std::vector<Particle> copies;
  const double period = end.disc->dx * full;
  end.for_fluid(0.0, full ? end.length : 0.0, [&](int i, double s) {
    if (slice(s) >= full) return;
    Particle c = population->copy_of(i);
    for (int k = 1; slice(k * period - s) < most; k++) {
      c.x[end.axis] = atom->x[i][end.axis] - end.side * k * period;
      copies.push_back(c);
    }
  });
  return copies;
}

int Buffer::full_slices() const
{
  const int most = number_of_slices();
  std::vector<int> local(most, 0);
  end.for_fluid(0.0, 2.0 * end.length, [&](int, double s) {
    if (slice(s) < most) local[slice(s)]++;
  });
  const auto count = over_ranks(local, MPI_SUM, world);
  int full = 0;
  while (full < most && count[full] > 0 && count[full] >= SPARSE * count[0]) full++;
  return std::min(full, over_ranks(std::max(slices_before_bodies(), 1), MPI_MIN, world));
}

// that are not beside a body of this rank which has fluid at the plane before it
int Buffer::slices_before_bodies() const
{
  // places along the plane of the fluid within a spacing of it
  std::vector<Column> local, columns;
  end.for_fluid(0.0, end.length, [&](int i, double s) {
    if (slice(s) == 0) local.push_back(along(atom->x[i]));
  });
  if (end.ranks != MPI_COMM_NULL) columns = gather(local, end.ranks);
  const double dx = end.disc->dx;
  int limit = number_of_slices(), hole = 0;
  for (int i = 0; i < atom->nlocal; i++) {
    const State &state = end.disc->state[atom->type[i]];
    const double s = end.inside(atom->x[i]);
    if (s <= 0.0 || s >= end.length || state.species == FLUID || state.species == NONE) continue;
    const Column here = along(atom->x[i]);
    bool below = false, above = false;    // is there fluid on the same line?
    for (const Column &c : columns) {
      if (std::fabs(c[1] - here[1]) >= 0.5 * dx) continue;
      below = below || c[0] < here[0];
      above = above || c[0] > here[0];
      if (std::fabs(c[0] - here[0]) < 0.5 * dx)
        limit = std::min(
            limit, static_cast<int>((s - 0.5 * end.disc->dx_of(atom->type[i])) / dx + 1.0e-6));
    }
    if (state.species == SOLID && slice(s) == 0 && below && above && !hole++)
      error->warning(FLERR,
                     "{}: atom {} of a solid is within a spacing of its plane {}: behind it the "
                     "buffer has a hole, and what is not there will not come in. Move the solid or "
                     "the plane, or fill the buffer, to {}",
                     end.name, atom->tag[i], end.at(end.position), end.at(end.end()));
  }
  return limit;
}

// sorts copies along the plane; is a particle there already where they will be?
std::vector<int> Buffer::find_occupied(std::vector<Particle> &copies, bool at_start)
{
  double low = end.inside(copies[0].x), high = low;
  for (auto &c : copies) {
    domain->remap(c.x);
    low = std::min(low, end.inside(c.x));
    high = std::max(high, end.inside(c.x));
  }

  sort_along_plane(copies);
  const double reach = OCCUPIED * end.disc->dx;
  std::vector<int> is_occupied(copies.size(), 0);
  for (int i = 0; i < atom->nlocal; i++) {
    const double *const x = atom->x[i], s = end.inside(x);
    if (s < low - reach || s > high + reach) continue;
    const int species = end.disc->state[atom->type[i]].species;
    if (species != FLUID && !at_start) continue;    // as near as its parent is in front
    beside(copies, x, [&](const Particle &c, double *d) {
      if (MathExtra::lensq3(d) >= reach * reach) return;
      if (species != FLUID)
        error->one(FLERR, "{}: atom {} of a {} at {} is where fluid of its buffer should be",
                   end.name, atom->tag[i], species == RIGID ? "wall" : "solid", place_text(x));
      is_occupied[&c - copies.data()] = 1;
    });
  }
  return over_ranks(is_occupied, MPI_MAX, end.ranks);
}

// Makes copies: IDs in the order in which they came to be followed, and of those of the parents,
// whatever rank has them. Fluid that is in the place keeps it.
void Buffer::make(const std::vector<Particle> &local, bool at_start)
{
  std::vector<Particle> all, copies;
  std::vector<int> occupied;
  if (end.ranks != MPI_COMM_NULL) all = gather(local, end.ranks);
  if (!all.empty()) occupied = find_occupied(all, at_start);
  for (size_t k = 0; k < all.size(); k++)
    if (!occupied[k]) copies.push_back(all[k]);
  std::sort(copies.begin(), copies.end(), [&](const Particle &b, const Particle &c) {
    return std::make_tuple(b.since, b.parent, -end.inside(b.x)) <
        std::make_tuple(c.since, c.parent, -end.inside(c.x));
  });
  const int first = atom->nlocal;
  population->make(copies, end.name, at_start ? nullptr : ledger->account(Ledger::FIELDS));
  for (int i = first; i < atom->nlocal; i++) members[i] = MEMBER;
}

void Buffer::exchange(const std::vector<const OpenEnd *> &all_ends)
{
  end.match_region();
  std::vector<Particle> copies, left;
  std::vector<int> gone;
  enum { IN, OUT, MASS, MADE, DELETED, NCOUNT };
  double local[NCOUNT] = {}, all[NCOUNT];
  bool has_some = false;
  for (int i = 0; i < atom->nlocal; i++) {
    const double *const x = atom->x[i], s = end.inside(x);
    if (s > 0.0 && !member(i)) continue;
    has_some = true;
    if (!end.is_fluid(i)) {
      check_stranger(i);
      continue;
    }
    if (member(i) == FOLLOWED) {
      copies.push_back(population->copy_of(i));
      std::copy_n(behind[i], 3, copies.back().x);
      std::copy_n(follower[i], 3, copies.back().v);
      copies.back().since = follower[i][3];
      members[i] = MEMBER;
    }
    if (member(i) && s > 0.0) {
      members[i] = NOT;
      local[IN]++;
      local[MASS] += atom->rmass[i];
    } else if (!member(i) && end.holds(x)) {
      members[i] = MEMBER;
      local[OUT]++;
      local[MASS] -= atom->rmass[i];
    }
    if (!member(i)) continue;
    refuse_overlap(i, all_ends);
    if (s <= -end.length) gone.push_back(i);
  }
  local[MADE] = copies.size();
  local[DELETED] = gone.size();
  MPI_Allreduce(local, all, NCOUNT, MPI_DOUBLE, MPI_SUM, world);
  passed_in += all[IN];
  passed_out += all[OUT];
  mass_in += all[MASS];
  if (all[MADE] == 0.0 && all[DELETED] == 0.0) return;

  for (const int i : gone) left.push_back(population->copy_of(i));
  population->begin();
  population->remove(gone, ledger->account(Ledger::FIELDS));
  end.renew_ranks(has_some);
  if (all[MADE] > 0.0) make(copies, false);
  population->end();
  if (all[DELETED] > 0.0) find_next_of_rows(left);
}

void Buffer::refuse_overlap(int i, const std::vector<const OpenEnd *> &all_ends) const
{
  const double *const x = atom->x[i];
  for (const auto *other : all_ends)
    if (other != &end && other->holds(x))
      error->one(FLERR,
                 "Atom {} at {} is in the buffers of fix {} and fix {}: keep them "
                 "apart, with keyword region",
                 atom->tag[i], place_text(x), end.id, other->id);
}

// Before those that have left at the end: where flow turns before the next one of a row has come a
// spacing from the end, it is that one which another follows
void Buffer::find_next_of_rows(const std::vector<Particle> &gone)
{
  if (end.ranks == MPI_COMM_NULL) return;
  auto all = gather(gone, end.ranks);
  sort_along_plane(all);
  const double reach = OCCUPIED * end.disc->dx, far = 2.0 * end.disc->dx;
  std::vector<double> local(all.size(), far);
  // visit(distance along the axis, to which of them) for a particle that is before one of them
  const auto before = [&](int i, const auto &visit) {
    if (!member(i) || end.inside(atom->x[i]) > far - end.length) return;
    beside(all, atom->x[i], [&](const Particle &p, double *d) {
      const double ahead = -end.side * d[end.axis];
      d[end.axis] = 0.0;
      if (ahead > 0.0 && MathExtra::lensq3(d) < reach * reach) visit(ahead, &p - all.data());
    });
  };
  for (int i = 0; i < atom->nlocal; i++)
    before(i, [&](double ahead, size_t k) {
      local[k] = std::min(local[k], ahead);
    });
  const auto nearest = over_ranks(local, MPI_MIN, end.ranks);
  for (int i = 0; i < atom->nlocal; i++)
    before(i, [&](double ahead, size_t k) {
      if (member(i) == MEMBER && ahead == nearest[k]) members[i] = NEXT_OF_ROW;
    });
}

// behind the plane, and no fluid that this end lets pass
void Buffer::check_stranger(int i)
{
  const double *const x = atom->x[i];
  const int species = end.disc->state[atom->type[i]].species;
  if (!end.in_patch(x)) return;
  if (species == SOLID && end.inside(x) > -end.length)
    error->one(FLERR, "Atom {} of a solid is in the buffer of {} {}, which is for fluid alone",
               atom->tag[i], end.command, end.id);
  if (warned_of_stranger || !is_moved(i, lmp) || end.side * atom->v[i][end.axis] >= 0.0) return;
  warned_of_stranger = true;
  error->warning(
      FLERR,
      "{}: atom {} of type {}, {}, moves into the buffer, which only fluid of its group can pass: "
      "it will be lost at the end of the box",
      end.name, atom->tag[i], atom->type[i],
      species == FLUID ? fmt::format("a fluid that is not of group {}", group->names[end.igroup])
          : species == SOLID ? "of a solid"
          : species == NONE  ? "without a material"
                             : "of a wall or rigid body");
}

// The last of a row has come a spacing from the end: another follows it, from the next list on, but
// where it would be had it been made now, so that it does not matter when lists are built. The
// spacing is that at which particles have the room of their density. (Copies of those that pass the
// plane would bring each gap again.)
void Buffer::follow(int i, double s, double column)
{
  const double spacing = column * end.disc->dx * end.disc->state[atom->type[i]].rho0 / atom->rho[i];
  const bool at_end = s <= spacing - end.length, is_next = member(i) == NEXT_OF_ROW;
  if (at_end && (is_next || member(i) == MEMBER)) members[i] = LAST;
  if (at_end || !(member(i) == LAST || (is_next && end.side * atom->v[i][end.axis] > 0.0))) return;
  members[i] = FOLLOWED;
  std::copy_n(atom->x[i], 3, behind[i]);
  behind[i][end.axis] -= end.side * spacing;
  std::copy_n(atom->v[i], 3, follower[i]);
  follower[i][3] = (double) update->ntimestep;
}

// to the middle of the step, whose length may be new
void Buffer::start_step()
{
  for (const auto &place : end.places)
    for (int d = 0; member(place.i) == FOLLOWED && d < end.disc->dim; d++)
      behind[place.i][d] += 0.5 * update->dt * follower[place.i][d];
}

// A velocity that is given by atom-style variables: where followers are
bool Buffer::find_followers()
{
  if (end.has_own_velocity() || !end.given.of_atoms()) return false;
  std::vector<OpenEnd::Place> followed;
  for (const auto &place : end.places)
    if (member(place.i) == FOLLOWED) followed.push_back(place);
  if (!anywhere(!followed.empty(), world)) return true;
  const auto swap = [&]() {
    for (const auto &place : followed)
      std::swap_ranges(behind[place.i], behind[place.i] + 3, atom->x[place.i]);
  };
  swap();
  end.given.evaluate_for(followed, 0, 3);
  for (const auto &place : followed)
    for (int d = 0; d < 3; d++) follower[place.i][d] = end.value(d, place.i);
  swap();
  return true;
}

// where there is no fluid at the plane it keeps what it has
double Buffer::velocity_at_end(const OpenEnd::Place &place, int d, double wave) const
{
  if (!end.has_own_velocity())
    return end.value(d, place.i) + (d == end.axis ? end.side * wave : 0.0);
  return !place.known ? atom->v[place.i][d] : d == end.axis ? place.normal : 0.0;
}

void Buffer::add_pulls(double wave, std::vector<StepState::Pull> &pulls)
{
  if (!end.has_own_velocity()) end.given.evaluate_for(end.places, 0, 3);
  for (const auto &place : end.places)
    for (int d = 0; place.inside <= 0.0 && d < end.disc->dim; d++)
      pulls.push_back({place.i, d, HUGE_VAL, velocity_at_end(place, d, wave)});
}

// forces that give the buffer its velocity at the end of the step
void Buffer::prescribe(double wave)
{
  std::fill_n(push, 4, 0.0);
  const double dt = update->dt;
  if (dt == 0.0) return;
  const bool found = find_followers();
  if (!end.has_own_velocity()) end.given.evaluate_for(end.places, 0, 3);
  for (const auto &place : end.places) {
    const int i = place.i;
    if (place.inside > 0.0) continue;
    const double m = atom->rmass[i];
    double *const f = atom->f[i], *const v = atom->v[i];
    for (int d = 0; d < end.disc->dim; d++) {
      const double u = velocity_at_end(place, d, wave);
      if (member(i) == FOLLOWED) {
        if (!found)
          follower[i][d] = u;
        else if (d == end.axis)
          follower[i][d] += end.side * wave;
        behind[i][d] += 0.5 * dt * follower[i][d];
      }
      const double to = m * (u - v[d]) / (dt * force->ftm2v), change = to - f[d];
      f[d] = to;
      push[d] += change;
      push[3] += change * 0.5 * (u + v[d]);
    }
  }
}

// What has a given velocity goes without the fluid where that does not follow, and has nothing to
// come back with. A given pressure may let the fluid run dry, which is worth a word.
void Buffer::check_supply()
{
  const double count = end.sum[OpenEnd::BUFFER];
  const bool own_velocity = end.has_own_velocity();
  // with a given velocity it may begin without any
  if (served < 0.0 || (served == 0.0 && !own_velocity)) served = count;
  const bool begins = update->ntimestep == update->firststep + 1;
  if (begins && last_count > 0.0) taken = std::max(0.0, last_count - count);
  last_count = count;
  if (count >= STARVED * served || warned_of_supply) return;
  std::string why;
  if (taken > STARVED * served)
    why = fmt::format("{} were deleted, or have left group {}, between the runs", taken,
                      group->names[end.igroup]);
  else if (own_velocity && end.sum[OpenEnd::WEIGHT] == 0.0)
    why = "There is no fluid within the kernel's support before it either";
  else if (own_velocity)
    why = fmt::format("Fluid before it, which comes in with {:g} in the mean, meets nothing there",
                      end.average(OpenEnd::SPEED));
  else if (end.softest().floor == 0.0 && end.softest().p0 <= 0.0)
    why = "The fluid does not follow the velocity that is given: it tears under suction, without "
          "keyword tension yes or background of pair_style fsi/fluid";
  else
    why = fmt::format("The fluid does not follow the velocity that is given: within the kernel's "
                      "support it comes in with {:g} in the mean, so there is too little of it, or "
                      "what is given goes out where none is",
                      end.average(OpenEnd::SPEED));
  const auto text = fmt::format("{} {}: of {} particles behind its plane {} there are {}. {}",
                                end.name, own_velocity ? "runs empty" : "starves", served,
                                end.at(end.position), count, why);
  if (!own_velocity) error->all(FLERR, text);
  warned_of_supply = true;
  if (comm->me == 0) error->warning(FLERR, text);
}
