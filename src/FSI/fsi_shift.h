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

// Particle shifting (delta-plus-SPH: Sun, Colagrossi, Marrone and Zhang 2017, Comput. Methods Appl. Mech. Eng. 315, 25):
//   delta r_i = -C c h dt sum_j V_j [1 + 0.2 (W_ij/W(dx))^4] grad_i W_ij,  |delta r_i| <= C c dt/4
// Particles move from where they are dense to where they are not. Sun et al. have C = 2 Ma, with Ma = 0.1 the largest
// expected speed U over c; the bound is then their U/2. The sum vanishes on a lattice.
//
// Where kernels are cut off by a free surface the sum points out of the fluid. There the part along the normal
// n ~ sum_j V_j grad_i W_ij is taken out, and nothing is left on edges, in jets and drops. What tells is how much of the
// divergence of position is missing, d - sum_j V_j x_ji.grad_i W_ij: 0 inside, 0.7 to 0.8 in the first row of a plane surface
// and 0.1 to 0.4 in the second, 1.3 on a straight edge, in 2D and 3D. Walls (images) and solids count as full.
//
// Velocity and density go along unchanged: what is neglected, delta r.grad v and delta r.grad rho, is what Sun et al. neglect.
// With C doubled the error of Taylor-Green vortices changes by less than 0.001 (doc/src/theory.rst), which bounds it. Linear momentum
// is kept exactly; angular momentum and potential energy are not, and the energy ledger knows nothing of shifting.

#ifndef LMP_FSI_SHIFT_H
#define LMP_FSI_SHIFT_H

#include "fsi_pack.h"

#include <cmath>

namespace LAMMPS_NS {
namespace FSI {

  template <int D> struct Shift {
    static constexpr int N = 2 * D + 1;             // sums of a particle: weighted and plain sum of V_j grad_i W_ij, divergence
    static constexpr int ROW = D == 2 ? N : N + 1;    // numbers from one particle to the next: fours are added at once
    double wdx;                            // W(dx)
    explicit Shift(double w) : wdx(w) {}

    // adds neighbour j of volume V_j to the sums of i; g: grad_i W_ij = g x_ij, w = W_ij; T: double or Pack
    template <class T> FSI_INLINE void add(T *sum, const T &vol, const T &g, const T &w, const T &rsq, const T *x_ij) const
    {
      const T q = w * (1.0 / wdx), qq = q * q, vg = vol * g, weighted = vg * (1.0 + 0.2 * (qq * qq));
      for (int d = 0; d < D; d++) {
        sum[d] += weighted * x_ij[d];
        sum[D + d] += vg * x_ij[d];
      }
      sum[2 * D] -= vg * rsq;
    }

    // the sums become the displacement, in their first D places; scale = C c h dt, most = C c dt/4
    static void displacement(double *sum, double scale, double most)
    {
      const double missing = D - sum[2 * D];
      const double *const n = sum + D;
      const double nn = dot(n, n);
      // shares of the tangential and of the normal part: the latter from the second or third row on
      const double along = share(missing, 0.9, 1.0), across = share(missing, 0.04, 0.16);
      const double normal = nn > 0.0 ? (1.0 - across) * dot(sum, n) / nn : 0.0;
      for (int d = 0; d < D; d++) sum[d] = -scale * along * (sum[d] - normal * n[d]);
      const double size = std::sqrt(dot(sum, sum));
      if (size > most)
        for (int d = 0; d < D; d++) sum[d] *= most / size;
    }

   private:
    static double dot(const double *a, const double *b)
    {
      double s = 0.0;
      for (int d = 0; d < D; d++) s += a[d] * b[d];
      return s;
    }
    // 1 up to all, 0 from none on
    static double share(double x, double all, double none)
    {
      return x <= all ? 1.0 : x >= none ? 0.0 : (none - x) / (none - all);
    }
  };

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
