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

#ifdef COMMAND_CLASS
// clang-format off
CommandStyle(fsi/clamp,FSIClamp);
// clang-format on
#else

#ifndef LMP_FSI_CLAMP_COMMAND_H
#define LMP_FSI_CLAMP_COMMAND_H

#include "command.h"

namespace LAMMPS_NS {

// fsi/clamp free-group-ID clamp-group-ID: particles of a body in the first group that are within
// a spacing of its particles in the second one go over to that. Held particles act as a clamp a
// spacing behind their face (theory.rst), so this one acts at the face that it had.
class FSIClamp : public Command {
 public:
  FSIClamp(class LAMMPS *lmp) : Command(lmp) {}
  void command(int, char **) override;
};

}    // namespace LAMMPS_NS

#endif
#endif
