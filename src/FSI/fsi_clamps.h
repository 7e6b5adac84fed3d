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

#include "pointers.h"

#include <string>
#include <unordered_map>
#include <vector>

namespace LAMMPS_NS {
class Fix;

namespace FSI {

  class Scene;

  // Rigid bodies of fix rigid or rigid/small with particles of total-Lagrangian solids in them,
  // which take sub-steps: the rigid body takes them, too, with the same position Verlet. The fix
  // keeps mass, inertia and state, and has them at the end of the step; its particles have the
  // force averaged over the sub-steps, which it sums as ever.
  class Clamps : protected Pointers {
   public:
    explicit Clamps(LAMMPS *lmp) : Pointers(lmp) {}
    void find(const Scene &, const Fix *fix_fsi);    // before a run
    void clear() { bodies.clear(); }
    bool any() const { return !bodies.empty(); }
    bool known(const Fix *) const;    // is it one of theirs?
    // local atom i, in sub-steps
    bool has(int i) const { return any() && clamp[i]; }

    void begin();        // of the step, before fix rigid moves what it has
    void to_middle();    // after that
    void begin_substeps(const std::vector<int> &solids);    // and back to the start of the step
    void drift(double t);
    void kick(double t, const double *const *f);    // f: of one sub-step
    void average(int substeps, double **f) const;
    void take_step();    // without sub-steps: from the middle on, by atom->f
    void finish();       // atom->f is what fix rigid will see
    void go_back();      // from the middle of the step to its start

   private:
    struct Motion {
      double x[3], v[3], q[4], L[3];
    };
    struct State : Motion {
      tagint id;    // index in fix rigid, bodytag in fix rigid/small
      double mass, inertia[3];
    };
    struct Body : State {    // state of now
      Fix *fix;
      bool small;
      double free[6];                          // 0: components of force and torque left out
      const double *const *displace;           // of atoms, from the center in the body's axes
      const imageint *image;                   // of atoms
      Motion start;                            // of the step
      double middle[3];                        // x, in the middle of the step
      double ex[3], ey[3], ez[3], omega[3];    // follow from the orientation
      double outside[6];                       // force and torque of what is no solid, in this step
    };
    struct Member {
      int i, body;    // local atom
    };
    std::vector<Body> bodies;
    std::vector<Member> members, clamps;    // all particles; those of solids
    std::vector<char> clamp;                // is an atom one?
    std::vector<double> impulse;            // of clamps, over the last sub-steps' length
    std::vector<double> sums;               // force and torque of each body
    const Fix *mover = nullptr;
    void refuse(Fix *) const;
    void refuse_new_ids(Fix *) const;
    void find_members();
    void follow(Body &) const;
    void drift(Body &, double t) const;
    void kick(Body &, double t, const double *force_and_torque) const;
    void arm(const Member &, double *) const;
    tagint id_of(const Body &, int i) const;
    void place(const std::vector<Member> &) const;
    void sum(const std::vector<Member> &, const double *const *f);
    void add_own(const Body &, double *force_and_torque) const;
    std::vector<State> states(Fix *) const;    // of all its bodies
    template <class Use> void of_fixes(Use) const;
    std::unordered_map<tagint, size_t> entries(size_t first, size_t last) const;
    template <class Use> void with_states(Use);
    void store() const;
    void store_large(const Body &) const;
    void to_start();
    void follow_boundary();
  };

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
