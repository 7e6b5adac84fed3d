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

// What commands between two runs have changed: particles, which are not those of the last setup any
// more; and fixes, computes, regions and pair styles, to which others point since then.

#ifndef LMP_FSI_CHANGES_H
#define LMP_FSI_CHANGES_H

#include "pointers.h"

#include <cstdint>
#include <set>
#include <vector>

namespace LAMMPS_NS::FSI {

class Changes : protected Pointers {
 public:
  explicit Changes(LAMMPS *lmp) : Pointers(lmp), nlocal(0), known(0), stale(true), pours(false) {}

  // particles of this rank
  void begin_run();                  // in init(): nothing is known of them
  void forget() { stale = true; }    // one was made, or what others know of it is gone
  void made(int i);                  // in set_arrays()
  void in_step();                    // the state is brought up to date
  void end_run() { known = fingerprint(); }
  bool of_atoms() const;    // since then
  bool any_mass() const;    // has any on any rank been in a run? all ask together

  // Atoms in the restart file that was read. What it has of each stays in their order until a fix
  // takes it, which delete_atoms changes
  bigint in_file = -1;
  void check_file() const;

  // what a run points to; what fixes that are gone had of particles is not of now any more
  void set_up();
  bool known_setup() const { return !there.empty(); }
  void check_pre_no() const;    // in its first step: an error if it is another one
  static bool in_first_step(const class Update *);

 private:
  int nlocal;
  uint64_t known;
  bool stale, pours;          // pours: does another fix make atoms?
  std::set<tagint> births;    // IDs of atoms that a fix made in a run, until lists are new
  void check_births();
  std::vector<std::uintptr_t> there;
  uint64_t fingerprint() const;
  std::vector<std::uintptr_t> present() const;
};

}    // namespace LAMMPS_NS::FSI

#endif
