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

// How a run that goes wrong is stopped: who, where, what, how much, what to try; files of the state
// before it went wrong.

#ifndef LMP_FSI_STOP_H
#define LMP_FSI_STOP_H

#include "pointers.h"

#include <string>

namespace LAMMPS_NS {
namespace FSI {
  class Scene;

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
    enum When { BEFORE, START, MIDDLE };    // of all forces; of a step: where positions are

    Stop(class LAMMPS *, const std::string &who);
    Finding finding(Trouble, int i, double value, int j = -1) const;
    // what of atom i is not finite? No tag if nothing is. With forces, if they are there
    Finding not_finite(int i, bool forces) const;
    // of the findings of all ranks the one with the largest key
    Finding worst(const Finding &mine, double key) const;
    // what is wrong, if it is not FINITE, then step, particle and what to try
    std::string describe(const Scene &, const std::string &what, const Finding &, When) const;
    // error->all, after writing the files
    void stop(const Scene &, std::string text, const Finding &, When);

   private:
    const std::string who, restart_file, dump_file;
    // the particle of a solid or wall that a fluid particle is nearest to
    struct Neighbor {
      double distance, dx;
      tagint tag, molecule;
      int species;
      bool around;    // is its body on all sides?
    };
    Neighbor nearest_body(const Scene &, const Finding &) const;
    static bool too_near(const Scene &, const Neighbor &);
    static std::string advice(const Neighbor &, When);
    double courant(const Scene &, int type) const;
    std::string advice(const Scene &, const Finding &, When, const Neighbor &) const;
    void go_back(const Scene &);
    std::string write_state(const Scene &);
    void write_neighbours(const Scene &, const Finding &) const;
  };

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
