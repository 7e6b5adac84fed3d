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

// The loops of pair_style fsi/fluid pair by pair, once for any kernel, for processors and compilers
// without packs and for the paper's couplings; and the choice between these and those with packs.

#include "fsi_fluid_rows.h"

#include "exceptions.h"
#include "fmt/format.h"

using namespace LAMMPS_NS;
using namespace FSI;

std::shared_ptr<FluidLoops> FSI::make_fluid_loops(int kernel, int dim, double h, bool packs)
{
#if FSI_PACKS
  if (packs) {
    if (kernel == CUBIC) return make_fluid_loops_cubic(dim, h);
    if (kernel == QUINTIC) return make_fluid_loops_quintic(dim, h);
    return make_fluid_loops_wendland(dim, h);
  }
#endif
  if (dim == 2)
    return std::make_shared<FluidLoopsOf<double, ChosenKernelOf<2>>>(ChosenKernelOf<2>(kernel, h));
  return std::make_shared<FluidLoopsOf<double, ChosenKernelOf<3>>>(ChosenKernelOf<3>(kernel, h));
}

void FSI::no_such_loop(const char *what, int kind, int flags)
{
  throw LAMMPSException(fmt::format(
      "Pair style fsi/fluid has no loop of {} for pairs of kind {} with the effects {:#x}: please "
      "report it",
      what, kind, flags));
}
