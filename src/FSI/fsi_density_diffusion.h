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

// Density diffusion (delta-SPH: Molteni and Colagrossi 2009) with the hydrostatic part of the
// density difference taken out (Fourtakas et al. 2019), so that still water does not drift:
//   d rho_i/dt += 2 delta h c sum_j V_j (rho_j - rho_i + rho0/c^2 b.x_ij) x_ji.grad_i W_ij / r^2,
//     b: body force per mass

#ifndef LMP_FSI_DENSITY_DIFFUSION_H
#define LMP_FSI_DENSITY_DIFFUSION_H

#include "fsi_pack.h"

namespace LAMMPS_NS {
namespace FSI {

  struct DensityDiffusion {
    double scale;    // 2 delta h c
    DensityDiffusion(double delta, double h, double c) : scale(2.0 * delta * h * c) {}
    // hydrostatic part of the density at x, but for a constant
    static double hydrostatic(const double *gravity, const double *x, double rho0_over_csq)
    {
      return rho0_over_csq * (gravity[0] * x[0] + gravity[1] * x[1] + gravity[2] * x[2]);
    }
    // flux k: d rho_i/dt += k V_j, d rho_j/dt -= k V_i; hydro: difference i - j of the hydrostatic
    // parts at the particles themselves, also where g, with grad_i W_ij = g x_ij, belongs to an
    // image; T: double or Pack
    template <class T>
    FSI_INLINE T operator()(const T &rho_i, const T &rho_j, const T &hydro, const T &g) const
    {
      return -scale * g * (rho_j - rho_i + hydro);
    }
  };

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
