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
#include "fsi_kernel.h"
#include "fsi_scene.h"
#include "neighbor.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace FSI;

static constexpr int NTABLE = 400;    // distances for which forces are tabulated

/* ----------------------------------------------------------------------
   A layer of particles counts as a smeared one, with the kernel that is sharper where its lattice is finer than the fluid's.
------------------------------------------------------------------------- */

Sight::Sight(LAMMPS *lmp, const Scene &scene, const std::vector<double> &types) :
    Pointers(lmp), scene(scene), types(types), reach(0.0), from{}, low{}, per_cell(0.0), n{}, half_space(types.size())
{
  for (size_t t = 1; t < types.size(); t++) {
    if (types[t] == 0.0) continue;
    const double dx = scene.dx_of(t), sharper = scene.sharper_of(t);
    with_kernel(scene.kernel, scene.dim, scene.h, [&](const auto &kernel) {
      constexpr int D = std::decay_t<decltype(kernel)>::DIM, STEPS = 200;
      const double step = kernel.cut / STEPS;
      for (int k = 0; k <= NTABLE; k++) {
        Fill sum = {0.0, 0.0};
        for (double a = k * kernel.cut / NTABLE; a < kernel.cut; a += dx)
          for (int m = 0; m < STEPS; m++) {
            const double s = (m + 0.5) * step, r = std::sqrt(a * a + s * s);
            if (r >= kernel.cut) continue;
            sum.force -= (D == 3 ? s : 1.0) * a * kernel.sharper_gradient(r, sharper);
            sum.weight += (D == 3 ? s : 1.0) * kernel.sharper(r, sharper);
          }
        half_space[t].push_back(sum);
      }
    });
  }
}

Sight::Fill Sight::beyond(int type, double distance) const
{
  const double at = std::max(distance, 0.0) / scene.cut * NTABLE;
  const int k = static_cast<int>(at);
  if (k >= NTABLE) return {0.0, 0.0};
  const Fill &a = half_space[type][k], &b = half_space[type][k + 1];
  return {a.force + (at - k) * (b.force - a.force), a.weight + (at - k) * (b.weight - a.weight)};
}

/* ----------------------------------------------------------------------
   local particles and ghosts into cells as wide as the reach
------------------------------------------------------------------------- */

void Sight::find_bodies()
{
  const int *const type = atom->type, nall = atom->nlocal + atom->nghost;
  const Scene::Row *const x = Scene::rows(atom->x);
  reach = scene.cut + neighbor->skin;
  per_cell = 1.0 / reach;
  double high[3] = {};
  int count = 0;
  for (int i = 0; i < nall; i++) {
    if (types[type[i]] == 0.0) continue;
    for (int d = 0; d < 3; d++) {
      low[d] = count ? std::min(low[d], x[i][d]) : x[i][d];
      high[d] = count ? std::max(high[d], x[i][d]) : x[i][d];
    }
    count++;
  }
  for (int d = 0; d < 3; d++) n[d] = count ? static_cast<int>((high[d] - low[d]) * per_cell) + 1 : 0;
  first.assign((size_t) n[0] * n[1] * n[2] + 2, 0);
  places.resize(count);
  const auto cell = [&](const double *p) {
    size_t c = 0;
    for (int d = 0; d < 3; d++) c = c * n[d] + static_cast<int>((p[d] - low[d]) * per_cell);
    return c;
  };
  for (int i = 0; i < nall; i++)
    if (types[type[i]] != 0.0) first[cell(x[i]) + 2]++;
  for (size_t c = 2; c < first.size(); c++) first[c] += first[c - 1];
  for (int i = 0; i < nall; i++)
    if (types[type[i]] != 0.0) places[first[cell(x[i]) + 1]++] = {{x[i][0], x[i][1], x[i][2]}, i};
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
  bool any = false;
  for_near(x, [&](const Place &) { return any = true; });
  return any;
}

