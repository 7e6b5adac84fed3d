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

#include "compute_fsi_atom.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "fix_fsi.h"
#include "fix_fsi_stress.h"
#include "force.h"
#include "fsi_tensor.h"
#include "memory.h"
#include "modify.h"
#include "pair_fsi_solid_tl.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace FSI;

/* ---------------------------------------------------------------------- */

ComputeFSIAtom::ComputeFSIAtom(LAMMPS *lmp, int narg, char **arg) :
    Compute(lmp, narg, arg), nmax(0), fix_fsi(nullptr)
{
  if (narg < 4) utils::missing_cmd_args(FLERR, "compute fsi/atom", error);
  static const std::vector<std::string> names = {"p",        "rho", "psi", "volume",
                                                 "vonmises", "sxx", "syy", "szz",
                                                 "sxy",      "sxz", "syz", "plastic/strain"};
  for (int iarg = 3; iarg < narg; iarg++) {
    const auto it = std::find(names.begin(), names.end(), arg[iarg]);
    if (it == names.end())
      error->all(FLERR,
                 "Unknown compute fsi/atom quantity {}: expected p, rho, psi, volume, vonmises, "
                 "sxx, syy, szz, sxy, sxz, syz or plastic/strain",
                 arg[iarg]);
    quantity.push_back(it - names.begin());
  }
  peratom_flag = 1;
  size_peratom_cols = quantity.size() == 1 ? 0 : quantity.size();
}

/* ---------------------------------------------------------------------- */

ComputeFSIAtom::~ComputeFSIAtom()
{
  memory->destroy(vector_atom);
  memory->destroy(array_atom);
}

/* ---------------------------------------------------------------------- */

void ComputeFSIAtom::init()
{
  fix_fsi = FixFSI::find(lmp, "Compute fsi/atom");
  const auto *const stress = FixFSIStress::find(lmp);
  if (std::find(quantity.begin(), quantity.end(), PLASTIC) != quantity.end() &&
      (!stress || !stress->plastic))
    error->all(FLERR, "Compute fsi/atom plastic/strain requires fix fsi/stress plastic");
}

/* ---------------------------------------------------------------------- */

void ComputeFSIAtom::grow()
{
  const int n = quantity.size();
  if (atom->nmax <= nmax) return;
  nmax = atom->nmax;
  if (n == 1) {
    memory->destroy(vector_atom);
    memory->create(vector_atom, nmax, "fsi/atom:vector_atom");
  } else {
    memory->destroy(array_atom);
    memory->create(array_atom, nmax, n, "fsi/atom:array_atom");
  }
}

/* ---------------------------------------------------------------------- */

void ComputeFSIAtom::compute_peratom()
{
  invoked_peratom = update->ntimestep;
  fix_fsi = FixFSI::ready(lmp, "Compute fsi/atom");
  const int n = quantity.size();
  grow();
  if (std::find(quantity.begin(), quantity.end(), PSI) != quantity.end()) {
    psi.resize(atom->nmax);
    comm->forward_comm();    // ghosts still stand where they were in the middle of the step
    fix_fsi->number_density.find(psi.data());
  }
  auto *const solid_tl = PairFSISolidTL::find(lmp);
  if (solid_tl) solid_tl->begin_stress();
  fix_stress = FixFSIStress::find(lmp);
  const auto has_stress = [this](int i) {
    return fix_fsi->state[atom->type[i]].form == UPDATED_LAGRANGIAN;
  };

  const int *const mask = atom->mask;
  PairFSISolidTL::Stress tl;
  for (int i = 0; i < atom->nlocal; i++) {
    const bool lagrangian = (mask[i] & groupbit) && fix_fsi->is_total_lagrangian(i);
    if (lagrangian) tl = solid_tl->stress(i);
    for (int k = 0; k < n; k++) {
      double value = 0.0;
      if (lagrangian) {
        switch (quantity[k]) {
          case PRESSURE:
            value = tl.pressure();
            break;
          case DENSITY:
            value = fix_fsi->state[atom->type[i]].rho0 / tl.J;
            break;
          case PSI:
            value = psi[i];
            break;
          case VOLUME:
            value = atom->rmass[i] * tl.J / fix_fsi->state[atom->type[i]].rho0;
            break;
          case VONMISES:
            value = tl.von_mises();
            break;
          case PLASTIC:
            value = fix_stress->plastic_strain(i);
            break;
          default:
            value = tl.sigma[quantity[k] - SXX];
        }
      } else if (mask[i] & groupbit) {
        switch (quantity[k]) {
          case PRESSURE:
            value = fix_fsi->pressure(i);
            break;
          case DENSITY:
            value = atom->rho[i];
            break;
          case PSI:
            value = psi[i];
            break;
          case VOLUME:
            value = atom->rmass[i] / atom->rho[i];
            break;
          case VONMISES:
            if (has_stress(i)) value = fix_stress->von_mises(i, fix_fsi->pressure(i));
            break;
          case PLASTIC:
            if (has_stress(i)) value = fix_stress->plastic_strain(i);
            break;
          default:
            value = cauchy(i, quantity[k]);
        }
      }
      if (n == 1)
        vector_atom[i] = value;
      else
        array_atom[i][k] = value;
    }
  }
}

/* ----------------------------------------------------------------------
   component of the Cauchy stress sigma = -p I + S, tension positive
------------------------------------------------------------------------- */

double ComputeFSIAtom::cauchy(int i, int component) const
{
  const double p = fix_fsi->pressure(i);
  const bool stress = fix_fsi->state[atom->type[i]].form == UPDATED_LAGRANGIAN;
  const double *s = stress ? fix_stress->stress[i] : nullptr;
  const bool flat = fix_fsi->dim == 2;
  switch (component) {
    case SXX:
      return -p + (s ? s[0] : 0.0);
    case SYY:
      return -p + (s ? s[1] : 0.0);
    case SZZ:
      if (s && flat) return fix_stress->plane_stress ? 0.0 : -p - s[0] - s[1];
      return -p + (s ? s[2] : 0.0);
    case SXY:
      return s ? s[flat ? 2 : 3] : 0.0;
    case SXZ:
      return (s && !flat) ? s[4] : 0.0;
    default:
      return (s && !flat) ? s[5] : 0.0;
  }
}

/* ---------------------------------------------------------------------- */

double ComputeFSIAtom::memory_usage()
{
  return (double) nmax * quantity.size() * sizeof(double) +
      (double) psi.capacity() * sizeof(double);
}
