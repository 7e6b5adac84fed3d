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
PairStyle(fsi/fluid/omp,PairFSIFluidOMP);
// clang-format on
#else

#ifndef LMP_PAIR_FSI_FLUID_OMP_H
#define LMP_PAIR_FSI_FLUID_OMP_H

#include "pair_fsi_fluid.h"

namespace LAMMPS_NS {

class PairFSIFluidOMP : public PairFSIFluid {
  struct Members;
  const std::unique_ptr<Members> members;

 public:
  PairFSIFluidOMP(class LAMMPS *);
  ~PairFSIFluidOMP() override;
  void init_style() override;
  void set_fields(FSI::Discretization &) override;
  void begin_state(bool) override;
  double memory_usage() override;
};

}    // namespace LAMMPS_NS

#endif
#endif
