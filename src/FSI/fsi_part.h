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

// What takes part in a step: pair styles, walls, what keeps stress, chooses the time step or writes
// reports. Fix fsi finds the parts that there are and calls them in turn; it knows none of their
// styles.

#ifndef LMP_FSI_PART_H
#define LMP_FSI_PART_H

#include "fsi_keywords.h"
#include "fsi_walls.h"

#include <functional>
#include <string>
#include <vector>

namespace LAMMPS_NS::FSI {

class Ghosts;
class Message;
struct Discretization;
struct Ledger;
struct Preset;
struct StepState;

// What others need to know of a style. A style that there is not has none of it.
struct Facts {
  enum Style { NONE, OF_FLUIDS, OF_SOLIDS, OF_TOTAL_LAGRANGIAN_SOLIDS, OF_GRAINS };
  Style style = NONE;    // of pairs
  // of fluids
  const Preset *preset = nullptr;
  bool laminar = false;                  // laminar viscosity
  bool implicit_viscosity = false;       // of a step with no limit from it
  bool couples_stress = false;           // solids act with a pressure or stress of their own
  bool density_at_surfaces = false;      // density/surface
  bool density_follows_shift = false;    // where there are open ends
  int shift_every = 0;                   // steps from one shift to the next; 0: none
  // of solids
  double contact = 0.0;    // range over dx
  bool self_contact = false;
  bool hourglass = false;
  bool by_rate = false;    // the stress is integrated: fix fsi/stress has it
  bool corrected_gradients = false;
  // of both
  double alpha = 0.0;    // artificial viscosity
  // of fixes: what chooses the time step, sub-steps; walls; what keeps strain or stress
  bool chooses_step = false, chooses_substeps = false;
  bool mirror_walls = false, segments = false, particle_walls = false;
  bool keeps_solids = false;
  // of computes
  bool keeps_account = false;    // of energy
};
inline Facts only(bool Facts::*what)
{
  Facts facts;
  facts.*what = true;
  return facts;
}
// of the pair style of fluids, of solids, that there is now, hybrid or not
Facts facts_of_fluids(LAMMPS *);
Facts facts_of_solids(LAMMPS *);
bool has_open_ends(const LAMMPS *);    // fixes fsi/inlet and fsi/outlet

class Part {
 public:
  virtual Facts facts() const { return {}; }

  // The order of calls, whatever that of the script is. In advance() several write densities: the
  // fluid's rates first, then what holds them in a stream, then what gives those of a buffer.
  enum Rank { PAIRS, STATES, STREAMS, OPEN_ENDS, SURFACES };
  virtual Rank rank() const { return STATES; }

  // Between runs: is it as it was when the last one was set up, or has a command given it anew?
  virtual bool is_set_up() const { return true; }

  // Before a run, when the states of all types are known: arrays per atom for the effects that
  // are on; then what of them goes to ghosts, and what pairs leave on ghosts and comes back.
  virtual void set_fields(Discretization &) {}
  virtual void add_messages(Message &to_ghosts, Message &back) {}

  // In a step, in this order. Not to advance, in setup: the same for the state that there is,
  // nothing evolves.
  virtual void start_step() {}    // before anything moves: may change the time step
  // mirrors, and where the force on each is summed
  virtual void add_walls(Walls &, std::vector<WallForce> &) {}
  // positions are those of the middle of the step, where walls are and pairs meet
  virtual void begin_state(bool advance) {}
  // sums over pairs, some of them left on ghosts; whether there are any
  virtual bool add_rates(bool advance) { return false; }
  virtual void advance(bool advance) {}    // density, stress, bonds to the middle of the step
  // psi, of what it has pairs of
  virtual void add_number_density(double *n, bool of_all_bodies) {}
  // sum_j grad_i W_ij/psi_bulk of fluids, components one after the other
  virtual void add_gradient_sum(double *s) {}
  virtual void end_state(bool advance) {}    // when ghosts have it
  // of walls: adds the forces in atom->f with this sign, -1 before those of fluids and +1 after
  virtual void tally_fluids(double sign) {}
  // when all forces are there: those that bring velocities to what is given
  virtual void prescribe() {}
  virtual void integrate_substeps() {}    // what takes shorter steps than the kick of all
  virtual void react() {}    // to what bodies have done in this step, before the kick of all

  // from the middle of a step to its start, a state to go on from that a run which stops leaves:
  // what advance() did, if it was called; what moves
  virtual void undo_advance() {}
  virtual void go_back() {}

  // Before the first step: what is simulated
  using Effect = Keywords::Effect;
  virtual std::vector<Effect> effects() const { return {}; }
  // effects with nothing to act on: what, why
  using Idle = std::function<void(const std::string &, const std::string &)>;
  struct Census {
    bigint fluids, solids;
  };
  virtual void find_idle(const Census &, const Idle &) const {}

 protected:
  ~Part() = default;    // a style is deleted as what LAMMPS knows it as
};
// Before the first step, when it changes: every effect that is on, every one that is not and how
// to turn it on; then advice, and what has nothing to act on (fsi_advice.cpp)
void announce(LAMMPS *, const Discretization &, const StepState &, const std::vector<Part *> &,
              bool keeps_account, std::string &announced);

inline bool any_is(const std::vector<Part *> &parts, bool Facts::*what)
{
  for (const auto *p : parts)
    if (p->facts().*what) return true;
  return false;
}

}    // namespace LAMMPS_NS::FSI

#endif
