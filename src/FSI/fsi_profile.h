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

// Where the time of a run goes and what it sends: kept only while there is a fix fsi/report, which
// owns it. Everyone else holds a pointer, null without that fix, and looks at it once per phase.

#ifndef LMP_FSI_PROFILE_H
#define LMP_FSI_PROFILE_H

#include "comm.h"

#include <vector>

namespace LAMMPS_NS {
namespace FSI {

  class Profile {
   public:
    enum Section { DENSITY, STRESS, FLUID_FORCES, SOLID_FORCES, WALLS, MESSAGES, NPART };
    static constexpr int OUTSIDE = NPART;
    double seconds[NPART + 1];    // each without what is nested in it

    bool counting;             // messages of this step
    double bytes, messages;    // of the package, in the steps that were counted
    double impulse_held[3];    // of sub-steps on held solids, beyond the force at their end times
                               // the step
    double reflected[3];       // momentum that reflections at walls gave to the fluid

    Profile() { clear(); }
    void clear();
    int current;               // section that is running
    int enter(int section);    // returns the one before
    template <class T> void count(Comm *, T *who, bool back, bool skip_empty);

    struct Message {
      int n, *list, first;    // atoms of a forward one in list, of one back from first on
    };
    // what one exchange with ghosts sends to other ranks
    static std::vector<Message> messages_of(const Comm *, bool back);

   private:
    double since;
    std::vector<double> buffer;
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

  // sizes are known only when packed: pack once more
  template <class T> void Profile::count(Comm *comm, T *who, bool back, bool skip_empty)
  {
    for (const auto &m : messages_of(comm, back)) {
      const size_t most = (size_t) m.n * (back ? who->comm_reverse : who->comm_forward);
      if (buffer.size() < most) buffer.resize(most);
      const int n = back ? who->pack_reverse_comm(m.n, m.first, buffer.data())
                         : who->pack_forward_comm(m.n, m.list, buffer.data(), 0, nullptr);
      bytes += sizeof(double) * n;
      if (n > 0 || !skip_empty) messages += 1.0;
    }
  }

  // communication of a fix or pair style of the package; nothing is kept of what happens outside a
  // step, in output
  template <class T, class F>
  void exchange(Profile *profile, Comm *comm, T *who, bool back, F &&send, bool skip_empty = false)
  {
    const bool known = profile && profile->current != Profile::OUTSIDE && comm->nprocs > 1;
    const Phase phase(known ? profile : nullptr, Profile::MESSAGES);
    if (known && profile->counting) profile->count(comm, who, back, skip_empty);
    send();
  }
  template <class T> void forward_comm(Profile *profile, Comm *comm, T *who)
  {
    exchange(profile, comm, who, false, [&]() {
      comm->forward_comm(who);
    });
  }
  template <class T> void reverse_comm(Profile *profile, Comm *comm, T *who)
  {
    exchange(profile, comm, who, true, [&]() {
      comm->reverse_comm(who);
    });
  }

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
