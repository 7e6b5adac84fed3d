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

// Where the time of a run goes: kept only while there is a fix fsi/report, which owns it. Everyone
// else holds a pointer, null without that fix, and looks at it once per phase.

#ifndef LMP_FSI_PROFILE_H
#define LMP_FSI_PROFILE_H

#include "comm.h"
#include "platform.h"

#include <algorithm>

namespace LAMMPS_NS::FSI {

class Profile {
 public:
  enum Section { DENSITY, STRESS, FLUID_FORCES, SOLID_FORCES, WALLS, MESSAGES, NPART };
  static constexpr int OUTSIDE = NPART;
  double seconds[NPART + 1];    // each without what is nested in it
  // of sub-steps on held solids, beyond the force at their end times the step
  double impulse_held[3];
  double reflected[3];    // momentum that reflections at walls gave to the fluid
  int current;            // section that is running

  Profile() { clear(); }
  void clear()
  {
    std::fill_n(seconds, NPART + 1, 0.0);
    std::fill_n(impulse_held, 3, 0.0);
    std::fill_n(reflected, 3, 0.0);
    current = OUTSIDE;
    since = platform::walltime();
  }
  int enter(int section)    // returns the one before
  {
    const int before = current;
    const double now = platform::walltime();
    seconds[current] += now - since;
    since = now;
    current = section;
    return before;
  }

 private:
  double since;
};

// a phase of the step, to the end of the block. A look at the clock takes as long as a few pairs:
// only where there is something to time.
class Phase {
 public:
  Phase(Profile *profile_in) : profile(profile_in), before(-1) {}
  Phase(Profile *profile_in, int section) : Phase(profile_in) { next(section); }
  Phase(const Phase &) = delete;
  ~Phase()
  {
    if (before >= 0) profile->enter(before);
  }
  void next(int section)
  {
    if (!profile || profile->current == section) return;
    const int last = profile->enter(section);
    if (before < 0) before = last;
  }

 private:
  Profile *profile;
  int before;
};

// that of messages of a style of the package; nothing is kept outside of a step, in output
inline Phase messages(Profile *profile, const Comm *comm)
{
  const bool known = profile && profile->current != Profile::OUTSIDE && comm->nprocs > 1;
  return Phase(known ? profile : nullptr, Profile::MESSAGES);
}
template <class T> void forward_comm(Profile *profile, Comm *comm, T *style, int size = 0)
{
  const Phase phase = messages(profile, comm);
  comm->forward_comm(style, size);
}
template <class T> void reverse_comm(Profile *profile, Comm *comm, T *style, int size = 0)
{
  const Phase phase = messages(profile, comm);
  comm->reverse_comm(style, size);
}

}    // namespace LAMMPS_NS::FSI

#endif
