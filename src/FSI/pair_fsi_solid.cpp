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

#include "pair_fsi_solid.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix_fsi.h"
#include "fix_fsi_stress.h"
#include "force.h"
#include "fsi_contact.h"
#include "fsi_gradient.h"
#include "fsi_hourglass.h"
#include "fsi_kernel.h"
#include "fsi_pack.h"
#include "fsi_profile.h"
#include "fsi_stress_artificial.h"
#include "fsi_tensor.h"
#include "fsi_viscosity_artificial.h"
#include "modify.h"
#include "neigh_list.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

using namespace LAMMPS_NS;
using namespace FSI;

/* ---------------------------------------------------------------------- */

PairFSISolid::PairFSISolid(LAMMPS *lmp) :
    PairFSI(lmp, "fsi/solid"), fix_stress(nullptr), fields(lmp), grad(nullptr), any_gradient(false), force_loop(nullptr), gradient_loop(nullptr)
{
  artificial_row("solid");
  keywords.key("artificial/stress").number(epsilon, 0.0, Range::from(0.0)).effect("artificial stress {}");
  keywords.key("hourglass").number(xi, 0.0, Range::from(0.0)).effect("hourglass control of the solid {}");
  contact_row();
  keywords.key("gradient").choice(gradient, PLAIN, {"plain", "corrected", "quadratic"});
}

template <> std::vector<PairFSISolid::Aux<2>> &PairFSISolid::get_aux<2>()
{
  return aux2;
}
template <> std::vector<PairFSISolid::Aux<3>> &PairFSISolid::get_aux<3>()
{
  return aux3;
}

/* ---------------------------------------------------------------------- */

bool PairFSISolid::handles(int a, int b) const
{
  return a == SOLID && b == SOLID;
}

/* ---------------------------------------------------------------------- */

State PairFSISolid::make_state(const Material &m) const
{
  const auto *const stress = FixFSIStress::find(lmp);
  State s = solid_state(m, stress && stress->plane_stress);
  s.form = UPDATED_LAGRANGIAN;
  return s;
}

/* ---------------------------------------------------------------------- */

void PairFSISolid::init_style()
{
  PairFSI::init_style();
  check_contact();
  fix_stress = FixFSIStress::find(lmp);
  if (!fix_stress) error->all(FLERR, "Pair style fsi/solid requires fix fsi/stress: without it a solid has no shear stress");
  comm_forward = has_hourglass() ? fix_fsi->dim * fix_fsi->dim : 0;
  comm_reverse = has_hourglass() ? fix_fsi->dim : 0;
  const bool bodies = several_bodies();
  const int flags = (has_artificial() ? ARTIFICIAL_VISCOSITY : 0) | (epsilon > 0.0 ? ARTIFICIAL_STRESS : 0) |
      (bodies ? BODIES : 0) | (modify->get_compute_by_style("^fsi/energy$").empty() ? 0 : LEDGER);
  with_kernel(fix_fsi->kernel, fix_fsi->dim, fix_fsi->h, [&](const auto &k) {
    using K = std::decay_t<decltype(k)>;
    if (gradient == PLAIN) select<K, 0>(flags);
    else if (gradient == CORRECTED_LINEAR) select<K, K::DIM>(flags);
    else select<AnyKernel<K::DIM>, Gradient<K::DIM>::NQUADRATIC>(flags);
  });
}

template <class K, int TERMS> void PairFSISolid::select(int flags)
{
  with_flags<ARTIFICIAL_VISCOSITY | BODIES | ARTIFICIAL_STRESS | LEDGER>(completed<TERMS>(flags), [this](auto f) {
    if constexpr (completed<TERMS>(f()) == f()) force_loop = &PairFSISolid::force_pairs<K, TERMS, f()>;
  });
  gradient_loop =
      (flags & BODIES) ? &PairFSISolid::gradient_pairs<K, TERMS, BODIES> : &PairFSISolid::gradient_pairs<K, TERMS, 0>;
}

int PairFSISolid::terms() const
{
  const int dim = domain->dimension;
  return gradient == PLAIN ? 0 : gradient == CORRECTED_LINEAR ? dim : dim * (dim + 3) / 2;
}

/* ---------------------------------------------------------------------- */

void *PairFSISolid::extract(const char *name, int &dim_of_extract)
{
  dim_of_extract = 0;
  if (strcmp(name, "gradient") == 0) return &gradient;    // 0: plain
  if (strcmp(name, "hourglass") == 0) return &xi;
  return PairFSI::extract(name, dim_of_extract);
}

