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

#include "fix_fsi_kokkos.h"

#include "atom_kokkos.h"
#include "atom_masks.h"
#include "atom_vec_fsi_kokkos.h"
#include "error.h"
#include "fix_fsi_dt.h"
#include "fix_fsi_report.h"
#include "fix_fsi_wall_mirror.h"
#include "fix_fsi_watch.h"
#include "force.h"
#include "fsi_check.h"
#include "fsi_clamps.h"
#include "fsi_find.h"
#include "fsi_part.h"
#include "neighbor.h"
#include "pair_fsi_fluid_kokkos.h"
#include "update.h"

using namespace LAMMPS_NS;
using namespace FSI;

typedef ArrayTypes<LMPDeviceType> AT;
typedef Kokkos::RangePolicy<LMPDeviceType> Atoms;

FixFSIKokkos::FixFSIKokkos(LAMMPS *lmp, int narg, char **arg) : FixFSI(lmp, narg, arg)
{
  kokkosable = 1;
  atomKK = static_cast<AtomKokkos *>(atom);
  execution_space = Device;
  datamask_read = datamask_modify = EMPTY_MASK;    // each call says what it takes
  if (!dynamic_cast<AtomVecFSIKokkos *>(atom->avec))
    error->all(FLERR, "Fix fsi/kk requires atom_style fsi/kk, and no hybrid one");
  step.device = this;
}

void FixFSIKokkos::init()
{
  FixFSI::init();
  refuse_others();
}

// what takes part in a step and knows of no device, or does nothing with particles there
void FixFSIKokkos::refuse_others() const
{
  if (!first_of(pairs_of<PairFSIFluidKokkos>(lmp)))
    error->all(FLERR, "Fix fsi/kk requires pair_style fsi/fluid/kk, which suffix kk takes");
  if (clamps.any())
    error->all(FLERR, "Fix fsi/kk does not support rigid bodies that move with the step of all");
  for (const auto *fix : fixes_of<Fix>(lmp)) {
    if (!dynamic_cast<const Part *>(fix) || dynamic_cast<const FixFSIWallMirror *>(fix) ||
        dynamic_cast<const FixFSIDt *>(fix) || dynamic_cast<const FixFSIReport *>(fix) ||
        dynamic_cast<const FixFSIWatch *>(fix))
      continue;
    error->all(FLERR,
               "Fix fsi/kk does not support fix {} (style {}): use both, and the pair style, "
               "without suffix kk",
               fix->id, fix->style);
  }
}

void FixFSIKokkos::to_host()
{
  atomKK->sync(Host, ALL_MASK);
}

void FixFSIKokkos::from_host()
{
  atomKK->modified(Host, ALL_MASK);
}

void FixFSIKokkos::setup(int vflag)
{
  to_host();
  FixFSI::setup(vflag);
}

// body forces look at groups and types where these may be new, the ledger at places
void FixFSIKokkos::show_changes()
{
  if (neighbor->ago == 0 || ledger.kept) to_host();
}

void FixFSIKokkos::setup_pre_force(int vflag)
{
  show_changes();
  FixFSI::setup_pre_force(vflag);
}

void FixFSIKokkos::pre_force(int vflag)
{
  show_changes();
  FixFSI::pre_force(vflag);
}

void FixFSIKokkos::pre_exchange()
{
  to_host();
  FixFSI::pre_exchange();
}

namespace {

struct Drift {
  AT::t_kkfloat_1d_3_lr x;
  AT::t_kkfloat_1d_3 v;
  AT::t_int_1d mask;
  double dth;
  int bit, dim;
  KOKKOS_FUNCTION void operator()(int i) const
  {
    if (mask(i) & bit)
      for (int d = 0; d < dim; d++) x(i, d) += dth * v(i, d);
  }
};

struct Kick {
  AT::t_kkfloat_1d_3_lr x;
  AT::t_kkfloat_1d_3 v;
  AT::t_kkacc_1d_3 f;
  AT::t_kkfloat_1d rmass;
  AT::t_int_1d mask;
  double dtf, dth;
  int bit, dim;
  KOKKOS_FUNCTION void operator()(int i) const
  {
    if (!(mask(i) & bit)) return;
    const double dtfm = dtf / rmass(i);
    for (int d = 0; d < dim; d++) {
      v(i, d) += dtfm * f(i, d);
      x(i, d) += dth * v(i, d);
    }
  }
};

// how many particles are not calm; comparisons that NaN fails
struct Look {
  AT::t_kkfloat_1d_3_lr x;
  AT::t_kkfloat_1d_3 v;
  AT::t_kkacc_1d_3 f;
  AT::t_kkfloat_1d rho;
  bool closely;
  double force, speed, most;
  KOKKOS_FUNCTION void operator()(int i, int &wild) const
  {
    bool calm = true;
    for (int d = 0; d < 3; d++) calm = calm && Kokkos::fabs(f(i, d)) <= force;
    for (int d = 0; closely && d < 3; d++)
      calm = calm && Kokkos::fabs(v(i, d)) <= speed && Kokkos::fabs(x(i, d)) <= most;
    if (closely) calm = calm && rho(i) > 0.0 && rho(i) < most;
    wild += !calm;
  }
};

struct PackDensity {
  AT::t_kkfloat_1d rho;
  AT::t_int_1d list;
  AT::t_double_1d to;
  KOKKOS_FUNCTION void operator()(int k) const { to(k) = rho(list(k)); }
};

struct UnpackDensity {
  AT::t_kkfloat_1d rho;
  AT::t_double_1d from;
  int first;
  KOKKOS_FUNCTION void operator()(int k) const { rho(first + k) = from(k); }
};

}    // namespace

