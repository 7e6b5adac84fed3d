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

#ifdef FIX_CLASS
// clang-format off
FixStyle(fsi/stress,FixFSIStress);
FixStyle(FSI_HISTORY,FixFSIHistory);
// clang-format on
#else

#ifndef LMP_FIX_FSI_STRESS_H
#define LMP_FIX_FSI_STRESS_H

#include "fsi_fields.h"
#include "fsi_part.h"

#include <string>
#include <string_view>
#include <vector>

namespace LAMMPS_NS {

// Deviatoric stress of hypoelastic solids: owns it, evolves it by the Jaumann rate (paper eq. 3).
// Driven by fix fsi, which forms the velocity gradient.

class FixFSIStress : public FSI::FixFields, public FSI::Part {
 public:
  FixFSIStress(class LAMMPS *, int, char **);
  ~FixFSIStress() override;
  int setmask() override { return FixConst::POST_RUN; }
  void post_run() override;
  void init() override;
  FSI::Facts facts() const override { return FSI::only(&FSI::Facts::keeps_solids); }
  std::vector<Effect> effects() const override;
  void find_idle(const Census &, const Idle &) const override;

  // deviatoric stress per atom, in-plane in 2D; see fsi_tensor.h for the order
  double **stress;
  double **hourglass;    // force per atom that pair_style fsi/solid keeps here; null without its
                         // hourglass control
  int plane_stress;
  int plastic;    // materials yield
  // keyword self of pair_style fsi/solid: enters the places of those that have none yet, then tells
  // ghosts; how far two of them were apart
  void enter_start(const std::vector<FSI::State> &, FSI::Ghosts &);
  double distance_at_start(int i, int j) const;

  // half a step back to half a step ahead, with the velocity gradient L of the time between
  // (fsi_solid_laws.h). Returns what of the work per volume the elastic energy has not got: to
  // plastic strain, and, with a minus and if that is asked for, what that gets without work
  template <int D>
  double advance_stress(int i, const double *L, double dt, const FSI::State &material,
                        bool account);

  // equivalent plastic strain of atom i
  double plastic_strain(int i) const { return plastic ? strain[i] : 0.0; }
  double shear_energy(int i, double shear) const;    // of atom i with this shear modulus

 private:
  static constexpr double FOREIGN = -1.0e300;    // first entry of an atom that was no solid when a
                                                 // run began
  int ns;                                        // components of the deviator
  double **start;    // places, and whether there is one; null without keyword self
  double *strain;    // equivalent plastic strain; null without plastic
  double **left;     // where the last run has left particles, until the next one
  void choose_fields();
  void look_for_turns(const FSI::Discretization &);
};

// What a law of total-Lagrangian solids keeps of each particle (fsi_law_list.h): it goes with its
// atom from rank to rank, through restart files and from one pair_style command to the next.
// Internal: pair_style fsi/solid/tl makes it where a law has a history, and only there.

class FixFSIHistory : public FSI::FixFields {
 public:
  FixFSIHistory(class LAMMPS *, int, char **);
  ~FixFSIHistory() override;
  int setmask() override { return 0; }

  // that of this name (empty: none) and so many numbers of each particle; what there was of another
  // is gone. All ranks together
  static FixFSIHistory *keep(class LAMMPS *, std::string_view name, int columns);
  double **of;    // of local atoms

 private:
  const std::string name;
  const int columns;
};

}    // namespace LAMMPS_NS

#endif
#endif