/* ---------------------------------------------------------------------- */

int PairFSISolid::ngrad() const
{
  const int dim = fix_fsi->dim, n = terms();
  return n == 0 ? dim * dim : dim * n + 2 * packed_size(n);
}

void PairFSISolid::set_fields(Scene &)
{
  fields.set("velocity gradient", Fields::STEP, true, grad, ngrad());
}

void PairFSISolid::add_messages(Message &to_ghosts, Message &back)
{
  const int dim = fix_fsi->dim;
  to_ghosts.add(fix_stress->stress, 0, dim == 2 ? 3 : 6, {SOLID});
  to_ghosts.add(grad, dim * dim, dim * terms(), {SOLID});
  back.add(grad, 0, ngrad(), {SOLID});
}

void PairFSISolid::add_costs(Costs &costs) const
{
  const int dim = fix_fsi->dim, newton = force->newton_pair, hourglass = has_hourglass();
  costs.bytes += 8 * ngrad();
  costs.arrays += ", velocity gradient";
  costs.sums = true;
  costs.forward += hourglass;
  costs.back += newton * hourglass;
  costs.solid_ghost += (dim == 2 ? 3 : 6) + dim * terms() + newton * ngrad() + hourglass * (dim * dim + newton * dim);
}

void PairFSISolid::find_idle(const Census &all, const Idle &nothing) const
{
  if (all.solids == 0) nothing("Pair style fsi/solid" + named_effects(), "no particle is a solid");
}

/* ---------------------------------------------------------------------- */

bool PairFSISolid::add_rates(bool advance)
{
  fields.grow();
  any_gradient = advance || terms();
  if (!any_gradient) return false;
  const Phase phase(fix_fsi->profile, Profile::STRESS);
  const size_t nall = atom->nlocal + atom->nghost;
  if (nall) std::fill_n(grad[0], nall * ngrad(), 0.0);
  velocity_gradient(advance ? update->dt : 0.0);
  return true;
}

void PairFSISolid::advance(bool advance)
{
  if (!any_gradient) return;
  const Phase phase(fix_fsi->profile, Profile::STRESS);
  const int dim = fix_fsi->dim;
  if (terms() == 0) dim == 2 ? advance_stress<2, 0>(advance) : advance_stress<3, 0>(advance);
  else if (terms() == dim) dim == 2 ? advance_stress<2, 2>(advance) : advance_stress<3, 3>(advance);
  else dim == 2 ? advance_stress<2, 5>(advance) : advance_stress<3, 9>(advance);
  if (advance && has_hourglass()) advance_hourglass(update->dt);
}

/* ----------------------------------------------------------------------
   velocity gradient L from its sums; stress and, in continuity mode, density from L
------------------------------------------------------------------------- */

template <int D, int TERMS> void PairFSISolid::advance_stress(bool advance)
{
  double *rho = atom->rho;
  const int *const type = atom->type;
  const double dt = update->dt + fix_fsi->dt_offset;
  for (int i = 0; i < atom->nlocal; i++) {
    const State &s = fix_fsi->state[type[i]];
    if (s.species != SOLID) continue;
    double *L = grad[i];
    if constexpr (TERMS > 0) {
      // L = [sum_j w_ij (v_j - v_i)(x)phi_j] C^T
      double C[D * TERMS], force_C[D * TERMS], full[D * D] = {};
      const double *const moments = L + D * TERMS;
      // hardly any neighbours: torn off, no strain, no stress to share
      if (gradient_coefficients<D, TERMS>(moments, C) == Gradient<D>::DEFICIENT) std::fill_n(C, D * TERMS, 0.0);
      if (gradient_coefficients<D, TERMS>(moments + packed_size(TERMS), force_C) == Gradient<D>::DEFICIENT)
        std::fill_n(force_C, D * TERMS, 0.0);
      for (int a = 0; a < D; a++)
        for (int b = 0; b < D; b++)
          for (int k = 0; k < TERMS; k++) full[a * D + b] += L[a * TERMS + k] * C[b * TERMS + k];
      const double inv = 1.0 / fix_fsi->h;
      for (int k = 0; k < D * D; k++) L[k] = full[k] * inv;
      for (int k = 0; k < D * TERMS; k++) L[D * D + k] = force_C[k] * inv;
    }
    if (!advance) continue;
    const double work = fix_stress->advance_stress<D>(i, L, dt, s);
    if (fix_fsi->density_solid == FixFSI::CONTINUITY) {
      double div = 0.0;
      for (int a = 0; a < D; a++) div += L[a * D + a];
      // d rho/dt = -rho div v, centred: second order, and positive for any step
      rho[i] *= (1.0 - 0.5 * dt * div) / (1.0 + 0.5 * dt * div);
    }
    if (fix_fsi->ledger) {
      // what the strain stores; what the pair forces deliver, with the same stress and velocity, is taken off in
      // force_pairs(): their difference is what the gradient's correction costs
      auto sigma = Sym<D>::load(fix_stress->stress[i]);
      sigma += Sym<D>::identity(-s.pressure(rho[i]));
      double power = 0.0;
      for (int a = 0; a < D; a++)
        for (int b = 0; b < D; b++) power += sigma(a, b) * L[a * D + b];
      fix_fsi->tally(FixFSI::GRADIENT, -power * atom->rmass[i] / rho[i]);
      fix_fsi->energy_out[FixFSI::PLASTIC] += work * atom->rmass[i] / rho[i];
    }
  }
}

