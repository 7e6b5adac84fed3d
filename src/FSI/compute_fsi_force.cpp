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

#include "compute_fsi_force.h"

#include "atom.h"
#include "domain.h"
#include "error.h"
#include "fix_fsi.h"
#include "force.h"
#include "fsi_gather.h"
#include "fsi_hub.h"
#include "fsi_keywords.h"
#include "fsi_part.h"
#include "group.h"
#include "math_extra.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace FSI;

ComputeFSIForce::ComputeFSIForce(LAMMPS *lmp, int narg, char **arg) : Compute(lmp, narg, arg)
{
  Keywords keywords(lmp, "compute fsi/force");
  keywords.key("split").logical(split, false);
  keywords.parse(narg - 3, arg + 3);
  vector_flag = 1;
  size_vector = split ? 12 : 6;
  extvector = 1;
  vector = new double[size_vector];
}

void ComputeFSIForce::init()
{
  disc = &FixFSI::find(lmp, "Compute fsi/force")->disc;
  if (!facts_of_fluids(lmp).style)
    error->all(FLERR, "Compute fsi/force requires pair_style fsi/fluid");
}

void ComputeFSIForce::find_idle(const Census &, const Idle &nothing) const
{
  if (find_particles(atom, world, [this](int i) {
        return counts(i);
      }).count == 0)
    nothing("Compute fsi/force",
            fmt::format("group {} has no solid and no wall", group->names[igroup]));
}

bool ComputeFSIForce::counts(int i) const
{
  return (atom->mask[i] & groupbit) && disc->state[atom->type[i]].is_body();
}

// a point inside the body: where its first particle is when lists are new, since it may go far
// until the torque is asked for; then its center of mass
void ComputeFSIForce::find_body()
{
  tagint local = MAXTAGINT, first;
  double place[3] = {};
  for (int i = 0; i < atom->nlocal; i++)
    if (counts(i) && atom->tag[i] < local) {
      local = atom->tag[i];
      std::copy_n(atom->x[i], 3, place);
    }
  MPI_Allreduce(&local, &first, 1, MPI_LMP_TAGINT, MPI_MIN, world);
  if (local != first) std::fill_n(place, 3, 0.0);
  MPI_Allreduce(place, origin, 3, MPI_DOUBLE, MPI_SUM, world);
}

// Forces on ghosts count where they are, before they are sent home: the sum is the same. Without
// newton ghosts get none. Lever arms: of the nearest periodic image, from a point inside the body.
void ComputeFSIForce::add(int i, const double *f, double sign, int where)
{
  double r[3];
  for (int d = 0; d < 3; d++) r[d] = atom->x[i][d] - origin[d];
  to_nearest_image(*domain, r);
  double torque[3];
  MathExtra::cross3(r, f, torque);
  for (int d = 0; d < 3; d++) {
    if (d < disc->dim) sum[where + d] += sign * f[d];
    if (d == 2 || disc->dim == 3) sum[where + 3 + d] += sign * torque[d];
    if (where == FORCE && sign < 0.0 && i < atom->nlocal) sum[MOMENT + d] += atom->rmass[i] * r[d];
  }
}

void ComputeFSIForce::tally(double sign)
{
  const int nlocal = atom->nlocal, nall = nlocal + (force->newton_pair ? atom->nghost : 0);
  if (sign < 0.0) {
    std::fill_n(sum, (int) NSUM, 0.0);
    if (update->setupflag || (neighbor->ago == 0 && is_periodic(*domain))) find_body();
    reduced = false;
  }
  for (int i = 0; i < nall; i++) {
    if (!counts(i)) continue;
    add(i, atom->f[i], sign, FORCE);
    if (sign < 0.0 && i < nlocal) sum[MASS] += atom->rmass[i];
  }
}

void ComputeFSIForce::tally_viscosity(const double *forces, int row)
{
  const int nall = atom->nlocal + (force->newton_pair ? atom->nghost : 0);
  for (int i = 0; i < nall; i++)
    if (counts(i)) add(i, forces + (size_t) i * row, 1.0, VISCOUS);
}

void ComputeFSIForce::compute_vector()
{
  invoked_vector = update->ntimestep;
  disc = &FixFSI::ready(lmp, "Compute fsi/force")->disc;
  if (reduced) return;
  reduced = true;
  double all[NSUM];
  MPI_Allreduce(sum, all, NSUM, MPI_DOUBLE, MPI_SUM, world);
  for (int k = 0; k < size_vector; k += 6) {
    double torque[3];    // about the origin
    MathExtra::cross3(all + MOMENT, all + k, torque);
    std::copy_n(all + k, 6, vector + k);
    for (int d = 0; d < 3 && all[MASS] > 0.0; d++) vector[k + 3 + d] -= torque[d] / all[MASS];
  }
  if (all[MASS] == 0.0) return;    // no such particle in the group
  for (int d = 0; d < 3; d++) origin[d] += all[MOMENT + d] / all[MASS];
  domain->remap(origin);
}
