/* -*- c++ -*- ----------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   Copyright (2003) Sandia Corporation.  Under the terms of Contract
   DE-AC04-94AL85000 with Sandia Corporation, the U.S. Government retains
   certain rights in this software.  This software is distributed under
   the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifndef LMP_FSI_CELLS_H
#define LMP_FSI_CELLS_H

#include "atom.h"
#include "domain.h"
#include "fsi_gather.h"
#include "lammps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <memory>
#include <vector>

namespace LAMMPS_NS::FSI {

inline bool every(int)    // particle
{
  return true;
}

// Local and ghost particles that are chosen, in cells, for questions about the nearest one.
class Cells {
 public:
  static constexpr double LARGE = 1.0e300;

  template <class Choose>
  Cells(const double *const *x, int n, int dim, double size, Choose choose) :
      x(x), dim(dim), size(size)
  {
    for (int d = 0; d < dim; d++) {
      low[d] = LARGE;
      double high = -LARGE;
      for (int i = 0; i < n; i++) {
        if (!choose(i)) continue;
        low[d] = std::min(low[d], x[i][d]);
        high = std::max(high, x[i][d]);
      }
      extent[d] = std::max(high - low[d], 0.0);
    }
    // a few particles far away must not cost a grid of empty cells
    double cells = 1.0;
    for (int d = 0; d < dim; d++) cells *= extent[d] / size + 1.0;
    if (!(cells < LARGE)) {    // a particle at infinity: one cell
      std::fill(extent, extent + 3, 0.0);
      this->size = LARGE;
    } else if (cells > 8.0 * n + 1000.0)
      this->size *= std::pow(cells / (8.0 * n + 1000.0), 1.0 / dim);
    int total = 1;
    for (int d = 0; d < dim; d++) total *= count[d] = static_cast<int>(extent[d] / this->size) + 1;
    first.assign(total + 1, 0);
    std::vector<int> cell(n, -1);
    for (int i = 0; i < n; i++) {
      if (!choose(i)) continue;
      int c = 0;
      for (int d = dim - 1; d >= 0; d--) c = c * count[d] + place(d, x[i][d]);
      cell[i] = c;
      first[c]++;
    }
    // until all are there, where the last one of a cell has gone
    for (int c = 0; c < total; c++) first[c + 1] += first[c];
    members.resize(first[total]);
    for (int i = 0; i < n; i++)
      if (cell[i] >= 0) members[--first[cell[i]]] = i;
  }

  // of local and ghost atoms
  template <class Choose>
  Cells(const Atom *atom, int dim, double size, Choose choose) :
      Cells(atom->x, atom->nlocal + atom->nghost, dim, size, choose)
  {
  }

  // calls f(j, squared distance) for all particles within the cell size of a place, or the reach
  // given, and others: cells a third as wide hold few that are too far
  template <typename F> void around(const double *p, F f) const { around(p, size, f); }
  template <typename F> void around(const double *p, double reach, F f) const
  {
    dim == 2 ? around_in<2>(p, reach, f) : around_in<3>(p, reach, f);
  }
  // is one nearer than that for which is(j)?
  template <typename Is = bool (*)(int)>
  bool any_within(const double *p, double reach, Is is = every) const
  {
    bool any = false;
    around(p, reach, [&](int j, double rsq) {
      any = any || (rsq < reach * reach && is(j));
    });
    return any;
  }

 private:
  template <int D, typename F> void around_in(const double *p, double reach, F &f) const
  {
    int from[3] = {0, 0, 0}, to[3] = {0, 0, 0}, c[3];
    for (int d = 0; d < D; d++) {
      from[d] = place(d, p[d] - reach);
      to[d] = place(d, p[d] + reach);
    }
    const double farthest = 1.000001 * reach * reach;    // more than round-off
    for (c[2] = from[2]; c[2] <= to[2]; c[2]++) {
      const double rsq2 = D == 3 ? distance_sq(2, c[2], p[D - 1]) : 0.0;
      for (c[1] = from[1]; c[1] <= to[1]; c[1]++) {
        if (rsq2 + distance_sq(1, c[1], p[1]) > farthest) continue;
        // cells along x are next to each other
        const int row = (D == 3 ? c[2] * count[1] + c[1] : c[1]) * count[0];
        const int end = first[row + to[0] + 1];
        for (int m = first[row + from[0]]; m < end; m++) {
          const int j = members[m];
          const double *const xj = x[j];
          double rsq = 0.0;
          for (int d = 0; d < D; d++) rsq += (xj[d] - p[d]) * (xj[d] - p[d]);
          f(j, rsq);
        }
      }
    }
  }

  // from a place to the nearest point of cell c, along d; those at the ends have what is beyond
  double distance_sq(int d, int c, double r) const
  {
    const double before = low[d] + c * size - r, behind = -before - size;
    const double away = c > 0 && before > 0.0 ? before
        : c < count[d] - 1 && behind > 0.0    ? behind
                                              : 0.0;
    return away * away;
  }

  const double *const *x;
  int dim, count[3];
  double size, low[3], extent[3];
  std::vector<int> first, members;    // cell by cell; where each begins, and the last one ends

  // clamped, which also takes what is not a number
  int place(int d, double r) const
  {
    const double k = (r - low[d]) / size;
    return k > 0.0 ? (k < count[d] - 1 ? static_cast<int>(k) : count[d] - 1) : 0;
  }
};

typedef std::array<double, 3> Position;

// Places of all ranks, and their images across periods, within a reach of the particles of this
// one, for questions about the nearest one: ghosts may not go as far.
class Everywhere {
 public:
  // local: inside of the box, of this rank
  Everywhere(LAMMPS *lmp, double reach, std::vector<Position> local) :
      total(count_of(local.size(), lmp->world))
  {
    const Domain *const domain = lmp->domain;
    for (int d = 0; d < domain->dimension; d++) {
      if (!domain->periodicity[d]) continue;
      for (size_t k = 0, n = local.size(); k < n; k++)
        for (const int side : {-1, 1}) {
          Position image = local[k];
          image[d] += side * domain->prd[d];
          if (image[d] > domain->boxlo[d] - reach && image[d] < domain->boxhi[d] + reach)
            local.push_back(image);
        }
    }
    pass(lmp, reach, local);
    for (const Position &place : places) x.push_back(place.data());
    cells = std::make_unique<Cells>(x.data(), (int) x.size(), domain->dimension, reach, every);
  }
  bool empty() const { return total == 0; }    // on all ranks
  // squared distance of one from here; large where none is in reach
  double nearest(const double *to) const
  {
    double least = Cells::LARGE;
    cells->around(to, [&](int, double rsq) {
      least = std::min(least, rsq);
    });
    return least;
  }

 private:
  // to each rank what is within reach of its particles
  void pass(LAMMPS *lmp, double reach, const std::vector<Position> &local)
  {
    struct Box {
      double lo[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, hi[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    } box;
    for (int i = 0; i < lmp->atom->nlocal; i++)
      for (int d = 0; d < 3; d++) {
        box.lo[d] = std::min(box.lo[d], lmp->atom->x[i][d] - reach);
        box.hi[d] = std::max(box.hi[d], lmp->atom->x[i][d] + reach);
      }
    std::vector<Position> out;
    std::vector<int> to, from, first_to(1, 0), first_from(1, 0);    // numbers
    for (const Box &b : gather(std::vector<Box>{box}, lmp->world)) {
      std::copy_if(local.begin(), local.end(), std::back_inserter(out), [&](const Position &p) {
        for (int d = 0; d < 3; d++)
          if (p[d] < b.lo[d] || p[d] > b.hi[d]) return false;
        return true;
      });
      to.push_back(3 * (int) out.size() - first_to.back());
      first_to.push_back(3 * (int) out.size());
    }
    from.resize(to.size());
    MPI_Alltoall(to.data(), 1, MPI_INT, from.data(), 1, MPI_INT, lmp->world);
    for (const int count : from) first_from.push_back(first_from.back() + count);
    places.resize(first_from.back() / 3);
    MPI_Alltoallv(out.data(), to.data(), first_to.data(), MPI_DOUBLE, places.data(), from.data(),
                  first_from.data(), MPI_DOUBLE, lmp->world);
  }

  bigint total;
  std::vector<Position> places;
  std::vector<const double *> x;
  std::unique_ptr<Cells> cells;
};

// of the particles that is(i) holds for
template <class Is> Everywhere everywhere(LAMMPS *lmp, double reach, Is is)
{
  const Atom *const atom = lmp->atom;
  std::vector<Position> local;
  for (int i = 0; i < atom->nlocal; i++)
    if (is(i)) local.push_back({atom->x[i][0], atom->x[i][1], atom->x[i][2]});
  return Everywhere(lmp, reach, local);
}

}    // namespace LAMMPS_NS::FSI

#endif
