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
CommandStyle(fsi/set,FSISet);
// clang-format on
#else

#ifndef LMP_FSI_SET_H
#define LMP_FSI_SET_H

#include "command.h"

#include <string>

namespace LAMMPS_NS {
namespace FSI {
  class BodyForces;
  struct State;
}    // namespace FSI

// fsi/set group-ID keyword values ...: initial density of particles, once, before a run.

class FSISet : public Command {
 public:
  FSISet(class LAMMPS *lmp) : Command(lmp) {}
  void command(int, char **) override;

 private:
  bool set_volume(int i, double volume);
  bool set_density(int i, int what, const std::string &name, double value, const FSI::State &,
                   const FSI::BodyForces &);
};

}    // namespace LAMMPS_NS

#endif
#endif
