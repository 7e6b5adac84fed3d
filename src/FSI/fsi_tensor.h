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

// Symmetric tensors and rotations in 2D and 3D, the only place where tensor algebra is written
// down.
//
// A symmetric tensor of dimension D keeps its in-plane part in Voigt order {xx, yy, xy} (2D) or
// {xx, yy, zz, xy, xz, yz} (3D). A full D x D matrix is row-major. No LAMMPS types.

#ifndef LMP_FSI_TENSOR_H
#define LMP_FSI_TENSOR_H

#include "fsi_pack.h"

#include <cmath>

namespace LAMMPS_NS::FSI {

// of full matrices
template <int D> FSI_INLINE double determinant(const double *F)
{
  if constexpr (D == 2)
    return F[0] * F[3] - F[1] * F[2];
  else
    return F[0] * (F[4] * F[8] - F[5] * F[7]) - F[1] * (F[3] * F[8] - F[5] * F[6]) +
        F[2] * (F[3] * F[7] - F[4] * F[6]);
}

// det(F) F^-T
template <int D> FSI_INLINE void cofactor(const double *F, double *C)
{
  if constexpr (D == 2) {
    C[0] = F[3];
    C[1] = -F[2];
    C[2] = -F[1];
    C[3] = F[0];
  } else {
    C[0] = F[4] * F[8] - F[5] * F[7];
    C[1] = F[5] * F[6] - F[3] * F[8];
    C[2] = F[3] * F[7] - F[4] * F[6];
    C[3] = F[2] * F[7] - F[1] * F[8];
    C[4] = F[0] * F[8] - F[2] * F[6];
    C[5] = F[1] * F[6] - F[0] * F[7];
    C[6] = F[1] * F[5] - F[2] * F[4];
    C[7] = F[2] * F[3] - F[0] * F[5];
    C[8] = F[0] * F[4] - F[1] * F[3];
  }
}

// T: double, or Pack for those of several particles side by side (fsi_pack.h)
template <int D, class T = double> struct Sym {
  static constexpr int N = (D == 2) ? 3 : 6;
  T c[N];

  FSI_INLINE Sym()
  {
    for (T &s : c) s = 0.0;
  }

  // index of component (a,b) in c
  static constexpr int id(int a, int b)
  {
    if (a == b) return a;
    return (D == 2) ? 2 : a + b + 2;
  }
  FSI_INLINE T &operator()(int a, int b) { return c[id(a, b)]; }
  FSI_INLINE const T &operator()(int a, int b) const { return c[id(a, b)]; }

  FSI_INLINE static Sym identity(double s)
  {
    Sym t;
    for (int a = 0; a < D; a++) t.c[a] = s;
    return t;
  }
  FSI_INLINE static Sym load(const T *p)
  {
    Sym t;
    for (int k = 0; k < N; k++) t.c[k] = p[k];
    return t;
  }
  FSI_INLINE void store(double *p) const
  {
    for (int k = 0; k < N; k++) p[k] = c[k];
  }
  FSI_INLINE Sym &operator+=(const Sym &b)
  {
    for (int k = 0; k < N; k++) c[k] += b.c[k];
    return *this;
  }
  FSI_INLINE Sym &operator*=(const T &s)
  {
    for (int k = 0; k < N; k++) c[k] = s * c[k];
    return *this;
  }
  FSI_INLINE double trace() const
  {
    double t = 0.0;
    for (int a = 0; a < D; a++) t += c[a];
    return t;
  }
  // in-plane double contraction c:c
  FSI_INLINE double squared() const
  {
    double t = 0.0;
    for (int a = 0; a < D; a++) t += c[a] * c[a];
    for (int k = D; k < N; k++) t += 2.0 * c[k] * c[k];
    return t;
  }
};

// out = t . x
template <int D, class T> FSI_INLINE void dot(const Sym<D, T> &t, const T *x, T *out)
{
  if constexpr (D == 2) {
    out[0] = t.c[0] * x[0] + t.c[2] * x[1];
    out[1] = t.c[2] * x[0] + t.c[1] * x[1];
  } else {
    out[0] = t.c[0] * x[0] + t.c[3] * x[1] + t.c[4] * x[2];
    out[1] = t.c[3] * x[0] + t.c[1] * x[1] + t.c[5] * x[2];
    out[2] = t.c[4] * x[0] + t.c[5] * x[1] + t.c[2] * x[2];
  }
}

// symmetric part of the matrix L
template <int D> FSI_INLINE Sym<D> symmetric(const double *L)
{
  Sym<D> e;
  for (int a = 0; a < D; a++)
    for (int b = a; b < D; b++) e(a, b) = 0.5 * (L[a * D + b] + L[b * D + a]);
  return e;
}

// Rotation Q = exp(dt w) for the spin w = antisym(L), L_ab = dv_a/dx_b (Rodrigues' formula;
// exact, so that a rigid spin keeps every invariant of a rotated tensor to round-off whatever the
// step).
template <int D> FSI_INLINE void rotation(const double *L, double dt, double *Q)
{
  if constexpr (D == 2) {
    const double angle = 0.5 * dt * (L[2] - L[1]);    // w_yx
    const double c = std::cos(angle), s = std::sin(angle);
    Q[0] = c;
    Q[1] = -s;
    Q[2] = s;
    Q[3] = c;
  } else {
    const double wx = 0.5 * dt * (L[7] - L[5]), wy = 0.5 * dt * (L[2] - L[6]),
                 wz = 0.5 * dt * (L[3] - L[1]);
    const double t2 = wx * wx + wy * wy + wz * wz, t = std::sqrt(t2);
    // sin(t)/t and (1-cos t)/t^2, with their limits
    const double a = t > 1.0e-4 ? std::sin(t) / t : 1.0 - t2 / 6.0;
    const double sh = t > 1.0e-4 ? std::sin(0.5 * t) / (0.5 * t) : 1.0 - t2 / 24.0;
    const double b = 0.5 * sh * sh;
    Q[0] = 1.0 - b * (wy * wy + wz * wz);
    Q[1] = b * wx * wy - a * wz;
    Q[2] = b * wx * wz + a * wy;
    Q[3] = b * wx * wy + a * wz;
    Q[4] = 1.0 - b * (wx * wx + wz * wz);
    Q[5] = b * wy * wz - a * wx;
    Q[6] = b * wx * wz - a * wy;
    Q[7] = b * wy * wz + a * wx;
    Q[8] = 1.0 - b * (wx * wx + wy * wy);
  }
}

// Q t Q^T
template <int D> FSI_INLINE Sym<D> rotate(const Sym<D> &t, const double *Q)
{
  double qt[D * D];
  for (int a = 0; a < D; a++)
    for (int b = 0; b < D; b++) {
      double s = 0.0;
      for (int k = 0; k < D; k++) s += Q[a * D + k] * t(k, b);
      qt[a * D + b] = s;
    }
  Sym<D> r;
  for (int a = 0; a < D; a++)
    for (int b = a; b < D; b++) {
      double s = 0.0;
      for (int k = 0; k < D; k++) s += qt[a * D + k] * Q[b * D + k];
      r(a, b) = s;
    }
  return r;
}

// adds a tensor, by its components, to a virial in LAMMPS' order
template <int D, class Component, class T>
FSI_INLINE void add_virial(Component component, T *virial)
{
  virial[0] += component(0, 0);
  virial[1] += component(1, 1);
  virial[3] += component(0, 1);
  if (D == 3) {
    virial[2] += component(D - 1, D - 1);
    virial[4] += component(0, D - 1);
    virial[5] += component(1, D - 1);
  }
}

// of a stress xx yy zz xy xz yz
inline double von_mises(const double *s)
{
  const double a = s[0] - s[1], b = s[1] - s[2], c = s[2] - s[0];
  return std::sqrt(0.5 * (a * a + b * b + c * c) + 3.0 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
}

}    // namespace LAMMPS_NS::FSI

#endif
