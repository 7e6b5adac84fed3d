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

#ifndef LMP_FSI_ADVICE_H
#define LMP_FSI_ADVICE_H

namespace LAMMPS_NS {
class LAMMPS;

namespace FSI {
  class Scene;

  // Warns, before the first step, of numbers that are legal and most likely not what was meant:
  // spacing, overlaps, thin bodies, speed of sound, time step, skin, box, units. Each says what to
  // type. Reads only; a few operations per particle.
  void advise(LAMMPS *lmp, const Scene &scene);

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