void FixFSIKokkos::drift()
{
  atomKK->sync(execution_space, X_MASK | V_MASK | MASK_MASK);
  const Drift loop = {atomKK->k_x.view_device(),
                      atomKK->k_v.view_device(),
                      atomKK->k_mask.view_device(),
                      0.5 * update->dt,
                      groupbit,
                      disc.dim};
  Kokkos::parallel_for(Atoms(0, atom->nlocal), loop);
  atomKK->modified(execution_space, X_MASK);
}

void FixFSIKokkos::kick()
{
  atomKK->sync(execution_space, X_MASK | V_MASK | F_MASK | RMASS_MASK | MASK_MASK);
  const Kick loop = {atomKK->k_x.view_device(),
                     atomKK->k_v.view_device(),
                     atomKK->k_f.view_device(),
                     atomKK->k_rmass.view_device(),
                     atomKK->k_mask.view_device(),
                     update->dt * force->ftm2v,
                     0.5 * update->dt,
                     groupbit,
                     disc.dim};
  Kokkos::parallel_for(Atoms(0, atom->nlocal), loop);
  atomKK->modified(execution_space, X_MASK | V_MASK);
}

bool FixFSIKokkos::is_calm(bool closely, double force, double speed)
{
  atomKK->sync(execution_space, closely ? X_MASK | V_MASK | F_MASK | DPDRHO_MASK : F_MASK);
  const Look loop = {atomKK->k_x.view_device(),
                     atomKK->k_v.view_device(),
                     atomKK->k_f.view_device(),
                     atomKK->k_rho.view_device(),
                     closely,
                     force,
                     speed,
                     Check::OFF};
  int wild = 0;
  Kokkos::parallel_reduce(Atoms(0, atom->nlocal), loop, wild);
  return wild == 0;
}

// From device to device where messages of LAMMPS go so; all others are of the host.
void FixFSIKokkos::send_state()
{
  forward_comm_device = 1;
  FixFSI::send_state();
  forward_comm_device = 0;
}

int FixFSIKokkos::pack_forward_comm(int n, int *list, double *buf, int flag, int *pbc)
{
  atomKK->sync(Host, DPDRHO_MASK | TYPE_MASK);
  return FixFSI::pack_forward_comm(n, list, buf, flag, pbc);
}

void FixFSIKokkos::unpack_forward_comm(int n, int first, double *buf)
{
  atomKK->sync(Host, DPDRHO_MASK | TYPE_MASK);
  FixFSI::unpack_forward_comm(n, first, buf);
  atomKK->modified(Host, DPDRHO_MASK);
}

int FixFSIKokkos::pack_forward_comm_kokkos(int n, DAT::tdual_int_1d list, DAT::tdual_double_1d &buf,
                                           int, int *)
{
  atomKK->sync(execution_space, DPDRHO_MASK);
  Kokkos::parallel_for(
      Atoms(0, n), PackDensity{atomKK->k_rho.view_device(), list.view_device(), buf.view_device()});
  return n;
}

void FixFSIKokkos::unpack_forward_comm_kokkos(int n, int first, DAT::tdual_double_1d &buf)
{
  atomKK->sync(execution_space, DPDRHO_MASK);
  Kokkos::parallel_for(Atoms(0, n),
                       UnpackDensity{atomKK->k_rho.view_device(), buf.view_device(), first});
  atomKK->modified(execution_space, DPDRHO_MASK);
}
