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
FixStyle(FSI_REFERENCE,FixFSIReference);
// clang-format on
#else

#ifndef LMP_FIX_FSI_REFERENCE_H
#define LMP_FIX_FSI_REFERENCE_H

#include "fsi_bond_store.h"

#include <memory>
#include <string>
#include <unordered_map>

namespace LAMMPS_NS {
namespace FSI {
  class Damage;
  class SelfContact;
  class Swaps;
}    // namespace FSI

// The reference configuration of total-Lagrangian solids: for every particle its bonds to the
// neighbors of its own body, with the gradient's weights. Made by pair_style fsi/solid/tl; taken
// at the start of the first run; travels with its atom between ranks, through restart files and
// from one pair_style command to the next.

class FixFSIReference : public FSI::BondStore {
  struct Members;
  const std::unique_ptr<Members> members;

 public:
  static constexpr char ID[] = "FSI_REFERENCE";
  FixFSIReference(class LAMMPS *, int, char **);
  ~FixFSIReference() override;
  int setmask() override { return FixConst::POST_NEIGHBOR; }
  void init() override;
  void setup_post_neighbor() override;
  void post_neighbor() override;
  void unpack_restart(int, int) override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  double memory_usage() override;

  std::string stressed_by;      // strains or rates, the law of the last run; empty: none yet
  bool end_corrected = true;    // volumes of the energy's integral with corrections at faces
  FSI::Damage &damage;
  FSI::SelfContact &self;
  FSI::Swaps &swaps;    // messages of solids

 private:
  std::string made;    // how the bonds were: keywords of pair_style fsi/solid/tl; empty: none yet
  std::string as_now() const;
  bool has_record = false;
  bool resting = false;    // no pair_style fsi/solid/tl

  void find_planes();
  void refuse_other_materials() const;
  void refuse_split_bodies() const;
  using NewIDs = std::unordered_map<tagint, tagint>;    // by the old ones
  void follow_commands();
  bool anything_gone();
  NewIDs new_ids();
  int cut(int i, const NewIDs &);
  void take_bare();
  void find_partners();
  void correct_ends(const std::vector<int> &of);
};

}    // namespace LAMMPS_NS

#endif
#endif
