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

#include "fsi_others.h"

#include "atom.h"
#include "error.h"
#include "force.h"
#include "fsi_gather.h"
#include "fsi_hub.h"
#include "math_const.h"

#include <cmath>

using namespace LAMMPS_NS;
using namespace FSI;
using MathConst::MY_PI;

void Others::init()
{
  bool local = false;
  for (int i = 0; i < atom->nlocal; i++) {
    if (disc.state[atom->type[i]].species != NONE) continue;
    local = true;
    if (atom->rmass[i] <= 0.0)
      error->one(FLERR,
                 "Atom {} is of type {}, which has no material, and has no mass: give it a "
                 "material in pair_coeff, or, if it is a particle of another pair style, a mass",
                 atom->tag[i], atom->type[i]);
  }
  spins = anywhere(local, world) && atom->radius_flag && atom->omega_flag && atom->torque_flag;
}

// an atom that was never given a mass or a density gets those of the stress-free lattice: of a
// body that keeps its reference the cell's, which is exact; else 1/psi, whose sum is
void Others::give_defaults(int i) const
{
  const int type = atom->type[i];
  const State &s = disc.state[type];
  if (s.species == NONE) return give_density(i);
  if (atom->rmass[i] == 0.0 || has_mass_of_new_sphere(i)) atom->rmass[i] = lattice_mass(disc, type);
  if (atom->rho[i] == 0.0) atom->rho[i] = s.rho0;
}

double Others::lattice_mass(const Discretization &disc, int type)
{
  const State &s = disc.state[type];
  const Resolution &r = disc.resolution[type];
  if (s.form != TOTAL_LAGRANGIAN) return s.rho0 / r.psi_bulk;
  return s.rho0 * (disc.dim == 2 ? r.dx * r.dx : r.dx * r.dx * r.dx);
}

// one number for the checks of all densities: mass over volume
void Others::give_density(int i) const
{
  const double r = atom->radius_flag ? atom->radius[i] : 0.0;
  const double volume = r == 0.0 ? 1.0 / disc.psi_bulk
      : disc.dim == 2            ? MY_PI * r * r
                                 : 4.0 / 3.0 * MY_PI * r * r * r;
  atom->rho[i] = atom->rmass[i] / volume;
}

// atom_style sphere gives all new particles one, whatever they are; releases differ in its last bit
bool Others::has_mass_of_new_sphere(int i) const
{
  return atom->radius_flag && std::fabs(atom->rmass[i] / (MY_PI / 6.0) - 1.0) < 1e-15;
}

// spheres, in 2D too, as in fix nve/sphere
void Others::turn(double dt) const
{
  if (!spins) return;
  double **const omega = atom->omega, **const torque = atom->torque;
  const double dtf = dt * force->ftm2v / 0.4;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & disc.mover->groupbit)) continue;
    if (disc.state[atom->type[i]].species != NONE || atom->radius[i] == 0.0) continue;
    const double by = dtf / (atom->rmass[i] * atom->radius[i] * atom->radius[i]);
    for (int d = 0; d < 3; d++) omega[i][d] += by * torque[i][d];
  }
}
