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

#include "compute_fsi_energy.h"

#include "atom.h"
#include "error.h"
#include "fix_fsi.h"
#include "fix_fsi_stress.h"
#include "force.h"
#include "fsi_find.h"
#include "fsi_hub.h"
#include "fsi_refusals.h"
#include "pair_fsi_solid_tl.h"
#include "update.h"

using namespace LAMMPS_NS;
using namespace FSI;

static constexpr int NHAVE = 4;    // kinetic, gravitational, compressive, shear

ComputeFSIEnergy::ComputeFSIEnergy(LAMMPS *lmp, int narg, char **arg) : Compute(lmp, narg, arg)
{
  if (narg != 3) error->all(FLERR, "Compute fsi/energy takes no arguments");
  if (igroup) refuse(error, Refused::ENERGY_GROUP);
  scalar_flag = vector_flag = 1;
  extscalar = extvector = 1;
  size_vector = NHAVE + Ledger::NTERM;
  vector = new double[size_vector];
}

void ComputeFSIEnergy::init()
{
  FixFSI::find(lmp, "Compute fsi/energy");
}

const char *ComputeFSIEnergy::name(int k)
{
  // clang-format off
  static const char *const names[NHAVE + Ledger::NTERM] = {
      "kinetic", "gravitational", "compressive", "shear", "artificial viscosity",
      "laminar viscosity", "density diffusion", "artificial stress", "walls", "coupling",
      "gradient", "plastic", "changing gravity", "splitting and merging"};
  // clang-format on
  return names[k];
}

// the sum of the ledger: constant, but for the error of the time step
double ComputeFSIEnergy::compute_scalar()
{
  if (invoked_vector != update->ntimestep) compute_vector();
  invoked_scalar = update->ntimestep;
  scalar = 0.0;
  for (int k = 0; k < size_vector; k++) scalar += vector[k];
  return scalar;
}

// everything at the middle of the last step, where densities and stresses are
void ComputeFSIEnergy::compute_vector()
{
  invoked_vector = update->ntimestep;
  const auto *const fix_fsi = FixFSI::ready(lmp, "Compute fsi/energy");
  const Discretization &disc = fix_fsi->disc;
  const StepState &step = fix_fsi->step;
  const Ledger &ledger = fix_fsi->ledger;
  double sum[NHAVE + Ledger::NTERM] = {};    // of this rank
  double **const v = atom->v, **const f = atom->f;
  const auto *const stress = first_of(fixes_of<FixFSIStress>(lmp));
  for (int i = 0; i < atom->nlocal; i++) {
    const State &s = disc.state[atom->type[i]];
    // what a wall gets is in the term of walls; what grains get, in that of coupling
    if (s.species == NONE || s.species == RIGID) continue;
    const double m = atom->rmass[i];
    const bool tl = s.form == TOTAL_LAGRANGIAN;
    // what fix fsi does not integrate is where and as fast as it is, whatever pushes it
    const double dth = !(atom->mask[i] & disc.mover->groupbit) ? 0.0
        : tl                                                   ? step.behind / step.substeps
                                                               : step.behind;
    const auto g = step.body_forces.on(i);
    for (int d = 0; d < disc.dim; d++) {
      const double vmid = v[i][d] - dth * force->ftm2v * f[i][d] / m;
      sum[0] += 0.5 * m * vmid * vmid;
      sum[1] += m * g[d] * dth * v[i][d];    // back from the end of the step
    }
    sum[1] += step.body_forces.potential(i);
    if (tl) continue;
    sum[2] += stored(i, atom, disc);
    if (s.form == UPDATED_LAGRANGIAN) sum[3] += stress->shear_energy(i, s.shear);
  }
  if (const auto *solid_tl = first_of(pairs_of<PairFSISolidTL>(lmp)))
    sum[3] += solid_tl->strain_energy;
  for (int k = 0; k < Ledger::NTERM; k++) sum[NHAVE + k] = ledger.energy_out[k];
  sum[NHAVE + Ledger::WALLS] += ledger.guarding[0];
  sum[NHAVE + Ledger::COUPLING] += ledger.guarding[1];
  MPI_Allreduce(sum, vector, size_vector, MPI_DOUBLE, MPI_SUM, world);
}
