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

#ifdef FIX_CLASS
// clang-format off
FixStyle(fsi/stress,FixFSIStress);
// clang-format on
#else

#ifndef LMP_FIX_FSI_STRESS_H
#define LMP_FIX_FSI_STRESS_H

#include "fix.h"
#include "fsi_tensor.h"

namespace LAMMPS_NS {

// Deviatoric stress of hypoelastic solids: owns it, evolves it by the Jaumann rate (paper eq. 3). Driven by fix fsi,
// which forms the velocity gradient.

class FixFSIStress : public Fix {
 public:
  FixFSIStress(class LAMMPS *, int, char **);
  ~FixFSIStress() override;
  int setmask() override { return 0; }
  void init() override;
  void grow_arrays(int) override;
  void copy_arrays(int, int, int) override;
  void set_arrays(int) override;
  int pack_exchange(int, double *) override;
  int unpack_exchange(int, double *) override;
  int pack_restart(int, double *) override;
  void unpack_restart(int, int) override;
  int size_restart(int) override;
  int maxsize_restart() override;
  double memory_usage() override;

  // deviatoric stress per atom, in-plane in 2D; see fsi_tensor.h for the order
  double **stress;
  bool plane_stress;

  // S^{n-1/2} -> S^{n+1/2} with the velocity gradient L (row-major) at time n:
  // dS/dt = 2G dev(e) + w S - S w, integrated as S' = Q S Q^T + Qh (2G dt dev(e)) Qh^T with Q = exp(dt w), Qh = exp(dt w/2):
  // second order, and exact for rigid rotation
  template <int D> void advance(int i, const double *L, double dt, double shear)
  {
    double Q[D * D], Qh[D * D];
    FSI::rotation<D>(L, dt, Q);
    FSI::rotation<D>(L, 0.5 * dt, Qh);
    FSI::Sym<D> de = FSI::symmetric<D>(L);
    const double mean = de.trace() / (plane_stress ? 2.0 : 3.0);
    for (int a = 0; a < D; a++) de.c[a] -= mean;
    de *= 2.0 * shear * dt;
    FSI::Sym<D> s = FSI::rotate<D>(FSI::Sym<D>::load(stress[i]), Q);
    s += FSI::rotate<D>(de, Qh);
    s.store(stress[i]);
  }

  // von Mises stress of atom i with pressure p
  double von_mises(int i, double p) const;

 private:
  int n;    // components per atom
};

}    // namespace LAMMPS_NS

#endif
#endif
