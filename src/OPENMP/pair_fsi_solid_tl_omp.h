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

#ifdef PAIR_CLASS
// clang-format off
PairStyle(fsi/solid/tl/omp,PairFSISolidTLOMP);
// clang-format on
#else

#ifndef LMP_PAIR_FSI_SOLID_TL_OMP_H
#define LMP_PAIR_FSI_SOLID_TL_OMP_H

#include "pair_fsi_solid_tl.h"

namespace LAMMPS_NS {
namespace FSI {
  class RowThreads;
}

class PairFSISolidTLOMP : public PairFSISolidTL {
  const std::unique_ptr<FSI::RowThreads> of_all, of_moving;    // rows

 public:
  PairFSISolidTLOMP(class LAMMPS *);
  ~PairFSISolidTLOMP() override;
  double memory_usage() override;

 protected:
  void find_rows() override;
  void over_rows(int n, double *to, int width, FSI::BondSums &, const RowLoop &) override;
};

}    // namespace LAMMPS_NS

#endif
#endif
