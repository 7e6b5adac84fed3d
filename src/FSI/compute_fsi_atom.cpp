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
#include "fsi_find.h"
#include "fsi_hub.h"
#include "fsi_keywords.h"
#include "fsi_number_density.h"
#include "fsi_refusals.h"
#include "fsi_shear.h"
#include "fsi_tensor.h"
#include "memory.h"
#include "pair_fsi_fluid.h"
#include "pair_fsi_solid_tl.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace FSI;

ComputeFSIAtom::ComputeFSIAtom(LAMMPS *lmp, int narg, char **arg) : Compute(lmp, narg, arg)
{
  if (narg < 4) utils::missing_cmd_args(FLERR, "compute fsi/atom", error);
  static const std::vector<std::string> names = {
      "p",   "rho", "psi", "volume",         "vonmises", "sxx",        "syy",      "szz",
      "sxy", "sxz", "syz", "plastic/strain", "bonds",    "shear/rate", "viscosity"};
  for (int iarg = 3; iarg < narg; iarg++) {
    const auto it = std::find(names.begin(), names.end(), arg[iarg]);
    if (it == names.end())
      error->all(FLERR, "Unknown compute fsi/atom quantity {}: expected {}", arg[iarg],
                 list_of(names));
    quantity.push_back(it - names.begin());
    tensor |= quantity.back() >= VONMISES && quantity.back() <= SYZ;
  }
  peratom_flag = 1;
  size_peratom_cols = quantity.size() == 1 ? 0 : quantity.size();
}

ComputeFSIAtom::~ComputeFSIAtom()
{
  memory->destroy(array_atom);
}

void ComputeFSIAtom::init()
{
  FixFSI::find(lmp, "Compute fsi/atom");
  const auto *const stress = first_of(fixes_of<FixFSIStress>(lmp));
  for (const int q : quantity)
    if (q == PLASTIC && (!stress || !stress->plastic))
      refuse(error, Refused::PLASTIC_STRAIN);
    else if (q >= SHEAR_RATE && !facts_of_fluids(lmp).style)
      refuse(error, Refused::SHEAR_RATE, q == SHEAR_RATE ? "shear/rate" : "viscosity");
}

void ComputeFSIAtom::compute_peratom()
{
  invoked_peratom = update->ntimestep;
  auto *const fix_fsi = FixFSI::ready(lmp, "Compute fsi/atom")->link(disc, step);
  if (atom->nmax > nmax) {
    nmax = atom->nmax;
    memory->destroy(array_atom);
    memory->create(array_atom, nmax, (int) quantity.size(), "fsi/atom:array_atom");
    if (!size_peratom_cols) vector_atom = array_atom[0];
  }
  const auto is_wanted = [this](int q) {
    return std::find(quantity.begin(), quantity.end(), q) != quantity.end();
  };
  const bool sums = is_wanted(PSI), rates = is_wanted(SHEAR_RATE) || is_wanted(VISCOSITY);
  // the style whose velocity gradients something needs; or null
  auto *fluid = first_of(pairs_of<PairFSIFluid>(lmp));
  if (fluid && !rates && !(tensor && fluid->has_laminar())) fluid = nullptr;
  if (sums || fluid) comm->forward_comm();    // ghosts stand where they were in mid-step
  if (sums) {
    psi.resize(atom->nmax);
    fix_fsi->number_density.find(psi.data());
  }
  shear = fluid ? &fluid->find_shear() : nullptr;
  solid_tl = first_of(pairs_of<PairFSISolidTL>(lmp));
  if (solid_tl) solid_tl->begin_stress();
  fix_stress = first_of(fixes_of<FixFSIStress>(lmp));

  for (int i = 0; i < atom->nlocal; i++) {
    const bool chosen = atom->mask[i] & groupbit;
    double of[NQUANTITY] = {};
    if (chosen) find(i, of);
    for (size_t k = 0; k < quantity.size(); k++) array_atom[i][k] = of[quantity[k]];
  }
}

