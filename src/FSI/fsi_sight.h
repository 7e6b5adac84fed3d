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

// What fluids see past bodies and walls that are thinner than the kernel's support (fix fsi thin): a pair of fluid particles that such a
// body is between is no pair; and to each side the body counts as if it went on behind.

#ifndef LMP_FSI_SIGHT_H
#define LMP_FSI_SIGHT_H

#include "pointers.h"

#include <vector>

namespace LAMMPS_NS {
namespace FSI {

  class Scene;

  class Sight : protected Pointers {
   public:
    Sight(LAMMPS *, const Scene &, const std::vector<double> &types);    // whose kernel and spacings are known; past types that are not 0
    void find_bodies();    // where they are when neighbor lists are new: what follows is said of then

    bool near(const double *x) const;      // may one be within the reach of the lists?
    void look_from(const double *x);       // x: for the next two
    bool blocked(const double *y) const;   // is one between x and y? The same from y to x, and on each rank that has one of both
    // The body that a fluid particle has beside it: how deep, counted from one of its particles, and thick it is along its normal
    struct Beside {
      int i, j, type;            // fluid particle, particle of the body
      double normal[3], face, layers;    // from x inwards, known beyond the support, too; distance of the first layer less that of j along it; number of layers
      double behind;                     // part of what is deeper that it hides
    };
    bool beside(int i, Beside &);    // of i, that x is of; false: none within the support. What is seen goes on behind mirror walls afterwards
    static bool opposite(const double *normal, const double *other);    // are they of two sides of a body? A corner has right angles
    // of a half-space of its layers over those that there are, now: force on i, and weight in sums of W, as forces along the face are
    struct Fill {
      double force, weight;
    };
    Fill fill(const Beside &) const;
    double distance(const Beside &) const;    // of i from the first layer, now

    double memory_usage() const;

   private:
    const Scene &scene;
    const std::vector<double> types;
    double reach, from[3];
    double low[3], per_cell;
    int n[3];
    std::vector<int> first;       // of each cell, and behind the last
    struct Place {
      double x[3];
      int i;
    };
    std::vector<Place> places;    // by cell
    struct Seen {
      double x[3], rsq, dx;       // from x; spacing
      int i;
    };
    std::vector<Seen> seen;
    mutable std::vector<double> angles;
    mutable std::vector<Seen> around;
    std::vector<std::vector<Fill>> half_space;    // per type: of its layers by the distance of the first
    Fill beyond(int type, double distance) const;
    void see_images();
    double hidden_behind(const double *normal, double depth) const;
    template <class Visit> void for_near(const double *x, Visit) const;    // until it returns true
  };

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
