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

// What fix fsi/refine is made of: how a particle is split, where levels are wanted, how particles
// settle around what has changed.

#ifndef LMP_FSI_REFINE_H
#define LMP_FSI_REFINE_H

#include "fsi_cells.h"
#include "fsi_gradient.h"
#include "fsi_rows.h"
#include "fsi_walls.h"
#include "pointers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace LAMMPS_NS {
class Region;

namespace FSI {
  struct Discretization;
  struct Ledger;
  struct StepState;

  // How a fluid particle becomes two of the next finer level: along the direction in which there is
  // most room around it, on both sides. Two particles of mass m/2 at half the finer spacing from
  // the old one's place make the finer lattice out of a square one, and one with eight equal
  // neighbors (body-centered) out of a simple cubic one. No LAMMPS types.

  // Unit vectors along which a particle may split, one of each pair of opposite ones; the simplest
  // first: the first of equals is taken, so that all of a lattice split the same way.
  inline std::vector<std::array<double, 3>> split_directions(int dim)
  {
    struct Whole {
      int square;
      std::array<int, 3> c;
    };
    std::vector<Whole> whole;
    const int nz = dim == 3 ? 2 : 0;
    for (int z = -nz; z <= nz; z++)
      for (int y = -2; y <= 2; y++)
        for (int x = -2; x <= 2; x++) {
          const bool even = x % 2 == 0 && y % 2 == 0 && z % 2 == 0;    // or zero
          const int first = x ? x : y ? y : z;
          if (!even && first > 0) whole.push_back({x * x + y * y + z * z, {x, y, z}});
        }
    std::stable_sort(whole.begin(), whole.end(), [](const Whole &a, const Whole &b) {
      return a.square < b.square;
    });
    std::vector<std::array<double, 3>> unit;
    for (const auto &w : whole) {
      const double length = std::sqrt(w.square);
      unit.push_back({w.c[0] / length, w.c[1] / length, w.c[2] / length});
    }
    return unit;
  }

  // distance of each of the two from the old place, over its spacing
  inline double split_distance(int dim)
  {
    return 0.25 * std::sqrt(dim);
  }

  inline double split_spacing(int dim)    // of the next level, likewise
  {
    return std::pow(2.0, -1.0 / dim);
  }

  // what is beside the one that splits: its place from there, mean spacing of it and a half
  struct SplitNeighbor {
    double x[3] = {}, spacing = 0.0;
  };

  // How crowded a place is, at an offset from the old one: sum of (spacing/distance)^4.
  inline double crowding(const std::vector<SplitNeighbor> &around, const double *offset)
  {
    double sum = 0.0;
    for (const auto &n : around) {
      double rsq = 0.0;
      for (int d = 0; d < 3; d++) rsq += (n.x[d] - offset[d]) * (n.x[d] - offset[d]);
      const double q = n.spacing * n.spacing / std::max(rsq, 1.0e-4 * n.spacing * n.spacing);
      sum += q * q;
    }
    return sum;
  }

  // Which of the directions has the least crowded ends; extra(offset): what else crowds one, walls.
  // In units in which round-off does not decide between equals. -1: none has room, in a corner
  template <class Extra>
  int split_direction(const std::vector<std::array<double, 3>> &directions,
                      const std::vector<SplitNeighbor> &around, double distance, Extra extra)
  {
    constexpr double FINE = 1.0e6, MOST = 1.0e9;
    long long least = std::llround(FINE * MOST);
    int best = -1;
    for (size_t k = 0; k < directions.size(); k++) {
      const auto &e = directions[k];
      double sum = 0.0;
      for (const double to : {distance, -distance}) {
        const double offset[3] = {to * e[0], to * e[1], to * e[2]};
        sum += crowding(around, offset) + extra(offset);
      }
      const long long score = std::llround(FINE * std::min(sum, MOST));
      if (score >= least) continue;
      least = score;
      best = (int) k;
    }
    return best;
  }