void Sight::look_from(const double *x)
{
  seen.clear();
  std::copy_n(x, 3, from);
  for_near(x, [&](const Place &p) {
    Seen s = {};
    for (int d = 0; d < scene.dim; d++) {
      s.x[d] = p.x[d] - x[d];
      s.rsq += s.x[d] * s.x[d];
    }
    s.i = p.i;
    s.dx = scene.dx_of(atom->type[p.i]);
    if (s.rsq < reach * reach) seen.push_back(s);
    return false;
  });
}

/* ----------------------------------------------------------------------
   Seen along the line from x to y, the body's particles between both surround it: so what passes beside a face, an edge or a corner is
   free. Only those within reach of both count, which each rank that has one of the pair has. Ties of lattices are not left to round-off.
------------------------------------------------------------------------- */

bool Sight::blocked(const double *y) const
{
  constexpr double NEAR = 0.75, AROUND = 1.25, HIT = 1.0e-4, PI_AND_MORE = PI + 1.0e-6;
  double d[3] = {}, dsq = 0.0, nearest = AROUND * AROUND;
  for (int k = 0; k < scene.dim; k++) {
    d[k] = y[k] - from[k];
    dsq += d[k] * d[k];
  }
  around.clear();
  for (const auto &s : seen) {
    const double along = s.x[0] * d[0] + s.x[1] * d[1] + s.x[2] * d[2];
    if (along <= 0.0 || along >= dsq) continue;
    const double t = along / dsq, offsq = (s.rsq - t * along) / (s.dx * s.dx);
    if (offsq > AROUND * AROUND || s.rsq - 2.0 * along + dsq > reach * reach) continue;
    nearest = std::min(nearest, offsq);
    around.push_back({{s.x[0] - t * d[0], s.x[1] - t * d[1], s.x[2] - t * d[2]}, offsq, s.dx, s.i});
  }
  if (nearest > NEAR * NEAR) return false;
  if (nearest < HIT * HIT) return true;

  // the largest gap between the directions in which they are
  const double *const a = around[0].x, b[3] = {d[1] * a[2] - d[2] * a[1], d[2] * a[0] - d[0] * a[2], d[0] * a[1] - d[1] * a[0]};
  const double per_length = 1.0 / std::sqrt(dsq);
  angles.clear();
  for (const auto &o : around)
    angles.push_back(std::atan2((o.x[0] * b[0] + o.x[1] * b[1] + o.x[2] * b[2]) * per_length, o.x[0] * a[0] + o.x[1] * a[1] + o.x[2] * a[2]));
  std::sort(angles.begin(), angles.end());
  double gap = angles.front() - angles.back() + 2.0 * PI;
  for (size_t k = 1; k < angles.size(); k++) gap = std::max(gap, angles[k] - angles[k - 1]);
  return gap < PI_AND_MORE;
}

/* ----------------------------------------------------------------------
   images in mirror walls of the solids seen, which fluids meet in place of what is behind
------------------------------------------------------------------------- */

void Sight::forget_behind_walls()
{
  if (!scene.walls.near(from, scene.cut)) return;
  const auto behind = [&](const Seen &s) {
    const double y[3] = {from[0] + s.x[0], from[1] + s.x[1], from[2] + s.x[2]};
    return scene.state[atom->type[s.i]].species == SOLID &&
        std::any_of(scene.walls.wall.begin(), scene.walls.wall.end(), [&](const Wall &w) { return !w.finite && w.distance(y) < 0.0; });
  };
  seen.erase(std::remove_if(seen.begin(), seen.end(), behind), seen.end());
}

void Sight::see_images()
{
  const int mask = scene.walls.near(from, scene.cut);
  if (!mask) return;
  for (size_t k = 0, n = seen.size(); k < n; k++) {
    const Seen s = seen[k];
    if (scene.state[atom->type[s.i]].species != SOLID) continue;
    const double y[3] = {from[0] + s.x[0], from[1] + s.x[1], from[2] + s.x[2]};
    scene.walls.images(mask & scene.walls.near(y, scene.cut), s.rsq, from, y, scene.cut * scene.cut,
                       [&](const Walls::Reflection &, double rsq, const double *d) { seen.push_back({{-d[0], -d[1], -d[2]}, rsq, s.dx, s.i}); });
  }
}

