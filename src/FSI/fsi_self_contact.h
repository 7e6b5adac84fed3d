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

// A total-Lagrangian body and itself: pairs that contact (fsi_pair_laws.h) acts on, and, without
// contact, parts of it that pass through each other. Its image in a plane of symmetry at which it
// does not end is another body.

#ifndef LMP_FSI_SELF_CONTACT_H
#define LMP_FSI_SELF_CONTACT_H

#include "fsi_bond_store.h"

#include <unordered_map>
#include <vector>

namespace LAMMPS_NS::FSI {
class Cells;

class SelfContact : protected Pointers {
 public:
  SelfContact(LAMMPS *lmp, BondStore &bonds) : Pointers(lmp), bonds(bonds) {}

  double range = 0.0;    // over the spacing; 0: off
  bool tears = false;    // keyword damage
  // Pairs as a local particle i sees them, without a bond, or whose bond may have broken by now,
  // that can come within reach before lists are new. Each belongs to i by half: what one rank
  // sees of its own particles, no other needs to know.
  struct SelfPair {
    int i = 0, j = 0;
    double reach = 0.0;
    bool torn = false;    // neighbors in the reference
  };
  std::vector<SelfPair> pairs;

  void find_pairs();
  // likewise, without newton: i and the images of j in planes, or of i itself
  double range_of_images = 0.0;
  std::vector<std::pair<int, int>> image_pairs;
  // by body: bits of the planes through which it has bonds, or had them
  std::unordered_map<tagint, int> joined;
  bool goes_on(tagint body, int planes) const
  {
    const auto it = joined.find(body);
    return it != joined.end() && (it->second & planes) == planes;
  }
  void find_joined();    // all ranks together
  void find_image_pairs();

  void begin_to_look();    // for parts that pass through each other
  void look();

 private:
  BondStore &bonds;
  bigint next_look = 0;    // never again once they were named
  void find_pairs_of(int i, const std::vector<double> &places, const Cells &);
  double largest_dx() const;
};

}    // namespace LAMMPS_NS::FSI

#endif
