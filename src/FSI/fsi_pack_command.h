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
CommandStyle(fsi/pack,FSIPack);
// clang-format on
#else

#ifndef LMP_FSI_PACK_COMMAND_H
#define LMP_FSI_PACK_COMMAND_H

#include "command.h"

#include <memory>
#include <string>
#include <vector>

namespace LAMMPS_NS {
namespace FSI {
  class Surface;
  struct Discretization;
  struct Ledger;
  struct StepState;
}    // namespace FSI

// fsi/pack body-ID fluid-ID region ID | stl FILE | outline FILE [still group-ID] [steps N]: moves
// the particles of a body and of the fluid around it until both fit the surface between them.

class FSIPack : public Command {
 public:
  FSIPack(class LAMMPS *lmp);
  ~FSIPack() override;
  void command(int, char **) override;

 private:
  const FSI::Discretization *disc = nullptr;
  FSI::StepState *step = nullptr;
  FSI::Ledger *ledger = nullptr;
  std::unique_ptr<FSI::Surface> surface;
  // bits of groups, 0: there is none; still: a part of the body that stays as it is
  int body = 0, fluid = 0, still = 0, filler = 0, gone_at_once = 0, distant = 0;
  double band = 0.0;    // from the surface, in which particles move
  double volume_inside() const, volume_of_still() const;
  double volume_of_cell(const double *middle, const double *sides, double finest) const;
  double part_inside(int i) const;
  void choose(double volume);
  std::vector<char> deepest(int bit, double n) const;
  void pack(int steps);
  std::vector<double> part(const std::vector<double> &mobility, const std::vector<double> &side);
  double keep_off(int i, double side);
  void set_masses(double volume);
  void refuse_bonded() const;
  void remove(const std::string &group);
};

}    // namespace LAMMPS_NS

#endif
#endif
