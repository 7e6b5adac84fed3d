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
CommandStyle(fsi/displace,FSIDisplace);
CommandStyle(fsi/dump,FSIDump);
CommandStyle(fsi/material,FSIMaterial);
CommandStyle(fsi/pack,FSIPack);
CommandStyle(fsi/run,FSIRun);
CommandStyle(fsi/set,FSISet);
// clang-format on
#else

#ifndef LMP_FSI_COMMANDS_H
#define LMP_FSI_COMMANDS_H

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

// fsi/displace fluid-group-ID body-group-ID: takes out the fluid in whose place a body is.
class FSIDisplace : public Command {
 public:
  FSIDisplace(class LAMMPS *lmp) : Command(lmp) {}
  void command(int, char **) override;
};

// fsi/run time keyword value ...: runs until that time. Keywords: of the fix fsi/dt that it makes
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

// fsi/material name species keyword value ...: a material that pair_coeff finds by its name, beside
// those of its file. fsi/material file name: likewise all materials of another file.
class FSIMaterial : public Command {
 public:
  FSIMaterial(class LAMMPS *lmp) : Command(lmp) {}
  void command(int, char **) override;
};

// fsi/pack body-ID fluid-ID region ID | stl FILE | outline FILE [still group-ID] [steps N]: moves
// the particles of a body and of the fluid around it until both fit the surface between them.
class FSIPack : public Command {
 public:
  FSIPack(class LAMMPS *lmp) : Command(lmp) {}
  void command(int, char **) override;
};

// fsi/set group-ID keyword values ...: initial density of particles, once, before a run.
class FSISet : public Command {
 public:
  FSISet(class LAMMPS *lmp) : Command(lmp) {}
  void command(int, char **) override;
};

}    // namespace LAMMPS_NS

#endif
#endif
