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
FixStyle(fsi/wall/particle,FixFSIWallParticle);
// clang-format on
#else

#ifndef LMP_FIX_FSI_WALL_PARTICLE_H
#define LMP_FIX_FSI_WALL_PARTICLE_H

#include "fsi_fields.h"
#include "fsi_part.h"

#include <memory>
#include <vector>

namespace LAMMPS_NS {

// Walls of any shape, made of particles (Adami, Hu & Adams, J. Comput. Phys. 231 (2012) 7057): a
// wall particle's pressure, and for no slip its velocity in viscous forces, are extrapolated from
// the fluid around it. The pressure is kept as the density that has it, so the pair loops treat the
// particle as fluid. What moves the particles (fix move, fix rigid, nothing) is of no concern here:
// their acceleration is that of their velocity.

class FixFSIWallParticle : public FSI::FixFields, public FSI::Part {
 public:
  FixFSIWallParticle(class LAMMPS *, int, char **);
  ~FixFSIWallParticle() override;
  int setmask() override { return FixConst::POST_RUN; }
  void init() override;
  void post_run() override;
  double compute_scalar() override;
  double compute_vector(int) override;
  double memory_usage() override;

  FSI::Facts facts() const override { return FSI::only(&FSI::Facts::particle_walls); }

  int slip, pressure;    // how pressure is extrapolated
  void set_fields(FSI::Discretization &) override;
  void end_state(bool advance) override;    // the fluid's densities and the positions are those at
                                            // which forces are computed
  void tally_fluids(double sign) override;
  void undo_advance() override;

 private:
  double guard;    // distance of a fluid particle below which it is pushed off, in spacings; < 0:
                   // as the fluid has tension or not
  bool linear = false;           // extrapolates with the gradient, not a mean
  double fluid_density = 0.0;    // at rest
  bool mixed = false;            // several fluids differ in it: each wall particle has a mean
  bool several = false;          // spacings of fluids: likewise
  std::vector<class FixFSIMove *> movers;
  // velocity at the last step, of light floats a mean of the last ones, and whether there was one
  double **before = nullptr;
  int floats = 0;                   // groups of rigid bodies
  std::vector<double> of_newest;    // by type: part of the newest velocity in that of its floats
  std::vector<double> old;          // the same of members at the start of this one
  double **at_end = nullptr;        // velocity at the end of a run
  void follow_commands();
  const FSI::Discretization *disc = nullptr;
  FSI::StepState *step = nullptr;
  std::vector<int> members;                   // the group's particles, local and ghost
  const std::unique_ptr<FSI::Swaps> swaps;    // theirs
  std::unique_ptr<FSI::Message> to_ghosts, from_ghosts;
  std::vector<int> types_of_members();
  void enter_states(std::vector<FSI::State> &, const std::vector<int> &types);
  std::vector<int> entered;    // types, as above
  // f(wall particle, fluid particle or its image, distance between and its square, its mirror) of
  // those within a distance, if that is not beyond the kernel's support
  template <class F> void for_pairs(size_t level, double cutsq, F f) const;
  void sum_up();
  // per atom, over the fluid and its images: of W, p W, rho (x_wall - x) W, v W; with linear of
  // d W, d d W, p d W, d = x_wall - x; with turns of d W
  double **sum = nullptr;
  int nsum = 0, first_moment, first_stiffness, of_densities, of_spacings;
  bool turns = false;              // walls that fluid sticks to may
  std::vector<int> first, near;    // of each local member, where its neighbors in the wall begin;
                                   // these
  void find_near();
  void find_floats();
  double newest(int i) const;
  void find_acceleration(int i, double *a) const;
  void add_turn(int m, const double *way, double *v) const;
  double force_on[3] = {};    // this group, this rank's part

  template <int D>
  double beyond_mean(const double *moments, double W, double p, double rho, double dx,
                     const double *a) const;
};

}    // namespace LAMMPS_NS

#endif
#endif
