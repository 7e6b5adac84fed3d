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
#include "fsi_cells.h"
#include "fsi_gather.h"
#include "fsi_gradient.h"
#include "fsi_kernel.h"
#include "fsi_refusals.h"
#include "fsi_rows.h"
#include "neighbor.h"
#include "region.h"
#include "update.h"

using namespace LAMMPS_NS;
using namespace FSI;

static constexpr double STIFF = 40.0;    // absorb auto over c/2L between given pressures: a channel
                                         // c/K longer, L/20
static constexpr double MOST_ADDED = 0.05;    // of a pressure that is given
static constexpr double AT_SURFACE = 0.9;     // of the density: m psi of a particle at a free
                                              // surface is less
static constexpr double EXCESS = 0.02;        // of the mass near the plane that is worth a word
// Time in h/c in which particles and room come together before the plane; of how many looks the
// mean is that a warning tells
static constexpr double SETTLE = 50.0;
static constexpr int LOOKS = 20;
// Spacing of what comes in: part of an error that a buffer's length of inflow mends; what a lattice
// that is sheared or bent shows of one; and the range, where particles stay a fluid
static constexpr double MEND = 0.2, DISORDER = 0.005, NARROW = 0.85, WIDE = 1.15;

OpenEnd::OpenEnd(LAMMPS *lmp, const Fix *fix) :
    Pointers(lmp), command(std::string("fix ") + fix->style),
    label(std::string("Fix ") + fix->style), id(fix->id), name(label + " " + id),
    outlet(label == "Fix fsi/outlet"), igroup(fix->igroup), groupbit(fix->groupbit),
    given(lmp, command, NVALUES)
{
}

void OpenEnd::init(const Discretization *discretization, double given_length)
{
  disc = discretization;
  if (domain->periodicity[axis])
    refuse(error, Refused::END_PERIODIC, name, std::string(1, "xyz"[axis]));
  find_length(given_length);
  check_plane();
  find_region();
  given.find();
  forget_ranks();
}

// Lists hold for half a skin; a place that becomes free at the end is filled when a column has
// gone by. As long for any skin up to a spacing
void OpenEnd::find_length(double given_length)
{
  const double dx = disc->dx, least = disc->cut + dx + 0.5 * neighbor->skin,
               usual = std::max(least, disc->cut + 1.5 * dx);
  length = dx * std::ceil(usual / dx - 1.0e-9);
  if (given_length == AUTO) return;
  length = dx * std::round(given_length / dx);
  if (std::fabs(length - given_length) > 1.0e-6 * dx)
    error->all(
        FLERR,
        "{} buffer {} must be a multiple of the spacing {}: its end is where the lattice goes on",
        label, given_length, dx);
  if (length < least - 1.0e-9 * dx)
    error->all(FLERR,
               "{} buffer {} is too short: expected at least {:g}, the kernel's support {:g}, a "
               "spacing and half the skin",
               label, given_length, dx * std::ceil(least / dx - 1.0e-9), disc->cut);
}

// plane and buffer are inside the box
void OpenEnd::check_plane() const
{
  // a number in a script may be that of the box but for its last digits
  const double little = 1.0e-9 * domain->prd[axis], lo = domain->boxlo[axis],
               hi = domain->boxhi[axis];
  if (position < lo - little || position > hi + little)
    error->all(FLERR, "{}: its plane at {} is outside the box, from {} to {}", name, at(position),
               lo, hi);
  // what has passed the end of the buffer is deleted with the next list
  const double half_skin = 0.5 * neighbor->skin, last = end() - side * half_skin;
  if (domain->boundary[axis][side < 0.0] == 1 && (last < lo - little || last > hi + little))
    error->all(FLERR,
               "{}: its buffer, {} to {:.10g}, and half the neighbor skin, {:g}, must be inside "
               "the box, from {} to {}",
               name, at(position), end(), half_skin, lo, hi);
}

