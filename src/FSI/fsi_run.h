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
CommandStyle(fsi/run,FSIRun);
CommandStyle(fsi/dump,FSIDump);
// clang-format on
#else

#ifndef LMP_FSI_RUN_H
#define LMP_FSI_RUN_H

#include "command.h"

namespace LAMMPS_NS {

// fsi/run time keyword value ...: runs until that time. Keywords are those of the fix fsi/dt that
// it makes if there is none.
class FSIRun : public Command {
 public:
  FSIRun(class LAMMPS *lmp) : Command(lmp) {}
  void command(int, char **) override;
};

// fsi/dump group-ID time field ... [file name]: particles every so much time, with the fields of
// compute fsi/atom, in columns of these names.
class FSIDump : public Command {
 public:
  FSIDump(class LAMMPS *lmp) : Command(lmp) {}
  void command(int, char **) override;
};

}    // namespace LAMMPS_NS

#endif
#endif
