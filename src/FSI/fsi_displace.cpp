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

#include "fsi_displace.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix_fsi.h"
#include "fsi_gather.h"
#include "fsi_hub.h"
#include "fsi_keywords.h"
#include "group.h"
#include "input.h"
#include "neigh_list.h"
#include "neighbor.h"

#include <algorithm>
#include <cmath>
#include <string>

using namespace LAMMPS_NS;
using namespace FSI;

namespace {
constexpr double NEVER = 1e9;

// This part of a particle's cell a cell of the body covers, squares or cubes. Cells of a lattice
// fill space, so the sum over the fluid is the body's volume in it, wherever the two lattices lie.
double covered(const double *xi, double a, const double *xj, double b, int dim)
{
  double part = 1.0;
  for (int d = 0; d < dim; d++) {
    const double common = std::min({0.5 * (a + b) - std::fabs(xi[d] - xj[d]), a, b});
    part *= std::max(common, 0.0) / a;
  }
  return part;
}

}    // namespace

// of all particles, as between runs there are none
const NeighList *FSIDisplace::neighbors()
{
  neighbor->add_request(this, "fsi/displace", NeighConst::REQ_FULL);
  lmp->init();    // materials and masses are entered there
  renew_ghosts(lmp);
  neighbor->build(1);
  auto *const list = neighbor->find_list(this);
  neighbor->build_one(list);
  return list;
}

// Of each particle of fluid that a body covers the key, of others NEVER; sum: how many, and their
// mass. First goes what is covered most and nearest to the body, in spacings, so that none that
// stays is too near; of the same by place.
template <class IsFluid, class IsBody>
std::vector<double> FSIDisplace::find_covered(const Discretization &disc, const NeighList &list,
                                              IsFluid is_fluid, IsBody is_body, double *sum) const
{
  double **const x = atom->x;
  const int *const type = atom->type;
  std::vector<double> key(atom->nlocal, NEVER);
  for (int ii = 0; ii < list.inum; ii++) {
    const int i = list.ilist[ii];
    if (!is_fluid(i)) continue;
    const double dx = disc.dx_of(type[i]);
    double part = 0.0, nearest = 4.0 * dx;
    for (int jj = 0; jj < list.numneigh[i]; jj++) {
      const int j = list.firstneigh[i][jj] & NEIGHMASK;
      if (!is_body(j)) continue;
      part += covered(x[i], dx, x[j], disc.dx_of(type[j]), disc.dim);
      nearest =
          std::min(nearest, std::hypot(x[i][0] - x[j][0], x[i][1] - x[j][1], x[i][2] - x[j][2]));
    }
    if (part == 0.0) continue;
    sum[0] += part;
    sum[1] += part * atom->rmass[i];
    key[i] = std::floor((nearest / dx - part) * 1e4 + 0.5) + part_by_place(x[i], domain);
  }
  return key;
}

void FSIDisplace::command(int narg, char **arg)
{
  if (domain->box_exist == 0)
    error->all(FLERR, "Fsi/displace command before simulation box is defined");
  std::string names[2];
  Keywords keywords(lmp, "fsi/displace");
  keywords.argument("fluid group-ID").word(names[0], "");
  keywords.argument("body group-ID").word(names[1], "");
  keywords.parse(narg, arg);
  int bit[2];
  for (int k = 0; k < 2; k++) bit[k] = group->bitmask[group_of(lmp, "Fsi/displace", names[k])];
  const Discretization &disc = FixFSI::find(lmp, "Fsi/displace")->disc;
  const NeighList *const list = neighbors();
  const int *const type = atom->type, *const mask = atom->mask;
  const auto is_fluid = [&](int i) {
    return mask[i] & bit[0] && disc.state[type[i]].species == FLUID;
  };
  const auto is_body = [&](int j) {
    return mask[j] & bit[1] && disc.state[type[j]].species != FLUID;
  };
  for (int k = 0; k < 2; k++)
    if (find_particles(atom, world, [&](int i) {
          return k == 0 ? is_fluid(i) : is_body(i);
        }).count == 0)
      error->all(FLERR, "Fsi/displace group-ID {} has no particle of {}", names[k],
                 k == 0 ? "a fluid" : "a body");

  double here[3] = {}, all[3];    // particles, mass in whose place the body is; what goes
  const auto key = find_covered(disc, *list, is_fluid, is_body, here);
  MPI_Allreduce(here, all, 2, MPI_DOUBLE, MPI_SUM, world);

  const double limit = limit_of(key, std::llround(all[0]), -NEVER, NEVER, world);
  here[0] = 0.0;
  const std::string gone = "FSI_DISPLACED";
  const int igone = group->find_or_create(gone.c_str());
  for (int i = 0; i < atom->nlocal; i++)
    if (key[i] < limit) {
      atom->mask[i] |= group->bitmask[igone];
      here[0]++;
      here[2] += atom->rmass[i];
    }
  MPI_Allreduce(here, all, 3, MPI_DOUBLE, MPI_SUM, world);
  if (comm->me == 0)
    utils::logmesg(
        lmp, "  fsi/displace: {} is in the place of {:.6g} of {}, {} particles of {:.6g} go\n",
        names[1], all[1], names[0], all[0], all[2]);
  if (all[0] == 0.0 && comm->me == 0)
    error->warning(FLERR, "Fsi/displace {} {}: the body is in no fluid", names[0], names[1]);
  input->one(fmt::format("delete_atoms group {} compress no", gone));
  input->one(fmt::format("group {} delete", gone));
}
