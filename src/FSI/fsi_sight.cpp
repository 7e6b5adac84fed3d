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

#include "fsi_sight.h"

#include "atom.h"
#include "fsi_hub.h"
#include "fsi_kernel.h"
#include "math_extra.h"
#include "neighbor.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace FSI;

static constexpr int NTABLE = 400;    // distances for which forces are tabulated
// A line meets a body if the particles within their spacing of it add up to these, and is inside of
// it as long as the mean place of those around leans to no side by more than this: 1 is at an edge,
// where it is so much of the radius, 5/16 in 2D and 64/(70 pi) in 3D
static constexpr double MISSES = 0.15, MEETS = 0.5, INSIDE = 0.1, OUTSIDE = 0.4, AT_EDGE = 0.3;
// (distance over support)^2 from which on kernels are zero half a step ago, too
static constexpr double FAR = 1.1;
// Of equals, and of a side, the edges: in spacings, as the cosine of an angle
static constexpr double AS_NEAR = 0.2, ASIDE = 0.3;

// A layer of particles counts as a smeared one, with the kernel that is sharper where its lattice
// is finer than the fluid's.
void Sight::tabulate()
{
  std::vector<double> spacings;
  for (const auto &level : disc.levels) spacings.push_back(level.dx);
  if (spacings == tabulated) return;
  tabulated = spacings;
  half_space.assign(spacings.size() * types.size(), {});
  for (size_t k = 0; k < half_space.size(); k++) {
    const Resolution &level = disc.levels[k / types.size()];
    const size_t t = k % types.size();
    if (types[t] == 0.0) continue;
    const double dx = disc.dx_of(t), sharper = disc.sharper_of(t, level.dx);
    const ChosenKernel kernel(disc.kernel, disc.dim, level.h);
    constexpr int STEPS = 200;
    const double step = kernel.cut / STEPS;
    for (int place = 0; place <= NTABLE; place++) {
      Backfill sum = {0.0, 0.0};
      for (double a = place * kernel.cut / NTABLE; a < kernel.cut; a += dx)
        for (int m = 0; m < STEPS; m++) {
          const double s = (m + 0.5) * step, r = std::sqrt(a * a + s * s);
          if (r >= kernel.cut) continue;
          sum.force -= (kernel.dim == 3 ? s : 1.0) * a * kernel.sharper_gradient(r, sharper);
          sum.weight += (kernel.dim == 3 ? s : 1.0) * kernel.sharper(r, sharper);
        }
      half_space[k].push_back(sum);
    }
  }
}

Sight::Backfill Sight::beyond(size_t level, int type, double distance) const
{
  const double at = std::max(distance, 0.0) / disc.levels[level].cut * NTABLE;
  const int k = static_cast<int>(at);
  if (k >= NTABLE) return {0.0, 0.0};
  const Backfill *const table = half_space[level * types.size() + type].data();
  const Backfill &a = table[k], &b = table[k + 1];
  return {a.force + (at - k) * (b.force - a.force), a.weight + (at - k) * (b.weight - a.weight)};
}

// local particles and ghosts into cells as wide as the reach of neighbor lists. Those of other
// bodies count, too, where a thin one goes on as one of them.
bool Sight::counts(int type) const
{
  return types[type] != 0.0 || disc.state[type].is_body();
}

void Sight::find_bodies()
{
  const int *const type = atom->type, nall = atom->nlocal + atom->nghost;
  const Vector *const x = vectors(atom->x);
  per_cell = 1.0 / (disc.cut + neighbor->skin);
  double high[3] = {};
  int count = 0;
  for (int i = 0; i < nall; i++) {
    if (!counts(type[i])) continue;
    for (int d = 0; d < 3; d++) {
      low[d] = count ? std::min(low[d], x[i][d]) : x[i][d];
      high[d] = count ? std::max(high[d], x[i][d]) : x[i][d];
    }
    count++;
  }
  for (int d = 0; d < 3; d++)
    n[d] = count ? static_cast<int>((high[d] - low[d]) * per_cell) + 1 : 0;
  first.assign((size_t) n[0] * n[1] * n[2] + 2, 0);
  places.resize(count);
  const auto cell = [&](const double *p) {
    size_t c = 0;
    for (int d = 0; d < 3; d++) c = c * n[d] + static_cast<int>((p[d] - low[d]) * per_cell);
    return c;
  };
  for (int i = 0; i < nall; i++)
    if (counts(type[i])) first[cell(x[i]) + 2]++;
  for (size_t c = 2; c < first.size(); c++) first[c] += first[c - 1];
  for (int i = 0; i < nall; i++)
    if (counts(type[i]))
      places[first[cell(x[i]) + 1]++] = {{x[i][0], x[i][1], x[i][2]}, i, types[type[i]] != 0.0};
}

void Sight::follow_bodies()
{
  const Vector *const x = vectors(atom->x);
  for (auto &place : places) std::copy_n(x[place.i], 3, place.x);
}

