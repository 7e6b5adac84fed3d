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

#include "fsi_clamp_command.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix_fsi.h"
#include "fsi_cells.h"
#include "fsi_gather.h"
#include "fsi_hub.h"
#include "fsi_keywords.h"
#include "group.h"

#include <algorithm>
#include <string>
#include <vector>

using namespace LAMMPS_NS;
using namespace FSI;

static constexpr double NEXT = 1.2;    // spacings: the next column, not the diagonal neighbor

void FSIClamp::command(int narg, char **arg)
{
  if (domain->box_exist == 0)
    error->all(FLERR, "Fsi/clamp command before simulation box is defined");
  std::string names[2];
  Keywords keywords(lmp, "fsi/clamp");
  keywords.argument("free group-ID").word(names[0], "");
  keywords.argument("clamp group-ID").word(names[1], "");
  keywords.parse(narg, arg);
  int bit[2];
  for (int k = 0; k < 2; k++) {
    const int igroup = group_of(lmp, "Fsi/clamp", names[k]);
    if (igroup == 0) error->all(FLERR, "Fsi/clamp group-ID all: expected a group of a part");
    bit[k] = group->bitmask[igroup];
  }
  const Discretization &disc = FixFSI::find(lmp, "Fsi/clamp")->disc;
  lmp->init();    // materials are entered there
  renew_ghosts(lmp);

  double **const x = atom->x;
  const int *const type = atom->type;
  int *const mask = atom->mask;
  const auto in = [&](int i, int k) {
    return mask[i] & bit[k] && disc.state[type[i]].form == TOTAL_LAGRANGIAN;
  };
  const int nall = atom->nlocal + atom->nghost;
  const Cells clamps(x, nall, disc.dim, NEXT * disc.largest_cut, [&](int i) {
    return in(i, 1);
  });
  std::vector<int> over;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!in(i, 0) || in(i, 1)) continue;
    const double reach = NEXT * disc.dx_of(type[i]);
    bool next = false;
    clamps.around(x[i], reach, [&](int j, double rsq) {
      next |= rsq < reach * reach && atom->molecule[j] == atom->molecule[i];
    });
    if (next) over.push_back(i);
  }
  for (const int i : over) {
    mask[i] = (mask[i] & ~bit[0]) | bit[1];
    std::fill_n(atom->v[i], 3, 0.0);    // whoever moves the clamp gives it another
  }
  const bigint all = count_of(over.size(), world);
  if (all == 0)
    error->all(FLERR,
               "Fsi/clamp {} {}: no particle of the first group is within {} spacings of one of "
               "the second: expected two parts of one body (molecule ID) of pair style "
               "fsi/solid/tl",
               names[0], names[1], NEXT);
  if (comm->me == 0)
    utils::logmesg(lmp, "  fsi/clamp: {} particles go from {} to {}\n", all, names[0], names[1]);
}
