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

// What fix fsi does to particles in a step: loops over this rank's, on the host

#include "fix_fsi.h"

#include "atom.h"
#include "error.h"
#include "force.h"
#include "fsi_gather.h"
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

void FixFSI::find_others()
{
  bool local = false;
  for (int i = 0; i < atom->nlocal; i++) {
    if (disc.state[atom->type[i]].species != NONE) continue;
    local = true;
    if (atom->rmass[i] <= 0.0)
      error->one(FLERR,
                 "Atom {} is of type {}, which has no material, and has no mass: give it a "
                 "material in pair_coeff, or, if it is a particle of another pair style, a mass",
                 atom->tag[i], atom->type[i]);
  }
  others_turn =
      anywhere(local, world) && atom->radius_flag && atom->omega_flag && atom->torque_flag;
}

// spheres, in 2D too, as in fix nve/sphere
void FixFSI::turn() const
{
  if (!others_turn) return;
  double **const omega = atom->omega, **const torque = atom->torque;
  const double dtf = update->dt * force->ftm2v / 0.4;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    if (disc.state[atom->type[i]].species != NONE || atom->radius[i] == 0.0) continue;
    const double by = dtf / (atom->rmass[i] * atom->radius[i] * atom->radius[i]);
    for (int d = 0; d < 3; d++) omega[i][d] += by * torque[i][d];
  }
}
