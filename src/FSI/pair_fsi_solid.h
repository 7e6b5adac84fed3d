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
PairStyle(fsi/solid,PairFSISolid);
// clang-format on
#else

#ifndef LMP_PAIR_FSI_SOLID_H
#define LMP_PAIR_FSI_SOLID_H

#include "fsi_fields.h"
#include "fsi_tensor.h"
#include "pair_fsi.h"

#include <vector>

namespace LAMMPS_NS {

// Solid-solid pairs, updated Lagrangian: full Cauchy stress, artificial viscosity, artificial stress; and the sums that
// the velocity gradient is made of. Pairs of different bodies (molecule IDs) only push.

class PairFSISolid : public PairFSI {
 public:
  PairFSISolid(class LAMMPS *);
  void init_style() override;
  void compute(int, int) override;
  int pack_forward_comm(int, int *, double *, int, int *) override;
  void unpack_forward_comm(int, int, double *) override;
  int pack_reverse_comm(int, int, double *) override;
  void unpack_reverse_comm(int, int *, double *) override;
  std::vector<Effect> effects() const override;
  double memory_usage() override;

  void *extract(const char *, int &) override;
  void set_fields(FSI::Scene &) override;
  void add_messages(FSI::Message &, FSI::Message &) override;
  bool add_rates(bool) override;
  void advance(bool) override;
  void add_number_density(double *, bool of_all_bodies) override;
  void go_back() override;
  void add_costs(Costs &) const override;
  void find_idle(const Census &, const Idle &) const override;

  // gradients: 0 = plain, else the number of terms for which they are exact (fsi_gradient.h): dim linear ones (Bonet and
  // Lok 1999), or the quadratic ones too
  int terms() const;
  bool has_hourglass() const { return xi > 0.0; }

 protected:
  bool handles(int, int) const override;
  bool defines(int species) const override { return species == FSI::SOLID; }
  FSI::State make_state(const FSI::Material &) const override;

 private:
  class FixFSIStress *fix_stress;
  FSI::Fields fields;
  // local and ghost: sums of the velocity gradient, afterwards L and the coefficients of its weights (fsi_gradient.h)
  double **grad;
  int ngrad() const;
  bool any_gradient;    // in this step: coefficients are needed by forces, so in setup, too
  // adds to grad, over the own body, at the positions dt/2 ago, to which the velocities belong: plain,
  // sum_j V_j (v_j - v_i)(x)grad_i W_ij; else sum_j w (v_j - v_i)(x)phi and, packed, the moments sum_j w phi (x) phi, with
  // grad_i W_ij = -w x_ij/V_j and the basis phi of x_ji/h; then these moments at the positions of now, for the forces
  void velocity_gradient(double dt);
  template <int D, int TERMS> void advance_stress(bool advance);
  // forces of hourglass control from half a step back to half a step ahead, with L of the time between
  void advance_hourglass(double dt);

  enum GradientKind { PLAIN, CORRECTED_LINEAR, CORRECTED_QUADRATIC };
  double epsilon, xi;
  std::vector<double> hourglass_rate;    // local and ghost
  template <class K> void hourglass_pairs(double);
  template <int D> void rotate_hourglass(double);
  int gradient;

  // local and ghost, filled at the start of compute(): stress and artificial stress, both times V^2
  template <int D> struct Aux {
    FSI::Sym<D> stress, artificial;
    const double *C;    // coefficients of the gradient
    FSI::Sym<D> vstress;    // V sigma
    double vol, rho, c;
    double vol0;    // m/rho0
  };
  std::vector<Aux<2>> aux2;
  std::vector<Aux<3>> aux3;
  template <int D> std::vector<Aux<D>> &get_aux();
  template <int D, int TERMS> const std::vector<Aux<D>> &fill_aux();

  enum { ARTIFICIAL_VISCOSITY = 1, BODIES = 2, ARTIFICIAL_STRESS = 4, LEDGER = 8 };
  // Loops may have effects that are off, with coefficients of zero: what rarely is alone shares a loop with what it is mostly with. Loops of
  // quadratic gradients are for any kernel.
  template <int TERMS> static constexpr int completed(int flags)
  {
    const bool ledger = flags & LEDGER;
    if (TERMS && ledger && (flags & BODIES)) flags |= ARTIFICIAL_STRESS;
    if ((TERMS || ledger) && (flags & ARTIFICIAL_STRESS)) flags |= BODIES;
    if ((TERMS && ledger) || (flags & BODIES)) flags |= ARTIFICIAL_VISCOSITY;
    return flags;
  }
  void (PairFSISolid::*force_loop)();
  void (PairFSISolid::*gradient_loop)(double);
  template <class K, int TERMS, int FLAGS> void force_pairs();
  template <class K, int TERMS, int FLAGS> void gradient_pairs(double);
  template <class K, int TERMS> void select(int flags);
};

}    // namespace LAMMPS_NS

#endif
#endif
