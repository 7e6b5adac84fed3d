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
#include "fix.h"
#include "force.h"
#include "fsi_part.h"
#include "fsi_scene.h"

#include <algorithm>
#include <cmath>
#include <vector>

using namespace LAMMPS_NS;
using namespace FSI;

Limits::Limits(LAMMPS *lmp) : Pointers(lmp), culprit{}
{
  for (double *row : {step, sub}) std::fill_n(row, NLIMIT, UNLIMITED);
}

// fluid: h/4(c+|v|); solid: h/4c_l, c_l^2 = (K+4G/3)/rho0; artificial viscosity: 0.4h/c(1+0.6
// alpha); laminar: h^2/16nu; acceleration: sqrt(h/|a|)/4
void Limits::find(const Scene &scene, int groupbit, bool substeps, double of_fluid, double of_solid)
{
  const int *const mask = atom->mask, *const type = atom->type;
  double **v = atom->v;
  double **f = atom->f;
  const double *const rmass = atom->rmass, *const rho = atom->rho;

  double *const mine[2] = {step, sub};
  std::vector<double> fastest(atom->ntypes + 1, 0.0), asq_max(fastest);
  std::vector<tagint> fast(atom->ntypes + 1, 0), pushed(fast);
  for (auto &row : culprit) row[0] = row[1] = 0;
  std::vector<char> present(atom->ntypes + 1, 0);
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(mask[i] & groupbit)) continue;
    const State &s = scene.state[type[i]];
    if (s.species == NONE || s.species == RIGID) continue;
    present[type[i]] = 1;
    if (s.species == FLUID) {
      double c = s.c;
      if (s.tait) c *= std::max(1.0, std::pow(rho[i] / s.rho0, 3));
      c += std::sqrt(v[i][0] * v[i][0] + v[i][1] * v[i][1] + v[i][2] * v[i][2]);
      if (c > fastest[type[i]]) {
        fastest[type[i]] = c;
        fast[type[i]] = atom->tag[i];
      }
    }
    // what is held does not follow its force
    if (!(mask[i] & scene.mover->groupbit)) continue;
    const double w = force->ftm2v / rmass[i];
    const double asq = w * w * (f[i][0] * f[i][0] + f[i][1] * f[i][1] + f[i][2] * f[i][2]);
    if (asq > asq_max[type[i]]) {
      asq_max[type[i]] = asq;
      pushed[type[i]] = atom->tag[i];
    }
  }

  const Facts of_fluids = facts_of_fluids(lmp), of_solids = facts_of_solids(lmp);
  for (double *row : mine) std::fill_n(row, NLIMIT, UNLIMITED);
  for (int t = 1; t <= atom->ntypes; t++) {
    if (!present[t]) continue;
    const State &s = scene.state[t];
    const bool fluid = s.species == FLUID;
    const int in_sub = substeps && !fluid;
    double *const m = mine[in_sub], own = fluid ? of_fluid : of_solid, h = scene.h_of(t);
    const double by_sound = fastest[t] > 0.0 ? of_fluid * safe[SOUND] * h / fastest[t] : UNLIMITED;
    if (by_sound < mine[0][SOUND]) {
      mine[0][SOUND] = by_sound;
      culprit[0][0] = fast[t];
    }
    const double pushing = asq_max[t] > 0.0
        ? own * safe[ACCELERATION] * std::sqrt(h / std::sqrt(asq_max[t]))
        : UNLIMITED;
    if (pushing < m[ACCELERATION]) {
      m[ACCELERATION] = pushing;
      culprit[in_sub][1] = pushed[t];
    }
    const double alpha =
        (fluid ? of_fluids : of_solids).alpha;    // held solids may be walls, without a style
    if (!fluid)
      m[ELASTIC] = std::min(m[ELASTIC], own * safe[ELASTIC] * h / std::sqrt(s.wave_speed_sq()));
    if (alpha > 0.0)
      m[ARTIFICIAL] =
          std::min(m[ARTIFICIAL], own * safe[ARTIFICIAL] * h / (s.c * (1.0 + 0.6 * alpha)));
    if (fluid && s.viscosity > 0.0 && of_fluids.laminar)
      m[LAMINAR] = std::min(m[LAMINAR], own * safe[LAMINAR] * h * h * s.rho0 / s.viscosity);
  }
}

void Limits::reduce()
{
  double mine[2][NLIMIT], all[2][NLIMIT];
  std::copy_n(step, NLIMIT, mine[0]);
  std::copy_n(sub, NLIMIT, mine[1]);
  MPI_Allreduce(&mine[0][0], &all[0][0], 2 * NLIMIT, MPI_DOUBLE, MPI_MIN, world);
  tagint who[2][2];
  for (int k = 0; k < 2; k++) {
    who[k][0] = mine[k][SOUND] == all[k][SOUND] ? culprit[k][0] : 0;
    who[k][1] = mine[k][ACCELERATION] == all[k][ACCELERATION] ? culprit[k][1] : 0;
  }
  MPI_Allreduce(&who[0][0], &culprit[0][0], 4, MPI_LMP_TAGINT, MPI_MAX, world);
  std::copy_n(all[0], NLIMIT, step);
  std::copy_n(all[1], NLIMIT, sub);
}
