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

// What no run may lose: numbers that are finite, densities above 0, fluids slower than their sound.
// Fix fsi asks in every step before the kick, the last moment with a state to go back to. And how a
// run that has lost them is stopped (fsi_stop.cpp), by fix fsi/watch, too.

#ifndef LMP_FSI_CHECK_H
#define LMP_FSI_CHECK_H

#include "fsi_part.h"
#include "pointers.h"

#include <string>
#include <vector>

namespace LAMMPS_NS::FSI {

// what can be wrong
enum Trouble { FINITE, MACH, DISTANCE, DENSITY, ENERGY, LOST, NTROUBLE };
constexpr double HUGE_SQUARE = 1.0e200;    // of a speed: nothing finite gets there

// with whom
struct Finding {
  double value, x[3];
  tagint tag, other;    // 0 = no particle
  int type;
  Trouble trouble;
  int field;    // of FINITE: Stop::Field
};

// How a run that goes wrong is stopped: particle, place, value, what to try; files of the state
class Stop : protected Pointers {
 public:
  enum Field { FORCE, VELOCITY, MASS_DENSITY, POSITION, MASS };
  // before all forces; in a step: where positions are, and for MIDDLE densities, too
  enum When { BEFORE, START, DRIFTED, MIDDLE };

  Stop(class LAMMPS *, const std::string &name, const Discretization &, const StepState &,
       const std::vector<Part *> &);
  Finding finding(Trouble, int i, double value, int j = -1) const;
  // what of atom i is not finite? No tag if nothing is. With forces, if they are there
  Finding not_finite(int i, bool forces) const;
  // of the findings of all ranks the one with the largest key
  Finding worst(const Finding &of_rank, double key) const;
  // what is wrong, if it is not FINITE, then step, particle and what to try
  std::string describe(const std::string &what, const Finding &, When) const;
  // error->all, after writing the files
  void stop(std::string text, const Finding &, When);

 private:
  const std::string name, restart_file, dump_file;
  const Discretization &disc;
  const StepState &step;
  const std::vector<Part *> &parts;
  // the particle of a solid or wall that a fluid particle is nearest to
  struct Neighbor {
    double distance, dx;
    tagint tag, molecule;
    int species;
    bool around;    // is its body on all sides?
  };
  Neighbor nearest_body(const Finding &) const;
  bool too_near(const Neighbor &) const;
  std::vector<Part::Effect> effects(bool of_fluid) const;
  std::string advice(const Finding &, When, const Neighbor &) const;
  std::string shorter_step(const Finding &, bool &suspect) const;
  void go_back(bool advanced);
  std::string write_state();
  void write_neighbors(const Finding &) const;
};

class Check : protected Pointers {
 public:
  static constexpr double OFF = 1.0e20;

  Check(class LAMMPS *, const Discretization &, const StepState &, const std::vector<Part *> &);
  void before_init();            // what no run may have
  void materials();              // every atom has one, of the density that its mass was made for
  void know_masses();            // those that there are are meant
  void write(Record &) const;    // these densities and masses
  void read(const Record &);
  void init();           // of a run: what a restart file or a script has put there
  void setup();          // after the first forces
  void positions();      // before lists are built: finite, and in the box
  void before_kick();    // in each step
  void before_substeps(const std::vector<int> &solids);
  void after_substeps();

 private:
  const Discretization &disc;
  const StepState &step;
  Stop stop;
  std::vector<double> densities;    // per type, in the last run; 0: not known
  std::vector<double> masses;       // per type, in the last run: the most, and the negative least
  std::vector<double> limit_sq;     // per type: of the speed
  // components of velocities and of their change in a step from which no limit is in reach
  double calm_speed = 0.0, calm_kick = 0.0;
  double lightest = 0.0;                           // mass of this rank's particles
  const std::vector<int> *substepped = nullptr;    // solids with sub-steps,
  std::vector<double> kept;                        // and their positions and velocities before them
  std::vector<double> dense;    // per type: density over which a fluid is far compressed
  Finding densest = {};         // particle beyond that, of this rank; no tag: none
  // per fluid type: sum of (rho/rho0 - 1)^2 over this rank's particles, and how many they are
  std::vector<double> deviations;
  // in this run: of particles that are far compressed, of sound too slow for the pressures
  bool warned_dense = false, warned_soft = false;
  Finding found = {};    // the first thing that is not finite, or the worst of this rank

  void spacings() const;
  void fluid_spacings(double dx, int type) const;
  void compare_densities();
  void compare_masses();
  void held_parts() const;
  void integrators() const;
  void thin_bodies() const;
  void enter(const Finding &);
  void examine(int i, double kick);
  void inside_out();
  void look(bool closely, double kick);
  void look_at_densities();
  bool any_soft() const;
  void warn_of_density();
  void warn_of_sound();
  std::string face_of(const double *x) const;
  void judge(Stop::When);
};

}    // namespace LAMMPS_NS::FSI

#endif
