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

// Density diffusion (delta-SPH: Molteni and Colagrossi 2009) with the hydrostatic part of the density difference taken
// out (Fourtakas et al. 2019), so that still water does not drift:
//   d rho_i/dt += 2 delta h c sum_j V_j (rho_j - rho_i + rho0/c^2 b.x_ij) x_ji.grad_i W_ij / r^2,  b: body force per mass

#ifndef LMP_FSI_DENSITY_DIFFUSION_H
#define LMP_FSI_DENSITY_DIFFUSION_H

namespace LAMMPS_NS {
namespace FSI {

  struct DensityDiffusion {
    double scale;        // 2 delta h
    double gravity[3];
    DensityDiffusion(double delta, double h, const double *g) : scale(2.0 * delta * h)
    {
      for (int k = 0; k < 3; k++) gravity[k] = g[k];
    }
    // flux k: d rho_i/dt += k V_j, d rho_j/dt -= k V_i; g: grad_i W_ij = g x_ij; x_ij here is that of the particles
    // themselves, also where g belongs to an image
    double operator()(double rho_i, double rho_j, const double *x_ij, double c, double rho0_over_csq, double g) const
    {
      const double hydrostatic =
          rho0_over_csq * (gravity[0] * x_ij[0] + gravity[1] * x_ij[1] + gravity[2] * x_ij[2]);
      return -scale * c * g * (rho_j - rho_i + hydrostatic);
    }
  };

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
