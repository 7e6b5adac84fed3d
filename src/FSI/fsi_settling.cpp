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
#include "fsi_hub.h"
#include "fsi_kernel.h"
#include "fsi_rows.h"
#include "math_extra.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace FSI;

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
    const int species = disc.state[atom->type[j]].species;
    return (species == SOLID || species == RIGID) && events.nearest(atom->x[j]) < beyond * beyond;
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
  const Cells cells(atom->x, nall, disc.dim, 0.25 * disc.cut, [&](int j) {
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
    const double rho = s.species == RIGID || s.species == SOLID ? s.rho0 : atom->rho[j];
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
      have_packs() ? sum_up<Pack>(of_types) : sum_up<double>(of_types);
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

template <class T, class K> void Settling::sum_up(const std::vector<K> &of_types)
{
  const Walls &walls = step.walls;
  const std::vector<Walls::Reflection> &reflections = walls.reflections;
  const double *const *const x = atom->x;
  const int *const type = atom->type;
  const bool segments = walls.finite();
  sums.assign(rows.size(), {});
  at_walls.clear();
  run_loop<T>([&](const auto &number) FSI_INLINE_LAMBDA {
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

// they hide some of what is behind them
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
      walls.images(near & walls.near(x[j], disc.cut), MathExtra::distsq3(x[i], x[j]), x[i], x[j],
                   kernel.cutsq, [&](const Walls::Reflection &s, double rsq, const double *away) {
                     if (!walls.finite(s)) return;
                     const double distance = std::sqrt(rsq), volume = points[POINT * j + 3],
                                  g = volume * kernel.gradient(distance);
                     for (int a = 0; a < K::DIM; a++) sum_i[a] += g * away[a];
                     sum_i[K::DIM] += volume * kernel.W(distance);
                   });
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
