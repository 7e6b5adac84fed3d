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

#include "fsi_refine.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fsi_hub.h"
#include "fsi_kernel.h"
#include "fsi_keywords.h"
#include "group.h"
#include "lammps.h"
#include "math_extra.h"
#include "region.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace FSI;

static constexpr double ROUND_OFF = 1.0e-12;    // of differences of distances

Zones::Zones(LAMMPS *lmp, const std::string &label) :
    Pointers(lmp), label(label), directions(split_directions(domain->dimension))
{
}

static bool is_union(const Region *region)
{
  return strcmp(region->style, "union") == 0;
}

void Zones::read_regions(const std::vector<std::string> &words)
{
  region_ids = words;
  for (const auto &name : region_ids)
    if (!domain->get_region_by_id(name))
      error->all(FLERR, "Region {} of fix fsi/refine does not exist", name);
}

void Zones::read_distances(const std::vector<std::string> &words)
{
  if (words.empty()) utils::missing_cmd_args(FLERR, "fix fsi/refine distance", error);
  body_id = words[0];
  find_body();
  for (size_t k = 1; k < words.size(); k++) {
    distances.push_back(numeric(lmp, label + " distance", words[k], Range::above(0.0)));
    if (k > 1 && distances[k - 1] >= distances[k - 2])
      error->all(FLERR, "{} distance: {} after {}, expected less: the finer levels are nearer",
                 label, distances[k - 1], distances[k - 2]);
  }
}

// A group may be deleted, and another take its bit
void Zones::find_body()
{
  if (body_id.empty()) return;
  const int of_body = group->find(body_id);
  if (of_body < 0) error->all(FLERR, "Group {} of fix fsi/refine distance does not exist", body_id);
  body_bit = group->bitmask[of_body];
}

void Zones::check_number(size_t types)
{
  if (!region_ids.empty() && !distances.empty())
    error->all(FLERR, "{} takes region or distance, not both", label);
  nested = types == 0;
  if (nested && region_ids.size() + distances.size() != 1)
    error->all(FLERR,
               "{} finest has {} {}: expected one, for the finest level: those of the others "
               "follow from it",
               label, region_ids.size() + distances.size(),
               distances.empty() ? "regions" : "distances");
  // of an intersection LAMMPS finds no distance
  for (const auto &name : region_ids) {
    const Region *const region = nested ? domain->get_region_by_id(name) : nullptr;
    if (region && region->nregion > 1 && !(is_union(region) && region->interior))
      error->all(FLERR, "{} finest: region {} is of style {}: expected one shape or a union", label,
                 name, region->style);
  }
  if (nested) return;
  if (region_ids.size() + distances.size() != types - 1)
    error->all(FLERR,
               "{} has {} types and {} {}: expected one for each type but the first, that of "
               "larger spacing first",
               label, types, region_ids.size() + distances.size(),
               distances.empty() ? "regions" : "distances");
}

// Zones of levels k and k + 1 end so far apart that a particle sees one level beside its own
void Zones::init(const Discretization &disc, const std::vector<int> &types)
{
  find_body();
  // each by the least that there has to be between two
  wider.assign(types.size() - 1, 0.0);
  for (size_t k = nested ? wider.size() - 1 : 0; k > 0; k--)
    wider[k - 1] = wider[k] + disc.resolution[types[k - 1]].cut + disc.dx_of(types[k]);
  regions.clear();
  can_move = !distances.empty();
  for (const auto &name : region_ids) {
    regions.push_back(domain->get_region_by_id(name));
    if (!regions.back()) error->all(FLERR, "Region {} of fix fsi/refine does not exist", name);
    can_move = can_move || regions.back()->dynamic_check();
  }
  for (size_t k = 1; k < distances.size(); k++) {
    const double shell = distances[k - 1] - distances[k],
                 least = disc.resolution[types[k - 1]].cut + disc.dx_of(types[k]);
    if (shell < (1.0 - ROUND_OFF) * least)
      error->all(FLERR,
                 "{} distance: from {} to {} there is {:g} for atom type {}: expected at least "
                 "{:g}, the kernel's support of type {} and a spacing of type {}",
                 label, distances[k], distances[k - 1], shell, types[k], least, types[k - 1],
                 types[k]);
  }
}

std::string Zones::names(int k) const
{
  if (regions.empty()) return "";
  if (!nested) return fmt::format(" ({} and {})", region_ids[k - 1], region_ids[k]);
  return can_move ? " (what moves is not continued across a periodic face)" : "";
}

