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

// Mirror walls: planar walls and wall segments that act through images of the particles near them.
//
// The images that matter to particle i are images of i itself and of its own neighbors, because an
// image is never nearer to i than its original while both are on the wall's fluid side. So walls
// are treated inside the pair loops: no ghost atoms, no communication. With a_i the distance of i
// to the plane, |x_i - M x_j|^2 = r_ij^2 + 4 a_i a_j. Corners need the image of the image: every
// set of mutually perpendicular walls that both particles can see is a reflection of its own. A
// wall segment reflects i onto j if the straight line from i to the image of j passes through the
// segment; the rule is symmetric in i and j.
// Bodies that pass through a wall: before().

#ifndef LMP_FSI_WALLS_H
#define LMP_FSI_WALLS_H

#include "fsi_pack.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace LAMMPS_NS::FSI {

struct Wall {
  int axis = 0;                     // normal direction 0,1,2
  double side = 1.0;                // +1: fluid above the plane (xlo), -1: below (xhi)
  double position = 0.0;            // of the plane along axis
  double velocity[3] = {};          // of the wall; the component along axis moves the plane
  bool noslip = false;              // image velocity for viscous forces
  bool finite = false;              // has an extent
  double lo[3] = {}, hi[3] = {};    // extent along the other two axes
  bool hydrostatic = false;         // are images as much deeper as they are lower?
  int joins = 0;    // of a plane of symmetry: bit of the group whose bodies go on in their images

  std::string face() const { return std::string(1, "xyz"[axis]) + (side > 0.0 ? "lo" : "hi"); }
  FSI_INLINE double distance(const double *x) const { return side * (x[axis] - position); }
  // part of the cell of a particle with spacing dx that is before a plane without end
  double before(const double *x, double dx) const
  {
    return finite ? 1.0 : std::fmin(std::fmax(0.5 + distance(x) / dx, 0.0), 1.0);
  }
  // inside the extent, widened by margin
  FSI_INLINE bool spans(const double *x, double margin) const
  {
    if (!finite) return true;
    for (int b = 0; b < 3; b++)
      if (b != axis && (x[b] < lo[b] - margin || x[b] > hi[b] + margin)) return false;
    return true;
  }
};

// Where no point is within a margin of a wall's plane or behind it: the many that are there need
// no look at each wall.
struct InnerBox {
  double lo[3], hi[3];
  InnerBox(const std::vector<Wall> &walls, double margin)
  {
    for (int d = 0; d < 3; d++) {
      lo[d] = -INFINITY;
      hi[d] = INFINITY;
    }
    for (const auto &w : walls)
      if (w.side > 0.0)
        lo[w.axis] = std::fmax(lo[w.axis], w.position + margin);
      else
        hi[w.axis] = std::fmin(hi[w.axis], w.position - margin);
  }
  FSI_INLINE bool contains(const double *x) const
  {
    return x[0] > lo[0] && x[0] < hi[0] && x[1] > lo[1] && x[1] < hi[1] && x[2] > lo[2] &&
        x[2] < hi[2];
  }
};

typedef double *WallForce;    // three components

struct Reflection {    // a set of up to three mutually perpendicular walls
  int mask = 0, n = 0, w[3] = {};
};

// n walls side by side, for loops on any processor
struct WallRow {
  const Wall *wall;
  int n;

  // bits of the walls that x is near enough to have images in; behind: so far may it be behind a
  // plane without end
  FSI_INLINE int near(const double *x, double cut, double behind) const
  {
    int mask = 0;
    for (int k = 0; k < n; k++) {
      const double a = wall[k].distance(x);
      if (a >= (wall[k].finite ? 0.0 : -behind) && a < cut && wall[k].spans(x, cut)) mask |= 1 << k;
    }
    return mask;
  }

  // Does x_i see the image M x_j of x_j within the cutoff? rsq: |x_i - x_j|^2, which becomes
  // |x_i - M x_j|^2; dx[3] = x_i - M x_j. The one rule of all that have images
  FSI_INLINE bool sees(const Reflection &s, const double *xi, const double *xj, double cutsq,
                       double &rsq, double *dx) const
  {
    double ai[3], aj[3];
    for (int d = 0; d < 3; d++) dx[d] = xi[d] - xj[d];
    for (int k = 0; k < s.n; k++) {
      const Wall &w = wall[s.w[k]];
      ai[k] = w.distance(xi);
      aj[k] = w.distance(xj);
      rsq += 4.0 * ai[k] * aj[k];
      dx[w.axis] += 2.0 * w.side * aj[k];
    }
    return rsq < cutsq && passes(s, xi, dx, ai, aj);
  }

