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

// Number density, for what needs it: density by summation or ratio in place of continuity (the
// paper's), the free-surface rule.

#ifndef LMP_FSI_NUMBER_DENSITY_H
#define LMP_FSI_NUMBER_DENSITY_H

#include "fsi_part.h"
#include "pointers.h"

#include <utility>
#include <vector>

namespace LAMMPS_NS::FSI {

class Fields;

class NumberDensity : protected Pointers {
 public:
  NumberDensity(LAMMPS *lmp, Discretization &disc, StepState &step, Ghosts &ghosts,
                const std::vector<Part *> &parts) :
      Pointers(lmp),
      disc(disc), step(step), ghosts(ghosts), parts(parts)
  {
  }
  void set_fields(Fields &);    // for the effects that there are now
  void add_messages(Message &to_ghosts);
  // of the positions in atom->x; and the densities that follow from it
  void renew();
  // of local atoms into n[0..nlocal-1], for ghosts as they are in atom->x; n has room for ghosts
  void find(double *n) const;
  // h |sum_j grad_i W_ij|/psi_bulk of fluids, of local atoms
  std::vector<double> find_asymmetry() const;

 private:
  Discretization &disc;
  StepState &step;
  Ghosts &ghosts;
  const std::vector<Part *> &parts;
  // density mode ratio: rho/psi of the reference state; 0 = not taken yet
  double *ratio = nullptr;
  void find_density();
};

// The kernel's deficit at free surfaces. Continuity conserves rho - m psi of a particle, psi
// being its number density (pair_fsi_fluid.cpp): a particle that starts at a surface keeps its
// deficit when it is covered, and a block of water that has fallen into a box would stay too
// large. So the part of rho that stands for missing neighbors,
//   deficit = 1 - psi/psi_bulk  at the start,
// is kept for each particle, and is bounded by that of a particle at a plane surface with the
// same sum of gradients,
//   s = h |sum_j grad W_ij|/psi_bulk
// (at edges in proportion to its value at the start): where neighbors come, deficit and density
// decrease. Where a surface opens, deficit grows to that bound, at p = 0, as long as the
// density does not exceed rho0: this adds no pressure. Apart from what happens in between, the
// result does not depend on how often it is evaluated.
class SurfaceDeficit final : public Part, protected Pointers {
 public:
  SurfaceDeficit(LAMMPS *lmp, const Discretization &disc, const StepState &step, Ledger &ledger,
                 const NumberDensity &number_density) :
      Pointers(lmp),
      disc(disc), step(step), ledger(ledger), number_density(number_density)
  {
  }
  void set_array(Fields &);
  void write(Record &) const;
  void read(const Record &);
  Rank rank() const override { return SURFACES; }
  bool add_rates(bool) override;
  void advance(bool) override;    // after the density
  void undo_advance() override;
  std::vector<Effect> effects() const override;

 private:
  const Discretization &disc;
  const StepState &step;
  Ledger &ledger;
  const NumberDensity &number_density;
  // 1 + deficit (0: not known yet), and how often that of a plane it was at the start, on an edge
  double **deficit = nullptr;
  double since = 0.0, since_before = 0.0;    // the last look: now, at the start of this step
  bool due = false;
  // of the layers of a lattice below a plane surface, from the inside: s and deficit
  std::vector<std::pair<double, double>> layers;
  void find_layers();
  double of_plane(double s) const;
  std::vector<double> changes;    // of deficit and density in this step
  std::vector<double> earlier;    // densities before it, for the ledger
  void pass(double dt);
  void begin();
  void follow();
  double energy_loss(int i, double now, double change) const;
};

}    // namespace LAMMPS_NS::FSI

#endif
