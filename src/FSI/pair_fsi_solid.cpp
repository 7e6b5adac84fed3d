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
#include "error.h"
#include "fix_fsi.h"
#include "fix_fsi_stress.h"
#include "force.h"
#include "fsi_contact.h"
#include "fsi_kernel.h"
#include "fsi_stress_artificial.h"
#include "fsi_tensor.h"
#include "fsi_viscosity_artificial.h"
#include "modify.h"
#include "neigh_list.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

using namespace LAMMPS_NS;
using namespace FSI;

/* ---------------------------------------------------------------------- */

PairFSISolid::PairFSISolid(LAMMPS *lmp) :
    PairFSI(lmp, "fsi/solid"), corrected(0), alpha(0.0), beta(0.0), epsilon(0.0), force_loop(nullptr), gradient_loop(nullptr)
{
}

template <> std::vector<PairFSISolid::Aux<2>> &PairFSISolid::get_aux<2>()
{
  return aux2;
}
template <> std::vector<PairFSISolid::Aux<3>> &PairFSISolid::get_aux<3>()
{
  return aux3;
}

/* ----------------------------------------------------------------------
   pair_style fsi/solid keyword value ...
------------------------------------------------------------------------- */

void PairFSISolid::settings(int narg, char **arg)
{
  int iarg = 0;
  while (iarg < narg) {
    if (strcmp(arg[iarg], "artificial/visc") == 0) {
      need(narg, arg, iarg, 2);
      alpha = number(arg[iarg + 1], "artificial/visc alpha");
      beta = number(arg[iarg + 2], "artificial/visc beta");
      iarg += 3;
    } else if (strcmp(arg[iarg], "artificial/stress") == 0) {
      need(narg, arg, iarg, 1);
      epsilon = number(arg[iarg + 1], "artificial/stress");
      iarg += 2;
    } else if (strcmp(arg[iarg], "gradient") == 0) {
      need(narg, arg, iarg, 1);
      if (strcmp(arg[iarg + 1], "plain") == 0) corrected = 0;
      else if (strcmp(arg[iarg + 1], "corrected") == 0) corrected = 1;
      else error->all(FLERR, "Unknown pair_style fsi/solid gradient {}: expected plain or corrected", arg[iarg + 1]);
      iarg += 2;
    } else
      error->all(FLERR, "Unknown pair_style fsi/solid keyword {}: expected artificial/visc, artificial/stress or gradient",
                 arg[iarg]);
  }
}

/* ---------------------------------------------------------------------- */

bool PairFSISolid::handles(int a, int b) const
{
  return a == SOLID && b == SOLID;
}

/* ---------------------------------------------------------------------- */

State PairFSISolid::make_state(const Material &m) const
{
  bool plane_stress = false;
  for (auto &fix : modify->get_fix_by_style("^fsi/stress$"))
    plane_stress = dynamic_cast<FixFSIStress *>(fix)->plane_stress;
  return solid_state(m, plane_stress);
}

/* ---------------------------------------------------------------------- */

void PairFSISolid::init_style()
{
  PairFSI::init_style();
  const bool bodies = several_bodies();
  const int flags = (alpha > 0.0 || beta > 0.0 ? ARTIFICIAL_VISCOSITY : 0) | (epsilon > 0.0 ? ARTIFICIAL_STRESS : 0) |
      (bodies ? BODIES : 0) | (modify->get_compute_by_style("^fsi/energy$").empty() ? 0 : LEDGER);
  with_kernel(hub->kernel, hub->dim, hub->h, [&](const auto &k) {
    using K = std::decay_t<decltype(k)>;
    pick_force<K>(flags, std::make_integer_sequence<int, NFORCE>());
    gradient_loop = bodies ? &PairFSISolid::gradient_pairs<K, BODIES> : &PairFSISolid::gradient_pairs<K, 0>;
  });
}

template <class K, int... F> void PairFSISolid::pick_force(int flags, std::integer_sequence<int, F...>)
{
  using Loop = void (PairFSISolid::*)();
  static constexpr Loop table[] = {&PairFSISolid::force_pairs<K, F>...};
  force_loop = table[flags];
}

/* ---------------------------------------------------------------------- */

void PairFSISolid::velocity_gradient(double dt)
{
  (this->*gradient_loop)(dt);
}

