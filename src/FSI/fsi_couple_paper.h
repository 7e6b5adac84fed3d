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

// The rule of pair_style fsi/fluid couple full, by which the source paper lets a fluid and a solid
// share one equation of motion (eq. 14): the mean of both pressures, and the solid's stress. Kept
// to compare with; the recommended couple wall is in fsi_fluid_rows.h.

#ifndef LMP_FSI_COUPLE_PAPER_H
#define LMP_FSI_COUPLE_PAPER_H

#include "fsi_pack.h"
#include "fsi_tensor.h"
#include "fsi_walls.h"

namespace LAMMPS_NS::FSI {

namespace CouplePaper {
  // adds the stress of solid j to the force on fluid i and gives its power; it is that of the
  // particle, not of its image, so look from the solid
  template <bool IMAGE, int D>
  FSI_INLINE double add_stress(const double *stress, const Mirror &mirror, double v2g,
                               const double (&x)[D], const double (&v)[D], double (&force)[D])
  {
    double seen[D], shear[D] = {}, power = 0.0;
    for (int d = 0; d < D; d++) seen[d] = (IMAGE ? mirror.sign[d] : 1.0) * x[d];
    dot<D>(Sym<D>::load(stress), seen, shear);
    for (int d = 0; d < D; d++) {
      const double s = (IMAGE ? mirror.sign[d] : 1.0) * shear[d] * v2g;
      force[d] += s;
      power += s * v[d];
    }
    return power;
  }
}    // namespace CouplePaper

}    // namespace LAMMPS_NS::FSI

#endif