template <class Visit> void Sight::for_near(const double *x, Visit visit) const
{
  int lo[3], hi[3];
  for (int d = 0; d < 3; d++) {
    const int at = static_cast<int>(std::floor((x[d] - low[d]) * per_cell));
    lo[d] = std::max(at - 1, 0);
    hi[d] = std::min(at + 1, n[d] - 1);
  }
  for (int a = lo[0]; a <= hi[0]; a++)
    for (int b = lo[1]; b <= hi[1]; b++)
      for (int c = lo[2]; c <= hi[2]; c++) {
        const size_t at = ((size_t) a * n[1] + b) * n[2] + c;
        for (int k = first[at]; k < first[at + 1]; k++)
          if (visit(places[k])) return;
      }
}

bool Sight::near(const double *x) const
{
  const double reach = disc.cut + neighbor->skin;
  bool any = std::any_of(walls.wall.begin(), walls.wall.end(), [&](const Wall &w) {
    return w.finite && std::fabs(w.distance(x)) < reach && w.spans(x, reach);
  });
  for_near(x, [&](const Place &p) {
    return any = any || p.thin;
  });
  return any;
}

// A solid that passes through a mirror wall goes on in its images, which fluids meet in place of
// what is behind.
void Sight::look_from(const double *x, double largest, double slack)
{
  reach = largest;
  const double within = (reach + slack) * (reach + slack);
  const bool by_walls = walls.near(x, reach + slack);
  seen.clear();
  std::copy_n(x, 3, from);
  for_near(x, [&](const Place &p) {
    Seen s = {};
    for (int d = 0; d < disc.dim; d++) {
      s.x[d] = p.x[d] - x[d];
      s.rsq += s.x[d] * s.x[d];
    }
    if (s.rsq >= within) return false;
    s.type = atom->type[p.i];
    s.dx = disc.dx_of(s.type);
    s.volume = disc.dim == 3 ? s.dx * s.dx * s.dx : s.dx * s.dx;
    s.thin = p.thin;
    const bool of_wall = disc.state[s.type].species == RIGID;
    s.mirrors = by_walls ? walls.mirroring(of_wall, atom->mask[p.i]) : 0;
    const bool behind = by_walls && !of_wall &&
        std::any_of(walls.wall.begin(), walls.wall.end(), [&](const Wall &w) {
                          return !w.finite && w.distance(p.x) < 0.0;
                        });
    if (!behind) seen.push_back(s);
    return false;
  });
  if (by_walls) see_images();
}

void Sight::see_images()
{
  const int mask = walls.near(from, reach);
  for (size_t k = 0, n = seen.size(); k < n; k++) {
    const Seen s = seen[k];
    const double y[3] = {from[0] + s.x[0], from[1] + s.x[1], from[2] + s.x[2]};
    walls.images(mask & s.mirrors & walls.near(y, reach), s.rsq, from, y, reach * reach,
                 [&](const Walls::Reflection &, double rsq, const double *d) {
                   seen.push_back({{-d[0], -d[1], -d[2]}, rsq, s.dx, s.volume, s.type, 0, s.thin});
                 });
  }
}

double Sight::way_to(const double *y, double (&d)[3]) const
{
  double dsq = 0.0;
  for (int k = 0; k < 3; k++) {
    d[k] = k < disc.dim ? y[k] - from[k] : 0.0;
    dsq += d[k] * d[k];
  }
  return dsq;
}

bool Sight::may_hide(const double *y, double slack) const
{
  if (walls.row().may_divide(from, y, slack)) return true;
  double d[3];
  const double length = std::sqrt(way_to(y, d));
  for (double &e : d) e /= length;
  return std::any_of(seen.begin(), seen.end(), [&](const Seen &s) {
    if (!s.thin) return false;
    const double along = MathExtra::dot3(s.x, d);
    const double off = s.dx + slack;
    return along > -slack && along < length + slack && s.rsq - along * along < off * off;
  });
}

// sum = how many particles of thin bodies the line meets, which end with their spacing and at both
// ends of the line; lean = the mean place across the line of what is around where it meets them,
// over that beside a straight edge. The ball in which that is reaches as far as both supports do,
// so that each rank that has one of the pair has what is in it.
static double smooth(double x)
{
  const double t = std::min(std::max(x, 0.0), 1.0);
  return t * t * (3.0 - 2.0 * t);
}

double Sight::visible(const double *y, double cut) const
{
  double d[3];
  if (way_to(y, d) >= FAR * cut * cut) return 1.0;
  return walls.row().divide(from, y) ? 0.0 : left_of(y, cut);
}

