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

#include "fsi_gather.h"

#include "comm.h"
#include "domain.h"
#include "lammps.h"
#include "neighbor.h"

using namespace LAMMPS_NS;

void FSI::renew_ghosts(LAMMPS *lmp)
{
  lmp->domain->pbc();
  lmp->domain->reset_box();
  lmp->comm->setup();
  if (lmp->neighbor->style) lmp->neighbor->setup_bins();
  lmp->comm->exchange();
  lmp->comm->borders();
}

double FSI::part_by_place(const double *x, const Domain *domain)
{
  double part = 0.0, digit = 0.5;
  for (int d = 0; d < domain->dimension; d++, digit *= 1.0e-4)
    part += digit * (x[d] - domain->boxlo[d]) / domain->prd[d];
  return part;
}