/* ---------------------------------------------------------------------- */

void PairFSISolid::go_back()
{
  if (fix_fsi->density_solid != FixFSI::CONTINUITY) return;
  const double dt = update->dt + fix_fsi->dt_offset;
  for (int i = 0; i < atom->nlocal; i++) {
    if (fix_fsi->state[atom->type[i]].species != SOLID) continue;
    double div = 0.0;
    for (int k = 0; k < fix_fsi->dim; k++) div += grad[i][k * (fix_fsi->dim + 1)];
    atom->rho[i] *= (1.0 + 0.5 * dt * div) / (1.0 - 0.5 * dt * div);
  }
}

/* ---------------------------------------------------------------------- */

void PairFSISolid::velocity_gradient(double dt)
{
  (this->*gradient_loop)(dt);
}

/* ----------------------------------------------------------------------
   sums of the velocity gradient
   V_j = m_j/rho0: the density at hand is half a step older than positions and velocities, and would make the solid first
   order in time and irreversible; what it would change is its compression, below the error of the plain gradient
------------------------------------------------------------------------- */

// sum_j w phi (x) phi of both particles of a pair, phi as seen from i: from j the linear terms change sign
template <int D, int TERMS>
static inline void add_moments(const double *phi, double wi, double wj, double *gi, double *gj)
{
  for (int a = 0, m = 0; a < TERMS; a++)
    for (int b = 0; b <= a; b++, m++) {
      const double t = phi[a] * phi[b];
      gi[m] += wi * t;
      gj[m] += ((a < D) == (b < D) ? wj : -wj) * t;
    }
}

