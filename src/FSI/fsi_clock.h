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

// Simulated time as a restart file has it, which LAMMPS forgets where it has no timestep command
// after reading.

#ifndef LMP_FSI_CLOCK_H
#define LMP_FSI_CLOCK_H

#include "pointers.h"

#include <optional>

namespace LAMMPS_NS {
namespace FSI {

  class Record;

  class Clock : protected Pointers {
   public:
    explicit Clock(LAMMPS *lmp) : Pointers(lmp) {}
    static double now(const Update *);    // simulated time of this step
    void write(Record &) const;
    void read(const Record &);
    void restore();                    // before the first run after a restart file was read
    void forget() { kept.reset(); }    // from that run on

   private:
    struct Time {
      bigint step = 0, first_step = 0;
      double dt = 0.0, time = 0.0;
    };
    std::optional<Time> kept;
  };

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
