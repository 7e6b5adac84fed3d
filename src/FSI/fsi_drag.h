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

// What a fluid does to a sphere in it that is too small for the fluid's particles to resolve.
//
// Drag: Schiller and Naumann (1933), Z. Ver. Dtsch. Ing. 77, 318-320, with Newton's constant for
// fast spheres, as in Clift, Grace and Weber (1978), Bubbles, Drops, and Particles, ch. 5:
//   F = pi/8 rho d^2 C |u - v| (u - v),  C = max(24/Re (1 + 0.15 Re^0.687), 0.44),
//   Re = rho d |u - v|/eta
// Pressure: -V grad p, what the fluid that was there would feel (Maxey and Riley 1983, Phys. Fluids
// 26, 883-889). Of a sphere that a free surface cuts, p = 0 there, only the cap below counts.

#ifndef LMP_FSI_DRAG_H
#define LMP_FSI_DRAG_H

#include "math_const.h"

#include <algorithm>
#include <cmath>

namespace LAMMPS_NS {
namespace FSI {

  // k, with F = k (u - v); speed: |u - v|
  inline double drag_of_sphere(double rho, double eta, double d, double speed)
  {
    const double fast = 0.44 / 8.0 * MathConst::MY_PI * rho * d * d * speed;
    if (eta <= 0.0) return fast;
    const double Re = rho * d * speed / eta;
    return std::max(3.0 * MathConst::MY_PI * eta * d * (1.0 + 0.15 * std::pow(Re, 0.687)), fast);
  }

  // part of the volume of a sphere of radius r that is where p > 0; p: at its center, g: |grad p|
  inline double immersed_part(double p, double g, double r)
  {
    if (p >= g * r) return 1.0;
    if (p <= -g * r) return 0.0;
    const double s = p / (g * r);
    return 0.25 * (2.0 + s * (3.0 - s * s));
  }

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
