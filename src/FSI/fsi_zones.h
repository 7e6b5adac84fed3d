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

// Where each level of a fluid from the first finer one on is wanted: nested regions, or distances
// from a body. A finer zone is inside the one before it, by the kernel's support at least.

#ifndef LMP_FSI_ZONES_H
#define LMP_FSI_ZONES_H

#include "pointers.h"

#include <array>
#include <string>
#include <vector>

namespace LAMMPS_NS {
class Region;

namespace FSI {
  struct Discretization;

  class Zones : protected Pointers {
   public:
    Zones(LAMMPS *, const std::string &who);
    void read_regions(const std::vector<std::string> &words);
    void read_distances(const std::vector<std::string> &words);
    void check_number(size_t types) const;

    void init(const Discretization &, const std::vector<int> &types);
    bool moving() const { return can_move; }
    // where they are at the end of this step, and so much beyond them; positions are by that time
    // before it
    void find(const Discretization &, double beyond, double time);
    bool has(int k, int i, double grown) const;    // is i in zone k, from 1 on, grown by that?
    std::string names(int k) const;                // of zones k and k + 1, for errors

   private:
    void find_body();
    const std::string who;
    std::vector<std::string> region_ids;
    std::vector<Region *> regions;
    std::string body_id;
    int body_bit;
    std::vector<double> distances, away;    // of zones; per local particle, from the body
    bool can_move;
    double ahead;                                     // of positions, time
    std::vector<std::array<double, 3>> directions;    // in which a region grows
  };

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
