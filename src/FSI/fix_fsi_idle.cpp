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

#include "fix_fsi.h"
// What a script names and what has nothing to act on: it costs nothing, but whoever named it should know.

#include "fix_fsi.h"

#include "comm.h"
#include "error.h"
#include "fix_fsi_dt.h"
#include "fix_fsi_stress.h"
#include "fix_fsi_wall_mirror.h"
#include "group.h"
#include "modify.h"
#include "pair_fsi_fluid.h"
#include "pair_fsi_solid.h"
#include "pair_fsi_solid_tl.h"

using namespace LAMMPS_NS;
using namespace FSI;

/* ---------------------------------------------------------------------- */

void FixFSI::warn_idle() const
{
  bigint mine[2] = {0, 0}, all[2];    // fluid and solid particles
  for (int i = 0; i < atom->nlocal; i++)
    if (state[atom->type[i]].species != RIGID) mine[state[atom->type[i]].species == SOLID]++;
  MPI_Allreduce(mine, all, 2, MPI_LMP_BIGINT, MPI_SUM, world);

  std::vector<std::string> idle;
  const auto nothing = [&](const std::string &what, const std::string &why) { idle.push_back(what + " has nothing to act on: " + why); };
  const auto style = [&](const PairFSI *pair, const char *name, const char *why) {
    std::string named;
    for (const auto &e : pair->effects())
      if (e.on) named += (named.empty() ? " with " : ", ") + e.keyword;
    nothing(fmt::format("Pair style {}{}", name, named), why);
  };
  static const char *const NO_FLUID = "no particle is a fluid", *const NO_SOLID = "no particle is a solid";

  if (fluid && all[0] == 0) style(fluid, "fsi/fluid", NO_FLUID);
  if (!wall_fixes.empty() && !fluid) nothing("Fix fsi/wall/mirror", "walls mirror fluids, and there is no pair_style fsi/fluid");
  else if (!wall_fixes.empty() && all[0] == 0) nothing("Fix fsi/wall/mirror", NO_FLUID);
  if (fix_stress && !solid && !(solid_tl && solid_tl->hypoelastic())) nothing("Fix fsi/stress", "no solid is hypoelastic");
  if (all[1] == 0) {
    if (solid) style(solid, "fsi/solid", NO_SOLID);
    if (solid_tl) style(solid_tl, "fsi/solid/tl", NO_SOLID);
    if (fix_stress && (solid || (solid_tl && solid_tl->hypoelastic()))) nothing("Fix fsi/stress", NO_SOLID);
    if (substeps > 1) nothing("Fix fsi substeps", NO_SOLID);
  }
  if (fix_dt && fix_dt->chooses_substeps() && !solid_tl) nothing("Fix fsi/dt substeps auto", "there is no pair_style fsi/solid/tl");
  if (surface_every > 1 && !need_psi) nothing("Fix fsi surface/every", "pair_style fsi/fluid has no surface rule");
  if (surface_every > 1 && need_psi && !keep_psi) nothing("Fix fsi surface/every", "a density mode needs the number density in each step");
  if (!fluid && density_fluid != CONTINUITY) nothing("Fix fsi fluid density", "there is no pair_style fsi/fluid");
  if (!solid && !solid_tl && density_solid != CONTINUITY) nothing("Fix fsi solid density", "there is no pair_style fsi/solid");
  if (fluid && !fluid->has_laminar())
    for (const auto &w : walls.wall)
      if (w.noslip) {
        nothing("Fix fsi/wall/mirror slip no", "pair_style fsi/fluid has no laminar/visc");
        break;
      }
  for (const char *name : {"^fsi/dt$", "^fsi/watch$"})
    for (auto &fix : modify->get_fix_by_style(name))
      if (group->count(fix->igroup) == 0)
        nothing(fmt::format("Fix {}", fix->style), fmt::format("group {} is empty", group->names[fix->igroup]));

  if (comm->me == 0)
    for (const auto &text : idle) error->warning(FLERR, text);
}
