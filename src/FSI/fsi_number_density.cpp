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

#include "fsi_number_density.h"

#include "atom.h"
#include "force.h"
#include "fsi_fields.h"
#include "fsi_gather.h"
#include "fsi_hub.h"
#include "fsi_kernel.h"
#include "fsi_profile.h"
#include "fsi_record.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace FSI;

void NumberDensity::set_fields(Fields &fields)
{
  const int of_fluid = disc.density_fluid, of_solid = disc.density_solid;
  disc.need_psi = of_fluid != Discretization::CONTINUITY || disc.surface_ratio > 0.0 ||
      (of_solid != Discretization::CONTINUITY && facts_of_solids(lmp).style == Facts::OF_SOLIDS);
  fields.set("reference of ratio", Fields::RESTART, of_solid == Discretization::RATIO, ratio);
  fields.set("number density", Fields::STEP, disc.need_psi, step.psi);
}

void NumberDensity::add_messages(Message &to_ghosts)
{
  if (disc.need_psi) to_ghosts.add(step.psi, {FLUID, SOLID, RIGID});
}

void NumberDensity::renew()
{
  if (!disc.need_psi) return;
  const Phase phase(step.profile, Profile::DENSITY);
  find(step.psi);
  if (disc.surface_ratio > 0.0) {
    double most = 0.0;
    for (int i = 0; i < atom->nlocal; i++)
      if (disc.state[atom->type[i]].species == FLUID && step.psi[i] > most) most = step.psi[i];
    step.psi_reference = over_ranks(most, MPI_MAX, world);
  }
  if (disc.density_fluid != Discretization::CONTINUITY ||
      disc.density_solid != Discretization::CONTINUITY)
    find_density();
}

// psi_i = sum_j W_ij, self included (paper eq. 8): over all neighbors for a fluid; for a solid over
// its own body, and over all neighbors in density mode summation, the paper's. Of finer fluids it
// is what it would be on the coarsest's lattice.
void NumberDensity::find(double *n) const
{
  memset(n, 0, (atom->nlocal + atom->nghost) * sizeof(double));
  for (int i = 0; i < atom->nlocal; i++) n[i] = disc.w0;
  const auto for_finer = [&](auto f) {
    for (int i = 0; disc.has_levels() && i < atom->nlocal; i++)
      if (disc.level_of[atom->type[i]]) f(n[i], disc.resolution[atom->type[i]]);
  };
  for_finer([](double &psi, const Resolution &finer) {
    psi = finer.w0;
  });
  for (auto *p : parts) p->add_number_density(n, disc.density_solid == Discretization::SUMMATION);
  ghosts.add(n);
  for_finer([this](double &psi, const Resolution &finer) {
    psi *= disc.psi_bulk / finer.psi_bulk;
  });
}

std::vector<double> NumberDensity::find_asymmetry() const
{
  const int nlocal = atom->nlocal, dim = disc.dim;
  const size_t nall = nlocal + atom->nghost;
  std::vector<double> gradient(dim * nall, 0.0), s(nlocal);    // components one after the other
  for (auto *p : parts) p->add_gradient_sum(gradient.data());
  for (int d = 0; d < dim; d++) ghosts.add(&gradient[d * nall]);
  for (int i = 0; i < nlocal; i++) {
    double ssq = 0.0;
    for (int d = 0; d < dim; d++) ssq += gradient[d * nall + i] * gradient[d * nall + i];
    s[i] = disc.h * std::sqrt(ssq);
  }
  return s;
}

// summation: rho_i = m_i psi_i (paper eq. 12)
// ratio: rho_i = rho_i^0 psi_i/psi_i^0 with the reference taken when the mode starts
void NumberDensity::find_density()
{
  double *rho = atom->rho;
  const double *const rmass = atom->rmass, *const psi = step.psi;
  for (int i = 0; i < atom->nlocal; i++) {
    const int species = disc.state[atom->type[i]].species;
    if (species == NONE || species == RIGID) continue;
    const int mode = species == FLUID ? disc.density_fluid : disc.density_solid;
    if (mode == Discretization::SUMMATION)
      rho[i] = rmass[i] * psi[i];
    else if (mode == Discretization::RATIO) {
      if (ratio[i] == 0.0) ratio[i] = rho[i] / psi[i];
      rho[i] = ratio[i] * psi[i];
    }
  }
}

// time from one look to the next over h/c: ten usual time steps, in which particles move by h/2 at
// a Mach number of 0.1
static constexpr double PERIOD = 5.0;
static const std::string SINCE = "time since the last look at surfaces";
static constexpr double ROUND = 1.0e-6;    // missing parts of a lattice's sum that may be round-off
// more deficit over that of a plane than on any edge: of the two sides of a film s cancels
static constexpr double EDGE = 100.0;

// sums over the planes of a lattice that are missing
void SurfaceDeficit::find_layers()
{
  const ChosenKernel k(disc.kernel, disc.dim, disc.h / disc.dx);
  const double psi = lattice_number_density(k, 1.0);
  const int n = static_cast<int>(k.cut) + 1;
  double s = 0.0, missing = 0.0;
  layers = {{0.0, 0.0}};
  for (int z = n; z > 0; z--) {
    double w = 0.0, g = 0.0;
    for (int y = (k.dim == 3 ? -n : 0); y <= (k.dim == 3 ? n : 0); y++)
      for (int x = -n; x <= n; x++) {
        const double r = std::sqrt(double(x * x + y * y + z * z));
        if (r >= k.cut) continue;
        w += k.W(r);
        g -= k.gradient(r) * z;
      }
    missing += w / psi;
    s += k.h * g / psi;
    if (w > 0.0) layers.emplace_back(s, missing);
  }
}

