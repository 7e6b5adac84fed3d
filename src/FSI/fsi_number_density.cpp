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
#include "force.h"
#include "fsi_fields.h"
#include "fsi_part.h"
#include "fsi_profile.h"
#include "fsi_scene.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cstring>
#include <utility>

using namespace LAMMPS_NS;
using namespace FSI;

/* ---------------------------------------------------------------------- */

NumberDensity::NumberDensity(LAMMPS *lmp, Scene &scene, SumOverGhosts add_ghosts) :
    Pointers(lmp), scene(scene), add_ghosts(std::move(add_ghosts)), ratio(nullptr), send(true)
{
}

/* ---------------------------------------------------------------------- */

void NumberDensity::set_fields(Fields &fields)
{
  const int of_fluid = scene.density_fluid, of_solid = scene.density_solid;
  scene.keep_psi =
      scene.surface_every > 1 && of_fluid == Scene::CONTINUITY && of_solid == Scene::CONTINUITY;
  scene.need_psi = of_fluid != Scene::CONTINUITY || scene.surface_ratio > 0.0 ||
      (of_solid != Scene::CONTINUITY && facts_of_solids(lmp).style == Facts::OF_SOLIDS);
  fields.set("reference of ratio", Fields::RESTART, of_solid == Scene::RATIO, ratio);
  fields.set("number density", scene.keep_psi ? Fields::RESTART : Fields::STEP,
             scene.keep_psi || scene.need_psi, scene.psi);
}

/* ---------------------------------------------------------------------- */

void NumberDensity::add_messages(Message &to_ghosts)
{
  if (scene.need_psi) to_ghosts.add(scene.psi, {FLUID, SOLID, RIGID}, &send);
}

/* ---------------------------------------------------------------------- */

void NumberDensity::renew(bool advance)
{
  // or to new ghosts
  send = scene.need_psi && (!scene.keep_psi || !advance || neighbor->ago == 0);
  if (scene.need_psi && is_due(advance)) {
    const Phase phase(scene.profile, Profile::DENSITY);
    find(scene.psi);
    send = true;
  }
  if (!send) return;
  scene.psi_reference = scene.psi_bulk;
  if (scene.surface_max) {
    double mine = 0.0;
    for (int i = 0; i < atom->nlocal; i++)
      if (scene.state[atom->type[i]].species == FLUID && scene.psi[i] > mine) mine = scene.psi[i];
    MPI_Allreduce(&mine, &scene.psi_reference, 1, MPI_DOUBLE, MPI_MAX, world);
  }
  if (scene.density_fluid != Scene::CONTINUITY || scene.density_solid != Scene::CONTINUITY)
    find_density();
}

/* ----------------------------------------------------------------------
   setup goes on with what was kept, as a run must that goes on from a restart file
------------------------------------------------------------------------- */

bool NumberDensity::is_due(bool advance) const
{
  if (!scene.keep_psi) return true;
  if (advance) return update->ntimestep % scene.surface_every == 0;
  int mine = std::count(scene.psi, scene.psi + atom->nlocal, 0.0), all;
  MPI_Allreduce(&mine, &all, 1, MPI_INT, MPI_MAX, world);
  return all > 0;
}

/* ----------------------------------------------------------------------
   psi_i = sum_j W_ij, self included (paper eq. 8): over all neighbors for a fluid; for a solid over
   its own body, and over all neighbors in density mode summation, the paper's. Of finer fluids it
   is what it would be on the coarsest's lattice.
------------------------------------------------------------------------- */

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

/* ----------------------------------------------------------------------
   summation: rho_i = m_i psi_i (paper eq. 12)
   ratio: rho_i = rho_i^0 psi_i/psi_i^0 with the reference taken when the mode starts
------------------------------------------------------------------------- */

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
