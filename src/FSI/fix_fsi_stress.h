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
#include "fsi_jaumann.h"

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

  // half a step back to half a step ahead, with the velocity gradient L of the time between (fsi_jaumann.h)
  template <int D> void advance(int i, const double *L, double dt, double shear)
  {
    auto s = FSI::Sym<D>::load(stress[i]);
    FSI::jaumann_update<D>(s, L, dt, shear, plane_stress);
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
