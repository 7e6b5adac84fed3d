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

#ifndef LMP_FSI_ORDER_H
#define LMP_FSI_ORDER_H

namespace LAMMPS_NS {
class Atom;

namespace FSI {

  // Puts this rank's atoms in an order that depends on nothing but where they are and their IDs:
  // cells of that width, by ID in each. Positions must be wrapped. (Widths from half to twice the
  // support make no difference in time.)
  void sort_by_place(Atom *atom, double width);

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