void Zones::find(const Discretization &disc, double beyond, double time)
{
  ahead = time;
  for (auto *region : regions) region->prematch();
  if (!body_bit) return;
  const auto body = everywhere(lmp, distances[0] + wider[0] + beyond, [this](int i) {
    return (atom->mask[i] & body_bit) != 0;
  });
  if (body.empty())
    error->all(FLERR, "{} distance: there are no atoms in group {}", label, body_id);
  away.assign(atom->nlocal, Cells::LARGE);
  for (int i = 0; i < atom->nlocal; i++)
    if (disc.state[atom->type[i]].species == FLUID) away[i] = std::sqrt(body.nearest(atom->x[i]));
}

// does a region that x is not in begin within this distance?
static bool is_near(Region *region, const double *x, double distance)
{
  if (is_union(region))
    return std::any_of(region->reglist, region->reglist + region->nregion, [&](Region *part) {
      return is_near(part, x, distance);
    });
  region->interior ^= 1;
  const int n = region->surface(x[0], x[1], x[2], distance);
  region->interior ^= 1;
  return n > 0;
}

// The same of a region and of its images in a periodic box, also where x is in one. A region that
// moves or is turned inside out has no bounds, and none.
bool Zones::is_near_image(Region *region, const double *x, double distance) const
{
  const double bounds[3][2] = {{region->extent_xlo, region->extent_xhi},
                               {region->extent_ylo, region->extent_yhi},
                               {region->extent_zlo, region->extent_zhi}};
  int n[3];
  for (int d = 0; d < 3; d++)
    n[d] = d < domain->dimension && domain->periodicity[d] && region->bboxflag &&
        !region->dynamic_check();
  for (int a = -n[0]; a <= n[0]; a++)
    for (int b = -n[1]; b <= n[1]; b++)
      for (int c = -n[2]; c <= n[2]; c++) {
        const int image[3] = {a, b, c};
        double y[3];
        bool there = true;
        for (int d = 0; d < 3; d++) {
          y[d] = x[d] + image[d] * domain->prd[d];
          there = there &&
              (image[d] == 0 ||
               (y[d] >= bounds[d][0] - distance && y[d] <= bounds[d][1] + distance));
        }
        if (there && (region->match(y[0], y[1], y[2]) || is_near(region, y, distance))) return true;
      }
  return false;
}

// A zone grown by a distance: is any place as far away, in a number of directions, inside?
bool Zones::has(int k, int i, double grown) const
{
  const int given = nested ? 0 : k - 1;
  if (regions.empty()) return away[i] < distances[given] + wider[k - 1] + grown;
  Region *const region = regions[given];
  double x[3] = {atom->x[i][0], atom->x[i][1], atom->x[i][2]};
  if (region->dynamic_check()) {
    for (int d = 0; d < 3; d++) x[d] += ahead * atom->v[i][d];
    domain->remap(x);
  }
  if (nested) return is_near_image(region, x, wider[k - 1] + grown);
  if (region->match(x[0], x[1], x[2])) return true;
  if (grown == 0.0) return false;
  const auto matches = [&](const std::array<double, 3> &e, double to) {
    double at[3] = {x[0] + to * e[0], x[1] + to * e[1], x[2] + to * e[2]};
    domain->remap(at);
    return region->match(at[0], at[1], at[2]) != 0;
  };
  for (const auto &e : directions)
    if (matches(e, grown) || matches(e, -grown)) return true;
  return false;
}

// ---- settling ----

// A step over the sum of V grad W dx^2
static constexpr double STRENGTH = 0.15;
// Sums of V W: particles with the first are at a surface and stay, with the second move as others
static constexpr double SURFACE = 0.9, INSIDE = 0.95;
static constexpr int POINT = 4;        // of points: position and volume
static constexpr double SKIN = 0.5;    // of rows, in spacings of the two

Settling::Settling(LAMMPS *lmp, const Discretization &disc, const StepState &step, Ledger &ledger,
                   const std::vector<char> &moves, const std::vector<Position> &changed) :
    Pointers(lmp),
    disc(disc), step(step), ledger(ledger)
{
  const double of_body = disc.cut + disc.dx, beyond = disc.cut + 1.1 * of_body;
  const Everywhere events(lmp, beyond, changed);
  // the others hold no particle off: what moves is within the support of an event
  const auto bodies = everywhere(lmp, of_body, [&](int j) {
    return disc.state[atom->type[j]].is_body() && events.nearest(atom->x[j]) < beyond * beyond;
  });
  mobility.assign(atom->nlocal, 0.0);
  for (int i = 0; i < atom->nlocal; i++) {
    if (!moves[i]) continue;
    const double *const x = atom->x[i];
    const double cut = disc.resolution[atom->type[i]].cut, dx = disc.dx_of(atom->type[i]);
    const double event = events.nearest(x);
    if (event >= cut * cut) continue;
    double body = std::sqrt(std::min((cut + dx) * (cut + dx), bodies.nearest(x)));
    for (const auto &wall : step.walls.wall)
      if (wall.finite && wall.spans(x, cut)) body = std::min(body, std::fabs(wall.distance(x)));
    mobility[i] =
        std::min(1.0, 2.0 - 2.0 * std::sqrt(event) / cut) * std::max(0.0, (body - cut) / dx);
  }
}

