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

#include "fsi_body_forces.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix_gravity.h"
#include "fsi_find.h"
#include "fsi_lammps_access.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace FSI;

// all fix gravity commands, and which of them act on all particles of a type: only then two
// neighbors are pushed alike, and what is hydrostatic between them has a meaning
void BodyForces::find()
{
  all.clear();
  for (auto *g : fixes_of<FixGravity>(lmp)) {
    all.push_back({g, is_disabled(g) ? 0 : g->groupbit, has_variable(g), {}, {}});
    g->init();    // its variables are looked up
  }
  acts_on_all.assign(all.size() * (atom->ntypes + 1), 0);
  warned = acts_on_all;
}

// Of the particles that there are now: levels and buffers may be empty at the start of a run
void BodyForces::find_whole_types(const std::vector<State> &state)
{
  const int ntypes = atom->ntypes, nfields = all.size(), n = acts_on_all.size();
  std::vector<int> local(2 * n, 0), any(2 * n);    // type by type: with, without
  for (int i = 0; i < atom->nlocal; i++)
    for (int k = 0; k < nfields; k++)
      local[(atom->mask[i] & all[k].mask ? 0 : n) + k * (ntypes + 1) + atom->type[i]] = 1;
  MPI_Allreduce(local.data(), any.data(), 2 * n, MPI_INT, MPI_MAX, world);
  for (int at = 0; at < n; at++) {
    const int k = at / (ntypes + 1), t = at % (ntypes + 1);
    acts_on_all[at] = any[at] && !any[n + at];
    if (!any[at] || !any[n + at] || state[t].species != FLUID || warned[at]++ || comm->me > 0)
      continue;
    error->warning(FLERR,
                   "Fix gravity {} acts on a part of the particles of type {} only: for what "
                   "is hydrostatic between them, as in density diffusion, it does not count",
                   all[k].fix->id, t);
  }
}

// Body forces of this step. Fix gravity evaluates its variables when it acts, after the pair
// styles: it is asked to do so earlier, with nothing to act on.
void BodyForces::evaluate(const std::vector<State> &state)
{
  if (neighbor->ago == 0 && !all.empty()) find_whole_types(state);
  of_type.assign(atom->ntypes + 1, {0.0, 0.0, 0.0});
  size_t on = 0;
  for (auto &field : all) {
    if (field.varies) {
      const int groupbit = field.fix->groupbit;
      field.fix->groupbit = 0;
      field.fix->post_force(0);
      field.fix->groupbit = groupbit;
    }
    int dim_of_extract;
    const auto *now = static_cast<double *>(field.fix->extract("gvec", dim_of_extract));
    for (int d = 0; d < 3; d++) field.change[d] = now[d] - field.g[d];
    std::copy_n(now, 3, field.g);
    for (int t = 0; t <= atom->ntypes; t++, on++)
      if (t > 0 && acts_on_all[on])
        for (int d = 0; d < 3; d++) of_type[t][d] += field.g[d];
  }
}

// Where a field changes, so does the potential energy of what is there, which the ledger has to
// know.
double BodyForces::work(const std::vector<State> &state, int groupbit) const
{
  const double dth = 0.5 * update->dt;
  double sum = 0.0;
  for (const auto &field : all) {
    if (!field.varies) continue;
    for (int i = 0; i < atom->nlocal; i++)
      if ((atom->mask[i] & field.mask) && state[atom->type[i]].species != RIGID &&
          state[atom->type[i]].species != NONE) {
        double x[3];
        domain->unmap(atom->x[i], atom->image[i], x);
        for (int d = 0; d < domain->dimension; d++)
          sum += atom->rmass[i] * field.change[d] *
              (x[d] - (atom->mask[i] & groupbit ? dth * atom->v[i][d] : 0.0));
      }
  }
  return sum;
}

std::array<double, 3> BodyForces::on(int i) const
{
  std::array<double, 3> g = {0.0, 0.0, 0.0};
  for (const auto &field : all)
    if (atom->mask[i] & field.mask)
      for (int d = 0; d < 3; d++) g[d] += field.g[d];
  return g;
}

// gravity may pull through a periodic face
double BodyForces::potential(int i) const
{
  double x[3];
  domain->unmap(atom->x[i], atom->image[i], x);
  const auto g = on(i);
  return -atom->rmass[i] * (g[0] * x[0] + g[1] * x[1] + g[2] * x[2]);
}
