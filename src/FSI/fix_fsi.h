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
FixStyle(fsi,FixFSI);
// clang-format on
#else

#ifndef LMP_FIX_FSI_H
#define LMP_FIX_FSI_H

#include "fsi_fields.h"

#include <memory>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

namespace LAMMPS_NS {
namespace FSI {
  class Changes;
  class Check;
  class Clamps;
  class Clock;
  class NumberDensity;
  class Part;
  class Population;
  struct Discretization;
  struct Ledger;
  struct StepState;
}    // namespace FSI

// The centre of the package: integrates in time (position Verlet) and calls what takes part in a
// step, which brings density and stress of every particle to the middle of the step before forces
// are computed. It has the objects that those share.

class FixFSI : public FSI::FixFields {
  struct Members;
  const std::unique_ptr<Members> members;

 public:
  FixFSI(class LAMMPS *, int, char **);
  ~FixFSI() override;
  // the fix fsi of this LAMMPS; an error that names who needs it if there is none
  static FixFSI *find(class LAMMPS *, const std::string &who);
  // null: there is none. Who is asked between runs may know one that is gone
  static FixFSI *there(class LAMMPS *);
  // the same, for who needs what the setup of a run finds: an error if there was none since atoms
  // were made, deleted or changed, or pair styles given
  static FixFSI *ready(class LAMMPS *, const std::string &who);
  // is that of the fix fsi that there is?
  static bool has(class LAMMPS *, const FSI::Discretization *known);
  // of pairs in the first step of a run with pre no: an error if there is another fix fsi, or none
  static void check_pre_no(class LAMMPS *, const FSI::Discretization *known);
  // once, before the first run after a restart file was read: what the file keeps for fixes that go
  // by another ID now
  bool ids_checked = false;
  int setmask() override;
  void init() override;
  void setup(int) override;
  void setup_pre_force(int) override { update_state(false); }
  void initial_integrate(int) override;
  void post_integrate() override;
  void pre_exchange() override;
  void pre_force(int) override { update_state(true); }
  void final_integrate() override;
  void end_of_step() override;
  void post_run() override;
  void set_arrays(int) override;
  void write_restart(FILE *) override;
  void restart(char *) override;

  // what takes part in a step, in the order of its calls; from init() on
  const std::vector<FSI::Part *> &parts;
  FSI::Discretization &disc;    // constant after init()
  FSI::StepState &step;
  FSI::Ledger &ledger;
  FSI::Ghosts &ghosts;    // messages of parts
  FSI::Clock &clock;
  FSI::Check &check;        // stops a run that has lost its meaning
  FSI::Changes &changes;    // since the last run
  FSI::Population &population;
  FSI::NumberDensity &number_density;
  FSI::Clamps &clamps;    // rigid bodies
  // what a style takes of these when a run begins, by their types; const where it only reads
  template <class... Of> FixFSI *link(Of *&...of)
  {
    const auto all = std::make_tuple(&disc, &step, &ledger, &ghosts, &check, &population,
                                     &number_density, &clamps);
    ((of = std::get<std::remove_const_t<Of> *>(all)), ...);
    return this;
  }

 private:
  int given_substeps;
  std::string announced;    // the list of effects as last printed
  void set_fields();
  void find_parts();
  FSI::Record record() const;    // of the command, for the next one
  void goes_on(const FSI::Record &, const std::string &when);

  // ghosts get density, number density where in use, what parts of the step add; back come the
  // sums that pairs left on them
  FSI::Message forward, back;
  bool fresh_start() const;
  // Particles of types without a material, which other pair styles are for, as grains: those of the
  // group are moved, and turned if they can be; nothing else of the package looks at them
  bool others_turn = false;
  void find_others();
  void turn() const;
  void update_state(bool);

 protected:
  // loops over particles, which fix fsi/kk has on its device
  virtual void drift();
  virtual void kick();
  virtual void find_near_walls();
  virtual void send_state();    // to ghosts
};

}    // namespace LAMMPS_NS

#endif
#endif
