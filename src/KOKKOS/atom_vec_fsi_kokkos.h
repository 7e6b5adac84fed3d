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

#ifdef ATOM_CLASS
// clang-format off
AtomStyle(fsi/kk,AtomVecFSIKokkos);
// clang-format on
#else

#ifndef LMP_ATOM_VEC_FSI_KOKKOS_H
#define LMP_ATOM_VEC_FSI_KOKKOS_H

#include "atom_vec_fsi.h"
#include "atom_vec_kokkos.h"
#include "kokkos_type.h"

namespace LAMMPS_NS {

class AtomVecFSIKokkos : public AtomVecKokkos, public AtomVecFSI {
 public:
  AtomVecFSIKokkos(class LAMMPS *);
  void init() override;
  void grow(int) override;
  void grow_pointers() override;
  void sort_kokkos(Kokkos::BinSort<KeyViewType, BinOp> &) override;
  void sync(ExecutionSpace, uint64_t mask) override;
  void modified(ExecutionSpace, uint64_t mask) override;
  void sync_pinned(ExecutionSpace, uint64_t mask, int async) override;

 private:
  template <class Use> void for_arrays(uint64_t mask, Use);
};

}    // namespace LAMMPS_NS

#endif
#endif
