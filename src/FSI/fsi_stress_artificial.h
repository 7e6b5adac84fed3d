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

// Artificial stress (Gray, Monaghan and Swift 2001), paper eq. 14: short-range repulsion along
// tensile principal directions, against the tensile instability of solids.
//   R_i = -epsilon V_i^2 sum_k s_k n_k n_k^T over principal stresses s_k > 0,  F_ij += (R_i + R_j)
//     (W_ij/W(dx))^q . grad_i W_ij

#ifndef LMP_FSI_STRESS_ARTIFICIAL_H
#define LMP_FSI_STRESS_ARTIFICIAL_H

#include "fsi_tensor.h"

namespace LAMMPS_NS {
namespace FSI {

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

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
