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

// Places of all ranks, and their images across periods within a reach of the box, for questions
// about the nearest one: ghosts may not go as far.

#ifndef LMP_FSI_EVERYWHERE_H
#define LMP_FSI_EVERYWHERE_H

#include "atom.h"
#include "domain.h"
#include "fsi_cells.h"
#include "fsi_gather.h"
#include "lammps.h"

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

namespace LAMMPS_NS {
namespace FSI {

  typedef std::array<double, 3> Position;

  class Everywhere {
   public:
    // inside of the box, of this rank
    Everywhere(LAMMPS *lmp, double reach, const std::vector<Position> &mine) :
        places(gather(mine, lmp->world))
    {
      const Domain *const domain = lmp->domain;
      for (int d = 0; d < domain->dimension; d++) {
        if (!domain->periodicity[d]) continue;
        for (size_t k = 0, n = places.size(); k < n; k++)
          for (const int side : {-1, 1}) {
            Position image = places[k];
            image[d] += side * domain->prd[d];
            if (image[d] > domain->boxlo[d] - reach && image[d] < domain->boxhi[d] + reach)
              places.push_back(image);
          }
      }
      for (const Position &place : places) x.push_back(place.data());
      cells = std::make_unique<Cells>(x.data(), (int) x.size(), domain->dimension, reach);
    }
    bool empty() const { return places.empty(); }
    double nearest(const double *to) const    // squared distance; large where none is in reach
    {
      double least = Cells::LARGE;
      cells->around(to, [&](int, double rsq) {
        least = std::min(least, rsq);
      });
      return least;
    }

   private:
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
