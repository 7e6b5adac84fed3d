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

// Damage of total-Lagrangian solids: bonds that break where they are stretched too far.

#ifndef LMP_FSI_DAMAGE_H
#define LMP_FSI_DAMAGE_H

#include "fsi_bond_store.h"

#include <functional>
#include <vector>

namespace LAMMPS_NS::FSI {

class Damage : protected Pointers {
 public:
  Damage(LAMMPS *lmp, BondStore &bonds) : Pointers(lmp), bonds(bonds) {}

  // Removes bonds longer than stretch times their reference length, and makes the gradient anew
  // from those left; a particle whose bonds no longer suffice has no stress, but keeps them until
  // they are too long, lest contact acts at once on a pair that is near. The gradient of
  // those left may be another than that of all: where the energy (per volume, of local atom i)
  // would grow by it, the particle's weight shrinks instead, so that breaking makes no energy.
  // Looks only at particles of which a bond may have become too long since.
  using Energy = std::function<double(int)>;
  // That of a crushed particle is 0: it keeps its bonds, likewise.
  // spare: how far its partners may move until it is
  using Spare = std::function<double(int)>;
  void break_bonds(double stretch, const Energy &, const Spare &);
  void forget() { seen.clear(); }    // indices have changed
  double memory_usage() const { return bytes_of(seen, slack); }

 private:
  BondStore &bonds;
  // positions of solids and ghosts at the last look, empty = indices have changed; how far
  // particles have moved apart since indices changed, at most; of each solid, how far they may
  // before one of its bonds can be too long
  std::vector<double> seen, slack;
  double apart = 0.0;

  template <int D> void move_apart();
  template <int D> void break_as(double stretch, const Energy &, const Spare &);
  template <int D> bool is_longer(int i, int k, double stretch, double **x, double &left) const;
  void crush(int i, const Spare &, double &left);
};

}    // namespace LAMMPS_NS::FSI

#endif
