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
ComputeStyle(fsi/atom,ComputeFSIAtom);
ComputeStyle(fsi/surface/atom,ComputeFSISurfaceAtom);
// clang-format on
#else

#ifndef LMP_COMPUTE_FSI_ATOM_H
#define LMP_COMPUTE_FSI_ATOM_H

#include "compute.h"

#include <vector>

namespace LAMMPS_NS {
namespace FSI {
  class Shear;
  struct Discretization;
  struct StepState;
}    // namespace FSI

// Per-particle quantities of fluids and solids: pressure, density, number density, stress.

class ComputeFSIAtom : public Compute {
 public:
  ComputeFSIAtom(class LAMMPS *, int, char **);
  ~ComputeFSIAtom() override;
  void init() override;
  void compute_peratom() override;
  double memory_usage() override;

 private:
  // clang-format off
  enum Quantity {
    PRESSURE, DENSITY, PSI, VOLUME, VONMISES, SXX, SYY, SZZ, SXY, SXZ, SYZ, PLASTIC, BONDS,
    SHEAR_RATE, VISCOSITY, NQUANTITY
  };
  // clang-format on
  std::vector<int> quantity;
  bool tensor = false;    // is one of them of the stress?
  std::vector<double> psi;
  int nmax = 0;
  const FSI::Discretization *disc = nullptr;
  const FSI::StepState *step = nullptr;
  class FixFSIStress *fix_stress;    // null: no solid has one
  class PairFSISolidTL *solid_tl;    // null: there is none

  const FSI::Shear *shear = nullptr;    // null: nothing needs it

  void find(int i, double *of) const;    // all quantities of an atom that something needs
};

// 1 for fluid particles at a free surface, which a face of a solid or a wall is not; else 0.

class ComputeFSISurfaceAtom : public Compute {
 public:
  ComputeFSISurfaceAtom(class LAMMPS *, int, char **);
  void init() override;
  void compute_peratom() override;
  double memory_usage() override;

 private:
  enum { DIVERGENCE, NUMBER_DENSITY };
  int rule;
  double threshold;
  std::vector<double> sum;    // then the flags
};

}    // namespace LAMMPS_NS

#endif
#endif
