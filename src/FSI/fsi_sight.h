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
    Sight(LAMMPS *, const Scene &);
    void init();           // when kernel and spacings are known
    void find_bodies();    // where they are when neighbor lists are new: what follows is said of then

    bool near(const double *x) const;      // may one be within the reach of the lists?
    void look_from(const double *x);       // x: for the next two
    bool blocked(const double *y) const;   // is one between x and y? The same from y to x, and on each rank that has one of both
    // of a half-space of the body over what there is of it: force of its layers on a fluid particle at x
    double fill() const;

    double memory_usage() const;

   private:
    const Scene &scene;
    double reach, from[3];
    double low[3], per_cell;
    int n[3];
    std::vector<int> first;       // of each cell, and behind the last
    struct Place {
      double x[3];
      int type;
    };
    std::vector<Place> places;    // by cell
    struct Seen {
      double x[3], rsq, dx;       // from x; spacing
      int type;
    };
    std::vector<Seen> seen;
    mutable std::vector<double> angles;
    mutable std::vector<Seen> around;
    std::vector<std::vector<double>> layers;    // per type: force of a layer by its distance
    double force_of_layer(int type, double distance) const;
    template <class Visit> void for_near(const double *x, Visit) const;    // until it returns true
  };

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
