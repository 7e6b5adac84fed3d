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

#ifndef LMP_FSI_ANNOUNCE_H
#define LMP_FSI_ANNOUNCE_H

namespace LAMMPS_NS {
class LAMMPS;

namespace FSI {
  class Scene;

  // Before the first step, when it changes: every effect that is on, every one that is not and how
  // to turn it on, and what memory and messages they need; then advice, and what has nothing to act
  // on.
  void announce(LAMMPS *lmp, Scene &scene);

  // Warns (fsi_advice.cpp) of numbers that are legal and most likely not what was meant: spacing,
  // overlaps, thin bodies, speed of sound, time step, skin, box, units. Each says what to type.
  // Reads only; a few operations per particle.
  void advise(LAMMPS *lmp, const Scene &scene);

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
