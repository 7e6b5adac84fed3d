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

#include "fsi_number_density.h"

#include "atom.h"
#include "fsi_fields.h"
#include "fsi_part.h"
#include "fsi_profile.h"
#include "fsi_scene.h"

#include <cstring>
#include <utility>

using namespace LAMMPS_NS;
using namespace FSI;

NumberDensity::NumberDensity(LAMMPS *lmp, Scene &scene, SumOverGhosts add_ghosts) :
    Pointers(lmp), disc(scene), step(scene), parts(scene.parts), profile(scene.profile),
    add_ghosts(std::move(add_ghosts)), ratio(nullptr)
{
}

void NumberDensity::set_fields(Fields &fields)
{
  const int of_fluid = disc.density_fluid, of_solid = disc.density_solid;
  disc.need_psi = of_fluid != Discretization::CONTINUITY || disc.surface_ratio > 0.0 ||
      (of_solid != Discretization::CONTINUITY && facts_of_solids(lmp).style == Facts::OF_SOLIDS);
  fields.set("reference of ratio", Fields::RESTART, of_solid == Discretization::RATIO, ratio);
  fields.set("number density", Fields::STEP, disc.need_psi, step.psi);
}

void NumberDensity::add_messages(Message &to_ghosts)
{
  if (disc.need_psi) to_ghosts.add(step.psi, {FLUID, SOLID, RIGID});
}

void NumberDensity::renew()
{
  if (!disc.need_psi) return;
  const Phase phase(profile, Profile::DENSITY);
  find(step.psi);
  if (disc.surface_ratio > 0.0) {
    double most = 0.0;
    for (int i = 0; i < atom->nlocal; i++)
      if (disc.state[atom->type[i]].species == FLUID && step.psi[i] > most) most = step.psi[i];
    MPI_Allreduce(&most, &step.psi_reference, 1, MPI_DOUBLE, MPI_MAX, world);
  }
  if (disc.density_fluid != Discretization::CONTINUITY ||
      disc.density_solid != Discretization::CONTINUITY)
    find_density();
}

// psi_i = sum_j W_ij, self included (paper eq. 8): over all neighbors for a fluid; for a solid over
// its own body, and over all neighbors in density mode summation, the paper's. Of finer fluids it
// is what it would be on the coarsest's lattice.
void NumberDensity::find(double *n) const
{
  memset(n, 0, (atom->nlocal + atom->nghost) * sizeof(double));
  for (int i = 0; i < atom->nlocal; i++) n[i] = disc.w0;
  const auto for_finer = [&](auto f) {
    for (int i = 0; disc.has_levels() && i < atom->nlocal; i++)
      if (disc.level_of[atom->type[i]]) f(n[i], disc.resolution[atom->type[i]]);
  };
  for_finer([](double &psi, const Resolution &finer) {
    psi = finer.w0;
  });
  for (auto *p : parts) p->add_number_density(n, disc.density_solid == Discretization::SUMMATION);
  add_ghosts(n);
  for_finer([this](double &psi, const Resolution &finer) {
    psi *= disc.psi_bulk / finer.psi_bulk;
  });
}

// summation: rho_i = m_i psi_i (paper eq. 12)
// ratio: rho_i = rho_i^0 psi_i/psi_i^0 with the reference taken when the mode starts
void NumberDensity::find_density()
{
  double *rho = atom->rho;
  const double *const rmass = atom->rmass, *const psi = step.psi;
  for (int i = 0; i < atom->nlocal; i++) {
    const int species = disc.state[atom->type[i]].species;
    if (species == NONE || species == RIGID) continue;
    const int mode = species == FLUID ? disc.density_fluid : disc.density_solid;
    if (mode == Discretization::SUMMATION)
      rho[i] = rmass[i] * psi[i];
    else if (mode == Discretization::RATIO) {
      if (ratio[i] == 0.0) ratio[i] = rho[i] / psi[i];
      rho[i] = ratio[i] * psi[i];
    }
  }
}
