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
FixStyle(fsi/dt,FixFSIDt);
// clang-format on
#else

#ifndef LMP_FIX_FSI_DT_H
#define LMP_FIX_FSI_DT_H

#include "fix.h"
#include "fsi_part.h"

#include <memory>
#include <string>
#include <vector>

namespace LAMMPS_NS {
namespace FSI {
  class Limits;
}    // namespace FSI

// Time step, and number of sub-steps of total-Lagrangian solids, from what the particles do.

class FixFSIDt : public Fix, public FSI::Part {
 public:
  FixFSIDt(class LAMMPS *, int, char **);
  ~FixFSIDt() override;
  int setmask() override { return FixConst::END_OF_STEP | FixConst::POST_RUN; }
  void init() override;
  void setup(int) override;
  void end_of_step() override;
  void post_run() override;
  double compute_scalar() override;
  double compute_vector(int) override;
  void write_restart(FILE *) override;
  void restart(char *) override;

  void stop_at(double time);    // the next run

  void start_step() override;
  FSI::Facts facts() const override;
  void find_idle(const Census &, const Idle &) const override;

 private:
  enum CheckAction { NO_CHECK, WARN, STOP };
  const FSI::Discretization *disc = nullptr;    // of fix fsi
  FSI::StepState *step = nullptr;

  FSI::Keywords keywords;
  int interval;
  double cfl, of_fluid, of_solid, low, high, growth;
  double end;          // of the run
  bool cut = false;    // it was
  int automatic;       // number of sub-steps
  int check;

  const std::unique_ptr<FSI::Limits> limits;    // with the factors
  std::vector<double> limit;                    // of each cause: of step and sub-steps together
  double target;                                // smallest of these and of the bound
  int cause, ruling = -1;            // what sets the next step; last one that was printed
  double dt = 0.0, next_dt = 0.0;    // of the last step taken, 0 = none; from the next step on
  int next_substeps = 0;
  int warned = 0;    // bits of causes
  bool restored = false;

  void find_outside() const;
  void find_limits(double most);
  void choose(double most);
  void approach_end();
  void report();
  void set_step(double, const Fix *before) const;
  std::string name(int) const;
};

}    // namespace LAMMPS_NS

#endif
#endif
