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
FixStyle(fsi/report,FixFSIReport);
// clang-format on
#else

#ifndef LMP_FIX_FSI_REPORT_H
#define LMP_FIX_FSI_REPORT_H

#include "fix.h"
#include "fsi_limits.h"
#include "fsi_part.h"
#include "fsi_profile.h"

#include <array>
#include <string>
#include <vector>

namespace LAMMPS_NS {

// At the end of each run, what it cost and how exact it was. Looks and adds up, changes nothing.

class FixFSIReport : public Fix, public FSI::Part {
 public:
  FixFSIReport(class LAMMPS *, int, char **);
  ~FixFSIReport() override;
  int setmask() override;
  void init() override;
  void setup(int) override;
  void end_of_step() override;
  void post_run() override;
  double compute_vector(int) override;

  FSI::Profile *counters() override { return &profile; }
  FSI::Profile profile;    // filled by fix fsi, pair styles and walls

 private:
  class FixFSI *fix_fsi;
  class ComputeFSIEnergy *energy;
  int every;
  FILE *fp;    // of rank 0; null: the log

  bigint first_step, natoms,
      flowed;    // flowed: natoms is with so many that came in through open ends
  double first_time;
  int counted;                           // steps whose messages were
  double ghost_bytes, ghost_messages;    // of positions, velocities and forces, in those

  using Vector = std::array<double, 3>;
  struct Gravity {
    const double *g;
    double mass;    // of its group, all ranks
  };
  std::vector<Gravity> fields;
  bool any_held;
  std::vector<int> held;    // local atoms that fix fsi does not integrate, as of
  bigint listed;            // this build of the neighbor lists
  Vector momentum, by_gravity, by_walls,
      by_held;                   // at the start, of all ranks; impulses, the last two of this rank
  std::vector<double> ledger;    // at the start

  bigint collected;    // step of what follows
  Vector output;

  void begin();
  Vector momentum_of_moving(double *scale = nullptr) const;
  Vector all_ranks(const Vector &) const;
  struct Balance {
    Vector change, gravity, walls, held, rest;
    double scale;
  };
  Balance balance() const;

  std::string lines;    // FSI report name value
  template <class T> void enter_line(const std::string &name, const T &value);
  std::string time_table(double loop);
  std::string cost_table(double loop);
  bigint through_open_ends() const;
  std::string momentum_table(bool lost);
  std::string energy_table();
};

}    // namespace LAMMPS_NS

#endif
#endif
