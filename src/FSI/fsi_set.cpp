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

#include "fsi_set.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix_fsi.h"
#include "group.h"

#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace FSI;

/* ----------------------------------------------------------------------
   fsi_set group-ID density value
   fsi_set group-ID hydrostatic level
     density that gives p = rho0 |g| (level - height), height along -g; nothing above the level
   The mass follows: a particle keeps the volume of its place in the lattice. (With the mass of the uncompressed lattice
   volumes would say "compressed" where distances do not, and still water would settle 2 % off at c = 10 sqrt(2 g H).)
------------------------------------------------------------------------- */

void FSISet::command(int narg, char **arg)
{
  if (domain->box_exist == 0) error->all(FLERR, "Fsi_set command before simulation box is defined");
  if (narg != 3) error->all(FLERR, "Fsi_set expects group-ID, density or hydrostatic, and a value");

  const int igroup = group->find(arg[0]);
  if (igroup == -1) error->all(FLERR, "Fsi_set group-ID {} does not exist", arg[0]);
  const int groupbit = group->bitmask[igroup];
  const bool hydrostatic = strcmp(arg[1], "hydrostatic") == 0;
  if (!hydrostatic && strcmp(arg[1], "density") != 0)
    error->all(FLERR, "Unknown fsi_set keyword {}: expected density or hydrostatic", arg[1]);
  const double value = utils::numeric(FLERR, arg[2], false, lmp);
  if (!hydrostatic && value <= 0.0) error->all(FLERR, "Fsi_set density {} must be > 0", arg[2]);

  const FixFSI *hub = FixFSI::find(lmp, "Fsi_set");

  // materials, masses and gravity are entered in init()
  lmp->init();
  const double *g = hub->gravity, size = std::sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
  if (hydrostatic && size == 0.0) error->all(FLERR, "Fsi_set hydrostatic requires fix gravity");

  bigint count = 0;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    const State &s = hub->state[atom->type[i]];
    double rho = value;
    if (hydrostatic) {
      const double *x = atom->x[i], height = -(g[0] * x[0] + g[1] * x[1] + g[2] * x[2]) / size;
      if (height > value) continue;
      rho = s.density(s.rho0 * size * (value - height) + s.p0);
    }
    atom->rmass[i] *= rho / atom->rho[i];
    atom->rho[i] = rho;
    count++;
  }
  bigint all;
  MPI_Allreduce(&count, &all, 1, MPI_LMP_BIGINT, MPI_SUM, world);
  if (all == 0 && comm->me == 0) error->warning(FLERR, "Fsi_set {} {} {} acts on no particle", arg[0], arg[1], arg[2]);
  if (comm->me == 0) utils::logmesg(lmp, "  fsi_set: density of {} particles\n", all);
}
