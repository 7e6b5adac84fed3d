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

// Particle shifting (delta-plus-SPH: Sun, Colagrossi, Marrone and Zhang 2017, Comput. Methods Appl.
// Mech. Eng. 315, 25):
//   delta r_i = -C c h dt sum_j V_j [1 + 0.2 (W_ij/W(dx))^4] grad_i W_ij,  |delta r_i| <= C c dt/4
// Particles move from where they are dense to where they are not; the sum vanishes on a lattice.
// Sun et al. have C = 2 Ma, Ma = 0.1 the largest expected speed U over c: the bound is their U/2.
//
// Where kernels are cut off by a free surface the sum points out of the fluid. There the part along
// the normal n ~ sum_j V_j grad_i W_ij is taken out, and nothing is left on edges, in jets and
// drops. What tells is how much of the divergence of position is missing, d - sum_j V_j x_ji.grad_i
// W_ij: 0 inside, 0.7 to 0.8 in the first row of a plane surface and 0.1 to 0.4 in the second, 1.3
// on a straight edge, in 2D and 3D. Walls (images) and solids count as full. A fluid that fills its
// box has no surface: what is missing there is a gap, which the whole sum closes.
//
// The flow does not move with the particles: where a particle comes to it takes the velocity of the
// flow there (Sun, Colagrossi, Marrone, Antuono and Zhang 2019, Comput. Phys. Commun. 244, 36, have
// it as a term of the rate):
//   delta v_i = delta r_i.grad v,  grad v = [sum_j V_j v_ji (x) g_ij] [sum_j V_j x_ji (x) g_ij]^-1,
//     g_ij = grad_i W_ij,
// of fluid neighbors alone, exact for linear fields wherever they are. Without it vortices behind a
// cylinder are too weak (doc/src/theory.rst). This does not keep momentum, so it is done where the
// fluid fills its box: there walls and streams give and take momentum all the time; a jet or a drop
// has but its own. Density goes along unchanged: delta r.grad rho would be sound. But displaced
// particles fill their places with the mass that they have, so density and volume drift apart: in a
// closed stream pressure falls, between open ends it grows until particles are pressed out. There
// the rate of density has the velocity v + delta r/dt (of the step before), at the price of sound:
// half as much again in forces. Angular momentum and energy are not kept exactly; the energy ledger
// knows nothing of shifting.

#ifndef LMP_FSI_SHIFT_H
#define LMP_FSI_SHIFT_H

#include "fsi_pack.h"
#include "fsi_tensor.h"

#include <cmath>

namespace LAMMPS_NS {
namespace FSI {