/* ----------------------------------------------------------------------
   L_i = [sum_j V_j (v_j - v_i)(x)grad_i W_ij] [sum_j V_j x_ji(x)grad_i W_ij]^-1, the second factor if corrected
   V_j = m_j/rho0: the density at hand is half a step older than positions and velocities, and would make the solid first
   order in time and irreversible; what it would change is its compression, below the error of the plain gradient
------------------------------------------------------------------------- */

template <class K, int FLAGS> void PairFSISolid::gradient_pairs(double dt)
{
  constexpr int D = K::DIM;
  const K kernel(hub->h);
  const double dth = 0.5 * dt;
  double **x = atom->x;
  double **v = atom->v;
  const double *const rmass = atom->rmass;
  const int *const type = atom->type;
  const State *const state = hub->state.data();
  const tagint *const molecule = atom->molecule;
  double **grad = hub->grad;

  for (int ii = 0; ii < list->inum; ii++) {
    const int i = list->ilist[ii];
    const double vol_i = rmass[i] / state[type[i]].rho0;
    for (int jj = 0; jj < list->numneigh[i]; jj++) {
      const int j = list->firstneigh[i][jj] & NEIGHMASK;
      if ((FLAGS & BODIES) && molecule[i] != molecule[j]) continue;
      double xij[D], vij[D], rsq = 0.0;
      for (int d = 0; d < D; d++) {
        vij[d] = v[i][d] - v[j][d];
        xij[d] = x[i][d] - x[j][d] - dth * vij[d];
        rsq += xij[d] * xij[d];
      }
      if (rsq >= kernel.cutsq) continue;
      const double g = kernel.gradient(std::sqrt(rsq)), vol_j = rmass[j] / state[type[j]].rho0;
      // v_ji (x) g_ij is the same seen from i and from j; only the volumes differ
      double *gi = grad[i], *gj = grad[j];
      for (int a = 0; a < D; a++)
        for (int b = 0; b < D; b++) {
          const double t = -g * vij[a] * xij[b];
          gi[a * D + b] += vol_j * t;
          gj[a * D + b] += vol_i * t;
        }
      for (int a = 0; a < D; a++)
        for (int b = a; b < D; b++) {
          const double t = -g * xij[a] * xij[b];
          gi[D * D + Sym<D>::id(a, b)] += vol_j * t;
          gj[D * D + Sym<D>::id(a, b)] += vol_i * t;
        }
    }
  }
}

/* ---------------------------------------------------------------------- */

