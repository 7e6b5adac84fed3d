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

#include "fsi_clock.h"

#include "fsi_record.h"
#include "update.h"

#include <cmath>

using namespace LAMMPS_NS;
using namespace FSI;

double Clock::now(const Update *update)
{
  return update->atime + (update->ntimestep - update->atimestep) * update->dt;
}

void Clock::write(Record &record) const
{
  record.add("step", std::to_string(update->ntimestep));
  record.add("clock's step", std::to_string(update->atimestep));
  record.add("clock", std::vector<double>{update->dt, update->atime});
}

void Clock::read(const Record &record)
{
  const auto at = record.numbers("clock");
  kept = Time{std::stoll(record.value("step")), std::stoll(record.value("clock's step")), at[0],
              at[1]};
}

// LAMMPS counts time from a step on, and forgets that step at each init: in a run that goes on
// without a timestep command the time since then is lost. With the numbers of the file it is that
// of the uninterrupted run, bit for bit. Where a command has set another time or step, that holds.
void Clock::restore()
{
  if (!kept) return;
  const Time &c = *kept;
  const double elapsed = c.time + (c.step - c.first_step) * c.dt, now = Clock::now(update);
  const bool forgotten = update->atime == c.time ||
      std::fabs(now - elapsed) <= 1.0e-12 * std::fabs(elapsed);
  if (update->ntimestep != c.step || !forgotten) return;
  if (update->dt == c.dt) {
    update->atime = c.time;
    update->atimestep = c.first_step;
  } else {
    update->atime = elapsed;
    update->atimestep = c.step;
  }
}
