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


// Contact of solid bodies: a penalty on particles of different bodies that are nearer than the spacing dx, conservative and
// without adhesion or friction. Energy per pair K dx^D/2 (1 - r/dx)^2: a layer pushed in by e dx pushes back with K e, as the
// bulk would. K is the harmonic mean of the two bulk moduli.

#ifndef LMP_FSI_CONTACT_H
#define LMP_FSI_CONTACT_H

#include <cmath>

namespace LAMMPS_NS {
namespace FSI {

  struct Contact {
    double dx, dxsq, scale;    // scale = dx^(D-2)
    Contact(int dim, double dx_in) : dx(dx_in), dxsq(dx * dx), scale(dim == 3 ? dx : 1.0) {}
    // factor f of the force F_i = f x_ij; Ki, Kj: bulk moduli
    double operator()(double rsq, double Ki, double Kj) const
    {
      if (rsq >= dxsq) return 0.0;
      return 2.0 * Ki * Kj / (Ki + Kj) * scale * (dx / std::sqrt(rsq + 1.0e-18 * dxsq) - 1.0);
    }
    double energy(double rsq, double Ki, double Kj) const
    {
      if (rsq >= dxsq) return 0.0;
      const double gap = dx - std::sqrt(rsq);
      return Ki * Kj / (Ki + Kj) * scale * gap * gap;
    }
  };

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
