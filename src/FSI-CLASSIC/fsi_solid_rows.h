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

// Loops of updated-Lagrangian solids (pair_style fsi/solid) over rows of pairs, as many at a time
// as the number type T holds (fsi_pack.h): sums of the velocity gradient, hourglass control,
// forces.
//
// What a pair needs of a particle lies side by side in a record, filled once per particle. There is
// no branch on the distance: kernels are zero from their support on, and nothing here divides by
// it. Places left over at the end of a row hold i itself, whose distance and velocity from i are
// zero and all sums with them.

#ifndef LMP_FSI_SOLID_ROWS_H
#define LMP_FSI_SOLID_ROWS_H

#include "fsi_classic_laws.h"
#include "fsi_gradient.h"
#include "fsi_kernel.h"
#include "fsi_material.h"
#include "fsi_pair_laws.h"
#include "fsi_rows.h"
#include "fsi_tensor.h"

#include <type_traits>

namespace LAMMPS_NS::FSI {

// Any kernel, by its kind, of which there is one text with all numbers side by side
template <int D> struct PackedKernel {
  static constexpr int DIM = D;
  int kind;
  Cubic<D> cubic;
  Quintic<D> quintic;
  Wendland<D> wendland;
  double hinv;

  PackedKernel(int kind_in, double h) :
      kind(kind_in), cubic(h), quintic(h), wendland(h), hinv(1.0 / h)
  {
  }
  template <class T> FSI_INLINE T W(const T &r) const
  {
    return kind == CUBIC ? cubic.W(r) : kind == QUINTIC ? quintic.W(r) : wendland.W(r);
  }
  template <class T> FSI_INLINE T gradient(const T &r) const
  {
    return kind == CUBIC  ? cubic.gradient(r)
        : kind == QUINTIC ? quintic.gradient(r)
                          : wendland.gradient(r);
  }
};

constexpr int fours(int n)
{
  return (n + 3) / 4 * 4;
}

// Places in a record of the sums of rates: x half a step ago, to which v belongs, v, m/rho0,
// shear modulus.
template <int D> struct RateRecord {
  enum { X = 0, V = D, VOL = 2 * D, SHEAR, N = 8 };
  static_assert(SHEAR < N, "");
};

// In a record of forces. Plain gradients (no TERMS): stress and, for artificial stress, R, times
// V^2. Else the stress times V, m/rho0, and the coefficients of the gradient's weights.
template <int D, int TERMS> struct ForceRecord {
  static constexpr int NS = Sym<D>::N;
  enum {
    X = 0,
    V = D,
    VOL = 2 * D,
    RHO,
    SOUND,
    STRESS,
    VOL0 = STRESS + NS,
    FIT = VOL0 + (TERMS ? 1 : 0),
    ARTIFICIAL = FIT + D * TERMS,
    N = fours(ARTIFICIAL + NS)
  };
};

// Doubles of a particle's velocity gradient: its sums, afterwards L and the coefficients of the
// weights (pair_fsi_solid.h)
template <int D, int TERMS> struct GradientSums {
  static constexpr int N = TERMS ? D * TERMS + 2 * packed_size(TERMS) : D * D, ROW = fours(N);
};

// The first COUNT numbers of record j, of N; of several side by side.
template <int N, int COUNT, class T>
FSI_INLINE void read_records(const double *records, const int *j, T (&a)[COUNT])
{
  static_assert(N % 4 == 0 && COUNT % 4 == 0, "records are fours of numbers");
  if constexpr (std::is_same_v<T, double>) {
    for (int k = 0; k < COUNT; k++) a[k] = records[(size_t) N * j[0] + k];
  } else {
    const double *const p = records + (size_t) N * j[0], *const q = records + (size_t) N * j[1],
                        *const r = records + (size_t) N * j[2],
                        *const s = records + (size_t) N * j[3];
    for (int k = 0; k < COUNT; k += 4) T::columns(p + k, q + k, r + k, s + k, a + k);
  }
}
// those of i, the same in all places
template <int N, int COUNT, class T>
FSI_INLINE void read_own(const double *records, int i, T (&a)[COUNT])
{
  for (int k = 0; k < COUNT; k++) a[k] = records[(size_t) N * i + k];
}

// sum_j w phi (x) phi of both particles of a pair, phi as seen from i: from j the linear terms
// change sign
template <int D, int TERMS, class T>
FSI_INLINE void add_moments(const T *phi, const T &wi, const T &wj, T *of_i, T *of_j)
{
  for (int a = 0, m = 0; a < TERMS; a++)
    for (int b = 0; b <= a; b++, m++) {
      const T t = phi[a] * phi[b];
      of_i[m] += wi * t;
      of_j[m] = ((a < D) == (b < D)) ? wj * t : -wj * t;
    }
}

// Adds the sums of the velocity gradient to rows of both particles, V_j = m_j/rho0: the density
// at hand is half a step older than positions and velocities, and would make the solid first
// order in time and irreversible; what it would change is its compression, below the error of the
// plain gradient. half: half of the step that positions went since.
template <class T, class K, int TERMS>
FSI_INLINE void gradient_rows(const Row *const rows, const int nrows, const K kernel,
                              const double *const records, const double half,
                              double (*const grad)[GradientSums<K::DIM, TERMS>::ROW])
{
  constexpr int D = K::DIM, N = GradientSums<D, TERMS>::N, NR = RateRecord<D>::N;
  using At = RateRecord<D>;
  for (int n = 0; n < nrows; n++) {
    const Row row = rows[n];
    T own[NR], of_i[N];
    read_own<NR>(records, row.i, own);
    for (T &s : of_i) s = 0.0;
    for_neighbors<T, false>(row, [&](const int *j, const T &) FSI_INLINE_LAMBDA {
      T other[NR], x[D], v[D], of_j[N], rsq = 0.0;
      read_records<NR>(records, j, other);
      for (int d = 0; d < D; d++) {
        x[d] = own[At::X + d] - other[At::X + d];
        v[d] = own[At::V + d] - other[At::V + d];
        rsq += x[d] * x[d];
      }
      const T g = kernel.gradient(root(rsq)), wi = -g * other[At::VOL], wj = -g * own[At::VOL];
      if constexpr (TERMS == 0) {
        // v_ji (x) g_ij is the same seen from i and from j; only the volumes differ
        for (int a = 0; a < D; a++)
          for (int b = 0; b < D; b++) {
            const T t = v[a] * x[b];
            of_i[a * D + b] += wi * t;
            of_j[a * D + b] = wj * t;
          }
      } else {
        T phi[TERMS], seen[D], nowsq = 0.0;
        for (int d = 0; d < D; d++) seen[d] = -kernel.hinv * x[d];
        gradient_basis<D, TERMS>(seen, phi);
        for (int a = 0; a < D; a++)
          for (int k = 0; k < TERMS; k++) {
            const T t = -v[a] * phi[k];
            of_i[a * TERMS + k] += wi * t;
            of_j[a * TERMS + k] = k < D ? wj * t : -wj * t;
          }
        add_moments<D, TERMS>(phi, wi, wj, of_i + D * TERMS, of_j + D * TERMS);
        // moments at the positions of now
        for (int d = 0; d < D; d++) {
          const T now = x[d] + half * v[d];
          seen[d] = -kernel.hinv * now;
          nowsq += now * now;
        }
        const T now = kernel.gradient(root(nowsq));
        gradient_basis<D, TERMS>(seen, phi);
        constexpr int FORCES = D * TERMS + packed_size(TERMS);
        add_moments<D, TERMS>(phi, -now * other[At::VOL], -now * own[At::VOL], of_i + FORCES,
                              of_j + FORCES);
      }
      Lanes<T>::add_rows(of_j, grad, j);
    });
    for (int k = 0; k < N; k++) grad[row.i][k] += Lanes<T>::sum(of_i[k]);
  }
}

// Adds the rate of the forces of hourglass control (fsi_classic_laws.h); gradients: rows of ROW,
// with L in front
template <class T, class K, int ROW>
FSI_INLINE void hourglass_rows(const Row *const rows, const int nrows, const K kernel,
                               const double *const records, const double *const gradients,
                               const Hourglass hourglass,
                               double (*const rate)[row_of_forces(K::DIM)])
{
  constexpr int D = K::DIM, NR = RateRecord<D>::N, NL = fours(D * D);
  using At = RateRecord<D>;
  for (int n = 0; n < nrows; n++) {
    const Row row = rows[n];
    T own[NR], L_i[NL], of_i[D];
    read_own<NR>(records, row.i, own);
    read_own<ROW>(gradients, row.i, L_i);
    for (T &s : of_i) s = 0.0;
    for_neighbors<T, false>(row, [&](const int *j, const T &) FSI_INLINE_LAMBDA {
      T other[NR], L_j[NL], L[D * D], x[D], v[D], of_pair[D], of_j[D], rsq = 0.0;
      read_records<NR>(records, j, other);
      read_records<ROW>(gradients, j, L_j);
      for (int k = 0; k < D * D; k++) L[k] = L_i[k] + L_j[k];
      for (int d = 0; d < D; d++) {
        x[d] = own[At::X + d] - other[At::X + d];
        v[d] = own[At::V + d] - other[At::V + d];
        rsq += x[d] * x[d];
      }
      hourglass.operator()<D, T>(0.5 * (own[At::SHEAR] + other[At::SHEAR]),
                                 own[At::VOL] * other[At::VOL], kernel.gradient(root(rsq)), x, v, L,
                                 of_pair);
      for (int d = 0; d < D; d++) {
        of_i[d] += of_pair[d];
        of_j[d] = -of_pair[d];
      }
      Lanes<T>::add_rows(of_j, rate, j);
    });
    for (int d = 0; d < D; d++) rate[row.i][d] += Lanes<T>::sum(of_i[d]);
  }
}

// what a loop of forces is compiled for: artificial viscosity, artificial stress, sums of powers,
// pairs of different bodies
namespace SolidFlag {
  enum { VISCOSITY = 1, STRESS = 2, SUMS = 4, CONTACT = 8 };
}

// Powers that artificial stress, the gradient's correction and artificial viscosity take; virial.
struct SolidSums {
  double stress = 0.0, gradient = 0.0, viscosity = 0.0, virial[6] = {};
};

struct PairLaws {
  ArtificialViscosity viscosity;
  ArtificialStress artificial;
  Contact contact;
  const int *type = nullptr;
  const State *state = nullptr;
  int nlocal = 0;
  // else a pair across ranks is visited on both: each counts half of powers
  bool newton = false;
  SolidSums *sums = nullptr;
};

// takes w_i V_i sigma_i G_i - w_j V_j sigma_j G_j from t, with the corrected gradients G of i and
// of j (fsi_gradient.h) over -g
template <int D, int TERMS, class T>
FSI_INLINE void subtract_corrected(const T *own, const T *other, const T (&x)[D], double hinv,
                                   T (&t)[D])
{
  using At = ForceRecord<D, TERMS>;
  T seen[D], phi[TERMS], Gi[D], Gj[D], si[D], sj[D];
  for (int d = 0; d < D; d++) {
    seen[d] = -hinv * x[d];
    Gi[d] = Gj[d] = 0.0;
  }
  gradient_basis<D, TERMS>(seen, phi);
  for (int a = 0; a < D; a++)
    for (int k = 0; k < TERMS; k++) {
      Gi[a] += own[At::FIT + a * TERMS + k] * phi[k];
      if (k < D)
        Gj[a] -= other[At::FIT + a * TERMS + k] * phi[k];
      else
        Gj[a] += other[At::FIT + a * TERMS + k] * phi[k];
    }
  dot(Sym<D, T>::load(own + At::STRESS), Gi, si);
  dot(Sym<D, T>::load(other + At::STRESS), Gj, sj);
  for (int d = 0; d < D; d++) t[d] -= other[At::VOL0] * si[d] - own[At::VOL0] * sj[d];
}

// what a loop adds up in the type that it goes with: as SolidSums
template <class T> struct SolidTotals {
  T stress = 0.0, gradient = 0.0, viscosity = 0.0, virial[6];
  FSI_INLINE SolidTotals()
  {
    for (T &w : virial) w = 0.0;
  }
};

// a pair: records of both, i minus j, grad_i W_ij = g x, part of powers that counts here
template <int D, int TERMS, class T> struct SolidPair {
  T own[ForceRecord<D, TERMS>::N], other[ForceRecord<D, TERMS>::N], x[D], v[D];
  T rsq, r, g, share;
};

// force of the stress of both, and of artificial stress
template <int FLAGS, class K, int D, int TERMS, class T>
FSI_INLINE void push_by_stress(const SolidPair<D, TERMS, T> &p, const K &kernel,
                               const ArtificialStress &artificial, SolidTotals<T> &totals,
                               T (&force)[D])
{
  using namespace SolidFlag;
  using At = ForceRecord<D, TERMS>;
  Sym<D, T> t;
  if constexpr (TERMS == 0) {
    t = Sym<D, T>::load(p.own + At::STRESS);
    t += Sym<D, T>::load(p.other + At::STRESS);
  }
  if constexpr (FLAGS & STRESS) {
    auto R = Sym<D, T>::load(p.own + At::ARTIFICIAL);
    R += Sym<D, T>::load(p.other + At::ARTIFICIAL);
    R *= artificial.weight(kernel.W(p.r));
    t += R;
    if (FLAGS & SUMS) {
      dot(R, p.x, force);
      const T power = p.share * p.g * product(force, p.v);
      totals.stress -= power;
      totals.gradient += power;
    }
  }
  if constexpr (TERMS == 0 || (FLAGS & STRESS)) dot(t, p.x, force);
  if constexpr (TERMS > 0) subtract_corrected<D, TERMS>(p.own, p.other, p.x, kernel.hinv, force);
  for (int d = 0; d < D; d++) force[d] = p.g * force[d];
}

// Force of a pair on i.
// gradient plain: F_ij = [sigma_i V_i^2 + sigma_j V_j^2 + (R_i + R_j) (W_ij/W(dx))^4 - Q_ij I] .
// grad_i W_ij (paper eq. 14), sigma = -p I + S corrected, quadratic: with the weights G_ij = -V_j
// g C phi of the gradient V_i sigma_i G_ij - V_j sigma_j G_ji instead of the first two terms.
// What deforms the solid is what resists: energy and angular momentum are kept
// between bodies only contact and Q: bodies do not stick, nor share their stress
template <int FLAGS, class K, int D, int TERMS, class T>
FSI_INLINE void push_pair(const SolidPair<D, TERMS, T> &p, int i, const int *j, const K &kernel,
                          const PairLaws &laws, SolidTotals<T> &totals, T (&force)[D])
{
  using namespace SolidFlag;
  using At = ForceRecord<D, TERMS>;
  for (int d = 0; d < D; d++) force[d] = 0.0;
  if constexpr (!(FLAGS & CONTACT)) {
    push_by_stress<FLAGS>(p, kernel, laws.artificial, totals, force);
  } else {
    // along x: it does not go with the kernel's gradient, which may vanish here
    const State &si = laws.state[laws.type[i]], &sj = laws.state[laws.type[*j]];
    const T push = laws.contact(p.rsq, si.csq * si.rho0, sj.csq * sj.rho0);
    for (int d = 0; d < D; d++) force[d] = push * p.x[d];
  }
  if (FLAGS & SUMS) totals.gradient -= p.share * product(force, p.v);
  if (FLAGS & VISCOSITY) {
    const T vdotx = product(p.v, p.x);
    const T q = p.g *
        laws.viscosity(vdotx, p.rsq, T(0.5 * (p.own[At::RHO] + p.other[At::RHO])),
                       T(0.5 * (p.own[At::SOUND] + p.other[At::SOUND])),
                       T(p.own[At::VOL] * p.other[At::VOL]));
    for (int d = 0; d < D; d++) force[d] -= q * p.x[d];
    if (FLAGS & SUMS) totals.viscosity += p.share * q * vdotx;
  }
  if (FLAGS & SUMS)
    add_virial<D>(
        [&](int a, int b) FSI_INLINE_LAMBDA {
          return p.share * p.x[a] * force[b];
        },
        totals.virial);
}

// Adds the forces of pairs to both.
template <class T, class K, int TERMS, int FLAGS>
FSI_INLINE void force_rows(const Row *const rows, const int nrows, const K kernel,
                           const double *const records, const PairLaws laws,
                           double (*const f)[row_of_forces(K::DIM)])
{
  constexpr bool SUMS = FLAGS & SolidFlag::SUMS;
  constexpr int D = K::DIM, NR = ForceRecord<D, TERMS>::N;
  using At = ForceRecord<D, TERMS>;
  using L = Lanes<T>;
  SolidTotals<T> totals;
  for (int n = 0; n < nrows; n++) {
    const Row row = rows[n];
    SolidPair<D, TERMS, T> p;
    T of_i[D];
    read_own<NR>(records, row.i, p.own);
    for (T &s : of_i) s = 0.0;
    for_neighbors<T, false>(row, [&](const int *j, const T &) FSI_INLINE_LAMBDA {
      T force[D], of_j[D];
      read_records<NR>(records, j, p.other);
      for (int d = 0; d < D; d++) {
        p.x[d] = p.own[At::X + d] - p.other[At::X + d];
        p.v[d] = p.own[At::V + d] - p.other[At::V + d];
      }
      p.rsq = product(p.x, p.x);
      p.r = root(p.rsq);
      p.g = kernel.gradient(p.r);
      p.share = SUMS ? share_of<T>(row.i, j, laws.nlocal, laws.newton) : T(1.0);
      push_pair<FLAGS>(p, row.i, j, kernel, laws, totals, force);
      for (int d = 0; d < D; d++) {
        of_i[d] += force[d];
        of_j[d] = -force[d];
      }
      L::add_rows(of_j, f, j);
    });
    for (int d = 0; d < D; d++) f[row.i][d] += L::sum(of_i[d]);
  }
  if (!SUMS) return;
  laws.sums->stress += L::sum(totals.stress);
  laws.sums->gradient += L::sum(totals.gradient);
  laws.sums->viscosity += L::sum(totals.viscosity);
  for (int k = 0; k < 6; k++) laws.sums->virial[k] += L::sum(totals.virial[k]);
}

}    // namespace LAMMPS_NS::FSI

#endif
