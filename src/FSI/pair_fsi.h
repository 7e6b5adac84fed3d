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

// What the pair styles fsi/fluid and fsi/solid share: materials per atom type, link to fix fsi,
// restart.

#ifndef LMP_PAIR_FSI_H
#define LMP_PAIR_FSI_H

#include "atom.h"
#include "fsi_hub.h"
#include "fsi_keywords.h"
#include "fsi_material.h"
#include "fsi_part.h"
#include "pair.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

class PairFSI : public Pair, public FSI::Part {
 public:
  PairFSI(class LAMMPS *, const char *style);
  ~PairFSI() override;
  void settings(int, char **) override;
  void coeff(int, char **) override;
  void init_style() override;
  double init_one(int, int) override;
  void write_restart(FILE *) override;
  void read_restart(FILE *) override;
  void write_restart_settings(FILE *) override;
  void read_restart_settings(FILE *) override;

  void *extract(const char *, int &) override;    // "alpha", for fix adapt
  FSI::Facts facts() const override;
  std::vector<Effect> effects() const override = 0;
  bool is_set_up() const override { return disc != nullptr; }
  Rank rank() const override { return PAIRS; }

 protected:
  const std::string style;    // for messages
  FSI::Keywords keywords;     // of settings()
  // of fix fsi. Null: not since settings() or coeff()
  const FSI::Discretization *disc = nullptr;
  FSI::StepState *step = nullptr;
  FSI::Ledger *ledger = nullptr;
  FSI::Ghosts *ghosts = nullptr;
  std::vector<FSI::Material> material;    // per type; species NONE where pair_coeff said NULL
  double alpha = 0.0, beta = 0.0;         // artificial/visc (fsi_pair_laws.h)
  double contact_range = 1.0;             // of solids, over dx (fsi_pair_laws.h)
  int self_contact = 0;                   // of a body with itself
  int first_level = 0;                    // types from here on: pair_coeff keeps them; 0: none

  // does this style handle pairs of these species?
  virtual bool handles(int, int) const = 0;
  // may pairs of these species go without a force? alone: without a hybrid style
  virtual bool leaves_alone(int, int, bool alone) const { return false; }
  // equation of state and constants of a type
  virtual FSI::State make_state(const FSI::Material &) const = 0;
  // does this style tell fix fsi the state of a type of this species?
  virtual bool defines(int) const = 0;
  // does this style visit neighbors that move?
  virtual bool needs_neighbors() { return true; }

  void check_pair_coeff(int, char **) const;
  void keep_levels();
  std::vector<int> types_of_levels() const;
  FSI::State solid_state(const FSI::Material &, bool plane_stress) const;
  bool several_bodies() const;
  bool any_relaxes() const;           // has a material a Prony series?
  virtual void check_settings() {}    // what a row of keywords cannot say
  void artificial_row(const std::string &of);
  void contact_row();
  void check_contact() const;
  void check_same_materials() const;
  void check_species() const;
  class PairHybrid *hybrid_style() const;    // whose style this is, or null
  void check_pairs() const;                  // has that left it those of its sums?
  void drop_reference() const;
  bool has_artificial() const { return alpha > 0.0 || beta > 0.0; }
  void set_flags();
  void allocate();
  std::string named_effects() const;    // those that the script names, for messages
  void check_tally();
};

}    // namespace LAMMPS_NS

#endif