double Sight::left_of(const double *y, double cut) const
{
  const double cutsq = cut * cut;
  double d[3];
  const double dsq = way_to(y, d);
  double sum = 0.0, middle = 0.0, spacing = 0.0;
  for (const auto &s : seen) {
    const double along = MathExtra::dot3(s.x, d);
    if (!s.thin || along <= 0.0 || along >= dsq) continue;
    // within the support of both, so that it is the same from either
    if (s.rsq >= cutsq || s.rsq - 2.0 * along + dsq >= cutsq) continue;
    const double t = along / dsq, near = 1.0 - (s.rsq - t * t * dsq) / (s.dx * s.dx);
    if (near <= 0.0) continue;
    const double met = 4.0 * t * (1.0 - t) * near * near;
    sum += met;
    middle += met * t;
    spacing += met * s.dx;
  }
  if (sum <= MISSES) return 1.0;
  middle /= sum;
  const double radius =
      std::max(cut - std::sqrt(dsq) * std::max(middle, 1.0 - middle), spacing / sum);
  double weight = 0.0, place[3] = {};
  for (const auto &s : seen) {
    if (s.rsq >= cutsq) continue;
    const double t = MathExtra::dot3(s.x, d) / dsq, off = t - middle;
    const double rest = 1.0 - (s.rsq - t * t * dsq + off * off * dsq) / (radius * radius);
    if (rest <= 0.0 || s.rsq + (1.0 - 2.0 * t) * dsq >= cutsq) continue;
    const double w = s.volume * rest * rest;
    weight += w;
    for (int k = 0; k < disc.dim; k++) place[k] += w * (s.x[k] - t * d[k]);
  }
  const double lean = weight > 0.0 ? MathExtra::len3(place) / (AT_EDGE * radius * weight) : 0.0;
  return 1.0 -
      smooth((sum - MISSES) / (MEETS - MISSES)) * smooth((OUTSIDE - lean) / (OUTSIDE - INSIDE));
}

// The body is as thick as it is along its normal through x, which is the mean of what is on the
// side of the nearest particle, as far as the support reaches.
bool Sight::find_face(size_t level, const Seen &nearest, Face &face) const
{
  const double cut = disc.levels[level].cut, cutsq = cut * cut;
  double normal[3] = {};
  for (const auto &s : seen) {
    const double ahead = MathExtra::dot3(s.x, nearest.x) / std::sqrt(s.rsq * nearest.rsq);
    if (!s.thin || s.rsq >= cutsq || !(ahead > 0.0)) continue;
    const double rest = 1.0 - s.rsq / cutsq;
    const double w = smooth(ahead / ASIDE) * rest * rest * rest;
    for (int d = 0; d < 3; d++) normal[d] += w * s.x[d];
  }
  const double length = MathExtra::len3(normal), dx = nearest.dx, tube = 0.75 * dx;
  if (length == 0.0) return false;
  for (double &e : normal) e /= length;
  double front = cut, back = 0.0;
  for (const auto &s : seen) {
    if (!s.thin || s.rsq >= cutsq) continue;
    const double depth = MathExtra::dot3(s.x, normal);
    if (depth <= 0.0 || s.rsq - depth * depth > tube * tube) continue;
    front = std::min(front, depth);
    back = std::max(back, depth);
  }
  face = {nearest.type, {normal[0], normal[1], normal[2]}, front, back - front + dx};
  return back > 0.0;
}

// Several may be nearest, on a lattice and between two bodies: the mean of what each says, where
// one that is farther by AS_NEAR of its spacing has no say
Sight::Backfill Sight::backfill(size_t level) const
{
  const double cutsq = disc.levels[level].cut * disc.levels[level].cut;
  double least = cutsq, total = 0.0;
  for (const auto &s : seen)
    if (s.thin) least = std::min(least, s.rsq);
  least = std::sqrt(least);
  Backfill mean = {0.0, 0.0};
  Face face;
  for (const auto &s : seen) {
    const double say = smooth(1.0 - (std::sqrt(s.rsq) - least) / (AS_NEAR * s.dx));
    if (!s.thin || s.rsq >= cutsq || say == 0.0 || !find_face(level, s, face)) continue;
    const Backfill part = backfill(level, face);
    mean.force += say * part.force;
    mean.weight += say * part.weight;
    total += say;
  }
  return total > 0.0 ? Backfill{mean.force / total, mean.weight / total} : Backfill{1.0, 1.0};
}

// In the part in which the body hides the place that is as far behind it as x is before it. Not
// where the rest of a half space pulls: the sharper kernel is negative at its end, and what is
// missing may be as much as what is there.
Sight::Backfill Sight::backfill(size_t level, const Face &face) const
{
  static constexpr double MOST = 20.0;    // x in the plane of a layer, which pushes to no side
  const Backfill all = beyond(level, face.type, face.distance),
                 missing = beyond(level, face.type, face.distance + face.thickness);
  if (missing.weight == 0.0) return {1.0, 1.0};
  double y[3];
  const double across = 2.0 * face.distance + face.thickness - disc.dx_of(face.type);
  for (int d = 0; d < 3; d++) y[d] = from[d] + across * face.normal[d];
  const double there = 1.0 - left_of(y, disc.levels[level].cut);
  const auto over = [&](double whole, double rest) {
    if (rest <= 0.0 || whole <= rest) return 1.0;
    return std::min(1.0 + there * rest / (whole - rest), MOST);
  };
  return {over(all.force, missing.force), over(all.weight, missing.weight)};
}
