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

#include "fsi_bond_rows.h"
#include "fsi_contact.h"
#include "fsi_volumetric.h"
#include "pair_fsi.h"

#include <vector>

namespace LAMMPS_NS {

// Elastic solids in total-Lagrangian form. The deformation gradient of particle i is
//   F_i = sum_j (x_j - x_i) (x) G_ij
// over its bonds, the neighbours in the reference configuration, and the force is minus the
// derivative of the energy sum_i V_i psi(F_i): momentum, angular momentum and energy are kept to
// round-off and time step. Particle i alone gives the forces -V_i P_i G_ij to its partners and the
// opposite to itself, so neither F nor P crosses ranks. Particles of different bodies meet by
// contact only.

class PairFSISolidTL : public PairFSI {
 public:
  PairFSISolidTL(class LAMMPS *);
  ~PairFSISolidTL() override;
  static PairFSISolidTL *find(class LAMMPS *);    // null: there is none
  void init_style() override;
  void compute(int, int) override;
  int pack_forward_comm(int, int *, double *, int, int *) override;
  void unpack_forward_comm(int, int, double *) override;
  int pack_reverse_comm(int, int, double *) override;
  void unpack_reverse_comm(int, int *, double *) override;
  void *extract(const char *, int &) override;
  std::vector<Effect> effects() const override;
  void advance(bool) override;
  // Stiff solids: after the kick of what acts from outside is known, with a step that many times
  // shorter
  void integrate_substeps() override;
  void add_costs(Costs &) const override;
  void find_idle(const Census &, const Idle &) const override;
  double memory_usage() override;

  // all forces of this style, on local atoms, at the positions in atom->x of local and ghost atoms
  void internal_forces();
  // positions, and velocities where a force needs them, of ghost solids from their owners
  void forward_positions();
  // law hypo: deviatoric stress from half a step back to half a step ahead, at positions dt/2 ahead
  // of the velocities' time
  bool hypoelastic() const { return law == HYPO; }
  void advance_stress(double dt);
  void break_bonds();    // keyword damage
  const std::vector<int> &solids() const;
  // of this rank's particles at the last forces; kept for compute fsi/energy
  double strain_energy;

  struct Stress {
    double sigma[6];    // Cauchy: xx yy zz xy xz yz
    double J;           // det F
    double pressure() const { return -(sigma[0] + sigma[1] + sigma[2]) / 3.0; }
    double von_mises() const;
  };
  void begin_stress();    // before stress(), on all ranks: what it needs of other particles
  Stress stress(int i) const;    // of local atom i at the positions in atom->x
  double volume_ratio(int i) const;    // det F, likewise

 protected:
  void check_settings() override;
  bool handles(int, int) const override;
  bool defines(int species) const override { return species == FSI::SOLID; }
  bool needs_neighbors() override { return several_bodies(); }
  FSI::State make_state(const FSI::Material &) const override;

 private:
  enum Law { SVK, NEOHOOKEAN, HYPO };
  enum Volumetric { AUTO, SMOOTHED, LOCAL };
  double zeta, damage;
  int law, plane_stress, linear, plain, volumetric;
  int is_hypoelastic;    // for extract()
  class FixFSIReference *reference;
  class FixFSIStress *fix_stress;    // null: no law needs it
  std::vector<FSI::StVenantKirchhoff> svk;    // per type
  std::vector<FSI::NeoHookean> neohookean;
  std::vector<FSI::HypoElastic> hypo;
  double **fsolid;
  int nmax;

  void refuse_constraints() const;
  bool takes_substeps() const;    // or may choose to
  void refuse_rigid_parts() const;
  double stored(int i) const;
  template <class L> const L *laws() const;
  // the last ones act on held particles alone: of no use to sub-steps but the last, whose forces
  // are seen from outside
  std::vector<FSI::BondRow> rows;
  int nmoving, changes_seen;    // how many do not; when they were found
  // forces of those are wanted; all solids have one density and one speed of sound
  bool only_moving, one_material;
  void find_rows();
  std::vector<double> points;    // of solids and their ghosts, gathered for the loop over bonds
  template <int D> void gather_points();
  FSI::VolumetricStrain smoothed;
  bool sends_strains;    // what messages carry: these, or positions and forces
  bool is_smoothed(const FSI::Material &) const;
  double smooth_strains(bool of_all);    // their energy; of_all: theta also where it does not count
  template <class Call> void with_law(Call call);    // call(law, constant with the dimension)
  template <class L, int D> void bond_forces();
  std::vector<FSI::Contact> contacts;    // by both types
  template <int D> void contact_forces();
  template <int D> void self_contact_forces();
  template <int D>
  void push(int i, int j, const double *xij, double rsq, const FSI::Contact &, double share);
  template <int D> void add_smoothed(int i, const double *F, FSI::PiolaStress<D> &) const;
  template <int D> void deformation(int i, double *F) const;
  template <int D> void advance_stress_of_all(double dt);
};

}    // namespace LAMMPS_NS

#endif
#endif