Settling::Settling(LAMMPS *lmp, const Discretization &disc, const StepState &step, Ledger &ledger,
                   const std::vector<double> &mobility, const std::vector<char> &judged,
                   const std::function<void(int)> &bound) :
    Pointers(lmp),
    disc(disc), step(step), ledger(ledger), mobility(mobility), judged(judged), bound(bound)
{
}

void Settling::find_rows()
{
  const int nall = atom->nlocal + atom->nghost;
  const int *const type = atom->type;
  const Cells cells(atom, disc.dim, 0.25 * disc.cut, [&](int j) {
    return disc.state[type[j]].species != NONE;
  });
  const auto reach_of = [&](int t) {
    return 0.5 * (disc.resolution[t].cut + SKIN * disc.dx_of(t));
  };
  double widest = 0.0;
  for (int t = 1; t <= atom->ntypes; t++) widest = std::max(widest, reach_of(t));
  rows.clear();
  neighbors.clear();
  for (int i = 0; i < atom->nlocal; i++) {
    if (mobility[i] <= 0.0) continue;
    const size_t first = neighbors.size();
    const double reach_i = reach_of(type[i]);
    cells.around(atom->x[i], reach_i + widest, [&](int j, double rsq) {
      const double reach = reach_i + reach_of(type[j]);
      if (rsq < reach * reach) neighbors.push_back(j);
    });
    rows.push_back({i, (int) (neighbors.size() - first), nullptr});
  }
  const int *of_row = neighbors.data();
  for (auto &row : rows) {
    row.j = of_row;
    of_row += row.n;
  }
  start.resize(3 * nall);
  for (int i = 0; i < nall; i++) MathExtra::copy3(atom->x[i], &start[3 * i]);
}

bool Settling::rows_hold() const
{
  for (int i = 0; i < atom->nlocal + atom->nghost; i++) {
    const double most = 0.5 * SKIN * disc.dx_of(atom->type[i]);
    if (MathExtra::distsq3(atom->x[i], &start[3 * i]) > most * most) return false;
  }
  return true;
}

void Settling::run(int sweeps)
{
  const int nall = atom->nlocal + atom->nghost;
  points.resize(POINT * nall);
  for (int j = 0; j < nall; j++) {
    const bool counts = step.walls.is_before_planes(atom->x[j]);
    // densities of walls, and of solids by sums, are made anew when a run begins
    const State &s = disc.state[atom->type[j]];
    const double rho = s.is_body() ? s.rho0 : atom->rho[j];
    points[POINT * j + 3] = counts ? atom->rmass[j] / rho : 0.0;
  }
  mirrors.assign(1, Mirror(step.walls, {}));
  for (const auto &s : step.walls.reflections) mirrors.emplace_back(step.walls, s);
  with_kernel(disc.kernel, disc.dim, disc.h, [&](const auto &kernel) {
    using K = std::decay_t<decltype(kernel)>;
    std::vector<K> of_types;
    for (int a = 0; a <= atom->ntypes; a++)
      for (int b = 0; b <= atom->ntypes; b++)
        of_types.emplace_back(0.5 * (disc.h_of(a) + disc.h_of(b)));
    for (int k = 0; k < sweeps; k++) {
      if (k == 0 || !rows_hold()) find_rows();
      for (int j = 0; j < nall; j++) std::copy_n(atom->x[j], 3, &points[POINT * j]);
      sum_up(of_types);
      if (step.walls.finite()) add_images_of_segments(of_types);
      displace<K::DIM>();
      comm->forward_comm();
    }
  });
}

// Adds the sum of V grad W over images of a row's particles to the first DIM of sums, and that of
// V W to the last. Kernels vanish where they end, and the gradient of a particle's own is zero.
template <class T, class K>
FSI_INLINE static void add_images(const Row &row, const double *points, const int *type,
                                  const K *with, const Mirror &mirror, double *sums)
{
  const double *const xi = points + POINT * row.i;
  T sum[K::DIM + 1];
  for (auto &s : sum) s = T(0.0);
  for_neighbors<T, false>(row, [&](const int *j, const T &there) FSI_INLINE_LAMBDA {
    const auto of = [&](int n) FSI_INLINE_LAMBDA {
      return Lanes<T>::make([&](int k) FSI_INLINE_LAMBDA {
        return points[POINT * j[k] + n];
      });
    };
    T away[K::DIM], rsq = T(0.0);
    for (int a = 0; a < K::DIM; a++) {
      away[a] = xi[a] - mirror.x[a] - mirror.sign[a] * of(a);
      rsq += away[a] * away[a];
    }
    const T hinv = Lanes<T>::make([&](int k) FSI_INLINE_LAMBDA {
      return with[type[j[k]]].hinv;
    });
    const T norm = Lanes<T>::make([&](int k) FSI_INLINE_LAMBDA {
      return with[type[j[k]]].norm;
    });
    const T q = root(rsq) * hinv, vol = there * of(3) * norm, g = vol * hinv * hinv * K::dwq(q);
    for (int a = 0; a < K::DIM; a++) sum[a] += g * away[a];
    sum[K::DIM] += vol * K::w(q);
  });
  for (int n = 0; n <= K::DIM; n++) sums[n] += Lanes<T>::sum(sum[n]);
}

