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

#include "pair_fsi_solid_tl.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix_fsi.h"
#include "fix_fsi_reference.h"
#include "fix_fsi_stress.h"
#include "force.h"
#include "fsi_contact.h"
#include "fsi_viscosity_artificial.h"
#include "memory.h"
#include "modify.h"
#include "neigh_list.h"
#include "update.h"

#include <cmath>
#include <cstring>
#include <type_traits>

using namespace LAMMPS_NS;
using namespace FSI;

static constexpr char REFERENCE[] = "FSI_REFERENCE";

/* ---------------------------------------------------------------------- */

PairFSISolidTL::PairFSISolidTL(LAMMPS *lmp) :
    PairFSI(lmp, "fsi/solid/tl"), strain_energy(0.0), reference(nullptr), fsolid(nullptr), nmax(0), bond_loop{nullptr, nullptr}
{
  no_virial_fdotr_compute = 1;
  artificial_row("solid");
  keywords.key("hourglass").number(zeta, 0.0, Range::from(0.0)).effect("hourglass control of the solid {}");
  keywords.key("law").choice(law, SVK, {"svk", "neohookean", "hypo"});
  keywords.key("plane").choice(plane_stress, 0, {"strain", "stress"});
  keywords.key("gradient").choice(linear, 0, {"quadratic", "linear"});
  keywords.key("volumes").choice(plain, 0, {"corrected", "plain"});
  contact_row();
  keywords.key("damage").number(damage, 0.0, Range::from(0.0), "strain").effect("damage at strain {}");
}

PairFSISolidTL::~PairFSISolidTL()
{
  memory->destroy(fsolid);
  if (modify->nfix && modify->get_fix_by_id(REFERENCE)) modify->delete_fix(REFERENCE);
}

template <> const StVenantKirchhoff *PairFSISolidTL::laws<StVenantKirchhoff>() const
{
  return svk.data();
}
template <> const NeoHookean *PairFSISolidTL::laws<NeoHookean>() const
{
  return neohookean.data();
}
template <> const HypoElastic *PairFSISolidTL::laws<HypoElastic>() const
{
  return hypo.data();
}

/* ---------------------------------------------------------------------- */

void PairFSISolidTL::check_settings()
{
  if (plane_stress && law == NEOHOOKEAN) error->all(FLERR, "Pair style fsi/solid/tl plane stress requires law svk or hypo");
}

/* ---------------------------------------------------------------------- */

bool PairFSISolidTL::handles(int a, int b) const
{
  return a == SOLID && b == SOLID;
}

/* ---------------------------------------------------------------------- */

State PairFSISolidTL::make_state(const Material &m) const
{
  return solid_state(m, plane_stress);
}

/* ---------------------------------------------------------------------- */

void PairFSISolidTL::init_style()
{
  PairFSI::init_style();
  check_contact();
  const int dim = hub->dim;
  if (plane_stress && dim == 3) error->all(FLERR, "Pair style fsi/solid/tl plane is for dimension 2 only");
  if (force->pair_match("^fsi/solid$", 0)) error->all(FLERR, "Use either pair_style fsi/solid or fsi/solid/tl, not both");

  // bonds find their partners by atom ID
  if (atom->map_style == Atom::MAP_NONE) {
    atom->map_init();
    atom->map_set();
  }
  reference = dynamic_cast<FixFSIReference *>(modify->get_fix_by_id(REFERENCE));
  if (!reference)
    reference = dynamic_cast<FixFSIReference *>(modify->add_fix(fmt::format("{} all fsi/reference", REFERENCE)));
  reference->quadratic = !linear;
  reference->end_corrected = !plain;
  comm_forward = has_artificial() || law == HYPO ? 2 * dim : dim;
  comm_reverse = dim;

  svk.clear();
  neohookean.clear();
  hypo.clear();
  for (const auto &m : material) {
    const bool is = m.species == SOLID;
    const double K = is ? m.bulk_modulus() : 1.0, G = is ? m.shear_modulus() : 1.0;
    svk.emplace_back(K, G, plane_stress);
    neohookean.emplace_back(K, G, false);
    hypo.emplace_back(is && plane_stress ? m.plane_stress_modulus() : K, G, plane_stress);
  }

  const int flags = (zeta > 0.0 ? HOURGLASS : 0) | (has_artificial() ? VISCOSITY : 0) |
      (modify->get_compute_by_style("^fsi/energy$").empty() ? 0 : LEDGER);
  if (law == SVK) dim == 2 ? select<StVenantKirchhoff, 2>(flags) : select<StVenantKirchhoff, 3>(flags);
  else if (law == NEOHOOKEAN) dim == 2 ? select<NeoHookean, 2>(flags) : select<NeoHookean, 3>(flags);
  else dim == 2 ? select<HypoElastic, 2>(flags) : select<HypoElastic, 3>(flags);
}

