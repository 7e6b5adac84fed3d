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

#ifdef PAIR_CLASS
// clang-format off
PairStyle(fsi/fluid/kk,PairFSIFluidKokkos);
// clang-format on
#else

#ifndef LMP_PAIR_FSI_FLUID_KOKKOS_H
#define LMP_PAIR_FSI_FLUID_KOKKOS_H

#include "pair_fsi_fluid.h"

namespace LAMMPS_NS {
namespace FSI {
  struct AtomArrays;
  struct Meetings;
}    // namespace FSI

// Fluids alone, with mirror walls: rates of density and forces on the device. What else the plain
// style has is refused.

class PairFSIFluidKokkos : public PairFSIFluid {
  struct Members;
  const std::unique_ptr<Members> kk;

 public:
  PairFSIFluidKokkos(class LAMMPS *);
  ~PairFSIFluidKokkos() override;
  void init_style() override;
  void compute(int, int) override;
  void begin_state(bool) override;
  bool add_rates(bool) override;
  void advance(bool) override;
  void react() override;
  void undo_advance() override;
  double memory_usage() override;

 private:
  void refuse_others() const;
  FSI::AtomArrays arrays() const;
  FSI::FluidParticles particles_on_device() const;
  void set_meetings(FSI::Meetings &, const FSI::Walls &);
  template <int D, bool OF_RATES> void gather(double t);
  void find_near_walls();
  template <class K> void find_rates(const K &);
  template <class K> void find_forces(const K &, bool tally);
  template <class K, bool SUMS> void run_forces(const K &, double *sums, int nsums);
};

}    // namespace LAMMPS_NS

#endif
#endif