// the part of the plane that is open
void OpenEnd::find_region()
{
  region = nullptr;
  if (region_id.empty()) return;
  region = domain->get_region_by_id(region_id);
  if (!region) error->all(FLERR, "Region {} of {} does not exist", region_id, command);
  if (region->dynamic_check()) refuse(error, Refused::END_REGION, label);
  if (!region->bboxflag) return;
  const double from[] = {region->extent_xlo, region->extent_ylo, region->extent_zlo},
               to[] = {region->extent_xhi, region->extent_yhi, region->extent_zhi};
  const auto refuse = [&](int d, const std::string &what) {
    error->all(FLERR, "Region {} of {}, from {} to {} along {}, {}", region_id, command, from[d],
               to[d], "xyz"[d], what);
  };
  for (int d = 0; d < disc->dim; d++)
    if (d != axis && (from[d] > domain->boxhi[d] || to[d] < domain->boxlo[d]))
      refuse(d, "is outside the box");
  if (from[axis] > position || to[axis] < position)
    refuse(axis, fmt::format("does not reach its plane at {}", position));
}

void OpenEnd::match_region() const
{
  if (region) region->prematch();
}

double OpenEnd::value(int k, int i) const
{
  const double x = given(k, i);
  if (!std::isfinite(x))
    error->one(FLERR, "{}: {} {} of atom {} at {} is no number{}", name,
               k == PRESSURE ? "pressure" : fmt::format("velocity along {}", "xyz"[k]), x,
               atom->tag[i], place_text(atom->x[i]), given.see(k));
  return x;
}

double OpenEnd::pressure_given(int i) const
{
  return background ? disc->state[atom->type[i]].p0 : given(PRESSURE, i);
}

// the fluid that a pressure compresses most; is a pressure out of its range?
const State &OpenEnd::softest() const
{
  const State *soft = nullptr;
  for (const auto &s : disc->state)
    if (s.species == FLUID && (!soft || s.rho0 * s.csq < soft->rho0 * soft->csq)) soft = &s;
  return soft ? *soft : disc->state[0];
}

bool OpenEnd::is_far(double p) const
{
  const State &soft = softest();
  return soft.species == FLUID && std::fabs(p - soft.p0) > FAR * soft.rho0 * soft.csq;
}

// of what is slower than sound through the box
double OpenEnd::slow_rate() const
{
  double c = 0.0;
  for (const auto &s : disc->state)
    if (s.species == FLUID) c = std::max(c, s.c);
  return 0.5 * c / domain->prd[axis];
}

// hat functions, which a lattice sums to a constant
double OpenEnd::hat_at(double s, double spacings) const
{
  const double width = spacings * disc->dx;
  return std::max(0.0, 1.0 - std::fabs(s) / width) / width;
}

bool OpenEnd::is_fluid(int i) const
{
  return (atom->mask[i] & groupbit) && disc->state[atom->type[i]].species == FLUID;
}

// a region says which part of the plane is open
bool OpenEnd::in_patch(const double *x) const
{
  if (!region) return true;
  double to[3] = {x[0], x[1], x[2]};
  to[axis] = position;
  domain->remap(to);
  return region->match(to[0], to[1], to[2]);
}

bool OpenEnd::holds(const double *x) const
{
  const double s = inside(x);
  return s <= 0.0 && s > -2.0 * length && in_patch(x);
}

void OpenEnd::find_places()
{
  places.clear();
  match_region();
  for_fluid(-2.0 * length, zone() + neighbor->skin, [this](int i, double) {
    places.push_back({i, 0.0, 0.0, 0.0, false});
  });
  renew_ranks(!places.empty());
}

// The ranks whose part of the box the zone of this end reaches, or that have particles there: these
// make particles and know the plane. Those that were among them stay so until the next run.
void OpenEnd::renew_ranks(bool has_some)
{
  const double low = inside(domain->sublo), high = inside(domain->subhi);
  const bool there = has_some || domain->triclinic ||
      (std::max(low, high) > -2.0 * length - neighbor->skin &&
       std::min(low, high) < zone() + 2.0 * neighbor->skin);
  if (!anywhere(there && ranks == MPI_COMM_NULL, world)) return;
  const int color = there || ranks != MPI_COMM_NULL ? 0 : MPI_UNDEFINED;
  forget_ranks();
  MPI_Comm_split(world, color, comm->me, &ranks);
}

