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
CommandStyle(fsi/displace,FSIDisplace);
// clang-format on
#else

#ifndef LMP_FSI_DISPLACE_H
#define LMP_FSI_DISPLACE_H

#include "command.h"

#include <vector>

namespace LAMMPS_NS {
namespace FSI {
  struct Discretization;
}

// fsi/displace fluid-group-ID body-group-ID: takes out the fluid in whose place a body is.

class FSIDisplace : public Command {
 public:
  FSIDisplace(class LAMMPS *lmp) : Command(lmp) {}
  void command(int, char **) override;

 private:
  const class NeighList *neighbors();
  template <class IsFluid, class IsBody>
  std::vector<double> find_covered(const FSI::Discretization &, const class NeighList &, IsFluid,
                                   IsBody, double *sum) const;
};

}    // namespace LAMMPS_NS

#endif
#endif
