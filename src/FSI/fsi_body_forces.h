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

// Body forces per mass: each fix gravity as it acts in this step.

#ifndef LMP_FSI_BODY_FORCES_H
#define LMP_FSI_BODY_FORCES_H

#include "fsi_material.h"
#include "pointers.h"

#include <array>
#include <vector>

namespace LAMMPS_NS {
class Fix;

namespace FSI {

  class BodyForces : protected Pointers {
   public:
    explicit BodyForces(LAMMPS *lmp) : Pointers(lmp) {}
    void find();                                  // before a run
    void evaluate(const std::vector<State> &);    // at the time of the step
    // Energy that this rank's particles have lost because fields changed in the last evaluate(),
    // taken in the middle between two steps. Those of the group are half a step further.
    double work(const std::vector<State> &, int groupbit) const;
    std::array<double, 3> on(int i) const;    // atom i, over its mass
    double potential(int i) const;            // its gravitational energy, where it is now

    struct Field {
      Fix *fix = nullptr;
      int mask = 0;    // of its group; 0 if it is disabled
      bool varies = false;
      double g[3] = {}, change[3] = {};
    };
    std::vector<Field> all;
    std::vector<std::array<double, 3>> of_type;    // sum of those that act on all its particles

   private:
    void find_whole_types(const std::vector<State> &);
    std::vector<int> acts_on_all, warned;    // each field, type by type
  };

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
