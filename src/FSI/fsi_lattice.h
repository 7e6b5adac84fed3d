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

// The elasticity that a lattice of fluid particles has and the fluid has not.
//
// A fluid strained without a change of area (3D: volume) keeps its density. The number density psi
// = sum W of its particles, which is what continuity follows and pressure works on, does not: on a
// square or simple cubic lattice psi(e) = psi (1 + s e^2/2 + ...), and the work p dpsi/psi is that
// of a solid with the modulus s p. s > 0 stiffens a flow (waves are too fast); where s < 0 a
// lattice under pressure gives way by itself. It is an error that does not fall with dx.
//
// s is a sum over the neighbors of second derivatives of W(|F x|), g = W'/r:
//   stretch, F = diag(exp e, exp -e):   sum (W'' - g) (x^2 - y^2)^2/r^2 + 2 g (x^2 + y^2)
//   shear, F = 1 + e x (x) y:           sum (W'' - g) x^2 y^2/r^2 + g y^2
// By the lattice's symmetry any other strain that keeps the volume, at small e, is a sum of these.

#ifndef LMP_FSI_LATTICE_H
#define LMP_FSI_LATTICE_H

#include "fsi_kernel.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace LAMMPS_NS {
namespace FSI {

  struct LatticeNeighbor {
    double x[3] = {}, g = 0.0, q = 0.0;    // place; g and (W'' - g)/r^2 over psi
  };

  template <class K> std::vector<LatticeNeighbor> lattice_neighbors(const K &kernel, double dx)
  {
    const double psi = lattice_number_density(kernel, dx);
    const int n = static_cast<int>(kernel.cut / dx) + 1, nz = K::DIM == 3 ? n : 0;
    std::vector<LatticeNeighbor> all;
    for (int k = -nz; k <= nz; k++)
      for (int j = -n; j <= n; j++)
        for (int i = -n; i <= n; i++) {
          const double rsq = dx * dx * (i * i + j * j + k * k), r = std::sqrt(rsq);
          if (r == 0.0 || r >= kernel.cut) continue;
          const double g = kernel.gradient(r) / psi;
          all.push_back({{i * dx, j * dx, k * dx}, g, (kernel.curvature(r) / psi - g) / rsq});
        }
    return all;
  }

  struct LatticeStiffness {
    double stretch = 0.0, shear = 0.0;    // modulus over pressure
  };

  template <class K> LatticeStiffness lattice_stiffness(const K &kernel, double dx)
  {
    LatticeStiffness s = {0.0, 0.0};
    for (const auto &j : lattice_neighbors(kernel, dx)) {
      const double xsq = j.x[0] * j.x[0], ysq = j.x[1] * j.x[1];
      s.stretch += j.q * (xsq - ysq) * (xsq - ysq) + 2.0 * j.g * (xsq + ysq);
      s.shear += j.q * xsq * ysq + j.g * ysq;
    }
    return s;
  }

  // Smallest rho omega^2/(p k^2) of the waves that leave densities as they are, so that no sound
  // holds them: the shear modulus over the pressure of the softest. The longest have that of shear
  // along the axes and a quarter of that of stretching along diagonals, short ones their own. A
  // lattice under pressure rests where it is not below 0. On lines of symmetry motions are known;
  // waves off them are softer by a tenth at most.
  template <class K> double lattice_softest_wave(const K &kernel, double dx)
  {
    static constexpr struct {
      double corner[3], toward[3], motion[3];    // wave vectors corner + t toward, of pi/dx
    } lines[] = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                 {{0, 0, 0}, {1, 1, 0}, {1, -1, 0}},
                 {{1, 0, 0}, {0, 1, 0}, {1, 0, 0}},
                 // 3D
                 {{0, 0, 0}, {1, 1, 0}, {0, 0, 1}},
                 {{0, 0, 0}, {1, 1, 1}, {1, -1, 0}},
                 {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                 {{1, 0, 0}, {0, 1, 1}, {1, 0, 0}},
                 {{1, 0, 0}, {0, 1, 1}, {0, 1, -1}},
                 {{1, 1, 0}, {0, 0, 1}, {1, 0, 0}}};
    const auto neighbors = lattice_neighbors(kernel, dx);
    const auto longest = lattice_stiffness(kernel, dx);
    double softest = std::min(longest.shear, 0.25 * longest.stretch);
    for (int l = 0; l < (K::DIM == 2 ? 3 : 9); l++)
      for (double t = 0.0; t <= 1.0; t += 1.0 / 32) {
        const double *const u = lines[l].motion;
        double k[3], ksq = 0.0, stiffness = 0.0;
        for (int d = 0; d < 3; d++) {
          k[d] = MathConst::MY_PI / dx * (lines[l].corner[d] + t * lines[l].toward[d]);
          ksq += k[d] * k[d];
        }
        if (ksq == 0.0) continue;
        const double usq = u[0] * u[0] + u[1] * u[1] + u[2] * u[2];
        for (const auto &j : neighbors) {
          const double ux = u[0] * j.x[0] + u[1] * j.x[1] + u[2] * j.x[2];
          stiffness += 2.0 * (1.0 - std::cos(k[0] * j.x[0] + k[1] * j.x[1] + k[2] * j.x[2])) *
              (j.g * usq + j.q * ux * ux);
        }
        softest = std::min(softest, stiffness / (ksq * usq));
      }
    return softest;
  }

  // h/dx nearest to a given one, with a support of 2.6 dx at least, at which stretching meets no
  // stiffness and no wave is soft to speak of; 0: none
  inline double lattice_free_ratio(int kind, int dim, double ratio)
  {
    constexpr double STEP = 0.01, HIGHEST = 2.5, SOFT = -0.02;
    const double lowest = 2.6 / kernel_support(kind);
    const auto stretch = [&](double r) {
      double s = 0.0;
      with_kernel(kind, dim, r, [&s](const auto &k) {
        s = lattice_stiffness(k, 1.0).stretch;
      });
      return s;
    };
    double best = 0.0;
    for (const double step : {-STEP, STEP}) {
      double last = stretch(ratio);
      for (double r = ratio + step; r > lowest && r < HIGHEST; r += step) {
        const double next = stretch(r);
        if (last * next <= 0.0 && last != next) {
          const double found = r - step * next / (next - last);
          double soft = 0.0;
          with_kernel(kind, dim, found, [&soft](const auto &k) {
            soft = lattice_softest_wave(k, 1.0);
          });
          if (soft > SOFT) {
            if (best == 0.0 || std::fabs(found - ratio) < std::fabs(best - ratio)) best = found;
            break;
          }
        }
        last = next;
      }
    }
    return best;
  }

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
