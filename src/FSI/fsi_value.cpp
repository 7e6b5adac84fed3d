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

#include "fsi_value.h"

#include "atom.h"
#include "error.h"
#include "fsi_keywords.h"
#include "group.h"
#include "input.h"
#include "memory.h"
#include "modify.h"
#include "update.h"
#include "variable.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace FSI;

Values::Values(LAMMPS *lmp, const std::string &command, int n) :
    Pointers(lmp), command(command), list(n), each(nullptr), nmax(0)
{
}

Values::~Values()
{
  memory->destroy(each);
}

void Values::read(int k, const std::string &word, const std::string &what, const std::string &other)
{
  if (utils::strmatch(word, "^v_")) return set_variable(k, word.substr(2));
  std::string title = command;
  title[0] = toupper(title[0]);
  list[k].number = numeric(lmp, title + " " + what, word, {}, false, other);
  list[k].source = NUMBER;
}

void Values::set_variable(int k, const std::string &name)
{
  list[k].name = name;
  list[k].source = EQUAL;    // or atom-style, see find()
}

// Each time by its name: a variable that is deleted gives its number in LAMMPS' list to others
int Values::variable(Value &v) const
{
  const int n = input->variable->find(v.name.c_str());
  if (n < 0) error->all(FLERR, "Variable {} of {} does not exist", v.name, command);
  if (input->variable->equalstyle(n))
    v.source = EQUAL;
  else if (input->variable->atomstyle(n))
    v.source = ATOM;
  else
    error->all(FLERR, "Variable {} of {} must be equal-style or atom-style", v.name, command);
  return n;
}

void Values::find()
{
  for (auto &v : list)
    if (!v.name.empty()) variable(v);
}

bool Values::of_atoms() const
{
  return std::any_of(list.begin(), list.end(), [](const Value &v) {
    return v.source == ATOM;
  });
}

std::string Values::text() const
{
  std::string text;
  for (const auto &v : list) {
    const auto number = v.source == FREE ? "NULL" : fmt::format("{}", v.number);
    text += (text.empty() ? "" : " ") + (v.name.empty() ? number : "v_" + v.name);
  }
  return text;
}

void Values::evaluate(int igroup, int first, int n, bool atoms)
{
  if (atoms && of_atoms() && atom->nmax > nmax) {
    nmax = atom->nmax;
    memory->destroy(each);
    memory->create(each, nmax, list.size(), "fsi:values");
  }
  modify->clearstep_compute();
  for (int k = first; k < first + n; k++) {
    Value &v = list[k];
    if (v.name.empty()) continue;
    const int index = variable(v);
    if (v.source == ATOM) {
      v.number = 0.0;
      if (atoms) input->variable->compute_atom(index, igroup, &each[0][k], list.size(), 0);
      continue;
    }
    v.number = input->variable->compute_equal(index);
    if (!std::isfinite(v.number))
      error->all(FLERR, "Variable {} of {} is {} on step {}: expected a number", v.name, command,
                 v.number, update->ntimestep);
  }
  modify->addstep_compute(update->ntimestep + 1);
}

int Values::shared_group() const
{
  return group->find_or_create("fsi_variables");
}

void Values::mark(int i, int igroup) const
{
  if (igroup) atom->mask[i] ^= group->bitmask[igroup];
}

double Values::memory_usage() const
{
  return (double) nmax * list.size() * sizeof(double);
}
