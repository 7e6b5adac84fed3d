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

#include "fsi_limits.h"

#include "atom.h"
#include "force.h"
#include "fsi_hub.h"
#include "fsi_part.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace FSI;

namespace {
// fastest wave seen from the lattice, and largest squared acceleration, with whose they are
struct OfType {
  bool present = false;
  double fastest = 0.0, asq = 0.0, viscosity = 0.0;
  tagint fast = 0, pushed = 0;
};
}    // namespace

static std::vector<OfType> look(const Atom *atom, const Discretization &disc,
                                const double *viscosity, int groupbit, double ftm2v)
{
  const int *const mask = atom->mask, *const type = atom->type, moved = disc.mover->groupbit;
  double **const v = atom->v, **const f = atom->f;
  std::vector<OfType> types(atom->ntypes + 1);
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(mask[i] & groupbit)) continue;
    const State &s = disc.state[type[i]];
    OfType &t = types[type[i]];
    if (s.species == NONE || s.species == RIGID) continue;
    t.present = true;
    t.viscosity = std::max(t.viscosity, viscosity ? viscosity[i] : s.viscosity);
    if (s.species == FLUID) {
      double c = s.c;
      if (s.tait) c *= std::max(1.0, std::pow(atom->rho[i] / s.rho0, 3));
      c += std::sqrt(v[i][0] * v[i][0] + v[i][1] * v[i][1] + v[i][2] * v[i][2]);
      if (c > t.fastest) {
        t.fastest = c;
        t.fast = atom->tag[i];
      }
    }
    if (!(mask[i] & moved)) continue;    // what is held does not follow its force
    const double w = ftm2v / atom->rmass[i];
    const double asq = w * w * (f[i][0] * f[i][0] + f[i][1] * f[i][1] + f[i][2] * f[i][2]);
    if (asq > t.asq) {
      t.asq = asq;
      t.pushed = atom->tag[i];
    }
  }
  return types;
}

// fluid: h/4(c+|v|); solid: h/4c_l, c_l^2 = (K+4G/3)/rho0; artificial viscosity: 0.4h/c(1+0.6
// alpha); laminar: h^2/16nu; acceleration: sqrt(h/|a|)/4
void Limits::find(const Discretization &disc, const double *viscosity, int groupbit, bool substeps,
                  double of_fluid, double of_solid)
{
  const auto types = look(atom, disc, viscosity, groupbit, force->ftm2v);
  const Facts of_fluids = facts_of_fluids(lmp), of_solids = facts_of_solids(lmp);
  // elastic solids without sub-steps feel viscous forces of the start of the step
  const bool implicit =
      of_fluids.implicit_viscosity && (substeps || of_solids.style == Facts::NONE);
  for (auto &row : culprit) row[0] = row[1] = 0;
  std::fill_n(limit[0], 2 * NLIMIT, UNLIMITED);
  const auto lower = [](double &limit, double value, tagint *particle = nullptr, tagint tag = 0) {
    if (!(value < limit)) return;
    limit = value;
    if (particle) *particle = tag;
  };
  for (int t = 1; t <= atom->ntypes; t++) {
    const OfType &found = types[t];
    if (!found.present) continue;
    const State &s = disc.state[t];
    const bool fluid = s.species == FLUID;
    const int in_sub = substeps && !fluid;
    double *const of_this = limit[in_sub];
    const double factor = fluid ? of_fluid : of_solid, h = disc.h_of(t);
    // held solids may be walls, without a style
    const double alpha = (fluid ? of_fluids : of_solids).alpha;
    if (found.fastest > 0.0)
      lower(step[SOUND], of_fluid * safe[SOUND] * h / found.fastest, &culprit[0][0], found.fast);
    if (found.asq > 0.0)
      lower(of_this[ACCELERATION],
            factor * safe[ACCELERATION] * std::sqrt(h / std::sqrt(found.asq)), &culprit[in_sub][1],
            found.pushed);
    if (!fluid) lower(of_this[ELASTIC], factor * safe[ELASTIC] * h / std::sqrt(s.wave_speed_sq()));
    if (alpha > 0.0)
      lower(of_this[ARTIFICIAL], factor * safe[ARTIFICIAL] * h / (s.c * (1.0 + 0.6 * alpha)));
    if (fluid && found.viscosity > 0.0 && of_fluids.laminar && !implicit)
      lower(of_this[LAMINAR], factor * safe[LAMINAR] * h * h * s.rho0 / found.viscosity);
  }
}

void Limits::reduce()
{
  double local[2][NLIMIT];
  tagint tags[2][2];
  std::copy_n(limit[0], 2 * NLIMIT, local[0]);
  MPI_Allreduce(local, limit, 2 * NLIMIT, MPI_DOUBLE, MPI_MIN, world);
  for (int k = 0; k < 2; k++) {
    tags[k][0] = local[k][SOUND] == limit[k][SOUND] ? culprit[k][0] : 0;
    tags[k][1] = local[k][ACCELERATION] == limit[k][ACCELERATION] ? culprit[k][1] : 0;
  }
  MPI_Allreduce(tags, culprit, 4, MPI_LMP_TAGINT, MPI_MAX, world);
}
