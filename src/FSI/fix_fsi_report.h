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
#include "fsi_part.h"

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace LAMMPS_NS {
namespace FSI {
  class Population;
  class Profile;
}    // namespace FSI

// At the end of each run, what it cost and how exact it was. Looks and adds up, changes nothing.

class FixFSIReport : public Fix, public FSI::Part {
 public:
  FixFSIReport(class LAMMPS *, int, char **);
  ~FixFSIReport() override;
  int setmask() override { return FixConst::PRE_REVERSE | FixConst::END_OF_STEP; }
  void init() override;
  void setup(int) override { begin(); }
  void pre_reverse(int, int) override;
  void prescribe() override;
  void end_of_step() override;
  void post_run() override;
  double compute_vector(int) override;

 private:
  const std::unique_ptr<FSI::Profile> profile;    // filled by fix fsi, pair styles and walls
  const FSI::Discretization *disc = nullptr;      // of fix fsi
  const FSI::StepState *step = nullptr;
  const FSI::Population *population = nullptr;
  class ComputeFSIEnergy *energy = nullptr;
  FILE *fp = nullptr;    // of rank 0; null: the log

  using Vector = std::array<double, 3>;
  enum Giver { GRAVITY, WALLS, HELD, NGIVER };
  using Impulses = std::array<Vector, NGIVER>;

  bigint first_step = 0, natoms = 0;    // natoms: without what came in through open ends
  double first_time = 0.0;
  struct Gravity {
    const double *g;
    double mass;    // that it moves, all ranks
  };
  std::vector<Gravity> fields;
  bool any_held = false;
  std::vector<int> held;         // atoms that fix fsi does not integrate, local ones first, as of
  bigint listed = -1;            // this build of the neighbor lists
  Vector of_fixes = {};          // what fixes add to the forces on them in this step
  Vector momentum = {};          // at the start, of all ranks
  Impulses impulse = {};         // of this rank
  std::vector<double> ledger;    // at the start
  bigint collected = -1;         // step of what follows
  Vector output = {};

  void begin();
  bigint particles() const;
  Vector force_on_held(int n) const;
  Vector momentum_of_moving(double *scale = nullptr) const;
  struct Balance {
    Vector change, rest;
    Impulses from;
    double scale;
  };
  Balance balance() const;

  std::string lines;    // FSI report name value
  template <class T> void enter_line(const std::string &name, const T &value);
  std::string time_table(double loop);
  std::string what_to_change(double loop, const double *mean, double busiest);
  std::string momentum_table(bool lost);
  std::string energy_table();
};

}    // namespace LAMMPS_NS

#endif
#endif
