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

#ifndef LMP_FSI_SWAPS_H
#define LMP_FSI_SWAPS_H

#include "fsi_lammps_access.h"
#include "pointers.h"

#include <functional>
#include <vector>

namespace LAMMPS_NS {
namespace FSI {

  // LAMMPS' exchanges with ghosts, without those that carry none of the chosen particles: both ends
  // of an exchange see whether it does, so no rank waits for an empty message. With comm_style
  // tiled they are LAMMPS' own.
  class Swaps : protected Pointers {
   public:
    explicit Swaps(LAMMPS *lmp) : Pointers(lmp), chosen(false) {}
    void find(const std::function<bool(int)> &is_chosen);    // whenever ghosts are new
    // for a pair style or a fix, which packs and unpacks the chosen particles only; size: numbers
    // of each, 0: comm_forward, comm_reverse
    template <class Owner> void forward(Owner *, int size = 0);
    template <class Owner> void reverse(Owner *, int size = 0);

   private:
    struct Swap : Exchange {
      std::vector<int> sent;    // chosen atoms of the list
      int arriving = 0;         // chosen ones of the ghosts
    };
    bool chosen;
    std::vector<Swap> swaps;
    std::vector<double> out, in;
    double *pass(int to, int n, int from, int most);
  };

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
