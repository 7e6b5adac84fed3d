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

// The shortest of a difference's periodic images, as Domain::minimum_image() gives it, whose
// arguments differ between releases of LAMMPS.

#ifndef LMP_FSI_NEAREST_IMAGE_H
#define LMP_FSI_NEAREST_IMAGE_H

#include "domain.h"

#include <cmath>

namespace LAMMPS_NS {
namespace FSI {

  // boxes are orthogonal
  inline void to_nearest_image(const Domain &box, double *d)
  {
    for (int k = 0; k < 3; k++)
      if (box.periodicity[k] && std::fabs(d[k]) > box.prd_half[k])
        d[k] = std::remainder(d[k], box.prd[k]);
  }

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
