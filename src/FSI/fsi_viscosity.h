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

// Viscosity of pairs, artificial and laminar.

#ifndef LMP_FSI_VISCOSITY_H
#define LMP_FSI_VISCOSITY_H

#include "fsi_pack.h"

namespace LAMMPS_NS {
namespace FSI {

  // Artificial viscosity (Monaghan 1992), paper eq. 14: damps approach only, never separation.
  //   F_ij = -Q_ij grad_i W_ij,  Q_ij = rho_ij V_i V_j (-alpha c_ij mu + beta mu^2),  mu = h
  //     v_ij.x_ij/(r^2 + 0.01 h^2) < 0
  struct ArtificialViscosity {
    double alpha, beta, h, eta;    // eta = 0.01 h^2
    ArtificialViscosity(double alpha_in, double beta_in, double h_in) :
        alpha(alpha_in), beta(beta_in), h(h_in), eta(0.01 * h_in * h_in)
    {
    }
    // vdotx = v_ij.x_ij; rho, c: means of the pair; vv = V_i V_j; T: double or Pack, C, too
    template <class T, class C>
    FSI_INLINE T operator()(const T &vdotx, const T &rsq, const T &rho, const C &c,
                            const T &vv) const
    {
      if (none(vdotx < T(0.0))) return T(0.0);
      const T mu = h * lesser(vdotx, T(0.0)) / (rsq + eta);
      return rho * vv * mu * (beta * mu - alpha * c);
    }
  };

  // Laminar viscosity, with V = m/rho and in both forms the mean viscosity of two fluids:
  //   plain (Morris, Fox and Zhu 1997, eq. 22):
  //     F_ij = V_i V_j (eta_i + eta_j) (x_ij.grad_i W_ij)/r^2 v_ij
  //   central, along the line of centers, as Monaghan and Gingold 1983 with Monaghan's 2005 factor
  //   2(d+2), but l^2, a constant (central_length_sq), in the place of r^2:
  //     F_ij = V_i V_j (d + 2)(eta_i + eta_j) (v_ij.x_ij)/l^2 grad_i W_ij
  // Both papers add 0.01 h^2 to r^2, which makes the viscosity 0.6 % smaller; but nothing is
  // singular here: grad_i W_ij = g x_ij, g is finite. x (x) x/r^2 is not smooth where r = 0, so on
  // a lattice its sums depend on the direction of shear: with r^2 and the quintic, h = dx, a flow
  // along the rows has 0.83 of its viscosity and one across them 1.17; with l^2 1.00. Both are the
  // Laplacian of an incompressible flow. The plain one takes eta |grad v|^2 from the flow, the
  // central one 2 eta e:e, e the rate of strain: only that is right at a free surface (Colagrossi,
  // Antuono, Souto-Iglesias and Le Touze 2011), and only that keeps angular momentum; the plain one
  // is quieter in shear.
  template <int D> struct LaminarViscosity {
    double along;    // (d + 2)/l^2; 0: the plain form
    explicit LaminarViscosity(double length_sq) : along(length_sq > 0.0 ? (D + 2) / length_sq : 0.0)
    {
    }
    // adds F_ij to f and returns the power it takes; g: grad_i W_ij = g x_ij; visc: eta_i + eta_j;
    // vv = V_i V_j; T: double or Pack
    template <class T>
    FSI_INLINE T operator()(const T &g, double visc, const T &vv, const T *x_ij, const T *v_ij,
                            T *f) const
    {
      const T k = vv * visc * g;
      T power = 0.0;
      if (along > 0.0) {
        T vx = 0.0;
        for (int d = 0; d < D; d++) vx += v_ij[d] * x_ij[d];
        const T push = along * k * vx;
        for (int d = 0; d < D; d++) f[d] += push * x_ij[d];
        power = push * vx;
      } else
        for (int d = 0; d < D; d++) {
          f[d] += k * v_ij[d];
          power += k * v_ij[d] * v_ij[d];
        }
      return -power;
    }
  };

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