void OpenEnd::forget_ranks()
{
  if (ranks != MPI_COMM_NULL) MPI_Comm_free(&ranks);
  ranks = MPI_COMM_NULL;
}

void OpenEnd::measure(const std::vector<std::array<double, 3>> &body_forces, bool pressure_varies)
{
  double total[NSUM] = {};
  for (auto &place : places) {
    const int i = place.i, type = atom->type[i];
    const double s = place.inside = inside(atom->x[i]), u = atom->v[i][axis], m = atom->rmass[i];
    const State &state = disc->state[type];
    const double hat = hat_at(s);
    total[MASS_FLOW] += m * side * u * hat;
    total[VOLUME_FLOW] += m / atom->rho[i] * side * u * hat;
    if (s <= 0.0) {
      if (s > -disc->cut) total[BUFFER]++;
      if (pressure_varies && is_far(given(PRESSURE, i))) total[TOO_FAR]++;
      continue;
    }
    double p = state.pressure(atom->rho[i]);
    // a variable need not know a value before the plane
    const double q = has_own_pressure() ? NAN : p - pressure_given(i);
    if (std::isfinite(q) && s < zone()) {
      total[MASS] += m;
      total[BEYOND] += m * q;
      total[FIRST] += m * s;
      total[SECOND] += m * s * s;
      total[SLOPE] += m * q * s;
    }
    const double near = std::max(0.0, 1.0 - s / disc->cut), w = m * near * near,
                 inner = m * std::max(0.0, 1.0 - std::fabs(s - length) / disc->cut);
    p -= atom->rho[i] * body_forces[type][axis] * side * s;
    place.pressure = p;
    total[WEIGHT] += w;
    total[SPEED] += w * side * u;
    total[MEAN_PRESSURE] += w * p;
    total[OVER_IMPEDANCE] += w * p / (state.rho0 * state.c);
    total[INNER_WEIGHT] += inner;
    total[INNER_SPEED] += inner * side * u;
  }
  MPI_Allreduce(total, sum, NSUM, MPI_DOUBLE, MPI_SUM, world);
}

void Absorber::advance(double dt, bool driven)
{
  using E = OpenEnd;
  const double *const sum = end.sum;
  const bool wants_velocity = end.has_own_velocity();
  const double slow = end.slow_rate();
  const double rate = wants_velocity && end.has_own_pressure() ? 0.0
      : absorb == E::AUTO                                      ? (driven ? slow : STIFF * slow)
                                                               : absorb;
  const double spread = sum[E::MASS] * sum[E::SECOND] - sum[E::FIRST] * sum[E::FIRST];
  if (spread > E::LITTLE * std::pow(sum[E::MASS] * end.disc->dx, 2))
    gradient += (1.0 - std::exp(-slow * dt)) *
        ((sum[E::MASS] * sum[E::SLOPE] - sum[E::FIRST] * sum[E::BEYOND]) / spread - gradient);
  const bool known = rate > 0.0 && sum[E::WEIGHT] > 0.0;
  if (known) {
    const double now = end.average(wants_velocity ? E::SPEED : E::OVER_IMPEDANCE);
    if (has_before) wave -= now - before;
    before = now;
  }
  has_before = known;
  wave *= std::exp(-rate * dt);
}

void Absorber::find_area()
{
  double at_plane = 0.0;
  for (const auto &place : end.places)
    at_plane += end.hat_at(end.inside(atom->x[place.i])) *
        std::pow(end.disc->dx_of(atom->type[place.i]), end.disc->dim);
  area = sum_of(at_plane, world);
}

