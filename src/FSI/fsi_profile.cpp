/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   Copyright (2003) Sandia Corporation.  Under the terms of Contract
   DE-AC04-94AL85000 with Sandia Corporation, the U.S. Government retains
   certain rights in this software.  This software is distributed under
   the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "fsi_profile.h"

#include "comm_brick.h"
#include "comm_tiled.h"
#include "platform.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace FSI;

/* ---------------------------------------------------------------------- */

void Profile::clear()
{
  std::fill_n(seconds, NPART + 1, 0.0);
  std::fill_n(impulse_held, 3, 0.0);
  std::fill_n(reflected, 3, 0.0);
  bytes = messages = 0.0;
  counting = false;
  current = OUTSIDE;
  since = platform::walltime();
}

/* ---------------------------------------------------------------------- */

int Profile::enter(int section)
{
  const int before = current;
  const double now = platform::walltime();
  seconds[current] += now - since;
  since = now;
  current = section;
  return before;
}

/* ----------------------------------------------------------------------
   LAMMPS shows its lists of ghosts to classes derived from its own only
------------------------------------------------------------------------- */

namespace {

struct Brick : public CommBrick {
  static void list(const CommBrick &comm, bool back, std::vector<Profile::Message> &found)
  {
    for (int k = 0; k < comm.*&Brick::nswap; k++) {
      const int n = (comm.*(back ? &Brick::recvnum : &Brick::sendnum))[k];
      if ((comm.*&Brick::sendproc)[k] != comm.me && n > 0)
        found.push_back({n, (comm.*&Brick::sendlist)[k], (comm.*&Brick::firstrecv)[k]});
    }
  }
};

struct Tiled : public CommTiled {
  static void list(const CommTiled &comm, bool back, std::vector<Profile::Message> &found)
  {
    for (int k = 0; k < comm.*&Tiled::nswap; k++) {
      const int self = (comm.*&Tiled::sendself)[k];    // the last one
      const int count = (comm.*(back ? &Tiled::nrecvproc : &Tiled::nsendproc))[k] - self;
      for (int i = 0; i < count; i++) {
        if (back)
          found.push_back(
              {(comm.*&Tiled::recvnum)[k][i], nullptr, (comm.*&Tiled::firstrecv)[k][i]});
        else
          found.push_back({(comm.*&Tiled::sendnum)[k][i], (comm.*&Tiled::sendlist)[k][i], 0});
      }
    }
  }
};

}    // namespace

std::vector<Profile::Message> Profile::messages_of(const Comm *comm, bool back)
{
  std::vector<Message> found;
  if (const auto *brick = dynamic_cast<const CommBrick *>(comm))
    Brick::list(*brick, back, found);
  else if (const auto *tiled = dynamic_cast<const CommTiled *>(comm))
    Tiled::list(*tiled, back, found);
  return found;
}
