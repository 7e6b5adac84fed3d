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
FixStyle(fsi/wall/mirror,FixFSIWallMirror);
// clang-format on
#else

#ifndef LMP_FIX_FSI_WALL_MIRROR_H
#define LMP_FIX_FSI_WALL_MIRROR_H

#include "fix.h"
#include "fsi_part.h"

#include <array>
#include <string>
#include <vector>

namespace LAMMPS_NS {

// Planar walls and wall segments by image particles. The images act inside the pair loops
// (fsi_walls.h); this fix holds the walls, moves them, sums the force on them, and turns back a
// fluid particle that gets too close.

class FixFSIWallMirror : public Fix, public FSI::Part {
 public:
  FixFSIWallMirror(class LAMMPS *, int, char **);
  int setmask() override { return FixConst::POST_INTEGRATE | FixConst::END_OF_STEP; }
  void init() override;
  void setup(int) override;
  void post_integrate() override;
  void end_of_step() override;
  double compute_scalar() override;
  double compute_array(int, int) override;
  void write_restart(FILE *) override;
  void restart(char *) override;

  std::vector<FSI::Wall> walls;
  std::vector<std::array<double, 3>> force_on;    // on each wall, this rank's part
  FSI::Facts facts() const override;
  void add_walls(FSI::Walls &, std::vector<FSI::WallForce> &) override;
  void begin_state(bool) override;
  void go_back() override;
  void find_idle(const Census &, const Idle &) const override;

 protected:
  virtual std::vector<int> find_outside(const FSI::InnerBox &);    // local fluid particles
  const FSI::Discretization *disc = nullptr;
  const FSI::StepState *step = nullptr;

 private:
  std::vector<double> start;    // positions in the command
  std::string settings(int) const, faces() const;
  void read_walls(int narg, char **arg);
  void add_wall(const std::string &key, double place);
  void add_range(FSI::Wall &, int along, double low, double high) const;
  void check_symmetry() const;
  void check_same(const FSI::Wall &, const FixFSIWallMirror &of) const;
  void warn_of_slip(const std::vector<bool> &slip_given) const;
  double guard = 0.1;    // smallest distance to a wall, in spacings
  bigint reflected = 0;
  struct Turn {    // a reflection of this step
    tagint tag;
    int wall;
    bool turned;    // the velocity, too
    double near;    // the particle's guard
  };
  std::vector<Turn> turns;
  FSI::Ledger *ledger = nullptr;
};

}    // namespace LAMMPS_NS

#endif
#endif
