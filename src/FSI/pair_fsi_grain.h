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

#ifdef PAIR_CLASS
// clang-format off
PairStyle(fsi/grain,PairFSIGrain);
// clang-format on
#else

#ifndef LMP_PAIR_FSI_GRAIN_H
#define LMP_PAIR_FSI_GRAIN_H

#include "fsi_part.h"
#include "pair.h"

#include <vector>

namespace LAMMPS_NS {

// Pressure and drag of fluids on spheres of other pair styles, and back (fsi_pair_laws.h). What a
// sphere meets is a sum over the fluid around it, weighted by V W; its force goes back to the same
// particles with the same weights.

class PairFSIGrain : public Pair, public FSI::Part {
 public:
  PairFSIGrain(class LAMMPS *);
  ~PairFSIGrain() override;
  void compute(int, int) override;
  void settings(int, char **) override;
  void coeff(int, char **) override;
  void init_style() override;
  double init_one(int, int) override;
  int pack_forward_comm(int, int *, double *, int, int *) override;
  void unpack_forward_comm(int, int, double *) override;
  int pack_reverse_comm(int, int, double *) override;
  void unpack_reverse_comm(int, int *, double *) override;
  double memory_usage() override;

  FSI::Facts facts() const override;
  bool is_set_up() const override { return disc != nullptr; }
  std::vector<Effect> effects() const override;
  void find_idle(const Census &, const Idle &) const override;
  Rank rank() const override { return PAIRS; }
  void prescribe() override;

 private:
  // of fix fsi. Null: not since settings() or coeff()
  const FSI::Discretization *disc = nullptr;
  const FSI::StepState *step = nullptr;
  FSI::Ledger *ledger = nullptr;
  FSI::Ghosts *ghosts = nullptr;
  // of a step: pairs within the support, and how much of the sphere's force the fluid takes, times
  // the sum over all of its fluid
  struct Touch {
    int fluid, grain;
    double weight;
  };
  std::vector<Touch> touches;
  // local and ghost grains, and which of them an atom is, or -1
  std::vector<int> grains, number;
  std::vector<double> sums, given;    // per grain: sums over fluids; its force over that of weights
  double least_floor;                 // lowest pressure of fluids: 0 if all have free surfaces

  void allocate();
  void find_grains();
  template <int D> void sum_up();
  template <int D> void forces();
  template <int D> void give_back();
  void check_radii(int type) const;
  void check_step(int i, double drag, double dt) const;
};

}    // namespace LAMMPS_NS

#endif
#endif
