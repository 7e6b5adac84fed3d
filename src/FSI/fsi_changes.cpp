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

#include "fsi_changes.h"

#include "atom.h"
#include "atom_vec_fsi.h"
#include "comm.h"
#include "compute.h"
#include "domain.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "fsi_find.h"
#include "fsi_gather.h"
#include "fsi_lammps_access.h"
#include "fsi_part.h"
#include "fsi_refusals.h"
#include "modify.h"
#include "neighbor.h"
#include "pair.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace FSI;

// Who is where in the arrays of this rank, and of what type, whether ghosts are there, which some
// commands take away, and who renews them: FNV-1a of it
uint64_t Changes::fingerprint() const
{
  uint64_t hash = 14695981039346656037ULL;
  const auto add = [&](uint64_t number) {
    hash = (hash ^ number) * 1099511628211ULL;
  };
  add(atom->nghost);
  add(comm->style);
  for (int i = 0; i < atom->nlocal; i++) {
    add(atom->tag[i]);
    add(atom->type[i]);
  }
  return hash;
}

void Changes::begin_run()
{
  stale = true;
  pours = false;
  for (const auto *fix : modify->get_fix_list())
    pours |= utils::strmatch(fix->style, "^deposit") || utils::strmatch(fix->style, "^pour");
}

// fix deposit and fix pour with id next count on from what there was when they were defined
void Changes::check_births()
{
  const auto ids = gather(births, world);
  births.clear();
  if (ids.empty()) return;
  const auto found = find_particles(atom, world, [&](int i) {
    return ids.count(atom->tag[i]) > 0;
  });
  if (found.count > (bigint) ids.size())
    error->all(FLERR,
               "A fix made atoms with IDs that others have, as {}: fix deposit and fix pour need "
               "id max where fixes of the package make particles, too",
               *ids.begin());
}

void Changes::made(int i)
{
  forget();
  if (pours && update->whichflag == 1) births.insert(atom->tag[i]);
}

void Changes::check_file() const
{
  if (modify->nfix_restart_peratom && in_file >= 0 && in_file != atom->natoms)
    error->all(
        FLERR,
        "The restart file has {} atoms, now there are {}: what it keeps of each is lost with "
        "delete_atoms. Give fix fsi and run 0 before it",
        in_file, atom->natoms);
}

void Changes::set_up()
{
  there = present();
  AtomVecFSI::of(atom)->of_fixes.clear();
}

void Changes::in_step()
{
  if (pours && neighbor->ago == 0) check_births();
  nlocal = atom->nlocal;
  stale = false;
}

bool Changes::of_atoms() const
{
  return stale || nlocal != atom->nlocal || (update->whichflag == 0 && known != fingerprint());
}

bool Changes::any_mass() const
{
  const int n = atom->nlocal;
  return anywhere(std::count(atom->rmass, atom->rmass + n, 0.0) < n, world);
}

std::vector<std::uintptr_t> Changes::present() const
{
  std::vector<std::uintptr_t> list;
  const auto add = [&](const void *p) {
    list.push_back(reinterpret_cast<std::uintptr_t>(p));
  };
  add(force->pair);
  for (const auto *const pair : pairs_of<Pair>(lmp)) {
    const auto *const part = dynamic_cast<const Part *>(pair);
    add(pair);
    list.push_back(part && part->is_set_up());
  }
  for (auto &region : domain->get_region_list()) add(region);
  // a new one may be at the address of that in whose place it came
  for (auto &fix : modify->get_fix_list()) list.push_back(number_of(fix));
  for (auto &compute : modify->get_compute_list()) {
    add(compute);
    list.push_back(compute->is_initialized());
  }
  return list;
}

bool Changes::in_first_step(const Update *update)
{
  return update->ntimestep - 1 == update->firststep;
}

void Changes::check_pre_no() const
{
  if (in_first_step(update) && there != present()) refuse(error, Refused::PRE_NO);
}
