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
FixStyle(fsi/move,FixFSIMove);
// clang-format on
#else

#ifndef LMP_FIX_FSI_MOVE_H
#define LMP_FIX_FSI_MOVE_H

#include "fsi_fields.h"
#include "fsi_part.h"

#include <memory>
#include <string>

namespace LAMMPS_NS {

// Prescribed motion of walls and held solids as a function of time: fix move of LAMMPS for time
// steps that change, with positions at the middle of the step where fix fsi has its forces.

class FixFSIMove : public FSI::FixFields, public FSI::Part {
 public:
  FixFSIMove(class LAMMPS *, int, char **);
  ~FixFSIMove() override;
  int setmask() override
  {
    return FixConst::INITIAL_INTEGRATE | FixConst::PRE_EXCHANGE | FixConst::FINAL_INTEGRATE;
  }
  void init() override;
  void setup_pre_exchange() override;
  void pre_exchange() override {}
  void initial_integrate(int) override;
  void final_integrate() override { move(END); }
  void go_back() override { move(BACK); }
  void reset_dt() override {}
  // velocity of a particle of the group at the end of the step that is going on; false: not known
  // before it is there
  bool velocity_at_end(int i, double *v) const;
  double memory_usage() override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  void set_arrays(int) override;

 private:
  void read_motion(FSI::Keywords &, int narg, char **arg);
  void read_variables(FSI::Keywords &, int narg, char **arg);
  enum Motion { LINEAR, WIGGLE, ROTATE, TRANSROT, VARIABLE };
  int motion;
  double rate[3];    // velocity, or amplitude of wiggle
  double point[3], axis[3], omega;
  bool driven[3];    // components: others go where forces take them
  // variables of displacements and, from VELOCITY on, of velocities; at the end of the step that is
  // going on, but for move(MIDDLE)
  static constexpr int VELOCITY = 3;
  const std::unique_ptr<FSI::Values> given;
  bigint evaluated;     // the last step at whose end they are known
  double origin;        // time at which particles were at
  double **original;    // these positions, not wrapped; less what variables were then
  bool begun;           // the motion, in the setup of a run

  enum When { START, MIDDLE, END, BACK };    // of a run; of a step, from its middle to its start

  std::string text() const;    // as in the command
  bool sets_velocity(int k) const, of_atom(int k) const;
  void refuse_free(const FSI::Discretization &, bool substeps) const;
  void compare_velocities(const double *before) const;
  void compare_velocity(int k, double moved, double dt, double v, double v_end, double round,
                        int i = -1) const;
  void follow(const double *from, double t, double *x, double *v) const;
  void where(int i, double t, double *x, double *v) const;
  void go_on_from_here();
  void turn_back(double *x, double t) const;
  void move(When);
};

}    // namespace LAMMPS_NS

#endif
#endif
