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

#include "fsi_motion.h"

#include "atom.h"
#include "force.h"
#include "fsi_hub.h"
#include "lammps.h"
#include "update.h"

using namespace LAMMPS_NS;
using namespace FSI;

template <int D> static void drift_in(LAMMPS *lmp, const StepState &step, int groupbit)
{
  const Atom *const atom = lmp->atom;
  Vector *const x = vectors(atom->x), *const v = vectors(atom->v);
  const int *const mask = atom->mask;
  step.for_particles(atom->nlocal, [=, bit = groupbit, dth = 0.5 * lmp->update->dt](int i) {
    if (mask[i] & bit)
      for (int d = 0; d < D; d++) x[i][d] += dth * v[i][d];
  });
}

template <int D>
static void kick_in(LAMMPS *lmp, const Discretization &disc, const StepState &step, int groupbit)
{
  const Atom *const atom = lmp->atom;
  Vector *const x = vectors(atom->x), *const v = vectors(atom->v), *const f = vectors(atom->f);
  const double *const rmass = atom->rmass;
  const int *const mask = atom->mask, *const type = atom->type;
  const double dt = lmp->update->dt, dtf = dt * lmp->force->ftm2v, dth = 0.5 * dt;
  const State *const state = disc.state.data();
  double *const *const shift = step.shifts ? step.shift : nullptr;
  step.for_particles(atom->nlocal, [=, bit = groupbit, no_solids = step.substeps > 1](int i) {
    if (!(mask[i] & bit) || (no_solids && state[type[i]].species == SOLID)) return;
    const double dtfm = dtf / rmass[i];
    for (int d = 0; d < D; d++) {
      v[i][d] += dtfm * f[i][d];
      x[i][d] += dth * v[i][d];
    }
    if (shift && state[type[i]].species == FLUID)
      for (int d = 0; d < 2 * D; d++) (d < D ? x[i][d] : v[i][d - D]) += shift[i][d];
  });
}

void FSI::drift(LAMMPS *lmp, const Discretization &disc, const StepState &step, int groupbit)
{
  disc.dim == 2 ? drift_in<2>(lmp, step, groupbit) : drift_in<3>(lmp, step, groupbit);
}

void FSI::kick(LAMMPS *lmp, const Discretization &disc, const StepState &step, int groupbit)
{
  disc.dim == 2 ? kick_in<2>(lmp, disc, step, groupbit) : kick_in<3>(lmp, disc, step, groupbit);
}
