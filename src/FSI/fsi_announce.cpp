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

#include "fsi_part.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "fix.h"
#include "fsi_gather.h"
#include "fsi_kernel.h"
#include "fsi_scene.h"
#include "lammps.h"

#include <string>
#include <vector>

using namespace LAMMPS_NS;
using namespace FSI;

static void say_effects(LAMMPS *lmp, Scene &scene, std::string &text)
{
  const auto modes = Scene::density_names(SOLID);
  static const char *const kernels[] = {"cubic spline", "quintic spline", "Wendland C2"};
  const bool fluid = facts_of_fluids(lmp).style;
  const auto solid = facts_of_solids(lmp).style;
  std::vector<Part::Effect> effects;
  if (fluid)
    effects.push_back(
        {fmt::format("density of the fluid by {}", modes[scene.density_fluid]), "", true});
  if (solid == Facts::OF_SOLIDS)
    effects.push_back(
        {fmt::format("density of the solid by {}", modes[scene.density_solid]), "", true});
  for (const auto *p : scene.parts)
    for (const auto &e : p->effects()) effects.push_back(e);
  if (fluid) {
    effects.push_back({fmt::format("{} mirror walls", scene.walls.wall.size()),
                       "fix fsi/wall/mirror", scene.walls.any()});
    int planes = 0;
    for (const auto &w : scene.walls.wall) planes += w.joins != 0;
    effects.push_back({fmt::format("{} planes of symmetry of solids", planes),
                       "fix fsi/wall/mirror symmetry", planes > 0});
    int n = 0;
    for (const auto *p : scene.parts) n += p->facts().particle_walls;
    effects.push_back(
        {fmt::format("{} groups of wall particles", n), "fix fsi/wall/particle", n > 0});
  }
  if (solid == Facts::OF_TOTAL_LAGRANGIAN_SOLIDS) {
    bool chosen = false;
    for (const auto *p : scene.parts) chosen |= p->facts().chooses_substeps;
    effects.push_back({chosen ? "solid sub-steps, as many as fix fsi/dt chooses"
                              : fmt::format("{} solid sub-steps", scene.substeps),
                       "fix fsi substeps", chosen || scene.substeps > 1});
  }
  if (scene.article)
    effects.push_back({"what the article's scheme sets where nothing else is said", "", true});
  effects.push_back({"energy balance", "compute fsi/energy", scene.kept});

  std::string on, off;
  for (const auto &e : effects)
    if (e.on)
      on += "\n    " + e.name;
    else
      off += (off.empty() ? "" : ", ") + e.keyword;
  std::string finer;
  for (size_t t = 1; t < scene.resolution.size(); t++)
    if (scene.dx_of(t) != scene.dx)
      finer += fmt::format("{} {:g} of type {}", finer.empty() ? "," : " and", scene.dx_of(t), t);
  text += fmt::format(
      "FSI: {}, h = {:g} dx, dx = {:g}{}\n  on: {}\n  off (keyword that turns it on): {}\n",
      kernels[scene.kernel], scene.h / scene.dx, scene.dx, finer, on, off.empty() ? "none" : off);
  if (fluid)
    with_kernel(scene.kernel, scene.dim, scene.h, [&](const auto &k) {
      const auto s = lattice_stiffness(k, scene.dx);
      text += fmt::format("  a lattice of the fluid under a pressure p has a modulus of {:.3f} p "
                          "when stretched, {:.3f} p in shear (a fluid: 0)\n",
                          s.stretch, s.shear);
    });
}

// effects that a script names and that have nothing to act on
static void warn_idle(LAMMPS *lmp, const Scene &scene)
{
  bigint mine[2] = {0, 0}, all[2];    // fluid and solid particles
  for (int i = 0; i < lmp->atom->nlocal; i++) {
    const int species = scene.state[lmp->atom->type[i]].species;
    if (species == FLUID || species == SOLID) mine[species == SOLID]++;
  }
  MPI_Allreduce(mine, all, 2, MPI_LMP_BIGINT, MPI_SUM, lmp->world);

  const auto nothing = [&](const std::string &what, const std::string &why) {
    if (lmp->comm->me == 0) lmp->error->warning(FLERR, what + " has nothing to act on: " + why);
  };
  for (const auto *p : scene.parts) p->find_idle({all[0], all[1]}, nothing);
  if (scene.substeps > 1 && all[1] == 0) nothing("Fix fsi substeps", "no particle is a solid");
  if (scene.article) return;
  if (scene.density_fluid != Scene::CONTINUITY && !facts_of_fluids(lmp).style)
    nothing("Fix fsi fluid density", "there is no pair_style fsi/fluid");
  if (scene.density_solid != Scene::CONTINUITY && !facts_of_solids(lmp).style)
    nothing("Fix fsi solid density", "there is no pair_style fsi/solid");
}

void FSI::announce(LAMMPS *lmp, Scene &scene)
{
  std::string text;
  say_effects(lmp, scene, text);
  // commands may have made fluid that nobody moves
  const auto held = find_particles(lmp->atom, lmp->world, [&](int i) {
    return scene.state[lmp->atom->type[i]].species == FLUID && !scene.is_moved(i);
  });
  const auto now = fmt::format("{}{}", text, held.count);
  if (now == scene.announced) return;
  scene.announced = now;
  if (lmp->comm->me == 0) utils::logmesg(lmp, text);
  advise(lmp, scene);
  warn_idle(lmp, scene);
}