template <class K> void Settling::sum_up(const std::vector<K> &of_types)
{
  const Walls &walls = step.walls;
  const std::vector<Walls::Reflection> &reflections = walls.reflections;
  const double *const *const x = atom->x;
  const int *const type = atom->type;
  const bool segments = walls.finite();
  sums.assign(rows.size(), {});
  at_walls.clear();
  run_widest([&](const auto &number) FSI_INLINE_LAMBDA {
    using Number = std::decay_t<decltype(number)>;
    for (size_t r = 0; r < rows.size(); r++) {
      const Row &row = rows[r];
      const K *const with = &of_types[type[row.i] * (atom->ntypes + 1)];
      double *const sum_i = sums[r].data();
      add_images<Number>(row, points.data(), type, with, mirrors[0], sum_i);
      const int near = walls.near(x[row.i], 0.5 * (disc.resolution[type[row.i]].cut + disc.cut));
      if (near && segments) at_walls.emplace_back(r, near);
      for (size_t s = 0; near && s < reflections.size(); s++)
        if ((reflections[s].mask & near) == reflections[s].mask && !walls.finite(reflections[s]))
          add_images<Number>(row, points.data(), type, with, mirrors[s + 1], sum_i);
    }
  });
}

// They hide some of what is behind them, images and particles themselves
template <class K> void Settling::add_images_of_segments(const std::vector<K> &of_types)
{
  const Walls &walls = step.walls;
  const double *const *const x = atom->x;
  const int *const type = atom->type;
  for (const auto &[r, near] : at_walls) {
    const int i = rows[r].i;
    double *const sum_i = sums[r].data();
    for (int n = 0; n < rows[r].n; n++) {
      const int j = rows[r].j[n];
      const K &kernel = of_types[type[i] * (atom->ntypes + 1) + type[j]];
      const auto add = [&](double rsq, const double *away, double volume) {
        const double distance = std::sqrt(rsq), g = volume * kernel.gradient(distance);
        for (int a = 0; a < K::DIM; a++) sum_i[a] += g * away[a];
        sum_i[K::DIM] += volume * kernel.W(distance);
      };
      const double volume = points[POINT * j + 3], rsq0 = MathExtra::distsq3(x[i], x[j]);
      walls.images(near & walls.near(x[j], disc.cut), rsq0, x[i], x[j], kernel.cutsq,
                   [&](const Walls::Reflection &s, double rsq, const double *away) {
                     if (walls.finite(s)) add(rsq, away, volume);
                   });
      if (rsq0 >= kernel.cutsq || !walls.row().divide(x[i], x[j])) continue;
      const double away[3] = {x[i][0] - x[j][0], x[i][1] - x[j][1], x[i][2] - x[j][2]};
      add(rsq0, away, -volume);
    }
  }
}

template <int D> void Settling::displace()
{
  double *const *const x = atom->x, *const account = ledger.account(Ledger::LEVELS);
  last = {};
  for (size_t r = 0; r < rows.size(); r++) {
    const int i = rows[r].i;
    double d[3] = {};
    std::copy_n(sums[r].data(), D, d);
    const double dx = disc.dx_of(atom->type[i]),
                 full = std::clamp((sums[r][D] - SURFACE) / (INSIDE - SURFACE), 0.0, 1.0);
    if (!judged.empty() && judged[i] && full == 1.0) {
      const double residue = dx * MathExtra::len3(d);
      last.largest = std::max(last.largest, residue);
      last.squares += residue * residue;
      last.n++;
    }
    MathExtra::scale3(-STRENGTH * dx * dx * mobility[i] * full, d);
    const double length = MathExtra::len3(d);
    if (length > LONGEST * dx) MathExtra::scale3(LONGEST * dx / length, d);
    if (account) *account += step.body_forces.potential(i);
    for (int a = 0; a < D; a++) x[i][a] += d[a];
    if (bound) bound(i);
    if (account) *account -= step.body_forces.potential(i);
  }
}
