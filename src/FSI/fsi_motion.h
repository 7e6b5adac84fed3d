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

// Drift and kick of fix fsi: loops over this rank's particles, on the host.

#ifndef LMP_FSI_MOTION_H
#define LMP_FSI_MOTION_H

namespace LAMMPS_NS {
class LAMMPS;

namespace FSI {
  struct Discretization;
  struct StepState;

  // of a group: x by half a step
  void drift(LAMMPS *, const Discretization &, const StepState &, int groupbit);
  // v by the forces, x by half a step, both by shifting; not of solids that took sub-steps
  void kick(LAMMPS *, const Discretization &, const StepState &, int groupbit);

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
