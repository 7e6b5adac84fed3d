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

// Velocity gradients of fluids, and the viscosity of those whose law depends on them
// (fsi_viscosity.h).

#ifndef LMP_FSI_SHEAR_H
#define LMP_FSI_SHEAR_H

#include "fsi_fluid_loops.h"
#include "fsi_hub.h"
#include "pointers.h"

#include <vector>

namespace LAMMPS_NS::FSI {
class Ghosts;
class PairSets;

class Shear : protected Pointers {
 public:
  // eddies: C_s of Smagorinsky 1963, which adds rho (C_s dx)^2 times the shear rate; 0: none
  Shear(LAMMPS *lmp, const Discretization &disc, const StepState &step, Ghosts &ghosts,
        double eddies) :
      Pointers(lmp),
      disc(disc), step(step), ghosts(ghosts), eddies(eddies)
  {
  }
  bool varies() const;    // has any fluid such a law, or eddies?

  // dv_a/dx_b of local fluid particles, where pairs and points are now: of neighbors, images and
  // what no-slip walls and solids have beyond their face, exact for linear fields,
  //   grad v = [sum_j V_j v_ji (x) g_ij] [sum_j V_j x_ji (x) g_ij]^-1,  g_ij = grad_i W_ij
  // (Randles and Libersky 1996), without the kernel's smoothing. 0 where neighbors are too few.
  void find_gradients(PairSets &, const FluidParticles &, const ForceLaws &);
  const double *gradient(int i) const;
  double rate(int i) const;                               // sqrt(2 D:D)
  void stress(int i, double eta, double *sigma) const;    // 2 eta D, as xx yy zz xy xz yz

  double viscosity_of(int i) const;    // at rate(i)
  // of local and ghost particles; those of fluids without such a law are constant
  void find_viscosities(PairSets &, const FluidParticles &, const ForceLaws &);
  const double *viscosities() const { return viscosity.data(); }
  double memory_usage() const { return bytes_of(sums, gradients, viscosity); }

 private:
  const Discretization &disc;
  const StepState &step;
  Ghosts &ghosts;
  const double eddies;
  std::vector<double> sums, gradients, viscosity;
  template <int D> void find_gradients(PairSets &, const FluidParticles &, const ForceLaws &);
  template <int D> void sharpen(PairSets &, const FluidParticles &);
  template <int D, class Loop> void for_rows(PairSets &, const FluidParticles &, Loop) const;
};

}    // namespace LAMMPS_NS::FSI

#endif
