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

// Laws of updated-Lagrangian solids alone: artificial stress and hourglass control.

#ifndef LMP_FSI_CLASSIC_LAWS_H
#define LMP_FSI_CLASSIC_LAWS_H

#include "fsi_tensor.h"
#include "math_eigen.h"

namespace LAMMPS_NS::FSI {

// sum over the principal values s_k > 0 of t of s_k n_k n_k^T (the tensile part of t)
template <int D> inline Sym<D> tensile_part(const Sym<D> &t)
{
  Sym<D> r;
  if constexpr (D == 2) {
    const double mean = 0.5 * (t.c[0] + t.c[1]), half = 0.5 * (t.c[0] - t.c[1]);
    const double radius = std::sqrt(half * half + t.c[2] * t.c[2]);
    const double s1 = mean + radius, s2 = mean - radius;
    if (s1 <= 0.0) return r;
    if (s2 >= 0.0) return t;
    // s1 n1 n1^T with n1 n1^T = (I + (t - mean I)/radius)/2
    const double f = 0.5 * s1 / radius;
    r.c[0] = f * (radius + half);
    r.c[1] = f * (radius - half);
    r.c[2] = f * t.c[2];
  } else {
    const double m[3][3] = {
        {t.c[0], t.c[3], t.c[4]}, {t.c[3], t.c[1], t.c[5]}, {t.c[4], t.c[5], t.c[2]}};
    double s[3], n[3][3];    // columns of n are the principal directions
    MathEigen::jacobi3(m, s, n);
    for (int k = 0; k < 3; k++) {
      if (s[k] <= 0.0) continue;
      for (int a = 0; a < 3; a++)
        for (int b = a; b < 3; b++) r(a, b) += s[k] * n[a][k] * n[b][k];
    }
  }
  return r;
}

// Artificial stress (Gray, Monaghan and Swift 2001), paper eq. 14: short-range repulsion along
// tensile principal directions, against the tensile instability of solids.
//   R_i = -epsilon V_i^2 sum_k s_k n_k n_k^T over principal stresses s_k > 0,
//   F_ij += (R_i + R_j) (W_ij/W(dx))^q . grad_i W_ij
struct ArtificialStress {
  double epsilon, inv_wdx;
  ArtificialStress(double epsilon_in, double wdx) : epsilon(epsilon_in), inv_wdx(1.0 / wdx) {}

  // R_i from the stress times V_i^2
  template <int D> Sym<D> operator()(const Sym<D> &stress_v2) const
  {
    Sym<D> r = tensile_part(stress_v2);
    r *= -epsilon;
    return r;
  }
  // (W/W(dx))^q with the paper's q = 4
  template <class T> FSI_INLINE T weight(const T &w) const
  {
    const T f = w * inv_wdx, f2 = f * f;
    return f2 * f2;
  }
};

// Hourglass control of the updated-Lagrangian solid, a penalty on what the linear velocity field
// of a particle's neighborhood does not explain (after Zhang, Wu, Lourenco and Hu 2024,
// arXiv 2409.11474): every pair has a spring of rate
//   d f_i/dt = xi G V_i V_j (-g_ij) [v_ji - (L_i + L_j) x_ji/2],  grad_i W_ij = g_ij x_ij,
// whose forces are kept summed per particle, in a vector that turns with it. Zero in any uniform
// gradient; second order in the spacing in a smooth field.
struct Hourglass {
  double xi;
  // rate of the force on i; shear: mean of the pair, vv = V_i V_j, x, v: i minus j, L: L_i + L_j,
  // row-major; T: double or Pack
  template <int D, class T>
  FSI_INLINE void operator()(const T &shear, const T &vv, const T &g, const T (&x)[D],
                             const T (&v)[D], const T (&L)[D * D], T (&rate)[D]) const
  {
    const T k = xi * shear * vv * g;
    for (int a = 0; a < D; a++) {
      T mismatch = v[a];
      for (int b = 0; b < D; b++) mismatch -= 0.5 * L[a * D + b] * x[b];
      rate[a] = k * mismatch;
    }
  }
};

}    // namespace LAMMPS_NS::FSI

#endif
