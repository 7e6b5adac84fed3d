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

// Gradients at a particle from its neighbors: grad u_i = sum_j (u_j - u_i) (x) G_ij, the weights
// G_ij from moving least squares about i.
//
// Exact for linear fields (Bonet and Lok 1999 give the same property), or for quadratic ones:
// linear ones make a bent plate soft, since at a free face they give the gradient of a place
// inside. One quadratic term a face is better without: the square of the distance along its normal,
// whose weights make the stiffest mode of the body (doc/notes/solids.md).

#ifndef LMP_FSI_GRADIENT_H
#define LMP_FSI_GRADIENT_H

#include "fsi_pack.h"
#include "math_eigen.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

namespace LAMMPS_NS::FSI {

template <int D> struct Gradient {
  static constexpr int NLINEAR = D, NQUADRATIC = D * (D + 3) / 2;
  enum Order { DEFICIENT, LINEAR, PARTIAL, QUADRATIC };
};
constexpr int packed_size(int n)
{
  return n * (n + 1) / 2;
}

// basis about a particle, x = offset times 1/length: x, y, (z), then, for quadratic exactness,
// their products
template <int D, int TERMS, class T> FSI_INLINE void gradient_basis(const T *x, T *phi)
{
  int k = 0;
  for (; k < D; k++) phi[k] = x[k];
  if constexpr (TERMS > D)
    for (int a = 0; a < D; a++)
      for (int b = a; b < D; b++) phi[k++] = x[a] * x[b];
}

// The first D rows C (D x TERMS) of the inverse of A = sum_j w_j phi_j phi_j^T (packed lower
// triangle, by rows): G_ij = w_ij C phi_j/length. Terms that the neighbors cannot tell from lower
// ones are left out (PARTIAL; LINEAR if all quadratic ones are, as in a body two particles
// thick); DEFICIENT, with C not set, where neighbors lie in a line (2D) or plane (3D) or are too
// few.
//
// quadratic_tolerance: part of a quadratic term's own square that must be independent of earlier
// terms. Nearly dependent terms give large weights of both signs, which amplify particle noise
// and cost time step: a body two particles thick whose particles are 0.01 dx off their lattice
// would have 1/40 of the usual one. In the axes of the lattice terms have 0.05 or more (Wendland,
// h = 1.3 to 2 dx; 0.03 for quintic, h = 0.9 dx), 0.02 or less in such a body up to 0.1 dx.
// least: the smallest such part among the quadratic terms kept, 0 if there are none.
constexpr double MIN_INDEPENDENCE = 0.025;
constexpr double FLAT = 1.0e-4;    // so much of the largest square, for linear terms
template <int D, int TERMS> struct MomentFactors {    // A = L d L^T
  double L[TERMS][TERMS] = {}, d[TERMS], part = 1.0;
  int dropped = 0;

  // false: neighbors lie in a line or plane
  bool factorize(const double *A, double quadratic_tolerance)
  {
    const auto at = [](int a, int b) {
      return packed_size(a) + b;
    };
    double widest = 0.0;
    for (int a = 0; a < D; a++) widest = std::max(widest, A[at(a, a)]);
    for (int a = 0; a < TERMS; a++) {
      for (int b = 0; b < a; b++) {
        if (d[b] == 0.0) continue;
        double s = A[at(a, b)];
        for (int k = 0; k < b; k++) s -= L[a][k] * d[k] * L[b][k];
        L[a][b] = s / d[b];
      }
      d[a] = A[at(a, a)];
      for (int k = 0; k < a; k++) d[a] -= L[a][k] * L[a][k] * d[k];
      if (!(d[a] > (a < D ? FLAT * widest : quadratic_tolerance * A[at(a, a)]))) {
        if (a < D) return false;
        d[a] = 0.0;
        for (int k = 0; k < a; k++) L[a][k] = 0.0;
        dropped++;
      } else if (a >= D)
        part = std::min(part, d[a] / A[at(a, a)]);
    }
    return true;
  }

  void find_row(int a, double *c) const    // of the inverse
  {
    for (int k = 0; k < TERMS; k++) {
      c[k] = (k == a) ? 1.0 : 0.0;
      for (int b = a; b < k; b++) c[k] -= L[k][b] * c[b];
    }
    for (int k = 0; k < TERMS; k++) c[k] = d[k] > 0.0 ? c[k] / d[k] : 0.0;
    for (int k = TERMS - 1; k >= 0; k--)
      for (int b = k + 1; b < TERMS; b++) c[k] -= L[b][k] * c[b];
  }
};

template <int D, int TERMS>
inline typename Gradient<D>::Order
gradient_coefficients(const double *A, double *C, double quadratic_tolerance = MIN_INDEPENDENCE,
                      double *least = nullptr)
{
  MomentFactors<D, TERMS> f;
  if (!f.factorize(A, quadratic_tolerance)) return Gradient<D>::DEFICIENT;
  if (least) *least = f.dropped < TERMS - D ? f.part : 0.0;
  for (int a = 0; a < D; a++) f.find_row(a, C + a * TERMS);
  if (f.dropped == TERMS - D) return Gradient<D>::LINEAR;
  return f.dropped ? Gradient<D>::PARTIAL : Gradient<D>::QUADRATIC;
}

// principal values, decreasing, and axes (rows) of packed moments sum_j w_j x_j x_j^T
template <int D> inline void principal(const double *moments, double *value, double (*axes)[D])
{
  double M[3][3] = {}, columns[3][3];
  for (int a = 0; a < D; a++)
    for (int b = 0; b <= a; b++) M[a][b] = M[b][a] = *moments++;
  MathEigen::jacobi3(M, value, columns);    // in 2D the third is across the plane
  for (int k = 0; k < D; k++)
    for (int a = 0; a < D; a++) axes[k][a] = columns[a][k];
}

// Inverse C of such moments for the slopes of a linear fit. Directions along which neighbors
// hardly lie apart fade: there a slope is that of noise. Half of a disc about its own center has
// 0.28 of its largest eigenvalue, half of a ball 0.30. wide: what an eigenvalue of neighbors that
// lie apart has at least; moments about the center of a single one are all round-off.
template <int D> inline void faded_inverse(const double *moments, double *C, double wide = 0.0)
{
  constexpr double NONE = 0.02, ALL = 0.1;    // of the largest eigenvalue
  double value[3], axes[D][D];
  principal<D>(moments, value, axes);
  std::fill_n(C, D * D, 0.0);
  wide = std::max(wide, value[0]);
  for (int k = 0; k < D; k++) {
    if (!(value[k] > NONE * wide)) break;
    const double t = std::min(1.0, (value[k] / wide - NONE) / (ALL - NONE));
    for (int a = 0; a < D; a++)
      for (int b = 0; b < D; b++)
        C[a * D + b] += t * t * (3.0 - 2.0 * t) / value[k] * axes[k][a] * axes[k][b];
  }
}

// the weights of one particle, from all its neighbors at once
template <int D> class GradientWeights : public Gradient<D> {
 public:
  using Order = typename Gradient<D>::Order;

  // G (n x D, 1/length) for n neighbors at X_j - X_i = dX (n x D) with weights w > 0; scale =
  // length of the order of |dX|; quadratic = false asks for linear exactness only. Returns what
  // was reached.
  Order operator()(int n, const double *dX, const double *w, double scale, bool quadratic,
                   double *G) const
  {
    return quadratic ? solve<Gradient<D>::NQUADRATIC>(n, dX, w, 1.0 / scale, G)
                     : solve<Gradient<D>::NLINEAR>(n, dX, w, 1.0 / scale, G);
  }

 private:
  // offsets over the scale along each axis, weights, what is found: one after the other, filled
  // up to whole packs with neighbors that weigh nothing
  mutable std::vector<double> columns, distances;    // of lattice_axes()

  // squares along the normal of a face keep 0.05 to 0.15 of themselves (cubic to quintic kernel,
  // h = 1 to 2 dx), all others 0.38 or more, in the axes chosen
  static constexpr double ONE_SIDED = 0.3;
  // What is equal to within TIE, as on a lattice, the box's axes choose between by a preference,
  // and not round-off. In disorder they have no part: a body's weights turn with it.
  static constexpr double TIE = 1.0e-6, PREFERENCE = 1.0e-4;

  template <int TERMS> struct Fit {
    double axes[D][D], C[D * TERMS], least;
    Order order;
  };

  // Of two sets of axes (rows), both the neighborhood's own whichever way the body lies, that is
  // taken in which the terms kept are best told from each other. The principal ones of sum_j w_j
  // x_j x_j have the normal of a plane face, that of a lattice cut aslant, too. At an edge they
  // are diagonal; there a lattice's own are normal to both faces, and other terms would lock a
  // bar two by two across. False if the neighbors lie in a line (2D) or plane (3D).
  static bool principal_axes(int n, const double *dX, const double *w, double (*axes)[D])
  {
    double moments[packed_size(D)] = {}, value[3];
    for (int j = 0; j < n; j++)
      for (int a = 0, m = 0; a < D; a++)
        for (int b = 0; b <= a; b++) moments[m++] += w[j] * dX[j * D + b] * dX[j * D + a];
    principal<D>(moments, value, axes);
    bool tie = false;
    for (int k = 1; k < D; k++) tie = tie || value[k - 1] - value[k] < TIE * value[0];
    if (tie) {
      for (int a = 0; a < D; a++) moments[packed_size(a) + a] *= 1.0 - PREFERENCE * a;
      principal<D>(moments, value, axes);
    }
    return value[D - 1] > FLAT * value[0];
  }

  // Those of a lattice: directions of the nearest neighbors, made orthogonal. False if there are
  // not D of them, 45 degrees apart.
  bool lattice_axes(int n, const double *dX, double (*axes)[D]) const
  {
    distances.resize(n);
    for (int j = 0; j < n; j++) {
      double distance = 0.0;
      for (int a = 0; a < D; a++) distance += (1.0 + TIE * a) * dX[j * D + a] * dX[j * D + a];
      distances[j] = distance;
    }
    for (int k = 0; k < D; k++) {
      double nearest = std::numeric_limits<double>::max();
      for (int j = 0; j < n; j++) {
        const double distance = distances[j];
        if (distance >= nearest) continue;
        double e[D], rsq = 0.0, across = 0.0;
        for (int a = 0; a < D; a++) {
          e[a] = dX[j * D + a];
          rsq += e[a] * e[a];
        }
        for (int m = 0; m < k; m++) {
          double along = 0.0;
          for (int a = 0; a < D; a++) along += e[a] * axes[m][a];
          for (int a = 0; a < D; a++) e[a] -= along * axes[m][a];
        }
        for (int a = 0; a < D; a++) across += e[a] * e[a];
        if (!(across > 0.5 * rsq)) continue;
        nearest = distance;
        for (int a = 0; a < D; a++) axes[k][a] = e[a] / std::sqrt(across);
      }
      if (nearest == std::numeric_limits<double>::max()) return false;
    }
    return true;
  }

  // but for round-off, order and sign: where both are a lattice's, as in most of a body
  static bool same(const double (*first)[D], const double (*second)[D])
  {
    int found = 0;
    for (int k = 0; k < D; k++)
      for (int m = 0; m < D; m++) {
        double along = 0.0;
        for (int a = 0; a < D; a++) along += first[k][a] * second[m][a];
        found += 1.0 - std::fabs(along) < 1.0e-14;
      }
    return found == D;
  }

  // by how one-sided the neighbors are along them, so that squares along normals come last
  static void sort_axes(int n, const double *dX, const double *w, double (*axes)[D])
  {
    double first[D] = {}, one_sided[D], length = 0.0, unsorted[D][D];
    int order[D];
    for (int j = 0; j < n; j++)
      for (int a = 0; a < D; a++) {
        first[a] += w[j] * dX[j * D + a];
        length += w[j] * std::fabs(dX[j * D + a]);
      }
    for (int k = 0; k < D; k++) {
      order[k] = k;
      one_sided[k] = 0.0;
      for (int a = 0; a < D; a++) {
        one_sided[k] += first[a] * axes[k][a];
        unsorted[k][a] = axes[k][a];
      }
      one_sided[k] = std::max(std::fabs(one_sided[k]), 1.0e-3 * length);
    }
    std::stable_sort(order, order + D, [&](int a, int b) {
      return one_sided[a] < one_sided[b];
    });
    for (int k = 0; k < D; k++) std::copy_n(unsorted[order[k]], D, axes[k]);
  }

  // basis in the axes of a fit at what column points to
  template <int TERMS, class T>
  FSI_INLINE static void terms_of(const Fit<TERMS> &fit, const double *column, int size, T *phi)
  {
    T x[D];
    for (int k = 0; k < D; k++) {
      x[k] = T(fit.axes[k][0]) * Lanes<T>::load(column);
      for (int a = 1; a < D; a++) x[k] += T(fit.axes[k][a]) * Lanes<T>::load(column + a * size);
    }
    gradient_basis<D, TERMS>(x, phi);
  }

  template <int TERMS>
  void solve_in_axes(int n, const double *dX, const double *w, Fit<TERMS> &fit) const
  {
    double A[packed_size(TERMS)];
    sort_axes(n, dX, w, fit.axes);
    const int size = columns.size() / (D + 1 + D);
    const double *const column = columns.data();
    run_widest([&](auto number) FSI_INLINE_LAMBDA {
      using T = decltype(number);
      T sum[packed_size(TERMS)], phi[TERMS];
      for (auto &s : sum) s = T(0.0);
      for (int j = 0; j < n; j += Lanes<T>::WIDTH) {
        terms_of<TERMS>(fit, column + j, size, phi);
        const T weight = Lanes<T>::load(column + D * size + j);
        for (int a = 0, m = 0; a < TERMS; a++) {
          const T weighed = weight * phi[a];
          for (int b = 0; b <= a; b++) sum[m++] += weighed * phi[b];
        }
      }
      for (int m = 0; m < packed_size(TERMS); m++) A[m] = Lanes<T>::sum(sum[m]);
    });
    fit.order = gradient_coefficients<D, TERMS>(A, fit.C, ONE_SIDED, &fit.least);
  }

  void fill_columns(int n, const double *dX, const double *w, double inv) const
  {
    const int size = (n + 3) / 4 * 4;
    columns.assign((size_t) size * (D + 1 + D), 0.0);
    for (int j = 0; j < n; j++) {
      for (int a = 0; a < D; a++) columns[a * size + j] = dX[j * D + a] * inv;
      columns[D * size + j] = w[j];
    }
  }

  template <int TERMS>
  Order solve(int n, const double *dX, const double *w, double inv, double *G) const
  {
    Fit<TERMS> fit, other;
    if (!principal_axes(n, dX, w, fit.axes)) return Gradient<D>::DEFICIENT;
    fill_columns(n, dX, w, inv);
    solve_in_axes<TERMS>(n, dX, w, fit);
    if (TERMS > D && lattice_axes(n, dX, other.axes) && !same(fit.axes, other.axes)) {
      solve_in_axes<TERMS>(n, dX, w, other);
      if (other.least > fit.least) fit = other;
    }
    if (fit.order == Gradient<D>::DEFICIENT) return fit.order;
    double C[D][TERMS] = {};    // back in the box's axes
    for (int a = 0; a < D; a++)
      for (int c = 0; c < D; c++)
        for (int k = 0; k < TERMS; k++) C[a][k] += fit.axes[c][a] * fit.C[c * TERMS + k] * inv;
    const int size = columns.size() / (D + 1 + D);
    double *const column = columns.data();
    run_widest([&](auto number) FSI_INLINE_LAMBDA {
      using T = decltype(number);
      T phi[TERMS];
      for (int j = 0; j < n; j += Lanes<T>::WIDTH) {
        terms_of<TERMS>(fit, column + j, size, phi);
        const T weight = Lanes<T>::load(column + D * size + j);
        for (int a = 0; a < D; a++) {
          T s = 0.0;
          for (int k = 0; k < TERMS; k++) s += T(C[a][k]) * phi[k];
          s = s * weight;
          std::memcpy(column + (D + 1 + a) * size + j, &s, sizeof(s));
        }
      }
    });
    for (int j = 0; j < n; j++)
      for (int a = 0; a < D; a++) G[j * D + a] = column[(D + 1 + a) * size + j];
    return fit.order;
  }
};

}    // namespace LAMMPS_NS::FSI

#endif
