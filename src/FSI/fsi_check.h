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
// Fix fsi asks in every step before the kick, the last moment with a state to go back to.

#ifndef LMP_FSI_CHECK_H
#define LMP_FSI_CHECK_H

#include "fsi_stop.h"

#include <vector>

namespace LAMMPS_NS::FSI {

class Check : protected Pointers {
 public:
  static constexpr double OFF = 1.0e20;

  Check(class LAMMPS *, const Discretization &, const StepState &, const std::vector<Part *> &);
  void before_init();            // what no run may have
  void materials();              // every atom has one, of the density that its mass was made for
  void write(Record &) const;    // these densities
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
