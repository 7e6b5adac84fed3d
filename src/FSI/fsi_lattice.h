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

// The elasticity that a lattice of fluid particles has and the fluid has not.
//
// A fluid strained without a change of area (3D: volume) keeps its density. The number density psi
// = sum W of its particles, which is what continuity follows and pressure works on, does not: on a
// square or simple cubic lattice psi(e) = psi (1 + s e^2/2 + ...), and the work p dpsi/psi is that
// of a solid with the modulus s p. s > 0 stiffens a flow (waves are too fast); where s < 0 a
// lattice under pressure gives way by itself. It is an error that does not fall with dx.
//
// s is a sum over the neighbors of second derivatives of W(|F x|), g = W'/r:
//   stretch, F = diag(exp e, exp -e):   sum (W'' - g) (x^2 - y^2)^2/r^2 + 2 g (x^2 + y^2)
//   shear, F = 1 + e x (x) y:           sum (W'' - g) x^2 y^2/r^2 + g y^2
// By the lattice's symmetry any other strain that keeps the volume, at small e, is a sum of these.

#ifndef LMP_FSI_LATTICE_H
#define LMP_FSI_LATTICE_H

#include "fsi_kernel.h"

#include <cmath>

namespace LAMMPS_NS {
namespace FSI {

  struct LatticeStiffness {
    double stretch = 0.0, shear = 0.0;    // modulus over pressure
  };

  template <class K> LatticeStiffness lattice_stiffness(const K &kernel, double dx)
  {
    const double psi = lattice_number_density(kernel, dx);
    const int n = static_cast<int>(kernel.cut / dx) + 1, nz = K::DIM == 3 ? n : 0;
    LatticeStiffness s;
    for (int k = -nz; k <= nz; k++)
      for (int j = -n; j <= n; j++)
        for (int i = -n; i <= n; i++) {
          const double rsq = dx * dx * (i * i + j * j + k * k), r = std::sqrt(rsq);
          if (r == 0.0 || r >= kernel.cut) continue;
          const double g = kernel.gradient(r) / psi, q = (kernel.curvature(r) / psi - g) / rsq,
                       xsq = i * dx * (i * dx), ysq = j * dx * (j * dx);
          s.stretch += q * (xsq - ysq) * (xsq - ysq) + 2.0 * g * (xsq + ysq);
          s.shear += q * xsq * ysq + g * ysq;
        }
    return s;
  }

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