/* ----------------------------------------------------------------------
   the body is as thick as it is along its normal through x
------------------------------------------------------------------------- */

static double dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

bool Sight::opposite(const double *a, const double *b)
{
  return dot(a, b) < -0.5;
}

bool Sight::beside(int i, Beside &b)
{
  b = Beside();
  forget_behind_walls();
  const auto first = std::min_element(seen.begin(), seen.end(), [](const Seen &a, const Seen &b) { return a.rsq < b.rsq; });
  if (first == seen.end()) return false;
  const Seen nearest = *first;
  const double within = nearest.rsq < scene.cut * scene.cut ? scene.cut : reach, withinsq = within * within;
  see_images();
  // normal, from what is on the side of the nearest
  double normal[3] = {};
  for (const auto &s : seen)
    if (s.rsq < withinsq && dot(s.x, nearest.x) > 0.0) {
      const double rest = 1.0 - s.rsq / withinsq;
      for (int d = 0; d < 3; d++) normal[d] += rest * rest * rest * s.x[d];
    }
  const double length = std::sqrt(dot(normal, normal)), dx = nearest.dx, tube = 0.75 * dx;
  for (double &e : normal) e /= length;
  double face = reach, back = 0.0;
  for (const auto &s : seen) {
    const double depth = dot(s.x, normal);
    if (depth <= 0.0 || s.rsq - depth * depth > tube * tube) continue;
    face = std::min(face, depth);
    back = std::max(back, depth);
  }
  b = {i, nearest.i, atom->type[nearest.i], {normal[0], normal[1], normal[2]}, face - dot(nearest.x, normal), (back - face) / dx + 1.0, 1.0};
  if (back == 0.0 || within == reach) return false;
  b.behind = hidden_behind(normal, back + 0.5 * dx);
  return true;
}

/* ----------------------------------------------------------------------
   Of what a lattice of the fluid deeper than that would push, the part that the body hides: less than all beside an edge
------------------------------------------------------------------------- */

double Sight::hidden_behind(const double *normal, double depth) const
{
  const int n = static_cast<int>(scene.cut / scene.dx), nz = scene.dim == 3 ? n : 0;
  double hidden = 0.0, all = 0.0;
  for (int a = -n; a <= n; a++)
    for (int b = -n; b <= n; b++)
      for (int c = -nz; c <= nz; c++) {
        const double d[3] = {a * scene.dx, b * scene.dx, c * scene.dx}, at = dot(d, normal), rest = 1.0 - dot(d, d) / (scene.cut * scene.cut);
        if (at < depth || rest <= 0.0) continue;
        const double y[3] = {from[0] + d[0], from[1] + d[1], from[2] + d[2]}, weight = rest * rest * rest * at;
        all += weight;
        if (blocked(y)) hidden += weight;
      }
  return all > 0.0 ? hidden / all : 1.0;
}

double Sight::distance(const Beside &b) const
{
  const double *const xi = atom->x[b.i], *const xj = atom->x[b.j];
  double face = b.face;
  for (int d = 0; d < 3; d++) face += (xj[d] - xi[d]) * b.normal[d];
  return face;
}

Sight::Fill Sight::fill(const Beside &b) const
{
  const double face = distance(b);
  const Fill all = beyond(b.type, face), missing = beyond(b.type, face + b.layers * scene.dx_of(b.type));
  const auto over = [&](double whole, double rest) { return whole > rest ? 1.0 + b.behind * rest / (whole - rest) : 1.0; };
  return {over(all.force, missing.force), over(all.weight, missing.weight)};
}

/* ---------------------------------------------------------------------- */

double Sight::memory_usage() const
{
  return (double) places.capacity() * sizeof(Place) + (double) seen.capacity() * sizeof(Seen) + (double) first.capacity() * sizeof(int);
}