template <class K, int TERMS, int FLAGS> void PairFSISolid::gradient_pairs(double dt)
{
  constexpr int D = K::DIM;
  const K kernel = make_kernel<K>(fix_fsi->kernel, fix_fsi->h);
  const double dth = 0.5 * dt, hinv = kernel.hinv;
  constexpr int NGRAD = TERMS ? D * TERMS + 2 * packed_size(TERMS) : D * D;
  double **const x = atom->x, **const v = atom->v;
  const double *const rmass = atom->rmass;
  const int *const type = atom->type;
  const State *const state = fix_fsi->state.data();
  const tagint *const molecule = atom->molecule;
  double **grad = this->grad;

  for (int ii = 0; ii < list->inum; ii++) {
    const int i = list->ilist[ii];
    const double vol_i = rmass[i] * state[type[i]].inv_rho0;
    const int *const jlist = list->firstneigh[i], jnum = list->numneigh[i];
    // of i in variables of their own: stores to neighbours might change what is in memory, and it would be read for each anew
    double x_i[D], v_i[D], gi[NGRAD];
    std::copy_n(x[i], D, x_i);
    std::copy_n(v[i], D, v_i);
    std::copy_n(grad[i], NGRAD, gi);
    for (int jj = 0; jj < jnum; jj++) {
      const int j = jlist[jj] & NEIGHMASK;
      if ((FLAGS & BODIES) && molecule[i] != molecule[j]) continue;
      double xij[D], vij[D], rsq = 0.0;
      for (int d = 0; d < D; d++) {
        vij[d] = v_i[d] - v[j][d];
        xij[d] = x_i[d] - x[j][d] - dth * vij[d];
        rsq += xij[d] * xij[d];
      }
      double *const gj = grad[j];
      const double vol_j = rmass[j] * state[type[j]].inv_rho0;
      if constexpr (TERMS > 0) {
        double xji[D], phi[TERMS], mid = 0.0;
        for (int d = 0; d < D; d++) {
          xji[d] = (x[j][d] - x_i[d]) * hinv;
          mid += xji[d] * xji[d];
        }
        mid *= kernel.h * kernel.h;
        if (mid < kernel.cutsq) {
          const double g = kernel.gradient(std::sqrt(mid));
          gradient_basis<D, TERMS>(xji, phi);
          add_moments<D, TERMS>(phi, -g * vol_j, -g * vol_i, gi + D * TERMS + packed_size(TERMS),
                                gj + D * TERMS + packed_size(TERMS));
        }
      }
      if (rsq >= kernel.cutsq) continue;
      const double g = kernel.gradient(std::sqrt(rsq));
      if constexpr (TERMS == 0) {
        // v_ji (x) g_ij is the same seen from i and from j; only the volumes differ
        for (int a = 0; a < D; a++)
          for (int b = 0; b < D; b++) {
            const double t = -g * vij[a] * xij[b];
            gi[a * D + b] += vol_j * t;
            gj[a * D + b] += vol_i * t;
          }
      } else {
        const double wi = -g * vol_j, wj = -g * vol_i;
        double xji[D], phi[TERMS];
        for (int d = 0; d < D; d++) xji[d] = -xij[d] * hinv;
        gradient_basis<D, TERMS>(xji, phi);
        for (int a = 0; a < D; a++)
          for (int k = 0; k < TERMS; k++) {
            const double t = -vij[a] * phi[k];
            gi[a * TERMS + k] += wi * t;
            gj[a * TERMS + k] += (k < D ? wj : -wj) * t;
          }
        add_moments<D, TERMS>(phi, wi, wj, gi + D * TERMS, gj + D * TERMS);
      }
    }
    std::copy_n(gi, NGRAD, grad[i]);
  }
}

/* ----------------------------------------------------------------------
   hourglass control (fsi_hourglass.h)
------------------------------------------------------------------------- */

void PairFSISolid::advance_hourglass(double dt)
{
  const int dim = fix_fsi->dim;
  forward_comm(fix_fsi->profile, comm, this);
  hourglass_rate.assign((size_t) (atom->nlocal + atom->nghost) * dim, 0.0);
  with_kernel(fix_fsi->kernel, dim, fix_fsi->h, [&](const auto &k) { hourglass_pairs<std::decay_t<decltype(k)>>(dt); });
  if (force->newton_pair) reverse_comm(fix_fsi->profile, comm, this);
  if (dim == 2) rotate_hourglass<2>(dt);
  else rotate_hourglass<3>(dt);
}

template <class K> void PairFSISolid::hourglass_pairs(double dt)
{
  constexpr int D = K::DIM;
  const K kernel(fix_fsi->h);
  const Hourglass hourglass{xi};
  double **const x = atom->x, **const v = atom->v, **const grad = this->grad;
  double *const total = hourglass_rate.data();
  const double *const rmass = atom->rmass;
  const int *const type = atom->type;
  const tagint *const molecule = atom->molecule;
  const State *const state = fix_fsi->state.data();
  for (int ii = 0; ii < list->inum; ii++) {
    const int i = list->ilist[ii];
    const State &si = state[type[i]];
    const double shear = si.shear, vol = rmass[i] * si.inv_rho0;
    const int *const jlist = list->firstneigh[i], jnum = list->numneigh[i];
    double x_i[D], v_i[D], Li[D * D], sum[D];
    std::copy_n(x[i], D, x_i);
    std::copy_n(v[i], D, v_i);
    std::copy_n(grad[i], D * D, Li);
    std::copy_n(total + i * D, D, sum);
    for (int jj = 0; jj < jnum; jj++) {
      const int j = jlist[jj] & NEIGHMASK;
      if (molecule[i] != molecule[j]) continue;
      double xij[D], vij[D], rsq = 0.0, rate[D];
      for (int d = 0; d < D; d++) {
        vij[d] = v_i[d] - v[j][d];
        xij[d] = x_i[d] - x[j][d] - 0.5 * dt * vij[d];
        rsq += xij[d] * xij[d];
      }
      if (rsq >= kernel.cutsq) continue;
      const State &sj = state[type[j]];
      hourglass.operator()<D>(0.5 * (shear + sj.shear), vol * rmass[j] * sj.inv_rho0,
                              kernel.gradient(std::sqrt(rsq)), xij, vij, Li, grad[j], rate);
      for (int d = 0; d < D; d++) {
        sum[d] += rate[d];
        total[j * D + d] -= rate[d];
      }
    }
    std::copy_n(sum, D, total + i * D);
  }
}