  // Has a segment x and y on different sides, and the straight line between them through it?
  FSI_INLINE bool divide(const double *x, const double *y) const
  {
    for (int k = 0; k < n; k++) {
      const double a = wall[k].distance(x), b = wall[k].distance(y);
      if (!wall[k].finite || a * b >= 0.0) continue;
      const double t = a / (a - b);
      const double cross[3] = {x[0] + t * (y[0] - x[0]), x[1] + t * (y[1] - x[1]),
                               x[2] + t * (y[2] - x[2])};
      if (wall[k].spans(cross, 0.0)) return true;
    }
    return false;
  }

  // may one come between them if each changes its distance to it by slack?
  bool may_divide(const double *x, const double *y, double slack) const
  {
    for (int k = 0; k < n; k++) {
      const double a = wall[k].distance(x), b = wall[k].distance(y);
      if (wall[k].finite && std::fmin(a, b) < slack && std::fmax(a, b) > -slack) return true;
    }
    return false;
  }

  // of a reflection the wall that has the force along that axis
  FSI_INLINE int pushed(const Reflection &s, int axis) const
  {
    int w = s.w[0];
    for (int k = 1; k < s.n; k++)
      if (wall[s.w[k]].axis == axis) w = s.w[k];
    return w;
  }

 private:
  // does the line from x_i to the image cross every wall of the set inside its extent?
  FSI_INLINE bool passes(const Reflection &s, const double *xi, const double *dx, const double *ai,
                         const double *aj) const
  {
    for (int k = 0; k < s.n; k++) {
      const Wall &w = wall[s.w[k]];
      if (!w.finite) continue;
      const double sum = ai[k] + aj[k], t = sum > 0.0 ? ai[k] / sum : 0.5;
      double cross[3] = {xi[0] - t * dx[0], xi[1] - t * dx[1], xi[2] - t * dx[2]};
      // behind another wall of the set the crossing point is itself an image: fold it back
      for (int m = 0; m < s.n; m++) {
        const Wall &u = wall[s.w[m]];
        if (m == k) continue;
        const double a = u.distance(cross);
        if (a < 0.0) cross[u.axis] -= 2.0 * u.side * a;
      }
      if (!w.spans(cross, 0.0)) return false;
    }
    return true;
  }
};

struct Walls {
  static constexpr int MAXWALL = 31;
  std::vector<Wall> wall;

  using Reflection = FSI::Reflection;
  std::vector<Reflection> reflections;

  bool any() const { return !wall.empty(); }
  bool finite() const    // has one an extent?
  {
    for (const auto &w : wall)
      if (w.finite) return true;
    return false;
  }

  // what is behind a wall without end is in the images of what is before it
  bool is_before_planes(const double *x) const
  {
    for (const auto &w : wall)
      if (!w.finite && w.distance(x) < 0.0) return false;
    return true;
  }
  bool finite(const Reflection &s) const
  {
    for (int k = 0; k < s.n; k++)
      if (wall[s.w[k]].finite) return true;
    return false;
  }

  void find_reflections()
  {
    reflections.clear();
    const int n = wall.size();
    for (int a = 0; a < n; a++) {
      reflections.push_back({1 << a, 1, {a, 0, 0}});
      for (int b = a + 1; b < n; b++) {
        if (wall[b].axis == wall[a].axis) continue;
        reflections.push_back({1 << a | 1 << b, 2, {a, b, 0}});
        for (int c = b + 1; c < n; c++)
          if (wall[c].axis != wall[a].axis && wall[c].axis != wall[b].axis)
            reflections.push_back({1 << a | 1 << b | 1 << c, 3, {a, b, c}});
      }
    }
  }

  // bits of the planes of symmetry for a body's particle with this mask
  int joined_by(int mask) const
  {
    int bits = 0;
    for (size_t k = 0; k < wall.size(); k++)
      if (wall[k].joins & mask) bits |= 1 << k;
    return bits;
  }
  // Bits of the walls that a particle has images in. Walls of particles have them in planes of
  // symmetry alone, behind others they go on themselves.
  int mirroring(bool of_wall, int mask) const { return of_wall ? joined_by(mask) : ~0; }

  // as WallRow has them
  int near(const double *x, double cut, double behind = 0.0) const
  {
    return row().near(x, cut, behind);
  }

