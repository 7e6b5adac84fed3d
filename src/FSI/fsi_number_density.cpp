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
    Pointers(lmp), scene(scene), add_ghosts(std::move(add_ghosts)), ratio(nullptr)
{
}

void NumberDensity::set_fields(Fields &fields)
{
  const int of_fluid = scene.density_fluid, of_solid = scene.density_solid;
  scene.need_psi = of_fluid != Scene::CONTINUITY || scene.surface_ratio > 0.0 ||
      (of_solid != Scene::CONTINUITY && facts_of_solids(lmp).style == Facts::OF_SOLIDS);
  fields.set("reference of ratio", Fields::RESTART, of_solid == Scene::RATIO, ratio);
  fields.set("number density", Fields::STEP, scene.need_psi, scene.psi);
}

void NumberDensity::add_messages(Message &to_ghosts)
{
  if (scene.need_psi) to_ghosts.add(scene.psi, {FLUID, SOLID, RIGID});
}

void NumberDensity::renew()
{
  if (!scene.need_psi) return;
  const Phase phase(scene.profile, Profile::DENSITY);
  find(scene.psi);
  if (scene.surface_ratio > 0.0) {
    double mine = 0.0;
    for (int i = 0; i < atom->nlocal; i++)
      if (scene.state[atom->type[i]].species == FLUID && scene.psi[i] > mine) mine = scene.psi[i];
    MPI_Allreduce(&mine, &scene.psi_reference, 1, MPI_DOUBLE, MPI_MAX, world);
  }
  if (scene.density_fluid != Scene::CONTINUITY || scene.density_solid != Scene::CONTINUITY)
    find_density();
}

// psi_i = sum_j W_ij, self included (paper eq. 8): over all neighbors for a fluid; for a solid over
// its own body, and over all neighbors in density mode summation, the paper's. Of finer fluids it
// is what it would be on the coarsest's lattice.
void NumberDensity::find(double *n) const
{
  memset(n, 0, (atom->nlocal + atom->nghost) * sizeof(double));
  for (int i = 0; i < atom->nlocal; i++) n[i] = scene.w0;
  const auto for_finer = [&](auto f) {
    for (int i = 0; scene.has_levels() && i < atom->nlocal; i++)
      if (scene.level_of[atom->type[i]]) f(n[i], scene.resolution[atom->type[i]]);
  };
  for_finer([](double &psi, const Resolution &own) {
    psi = own.w0;
  });
  for (auto *p : scene.parts) p->add_number_density(n, scene.density_solid == Scene::SUMMATION);
  add_ghosts(n);
  for_finer([this](double &psi, const Resolution &own) {
    psi *= scene.psi_bulk / own.psi_bulk;
  });
}

// summation: rho_i = m_i psi_i (paper eq. 12)
// ratio: rho_i = rho_i^0 psi_i/psi_i^0 with the reference taken when the mode starts
void NumberDensity::find_density()
{
  double *rho = atom->rho;
  const double *const rmass = atom->rmass, *const psi = scene.psi;
  for (int i = 0; i < atom->nlocal; i++) {
    const int species = scene.state[atom->type[i]].species;
    if (species == NONE || species == RIGID) continue;
    const int mode = species == FLUID ? scene.density_fluid : scene.density_solid;
    if (mode == Scene::SUMMATION)
      rho[i] = rmass[i] * psi[i];
    else if (mode == Scene::RATIO) {
      if (ratio[i] == 0.0) ratio[i] = rho[i] / psi[i];
      rho[i] = ratio[i] * psi[i];
    }
  }
}
