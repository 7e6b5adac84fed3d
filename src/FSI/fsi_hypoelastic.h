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

// Stress of hypoelastic solids that is integrated in time, and where it yields.

#ifndef LMP_FSI_HYPOELASTIC_H
#define LMP_FSI_HYPOELASTIC_H

#include "fsi_tensor.h"

#include <cmath>

namespace LAMMPS_NS {
namespace FSI {

  // Jaumann rate, paper eq. 3.
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

  // J2 plasticity of hypoelastic solids: radial return of the deviatoric stress to the von Mises
  // surface (Wilkins 1964; Simo and Hughes 1998, sec. 3.3.1), with linear isotropic hardening:
  // sigma_y = yield + hardening * (equivalent plastic strain).
  // s: elastic trial deviator, of plane strain in 2D, brought back to the surface; strain:
  // equivalent plastic strain, which grows. Returns the plastic work per volume.
  template <int D>
  inline double radial_return(Sym<D> &s, double &strain, double shear, double yield,
                              double hardening)
  {
    double ss = s.squared();
    if (D == 2) ss += (s.c[0] + s.c[1]) * (s.c[0] + s.c[1]);    // s_zz
    const double trial = std::sqrt(1.5 * ss), limit = yield + hardening * strain;
    if (trial <= limit) return 0.0;
    const double d = (trial - limit) / (3.0 * shear + hardening);
    s *= 1.0 - 3.0 * shear * d / trial;
    strain += d;
    return (limit + hardening * d) * d;
  }

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