// What pushes the fluid is the stress at the plane, the mean of p sum_j V_j x_ji.grad_i W_ij/D. It
// goes with the square of number density times volume, of which 0.5 % are 5 % of what drives a flow
// if pressure is five times its difference: what the stress lacks is added to the buffer's pressure
void Absorber::meet_pressure(const double *divergence, double dt)
{
  const Discretization &disc = *end.disc;
  enum { PRESSURES, GIVEN, WEIGHTS, NSUM };
  double local[NSUM] = {}, all[NSUM];
  for (const auto &place : end.places) {
    const int i = place.i;
    const State &state = disc.state[atom->type[i]];
    // those that do not see the end of the buffer, where others wait for lists
    const double hat = end.hat_at(end.inside(atom->x[i]), 1.0),
                 volume = atom->rmass[i] / atom->rho[i];
    local[PRESSURES] += hat * volume * state.pressure(atom->rho[i]) * divergence[i] / disc.dim;
    if (place.inside > 0.0) continue;
    local[GIVEN] += hat * end.pressure_given(i);
    local[WEIGHTS] += hat;
  }
  MPI_Allreduce(local, all, NSUM, MPI_DOUBLE, MPI_SUM, world);
  if (all[WEIGHTS] == 0.0) return;
  const State &soft = end.softest();
  const double p = all[GIVEN] / all[WEIGHTS], most = MOST_ADDED * std::fabs(p),
               lacks = p + soft.rho0 * soft.c * wave - all[PRESSURES] / area;
  added += (1.0 - std::exp(-end.slow_rate() * dt)) * lacks;
  added = std::clamp(added, -most, most);
}

// Continuity keeps rho - m psi of a particle, density less that of its number. But what comes in
// through the plane has the density that is given, and the neighbors with which it went out when
// pressure was another: where flow reverses each time adds to their number, since it goes out when
// pressure is higher. And diffusion passes between fluid and buffer what has no volume. So mass is
// compared with density times room, 1/psi, of the fluid before the plane. Particles at a free
// surface do not count; where there is one, a lack says nothing. Of fluid of several spacings it is
// the coarsest that is there, but for those that see another: where two meet, numbers are those of
// neither lattice.
void Fullness::look(const double *psi)
{
  const Discretization &disc = *end.disc;
  enum { MASS, ROOM, MEMBERS, SURFACE, NSUM };
  std::vector<std::array<double, NSUM>> local(disc.levels.size()), all(local.size());
  const auto level = [&](int i) {
    return disc.level_of[atom->type[i]];
  };
  const bool one_level = !disc.has_levels();
  const Cells near_zone(atom->x, one_level ? 0 : atom->nlocal + atom->nghost, disc.dim, disc.cut,
                        [&](int i) {
                          return end.is_fluid(i) && end.inside(atom->x[i]) < end.zone() + disc.cut;
                        });
  const auto sees_another = [&](int i) {
    bool sees = false;
    near_zone.around(atom->x[i], [&](int j, double rsq) {
      const double cut = disc.resolution[atom->type[i]].cut + disc.resolution[atom->type[j]].cut;
      sees = sees || (level(j) != level(i) && 4.0 * rsq < cut * cut);
    });
    return sees;
  };
  for (const auto &place : end.places) {
    const int i = place.i;
    const double s = end.inside(atom->x[i]), m = atom->rmass[i], rho = atom->rho[i];
    // those that do not see the buffer, whose particles may be as near to each other as they like
    if (s <= disc.cut || s >= end.zone() || (!one_level && sees_another(i))) continue;
    const double n = psi[i] * (disc.resolution[atom->type[i]].psi_bulk / disc.psi_bulk);
    auto &sum = local[level(i)];
    const bool at_surface = m * n < AT_SURFACE * rho;
    sum[at_surface ? SURFACE : MEMBERS]++;
    if (at_surface) continue;
    sum[MASS] += m;
    sum[ROOM] += rho / n;
  }
  MPI_Allreduce(local.data(), all.data(), (int) local.size() * NSUM, MPI_DOUBLE, MPI_SUM, world);
  const bool first = now == 0.0;
  now = 1.0;
  double members = 0.0, at_surface = 0.0;
  for (const auto &sum : all) {
    if (members == 0.0 && sum[MEMBERS] > 0.0) now = sum[MASS] / sum[ROOM];
    members += sum[MEMBERS];
    at_surface += sum[SURFACE];
  }
  mean += (now - mean) / (first ? 1 : LOOKS);
  warn(at_surface < EXCESS * members);
}