  // Slopes of fields, exact for linear ones, from weighted sums over neighbors; where those are in
  // a line (2D) or plane (3D) there are none across it.
  template <int D, int FIELDS> class Slopes {
   public:
    double slope[FIELDS][D] = {};

    void add(const double *x, double weight, const double *differences)
    {
      for (int a = 0, k = 0; a < D; a++)
        for (int b = 0; b <= a; b++) A[k++] += weight * x[a] * x[b];
      for (int f = 0; f < FIELDS; f++)
        for (int d = 0; d < D; d++) sum[f][d] += weight * differences[f] * x[d];
    }
    void solve()
    {
      double C[D * D];
      faded_inverse<D>(A, C);
      for (int f = 0; f < FIELDS; f++)
        for (int a = 0; a < D; a++)
          for (int b = 0; b < D; b++) slope[f][a] += C[a * D + b] * sum[f][b];
    }

   private:
    double A[packed_size(D)] = {}, sum[FIELDS][D] = {};
  };

  // Where each level of a fluid from the first finer one on is wanted: nested regions, or distances
  // from a body. A finer zone is inside the one before it, by the kernel's support at least.
  class Zones : protected Pointers {
   public:
    Zones(LAMMPS *, const std::string &label);
    void read_regions(const std::vector<std::string> &words);
    void read_distances(const std::vector<std::string> &words);
    void check_number(size_t types);    // 0: one zone, the others follow from it

    void init(const Discretization &, const std::vector<int> &types);
    bool moving() const { return can_move; }
    // where they are at the end of this step, and beyond; positions are by that time before it
    void find(const Discretization &, double beyond, double time);
    bool has(int k, int i, double grown) const;    // is i in zone k, from 1 on, grown by that?
    std::string names(int k) const;                // of zones k and k + 1, for errors

   private:
    void find_body();
    bool is_near_image(Region *, const double *x, double distance) const;
    const std::string label;
    std::vector<std::string> region_ids;
    std::vector<Region *> regions;
    std::string body_id;
    int body_bit = 0;
    std::vector<double> distances, away;    // of zones; per local particle, from the body
    std::vector<double> wider;              // of zones than the finest, the only one that is given
    bool nested = false, can_move = false;            // nested: see wider
    double ahead = 0.0;                               // of positions, time
    std::vector<std::array<double, 3>> directions;    // in which a region grows
  };

  // What has split or merged is not where the pressure around it is even. On its way there by
  // itself it would make sound, and with each event the fluid would lose some of its mean pressure,
  // since its density follows what moves. So particles around are moved there at once, with their
  // density, by steps against the sum of V grad W: less the further they are from an event, and not
  // where they see bodies, segments of mirror walls or a surface.
  class Settling : protected Pointers {
   public:
    // dx |sum V grad W| of those that are judged, where there is no surface
    struct Residue {
      double largest = 0.0, squares = 0.0;
      bigint n = 0;
    };
    static constexpr double LONGEST = 0.05;    // step of a sweep over dx
    // how freely each local particle moves, 0 to 1, is it judged? bound(i) keeps it where it may be
    Settling(LAMMPS *, const Discretization &, const StepState &, Ledger &,
             const std::vector<double> &mobility, const std::vector<char> &judged,
             const std::function<void(int)> &bound);
    const Residue &residue() const { return last; }    // before the last move
    // moves: per local particle, may it be moved? Ghosts are where these are, and follow. Changed:
    // where something did, of this rank
    Settling(LAMMPS *, const Discretization &, const StepState &, Ledger &,
             const std::vector<char> &moves, const std::vector<Position> &changed);
    void run(int sweeps);

   private:
    const Discretization &disc;
    const StepState &step;
    Ledger &ledger;
    std::vector<double> mobility, start;    // start: positions that the rows are for
    std::vector<char> judged;
    std::function<void(int)> bound;
    Residue last;
    std::vector<double> points;     // position and volume of each particle
    std::vector<Row> rows;          // particles that are moved, and themselves among others
    std::vector<Mirror> mirrors;    // none, then those of the walls' reflections
    std::vector<int> neighbors;     // of the rows
    // of each row: sums of V grad W, then of V W; and rows that see walls, with the bits of these
    std::vector<std::array<double, 4>> sums;
    std::vector<std::pair<size_t, int>> at_walls;

    void find_rows();
    bool rows_hold() const;
    template <class K> void sum_up(const std::vector<K> &of_types);
    template <class K> void add_images_of_segments(const std::vector<K> &of_types);
    template <int D> void displace();
  };

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
