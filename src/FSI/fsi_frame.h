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

#ifndef LMP_FSI_FRAME_H
#define LMP_FSI_FRAME_H

#include "pointers.h"

namespace LAMMPS_NS::FSI {
struct Walls;

// LAMMPS builds neighbor lists anew when a particle is half a skin from where it was. Lists hold
// as well while every particle is within half a skin of where it would be had all gone along
// with one velocity, whatever that is: two come nearer by less than the skin. So the places that
// LAMMPS measures from go along, with the mean of the highest and lowest velocities there were
// when lists were new. Lists of a stream last up to twice as long. By half a skin at most: those
// that ask for places fixed in space rely on it that none goes further than a skin.
class Frame : protected Pointers {
 public:
  Frame(LAMMPS *lmp, const Walls &walls) : Pointers(lmp), walls(walls) {}
  void init();
  void move();    // once in a step, before particles move

 private:
  const Walls &walls;
  bool allowed = false;
  double velocity[3], left = 0.0;    // how far it may go until lists are new
  void find_velocity();
};

// Puts this rank's atoms in an order that depends on nothing but where they are and their IDs:
// cells of that width, by ID in each. Positions must be wrapped. (Widths from half to twice the
// support make no difference in time.)
void sort_by_place(Atom *atom, double width);

}    // namespace LAMMPS_NS::FSI

#endif
