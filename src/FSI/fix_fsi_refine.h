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
FixStyle(fsi/refine,FixFSIRefine);
// clang-format on
#else

#ifndef LMP_FIX_FSI_REFINE_H
#define LMP_FIX_FSI_REFINE_H

#include "fix.h"

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace LAMMPS_NS {
namespace FSI {
  class Cells;
  struct Discretization;
  class Ghosts;
  struct Ledger;
  class Population;
  class Sight;
  struct StepState;
  class Zones;
}    // namespace FSI

// Levels of one fluid, atom types each with half the mass of the one before: where a finer one is
// wanted a particle splits in two, elsewhere two that are nearest to each other merge. Only in
// multiples of some steps, with new neighbor lists: neither lists nor restarts change when.

class FixFSIRefine : public Fix {
 public:
  FixFSIRefine(class LAMMPS *, int, char **);
  ~FixFSIRefine() override;
  int setmask() override { return FixConst::PRE_EXCHANGE; }
  void init() override;
  void setup_pre_exchange() override;
  void pre_exchange() override;
  double compute_vector(int n) override { return total[n]; }
  void write_restart(FILE *) override;
  void restart(char *) override;
  double memory_usage() override;

 private:
  struct Division {    // of a particle: its halves are at x + off + dx and x + off - dx, ...
    int i = 0;
    double off[3] = {}, dx[3] = {}, dv[3] = {}, drho = 0.0;
  };
  struct Union {    // of two: what becomes of the one that stays; its energy before
    int i = 0;
    double x[3] = {}, v[3] = {}, rho = 0.0, rmass = 0.0, energy = 0.0;
  };
  enum Total { SPLITS, MERGES, LOST, GAINED, SPIN, WAITING = SPIN + 3, NTOTAL };
  // what a particle is to do: bits above those of the zones that it is in
  enum Wish { SPLIT = 1 << 16, MERGE = 1 << 17, EAGER = 1 << 18 };

  const std::string label;
  int every, settle_steps = 30;
  double finest_dx = 0.0;                     // from which types follow; 0: they are given
  std::vector<int> types, level_of;           // from the coarsest on; per type, -1: none of them
  int finest = 0;                             // level that is wanted
  const std::unique_ptr<FSI::Zones> zones;    // where the levels from 1 to that are
  const FSI::Discretization *disc = nullptr;
  FSI::StepState *step = nullptr;
  FSI::Ledger *ledger = nullptr;
  FSI::Ghosts *ghosts = nullptr;
  FSI::Population *population = nullptr;
  std::vector<class FixFSIInlet *> open_ends;
  std::vector<std::array<double, 3>> directions;    // of splitting
  double total[NTOTAL] = {};
  bigint last_event = -1;
  bool warned = false;    // in this run

  // of one event
  // per particle, local and ghost: see Wish; name; direction, from 1 on, 0: it does not split
  std::vector<tagint> carried, partner, heading;
  std::vector<int> chosen;    // per local one: index of its partner
  double local[NTOTAL] = {};

  void check_mass(int i) const;
  int level(int i) const;
  void read_types(const std::vector<std::string> &);
  void find_types();
  void check_types() const;
  void check_others() const;

  void event(bool may_split, bool may_merge);
  void look(bool may_split, bool may_merge);
  bool in_open_end(int i, int wish) const;
  void check_zones() const;
  void warn_of_bodies();
  const FSI::Sight *sight_from(int i) const;
  double crowd_of_walls(const double *x, double dx) const;
  int choose_direction(int i, const FSI::Cells &) const;
  void choose_directions(const std::vector<int> &which, const FSI::Cells &);
  template <int D> void slopes(Division &, const FSI::Cells &) const;
  void keep_off_bodies(Division &, const FSI::Cells &) const;
  void keep_off_bodies(std::vector<Union> &) const;
  std::vector<Division> plan_divisions();
  void choose_partners();
  int best_partner(int i, const FSI::Cells &) const;
  std::vector<Union> plan_unions(std::vector<int> &gone);
  void unite(const std::vector<Union> &);
  void divide(const std::vector<Division> &);
};

}    // namespace LAMMPS_NS

#endif
#endif
