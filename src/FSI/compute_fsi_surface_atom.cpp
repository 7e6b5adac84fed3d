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

#include "compute_fsi_surface_atom.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "fix_fsi.h"
#include "fsi_find.h"
#include "fsi_hub.h"
#include "fsi_keywords.h"
#include "fsi_number_density.h"
#include "pair_fsi_fluid.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace FSI;

ComputeFSISurfaceAtom::ComputeFSISurfaceAtom(LAMMPS *lmp, int narg, char **arg) :
    Compute(lmp, narg, arg)
{
  Keywords keywords(lmp, "compute fsi/surface/atom");
  keywords.key("number/density")
      .set(rule, NUMBER_DENSITY)
      .number(threshold, 0.75, Range::inside(0.0, 1.0), "threshold");
  keywords.key("divergence")
      .set(rule, DIVERGENCE)
      .number(threshold, 0.75, Range::inside(0.0, 1.0), "threshold");
  keywords.parse(narg - 3, arg + 3);
  peratom_flag = 1;
  size_peratom_cols = 0;
}

void ComputeFSISurfaceAtom::init()
{
  FixFSI::find(lmp, "Compute fsi/surface/atom");
  if (!facts_of_fluids(lmp).style)
    error->all(FLERR, "Compute fsi/surface/atom requires pair_style fsi/fluid");
}

// number/density: psi_i <= threshold * psi of the bulk lattice (the paper's rule)
// divergence: sum_j V_j x_ji.grad_i W_ij <= threshold * dim (Lee et al. 2008, J. Comput. Phys. 227,
//   8417); it does not depend on how dense the fluid is packed
void ComputeFSISurfaceAtom::compute_peratom()
{
  invoked_peratom = update->ntimestep;
  const auto *const fix_fsi = FixFSI::ready(lmp, "Compute fsi/surface/atom");
  const Discretization &disc = fix_fsi->disc;
  sum.resize(atom->nmax);
  vector_atom = sum.data();
  comm->forward_comm();    // ghosts still stand where they were in the middle of the step
  double limit;
  if (rule == NUMBER_DENSITY) {
    fix_fsi->number_density.find(sum.data());
    limit = threshold * disc.psi_bulk;
  } else {
    std::fill(sum.begin(), sum.end(), 0.0);
    first_of(pairs_of<PairFSIFluid>(lmp))->add_position_divergence(sum.data());
    fix_fsi->ghosts.add(sum.data());
    limit = threshold * disc.dim;
  }
  const int *const mask = atom->mask, *const type = atom->type;
  for (int i = 0; i < atom->nlocal; i++)
    sum[i] = (mask[i] & groupbit) && disc.state[type[i]].species == FLUID && sum[i] <= limit ? 1.0
                                                                                             : 0.0;
}

double ComputeFSISurfaceAtom::memory_usage()
{
  return (double) sum.capacity() * sizeof(double);
}
