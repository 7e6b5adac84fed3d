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
FixStyle(fsi/stream,FixFSIStream);
// clang-format on
#else

#ifndef LMP_FIX_FSI_STREAM_H
#define LMP_FIX_FSI_STREAM_H

#include "fix.h"
#include "fsi_part.h"

#include <memory>
#include <string>
#include <vector>

namespace LAMMPS_NS {

// Brings the fluid of a zone to a given velocity, and, where asked, its density to the zone's mean:
// with one rate for both a sound wave that passes decays without a reflection.

class FixFSIStream : public Fix, public FSI::Part {
 public:
  FixFSIStream(class LAMMPS *, int, char **);
  ~FixFSIStream() override;
  int setmask() override { return FixConst::POST_FORCE; }
  void init() override;
  void setup(int) override;
  void post_force(int) override;
  double compute_scalar() override;
  double compute_vector(int) override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  double memory_usage() override;

  Rank rank() const override { return STREAMS; }
  void advance(bool) override;    // density, after that of the fluid
  void end_state(bool) override;

 private:
  FSI::Keywords keywords;
  std::string region_id;
  const std::unique_ptr<FSI::Values> velocity;
  int along;                       // axis
  double rate, density_rate;       // 1/time, in the middle of the zone
  double low = 0.0, high = 0.0;    // ends of the zone along the axis
  class Region *region = nullptr;
  const FSI::Discretization *disc = nullptr;
  FSI::StepState *step = nullptr;
  FSI::Ledger *ledger = nullptr;
  bigint last_step = -1;    // of the weights
  struct Member {
    int i = 0;
    double weight = 0.0;    // 0 outside of the zone and at its ends, 1 in its middle
  };
  std::vector<Member> zone;    // local fluid in and near it, as of the last list
  // those of this step, under implicit viscosity, and are there any on some rank?
  size_t first_pull = 0, end_of_pulls = 0;
  bool foreseen = false;
  double given[4] = {};    // force on the fluid and its power, this rank's part
  double work = 0.0;       // since the fix was defined, likewise

  void find_zone();
  double in_zone(int i) const;
  double target(int d, int i) const;
  void push(int i, int d, double f);
  void find_weights();
};

}    // namespace LAMMPS_NS

#endif
#endif
