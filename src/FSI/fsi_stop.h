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

// How a run that goes wrong is stopped: particle, place, value, what to try; files of the state.

#ifndef LMP_FSI_STOP_H
#define LMP_FSI_STOP_H

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

}    // namespace LAMMPS_NS::FSI

#endif
