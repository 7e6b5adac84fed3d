/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   Copyright (2003) Sandia Corporation.  Under the terms of Contract
   DE-AC04-94AL85000 with Sandia Corporation, the U.S. Government retains
   certain rights in this software.  This software is distributed under
   the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "fsi_order.h"

#include "atom.h"
#include "atom_vec.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

using namespace LAMMPS_NS;

// By cells of space, by ID in each: what is near in space is near in memory, whatever IDs are like.
// Cells do not depend on the box, whose bounds may follow the particles.
void FSI::sort_by_place(Atom *atom, double width)
{
  const int n = atom->nlocal;
  if (n == atom->nmax) atom->avec->grow(0);    // room for the atom in hand
  struct Place {
    std::array<bigint, 3> cell;    // slowest first
    tagint tag;
    int i;
    bool operator<(const Place &other) const
    {
      return cell != other.cell ? cell < other.cell : tag < other.tag;
    }
  };
  const double per_length = 1.0 / width;
  std::vector<Place> places(n);
  for (int i = 0; i < n; i++) {
    const double *const x = atom->x[i];
    places[i] = {{(bigint) std::floor(x[2] * per_length), (bigint) std::floor(x[1] * per_length),
                  (bigint) std::floor(x[0] * per_length)},
                 atom->tag[i],
                 i};
  }
  std::sort(places.begin(), places.end());
  std::vector<int> order(n);    // new place i gets the atom that is now at order[i]
  for (int i = 0; i < n; i++) order[i] = places[i].i;
  for (int start = 0; start < n; start++) {
    if (order[start] == start) continue;
    atom->avec->copy(start, n, 0);
    int i = start;
    while (order[i] != start) {
      atom->avec->copy(order[i], i, 0);
      const int next = order[i];
      order[i] = i;
      i = next;
    }
    atom->avec->copy(n, i, 0);
    order[i] = i;
  }
}
