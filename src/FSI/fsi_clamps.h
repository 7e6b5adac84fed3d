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

#ifndef LMP_FSI_CLAMPS_H
#define LMP_FSI_CLAMPS_H

#include "fsi_lammps_access.h"
#include "fsi_part.h"
#include "pointers.h"

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace LAMMPS_NS::FSI {

// Rigid bodies of fix rigid or rigid/small with particles of walls or solids in them. The fix has
// them at the end of the step when forces are found, half a step ahead of the fluid. Here they
// take the position Verlet of all, in sub-steps where total-Lagrangian solids do. The fix keeps
// mass, inertia and state; its particles have the force averaged over the sub-steps, which it
// sums as ever.
class Clamps : public Part, protected Pointers {
 public:
  Clamps(LAMMPS *lmp, const Discretization &disc, const StepState &step) :
      Pointers(lmp), disc(disc), step(step)
  {
  }
  void find();    // before a run
  bool any() const { return !bodies.empty(); }
  bool any_elastic() const { return elastic; }    // are there some that sub-steps act on?
  bool known(const Fix *) const;                  // is it one of theirs?
  // local atom i, in sub-steps
  bool has(int i) const { return elastic && clamp[i]; }

  void start_step() override;                             // before fix rigid moves what it has
  void to_middle();                                       // after that
  void begin_substeps(const std::vector<int> &solids);    // and back to the start of the step
  void drift(double t);
  void kick(double t, const double *const *f);    // f: of one sub-step
  void average(int substeps, double **f) const;
  void take_step();    // from the middle on, by atom->f, if it was not in sub-steps
  void finish();       // atom->f is what fix rigid will see
  void go_back() override;

 private:
  struct Body : BodyNow {
    const RigidBodies *fix;
    double free[6];       // 0: components of force and torque left out
    BodyMotion start;     // of the step
    double middle[3];     // x, in the middle of the step
    double outside[6];    // force and torque of what is no solid, in this step
  };
  struct Member {
    int i, body;    // local atom
  };
  std::vector<std::shared_ptr<RigidBodies>> fixes;    // of these bodies
  std::vector<Body> bodies;
  std::map<std::pair<const RigidBodies *, tagint>, int> number;    // of a body, by fix and ID
  std::vector<Member> members, clamps;                             // all particles; those of solids
  std::vector<char> clamp;                                         // is an atom one?
  std::vector<double> impulse;    // of clamps, over the last sub-steps' length
  std::vector<double> sums;       // force and torque of each body
  const Discretization &disc;
  const StepState &step;
  bool elastic = false;
  std::string expected_of(const RigidBodies &) const;
  void refuse_new_ids(const RigidBodies &) const;
  void find_members();
  void follow(Body &) const;
  void drift(Body &, double t) const;
  void kick(Body &, double t, const double *force_and_torque) const;
  void arm(const Member &, double *) const;
  void place(const std::vector<Member> &) const;
  void sum(const std::vector<Member> &, const double *const *f, bool whole);
  void add_own(const Body &, double *force_and_torque) const;
  const Body *find(const RigidBodies &, tagint id) const;    // null: it is none of these
  template <class Use> void with_states(Use);
  void store() const;
  void to_start();
  void follow_boundary();
};

}    // namespace LAMMPS_NS::FSI

#endif
