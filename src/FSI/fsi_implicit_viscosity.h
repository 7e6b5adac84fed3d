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

// Laminar viscosity, implicit: forces of velocities at the end of the step, which no limit of the
// time step depends on.

#ifndef LMP_FSI_IMPLICIT_VISCOSITY_H
#define LMP_FSI_IMPLICIT_VISCOSITY_H

#include "fsi_fluid_loops.h"
#include "fsi_hub.h"
#include "pointers.h"

#include <vector>

namespace LAMMPS_NS::FSI {
class Ghosts;
struct PairSet;
class PairSets;

// The velocities w that solve  m_i (w_i - v_i)/dt = f_i + sum_j k_ij (w_i - w_j),  v and f given,
// k_ij = V_i V_j (eta_i + eta_j) W'/r of the plain form (fsi_pair_laws.h): backward Euler, by
// conjugate gradients with the inverse of the diagonal (Hestenes and Stiefel 1952). Beyond
// no-slip walls and solids fluid has the velocity that explicit viscosity finds there, less what i
// changes by in the step: 2 v_wall - sum v W/sum W + v_i - w_i; of thin ones 2 v_wall - w_i. f has
// what the pulls of the step (fsi_hub.h) do with w, and of forces that are not known yet those of
// the last step.
class ImplicitViscosity : protected Pointers {
 public:
  ImplicitViscosity(LAMMPS *lmp, const Discretization &disc, StepState &step, Ghosts &ghosts) :
      Pointers(lmp), disc(disc), step(step), ghosts(ghosts)
  {
  }
  // rows of dim numbers of local and ghost particles; f: what else acts, on local ones in rows of
  // `columns` numbers. Pairs and points are those of the forces.
  const std::vector<double> &solve(PairSets &, const FluidParticles &, const ForceLaws &,
                                   const double *f, int columns);
  void find_unforeseen();    // when all forces are there
  double memory_usage() const;

 private:
  const Discretization &disc;
  StepState &step;
  Ghosts &ghosts;
  // pairs of fluids, with k in the order of the rows
  struct Block {
    RowSpan rows;
    double sign[3];    // of an image's velocity
    size_t first;
  };
  std::vector<Block> blocks;
  std::vector<double> k, diagonal, w, r, p, Ap;
  std::vector<char> free;                // what is not given
  std::vector<double> driving, given;    // forces without viscosity; with that of what is given
  template <int D>
  void solve(PairSets &, const FluidParticles &, const ForceLaws &, const double *f, int columns);
  template <int D> void begin(const double *f, int columns);
  template <int D> void add_pairs(const PairSet &, const FluidPairs &, const ForceLaws &);
  template <int D> void pull();
  template <int D> void multiply(std::vector<double> &x, std::vector<double> &y);
};

}    // namespace LAMMPS_NS::FSI

#endif
