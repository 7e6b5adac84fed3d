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

#include <string>

namespace LAMMPS_NS {

// Prescribed motion of walls and held solids as a function of time: fix move of LAMMPS for time steps that change, with
// positions at the middle of the step where fix fsi has its forces.

class FixFSIMove : public FSI::FixFields {
 public:
  FixFSIMove(class LAMMPS *, int, char **);
  ~FixFSIMove() override;
  int setmask() override;
  void init() override;
  void setup_pre_exchange() override;
  void pre_exchange() override {}
  void initial_integrate(int) override;
  void final_integrate() override;
  void reset_dt() override {}
  // velocity of a particle of the group at the end of the step that is going on; false: not known before it is there
  bool velocity_at_end(int i, double *v) const;
  double memory_usage() override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  void set_arrays(int) override;

 private:
  class Words;
  void read_motion(Words &);
  void read_units(Words &);
  enum Style { LINEAR, WIGGLE, ROTATE, TRANSROT, VARIABLE };
  enum Source { FREE, GIVEN, EQUAL, ATOM };
  int style;
  double rate[3];    // velocity, or amplitude of wiggle
  double point[3], axis[3], omega;
  Source source[3], of_velocity[3];    // of a component: FREE goes where forces take it, or as fast as it has to
  std::string position[3], velocity[3];    // variables
  int index[3], velocity_index[3];
  double origin;        // time at which particles were at
  double **original;    // these positions, not wrapped
  double end_speed[3];  // of equal-style variables, at the end of the step
  double **values;      // of atom-style variables: displacements and velocities
  int nmax;

  enum When { START, MIDDLE, END };    // of a run, of a step

  double now() const;
  bool sets_velocity(int k) const { return source[k] != FREE || of_velocity[k] != FREE; }
  void evaluate(double *shift, double *speed, bool everywhere);
  void follow(const double *from, double t, double *x, double *v) const;
  void move(When);
};

}    // namespace LAMMPS_NS

#endif
#endif
