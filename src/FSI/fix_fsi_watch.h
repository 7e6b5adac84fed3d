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

#include <string>
#include <vector>

namespace LAMMPS_NS {

// Stops a run that goes wrong while its state is still finite, and says what went wrong where.

class FixFSIWatch : public Fix {
 public:
  FixFSIWatch(class LAMMPS *, int, char **);
  int setmask() override;
  void init() override;
  void setup(int) override;
  void post_force(int) override;
  void end_of_step() override;
  double compute_scalar() override;
  double compute_vector(int) override;

  double nearest;    // smallest distance over spacing of all checks so far; for fix fsi/report, which sets it back

 private:
  enum Quantity { FINITE, MACH, DISTANCE, DENSITY, COURANT, ENERGY, LOST, REFLECTED, NQUANTITY };
  enum When { START, MIDDLE, END };    // of a step: where positions are
  struct Finding {
    double value, x[3];
    tagint tag, other;    // 0 = no particle
    int type;
  };
  class FixFSI *hub;

  int interval;
  double limit[NQUANTITY];    // BIG, for DISTANCE 0, = off
  int warn;
  std::string restart_file, dump_file;
  double speed_sq_of(int type) const;
  std::vector<double> speed_sq;    // per type: largest square of the speed
  double lightest;                 // mass of this rank's particles

  Finding worst[NQUANTITY];     // on this rank
  double total[NQUANTITY];      // of all ranks: ENERGY, LOST, REFLECTED
  double seen[NQUANTITY];       // of all ranks at the last check: the output
  double energy_before, reflected_before;
  std::vector<double> kept, kept_walls;    // of post_force, if there are sub-steps
  int warned;    // bits of quantities
  bigint violations;

  void clear();
  void enter(Quantity, int i, double value, int j = -1);
  void check_speed(double kick);
  void check_rest();
  void judge(When);
  std::string describe(Quantity, Finding &);
  void stop(Quantity, When);
  void write_neighbours(const Finding &);
};

}    // namespace LAMMPS_NS

#endif
#endif
