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

// What fluids see past bodies and walls that are thinner than the kernel's support (fix fsi thin):
// of a pair of fluid particles that such a body is between only a part is left, none of it where
// the body goes on to all sides, all of it at a free edge; and to each side the body counts as if
// it went on behind. Nothing is left of a pair that a segment of a mirror wall divides. A function
// of where particles are in a step (theory.rst).

#ifndef LMP_FSI_SIGHT_H
#define LMP_FSI_SIGHT_H

#include "fsi_rows.h"
#include "pointers.h"

#include <vector>

namespace LAMMPS_NS::FSI {

struct Discretization;
struct Walls;

class Sight : protected Pointers {
 public:
  // whose kernel and spacings are known; past types that are not 0
  Sight(LAMMPS *lmp, const Discretization &disc, const Walls &walls,
        const std::vector<double> &types) :
      Pointers(lmp),
      disc(disc), walls(walls), types(types)
  {
  }
  void tabulate();         // when the fluids' levels are known: for backfill()
  void find_bodies();      // when neighbor lists are new
  void follow_bodies();    // to where they are; what follows is said of then

  // may a thin one, or a segment, come within the support before lists are built again?
  bool near(const double *x) const;
  // x: for the next four; reach: the largest support that they ask for, at most that of the
  // coarsest fluid; slack: look so much farther, by the skin at most
  void look_from(const double *x, double reach, double slack = 0.0);
  // anything of y, if each distance may change by slack?
  bool may_hide(const double *y, double slack) const;
  // part of what is at y, to a pair of this support, as far as that matters. The same from y to
  // x, and on each rank that has one of both
  double visible(const double *y, double cut) const;
  // Of a half-space of layers over those of the body beside x, to a fluid particle of this level:
  // forces, and weights in sums of W, as forces along the face are; 1 where there is none
  struct Backfill {
    double force = 0.0, weight = 0.0;
  };
  Backfill backfill(size_t level) const;

  double memory_usage() const { return bytes_of(places, seen, first); }

 private:
  const Discretization &disc;
  const Walls &walls;    // at the time of the positions
  const std::vector<double> types;
  double low[3] = {}, per_cell = 0.0;
  int n[3] = {};
  std::vector<int> first;    // of each cell, and behind the last
  struct Place {
    double x[3] = {};
    int i = 0;
    bool thin = false;
  };
  std::vector<Place> places;           // by cell
  double from[3] = {}, reach = 0.0;    // what is seen is within that
  struct Seen {
    double x[3], rsq;     // from x
    double dx, volume;    // spacing, of its cell
    int type, mirrors;    // bits of the walls that it has images in
    bool thin;
  };
  std::vector<Seen> seen;
  // per level and type: of its layers by the distance of the first
  std::vector<std::vector<Backfill>> half_space;
  std::vector<double> tabulated;    // spacings of levels
  Backfill beyond(size_t level, int type, double distance) const;
  double left_of(const double *y, double cut) const;
  double way_to(const double *y, double (&d)[3]) const;    // from x; its square
  // distance of the first layer along the normal, which points to it, and how thick the body is
  struct Face {
    int type = 0;
    double normal[3] = {}, distance = 0.0, thickness = 0.0;
  };
  bool find_face(size_t level, const Seen &nearest, Face &) const;
  Backfill backfill(size_t level, const Face &) const;
  bool counts(int type) const;
  void see_images();
  template <class Visit> void for_near(const double *x, Visit) const;    // until it returns true
};

}    // namespace LAMMPS_NS::FSI

#endif
