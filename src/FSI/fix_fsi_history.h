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

#ifdef FIX_CLASS
// clang-format off
FixStyle(FSI_HISTORY,FixFSIHistory);
// clang-format on
#else

#ifndef LMP_FIX_FSI_HISTORY_H
#define LMP_FIX_FSI_HISTORY_H

#include "fsi_fields.h"

#include <string>
#include <string_view>

namespace LAMMPS_NS {

// What a law of total-Lagrangian solids keeps of each particle (fsi_law_list.h): it goes with its
// atom from rank to rank, through restart files and from one pair_style command to the next.
// Internal: pair_style fsi/solid/tl makes it where a law has a history, and only there.

class FixFSIHistory : public FSI::FixFields {
 public:
  FixFSIHistory(class LAMMPS *, int, char **);
  ~FixFSIHistory() override;
  int setmask() override { return 0; }

  // that of this name (empty: none) and so many numbers of each particle; what there was of another
  // is gone. All ranks together
  static FixFSIHistory *keep(class LAMMPS *, std::string_view name, int columns);
  double **of;    // of local atoms

 private:
  const std::string name;
  const int columns;
};

}    // namespace LAMMPS_NS

#endif
#endif
