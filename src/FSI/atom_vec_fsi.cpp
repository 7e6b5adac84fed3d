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

#include "atom_vec_fsi.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "fsi_find.h"
#include "fsi_part.h"
#include "fsi_record.h"

using namespace LAMMPS_NS;
using namespace FSI;

AtomVecFSI::AtomVecFSI(LAMMPS *lmp) : AtomVec(lmp), rmass(nullptr), rho(nullptr)
{
  molecular = Atom::ATOMIC;
  mass_type = PER_ATOM;

  atom->molecule_flag = 1;
  atom->rmass_flag = 1;
  atom->rho_flag = 1;

  // mass and body never change on a ghost; its density is refreshed by fix fsi, after the density
  // step

  fields_grow = {"molecule", "rmass", "rho"};
  fields_copy = {"molecule", "rmass", "rho"};
  fields_border = {"molecule", "rmass", "rho"};
  fields_border_vel = {"molecule", "rmass", "rho"};
  fields_exchange = {"molecule", "rmass", "rho"};
  fields_restart = {"molecule", "rmass", "rho"};
  fields_create = {"molecule", "rmass", "rho"};
  fields_data_atom = {"id", "molecule", "type", "rho", "rmass", "x"};
  fields_data_vel = {"id", "v"};

  setup_fields();
}

void AtomVecFSI::grow_pointers()
{
  rmass = atom->rmass;
  rho = atom->rho;
  // create_atoms, fix deposit ... take the mass of a molecule without Masses from a radius, which
  // is not there: here from the mass that it still is, create_atom_post()'s 0
  if (!atom->radius_flag) atom->radius = rmass;
}

AtomVecFSI *AtomVecFSI::of(Atom *atom)
{
  return dynamic_cast<AtomVecFSI *>(atom->style_match("fsi"));
}

AtomVecFSI::~AtomVecFSI()
{
  if (!atom->radius_flag) atom->radius = nullptr;
}

// zero mass and density mean "not set yet": fix fsi gives such a particle
// the mass that makes its bulk lattice stress-free and the density of its material
void AtomVecFSI::create_atom_post(int ilocal)
{
  rmass[ilocal] = 0.0;
  rho[ilocal] = 0.0;
}

void AtomVecFSI::data_atom_post(int ilocal)
{
  if (rho[ilocal] < 0.0)
    error->one(
        FLERR,
        "Invalid density {} in Atoms section of data file: expected >= 0 (0 = of the material)",
        rho[ilocal]);
  if (rmass[ilocal] < 0.0)
    error->one(FLERR,
               "Invalid mass {} in Atoms section of data file: expected >= 0 (0 = of the lattice)",
               rmass[ilocal]);
}

// A data file has none of what fixes and pair styles keep of solids: they have the density at which
// there is no pressure. When the first atom comes, a warning
void AtomVecFSI::pack_data_pre(int ilocal)
{
  const size_t t = atom->type[ilocal];
  kept = rho[ilocal];
  if (t < density_of_solids.size() && density_of_solids[t] > 0.0)
    rho[ilocal] = density_of_solids[t];
  if (ilocal > 0 || comm->me > 0) return;
  if (!any_is(fixes_of<Part>(lmp), &Facts::keeps_solids) &&
      !any_is(pairs_of<Part>(lmp), &Facts::keeps_solids))
    return;
  error->warning(FLERR,
                 "Data files hold no strain, stress or bonds of solids: read again, bodies are at "
                 "rest in the shape that they have. write_restart keeps all");
}

void AtomVecFSI::pack_data_post(int ilocal)
{
  rho[ilocal] = kept;
}

int AtomVecFSI::property_atom(const std::string &name)
{
  return name == "rho" ? 0 : -1;
}

void AtomVecFSI::pack_property_atom(int /*index*/, double *buf, int nvalues, int groupbit)
{
  for (int i = 0; i < atom->nlocal; i++)
    buf[i * nvalues] = (atom->mask[i] & groupbit) ? rho[i] : 0.0;
}
