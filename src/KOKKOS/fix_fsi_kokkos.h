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
FixStyle(fsi/kk,FixFSIKokkos);
// clang-format on
#else

#ifndef LMP_FIX_FSI_KOKKOS_H
#define LMP_FIX_FSI_KOKKOS_H

#include "fix_fsi.h"
#include "fsi_hub.h"
#include "kokkos_base.h"
#include "kokkos_type.h"

namespace LAMMPS_NS {

// Drift, kick, the check of each step and the density of ghosts on the device; what it calls of
// others on the host finds particles there.

class FixFSIKokkos : public FixFSI, public KokkosBase, public FSI::OnDevice {
 public:
  FixFSIKokkos(class LAMMPS *, int, char **);
  void init() override;
  void setup(int) override;
  void setup_pre_force(int) override;
  void pre_exchange() override;
  void pre_force(int) override;

  void to_host() override;
  void from_host() override;
  bool is_calm(bool closely, double force, double speed) override;

  int pack_forward_comm(int, int *, double *, int, int *) override;
  void unpack_forward_comm(int, int, double *) override;
  int pack_forward_comm_kokkos(int, DAT::tdual_int_1d, DAT::tdual_double_1d &, int, int *) override;
  void unpack_forward_comm_kokkos(int, int, DAT::tdual_double_1d &) override;

 protected:
  void drift() override;
  void kick() override;
  void find_near_walls() override {}    // pair_style fsi/fluid/kk does
  void send_state() override;

 private:
  void refuse_others() const;
  void show_changes();
};

}    // namespace LAMMPS_NS

#endif
#endif
