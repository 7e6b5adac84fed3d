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

#include "atom_vec_fsi_kokkos.h"

#include "atom_kokkos.h"
#include "atom_masks.h"
#include "error.h"
#include "fix.h"
#include "kokkos.h"
#include "memory_kokkos.h"
#include "modify.h"

#include <algorithm>

using namespace LAMMPS_NS;

AtomVecFSIKokkos::AtomVecFSIKokkos(LAMMPS *lmp) : AtomVec(lmp), AtomVecKokkos(lmp), AtomVecFSI(lmp)
{
}

// LAMMPS' own messages on the device carry no density, and those that make ghosts with velocities
// no masses (a slip, of 4 Jul 2026): those that come with new lists go by the host.
void AtomVecFSIKokkos::init()
{
  AtomVecFSI::init();
  set_atom_masks();
  lmp->kokkos->exchange_comm_legacy = 1;
}

template <class Use> void AtomVecFSIKokkos::for_arrays(uint64_t mask, Use use)
{
  if (mask & X_MASK) use(atomKK->k_x);
  if (mask & V_MASK) use(atomKK->k_v);
  if (mask & F_MASK) use(atomKK->k_f);
  if (mask & TAG_MASK) use(atomKK->k_tag);
  if (mask & TYPE_MASK) use(atomKK->k_type);
  if (mask & MASK_MASK) use(atomKK->k_mask);
  if (mask & IMAGE_MASK) use(atomKK->k_image);
  if (mask & MOLECULE_MASK) use(atomKK->k_molecule);
  if (mask & RMASS_MASK) use(atomKK->k_rmass);
  if (mask & DPDRHO_MASK) use(atomKK->k_rho);
}

// n = 0: by a piece
void AtomVecFSIKokkos::grow(int n)
{
  nmax = n ? n : nmax + std::max(static_cast<int>(LMP_KOKKOS_AV_DELTA), nmax / 100);
  atom->nmax = nmax;
  if (nmax < 0 || nmax > MAXSMALLINT) error->one(FLERR, "Per-processor system is too big");

  atomKK->sync(Device, ALL_MASK);
  atomKK->modified(Device, ALL_MASK);
  memoryKK->grow_kokkos(atomKK->k_tag, atomKK->tag, nmax, "atom:tag");
  memoryKK->grow_kokkos(atomKK->k_type, atomKK->type, nmax, "atom:type");
  memoryKK->grow_kokkos(atomKK->k_mask, atomKK->mask, nmax, "atom:mask");
  memoryKK->grow_kokkos(atomKK->k_image, atomKK->image, nmax, "atom:image");
  memoryKK->grow_kokkos(atomKK->k_x, atomKK->x, nmax, "atom:x");
  memoryKK->grow_kokkos(atomKK->k_v, atomKK->v, nmax, "atom:v");
  memoryKK->grow_kokkos(atomKK->k_f, atomKK->f, nmax, "atom:f");
  memoryKK->grow_kokkos(atomKK->k_molecule, atomKK->molecule, nmax, "atom:molecule");
  memoryKK->grow_kokkos(atomKK->k_rmass, atomKK->rmass, nmax, "atom:rmass");
  memoryKK->grow_kokkos(atomKK->k_rho, atomKK->rho, nmax, "atom:rho");
  grow_pointers();
  atomKK->sync(Host, ALL_MASK);

  for (int k = 0; k < atom->nextra_grow; k++) modify->fix[atom->extra_grow[k]]->grow_arrays(nmax);
}

void AtomVecFSIKokkos::grow_pointers()
{
  AtomVecFSI::grow_pointers();
  tag = atomKK->tag;
  type = atomKK->type;
  mask = atomKK->mask;
  image = atomKK->image;
  x = atomKK->x;
  v = atomKK->v;
  f = atomKK->f;
}

void AtomVecFSIKokkos::sort_kokkos(Kokkos::BinSort<KeyViewType, BinOp> &sorter)
{
  const uint64_t all_but_forces = ALL_MASK & ~F_MASK;
  atomKK->sync(Device, all_but_forces);
  for_arrays(all_but_forces, [&](auto &array) {
    sorter.sort(LMPDeviceType(), array.view_device());
  });
  atomKK->modified(Device, all_but_forces);
}

void AtomVecFSIKokkos::sync(ExecutionSpace space, uint64_t mask)
{
  for_arrays(mask, [=](auto &array) {
    if (space == Device)
      array.sync_device();
    else if constexpr (requires { array.sync_hostkk(); })
      space == Host ? array.sync_host() : array.sync_hostkk();
    else
      array.sync_host();
  });
}

void AtomVecFSIKokkos::modified(ExecutionSpace space, uint64_t mask)
{
  for_arrays(mask, [=](auto &array) {
    if (space == Device)
      array.modify_device();
    else if constexpr (requires { array.modify_hostkk(); })
      space == Host ? array.modify_host() : array.modify_hostkk();
    else
      array.modify_host();
  });
}

void AtomVecFSIKokkos::sync_pinned(ExecutionSpace space, uint64_t mask, int async)
{
  for_arrays(mask, [=, this](auto &array) {
    if (!(space == Device ? array.need_sync_device() : array.need_sync_host())) return;
    if constexpr (requires { array.sync_hostkk(); })
      perform_pinned_copy_transform(array, space, async);
    else
      perform_pinned_copy(array, space, async);
  });
}
