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

// The pairs of pair_style fsi/fluid, by what fluid particles meet and by kernel: as rows of the
// neighbor list and as rows of images in mirror walls, and which of them are near.

#ifndef LMP_FSI_PAIR_SETS_H
#define LMP_FSI_PAIR_SETS_H

#include "fsi_fluid_loops.h"
#include "fsi_hub.h"
#include "pointers.h"
#include "update.h"

#include <array>
#include <cmath>
#include <memory>
#include <vector>

namespace LAMMPS_NS {
class NeighList;

namespace FSI {

  // Pairs of one kernel: what fluid particles of one level meet, and pairs of two levels
  struct PairSet {
    // the first three each level has; fluids that thin bodies may hide
    enum { FLUIDS, WALLS, SOLIDS, OF_LEVEL, HIDDEN = OF_LEVEL, NKINDS };
    int what = FLUIDS;
    PairKind kind = WITH_FLUID;
    size_t level = 0;    // of the fluid particles
    bool unlike = false;
    std::vector<VolumeRatio> ratio;          // per type
    bool unequal = false;                    // is any solid or wall of another spacing, or thin?
    double h = 0.0, cut = 0.0, wdx = 0.0;    // of the kernel: W(mean spacing) last
    std::shared_ptr<FluidLoops> loops, of_forces;    // all; those of forces
    RowList rows;                                    // of the neighbor list
    std::vector<RowList> images;                     // by reflection; empty: has none
    // of images: the support, and what a pair comes nearer in a step
    double reach = INFINITY;
    // of these, what is within the support and a margin: the lists have the skin's pairs, too
    std::vector<Row> near;
    // of pairs that thin bodies may hide: what is left of each, and of those of images
    std::vector<double> visible;
    std::vector<std::vector<double>> visible_images;
  };

  class PairSets : protected Pointers {
   public:
    explicit PairSets(LAMMPS *lmp) : Pointers(lmp) {}
    // when the levels of fluids are known; full: solids' stress crosses (couple full)
    void init(const Discretization &, StepState &, bool full);
    std::vector<PairSet> sets;
    const char *elsewhere = nullptr;    // the style that has its pairs on a device: not here
    const PairSet &of(size_t level, int what) const
    {
      return sets[PairSet::OF_LEVEL * level + what];
    }
    bool has_rows_with_walls() const;
    // distance to which lists of solids at mirror walls have to reach
    double beyond_lists() const;
    double memory_usage() const;

    void find_rows(const NeighList *);    // when neighbor lists are new
    void begin_step()
    {
      images_step = -1;
      near_known = false;
    }
    void forget_near() { near_known = false; }    // before forces at other positions
    // what thin bodies hide and how much more they count, forces and sums of W, where particles are
    // in this step
    void look_past_thin_bodies(double *backfill, double *backfill_weight);
    // how far pairs of this step reach; sorts: for_rates() may sort near pairs out
    void find_reach(bool sorts);

    // those rows that pairs within the support are in
    const std::vector<Row> &near_rows(const PairSet &set) const
    {
      return near_known && set.what != PairSet::HIDDEN ? set.near : set.rows.rows;
    }
    // Particles: where they are, null: at atom->x; what differs from set to set is filled in.
    // Calls loop(set, pairs, reach, near) for all pairs, also with images. The loop leaves in near,
    // if it is not null, the rows of what is within reach.
    template <class Loop> void for_rates(const Walls &, const FluidParticles &, Loop);
    // Calls loop(set, pairs, k) for those within the support, k the number of an image's reflection
    template <class Loop> void for_all(const Walls &, const FluidParticles &, Loop);
    // Calls loop(set, rows, Mirror or null) for those with walls of particles
    template <class Loop> void for_walls(const Walls &, Loop);

   private:
    const Discretization *disc = nullptr;
    StepState *step = nullptr;
    void check() const;    // are the pairs here?
    void find_ratios(PairSet &) const;
    // of a set, or of its images; visible: what is left of each, where thin bodies may hide some
    static FluidPairs pairs_of(const PairSet &, const std::vector<Row> &,
                               const std::vector<double> &visible, const Mirror *,
                               const FluidParticles &);
    template <class Loop> void for_images(const Walls &, const FluidParticles &, Loop);
    std::vector<size_t> of_two_levels, of_hidden;    // the sets of two fluids
    std::vector<int> fluid_types, other_types;
    std::vector<char> is_fluid;    // by type
    bool has_solids = false;
    void add_sets_of_levels(bool full);

