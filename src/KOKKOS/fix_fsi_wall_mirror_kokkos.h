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
FixStyle(fsi/wall/mirror/kk,FixFSIWallMirrorKokkos);
// clang-format on
#else

#ifndef LMP_FIX_FSI_WALL_MIRROR_KOKKOS_H
#define LMP_FIX_FSI_WALL_MIRROR_KOKKOS_H

#include "fix_fsi_wall_mirror.h"

namespace LAMMPS_NS {

// Looks on the device for particles that are to be turned back; those few are turned on the host.

class FixFSIWallMirrorKokkos : public FixFSIWallMirror {
 public:
  FixFSIWallMirrorKokkos(class LAMMPS *, int, char **);
  void setup(int) override;
  void post_integrate() override;

 protected:
  std::vector<int> find_outside(const FSI::InnerBox &) override;

 private:
  bool turned = false;    // any in this step
};

}    // namespace LAMMPS_NS

#endif
#endif