template <class L, int D> void PairFSISolidTL::select(int flags)
{
  pick<L, D>(flags, std::make_integer_sequence<int, NFLAGS>());
}

template <class L, int D, int... F> void PairFSISolidTL::pick(int flags, std::integer_sequence<int, F...>)
{
  using Loop = void (PairFSISolidTL::*)();
  static constexpr Loop table[] = {&PairFSISolidTL::bond_forces<L, D, F>...};
  bond_loop[0] = table[flags];
  bond_loop[1] = table[flags | VIRIAL];
}

/* ---------------------------------------------------------------------- */

const std::vector<int> &PairFSISolidTL::solids() const
{
  return reference->solids;
}

/* ----------------------------------------------------------------------
   with sub-steps the forces act inside fix fsi's last half of the step, not here; but in setup forces, energy and virial are seen
------------------------------------------------------------------------- */

void PairFSISolidTL::compute(int eflag, int vflag)
{
  const Phase phase(hub->profile, Profile::SOLID);
  ev_init(eflag, vflag);
  check_tally();
  if (hub->substeps > 1 && !update->setupflag) return;
  internal_forces();
  double **f = atom->f;
  for (const int i : reference->solids)
    for (int d = 0; d < hub->dim; d++) f[i][d] += fsolid[i][d];
}

/* ---------------------------------------------------------------------- */

void PairFSISolidTL::internal_forces()
{
  if (atom->nmax > nmax) {
    nmax = atom->nmax;
    memory->destroy(fsolid);
    memory->create(fsolid, nmax, 3, "pair:fsolid");
  }
  for (const auto *set : {&reference->solids, &reference->ghosts})
    for (const int i : *set) fsolid[i][0] = fsolid[i][1] = fsolid[i][2] = 0.0;
  (this->*bond_loop[vflag_global ? 1 : 0])();
  if (list) {
    if (hub->dim == 2) contact_forces<2>();
    else contact_forces<3>();
  }
  exchange(hub->profile, comm, this, true, [this]() { reference->swaps.reverse(this); }, reference->swaps.skip_empty());
}

/* ----------------------------------------------------------------------
   per bond of i: F_i; hourglass control; forces; artificial viscosity

   Hourglass control (after Ganzenmueller 2015, in energy form): psi_i gains sum_j zeta E V_i V_j W/|X|^2 |r_ij|^2/2,
   r_ij = (x_j - x_i) - F_i X_ij: what the linear field F_i does not explain of its neighbours' positions.
   Artificial viscosity (fsi_viscosity_artificial.h) with the reference kernel; each particle of a pair does half.
------------------------------------------------------------------------- */

