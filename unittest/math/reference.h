/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.
   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// What several tests compare with: full matrices, written down independently of fsi_tensor.h, and random input.

#ifndef FSI_TEST_REFERENCE_H
#define FSI_TEST_REFERENCE_H

#include "fsi_tensor.h"

#include "gtest/gtest.h"

#include <cmath>
#include <random>
#include <string>
#include <type_traits>

// TYPED_TEST over the two dimensions
using Dimensions = ::testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
struct DimensionName {
  template <class T> static std::string GetName(int)
  {
    return T::value == 2 ? "2D" : "3D";
  }
};

// the same numbers in every run and on every platform
class Random {
  std::mt19937 engine;

 public:
  explicit Random(unsigned seed) : engine(seed) {}
  double operator()(double lo, double hi)
  {
    return lo + (hi - lo) * ((engine() + 0.5) / 4294967296.0);
  }
};

template <int D> struct Matrix {
  double a[D * D] = {};

  double &operator()(int i, int j)
  {
    return a[i * D + j];
  }
  double operator()(int i, int j) const
  {
    return a[i * D + j];
  }
  Matrix transposed() const
  {
    Matrix t;
    for (int i = 0; i < D; i++)
      for (int j = 0; j < D; j++) t(i, j) = a[j * D + i];
    return t;
  }
};

template <int D> Matrix<D> operator*(const Matrix<D> &p, const Matrix<D> &q)
{
  Matrix<D> r;
  for (int i = 0; i < D; i++)
    for (int j = 0; j < D; j++)
      for (int k = 0; k < D; k++) r(i, j) += p(i, k) * q(k, j);
  return r;
}
template <int D> Matrix<D> operator*(double s, Matrix<D> p)
{
  for (double &x : p.a) x *= s;
  return p;
}
template <int D> Matrix<D> operator+(Matrix<D> p, const Matrix<D> &q)
{
  for (int k = 0; k < D * D; k++) p.a[k] += q.a[k];
  return p;
}

template <int D> Matrix<D> diagonal(const double *s)
{
  Matrix<D> m;
  for (int i = 0; i < D; i++) m(i, i) = s[i];
  return m;
}
template <int D> Matrix<D> unit()
{
  const double one[3] = {1.0, 1.0, 1.0};
  return diagonal<D>(one);
}
template <int D> Matrix<D> random_matrix(Random &random, double size)
{
  Matrix<D> m;
  for (double &x : m.a) x = random(-size, size);
  return m;
}
template <int D> Matrix<D> antisymmetric(const Matrix<D> &m)
{
  return 0.5 * (m + -1.0 * m.transposed());
}

// power series; for |m| up to about 4 the terms stay below 1e2, so round-off below 1e-14
template <int D> Matrix<D> exponential(const Matrix<D> &m)
{
  Matrix<D> sum = unit<D>(), term = sum;
  for (int k = 1; k < 50; k++) {
    term = (1.0 / k) * (term * m);
    sum = sum + term;
  }
  return sum;
}

// proper rotation from an angle (2D) or a unit quaternion (3D)
template <int D> Matrix<D> random_rotation(Random &random)
{
  Matrix<D> r;
  if constexpr (D == 2) {
    const double angle = random(-3.1, 3.1);
    r(0, 0) = r(1, 1) = std::cos(angle);
    r(1, 0) = std::sin(angle);
    r(0, 1) = -r(1, 0);
  } else {
    double q[4], norm = 0.0;
    for (double &x : q) {
      x = random(-1.0, 1.0);
      norm += x * x;
    }
    for (double &x : q) x /= std::sqrt(norm);
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    r = {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), 2 * (x * y + z * w),
          1 - 2 * (x * x + z * z), 2 * (y * z - x * w), 2 * (x * z - y * w), 2 * (y * z + x * w),
          1 - 2 * (x * x + y * y)}};
  }
  return r;
}

// to and from the package's symmetric tensors, in LAMMPS' Voigt order
template <int D> Matrix<D> full(const LAMMPS_NS::FSI::Sym<D> &t)
{
  const double *c = t.c;
  if constexpr (D == 2)
    return {{c[0], c[2], c[2], c[1]}};
  else
    return {{c[0], c[3], c[4], c[3], c[1], c[5], c[4], c[5], c[2]}};
}
template <int D> LAMMPS_NS::FSI::Sym<D> voigt(const Matrix<D> &m)
{
  LAMMPS_NS::FSI::Sym<D> t;
  const double in_order[6] = {m(0, 0), m(1, 1), D == 2 ? m(0, 1) : m(D - 1, D - 1), m(0, 1), m(0, D - 1), m(1, D - 1)};
  for (int k = 0; k < t.N; k++) t.c[k] = in_order[k];
  return t;
}

template <int D> double difference(const Matrix<D> &p, const Matrix<D> &q)
{
  double d = 0.0;
  for (int k = 0; k < D * D; k++) {
    if (!std::isfinite(p.a[k] - q.a[k])) return INFINITY;
    d = std::fmax(d, std::fabs(p.a[k] - q.a[k]));
  }
  return d;
}

#endif
