/* -*- c++ -*- ----------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   Copyright (2003) Sandia Corporation.  Under the terms of Contract
   DE-AC04-94AL85000 with Sandia Corporation, the U.S. Government retains
   certain rights in this software.  This software is distributed under
   the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// Styles found by what they are, not by their names, to which a suffix as /omp may be added.

#ifndef LMP_FSI_FIND_H
#define LMP_FSI_FIND_H

#include "compute.h"
#include "fix.h"
#include "force.h"
#include "lammps.h"
#include "modify.h"
#include "pair.h"

#include <vector>

namespace LAMMPS_NS::FSI {

// of class T, in the order of their definition
template <class T> std::vector<T *> fixes_of(const LAMMPS *lmp)
{
  std::vector<T *> found;
  for (auto &fix : lmp->modify->get_fix_list())
    if (auto *const one = dynamic_cast<T *>(fix)) found.push_back(one);
  return found;
}

template <class T> std::vector<T *> computes_of(const LAMMPS *lmp)
{
  std::vector<T *> found;
  for (auto &compute : lmp->modify->get_compute_list())
    if (auto *const one = dynamic_cast<T *>(compute)) found.push_back(one);
  return found;
}

// the pair style of this package, or those of a hybrid one
template <class T> std::vector<T *> pairs_of(const LAMMPS *lmp)
{
  std::vector<T *> found;
  if (!lmp->force->pair) return found;
  Pair *pair, *last = nullptr;
  for (int k = 1; (pair = lmp->force->pair_match("^fsi/", 0, k)) != last; k++) {
    if (auto *const one = dynamic_cast<T *>(pair)) found.push_back(one);
    last = pair;    // the only one has all numbers
  }
  return found;
}

template <class T> T *first_of(const std::vector<T *> &found)
{
  return found.empty() ? nullptr : found[0];
}

}    // namespace LAMMPS_NS::FSI

#endif
