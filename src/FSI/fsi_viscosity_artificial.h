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

// Artificial viscosity (Monaghan 1992), paper eq. 14: damps approach only, never separation.
//   F_ij = -Q_ij grad_i W_ij,  Q_ij = rho_ij V_i V_j (-alpha c_ij mu + beta mu^2),  mu = h
//     v_ij.x_ij/(r^2 + 0.01 h^2) < 0

#ifndef LMP_FSI_VISCOSITY_ARTIFICIAL_H
#define LMP_FSI_VISCOSITY_ARTIFICIAL_H

#include "fsi_pack.h"

namespace LAMMPS_NS {
namespace FSI {

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

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
