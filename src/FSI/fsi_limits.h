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

// Limits of the time step, by cause: fix fsi/dt chooses by them, advice before a run compares.

#ifndef LMP_FSI_LIMITS_H
#define LMP_FSI_LIMITS_H

#include "pointers.h"

namespace LAMMPS_NS::FSI {
struct Discretization;

class Limits : protected Pointers {
 public:
  enum Limit { SOUND, ELASTIC, ARTIFICIAL, LAMINAR, ACCELERATION, NLIMIT };
  static constexpr double UNLIMITED = 1.0e20;
  static constexpr const char *names[NLIMIT] = {"sound in the fluid", "elastic waves in the solid",
                                                "artificial viscosity", "laminar viscosity",
                                                "acceleration"};
  // limit = safe times the time that the Courant number of this cause divides dt by, times a
  // factor of fluids or of solids; those that are usual; fluids remain stable at twice theirs,
  // elastic solids at 1.2 times (doc/notes/fluid.md)
  static constexpr double safe[NLIMIT] = {0.25, 0.25, 0.4, 0.0625, 0.25};
  static constexpr double FLUID_FACTOR = 2.0, SOLID_FACTOR = 1.0;

  double limit[2][NLIMIT];    // of the step, and of a sub-step of what takes sub-steps
  double *const step = limit[0], *const sub = limit[1];
  tagint culprit[2][2] = {};    // particle behind sound and acceleration, of step and sub-step

  explicit Limits(class LAMMPS *lmp) : Pointers(lmp) {}
  // of this rank's particles of a group, times a factor of fluids and one of solids
  void find(const Discretization &, const double *viscosity, int groupbit, bool substeps,
            double of_fluid = FLUID_FACTOR, double of_solid = SOLID_FACTOR);
  void reduce();    // of all ranks
};

}    // namespace LAMMPS_NS::FSI

#endif