// linear between layers; beyond the first one, at edges, as between the last two
double SurfaceDeficit::of_plane(double s) const
{
  size_t k = 1;
  while (k + 1 < layers.size() && s > layers[k].first) k++;
  const auto &a = layers[k - 1], &b = layers[k];
  return a.second + (s - a.first) * (b.second - a.second) / (b.first - a.first);
}

void SurfaceDeficit::set_array(Fields &fields)
{
  // a pair style that comes after fix fsi may want it: what a restart file has of it is read here
  const auto wanted = [&]() {
    return !force->pair || facts_of_fluids(lmp).density_at_surfaces;
  };
  fields.set("room at the surface", Fields::RESTART,
             disc.density_fluid == Discretization::CONTINUITY && wanted(), deficit, 2);
  if (deficit) find_layers();
}

void SurfaceDeficit::write(Record &record) const
{
  if (deficit) record.add(SINCE, std::vector<double>{since});
}

void SurfaceDeficit::read(const Record &record)
{
  if (record.has(SINCE)) since = record.numbers(SINCE)[0];
}

// by time, not by steps, which reset_timestep may count anew
void SurfaceDeficit::pass(double dt)
{
  double fastest = 0.0;
  for (const auto &s : disc.state)
    if (s.species == FLUID) fastest = std::max(fastest, s.c);
  since_before = since;
  since += dt;
  due = since * fastest >= PERIOD * (1.0 - 1.0e-9) * disc.h;
  if (due) since = 0.0;
}

bool SurfaceDeficit::add_rates(bool advance)
{
  if (deficit && advance) pass(update->dt);
  if (deficit && ledger.kept && advance && due) earlier.assign(atom->rho, atom->rho + atom->nlocal);
  return false;
}

void SurfaceDeficit::advance(bool advance)
{
  changes.clear();
  if (!deficit || (advance && !due)) return;
  const Phase phase(step.profile, Profile::DENSITY);
  begin();
  if (advance) follow();
}

void SurfaceDeficit::undo_advance()
{
  since = since_before;
  for (size_t i = 0; i < changes.size() / 2; i++) {
    deficit[i][0] -= changes[2 * i];
    atom->rho[i] -= changes[2 * i + 1];
  }
}

std::vector<Part::Effect> SurfaceDeficit::effects() const
{
  if (!facts_of_fluids(lmp).style) return {};
  return {{"density that follows surfaces", "density/surface", deficit != nullptr}};
}

// of particles that are new
void SurfaceDeficit::begin()
{
  const int nlocal = atom->nlocal, *const type = atom->type;
  const auto is_new = [&](int i) {
    return disc.state[type[i]].species == FLUID && deficit[i][0] == 0.0;
  };
  bool any_new = false;
  for (int i = 0; i < nlocal; i++) any_new |= is_new(i);
  if (!anywhere(any_new, world)) return;
  std::vector<double> psi(nlocal + atom->nghost);
  number_density.find(psi.data());
  const auto asymmetry = number_density.find_asymmetry();
  for (int i = 0; i < nlocal; i++)
    if (is_new(i)) {
      const double missing = std::max(0.0, 1.0 - psi[i] / disc.psi_bulk),
                   plane = of_plane(asymmetry[i]);
      deficit[i][0] = 1.0 + missing;
      const bool inside = missing <= std::max(plane, ROUND);
      deficit[i][1] = inside ? 1.0 : missing < EDGE * plane ? missing / plane : EDGE;
    }
}

void SurfaceDeficit::follow()
{
  const auto asymmetry = number_density.find_asymmetry();
  changes.assign(2 * atom->nlocal, 0.0);
  for (int i = 0; i < atom->nlocal; i++) {
    const State &state = disc.state[atom->type[i]];
    if (state.species != FLUID) continue;
    const double had = deficit[i][0] - 1.0, most = deficit[i][1] * of_plane(asymmetry[i]),
                 free = 1.0 - atom->rho[i] / state.rho0;
    const double has = had > most ? most : free > 0.0 ? std::min(most, had + free) : had;
    if (has == had) continue;
    const double before = atom->rho[i];
    deficit[i][0] = 1.0 + has;
    atom->rho[i] = std::max(before + (has - had) * state.rho0, atom->rmass[i] * disc.w0);
    changes[2 * i] = has - had;
    changes[2 * i + 1] = atom->rho[i] - before;
    if (ledger.kept)
      ledger.energy_out[Ledger::DIFFUSION] += energy_loss(i, before, atom->rho[i] - before);
  }
}

// Forces have the density of before until the step's start, and that of after from there: the
// change is one at its start, between two densities, which is what the ledger's energy is of (where
// it takes half of a step's work, the other is in the next)
double SurfaceDeficit::energy_loss(int i, double now, double change) const
{
  const State &state = disc.state[atom->type[i]];
  double sum = 0.0;
  for (const double rho : {earlier[i], now}) sum += state.energy(rho) - state.energy(rho + change);
  return 0.5 * atom->rmass[i] * sum;
}
