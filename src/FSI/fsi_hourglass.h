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

// Hourglass control of the updated-Lagrangian solid, a penalty on what the linear velocity field of
// a particle's neighborhood does not explain (after Zhang, Haidn and Hu 2024, arXiv 2409.11474):
// every pair has a spring of rate
//   d f_i/dt = xi G V_i V_j (-g_ij) [v_ji - (L_i + L_j) x_ji/2],  grad_i W_ij = g_ij x_ij,
// whose forces are kept summed per particle, in a vector that turns with it. Zero in any uniform
// gradient; second order in the spacing in a smooth field.

#ifndef LMP_FSI_HOURGLASS_H
#define LMP_FSI_HOURGLASS_H

#include "fsi_pack.h"

namespace LAMMPS_NS {
namespace FSI {

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

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
