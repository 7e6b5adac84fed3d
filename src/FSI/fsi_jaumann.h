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

// Hypoelastic stress update with the Jaumann rate, paper eq. 3.

#ifndef LMP_FSI_JAUMANN_H
#define LMP_FSI_JAUMANN_H

#include "fsi_tensor.h"

namespace LAMMPS_NS {
namespace FSI {

  // Deviatoric stress s^{n-1/2} -> s^{n+1/2} with the velocity gradient L (row-major D x D) of time
  // n, G = shear:
  //   ds/dt = 2G dev(e) + w s - s w,  e, w = symmetric and antisymmetric part of L,
  // as s' = Q (Q s Q^T + 2G dt dev(e)) Q^T with Q = exp(dt w/2): second order in dt, and exact for
  // rigid rotation. The deviator takes away a third of the trace in 3D and in plane strain, half of
  // it in plane stress.
  template <int D>
  void jaumann_update(Sym<D> &s, const double *L, double dt, double shear, bool plane_stress)
  {
    double Q[D * D];
    rotation<D>(L, 0.5 * dt, Q);
    Sym<D> de = symmetric<D>(L);
    const double mean = de.trace() / (plane_stress ? 2.0 : 3.0);
    for (int a = 0; a < D; a++) de.c[a] -= mean;
    de *= 2.0 * shear * dt;
    s = rotate<D>(s, Q);
    s += de;
    s = rotate<D>(s, Q);
  }

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