  template <int D> struct Shift {
    // Sums of a particle. Where the fluid may have a surface: the weighted and the plain sum of V_j
    // grad_i W_ij, and the divergence. Where it fills its box: the weighted sum and, of fluid
    // neighbors, those of x (x) g and v (x) g.
    static constexpr int EDGES = 2 * D + 1, SLOPES = D + Sym<D>::N + D * D;
    static constexpr int sums(bool fills) { return fills ? SLOPES : EDGES; }
    // Numbers from one particle to the next: the sums, and the neighbors' rate of density, which
    // saves them an addition of their own; fours are added at once
    static constexpr int row(bool fills) { return (sums(fills) + 1 + 3) / 4 * 4; }

    double inv_wdx;    // 1/W(dx)
    explicit Shift(double wdx) : inv_wdx(1.0 / wdx) {}

    // of W_ij: what grad_i W_ij is multiplied with
    template <class T> FSI_INLINE T weight(const T &w) const
    {
      const T q = w * inv_wdx, qq = q * q;
      return 1.0 + 0.2 * (qq * qq);
    }

    // Loops find sums times -V_i: then what a pair is in them is the same for both, but for the
    // sign of vectors. This is that of j; g: V_i V_j W'/r; T: double or Pack
    template <bool WITH_EDGES, class T>
    FSI_INLINE static void of_pair(T *part, const T &g, const T &weight, const T &rsq,
                                   const T *x_ij)
    {
      const T weighted = g * weight;
      for (int d = 0; d < D; d++) part[d] = weighted * x_ij[d];
      if (!WITH_EDGES) return;
      for (int d = 0; d < D; d++) part[D + d] = g * x_ij[d];
      part[2 * D] = g * rsq;
    }
    static constexpr bool is_vector(int k, bool with_edges) { return k < (with_edges ? 2 * D : D); }

    // what two fluid particles are in the sums that the gradient of the velocity comes of; v_ij:
    // v_i - v_j
    template <class T>
    FSI_INLINE static void slopes_of_pair(T *part, const T &g, const T *x_ij, const T *v_ij)
    {
      for (int a = 0; a < D; a++) {
        const T gx = g * x_ij[a], gv = g * v_ij[a];
        for (int b = a; b < D; b++) part[D + Sym<D>::id(a, b)] = gx * x_ij[b];
        for (int b = 0; b < D; b++) part[D + Sym<D>::N + a * D + b] = gv * x_ij[b];
      }
    }

    // The sums of a particle of volume V become the displacement, in their first D places, and the
    // change of velocity, in the next; FILLS: the fluid has no surface; scale = C c h dt, most =
    // C c dt/4
    template <bool FILLS>
    static void displacement(double *sum, double vol, double scale, double most)
    {
      const double inverse = -1.0 / vol;
      if (FILLS)
        find_slopes(sum, inverse);
      else
        take_normal_out(sum, inverse);
      for (int d = 0; d < D; d++) sum[d] *= -scale * inverse;
      const double sq = dot(sum, sum);
      if (sq > most * most)
        for (int d = 0; d < D; d++) sum[d] *= most / std::sqrt(sq);
      change_of_velocity(sum, FILLS);
    }

    // Only a part of the displacement along an axis is left, and the change of velocity is that of
    // what is left
    static void reduce(double *sum, bool fills, int axis, double part)
    {
      sum[axis] *= part;
      change_of_velocity(sum, fills);
    }

   private:
    static constexpr int GRADIENT = D + Sym<D>::N;    // the last D^2 sums: of the velocity

    // the sums of v (x) g become the gradient of the velocity: none where neighbors do not span the
    // space
    static void find_slopes(double *sum, double inverse_vol)
    {
      const auto inverse = spanned_inverse(Sym<D>::load(sum + D), inverse_vol);
      for (int a = 0; a < D; a++) {
        double *const row = sum + GRADIENT + a * D;
        double slope[D];
        FSI::dot(inverse, row, slope);
        for (int b = 0; b < D; b++) row[b] = slope[b];
      }
    }

    static void change_of_velocity(double *sum, bool fills)
    {
      for (int a = 0; a < D; a++) sum[D + a] = fills ? dot(sum + GRADIENT + a * D, sum) : 0.0;
    }

    static void take_normal_out(double *sum, double inverse_vol)
    {
      const double missing = D - inverse_vol * sum[2 * D];
      const double *const n = sum + D;
      const double nn = dot(n, n);
      // shares of the tangential and of the normal part: the latter from the second or third row on
      const double along = share(missing, 0.9, 1.0), across = share(missing, 0.04, 0.16);
      const double normal = nn > 0.0 ? (1.0 - across) * dot(sum, n) / nn : 0.0;
      for (int d = 0; d < D; d++) sum[d] = along * (sum[d] - normal * n[d]);
    }

    // m^-1, times the share it has: none where neighbors do not span the space. The determinant of
    // the sums in m, which are m times inverse_vol, is 1 inside, about 1/2 at a face and 1/4 or 1/8
    // in a corner
    static Sym<D> spanned_inverse(const Sym<D> &m, double inverse_vol)
    {
      Sym<D> adjoint;
      if constexpr (D == 2) {
        adjoint(0, 0) = m(1, 1);
        adjoint(1, 1) = m(0, 0);
        adjoint(0, 1) = -m(0, 1);
      } else
        for (int a = 0; a < D; a++)
          for (int b = a; b < D; b++) {
            const int p = (a + 1) % 3, q = (a + 2) % 3, r = (b + 1) % 3, s = (b + 2) % 3;
            adjoint(a, b) = m(p, r) * m(q, s) - m(p, s) * m(q, r);
          }
      double det = 0.0;
      for (int b = 0; b < D; b++) det += m(0, b) * adjoint(0, b);
      double of_sums = det;
      for (int d = 0; d < D; d++) of_sums *= inverse_vol;
      const double spanned = share(-of_sums, -0.1, -0.02);
      return adjoint *= spanned > 0.0 ? spanned / det : 0.0;
    }
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
