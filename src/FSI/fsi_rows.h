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

// Pairs as rows, of a particle and its neighbors, and how loops go over them, as many neighbors at
// a time as the number type T holds (fsi_pack.h).

#ifndef LMP_FSI_ROWS_H
#define LMP_FSI_ROWS_H

#include "fsi_pack.h"
#include "lmptype.h"

#include <algorithm>
#include <cstring>
#include <vector>

namespace LAMMPS_NS::FSI {

// that vectors have room for
template <class... Vector> double bytes_of(const Vector &...v)
{
  return (0.0 + ... + (double) (v.capacity() * sizeof(typename Vector::value_type)));
}

// A particle i (local or ghost) and n neighbors j, each pair of particles in one row. In a row of
// images the last neighbor may be i itself.
struct Row {
  int i, n;
  const int *j;
};

// some rows, one behind the other, of a list that lives longer
struct RowSpan {
  const Row *first, *last;
  RowSpan(const Row *begin, const Row *end) : first(begin), last(end) {}
  RowSpan(const std::vector<Row> &all) : first(all.data()), last(first + all.size()) {}
  int size() const { return last - first; }
  const Row *begin() const { return first; }
  const Row *end() const { return last; }
};

// Rows and, where they are not those of LAMMPS' neighbor list, their neighbors.
class RowList {
 public:
  std::vector<Row> rows;
  void clear()
  {
    rows.clear();
    used = 0;
  }
  // a row of i with the n of the neighbors that choose(j) holds for, and then i itself if
  // with_own; none if it would be empty
  template <class Choose>
  void add(int i, const int *neighbors, int n, bool with_own, bool even_empty, Choose choose)
  {
    if (used + n + 1 > pool.size()) pool.resize(2 * (used + n + 1));
    int *const first = pool.data() + used, *last = first;
    for (int k = 0; k < n; k++) {
      *last = neighbors[k];
      last += choose(neighbors[k]) ? 1 : 0;
    }
    if (with_own) *last++ = i;
    const int found = last - first;
    if (found || even_empty) rows.push_back({i, found, nullptr});
    used += found;
  }
  // no more rows: points them at their neighbors
  void end()
  {
    const int *first = pool.data();
    for (auto &row : rows) {
      if (row.j) continue;    // in LAMMPS' list
      row.j = first;
      first += row.n;
    }
  }
  double memory_usage() const { return bytes_of(rows, pool); }

 private:
  std::vector<int> pool;
  size_t used = 0;
};

// Doubles from the force on a particle to that on the next.
constexpr int row_of_forces(int dim)
{
  return dim == 3 ? 4 : 2;
}

// the same for positions and velocities
constexpr int row_of_points(int dim)
{
  return dim == 3 ? 8 : 4;
}

template <int D, class T> FSI_INLINE T product(const T (&a)[D], const T (&b)[D])
{
  T s = a[0] * b[0];
  for (int d = 1; d < D; d++) s += a[d] * b[d];
  return s;
}
template <int D, class T> FSI_INLINE void difference(const T (&a)[D], const T (&b)[D], T (&c)[D])
{
  for (int d = 0; d < D; d++) c[d] = a[d] - b[d];
}

// Calls pairs(j, weight) with the places of as many neighbors as T holds. The weight is 1, but 0
// for places that are left over and, in rows of images, 1/2 for i itself: it is seen from both
// sides of the pair.
template <class T, bool MIRRORED, class Pairs>
FSI_INLINE void for_neighbors(const Row &row, Pairs pairs)
{
  constexpr int W = Lanes<T>::WIDTH;
  const auto weight = [&](const int *j, int n) FSI_INLINE_LAMBDA {
    const T there = W == 1 ? T(1.0) : Lanes<T>::first(n < W ? n : W);
    return MIRRORED ? there * Lanes<T>::make([&](int k) {
                        return j[k] == row.i ? 0.5 : 1.0;
                      })
                    : there;
  };
  // one place for the text of a pair: written out again for the last ones loops are twice as long
  int last[W];
  const int *j = row.j;
  for (int left = row.n;; left -= W, j += W) {
    if (left < W) {
      if (left <= 0) return;
      for (int k = 0; k < W; k++) last[k] = k < left ? j[k] : row.i;
      j = last;
    }
    pairs(j, weight(j, left));
  }
}

// calls f(j, d, rsq), d = x_j - x_i, for the neighbors of a row, or of LAMMPS' list, within a
// distance; x_i: where its particle is, or its image
template <class F>
void for_near(const Row &row, const double *xi, const double *const *x, int dim, double cutsq, F f)
{
  for (int k = 0; k < row.n; k++) {
    const int j = row.j[k] & NEIGHMASK;
    double d[3], rsq = 0.0;
    for (int a = 0; a < dim; a++) {
      d[a] = x[j][a] - xi[a];
      rsq += d[a] * d[a];
    }
    if (rsq < cutsq) f(j, d, rsq);
  }
}
template <class F> void for_near(const Row &row, const double *const *x, int dim, double cutsq, F f)
{
  for_near(row, x[row.i], x, dim, cutsq, f);
}

// Puts the neighbors of a row that are near in front of the others, in place, while a loop goes
// over them: take() when it is done with these places j. Without KEEP the others are gone. What
// is not a number is not far: it is to be seen.
template <class T, bool KEEP> class Sieve {
  static constexpr int W = Lanes<T>::WIDTH;
  int *last = nullptr, *end_of_far = nullptr, left = 0;
  std::vector<int> far;

 public:
  FSI_INLINE void open(const Row &row)
  {
    last = const_cast<int *>(row.j);
    left = row.n;
    if (KEEP && far.size() < (size_t) row.n + W) far.resize(2 * row.n + W);
    end_of_far = far.data();
  }
  template <class Mask> FSI_INLINE void take(const Mask &is_far, const int *j)
  {
    const int bits = Lanes<T>::bits(is_far), n = left < W ? left : W;
    left -= W;
    if (n == W && bits == 0) {    // as most are in a row that was sorted before
      if (j != last) std::memmove(last, j, W * sizeof(int));
      last += W;
      return;
    }
    if (n == W && bits == (1 << W) - 1) {
      if (KEEP) std::memcpy(end_of_far, j, W * sizeof(int));
      end_of_far += KEEP ? W : 0;
      return;
    }
    if (n == W) return Lanes<T>::split(bits, j, last, KEEP ? &end_of_far : nullptr);
    for (int k = 0; k < n; k++) {
      const int neighbor = j[k], out = bits >> k & 1;
      *last = neighbor;
      last += 1 - out;
      if (!KEEP) continue;
      *end_of_far = neighbor;
      end_of_far += out;
    }
  }
  FSI_INLINE Row close(const Row &row)
  {
    if (KEEP) std::copy(far.data(), end_of_far, last);
    return {row.i, static_cast<int>(last - row.j), row.j};
  }
};

// 1 for a pair that only this rank visits, else 1/2
template <class T> FSI_INLINE T share_of(int i, const int *j, int nlocal, bool newton)
{
  if (newton) return T(1.0);
  return Lanes<T>::make([&](int k) {
    return i < nlocal && j[k] < nlocal ? 1.0 : 0.5;
  });
}

}    // namespace LAMMPS_NS::FSI

#endif
