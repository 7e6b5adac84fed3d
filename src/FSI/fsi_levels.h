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

// Kernels of fluids of several spacings.

#ifndef LMP_FSI_LEVELS_H
#define LMP_FSI_LEVELS_H

#include "fsi_kernel.h"
#include "fsi_scene.h"

namespace LAMMPS_NS {
namespace FSI {

  // Calls f(level, kernel) for each spacing of fluids with a kernel whose W is multiplied with the
  // volume of its particles, that of the coarsest being 1: weights of means over fluids around
  template <class F> void for_levels(const Discretization &disc, F &&f)
  {
    for (size_t l = 0; l < disc.levels.size(); l++)
      with_kernel(disc.kernel, disc.dim, disc.levels[l].h, [&](auto kernel) {
        const double ratio = disc.levels[l].dx / disc.dx;
        kernel.norm *= disc.dim == 3 ? ratio * ratio * ratio : ratio * ratio;
        f(l, kernel);
      });
  }

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
