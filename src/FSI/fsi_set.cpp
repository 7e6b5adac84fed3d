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
#include "fsi_refusals.h"

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
#include "update.h"
#include "variable.h"

#include <algorithm>
#include <cmath>
#include <vector>

using namespace LAMMPS_NS;
using namespace FSI;

// fsi/set group-ID density value
// fsi/set group-ID pressure value      density that gives this pressure
// fsi/set group-ID hydrostatic level
//   the same for p = rho0 |g| (level - height), height along -g; nothing above the level
// fsi/set group-ID volume value        mass of a particle that has another place than that of the
//                                      square or cubic lattice
// value: a number or, of density, pressure and volume, an atom-style variable
// The mass follows: a particle keeps the volume of its place in the lattice. (With the mass of the
// uncompressed lattice volumes would say "compressed" where distances do not, and still water would
// settle 2 % off at c = 10 sqrt(2 g H).)
enum { DENSITY, PRESSURE, HYDROSTATIC, VOLUME };

void FSISet::command(int narg, char **arg)
{
  if (domain->box_exist == 0) error->all(FLERR, "Fsi/set command before simulation box is defined");
  static const std::vector<std::string> names = {"density", "pressure", "hydrostatic", "volume"};
  std::string group_name, given;
  int what;
  Keywords keywords(lmp, "fsi/set");
  keywords.argument("group-ID").word(group_name, "");
  keywords.argument("keyword").choice(what, DENSITY, names);
  keywords.argument("value").word(given, "");
  keywords.parse(narg, arg);
  const int igroup = group_of(lmp, "Fsi/set", group_name);
  int variable = -1;
  if (utils::strmatch(given, "^v_") && what != HYDROSTATIC) {
    variable = input->variable->find(given.c_str() + 2);
    if (variable < 0 || !input->variable->atomstyle(variable))
      error->all(FLERR, "Fsi/set {} {} is not an atom-style variable", names[what], given);
  }
  const double number = variable < 0 ? numeric(lmp, "Fsi/set " + names[what], given) : 0.0;

  FixFSI *const fix_fsi = FixFSI::find(lmp, "Fsi/set");
  if (update->ntimestep > 0 && comm->me == 0)
    error->warning(FLERR,
                   "Fsi/set {} {} after {} steps: masses change with densities, which is meant "
                   "before the first run",
                   group_name, names[what], update->ntimestep);
  lmp->init();    // materials, masses and gravity are entered there
  BodyForces &forces = fix_fsi->step.body_forces;
  forces.evaluate(fix_fsi->disc.state);
  if (what == HYDROSTATIC && std::none_of(forces.all.begin(), forces.all.end(), [](const auto &f) {
        return f.mask;
      }))
    refuse(error, Refused::HYDROSTATIC);

  std::vector<double> each(atom->nlocal, number);
  if (variable >= 0) input->variable->compute_atom(variable, igroup, each.data(), 1, 0);
  bigint count = 0;
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->mask[i] & group->bitmask[igroup])
      count += what == VOLUME
          ? set_volume(i, each[i])
          : set_density(i, what, names[what], each[i], fix_fsi->disc.state[atom->type[i]], forces);
  const bigint all = count_of(count, world);
  if (all == 0 && comm->me == 0)
    error->warning(FLERR, "Fsi/set {} {} {} acts on no particle", group_name, names[what], given);
  if (comm->me == 0)
    utils::logmesg(lmp, "  fsi/set: {} of {} particles\n", what == VOLUME ? "mass" : "density",
                   all);
}

bool FSISet::set_volume(int i, double volume)
{
  if (!(volume > 0.0)) error->one(FLERR, "Fsi/set volume {} must be > 0", volume);
  atom->rmass[i] = atom->rho[i] * volume;
  return true;
}

// whether it has been set
bool FSISet::set_density(int i, int what, const std::string &name, double value, const State &s,
                         const BodyForces &forces)
{
  if (s.species == NONE || s.species == RIGID) return false;    // walls: from the fluid
  if (s.form == TOTAL_LAGRANGIAN) return false;                 // density from its strain
  double rho = what == PRESSURE ? s.density(value) : value;
  if (what == HYDROSTATIC) {
    const auto g = forces.on(i);
    const double *x = atom->x[i], size = std::sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
    if (size == 0.0)
      error->one(FLERR, "Fsi/set hydrostatic: no fix gravity acts on atom {}", atom->tag[i]);
    const double height = -(g[0] * x[0] + g[1] * x[1] + g[2] * x[2]) / size;
    if (height > value) return false;
    rho = s.density(s.rho0 * size * (value - height) + s.p0);
  }
  if (!(rho > 0.0 && rho < Range::LARGEST))
    error->one(FLERR, "Fsi/set {} {} must be > 0", what == DENSITY ? "density" : name + ": density",
               rho);
  atom->rmass[i] *= rho / atom->rho[i];
  atom->rho[i] = rho;
  return true;
}
