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

#include "force.h"
#include "lammps.h"
#include "pair.h"

using namespace LAMMPS_NS;
using namespace FSI;

static Facts facts_of(LAMMPS *lmp, const char *style)
{
  if (!lmp->force->pair) return Facts();
  const auto *const part = dynamic_cast<const Part *>(lmp->force->pair_match(style, 1));
  return part ? part->facts() : Facts();
}

Facts FSI::facts_of_fluids(LAMMPS *lmp)
{
  return facts_of(lmp, "fsi/fluid");
}

// there is one of the two (pair_fsi_solid_tl.cpp)
Facts FSI::facts_of_solids(LAMMPS *lmp)
{
  const Facts facts = facts_of(lmp, "fsi/solid");
  return facts.style ? facts : facts_of(lmp, "fsi/solid/tl");
}
