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
PairStyle(fsi/fluid,PairFSIFluid);
// clang-format on
#else

#ifndef LMP_PAIR_FSI_FLUID_H
#define LMP_PAIR_FSI_FLUID_H

#include "pair_fsi.h"

#include <functional>
#include <memory>
#include <vector>

namespace LAMMPS_NS {
namespace FSI {
  struct Contact;
  class Fields;
  struct FluidParticles;
  struct ForceLaws;
  struct PairSet;
  struct PairSums;
  class PairSets;
  struct Row;
  class Shear;
  struct Visible;
}    // namespace FSI

// Fluid-fluid and fluid-solid pairs: pressure, viscosity, density rate and diffusion, mirror
// images.

class PairFSIFluid : public PairFSI {
  struct Members;
  const std::unique_ptr<Members> members;

 public:
  enum Couple { WALL, FULL };

  PairFSIFluid(class LAMMPS *);
  ~PairFSIFluid() override;
  void init_style() override;
  void compute(int, int) override;
  FSI::Facts facts() const override;
  bool has_solids() const;
  std::vector<Effect> effects() const override;
  void find_idle(const Census &, const Idle &) const override;
  double memory_usage() override;
  void settings(int, char **) override;
  bool has_laminar() const { return laminar; }
  bool sticks_to_solids() const { return laminar && !solids_slip && has_solids(); }
  double sound_of(const FSI::Material &) const;

  void set_fields(FSI::Discretization &) override;
  void add_messages(FSI::Message &, FSI::Message &) override;
  void begin_state(bool) override;    // with new neighbor lists new rows
  bool add_rates(bool) override;
  void advance(bool) override;
  void add_number_density(double *, bool of_all_bodies) override;
  void prescribe() override;
  void integrate_substeps() override;
  void react() override;
  void undo_advance() override;
  // velocity gradients of local fluid particles as they are now
  const FSI::Shear &find_shear();
  // adds sum_j V_j x_ji.grad_i W_ij of fluid particles (dim inside a fluid, less at its surface)
  void add_position_divergence(double *div);
  void add_gradient_sum(double *) override;
  // Calls use(level of the scene, rows, mirror) for fluid particles, or their images in mirror, and
  // wall particles that may be within the support
  using UseOfRows =
      std::function<void(size_t level, const std::vector<FSI::Row> &, const FSI::Mirror &)>;
  void for_rows_with_walls(const UseOfRows &use);

 protected:
  bool handles(int a, int b) const override { return a == FSI::FLUID || b == FSI::FLUID; }
  // Of a hybrid style it takes LAMMPS' list of all pairs: its own would be copied from that
  bool needs_neighbors() override { return !hybrid_style(); }
  // walls of held solid particles need no pair style of their own; wall particles act on fluids
  // only
  bool leaves_alone(int a, int b, bool alone) const override
  {
    const auto rigid = [](int s) {
      return s == FSI::SOLID || s == FSI::RIGID;
    };
    return rigid(a) && rigid(b) && (alone || a == FSI::RIGID || b == FSI::RIGID);
  }
  bool defines(int species) const override { return species != FSI::NONE; }
  FSI::State make_state(const FSI::Material &) const override;
  FSI::PairSets &pairs;

  // settings
  int preset;                             // fsi_preset.h, from 1 on; 0: none
  double speed;                           // of the flow, for it
  double eddies;                          // C_s of Smagorinsky; 0: none
  double background, background_speed;    // one of them
  double background_pressure() const;
  void check_settings() override;
  double sound, delta;     // sound: of fluids whose material has none; 0: there is no
                           // default
  double shifting;         // coefficient C of particle shifting; 0 = off
  int shift_every;         // steps from one displacement to the next
  double surface_ratio;    // of the free-surface rule
  // distance over the mean spacing from which on solids push fluid off; 0: they do not
  double solids_guard;
  int tait, laminar, implicit, given_couple, couple, extrapolate, tension, solids_slip;
  int surfaces;                      // does the density follow surfaces (fsi_number_density.h)?
  class FixFSIStress *fix_stress;    // null: no solid has a stress
  std::vector<class ComputeFSIForce *> force_computes;
  std::vector<FSI::Part *> walls_of_particles;

  bool by_preset(const char *keyword) const;    // has the preset set it?
  void check_effects(const FSI::Facts &of_solids) const;
  // local and ghost, gathered at the start of each loop
  std::vector<double> points, forces, viscous_forces, pressure_over_density;
  std::vector<double> taken;    // by coupling and friction, if there is a ledger
  std::vector<std::vector<FSI::Contact>> guards;    // per level and type: where fluid is pushed off
  void find_guards();
  double *fade =
      nullptr;    // of fluids of several levels: what is left of shifting's factor; or null
  std::vector<double> volumes;
  void find_fades();
  template <class T, class K>
  void add_fades(const K &, const std::vector<FSI::Row> &, const FSI::Visible &);
  // per particle, by how much more thin bodies count (fsi_sight.h); null: there are none
  double *backfill = nullptr, *backfill_weight = nullptr;
  FSI::FluidParticles particles_at(const double *points);    // null: at atom->x
  template <int D> double volume_of(int i) const;
  // positions a time t later; what else a loop needs is up to complete(i, point)
  template <int D, class Complete> FSI::FluidParticles gather(double t, Complete);
  // the density rate (continuity) of fluids, and the sums of particle shifting, at the positions
  // dt/2 ago, to which the velocities belong
  FSI::Fields &fields;
  double *rate = nullptr;    // local after the reverse communication
  int nshift() const, shift_sums() const;
  bool fills() const
  {    // no free surfaces: with a background pressure they would blow up
    return background > 0.0 || background_speed > 0.0;
  }
  bool open_ends;
  double *const *velocity_of_shifting() const;
  // of solids that fluid sticks to: the sums of v W, and of W, of the fluid around
  double **beyond = nullptr;
  void add_velocities_at_solids();
  void extrapolate_velocities();
  template <int D> void correct_powers();
  void find_viscosities(const FSI::FluidParticles &, FSI::ForceLaws &);
  template <int D> FSI::FluidParticles gather_for_rates(double dth);
  template <int D> void add_density_rate(double dt);
  void advance_density();
  template <int D, bool FILLS>
  void displacements(double dt);    // turns the sums of particle shifting of local fluid atoms into
                                    // displacements
  template <int D> void add_gradients(double *);
  FSI::ForceLaws laws_of_forces();
  template <int D> void add_wall_forces(const FSI::Walls::Reflection &, const double (&total)[D]);
  template <int D> void compute_forces();
  template <int D>
  void add_viscous_forces(const FSI::FluidParticles &, FSI::ForceLaws, bool on_bodies,
                          FSI::PairSums *);
  template <int D> void split_forces(const FSI::FluidParticles &, const FSI::ForceLaws &);
  template <int D>
  void add_implicit_viscosity(const FSI::FluidParticles &, FSI::ForceLaws, FSI::PairSums *);
  double given_ghosts = 0.0,
         raised_ghosts = -1.0;    // cutoffs: that of the user, as raised for images
  // the hybrid style that this one makes sum its virial pair by pair; null: none
  Pair *hybrid = nullptr;
  int no_fdotr_before = 0;
  void take_virial(Pair *of);
  FSI::Contact guard_of(int type, double spacing) const;
};

}    // namespace LAMMPS_NS

#endif
#endif