void PairFSISolid::number_density(double *psi, bool all_bodies)
{
  double **x = atom->x;
  const tagint *const molecule = atom->molecule;
  with_kernel(hub->kernel, hub->dim, hub->h, [&](const auto &kernel) {
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
  ev_init(eflag, vflag);
  check_tally();
  (this->*force_loop)();
  if (vflag_fdotr) virial_fdotr_compute();
}

/* ----------------------------------------------------------------------
   F_ij = [sigma_i V_i^2 + sigma_j V_j^2 + (R_i + R_j) (W_ij/W(dx))^4 - Q_ij I] . grad_i W_ij (paper eq. 14), sigma = -p I + S
   between bodies only contact (fsi_contact.h) and Q: bodies do not stick, nor share their stress
------------------------------------------------------------------------- */

template <class K, int FLAGS> void PairFSISolid::force_pairs()
{
  constexpr int D = K::DIM;
  const K kernel(hub->h);
  double **x = atom->x;
  double **v = atom->v;
  double **f = atom->f;
  const double *const rho = atom->rho;
  const double *const rmass = atom->rmass;
  const int *const type = atom->type;
  const tagint *const molecule = atom->molecule;
  const int nlocal = atom->nlocal, nall = nlocal + atom->nghost;
  const bool newton = force->newton_pair;
  const bool tally_pairs = evflag && !vflag_fdotr;    // newton off
  const State *const state = hub->state.data();
  double **S = hub->fix_stress->stress;
  const ArtificialViscosity viscosity(alpha, beta, hub->h);
  const ArtificialStress artificial(epsilon, hub->wdx);
  const Contact contact(D, hub->dx);

  auto &aux = get_aux<D>();
  if ((int) aux.size() < nall) aux.resize(atom->nmax);
  for (int i = 0; i < nall; i++) {
    if (state[type[i]].species != SOLID) continue;
    Aux<D> &a = aux[i];
    a.rho = rho[i];
    a.vol = rmass[i] / rho[i];
    const double v2 = a.vol * a.vol;
    a.pv2 = hub->pressure(i) * v2;
    a.stress = Sym<D>::load(S[i]);
    a.stress *= v2;
    a.stress += Sym<D>::identity(-a.pv2);
    if (FLAGS & ARTIFICIAL_STRESS) a.artificial = artificial(a.stress);
  }

  // energies: without newton a pair across ranks is computed on both
  const auto share = [&](int j) { return (newton || j < nlocal) ? 1.0 : 0.5; };
  const auto contract = [](const Sym<D> &s, const double *x_ij, const double *vi, const double *vj) {
    double sx[D], sum = 0.0;
    dot<D>(s, x_ij, sx);
    for (int d = 0; d < D; d++) sum += sx[d] * (vi[d] - vj[d]);
    return sum;
  };

  for (int ii = 0; ii < list->inum; ii++) {
    const int i = list->ilist[ii];
    const Aux<D> &ai = aux[i];
    double fi[D] = {};
    for (int jj = 0; jj < list->numneigh[i]; jj++) {
      const int j = list->firstneigh[i][jj] & NEIGHMASK;
      double xij[D], vij[D], rsq = 0.0, vdotx = 0.0;
      for (int d = 0; d < D; d++) {
        xij[d] = x[i][d] - x[j][d];
        rsq += xij[d] * xij[d];
      }
      if (rsq >= kernel.cutsq) continue;
      const double r = std::sqrt(rsq), g = kernel.gradient(r);
      const Aux<D> &aj = aux[j];
      Sym<D> t;
      if ((FLAGS & BODIES) && molecule[i] != molecule[j]) {
        const State &si = state[type[i]], &sj = state[type[j]];
        t = Sym<D>::identity(contact(rsq, si.csq * si.rho0, sj.csq * sj.rho0) / g);
      } else {
        t = ai.stress;
        t += aj.stress;
        if (FLAGS & ARTIFICIAL_STRESS) {
          Sym<D> R = ai.artificial;
          R += aj.artificial;
          R *= artificial.weight(kernel.W(r));
          t += R;
          if (FLAGS & LEDGER) {
            const double power = contract(R, xij, v[i], v[j]);
            hub->tally(FixFSI::STRESS, -share(j) * g * power);
            hub->tally(FixFSI::GRADIENT, share(j) * g * power);
          }
        }
      }
      if (FLAGS & LEDGER) hub->tally(FixFSI::GRADIENT, -share(j) * g * contract(t, xij, v[i], v[j]));
      double tx[D];
      dot<D>(t, xij, tx);
      if (FLAGS & ARTIFICIAL_VISCOSITY) {
        for (int d = 0; d < D; d++) {
          vij[d] = v[i][d] - v[j][d];
          vdotx += vij[d] * xij[d];
        }
        const double q = viscosity(vdotx, rsq, 0.5 * (ai.rho + aj.rho), 0.5 * (state[type[i]].c + state[type[j]].c),
                                   ai.vol * aj.vol);
        for (int d = 0; d < D; d++) tx[d] -= q * xij[d];
        if (FLAGS & LEDGER) hub->tally(FixFSI::ARTIFICIAL, share(j) * q * g * vdotx);
      }
      for (int d = 0; d < D; d++) fi[d] += g * tx[d];
      if (newton || j < nlocal)
        for (int d = 0; d < D; d++) f[j][d] -= g * tx[d];
      if (tally_pairs)
        ev_tally_xyz(i, j, nlocal, newton, 0.0, 0.0, g * tx[0], g * tx[1], D == 3 ? g * tx[D - 1] : 0.0, xij[0], xij[1],
                     D == 3 ? xij[D - 1] : 0.0);
    }
    for (int d = 0; d < D; d++) f[i][d] += fi[d];
  }
}

/* ---------------------------------------------------------------------- */

void PairFSISolid::write_restart_settings(FILE *fp)
{
  double d[] = {alpha, beta, epsilon};
  restart_value(fp, d, true);
  restart_value(fp, corrected, true);
}

/* ---------------------------------------------------------------------- */

void PairFSISolid::read_restart_settings(FILE *fp)
{
  double d[3];
  restart_value(fp, d, false);
  restart_value(fp, corrected, false);
  alpha = d[0];
  beta = d[1];
  epsilon = d[2];
}

/* ---------------------------------------------------------------------- */

double PairFSISolid::memory_usage()
{
  return (double) aux2.capacity() * sizeof(Aux<2>) + (double) aux3.capacity() * sizeof(Aux<3>);
}
