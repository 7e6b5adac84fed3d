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

#include "fix_fsi_history.h"

#include "comm.h"
#include "error.h"
#include "fix_fsi.h"
#include "fsi_changes.h"
#include "modify.h"

#include <algorithm>
#include <cstdlib>

using namespace LAMMPS_NS;
using namespace FSI;

static constexpr char ID[] = "FSI_HISTORY";

// arguments: columns, name in one word
static std::string spaced(std::string word)
{
  std::replace(word.begin(), word.end(), '_', ' ');
  return word;
}

FixFSIHistory::FixFSIHistory(LAMMPS *lmp, int narg, char **arg) :
    FixFields(lmp, narg, arg, "fix FSI_HISTORY"), of(nullptr),
    name(narg == 5 ? spaced(arg[4]) : ""), columns(narg == 5 ? atoi(arg[3]) : 0)
{
  if (columns < 1) error->all(FLERR, "Fix FSI_HISTORY is made by pair_style fsi/solid/tl alone");
  fields.set(name, Fields::RESTART, true, of, columns);
  register_fields();
}

FixFSIHistory::~FixFSIHistory()
{
  if (auto *const now = FixFSI::there(lmp)) now->changes.forget();
}

FixFSIHistory *FixFSIHistory::keep(LAMMPS *lmp, std::string_view name, int columns)
{
  Modify *const modify = lmp->modify;
  auto *const old = dynamic_cast<FixFSIHistory *>(modify->get_fix_by_id(ID));
  if (old && old->name == name && old->columns == columns) return old;
  if (old) {
    if (lmp->comm->me == 0)
      lmp->error->warning(FLERR, "Pair style fsi/solid/tl: the {} of its bodies is forgotten",
                          old->name);
    modify->delete_fix(ID);
  }
  if (name.empty()) return nullptr;
  std::string word(name);
  std::replace(word.begin(), word.end(), ' ', '_');
  return dynamic_cast<FixFSIHistory *>(
      modify->add_fix(fmt::format("{} all FSI_HISTORY {} {}", ID, columns, word)));
}
