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

// Drift and kick of fix fsi: loops over this rank's particles, on the host

#include "fix_fsi.h"

#include "atom.h"
#include "force.h"
#include "fsi_hub.h"
#include "update.h"

using namespace LAMMPS_NS;
using namespace FSI;

template <int D>
static void drift_in(const Atom *atom, const StepState &step, double dth, int groupbit)
{
  Vector *const x = vectors(atom->x), *const v = vectors(atom->v);
  const int *const mask = atom->mask;
  step.for_particles(atom->nlocal, [=](int i) {
    if (mask[i] & groupbit)
      for (int d = 0; d < D; d++) x[i][d] += dth * v[i][d];
  });
}

// Solids with sub-steps have been kicked in these
template <int D>
static void kick_in(const Atom *atom, const State *state, const StepState &step, double dtf,
                    double dth, int groupbit)
{
  Vector *const x = vectors(atom->x), *const v = vectors(atom->v), *const f = vectors(atom->f);
  const double *const rmass = atom->rmass;
  const int *const mask = atom->mask, *const type = atom->type;
  double *const *const shift = step.shifts ? step.shift : nullptr;
  step.for_particles(atom->nlocal, [=, no_solids = step.substeps > 1](int i) {
    if (!(mask[i] & groupbit) || (no_solids && state[type[i]].species == SOLID)) return;
    const double dtfm = dtf / rmass[i];
    for (int d = 0; d < D; d++) {
      v[i][d] += dtfm * f[i][d];
      x[i][d] += dth * v[i][d];
    }
    if (shift && state[type[i]].species == FLUID)
      for (int d = 0; d < 2 * D; d++) (d < D ? x[i][d] : v[i][d - D]) += shift[i][d];
  });
}

void FixFSI::drift()
{
  (disc.dim == 2 ? drift_in<2> : drift_in<3>) (atom, step, 0.5 * update->dt, groupbit);
}

void FixFSI::kick()
{
  const double dt = update->dt;
  (disc.dim == 2 ? kick_in<2> : kick_in<3>) (atom, disc.state.data(), step, dt * force->ftm2v,
                                             0.5 * dt, groupbit);
}
