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
FixStyle(fsi/inlet,FixFSIInlet);
FixStyle(fsi/outlet,FixFSIInlet);
// clang-format on
#else

#ifndef LMP_FIX_FSI_INLET_H
#define LMP_FIX_FSI_INLET_H

#include "fsi_fields.h"
#include "fsi_part.h"

#include <memory>
#include <string>
#include <vector>

namespace LAMMPS_NS {
namespace FSI {
  class NumberDensity;
  class OpenEnd;
}    // namespace FSI

// An open end of the fluid: a plane, and behind it a buffer of particles whose velocity or pressure
// is prescribed, and the other one that of the fluid at the plane. Here is the order of a step;
// what is done in it is in OpenEnd, PlaneFit, Buffer, Absorber and Fullness. Inlets and outlets are
// the same but for defaults.

class FixFSIInlet : public FSI::FixFields, public FSI::Part {
 public:
  FixFSIInlet(class LAMMPS *, int, char **);
  ~FixFSIInlet() override;
  int setmask() override { return FixConst::PRE_EXCHANGE; }
  void init() override;
  void setup_pre_exchange() override;
  void pre_exchange() override;
  double compute_scalar() override;
  double compute_vector(int) override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  double memory_usage() override;

  Rank rank() const override { return OPEN_ENDS; }
  void start_step() override;       // places of particles that are to be made
  void advance(bool) override;      // density of the buffer, when the fluid has its own
  void end_state(bool) override;    // is there as much fluid as there is room?
  void prescribe() override;        // velocity of the buffer

  bool holds(const double *x) const;    // is a place in the buffer?

 private:
  struct Members;
  const std::unique_ptr<Members> members;
  FSI::OpenEnd &end;
  std::string name;    // of what another one goes on with
  double given_length;
  bool driven = false;    // has an open end of the scene a given velocity?
  bool filled = false, warned_of_far = false;
  // plane and length of its buffer in the last run; is that one of a restart file?
  std::vector<double> made;
  bool of_file = false;
  const FSI::Discretization *disc = nullptr;
  FSI::StepState *step = nullptr;
  FSI::Ledger *ledger = nullptr;
  FSI::Ghosts *ghosts = nullptr;
  const FSI::NumberDensity *number_density = nullptr;

  FSI::Record record() const;
  void goes_on(const FSI::Record &);
  void read_given(const std::string *velocity, const std::string &pressure, const char *face);
  void check_made() const;
  void check_far();
  void hold_shift(int i, double inside);
};

}    // namespace LAMMPS_NS

#endif
#endif
