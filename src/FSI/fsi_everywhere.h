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

// Places of all ranks, and their images across periods, within a reach of the particles of this
// one, for questions about the nearest one: ghosts may not go as far.

#ifndef LMP_FSI_EVERYWHERE_H
#define LMP_FSI_EVERYWHERE_H

#include "atom.h"
#include "domain.h"
#include "fsi_cells.h"
#include "fsi_gather.h"
#include "lammps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <memory>
#include <vector>

namespace LAMMPS_NS {
namespace FSI {

  typedef std::array<double, 3> Position;

  class Everywhere {
   public:
    // mine: inside of the box, of this rank
    Everywhere(LAMMPS *lmp, double reach, std::vector<Position> mine) :
        total(count_of(mine.size(), lmp->world))
    {
      const Domain *const domain = lmp->domain;
      for (int d = 0; d < domain->dimension; d++) {
        if (!domain->periodicity[d]) continue;
        for (size_t k = 0, n = mine.size(); k < n; k++)
          for (const int side : {-1, 1}) {
            Position image = mine[k];
            image[d] += side * domain->prd[d];
            if (image[d] > domain->boxlo[d] - reach && image[d] < domain->boxhi[d] + reach)
              mine.push_back(image);
          }
      }
      pass(lmp, reach, mine);
      for (const Position &place : places) x.push_back(place.data());
      cells = std::make_unique<Cells>(x.data(), (int) x.size(), domain->dimension, reach);
    }
    bool empty() const { return total == 0; }    // on all ranks
    // squared distance of one from here; large where none is in reach
    double nearest(const double *to) const
    {
      double least = Cells::LARGE;
      cells->around(to, [&](int, double rsq) {
        least = std::min(least, rsq);
      });
      return least;
    }

   private:
    // to each rank what is within reach of its particles
    void pass(LAMMPS *lmp, double reach, const std::vector<Position> &mine)
    {
      struct Box {
        double lo[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, hi[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
      } own;
      for (int i = 0; i < lmp->atom->nlocal; i++)
        for (int d = 0; d < 3; d++) {
          own.lo[d] = std::min(own.lo[d], lmp->atom->x[i][d] - reach);
          own.hi[d] = std::max(own.hi[d], lmp->atom->x[i][d] + reach);
        }
      std::vector<Position> out;
      std::vector<int> to, from, first_to(1, 0), first_from(1, 0);    // numbers
      for (const Box &b : gather(std::vector<Box>{own}, lmp->world)) {
        std::copy_if(mine.begin(), mine.end(), std::back_inserter(out), [&](const Position &p) {
          for (int d = 0; d < 3; d++)
            if (p[d] < b.lo[d] || p[d] > b.hi[d]) return false;
          return true;
        });
        to.push_back(3 * (int) out.size() - first_to.back());
        first_to.push_back(3 * (int) out.size());
      }
      from.resize(to.size());
      MPI_Alltoall(to.data(), 1, MPI_INT, from.data(), 1, MPI_INT, lmp->world);
      for (const int count : from) first_from.push_back(first_from.back() + count);
      places.resize(first_from.back() / 3);
      MPI_Alltoallv(out.data(), to.data(), first_to.data(), MPI_DOUBLE, places.data(), from.data(),
                    first_from.data(), MPI_DOUBLE, lmp->world);
    }

    bigint total;
    std::vector<Position> places;
    std::vector<const double *> x;
    std::unique_ptr<Cells> cells;
  };

  // of the particles that is(i) holds for
  template <class Is> Everywhere everywhere(LAMMPS *lmp, double reach, Is is)
  {
    const Atom *const atom = lmp->atom;
    std::vector<Position> mine;
    for (int i = 0; i < atom->nlocal; i++)
      if (is(i)) mine.push_back({atom->x[i][0], atom->x[i][1], atom->x[i][2]});
    return Everywhere(lmp, reach, mine);
  }

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
