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

// Planes of symmetry of solids (fix fsi/wall/mirror, keyword symmetry): the images of particles
// that others meet across a plane. They stand behind all local and ghost atoms, so that loops over
// bonds or pairs take them for particles. What such a loop leaves on an image goes to its original,
// mirrored, and the plane takes the difference: a half has the forces of the whole.

#ifndef LMP_FSI_IMAGES_H
#define LMP_FSI_IMAGES_H

#include "fsi_rows.h"
#include "fsi_walls.h"

#include <algorithm>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace LAMMPS_NS::FSI {

class Images {
 public:
  // with the bits of planes: only its partner counts, since a particle and its own image are a
  // pair of its own, or since another rank does the same for the original
  static constexpr int HALF = 1 << 30;
  Walls planes;                     // in the order of their names
  std::vector<WallForce> forces;    // on each of them
  bool joins(const int *mask, int i) const { return mask[i] & group; }

  void clear_planes()
  {
    planes = Walls();
    forces.clear();
    group = 0;
  }
  // of walls those that are planes of symmetry
  void find_planes(const Walls &walls, const std::vector<WallForce> &forces_on)
  {
    clear_planes();
    for (const int axis : {0, 1, 2})
      for (const double side : {1.0, -1.0})
        for (size_t k = 0; k < walls.wall.size(); k++) {
          const Wall &w = walls.wall[k];
          if (!w.joins || w.axis != axis || w.side != side) continue;
          planes.wall.push_back(w);
          forces.push_back(forces_on[k]);
          group |= w.joins;
        }
    planes.find_reflections();
  }

  // images of now: the one of atom j in the planes with these bits, of numbers from first on
  void begin(int first_)
  {
    first = first_;
    all.clear();
    number.clear();
  }
  int find(int j, int bits)
  {
    const auto found = number.emplace((int64_t) j << 32 | bits, first + (int) all.size());
    if (found.second)
      for (const auto &s : planes.reflections)
        if (s.mask == (bits & ~HALF)) all.push_back({j, bits, Mirror(planes, s)});
    return found.first->second;
  }
  bool any() const { return !all.empty(); }
  int end() const { return first + (int) all.size(); }
  int original(int j) const { return any() && j >= first ? all[j - first].of : j; }
  bool mirrors(int j, int axis) const
  {
    return any() && j >= first && all[j - first].mirror.sign[axis] < 0.0;
  }
  // every image: call(number, original, its Mirror, whether it counts)
  template <class Call> void for_each(Call call) const
  {
    for (size_t k = 0; k < all.size(); k++)
      call(first + (int) k, all[k].of, all[k].mirror, !(all[k].bits & HALF));
  }
  // of atoms and images
  void give_types(const int *type, std::vector<int> &types) const
  {
    types.assign(type, type + first);    // LAMMPS' array may end there
    for (const Image &image : all) types.push_back(type[image.of]);
  }
  // f of images to their originals; part: of the force on the planes
  template <int D> void fold(double (*f)[row_of_forces(D)], double part) const
  {
    for (size_t k = 0; k < all.size(); k++) {
      const Image &image = all[k];
      const double *const on = f[first + k], both = image.bits & HALF ? 1.0 : 2.0;
      for (int d = 0; d < D && both == 2.0; d++) f[image.of][d] += image.mirror.sign[d] * on[d];
      for (size_t p = 0; p < planes.wall.size(); p++)
        if (image.bits & 1 << p)
          forces[p][planes.wall[p].axis] += part * both * on[planes.wall[p].axis];
    }
  }

  // positions of atoms and images, as of the last update()
  void update(double **x)
  {
    if (!any()) return;
    if (xs.size() != (size_t) end()) xs.resize(end());
    std::copy_n(x, first, xs.data());
    rows.resize(3 * all.size());
    for (size_t k = 0; k < all.size(); k++) {
      xs[first + k] = &rows[3 * k];
      all[k].mirror.reflect(x[all[k].of], xs[first + k]);
    }
  }
  double **positions(double **x) { return any() ? xs.data() : x; }
  double memory_usage() const { return bytes_of(all, xs, rows); }

 private:
  struct Image {
    int of, bits;
    Mirror mirror;
  };
  int group = 0, first = 0;
  std::vector<Image> all;
  std::unordered_map<int64_t, int> number;
  std::vector<double *> xs;
  std::vector<double> rows;
};

}    // namespace LAMMPS_NS::FSI

#endif
