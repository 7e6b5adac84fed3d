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
#include "fsi_gather.h"
#include "fsi_keywords.h"
#include "group.h"
#include "input.h"
#include "update.h"
#include "variable.h"

#include <algorithm>
#include <cmath>
#include <string>
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
void FSISet::command(int narg, char **arg)
{
  if (domain->box_exist == 0) error->all(FLERR, "Fsi/set command before simulation box is defined");
  enum { DENSITY, PRESSURE, HYDROSTATIC, VOLUME };
  static const std::vector<std::string> names = {"density", "pressure", "hydrostatic", "volume"};
  std::string group_name, given;
  int what;
  Keywords keywords(lmp, "fsi/set");
  keywords.argument("group-ID").word(group_name, "");
  keywords.argument("keyword").choice(what, DENSITY, names);
  keywords.argument("value").word(given, "");
  keywords.parse(narg, arg);
  const int igroup = group->find(group_name);
  if (igroup == -1) error->all(FLERR, "Fsi/set group-ID {} does not exist", group_name);
  const int groupbit = group->bitmask[igroup];
  int variable = -1;
  if (utils::strmatch(given, "^v_") && what != HYDROSTATIC) {
    variable = input->variable->find(given.c_str() + 2);
    if (variable < 0 || !input->variable->atomstyle(variable))
      error->all(FLERR, "Fsi/set {} {} is not an atom-style variable", names[what], given);
  }
  const double number = variable < 0 ? numeric(lmp, "Fsi/set " + names[what], given) : 0.0;

  FixFSI *fix_fsi = FixFSI::find(lmp, "Fsi/set");
  if (update->ntimestep > 0 && comm->me == 0)
    error->warning(FLERR,
                   "Fsi/set {} {} after {} steps: masses change with densities, which is meant "
                   "before the first run",
                   group_name, names[what], update->ntimestep);

  // materials, masses and gravity are entered in init()
  lmp->init();
  fix_fsi->body_forces.evaluate(fix_fsi->state);
  if (what == HYDROSTATIC &&
      std::none_of(fix_fsi->body_forces.all.begin(), fix_fsi->body_forces.all.end(),
                   [](const BodyForces::Field &f) {
                     return f.mask;
                   }))
    error->all(FLERR, "Fsi/set hydrostatic requires fix gravity");

  std::vector<double> each(atom->nlocal, number);
  if (variable >= 0) input->variable->compute_atom(variable, igroup, each.data(), 1, 0);

  bigint count = 0;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    const State &s = fix_fsi->state[atom->type[i]];
    const double value = each[i];
    if (what == VOLUME) {
      if (!(value > 0.0)) error->one(FLERR, "Fsi/set volume {} must be > 0", value);
      atom->rmass[i] = atom->rho[i] * value;
      count++;
      continue;
    }
    if (s.species == NONE || s.species == RIGID) continue;    // walls: from the fluid
    if (s.form == TOTAL_LAGRANGIAN) continue;                 // density from its strain
    double rho = value;
    if (what == HYDROSTATIC) {
      const auto g = fix_fsi->body_forces.on(i);
      const double *x = atom->x[i], size = std::sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
      if (size == 0.0)
        error->one(FLERR, "Fsi/set hydrostatic: no fix gravity acts on atom {}", atom->tag[i]);
      const double height = -(g[0] * x[0] + g[1] * x[1] + g[2] * x[2]) / size;
      if (height > value) continue;
      rho = s.density(s.rho0 * size * (value - height) + s.p0);
    } else if (what == PRESSURE)
      rho = s.density(value);
    if (!(rho > 0.0 && rho < Range::LARGEST))
      error->one(FLERR, "Fsi/set {} {} must be > 0",
                 what == DENSITY ? "density" : names[what] + ": density", rho);
    atom->rmass[i] *= rho / atom->rho[i];
    atom->rho[i] = rho;
    count++;
  }
  const bigint all = count_of(count, world);
  if (all == 0 && comm->me == 0)
    error->warning(FLERR, "Fsi/set {} {} {} acts on no particle", group_name, names[what], given);
  if (comm->me == 0)
    utils::logmesg(lmp, "  fsi/set: {} of {} particles\n", what == VOLUME ? "mass" : "density",
                   all);
}
