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
#include "fsi_stop.h"

#include <string>

namespace LAMMPS_NS {

// Limits of what fix fsi itself (fsi_check.h) does not look at: stops a run that goes wrong, or
// warns, and says what went wrong where.

class FixFSIWatch : public Fix, public FSI::Part {
 public:
  FixFSIWatch(class LAMMPS *, int, char **);
  void find_idle(const Census &, const Idle &) const override;
  int setmask() override { return FixConst::POST_FORCE; }
  void init() override;
  void setup(int) override;
  void post_force(int) override;
  // checks that found something so far; what the last one saw
  double compute_scalar() override { return static_cast<double>(violations); }
  double compute_vector(int k) override { return seen[FSI::DISTANCE + k]; }

 private:
  class FixFSI *fix_fsi;
  class PairFSISolidTL *solid_tl;
  FSI::Stop halt;

  int interval;
  double limit[FSI::NTROUBLE];    // BIG, for DISTANCE 0, = off
  int warn;
  bool distances;    // found, whether there is a limit or not
  bool loses;        // does the script say how many?

  FSI::Finding worst[FSI::NTROUBLE];    // on this rank
  double total[FSI::NTROUBLE];          // of all ranks: ENERGY, LOST, REFLECTED
  double seen[FSI::NTROUBLE];           // of all ranks at the last check: the output
  double energy_before, reflected_before;
  int warned;    // bits of quantities
  bigint violations;

  void clear();
  void enter(FSI::Trouble, int i, double value, int j = -1);
  double allowed(FSI::Trouble) const;
  void look_at_particles(double &kinetic, double &little);
  void look_at_pairs();
  void look(FSI::Stop::When);
  void judge(FSI::Stop::When);
};

}    // namespace LAMMPS_NS

#endif
#endif
