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

// Laminar viscosity (Morris, Fox and Zhu 1997, eq. 22, with V = m/rho):
//   F_ij = V_i V_j (eta_i + eta_j) (x_ij.grad_i W_ij)/(r^2 + 0.01 h^2) v_ij

#ifndef LMP_FSI_VISCOSITY_LAMINAR_H
#define LMP_FSI_VISCOSITY_LAMINAR_H

namespace LAMMPS_NS {
namespace FSI {

  struct LaminarViscosity {
    double eta;    // 0.01 h^2
    explicit LaminarViscosity(double h) : eta(0.01 * h * h) {}
    // factor k with F_ij = k v_ij; g: grad_i W_ij = g x_ij; visc: eta_i + eta_j; vv = V_i V_j
    double operator()(double g, double rsq, double visc, double vv) const { return vv * visc * g * rsq / (rsq + eta); }
  };

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