  // To the fluid a body that passes through a plane without end goes on in its images: what is
  // behind is not there. How much counts of a particle with spacing dx, and its rate: the part of
  // its cell before the plane, so that nothing jumps when a body slides through, whatever its
  // lattice. Bodies that end before the plane are whole, so it begins with the first dx/2 that
  // they go behind it. depth[k]: how deep bodies of its type are behind wall k at most, with its
  // rate
  struct Depth {
    double depth = 0.0, rate = 0.0;
  };
  double before(const double *x, const double *v, double dx, const Depth *depth, double &rate) const
  {
    double part = 1.0;
    rate = 0.0;
    for (size_t k = 0; k < wall.size(); k++) {
      const Wall &w = wall[k];
      const double cell = w.before(x, dx);
      if (depth[k].depth <= 0.0 || cell >= 1.0) continue;
      const bool deep = depth[k].depth >= 0.5 * dx;
      const double share = deep ? 1.0 : 2.0 * depth[k].depth / dx, behind = 1.0 - cell;
      const double left = 1.0 - share * behind;
      const double grows =
          (cell > 0.0 ? share / dx * w.side * (v[w.axis] - w.velocity[w.axis]) : 0.0) -
          (deep ? 0.0 : 2.0 / dx * depth[k].rate * behind);
      rate = rate * left + part * grows;
      part *= left;
    }
    return part;
  }

  bool sees(const Reflection &s, const double *xi, const double *xj, double cutsq, double &rsq,
            double *dx) const
  {
    return row().sees(s, xi, xj, cutsq, rsq, dx);
  }

  // Calls f(reflection, rsq, dx) for every image that x_i sees. mask: walls near both; rsq0 =
  // |x_i - x_j|^2 (0 and x_j = x_i for the images of i itself).
  template <class F>
  void images(int mask, double rsq0, const double *xi, const double *xj, double cutsq, F &&f) const
  {
    for (const auto &s : reflections) {
      if ((s.mask & mask) != s.mask) continue;
      double rsq = rsq0, dx[3];
      if (sees(s, xi, xj, cutsq, rsq, dx)) f(s, rsq, dx);
    }
  }

  // the same walls a time dt later
  Walls moved(double dt) const
  {
    Walls m = *this;
    for (auto &w : m.wall) w.position += dt * w.velocity[w.axis];
    return m;
  }

  WallRow row() const { return {wall.data(), static_cast<int>(wall.size())}; }
};

// A reflection as what it makes of a point and its velocity, axis by axis: image = x + sign *
// original; for viscous forces no-slip walls turn the velocity around.
// Where no-slip walls of different velocity meet, the corner's flow is singular: the image
// depends on the order of the walls, which is that of the script.
struct Mirror {
  double sign[3] = {1.0, 1.0, 1.0}, x[3] = {}, v[3] = {};
  double rubbing_sign[3] = {1.0, 1.0, 1.0}, rubbing_v[3] = {};
  double slip_sign[3] = {1.0, 1.0, 1.0}, slip_v[3] = {};    // of velocities, in those that slip
  double deeper[3] = {};                                    // 1 along axes of hydrostatic walls
  Mirror() = default;
  Mirror(const Walls &walls, const Walls::Reflection &s)
  {
    for (int k = 0; k < s.n; k++) {
      const Wall &w = walls.wall[s.w[k]];
      sign[w.axis] = -1.0;
      x[w.axis] = 2.0 * w.position;
      v[w.axis] = 2.0 * w.velocity[w.axis];
      deeper[w.axis] = w.hydrostatic;
      if (!w.noslip) {
        slip_sign[w.axis] = sign[w.axis];
        slip_v[w.axis] = v[w.axis];
      }
      for (int d = 0; d < 3; d++)
        if (w.noslip || d == w.axis) {
          rubbing_sign[d] = -rubbing_sign[d];
          rubbing_v[d] = 2.0 * w.velocity[d] - rubbing_v[d];
        }
    }
  }
  bool slips() const { return std::equal(sign, sign + 3, rubbing_sign); }
  // what a body's image has of the water before it: planes that slip have water on both sides
  template <class T> FSI_INLINE T own_velocity(int d, const T &u) const
  {
    return slip_v[d] + slip_sign[d] * u;
  }
  void reflect(const double *original, double *image) const    // a point
  {
    for (int d = 0; d < 3; d++) image[d] = x[d] + sign[d] * original[d];
  }
  void reflect_velocity(const double *original, double *image) const    // as for walls that slip
  {
    for (int d = 0; d < 3; d++) image[d] = v[d] + sign[d] * original[d];
  }
};

}    // namespace LAMMPS_NS::FSI

#endif
