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

#include "pair_fsi.h"

#include <memory>
#include <vector>

namespace LAMMPS_NS {
namespace FSI {
  class Fields;
  class Images;
  struct PairLaws;
  class RowList;
}    // namespace FSI

// Solid-solid pairs, updated Lagrangian: full Cauchy stress, artificial viscosity, artificial
// stress; and the sums that the velocity gradient is made of. Pairs of different bodies (molecule
// IDs) only push.

class PairFSISolid : public PairFSI {
  struct Members;
  const std::unique_ptr<Members> members;

 public:
  PairFSISolid(class LAMMPS *);
  ~PairFSISolid() override;
  void init_style() override;
  void compute(int, int) override;
  std::vector<Effect> effects() const override;
  double memory_usage() override;

  void *extract(const char *, int &) override;    // "hourglass", for fix adapt
  FSI::Facts facts() const override;
  void set_fields(FSI::Discretization &) override;
  void add_messages(FSI::Message &, FSI::Message &) override;
  void begin_state(bool) override;    // with new neighbor lists new rows
  bool add_rates(bool) override;
  void advance(bool) override;
  void add_number_density(double *, bool of_all_bodies) override;
  void undo_advance() override;
  void find_idle(const Census &, const Idle &) const override;

  // gradients: 0 = plain, else the number of terms for which they are exact (fsi_gradient.h): dim
  // linear ones (Bonet and Lok 1999), or the quadratic ones too
  int terms() const;
  bool has_hourglass() const { return xi > 0.0; }

 protected:
  bool handles(int a, int b) const override { return a == FSI::SOLID && b == FSI::SOLID; }
  bool defines(int species) const override { return species == FSI::SOLID; }
  FSI::State make_state(const FSI::Material &) const override;

 private:
  class FixFSIStress *fix_stress;
  FSI::Fields &fields;
  // local and ghost: sums of the velocity gradient, afterwards L and the coefficients of its
  // weights (fsi_gradient.h)
  double **grad;
  int ngrad() const;
  bool any_gradient;    // in this step: coefficients are needed by forces, so in setup, too
  // adds to grad, over the own body, at the positions dt/2 ago, to which the velocities belong:
  // plain, sum_j V_j (v_j - v_i)(x)grad_i W_ij; else sum_j w (v_j - v_i)(x)phi and, packed, the
  // moments sum_j w phi (x) phi, with grad_i W_ij = -w x_ij/V_j and the basis phi of x_ji/h; then
  // these moments at the positions of now, for the forces
  void velocity_gradient(double dt);
  template <int D, int TERMS> void advance_stress(bool advance);
  // forces of hourglass control from half a step back to half a step ahead, with L of the time
  // between
  void advance_hourglass(double dt);

  enum GradientKind { PLAIN, CORRECTED_LINEAR, CORRECTED_QUADRATIC };
  double epsilon, xi;
  double artificial_stress() const;
  int gradient;
  bool bodies, packs;
  FSI::RowList &own, &others;
  void find_rows();

  // planes of symmetry: rows of images in the own body and of others, counted fully and by half
  FSI::Images &images;
  FSI::RowList (&own_images)[2], (&other_images)[2];
  std::vector<int> types_with_images;
  std::vector<double> image_sums;
  void find_image_rows();
  void check_planes() const;
  template <int D> auto single() const;
  template <int D, int TERMS> void add_image_gradients(double half);
  template <int D, int TERMS> void add_image_hourglass();
  template <int D, int TERMS, int FLAGS, class Laws>
  void add_image_forces(Laws, const FSI::RowList (&)[2]);
  std::vector<double> hourglass_rate, forces;    // local and ghost, rows of row_of_forces
  template <int D> void rotate_hourglass(double);

  // of local and ghost solids (fsi_solid_rows.h)
  std::vector<double> rate_records, force_records;
  template <int D> void fill_rate_records(double half);
  template <int D, int TERMS> void fill_force_records();

  template <class F> void with_loops(F) const;
  template <bool PACKED, int TERMS, class K> void pair_forces(const K &);
  template <bool PACKED, int TERMS, class K>
  void own_forces(const K &, const FSI::PairLaws &, bool sums);
};

}    // namespace LAMMPS_NS

#endif
#endif