template <class L, int D, int FLAGS> void PairFSISolidTL::bond_forces()
{
  constexpr int NV = 2 * D + 2;
  double **x = atom->x;
  double **v = atom->v;
  const int *const type = atom->type;
  const double *const rmass = atom->rmass;
  const State *const state = hub->state.data();
  const L *const law_of = laws<L>();
  double **stress_of = hypoelastic() ? hub->fix_stress->stress : nullptr;
  const ArtificialViscosity viscosity(alpha, beta, hub->h);
  strain_energy = 0.0;

  for (const int i : reference->solids) {
    const int n = reference->count(i), *const partner = reference->partners(i);
    if (n == 0) continue;    // torn off by damage
    const double *const values = reference->values(i);
    const State &si = state[type[i]];
    const double vol = rmass[i] / si.rho0 * reference->weight(i);

    double F[D * D] = {};
    const double *b = values;
    for (int k = 0; k < n; k++, b += NV) {
      const double *const xj = x[partner[k]];
      for (int a = 0; a < D; a++) {
        const double d = xj[a] - x[i][a];
        for (int c = 0; c < D; c++) F[a * D + c] += d * b[c];
      }
    }
    const auto piola = law_of[type[i]].template operator()<D>(F, stress_of ? stress_of[i] : nullptr);
    if (FLAGS & LEDGER) strain_energy += vol * piola.energy;
    double t[D * D];    // derivative of the energy of i with respect to F_i
    for (int a = 0; a < D * D; a++) t[a] = vol * piola.P[a];

    const double stiffness = zeta * material[type[i]].young;
    if (FLAGS & HOURGLASS) {
      b = values;
      for (int k = 0; k < n; k++, b += NV) {
        const double *const xj = x[partner[k]], *const X = b + D;
        const double kr = stiffness * b[2 * D];
        for (int a = 0; a < D; a++) {
          double r = xj[a] - x[i][a];
          for (int c = 0; c < D; c++) r -= F[a * D + c] * X[c];
          if (FLAGS & LEDGER) strain_energy += 0.5 * kr * r * r;
          for (int c = 0; c < D; c++) t[a * D + c] -= kr * r * X[c];
        }
      }
    }
    if (FLAGS & VIRIAL) {
      const auto component = [&](int a, int c) {
        double s = 0.0;
        for (int k = 0; k < D; k++) s += t[a * D + k] * F[c * D + k];
        return s;
      };
      virial[0] -= component(0, 0);
      virial[1] -= component(1, 1);
      virial[3] -= component(0, 1);
      if (D == 3) {
        virial[2] -= component(D - 1, D - 1);
        virial[4] -= component(0, D - 1);
        virial[5] -= component(1, D - 1);
      }
    }

    double fi[D] = {};
    b = values;
    for (int k = 0; k < n; k++, b += NV) {
      const int j = partner[k];
      double xji[D], fj[D];
      for (int a = 0; a < D; a++) {
        xji[a] = x[j][a] - x[i][a];
        fj[a] = 0.0;
        for (int c = 0; c < D; c++) fj[a] -= t[a * D + c] * b[c];
      }
      double extra[D] = {};    // on j, beyond what acts through F_i
      if (FLAGS & HOURGLASS) {
        const double kr = stiffness * b[2 * D];
        for (int a = 0; a < D; a++) {
          double r = xji[a];
          for (int c = 0; c < D; c++) r -= F[a * D + c] * b[D + c];
          extra[a] -= kr * r;
        }
      }
      if (FLAGS & VISCOSITY) {
        double vdotx = 0.0, rsq = 0.0;
        for (int a = 0; a < D; a++) {
          vdotx += (v[j][a] - v[i][a]) * xji[a];
          rsq += xji[a] * xji[a];
        }
        const State &sj = state[type[j]];
        const double q = 0.5 * b[2 * D + 1] * viscosity(vdotx, rsq, 0.5 * (si.rho0 + sj.rho0), 0.5 * (si.c + sj.c), 1.0);
        for (int a = 0; a < D; a++) extra[a] -= q * xji[a];
        if (FLAGS & LEDGER) hub->tally(FixFSI::ARTIFICIAL, q * vdotx);
      }
      if (FLAGS & VIRIAL) {
        virial[0] += xji[0] * extra[0];
        virial[1] += xji[1] * extra[1];
        virial[3] += xji[0] * extra[1];
        if (D == 3) {
          virial[2] += xji[D - 1] * extra[D - 1];
          virial[4] += xji[0] * extra[D - 1];
          virial[5] += xji[1] * extra[D - 1];
        }
      }
      double *const f = fsolid[j];
      for (int a = 0; a < D; a++) {
        fj[a] += extra[a];
        f[a] += fj[a];
        fi[a] -= fj[a];
      }
    }
    for (int a = 0; a < D; a++) fsolid[i][a] += fi[a];
  }
}

/* ----------------------------------------------------------------------
   particles of different bodies (fsi_contact.h)
------------------------------------------------------------------------- */