void Fullness::warn(bool full)
{
  const bool few = full && mean < 1.0 - EXCESS;
  if (warned || comm->me || !(mean > 1.0 + EXCESS || few)) return;
  warned = true;
  error->warning(
      FLERR,
      "{}: within {:g} before its plane there is {:.2g} % {} mass than the fluid's density has "
      "room for, at step {}: particles {}. {}",
      end.name, end.zone(), 100.0 * std::fabs(mean - 1.0), few ? "less" : "more", update->ntimestep,
      few ? "are missing" : "pile up",
      end.softest().p0 > 0.0
          ? "Vortices, bodies or a valve near the plane do so: move it away from them, or take a "
            "lower shift in pair_style fsi/fluid"
          : "Nothing holds their number without keyword background of pair_style fsi/fluid");
}

// Where fluid fills the box: too many particles before the plane get a density that presses them
// out, and those that come in follow each other at another spacing
void Fullness::keep(Ledger &ledger, double dt)
{
  const State &soft = end.softest();
  if (soft.p0 <= 0.0 || now == 0.0) return;
  const double inflow = std::max(0.0, end.average(OpenEnd::SPEED));
  const double excess = std::max(0.0, std::fabs(now - 1.0) - DISORDER);
  column = std::clamp(column + std::copysign(MEND * excess * inflow * dt / end.length, now - 1.0),
                      NARROW, WIDE);
  const double rise = (now - 1.0) * soft.c * dt / (SETTLE * end.disc->h);
  // what is dense where a pressure draws in would press the fluid on, and draw in more of itself
  if (rise == 0.0 || (inflow > 0.0 && !end.has_own_pressure())) return;
  for (const auto &place : end.places) {
    const int i = place.i;
    const double part = 1.0 - end.inside(atom->x[i]) / end.zone();
    if (part > 0.0 && part < 1.0)
      set_density(i, atom->rho[i] * (1.0 + part * rise), atom, *end.disc, ledger, Ledger::FIELDS);
  }
}

/* ----------------------------------------------------------------------
   fits of the fluid in the plane
------------------------------------------------------------------------- */

static constexpr double FIT_INDEPENDENCE = 0.05;    // a monomial is fitted if this part of its norm
                                                    // is orthogonal to the lower ones
static constexpr double NEXT = 1.01;    // in spacings along the plane: rows on both sides of a node

void Nodes::place(int axis, double spacing)
{
  nlateral = 0;
  first[1] = 0;    // in 2D
  count[1] = 1;
  periodic[1] = false;
  for (int d = 0; d < domain->dimension; d++) {
    if (d == axis) continue;
    const int k = nlateral++;
    lateral[k] = d;
    periodic[k] = domain->periodicity[d];
    if (periodic[k]) {
      count[k] = std::max(1, static_cast<int>(std::round(domain->prd[d] / spacing)));
      distance[k] = domain->prd[d] / count[k];
      first[k] = 0;
    } else {
      distance[k] = spacing;
      first[k] = static_cast<int>(std::floor(domain->boxlo[d] / spacing)) - 1;
      count[k] = static_cast<int>(std::ceil(domain->boxhi[d] / spacing)) + 2 - first[k];
    }
  }
  if (nlateral == 1) distance[1] = distance[0];
}

Nodes::Box Nodes::around(const std::vector<const double *> &places, double reach) const
{
  Box box;
  if (places.empty()) return box;
  box.n[1] = 1;
  for (int k = 0; k < nlateral; k++) {
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (const double *x : places) {
      low = std::min(low, x[lateral[k]]);
      high = std::max(high, x[lateral[k]]);
    }
    int from = static_cast<int>(std::floor((low - reach) / distance[k])),
        to = static_cast<int>(std::ceil((high + reach) / distance[k]));
    if (periodic[k] && to - from + 1 >= count[k]) {
      from = 0;
      to = count[k] - 1;
    } else if (!periodic[k]) {
      from = std::max(from, first[k]);
      to = std::min(to, first[k] + count[k] - 1);
    }
    box.low[k] = from;
    box.n[k] = std::max(0, to - from + 1);
  }
  return box;
}