template <int D> void PairFSISolid::rotate_hourglass(double dt)
{
  for (int i = 0; i < atom->nlocal; i++) {
    if (material[atom->type[i]].species != SOLID) continue;
    double Q[D * D], Qh[D * D], turned[D] = {};
    double *const q = fix_stress->hourglass_force(i), *const rate = &hourglass_rate[i * D];
    rotation<D>(grad[i], dt, Q);
    rotation<D>(grad[i], 0.5 * dt, Qh);
    for (int a = 0; a < D; a++)
      for (int b = 0; b < D; b++) turned[a] += Q[a * D + b] * q[b] + dt * Qh[a * D + b] * rate[b];
    for (int a = 0; a < D; a++) q[a] = turned[a];
  }
}

int PairFSISolid::pack_forward_comm(int n, int *listed, double *buf, int, int *)
{
  double *const first = buf;
  for_solids(n, listed, 0, [&](int i) { buf = std::copy_n(grad[i], comm_forward, buf); });
  return buf - first;
}

void PairFSISolid::unpack_forward_comm(int n, int first, double *buf)
{
  for_solids(n, nullptr, first, [&](int i) {
    std::copy_n(buf, comm_forward, grad[i]);
    buf += comm_forward;
  });
}

int PairFSISolid::pack_reverse_comm(int n, int first, double *buf)
{
  int m = 0;
  for_solids(n, nullptr, first, [&](int i) {
    for (int k = 0; k < comm_reverse; k++) buf[m++] = hourglass_rate[i * comm_reverse + k];
  });
  return m;
}

void PairFSISolid::unpack_reverse_comm(int n, int *listed, double *buf)
{
  for_solids(n, listed, 0, [&](int i) {
    for (int k = 0; k < comm_reverse; k++) hourglass_rate[i * comm_reverse + k] += *buf++;
  });
}

/* ---------------------------------------------------------------------- */

void PairFSISolid::add_number_density(double *psi, bool all_bodies)
{
  double **x = atom->x;
  const tagint *const molecule = atom->molecule;
  with_kernel(fix_fsi->kernel, fix_fsi->dim, fix_fsi->h, [&](const auto &kernel) {
    for (int ii = 0; ii < list->inum; ii++) {
      const int i = list->ilist[ii];
      for (int jj = 0; jj < list->numneigh[i]; jj++) {
        const int j = list->firstneigh[i][jj] & NEIGHMASK;
        if (!all_bodies && molecule[i] != molecule[j]) continue;
        double rsq = 0.0;
        for (int d = 0; d < 3; d++) rsq += (x[i][d] - x[j][d]) * (x[i][d] - x[j][d]);
        if (rsq >= kernel.cutsq) continue;
        const double w = kernel.W(std::sqrt(rsq));
        psi[i] += w;
        psi[j] += w;
      }
    }
  });
}

/* ---------------------------------------------------------------------- */

void PairFSISolid::compute(int eflag, int vflag)
{
  const Phase phase(fix_fsi->profile, Profile::SOLID_FORCES);
  ev_init(eflag, vflag);
  check_tally();
  (this->*force_loop)();
  if (has_hourglass()) {
    double **f = atom->f;
    for (int i = 0; i < atom->nlocal; i++) {
      if (material[atom->type[i]].species != SOLID) continue;
      const double *q = fix_stress->hourglass_force(i);
      for (int d = 0; d < fix_fsi->dim; d++) f[i][d] += q[d];
    }
  }
  if (vflag_fdotr) virial_fdotr_compute();
}

/* ----------------------------------------------------------------------
   what the pairs of an atom share; local and ghost
------------------------------------------------------------------------- */

