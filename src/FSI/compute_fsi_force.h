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
ComputeStyle(fsi/force,ComputeFSIForce);
// clang-format on
#else

#ifndef LMP_COMPUTE_FSI_FORCE_H
#define LMP_COMPUTE_FSI_FORCE_H

#include "compute.h"
#include "fsi_part.h"

namespace LAMMPS_NS {
namespace FSI {
  struct Discretization;
}

// Force and torque that pair_style fsi/fluid gives to the solid and wall particles of a group.

class ComputeFSIForce : public Compute, public FSI::Part {
 public:
  ComputeFSIForce(class LAMMPS *, int, char **);
  ~ComputeFSIForce() override { delete[] vector; }
  void init() override;
  void find_idle(const Census &, const Idle &) const override;
  void compute_vector() override;

  // adds the forces in atom->f with this sign: -1 before the loop of pair_style fsi/fluid, +1 after
  void tally(double sign);
  // between the two, only if split: forces of viscosity alone, per particle, in rows
  void tally_viscosity(const double *, int row);
  void add_more(int i, const double *f)    // after them, to local atom i
  {
    if (counts(i)) add(i, f, 1.0, FORCE);
  }
  int split;

 private:
  // about and from `origin`
  enum { FORCE = 0, TORQUE = 3, VISCOUS = 6, VISCOUS_TORQUE = 9, MOMENT = 12, MASS = 15, NSUM };
  double sum[NSUM] = {}, origin[3] = {};
  bool reduced = false;    // over ranks, since the last forces
  const FSI::Discretization *disc = nullptr;

  bool counts(int) const;
  void add(int, const double *f, double sign, int where);
  void find_body();
};

}    // namespace LAMMPS_NS

#endif
#endif
