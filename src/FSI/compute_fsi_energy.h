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

#ifdef COMPUTE_CLASS
// clang-format off
ComputeStyle(fsi/energy,ComputeFSIEnergy);
// clang-format on
#else

#ifndef LMP_COMPUTE_FSI_ENERGY_H
#define LMP_COMPUTE_FSI_ENERGY_H

#include "compute.h"
#include "fsi_part.h"

namespace LAMMPS_NS {

// Energy ledger: what the particles have, and what each term has taken since fix fsi was defined.

class ComputeFSIEnergy : public Compute, public FSI::Part {
 public:
  ComputeFSIEnergy(class LAMMPS *, int, char **);
  ~ComputeFSIEnergy() override { delete[] vector; }
  void init() override;
  double compute_scalar() override;
  void compute_vector() override;

  FSI::Facts facts() const override { return FSI::only(&FSI::Facts::keeps_account); }

  static const char *name(int);    // of an entry of the vector
};

}    // namespace LAMMPS_NS

#endif
#endif