template <int D> void PairFSISolidTL::contact_forces()
{
  double **x = atom->x;
  const int *const type = atom->type;
  const tagint *const molecule = atom->molecule;
  const State *const state = hub->state.data();
  const Contact contact(D, hub->dx, contact_range);
  const int nlocal = atom->nlocal;
  const bool newton = force->newton_pair;
  for (int ii = 0; ii < list->inum; ii++) {
    const int i = list->ilist[ii];
    for (int jj = 0; jj < list->numneigh[i]; jj++) {
      const int j = list->firstneigh[i][jj] & NEIGHMASK;
      if (molecule[i] == molecule[j]) continue;
      double xij[D], rsq = 0.0;
      for (int d = 0; d < D; d++) {
        xij[d] = x[i][d] - x[j][d];
        rsq += xij[d] * xij[d];
      }
      const State &si = state[type[i]], &sj = state[type[j]];
      const double f = contact(rsq, si.csq * si.rho0, sj.csq * sj.rho0);
      if (f == 0.0) continue;
      const bool both = newton || j < nlocal;    // without newton the other rank does its own particle
      for (int d = 0; d < D; d++) {
        fsolid[i][d] += f * xij[d];
        if (both) fsolid[j][d] -= f * xij[d];
      }
      if (vflag_global) {
        const double share = both ? 1.0 : 0.5;
        virial[0] += share * f * xij[0] * xij[0];
        virial[1] += share * f * xij[1] * xij[1];
        virial[3] += share * f * xij[0] * xij[1];
        if (D == 3) {
          virial[2] += share * f * xij[D - 1] * xij[D - 1];
          virial[4] += share * f * xij[0] * xij[D - 1];
          virial[5] += share * f * xij[1] * xij[D - 1];
        }
      }
      strain_energy += (both ? 1.0 : 0.5) * contact.energy(rsq, si.csq * si.rho0, sj.csq * sj.rho0);
    }
  }
}

/* ---------------------------------------------------------------------- */

template <int D> void PairFSISolidTL::deformation(int i, double *F) const
{
  double **x = atom->x;
  const double *b = reference->values(i);
  for (int a = 0; a < D * D; a++) F[a] = 0.0;
  for (int k = 0; k < reference->count(i); k++, b += reference->nvalue) {
    const double *const xj = x[reference->partners(i)[k]];
    for (int a = 0; a < D; a++)
      for (int c = 0; c < D; c++) F[a * D + c] += (xj[a] - x[i][a]) * b[c];
  }
}

/* ----------------------------------------------------------------------
   L = F' F^-1 at the time of the velocities, half a step before the positions
------------------------------------------------------------------------- */

void PairFSISolidTL::advance_stress(double dt)
{
  if (law != HYPO) return;
  const Phase phase(hub->profile, Profile::STRESS);
  if (hub->dim == 2) advance_stress_of_all<2>(dt);
  else advance_stress_of_all<3>(dt);
}

template <int D> void PairFSISolidTL::advance_stress_of_all(double dt)
{
  double **x = atom->x;
  double **v = atom->v;
  const double dth = 0.5 * dt;
  for (const int i : reference->solids) {
    const int n = reference->count(i), *const partner = reference->partners(i);
    const double *b = reference->values(i);
    double F[D * D] = {}, Fdot[D * D] = {}, C[D * D], L[D * D] = {};
    for (int k = 0; k < n; k++, b += reference->nvalue) {
      const int j = partner[k];
      for (int a = 0; a < D; a++) {
        const double dv = v[j][a] - v[i][a], dx = x[j][a] - x[i][a] - dth * dv;
        for (int c = 0; c < D; c++) {
          F[a * D + c] += dx * b[c];
          Fdot[a * D + c] += dv * b[c];
        }
      }
    }
    if (n == 0) continue;    // torn off
    cofactor<D>(F, C);
    const double inv = 1.0 / determinant<D>(F);
    for (int a = 0; a < D; a++)
      for (int c = 0; c < D; c++)
        for (int k = 0; k < D; k++) L[a * D + c] += Fdot[a * D + k] * C[c * D + k] * inv;
    const State &s = hub->state[atom->type[i]];
    const double work = hub->fix_stress->advance<D>(i, L, dt, s);
    if (hub->ledger) hub->taken[FixFSI::PLASTIC] += work * atom->rmass[i] / s.rho0;
  }
}

/* ---------------------------------------------------------------------- */

void PairFSISolidTL::break_bonds()
{
  if (damage <= 0.0) return;
  const Phase phase(hub->profile, Profile::STRESS);
  reference->break_bonds(1.0 + damage);
}

double PairFSISolidTL::volume_ratio(int i) const
{
  if (reference->count(i) == 0) return 1.0;
  double F[9];
  if (hub->dim == 2) {
    deformation<2>(i, F);
    return determinant<2>(F);
  }
  deformation<3>(i, F);
  return determinant<3>(F);
}

