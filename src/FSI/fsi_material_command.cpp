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

#include "fsi_material_command.h"

#include "atom.h"
#include "atom_vec_fsi.h"
#include "comm.h"
#include "error.h"
#include "fsi_material.h"

#include <cstring>

using namespace LAMMPS_NS;
using namespace FSI;

// A name that is given again is the new material; a pair style has it from its next pair_coeff on.
void FSIMaterial::command(int narg, char **arg)
{
  auto *const avec = AtomVecFSI::of(atom);
  if (!avec) error->all(FLERR, "Fsi/material requires atom_style fsi before it");
  if (narg < 2)
    error->all(FLERR,
               "Fsi/material expects a name, fluid, solid or wall, and keywords with values, or "
               "file and the name of a material file");
  if (narg == 2 && strcmp(arg[0], "file") == 0) {
    for (const Material &m : read_all_materials(lmp, arg[1])) avec->materials[m.name] = describe(m);
    return;
  }
  const std::string name = arg[0];
  if (name == describe({}))
    error->all(FLERR, "Fsi/material {}: this name stands for no material in pair_coeff", name);
  std::string line = name;
  for (int k = 1; k < narg; k++) line += std::string(" ") + arg[k];
  if (comm->me == 0)
    read_material(lmp, "of command fsi/material", line);    // what is wrong with it is an error
  MPI_Barrier(world);
  avec->materials[name] = line;
}
