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

// Contact of solid bodies: a penalty on particles of different bodies that are nearer than a range
// of R spacings, conservative and without adhesion. Energy per pair s K dx^D/2 (1 - r/(R dx))^2, K
// the harmonic mean of the two bulk moduli. s makes two lattices that face each other at a distance
// of dx as stiff against coming nearer as the bulk: a layer pushed in by e dx pushes back with K e.
// With R = 1, particle against particle, s = 1.
//
// With R = 1 a particle feels one or two of the other body's, and the face is as bumpy as a row of
// balls. With R = 2 or more it feels several, and their bumps average out.

#ifndef LMP_FSI_CONTACT_H
#define LMP_FSI_CONTACT_H

#include "fsi_pack.h"

#include <algorithm>
#include <cmath>

namespace LAMMPS_NS {
namespace FSI {

  // Contact of a body with itself, of pairs without a bond, does not reach beyond a part of their
  // distance in the reference, so that a body that nothing strains has none: 0.9 of it where a bond
  // is torn (short-range forces of Silling and Askari, Computers and Structures 83 (2005) 1526), a
  // half where there never was one, which leaves a body free to be compressed as much.
  inline double reach_within_body(double reach, double distance, bool torn)
  {
    return std::min(reach, (torn ? 0.9 : 0.5) * distance);
  }

  struct Contact {
    double reach, reachsq, scale;    // reach = R dx, scale = s dx^(D-2)/R^2
    Contact(int dim, double dx, double R = 1.0) :
        reach(R * dx), reachsq(reach * reach), scale(dim == 3 ? dx : 1.0)
    {
      scale /= stiffness(dim, R);
    }
    // the same, of pairs that feel each other only where they are nearer than that
    Contact within(double r) const
    {
      Contact c = *this;
      c.reach = r;
      c.reachsq = r * r;
      return c;
    }
    // factor f of the force F_i = f x_ij; Ki, Kj: bulk moduli; T: double or Pack
    template <class T> FSI_INLINE T operator()(const T &rsq, double Ki, double Kj) const
    {
      if (none(rsq < T(reachsq))) return T(0.0);
      const double k = 2.0 * Ki * Kj / (Ki + Kj) * scale;
      return where(rsq < T(reachsq), k * (reach / root(rsq + T(1.0e-18 * reachsq)) - T(1.0)),
                   T(0.0));
    }
    template <class T> FSI_INLINE T stored(const T &rsq, double K) const
    {
      const T gap = reach - root(rsq);
      return where(rsq < T(reachsq), 0.5 * K * scale * gap * gap, T(0.0));
    }
    double energy(double rsq, double Ki, double Kj) const
    {
      if (rsq >= reachsq) return 0.0;
      const double gap = reach - std::sqrt(rsq);
      return Ki * Kj / (Ki + Kj) * scale * gap * gap;
    }

    // second derivative of the energy (R - r)^2/2 per particle of a face by the distance of the
    // faces, where this is 1 (all lengths over dx): the sum over the other lattice, with n pairs of
    // layers at a distance of n, of 1 - R (r^2 - n^2)/r^3
    static double stiffness(int dim, double R)
    {
      const int m = static_cast<int>(R);
      double sum = 0.0;
      for (int n = 1; n <= m; n++)
        for (int a = -m; a <= m; a++)
          for (int b = (dim == 3 ? -m : 0); b <= (dim == 3 ? m : 0); b++) {
            const double s = a * a + b * b, r = std::sqrt(s + n * n);
            if (r <= R) sum += n * (1.0 - R * s / (r * r * r));
          }
      return sum;
    }
  };

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