/* ----------------------------------------------------------------------
   Cauchy stress: P F^T/J
------------------------------------------------------------------------- */

PairFSISolidTL::Stress PairFSISolidTL::stress(int i) const
{
  const auto evaluate = [&](auto dimension) {
    constexpr int D = decltype(dimension)::value;
    static constexpr int voigt[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
    Stress s = {};
    s.J = 1.0;
    if (reference->count(i) == 0) return s;
    double F[D * D];
    deformation<D>(i, F);
    const int t = atom->type[i];
    PiolaStress<D> piola;
    if (law == SVK) piola = svk[t].template operator()<D>(F, nullptr);
    else if (law == NEOHOOKEAN) piola = neohookean[t].template operator()<D>(F, nullptr);
    else piola = hypo[t].template operator()<D>(F, hub->fix_stress->stress[i]);
    s.J = determinant<D>(F);
    for (int a = 0; a < D; a++)
      for (int c = a; c < D; c++) {
        double sum = 0.0;
        for (int k = 0; k < D; k++) sum += piola.P[a * D + k] * F[c * D + k];
        s.sigma[voigt[a][c]] = sum / s.J;
      }
    if (D == 2) s.sigma[2] = piola.zz / s.J;
    return s;
  };
  return hub->dim == 2 ? evaluate(std::integral_constant<int, 2>()) : evaluate(std::integral_constant<int, 3>());
}

double PairFSISolidTL::Stress::von_mises() const
{
  const double *s = sigma;
  const double a = s[0] - s[1], b = s[1] - s[2], c = s[2] - s[0];
  return std::sqrt(0.5 * (a * a + b * b + c * c) + 3.0 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
}

/* ----------------------------------------------------------------------
   ghosts: positions (and velocities) out, forces back; of solids only
------------------------------------------------------------------------- */

void PairFSISolidTL::forward_positions()
{
  exchange(hub->profile, comm, this, false, [this]() { reference->swaps.forward(this); }, reference->swaps.skip_empty());
}

int PairFSISolidTL::pack_forward_comm(int n, int *listed, double *buf, int pbc_flag, int *pbc)
{
  const int dim = hub->dim;
  const bool velocities = comm_forward > dim;
  const double shift[3] = {pbc_flag ? pbc[0] * domain->xprd : 0.0, pbc_flag ? pbc[1] * domain->yprd : 0.0,
                           pbc_flag ? pbc[2] * domain->zprd : 0.0};
  int m = 0;
  for_solids(n, listed, 0, [&](int i) {
    for (int d = 0; d < dim; d++) buf[m++] = atom->x[i][d] + shift[d];
    if (velocities)
      for (int d = 0; d < dim; d++) buf[m++] = atom->v[i][d];
  });
  return m;
}

void PairFSISolidTL::unpack_forward_comm(int n, int first, double *buf)
{
  const int dim = hub->dim;
  const bool velocities = comm_forward > dim;
  for_solids(n, nullptr, first, [&](int i) {
    for (int d = 0; d < dim; d++) atom->x[i][d] = *buf++;
    if (velocities)
      for (int d = 0; d < dim; d++) atom->v[i][d] = *buf++;
  });
}

int PairFSISolidTL::pack_reverse_comm(int n, int first, double *buf)
{
  int m = 0;
  for_solids(n, nullptr, first, [&](int i) {
    for (int d = 0; d < hub->dim; d++) buf[m++] = fsolid[i][d];
  });
  return m;
}

void PairFSISolidTL::unpack_reverse_comm(int n, int *listed, double *buf)
{
  for_solids(n, listed, 0, [&](int i) {
    for (int d = 0; d < hub->dim; d++) fsolid[i][d] += *buf++;
  });
}

/* ---------------------------------------------------------------------- */

std::vector<PairFSI::Effect> PairFSISolidTL::effects() const
{
  static const char *const names[] = {"St. Venant-Kirchhoff", "neo-Hookean", "hypoelastic"};
  auto list = keywords.effects();
  list.insert(list.begin(), {fmt::format("total-Lagrangian solid, {}, gradients exact for {} fields", names[law], linear ? "linear" : "quadratic"),
                             "law", true});
  return list;
}

/* ---------------------------------------------------------------------- */

double PairFSISolidTL::memory_usage()
{
  return (double) nmax * 3 * sizeof(double);
}