// the numbers of the nodes that are in both boxes, in one of the two: in the order of the first
void Nodes::overlap(const Box &from, const Box &to, bool in_from, std::vector<int> &found) const
{
  found.clear();
  for (int b = 0; b < from.n[1]; b++) {
    if (place_in(to, 1, from.low[1] + b) < 0) continue;
    for (int a = 0; a < from.n[0]; a++) {
      const int node = number(to, from.low[0] + a, from.low[1] + b);
      if (node >= 0) found.push_back(in_from ? b * from.n[0] + a : node);
    }
  }
}

void Nodes::share(const std::vector<const double *> &give, double reach,
                  const std::vector<const double *> &take, double reach_of_taken, MPI_Comm comm)
{
  given = around(give, reach);
  taken = around(take, reach_of_taken);
  ranks = comm;
  peers.clear();
  if (ranks == MPI_COMM_NULL) return;
  int n;
  MPI_Comm_size(ranks, &n);
  const Box boxes[2] = {given, taken};
  std::vector<Box> all(2 * n);
  MPI_Allgather(const_cast<Box *>(boxes), sizeof(boxes), MPI_BYTE, all.data(), sizeof(boxes),
                MPI_BYTE, ranks);
  for (int r = 0; r < n; r++) {
    Peer peer;
    peer.rank = r;
    overlap(given, all[2 * r + 1], true, peer.give);
    overlap(all[2 * r], taken, false, peer.take);
    if (!peer.give.empty() || !peer.take.empty()) peers.push_back(std::move(peer));
  }
}

void Nodes::begin(int to_sum, int largest)
{
  nsum = to_sum;
  nlargest = largest;
  for (const auto &part : {std::make_pair(&given, &sums_given), std::make_pair(&taken, &sums)}) {
    part.second->assign((size_t) part.first->size() * row(), 0.0);
    for (size_t k = nsum; nlargest && k < part.second->size(); k += row())
      std::fill_n(part.second->begin() + k, nlargest, -HUGE_VAL);
  }
}

void Nodes::add(const Peer &peer, const double *from)
{
  for (const int node : peer.take) {
    double *const to = &sums[(size_t) node * row()];
    for (int k = 0; k < nsum; k++) to[k] += from[k];
    for (int k = nsum; k < row(); k++) to[k] = std::max(to[k], from[k]);
    from += row();
  }
}

void Nodes::add_up()
{
  if (ranks == MPI_COMM_NULL) return;
  int me;
  MPI_Comm_rank(ranks, &me);
  std::vector<MPI_Request> requests;
  for (auto &peer : peers) {
    peer.in.resize(peer.take.size() * row());
    if (peer.rank == me || peer.take.empty()) continue;
    requests.emplace_back();
    MPI_Irecv(peer.in.data(), (int) peer.in.size(), MPI_DOUBLE, peer.rank, 0, ranks,
              &requests.back());
  }
  for (auto &peer : peers) {
    peer.out.clear();
    for (const int node : peer.give)
      peer.out.insert(peer.out.end(), &sums_given[(size_t) node * row()],
                      &sums_given[(size_t) node * row()] + row());
    if (peer.rank == me || peer.give.empty()) continue;
    requests.emplace_back();
    MPI_Isend(peer.out.data(), (int) peer.out.size(), MPI_DOUBLE, peer.rank, 0, ranks,
              &requests.back());
  }
  std::vector<MPI_Status> status(requests.size());
  MPI_Waitall((int) requests.size(), requests.data(), status.data());
  for (const auto &peer : peers) add(peer, (peer.rank == me ? peer.out : peer.in).data());
}

