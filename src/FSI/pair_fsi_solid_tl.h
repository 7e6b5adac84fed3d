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
PairStyle(fsi/solid/tl,PairFSISolidTL);
// clang-format on
#else

#ifndef LMP_PAIR_FSI_SOLID_TL_H
#define LMP_PAIR_FSI_SOLID_TL_H

#include "pair_fsi.h"

#include <array>
#include <functional>
#include <memory>
#include <vector>

namespace LAMMPS_NS {
namespace FSI {
  struct BondRow;
  struct BondSums;
  class Check;
  class Clamps;
  struct Contact;
  template <int D> struct PiolaStress;
  class SolidLaws;
  struct VolumetricStrain;
}    // namespace FSI

// Elastic solids in total-Lagrangian form. The deformation gradient of particle i is
//   F_i = sum_j (x_j - x_i) (x) G_ij
// over its bonds, the neighbors in the reference configuration, and the force is minus the
// derivative of the energy sum_i V_i psi(F_i): momentum, angular momentum and energy are kept to
// round-off and time step. Particle i alone gives the forces -V_i P_i G_ij to its partners and the
// opposite to itself, so neither F nor P crosses ranks. Particles of different bodies meet by
// contact only.

class PairFSISolidTL : public PairFSI {
  struct Members;
  class Wet;
  class Moved;
  const std::unique_ptr<Members> members;

 public:
  PairFSISolidTL(class LAMMPS *);
  ~PairFSISolidTL() override;
  void init_style() override;
  void compute(int, int) override;
  int pack_forward_comm(int, int *, double *, int, int *) override;
  void unpack_forward_comm(int, int, double *) override;
  int pack_reverse_comm(int, int, double *) override;
  void unpack_reverse_comm(int, int *, double *) override;
  FSI::Facts facts() const override;
  std::vector<Effect> effects() const override;
  void advance(bool) override;
  // Stiff solids: after the kick of what acts from outside is known, with a step that many times
  // shorter
  void integrate_substeps() override;
  void find_idle(const Census &, const Idle &) const override;
  double memory_usage() override;

  // all forces of this style, on local atoms, at the positions in atom->x of local and ghost atoms
  void internal_forces();
  // positions, and velocities where a force needs them, of ghost solids from their owners
  void forward_positions();
  // stress or history of a law that has one, from the middle of one step to that of the next, where
  // positions are; velocities are those of the time between
  void advance_stress(double dt, double since);
  void break_bonds();    // keyword damage
  // of this rank's particles at the last forces; kept for compute fsi/energy
  double strain_energy = 0.0;

  struct Stress {
    double sigma[6] = {};    // Cauchy: xx yy zz xy xz yz
    double J = 0.0;          // det F
    double pressure() const { return -(sigma[0] + sigma[1] + sigma[2]) / 3.0; }
  };
  void begin_stress();           // before stress(), on all ranks: what it needs of other particles
  Stress stress(int i) const;    // of local atom i at the positions in atom->x
  double volume_ratio(int i) const;    // det F, likewise
  int bonds(int i) const;              // that local atom i has left

 protected:
  void check_settings() override;
  bool handles(int a, int b) const override { return a == FSI::SOLID && b == FSI::SOLID; }
  bool defines(int species) const override { return species == FSI::SOLID; }
  bool needs_neighbors() override { return several_bodies(); }
  FSI::State make_state(const FSI::Material &) const override;

  // the last ones act on held particles alone: of no use to sub-steps but the last, whose forces
  // are seen from outside
  std::vector<FSI::BondRow> rows;
  virtual void find_rows();
  // Calls loop(first, last, to, sums) for the rows from first to last - 1 of the first n: here at
  // once, in an /omp style in parts. to: what the loop adds to, width numbers per particle, or null
  using RowLoop = std::function<void(int first, int last, double *to, FSI::BondSums &)>;
  virtual void over_rows(int n, double *to, int width, FSI::BondSums &, const RowLoop &loop);

 private:
  enum Volumetric { AUTO, SMOOTHED, LOCAL };
  double zeta, damage;
  int law, plane_stress, linear, plain, volumetric;
  FSI::Clamps *clamps = nullptr;    // of fix fsi
  FSI::Check *check = nullptr;
  class FixFSIReference *reference = nullptr;
  class FixFSIStress *fix_stress = nullptr;      // null: the law has no rates
  class FixFSIHistory *fix_history = nullptr;    // null: the law has no history of its own
  FSI::SolidLaws &laws;
  double **fsolid = nullptr;
  int nmax = 0;

  void refuse_constraints() const;
  void add_forces();    // to those of all
  void refuse_other_parts() const;
  static constexpr double CRUSHED = 0.1;    // of its volume
  double stored(int i) const;
  template <int D> double spare(int i) const;
  void make_laws();
  void follow_law();
  // per particle, stress of rates or the law's own; or null
  const double *const *history() const;
  int nmoving = 0,
      changes_seen = -1;    // rows that act not on held particles alone; when they were found
  // forces of those are wanted; all solids have one density and one speed of sound
  bool only_moving = false, one_material = true;
  std::vector<double> points;    // of solids and their ghosts, gathered for the loop over bonds
  template <int D> void gather_points();
  FSI::VolumetricStrain &smoothed;
  // what messages carry: strains, or positions and forces; with positions velocities, too
  bool sends_strains = false, sends_velocities = false;
  template <class Visit> void for_solids(int n, const int *listed, int first, Visit) const;
  bool is_smoothed(const FSI::Material &) const;
  double smooth_strains(bool of_all);    // their energy; of_all: theta also where it does not count
  // what call(laws per type, constant with the dimension) returns
  template <class Call> auto with_law(Call call) const;
  template <class L, int D> void bond_forces(const L *law_of);
  std::vector<FSI::Contact> contacts;    // by both types
  std::array<tagint, 2> touch = {};      // bodies that do, on this rank
  bool contact_warned = false;
  void warn_of_contact();
  template <int D> void contact_forces();
  template <int D> void self_contact_forces();
  template <int D> void fold_images(double part);
  template <int D>
  void push_image(int i, int j, const FSI::Walls::Reflection &, double rsq, const double *xij,
                  bool both, double part);
  template <int D, class Counts>
  void meet_images(int i, int j, double most, bool both, double part, Counts);
  std::vector<int> types_with_images;
  const int *types() const;
  template <int D>
  void push(int i, int j, const double *xij, double rsq, const FSI::Contact &, double share);
  template <class L, int D> void add_smoothed(int i, const double *F, FSI::PiolaStress<D> &) const;
  template <int D> void deformation(int i, double *F) const;
  template <int D> void advance_rates(double dt, double since);
  template <class L, int D> void advance_history(const L *law_of, double dt);
};

}    // namespace LAMMPS_NS

#endif
#endif