template <int D, int TERMS> const std::vector<PairFSISolid::Aux<D>> &PairFSISolid::fill_aux()
{
  const State *const state = fix_fsi->state.data();
  const int *const type = atom->type;
  const double *const rho = atom->rho, *const rmass = atom->rmass;
  double **S = fix_stress->stress;
  const int nall = atom->nlocal + atom->nghost;
  const ArtificialStress artificial(epsilon, fix_fsi->wdx);

  auto &aux = get_aux<D>();
  if ((int) aux.size() < nall) aux.resize(atom->nmax);
  for (int i = 0; i < nall; i++) {
    const State &s = state[type[i]];
    if (s.species != SOLID) continue;
    Aux<D> &a = aux[i];
    a.rho = rho[i];
    a.c = s.c;
    a.vol = rmass[i] / rho[i];
    const double v2 = a.vol * a.vol;
    auto stress = Sym<D>::load(S[i]);
    stress *= v2;
    stress += Sym<D>::identity(-fix_fsi->pressure(i) * v2);
    a.stress = stress;
    a.artificial = epsilon > 0.0 ? artificial(stress) : Sym<D>();
    if constexpr (TERMS > 0) {
      a.C = grad[i] + D * D;
      a.vol0 = rmass[i] * s.inv_rho0;
      stress *= 1.0 / a.vol;
      a.vstress = stress;
    }
  }
  return aux;
}

/* ---------------------------------------------------------------------- */

template <int D> static double contract(const Sym<D> &s, const double *x_ij, const double *vi, const double *vj)
{
  double sx[D], sum = 0.0;
  dot<D>(s, x_ij, sx);
  for (int d = 0; d < D; d++) sum += sx[d] * (vi[d] - vj[d]);
  return sum;
}

/* ----------------------------------------------------------------------
   takes w_i V_i sigma_i G_i - w_j V_j sigma_j G_j from t, with the corrected gradients G of i and of j (fsi_gradient.h) over -g
------------------------------------------------------------------------- */

template <int D, int TERMS, class Aux>
static FSI_INLINE void subtract_corrected(const Aux &ai, const Aux &aj, double wi, double wj, const double *x_ij, double hinv, double *t)
{
  double xji[D], phi[TERMS], Gi[D] = {}, Gj[D] = {}, si[D], sj[D];
  for (int d = 0; d < D; d++) xji[d] = -x_ij[d] * hinv;
  gradient_basis<D, TERMS>(xji, phi);
  for (int a = 0; a < D; a++)
    for (int k = 0; k < TERMS; k++) {
      Gi[a] += ai.C[a * TERMS + k] * phi[k];
      Gj[a] += aj.C[a * TERMS + k] * (k < D ? -phi[k] : phi[k]);
    }
  dot<D>(ai.vstress, Gi, si);
  dot<D>(aj.vstress, Gj, sj);
  for (int d = 0; d < D; d++) t[d] -= wi * si[d] - wj * sj[d];
}

/* ----------------------------------------------------------------------
   with the weights G_ij = -V_j g C phi of the gradient (gradient corrected, quadratic): F_ij = V_i sigma_i G_ij - V_j sigma_j G_ji
   instead of the first two terms below. What deforms the solid is what resists: energy and angular momentum are kept
   gradient plain: F_ij = [sigma_i V_i^2 + sigma_j V_j^2 + (R_i + R_j) (W_ij/W(dx))^4 - Q_ij I] . grad_i W_ij (paper eq. 14), sigma = -p I + S
   between bodies only contact (fsi_contact.h) and Q: bodies do not stick, nor share their stress
------------------------------------------------------------------------- */

