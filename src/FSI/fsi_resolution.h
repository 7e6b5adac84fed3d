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

// How finely an atom type is resolved: the spacing of its lattice, and what follows from it. The
// smoothing length over the spacing is the same for all types. Fluids of two spacings meet with
// the kernel of their mean, fluids and others with the fluid's, each with its own volume.

#ifndef LMP_FSI_RESOLUTION_H
#define LMP_FSI_RESOLUTION_H

namespace LAMMPS_NS {
namespace FSI {

  struct Resolution {
    double dx = 0.0, h = 0.0;      // spacing, smoothing length
    double cut = 0.0;              // support radius of the kernel
    double psi_bulk = 0.0;         // number density inside the lattice: the volume of a particle is
                                   // 1/psi_bulk
    double wdx = 0.0, w0 = 0.0;    // W(dx), W(0)
  };

  // distance of neighbors of two lattices that face each other, cell by cell
  inline double spacing_between(const Resolution &a, const Resolution &b)
  {
    return 0.5 * (a.dx + b.dx);
  }

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