// Cauchy stress sigma = -p I + S, tension positive, of fluids S = 2 eta D; sigma_zz of plane strain
// is -p - (S_xx + S_yy), of plane stress 0
void ComputeFSIAtom::find(int i, double *of) const
{
  const State &state = disc->state[atom->type[i]];
  const bool lagrangian = state.form == TOTAL_LAGRANGIAN;
  const bool has_stress = lagrangian || state.form == UPDATED_LAGRANGIAN;
  double *const sigma = of + SXX;
  if (!psi.empty()) of[PSI] = psi[i];
  if (has_stress && fix_stress) of[PLASTIC] = fix_stress->plastic_strain(i);
  if (solid_tl) of[BONDS] = solid_tl->bonds(i);
  if (lagrangian) {
    const auto tl = solid_tl->stress(i);
    of[PRESSURE] = tl.pressure();
    of[DENSITY] = state.rho0 / tl.J;
    of[VOLUME] = atom->rmass[i] * tl.J / state.rho0;
    of[VONMISES] = von_mises(tl.sigma);
    std::copy_n(tl.sigma, 6, sigma);
    return;
  }
  of[PRESSURE] = pressure_of(i, atom, *disc, *step);
  of[DENSITY] = atom->rho[i];
  of[VOLUME] = atom->rmass[i] / of[DENSITY];
  if (state.species == FLUID && shear) {
    of[SHEAR_RATE] = shear->rate(i);
    of[VISCOSITY] = shear->viscosity_of(i);
  }
  if (!tensor) return;
  if (has_stress) {
    const double *const s = fix_stress->stress[i];
    const bool flat = disc->dim == 2;
    std::copy_n(s, flat ? 2 : 6, sigma);
    if (flat) {
      sigma[2] = fix_stress->plane_stress ? of[PRESSURE] : -(s[0] + s[1]);
      sigma[3] = s[2];
    }
  }
  if (state.species == FLUID && shear) shear->stress(i, of[VISCOSITY], sigma);
  of[VONMISES] = von_mises(sigma);    // a pressure changes nothing
  for (int d = 0; d < 3; d++) sigma[d] -= of[PRESSURE];
}

double ComputeFSIAtom::memory_usage()
{
  return (double) nmax * quantity.size() * sizeof(double) +
      (double) psi.capacity() * sizeof(double);
}

// ---- fsi/surface/atom ----

ComputeFSISurfaceAtom::ComputeFSISurfaceAtom(LAMMPS *lmp, int narg, char **arg) :
    Compute(lmp, narg, arg)
{
  Keywords keywords(lmp, "compute fsi/surface/atom");
  keywords.key("number/density")
      .set(rule, NUMBER_DENSITY)
      .number(threshold, 0.75, Range::inside(0.0, 1.0), "threshold");
  keywords.key("divergence")
      .set(rule, DIVERGENCE)
      .number(threshold, 0.75, Range::inside(0.0, 1.0), "threshold");
  keywords.parse(narg - 3, arg + 3);
  peratom_flag = 1;
  size_peratom_cols = 0;
}

void ComputeFSISurfaceAtom::init()
{
  FixFSI::find(lmp, "Compute fsi/surface/atom");
  if (!facts_of_fluids(lmp).style)
    error->all(FLERR, "Compute fsi/surface/atom requires pair_style fsi/fluid");
}

// number/density: psi_i <= threshold * psi of the bulk lattice (the paper's rule)
// divergence: sum_j V_j x_ji.grad_i W_ij <= threshold * dim (Lee et al. 2008, J. Comput. Phys. 227,
//   8417); it does not depend on how dense the fluid is packed
void ComputeFSISurfaceAtom::compute_peratom()
{
  invoked_peratom = update->ntimestep;
  const auto *const fix_fsi = FixFSI::ready(lmp, "Compute fsi/surface/atom");
  const Discretization &disc = fix_fsi->disc;
  sum.resize(atom->nmax);
  vector_atom = sum.data();
  comm->forward_comm();    // ghosts still stand where they were in the middle of the step
  double limit;
  if (rule == NUMBER_DENSITY) {
    fix_fsi->number_density.find(sum.data());
    limit = threshold * disc.psi_bulk;
  } else {
    std::fill(sum.begin(), sum.end(), 0.0);
    first_of(pairs_of<PairFSIFluid>(lmp))->add_position_divergence(sum.data());
    fix_fsi->ghosts.add(sum.data());
    limit = threshold * disc.dim;
  }
  const int *const mask = atom->mask, *const type = atom->type;
  for (int i = 0; i < atom->nlocal; i++)
    sum[i] = (mask[i] & groupbit) && disc.state[type[i]].species == FLUID && sum[i] <= limit ? 1.0
                                                                                             : 0.0;
}

double ComputeFSISurfaceAtom::memory_usage()
{
  return (double) sum.capacity() * sizeof(double);
}