    // of find_rows(): fluid particles and neighbors of other species, whichever of both has the
    // other in its list; rows of two fluid types, side by side
    std::vector<std::array<int, 2>> with_others;
    std::vector<RowList *> rows_of;
    std::vector<char> hides;
    std::vector<int> beside;    // fluid particles that may have a thin body beside them before
                                // lists are built again
    void add_rows_of_fluid(int i, const int *neighbors, int n);
    double farthest_of(int i, const int *neighbors, int n) const;
    void find_hidden(int i, const int *neighbors, int n);
    void add_pairs_behind_walls();
    void find_rows_with_others();

    double within(const PairSet &set) const
    {
      return disc->has_levels() ? set.cut : disc->largest_cut;
    }
    // The loop of rates sorts near pairs out when particles may have moved by the margin since it
    // last did. Before the lists are used by a second force evaluation at other positions they are
    // not known.
    bool near_known = false, sorts = true;
    double margin = 0.0;
    std::vector<double> sorted_at;    // positions
    std::vector<Row> near_images;
    template <int D> void find_reach(bool sorts);

    bigint images_step = -1;
    void find_images(const Walls &, const double *places);
    void find_images_of(PairSet &, const Walls &, const double *places);
    bool sees(int i, int j, const Walls &, int reflection, const double *places) const;
  };

  // calls loop(set, pairs, k)
  template <class Loop>
  void PairSets::for_images(const Walls &walls, const FluidParticles &particles, Loop loop)
  {
    if (!step->wmask || !walls.any()) return;
    // without extent of walls they are the same in all of a step's loops, but that of rates leaves
    // only what is within reach
    if (images_step != update->ntimestep || walls.finite()) find_images(walls, particles.points);
    images_step = update->ntimestep;
    for (size_t k = 0; k < walls.reflections.size(); k++)
      for (auto &set : sets) {
        if (set.images.empty() || set.images[k].rows.empty()) continue;
        const Mirror mirror(walls, walls.reflections[k]);
        loop(set, pairs_of(set, set.images[k].rows, set.visible_images[k], &mirror, particles), k);
      }
  }

  template <class Loop>
  void PairSets::for_all(const Walls &walls, const FluidParticles &particles, Loop loop)
  {
    check();
    for (const auto &set : sets)
      loop(set, pairs_of(set, near_rows(set), set.visible, nullptr, particles), 0);
    for_images(walls, particles, loop);
  }

  template <class Loop> void PairSets::for_walls(const Walls &walls, Loop loop)
  {
    for (const auto &set : sets)
      if (set.what == PairSet::WALLS) loop(set, near_rows(set), nullptr);
    if (!walls.joined_by(~0)) return;
    for_images(walls, {}, [&](const PairSet &set, const FluidPairs &pairs, int k) {
      if (set.what == PairSet::WALLS) loop(set, set.images[k].rows, pairs.mirror);
    });
  }

  template <class Loop>
  void PairSets::for_rates(const Walls &walls, const FluidParticles &particles, Loop loop)
  {
    check();
    // of what thin bodies may hide the order says which part belongs to which pair
    for (auto &set : sets) {
      const bool hidden = set.what == PairSet::HIDDEN;
      const std::vector<Row> &rows = sorts || hidden ? set.rows.rows : set.near;
      loop(set, pairs_of(set, rows, set.visible, nullptr, particles), within(set) + margin,
           sorts && !hidden ? &set.near : nullptr);
    }
    for_images(walls, particles, [&](PairSet &set, const FluidPairs &pairs, int k) {
      const bool hidden = set.what == PairSet::HIDDEN;
      loop(set, pairs, set.reach, hidden ? nullptr : &near_images);
      if (!hidden) set.images[k].rows.swap(near_images);
    });
    near_known = true;
  }

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
