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

#include <algorithm>
#include <cmath>
#include <vector>

namespace LAMMPS_NS {
namespace FSI {

  // Local and ghost particles, or those chosen of them, in cells, for questions about the nearest
  // one.
  class Cells {
   public:
    static constexpr double LARGE = 1.0e300;

    Cells(const double *const *x, int n, int dim, double size) :
        Cells(x, n, dim, size, [](int) {
          return true;
        })
    {
    }
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
      for (int d = 0; d < dim; d++)
        total *= count[d] = static_cast<int>(extent[d] / this->size) + 1;
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

    // calls f(j, squared distance) for all particles within the cell size of a place, or the reach
    // given: cells half as wide hold fewer that are too far
    template <typename F> void around(const double *p, F f) const { around(p, size, f); }
    template <typename F> void around(const double *p, double reach, F f) const
    {
      int from[3] = {0, 0, 0}, to[3] = {0, 0, 0}, c[3];
      for (int d = 0; d < dim; d++) {
        from[d] = place(d, p[d] - reach);
        to[d] = place(d, p[d] + reach);
      }
      for (c[2] = from[2]; c[2] <= to[2]; c[2]++)
        for (c[1] = from[1]; c[1] <= to[1]; c[1]++) {
          // cells along x are next to each other
          const int row = (dim == 3 ? c[2] * count[1] + c[1] : c[1]) * count[0];
          for (int m = first[row + from[0]]; m < first[row + to[0] + 1]; m++) {
            const int j = members[m];
            double rsq = 0.0;
            for (int d = 0; d < dim; d++) rsq += (x[j][d] - p[d]) * (x[j][d] - p[d]);
            f(j, rsq);
          }
        }
    }

   private:
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

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
