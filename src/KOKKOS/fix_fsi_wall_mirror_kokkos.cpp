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

#include "kokkos_type.h"    // first: says what functions for a device are

#include "fix_fsi_wall_mirror_kokkos.h"

#include "atom_kokkos.h"
#include "atom_masks.h"
#include "error.h"
#include "fsi_hub.h"

using namespace LAMMPS_NS;
using namespace FSI;

FixFSIWallMirrorKokkos::FixFSIWallMirrorKokkos(LAMMPS *lmp, int narg, char **arg) :
    FixFSIWallMirror(lmp, narg, arg)
{
  kokkosable = 1;
  atomKK = static_cast<AtomKokkos *>(atom);
  execution_space = Device;
  datamask_read = datamask_modify = EMPTY_MASK;    // each call says what it takes
}

void FixFSIWallMirrorKokkos::setup(int vflag)
{
  atomKK->sync(Host, X_MASK | MASK_MASK | TYPE_MASK | TAG_MASK);
  FixFSIWallMirror::setup(vflag);
}

namespace {
struct CountOutside {
  ArrayTypes<LMPDeviceType>::t_kkfloat_1d_3_lr x;
  ArrayTypes<LMPDeviceType>::t_int_1d mask;
  InnerBox inner;
  int bit;
  KOKKOS_FUNCTION void operator()(int i, int &outside) const
  {
    const double at[3] = {x(i, 0), x(i, 1), x(i, 2)};
    outside += (mask(i) & bit) && !inner.contains(at);
  }
};
}    // namespace

std::vector<int> FixFSIWallMirrorKokkos::find_outside(const InnerBox &inner)
{
  atomKK->sync(execution_space, X_MASK | MASK_MASK);
  const CountOutside loop = {atomKK->k_x.view_device(), atomKK->k_mask.view_device(), inner,
                             groupbit};
  int outside = 0;
  Kokkos::parallel_reduce(Kokkos::RangePolicy<LMPDeviceType>(0, atom->nlocal), loop, outside);
  turned = outside > 0;
  if (!turned) return {};
  atomKK->sync(Host, ALL_MASK);
  return FixFSIWallMirror::find_outside(inner);
}

void FixFSIWallMirrorKokkos::post_integrate()
{
  FixFSIWallMirror::post_integrate();
  if (turned) atomKK->modified(Host, X_MASK | V_MASK);
}