double Nodes::memory_usage() const
{
  double bytes = bytes_of(sums_given, sums);
  for (const auto &peer : peers) bytes += bytes_of(peer.out, peer.in, peer.give, peer.take);
  return bytes;
}

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
void PlaneFit::fit(int nmoment, int nfit, int nfields)
{
  for (int node = 0; node < nodes.taken.size(); node++) {
    double *const c = &nodes.sums[(size_t) node * nodes.row()], *const moment = c, row[6];
    if (moment[0] <= OpenEnd::LITTLE * end.disc->psi_bulk) {
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

void PlaneFit::share()
{
  nodes.place(end.axis, end.disc->dx);
  // until the next lists particles move by half a skin, and a little
  const double moved = 0.5 * neighbor->skin + end.disc->dx;
  std::vector<const double *> before, behind;
  for (const auto &place : end.places) {
    const double *const x = atom->x[place.i];
    if (end.inside(x) > -moved) before.push_back(x);
    if (end.inside(x) < moved) behind.push_back(x);
  }
  nodes.share(before, end.disc->cut + moved, behind, reach() + moved, end.ranks);
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

void PlaneFit::measure()
{
  const Discretization &disc = *end.disc;
  const bool wants_velocity = end.has_own_velocity(), wants_pressure = end.has_own_pressure();
  // monomials of the offset over dx, by their degree: those of the fit, and all that its matrix has
  const bool plane = nodes.nlateral == 2;
  const int nfit = plane ? 6 : 3, nmoment = plane ? 15 : 5;
  nbounds = nmoment + nfit * (wants_velocity + wants_pressure);
  nodes.begin(nbounds, wants_velocity ? 2 : 0);
  const ChosenKernel kernel(disc.kernel, disc.dim, disc.h);
  for (const auto &place : end.places) {
    const double away = wants_pressure ? place.inside : std::fabs(place.inside - end.length);
    if (place.inside <= 0.0 || away >= disc.cut) continue;
    const double u = atom->v[place.i][end.axis], p = place.pressure;
    const auto add_to = [&](int node, const double *d) {
      const double r = std::sqrt(std::min(away * away + d[0] * d[0] + d[1] * d[1], kernel.cutsq)),
                   W = kernel.W(r);
      const double y[] = {d[0] / disc.dx, d[1] / disc.dx};
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
    nodes.at(nodes.given, atom->x[place.i], std::sqrt(kernel.cutsq - away * away), add_to);
  }
  nodes.add_up();
  fit(nmoment, nfit, wants_velocity + wants_pressure);
}

// exact for quadratics (Keys 1981, IEEE Trans. Acoust. Speech Signal Process. 29, 1153, eq. 15);
// linear interpolation cuts maxima
static double cubic_convolution(double t)
{
  if (t < 1.0) return 1.0 + t * t * (1.5 * t - 2.5);
  return t < 2.0 ? 2.0 - t * (4.0 - t * (2.5 - 0.5 * t)) : 0.0;
}

// The velocity is one that the fluid has there: the first row at a wall would else go back for as
// much as a parabola falls below it, and bring in more and more.
bool PlaneFit::at(const double *x, double *values) const
{
  const bool has_velocity = end.has_own_velocity();
  const int n = has_velocity + end.has_own_pressure();
  double weight = 0.0, most = -HUGE_VAL, least = HUGE_VAL;
  std::fill_n(values, n, 0.0);
  nodes.at(nodes.taken, x, reach(), [&](int node, const double *d) {
    const double *const c = &nodes.sums[(size_t) node * nodes.row()];
    if (c[0] == 0.0) return;
    double w = 1.0;
    for (int k = 0; k < nodes.nlateral; k++)
      w *= cubic_convolution(std::fabs(d[k]) / nodes.distance[k]);
    weight += w;
    for (int k = 0; k < n; k++) values[k] += w * c[1 + k];
    if (!has_velocity) return;
    most = std::max(most, c[nbounds]);
    least = std::min(least, -c[nbounds + 1]);
  });
  if (weight < 0.5) return false;
  for (int k = 0; k < n; k++) values[k] /= weight;
  if (least <= most) values[0] = std::clamp(values[0], least, most);
  return true;
}
