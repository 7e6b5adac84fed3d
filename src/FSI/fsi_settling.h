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

// What has split or merged is not where the pressure around it is even. On its way there by itself
// it would make sound, and with each event the fluid would lose some of its mean pressure, since
// its density follows what moves. So particles around are moved there at once, with their density,
// by steps against the sum of V grad W: less the further they are from an event, and not where
// they see bodies, segments of mirror walls or a surface.

#ifndef LMP_FSI_SETTLING_H
#define LMP_FSI_SETTLING_H

#include "fsi_everywhere.h"
#include "fsi_rows.h"
#include "fsi_walls.h"
#include "pointers.h"

#include <array>
#include <utility>
#include <vector>

namespace LAMMPS_NS {
namespace FSI {
  struct Discretization;
  struct Ledger;
  class Scene;
  struct StepState;

  class Settling : protected Pointers {
   public:
    // moves: per local particle, may it be moved? Ghosts are where these are, and follow. Changed:
    // where something did, of this rank
    Settling(LAMMPS *, Scene &, const std::vector<char> &moves,
             const std::vector<Position> &changed);
    void run(int sweeps);

   private:
    const Scene &scene;
    const Discretization &disc;
    const StepState &step;
    Ledger &ledger;
    std::vector<double> mobility, start;    // start: positions that the rows are for
    std::vector<double> points;             // position and volume of each particle
    std::vector<Row> rows;                  // particles that are moved, and themselves among others
    std::vector<Mirror> mirrors;            // none, then those of the walls' reflections
    std::vector<int> neighbors;             // of the rows
    // of each row: sum of V grad W, and behind it that of V W; and rows that see walls, with the
    // bits of these
    std::vector<std::array<double, 4>> sums;
    std::vector<std::pair<size_t, int>> at_walls;

    void find_rows();
    bool rows_hold() const;
    template <class T, class K> void sum_up(const std::vector<K> &of_types);
    template <class K> void add_images_of_segments(const std::vector<K> &of_types);
    template <int D> void displace();
  };

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