template <class K, int TERMS, int FLAGS> void PairFSISolid::force_pairs()
{
  constexpr int D = K::DIM;
  const K kernel = make_kernel<K>(fix_fsi->kernel, fix_fsi->h);
  double **const x = atom->x, **const v = atom->v, **const f = atom->f;
  const int *const type = atom->type;
  const tagint *const molecule = atom->molecule;
  const int nlocal = atom->nlocal;
  const bool newton = force->newton_pair;
  const bool tally_pairs = evflag && !vflag_fdotr;    // newton off
  const State *const state = fix_fsi->state.data();
  const ArtificialViscosity viscosity(alpha, beta, fix_fsi->h);
  const ArtificialStress artificial(epsilon, fix_fsi->wdx);
  const Contact contact(D, fix_fsi->dx, contact_range);

  const auto &aux = fill_aux<D, TERMS>();

  double by_gradient = 0.0, by_stress = 0.0, by_viscosity = 0.0;    // powers
  const auto share = [&](int j) { return (newton || j < nlocal) ? 1.0 : 0.5; };    // without newton a pair across ranks is computed on both

  for (int ii = 0; ii < list->inum; ii++) {
    const int i = list->ilist[ii];
    const Aux<D> ai = aux[i];
    const int *const jlist = list->firstneigh[i], jnum = list->numneigh[i];
    double fi[D] = {}, x_i[D], v_i[D];
    std::copy_n(x[i], D, x_i);
    std::copy_n(v[i], D, v_i);
    for (int jj = 0; jj < jnum; jj++) {
      const int j = jlist[jj] & NEIGHMASK;
      double xij[D], rsq = 0.0;
      for (int d = 0; d < D; d++) {
        xij[d] = x_i[d] - x[j][d];
        rsq += xij[d] * xij[d];
      }
      if (rsq >= kernel.cutsq) continue;
      const double r = std::sqrt(rsq), g = kernel.gradient(r);
      const Aux<D> &aj = aux[j];
      Sym<D> t;
      double push = 0.0;    // of contact, along x_ij: it does not go with the kernel's gradient, which may vanish here
      if ((FLAGS & BODIES) && molecule[i] != molecule[j]) {
        const State &si = state[type[i]], &sj = state[type[j]];
        push = contact(rsq, si.csq * si.rho0, sj.csq * sj.rho0);
      } else {
        if constexpr (TERMS == 0) {
          t = ai.stress;
          t += aj.stress;
        }
        if (FLAGS & ARTIFICIAL_STRESS) {
          Sym<D> R = ai.artificial;
          R += aj.artificial;
          R *= artificial.weight(kernel.W(r));
          t += R;
          if (FLAGS & LEDGER) {
            const double power = contract<D>(R, xij, v_i, v[j]);
            by_stress -= share(j) * g * power;
            by_gradient += share(j) * g * power;
          }
        }
      }
      double tx[D];
      dot<D>(t, xij, tx);
      if constexpr (TERMS > 0)
        if (!(FLAGS & BODIES) || molecule[i] == molecule[j])
          subtract_corrected<D, TERMS>(ai, aj, aj.vol0, ai.vol0, xij, kernel.hinv, tx);
      if (FLAGS & LEDGER) {
        double power = 0.0;
        for (int d = 0; d < D; d++) power += (g * tx[d] + push * xij[d]) * (v_i[d] - v[j][d]);
        by_gradient -= share(j) * power;
      }
      if (FLAGS & ARTIFICIAL_VISCOSITY) {
        double vdotx = 0.0;
        for (int d = 0; d < D; d++) vdotx += (v_i[d] - v[j][d]) * xij[d];
        const double q = viscosity(vdotx, rsq, 0.5 * (ai.rho + aj.rho), 0.5 * (ai.c + aj.c), ai.vol * aj.vol);
        for (int d = 0; d < D; d++) tx[d] -= q * xij[d];
        if (FLAGS & LEDGER) by_viscosity += share(j) * q * g * vdotx;
      }
      for (int d = 0; d < D; d++) {
        tx[d] *= g;
        if (FLAGS & BODIES) tx[d] += push * xij[d];
        fi[d] += tx[d];
      }
      if (newton || j < nlocal)
        for (int d = 0; d < D; d++) f[j][d] -= tx[d];
      if (tally_pairs)
        ev_tally_xyz(i, j, nlocal, newton, 0.0, 0.0, tx[0], tx[1], D == 3 ? tx[D - 1] : 0.0, xij[0], xij[1], D == 3 ? xij[D - 1] : 0.0);
    }
    for (int d = 0; d < D; d++) f[i][d] += fi[d];
  }
  fix_fsi->tally(FixFSI::STRESS, by_stress);
  fix_fsi->tally(FixFSI::GRADIENT, by_gradient);
  fix_fsi->tally(FixFSI::ARTIFICIAL, by_viscosity);
}

/* ---------------------------------------------------------------------- */

std::vector<PairFSI::Effect> PairFSISolid::effects() const
{
  static const char *const orders[] = {"plain", "exact for linear fields", "exact for quadratic fields"};
  auto list = keywords.effects();
  list.insert(list.begin(), {fmt::format("updated-Lagrangian solid, gradients {}", orders[gradient]), "gradient", true});
  return list;
}

/* ---------------------------------------------------------------------- */

double PairFSISolid::memory_usage()
{
  return fields.memory_usage() + (double) aux2.capacity() * sizeof(Aux<2>) + (double) aux3.capacity() * sizeof(Aux<3>);
}
