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

#ifdef FIX_CLASS
// clang-format off
FixStyle(fsi/watch,FixFSIWatch);
// clang-format on
#else

#ifndef LMP_FIX_FSI_WATCH_H
#define LMP_FIX_FSI_WATCH_H

#include "fix.h"
#include "fsi_part.h"

#include <memory>
#include <vector>

namespace LAMMPS_NS {
namespace FSI {
  class Stop;
}

// Limits of what fix fsi itself (fsi_check.h) does not look at: stops a run that goes wrong, or
// warns, and says what went wrong where.

class FixFSIWatch : public Fix, public FSI::Part {
 public:
  FixFSIWatch(class LAMMPS *, int, char **);
  ~FixFSIWatch() override;
  void find_idle(const Census &, const Idle &) const override;
  int setmask() override { return FixConst::POST_FORCE; }
  void init() override;
  void setup(int) override;
  void post_force(int) override;
  // checks that found something so far; what the last one saw
  double compute_scalar() override { return static_cast<double>(violations); }
  double compute_vector(int k) override;

 private:
  struct Row;
  std::vector<Row> rows;    // what is watched, in the order of the output
  std::unique_ptr<FSI::Stop> halt;
  const FSI::Discretization *disc = nullptr;
  const FSI::StepState *step = nullptr;

  int interval, warn;
  bool loses;                     // does the script say how many?
  double energy_before = -1.0;    // kinetic
  bigint violations = 0;

  void enter(int row, int i, double value, int j = -1);
  void look_at_particles(double &kinetic, double &little);
  void look_at_pairs();
  void look(bool at_start);
  void judge(Row &, bool at_start);
};

}    // namespace LAMMPS_NS

#endif
#endif
