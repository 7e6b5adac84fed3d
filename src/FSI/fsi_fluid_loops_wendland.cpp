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

// The loops of pair_style fsi/fluid for one kernel: a file each, since they take long to compile.

#include "fsi_fluid_rows.h"

using namespace LAMMPS_NS;
using namespace FSI;

#if FSI_PACKS
std::shared_ptr<FluidLoops> FSI::make_fluid_loops_wendland(int dim, double h)
{
  if (dim == 2) return std::make_shared<FluidLoopsOf<Pack, Wendland<2>>>(Wendland<2>(h));
  return std::make_shared<FluidLoopsOf<Pack, Wendland<3>>>(Wendland<3>(h));
}
#endif
