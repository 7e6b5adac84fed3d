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

#include "fsi_frame.h"

#include "atom.h"
#include "atom_vec.h"
#include "domain.h"
#include "fsi_hub.h"
#include "fsi_part.h"
#include "math_extra.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

using namespace LAMMPS_NS;
using namespace FSI;

// Not where something else than particles moves relative to the places: walls, the box. Open ends
// make and delete particles when lists are new, before these have gone half a skin. Package KOKKOS
// has its own places.
void Frame::init()
{
  left = 0.0;
  allowed = !lmp->kokkos && neighbor->dist_check && !domain->box_change && !has_open_ends(lmp);
  for (const auto &wall : walls.wall) allowed = allowed && wall.velocity[wall.axis] == 0.0;
}

void Frame::find_velocity()
{
  static constexpr double GAIN = 0.8;    // of the highest speed: else it is not worth the while
  double local[7] = {}, all[7];          // highest, highest of the negative; of the square
  std::fill_n(local, 6, -INFINITY);
  for (int i = 0; i < atom->nlocal; i++) {
    const double *const v = atom->v[i];
    for (int d = 0; d < 3; d++) {
      local[d] = std::max(local[d], v[d]);
      local[3 + d] = std::max(local[3 + d], -v[d]);
    }
    local[6] = std::max(local[6], MathExtra::lensq3(v));
  }
  MPI_Allreduce(local, all, 7, MPI_DOUBLE, MPI_MAX, world);
  double range = 0.0;
  for (int d = 0; d < 3; d++) {
    velocity[d] = 0.5 * (all[d] - all[3 + d]);
    range += 0.25 * (all[d] + all[3 + d]) * (all[d] + all[3 + d]);
  }
  left = std::sqrt(range) < GAIN * std::sqrt(all[6]) ? 0.5 * neighbor->skin : 0.0;
}

void Frame::move()
{
  if (!allowed) return;
  if (neighbor->ago == 0) find_velocity();
  if (left <= 0.0) return;
  const double dt = update->dt;
  left -= dt * MathExtra::len3(velocity);
  if (left < 0.0) return;
  double *const *const from = neighbor->get_xhold();
  for (int i = 0; i < atom->nlocal; i++)
    for (int d = 0; d < 3; d++) from[i][d] += dt * velocity[d];
}

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
