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

// Forces of total-Lagrangian solids over the bonds of a particle (pair_style fsi/solid/tl), as many
// bonds at a time as the number type T holds (fsi_pack.h).
//
//   F_i = sum_j (x_j - x_i) (x) G_ij,  f_j = -V_i P(F_i) G_ij, and the opposite on i
// Hourglass control (after Ganzenmueller 2015, in energy form): psi_i gains
//   sum_j zeta E w |r_ij|^2/2,  w = V_i V_j W/|X|^2,  r_ij = (x_j - x_i) - F_i X_ij
// r_ij is what the linear field F_i does not explain of its neighbors' positions. The derivative
// with respect to F_i is -zeta E (A - F_i M), A = sum_j w (x_j - x_i) (x) X_ij,
// M = sum_j w X_ij (x) X_ij, so that one pass over the bonds has it; M is of the reference.
// Artificial viscosity (fsi_pair_laws.h) with the reference kernel; each particle of a
// pair does half.

#ifndef LMP_FSI_BOND_ROWS_H
#define LMP_FSI_BOND_ROWS_H

#include "fsi_gradient.h"
#include "fsi_material.h"
#include "fsi_pack.h"
#include "fsi_pair_laws.h"
#include "fsi_rows.h"
#include "fsi_solid_laws.h"
#include "fsi_tensor.h"

#include <cstring>
#include <type_traits>
#include <vector>

namespace LAMMPS_NS::FSI {

// Numbers of bonds are kept side by side, as loops take them: the first ones of BOND_BLOCK bonds,
// their second ones, and so on.
constexpr int BOND_BLOCK = 4;
constexpr int whole_blocks(int n)
{
  return (n + BOND_BLOCK - 1) / BOND_BLOCK * BOND_BLOCK;
}
// place of the first number of bond k, of which each has n; the next ones are BOND_BLOCK further
constexpr size_t number_of_bond(int k, int n)
{
  return (size_t) (k / BOND_BLOCK) * BOND_BLOCK * n + k % BOND_BLOCK;
}

// The bonds of local particle i: n of them, each with 2 D + 2 numbers (fix_fsi_reference.h). What
// fills up the last block has partners, too.
struct BondRow {
  int i, n;
  const int *partner;
  const double *numbers;
  const double *moments;    // M of hourglass control, lower triangle
  double volume;            // of i in the energy's integral
  double stiffness;         // zeta E of hourglass control
  double h;                 // smoothing length of its body
};

struct BondSums {
  double energy = 0.0, artificial = 0.0, virial[6] = {};    // artificial: power that it takes
  int inverted = -1;                                        // a particle with det F <= 0
};

struct BondArguments {
  const double *points = nullptr;    // per particle x, v
  const int *type = nullptr;
  const State *state = nullptr;
  const double *const *history = nullptr;    // per particle, of the law (fsi_law_list.h); null:
                                             // none
  const double *volumetric = nullptr;        // per particle, q of fsi_volumetric.h; null: none
  double alpha = 0.0, beta = 0.0;            // artificial viscosity
  bool one_material = false;                 // all solids have one density and one speed of sound
  BondSums *sums = nullptr;
};

namespace BondFlag {
  enum { HOURGLASS = 1, VISCOSITY = 2, SUMS = 4 };
}

// Positions of partners from those of i, and velocities.
template <class T, int D> struct Separation {
  T x[D], v[D];

  // from: x, v of i
  FSI_INLINE void read(const int *partner, const double *points, const T (&from)[2 * D],
                       bool with_velocities)
  {
    constexpr int N = row_of_points(D);
    const double *const p = points + N * partner[0];
    if constexpr (std::is_same_v<T, double>) {
      for (int a = 0; a < D; a++) x[a] = p[a] - from[a];
      if (with_velocities)
        for (int a = 0; a < D; a++) v[a] = p[D + a] - from[D + a];
    } else {
      const double *const q = points + N * partner[1], *const r = points + N * partner[2],
                          *const s = points + N * partner[3];
      T at[2 * D];
      if (D == 2 && !with_velocities)
        T::columns(p, q, r, s, at[0], at[1]);
      else
        T::columns(p, q, r, s, at);
      if (D == 3 && with_velocities)
        T::columns(p + 4, q + 4, r + 4, s + 4, at[2 * D - 2], at[2 * D - 1]);
      for (int a = 0; a < D; a++) x[a] = at[a] - from[a];
      if (with_velocities)
        for (int a = 0; a < D; a++) v[a] = at[D + a] - from[D + a];
    }
  }
};

// takes F t^T from a virial
template <int D> FSI_INLINE void subtract_product(const double *t, const double *F, double *virial)
{
  double component[D * D];
  for (int a = 0; a < D; a++)
    for (int c = 0; c < D; c++) {
      component[a * D + c] = 0.0;
      for (int k = 0; k < D; k++) component[a * D + c] -= F[a * D + k] * t[c * D + k];
    }
  add_virial<D>(
      [&](int a, int c) {
        return component[a * D + c];
      },
      virial);
}

// takes what hourglass control adds to the derivative of the energy from t: F_i changes the
// straight lines that bonds are measured by
template <class T, int D>
FSI_INLINE void subtract_hourglass(double stiffness, const T *A, const double *M, const double *F,
                                   double *t)
{
  const auto at = [](int a, int c) {
    return a < c ? packed_size(c) + a : packed_size(a) + c;
  };
  for (int a = 0; a < D; a++)
    for (int c = 0; c < D; c++) {
      double s = Lanes<T>::sum(A[a * D + c]);
      for (int k = 0; k < D; k++) s -= F[a * D + k] * M[at(k, c)];
      t[a * D + c] -= stiffness * s;
    }
}

// adds hourglass control of a bond, k = zeta E w, to the force on j; its energy
template <class T, int D>
FSI_INLINE T straighten(const T &k, const double *F, const T (&x)[D], const T (&X)[D],
                        T (&force)[D])
{
  T rsq = 0.0;
  for (int a = 0; a < D; a++) {
    T r = x[a];
    for (int c = 0; c < D; c++) r -= F[a * D + c] * X[c];
    force[a] -= k * r;
    rsq += r * r;
  }
  return 0.5 * k * rsq;
}

// adds artificial viscosity of a bond, g = V_i V_j (grad W)/x_ij, to the force on j; what it
// takes from their energy
template <class T, int D>
FSI_INLINE T viscous_force(const ArtificialViscosity &viscosity, const State &si, const State &sj,
                           const T &g, const Separation<T, D> &b, T (&force)[D])
{
  T vdotx = 0.0, rsq = 0.0;
  for (int a = 0; a < D; a++) {
    vdotx += b.v[a] * b.x[a];
    rsq += b.x[a] * b.x[a];
  }
  const T q =
      0.5 * g * viscosity(vdotx, rsq, T(0.5 * (si.rho0 + sj.rho0)), 0.5 * (si.c + sj.c), T(1.0));
  for (int a = 0; a < D; a++) force[a] -= q * b.x[a];
  return q * vdotx;
}

// number v of bond k of a row, and of those that go side by side with it
template <class T, int D> FSI_INLINE T number_of(const BondRow &row, int k, int v)
{
  constexpr int NV = 2 * D + 2;
  return Lanes<T>::load(row.numbers +
                        (Lanes<T>::WIDTH == BOND_BLOCK ? (size_t) k * NV : number_of_bond(k, NV)) +
                        v * BOND_BLOCK);
}

// What loops over the bonds of a row need to know before they begin. Partners are read once and
// kept for the second pass over them; copied, since doubles need not be where packs may be
template <class T, int D, int FLAGS> struct BondPass {
  using Partners = Separation<T, D>;
  static constexpr bool VELOCITIES = FLAGS & (BondFlag::VISCOSITY | BondFlag::SUMS);
  static constexpr int SIZE =
      (VELOCITIES ? sizeof(Partners) : sizeof(Partners::x)) / sizeof(double);
  static constexpr int W = Lanes<T>::WIDTH;
};

// F gains u (x) G of bond k, and of those side by side with it: the one place that says what F is
template <class T, int D> FSI_INLINE void deform(const BondRow &row, int k, const T (&u)[D], T *F)
{
  for (int a = 0; a < D; a++)
    for (int c = 0; c < D; c++) F[a * D + c] += u[a] * number_of<T, D>(row, k, c);
}

// calls each(k, Separation) of all bonds of a row
template <class T, int D, bool VELOCITIES, class Each>
FSI_INLINE void for_bonds(const BondRow &row, const double *points, Each each)
{
  T from[2 * D];
  for (int a = 0; a < 2 * D; a++) from[a] = points[row_of_points(D) * row.i + a];
  for (int k = 0; k < row.n; k += Lanes<T>::WIDTH) {
    Separation<T, D> b;
    b.read(row.partner + k, points, from, VELOCITIES);
    each(k, b);
  }
}

// F of a row alone, for what takes no second pass over it; with RATE its rate, too
template <class T, int D, bool RATE>
FSI_INLINE void deform_row(const BondRow &row, const double *points, double *F,
                           double *Fdot = nullptr)
{
  T sum[D * D], rate[D * D];
  for (int k = 0; k < D * D; k++) sum[k] = rate[k] = 0.0;
  for_bonds<T, D, RATE>(row, points, [&](int k, const Separation<T, D> &b) FSI_INLINE_LAMBDA {
    deform<T, D>(row, k, b.x, sum);
    if (RATE) deform<T, D>(row, k, b.v, rate);
  });
  for (int k = 0; k < D * D; k++) {
    F[k] = Lanes<T>::sum(sum[k]);
    if (RATE) Fdot[k] = Lanes<T>::sum(rate[k]);
  }
}

// The first pass: F and A of a row
template <class T, int D, int FLAGS>
FSI_INLINE void gather_row(const BondRow &row, const double *points, double *end, T (&F)[D * D],
                           T (&A)[D * D])
{
  using Pass = BondPass<T, D, FLAGS>;
  for (int k = 0; k < D * D; k++) F[k] = A[k] = 0.0;
  for_bonds<T, D, Pass::VELOCITIES>(row, points,
                                    [&](int k, const Separation<T, D> &b) FSI_INLINE_LAMBDA {
                                      deform<T, D>(row, k, b.x, F);
                                      for (int a = 0; a < D && (FLAGS & BondFlag::HOURGLASS); a++) {
                                        const T wx = number_of<T, D>(row, k, 2 * D) * b.x[a];
                                        for (int c = 0; c < D; c++)
                                          A[a * D + c] += wx * number_of<T, D>(row, k, D + c);
                                      }
                                      std::memcpy(end, b.x, sizeof(b.x));
                                      if (Pass::VELOCITIES)
                                        std::memcpy(end + Pass::SIZE / 2, b.v, sizeof(b.v));
                                      end += Pass::SIZE;
                                    });
}

// The derivative t of the energy of i with respect to F_i
template <class T, class Law, int D, int FLAGS>
FSI_INLINE void differentiate(const BondRow &row, const Law &law, const BondArguments &in,
                              const double *F, const T *A, double *t)
{
  const int i = row.i;
  // inline: a call would write F number by number and read it in pairs, which waits until all
  // stores before it are done
  const auto piola = law.template operator()<D>(F, in.history ? in.history[i] : nullptr);
  if (determinant<D>(F) <= 0.0) in.sums->inverted = i;
  for (int k = 0; k < D * D; k++) t[k] = row.volume * piola.P[k];
  if (in.volumetric) {
    double dm[D * D];
    law.template volumetric_strain<D>(F, dm);
    for (int k = 0; k < D * D; k++) t[k] += in.volumetric[i] * dm[k];
  }
  if (FLAGS & BondFlag::HOURGLASS) subtract_hourglass<T, D>(row.stiffness, A, row.moments, F, t);
  if (FLAGS & BondFlag::SUMS) {
    in.sums->energy += row.volume * piola.energy;
    subtract_product<D>(t, F, in.sums->virial);
  }
}

// what a loop adds up in the type that it goes with
template <class T> struct BondTotals {
  T energy = 0.0, artificial = 0.0, virial[6];
  FSI_INLINE BondTotals()
  {
    for (T &w : virial) w = 0.0;
  }
};

// The second pass: forces on partners, and the opposite on i. next: what gather_row() kept
template <class T, int D, int FLAGS>
FSI_INLINE void push_row(const BondRow &row, const BondArguments &in, const double *F,
                         const double *t, const double *next, BondTotals<T> &totals,
                         double (*f)[row_of_forces(D)])
{
  using namespace BondFlag;
  using Pass = BondPass<T, D, FLAGS>;
  const ArtificialViscosity viscosity(in.alpha, in.beta, row.h);
  const State &si = in.state[in.type[row.i]];
  T sum[D];
  for (T &s : sum) s = 0.0;
  for (int k = 0; k < row.n; k += Pass::W, next += Pass::SIZE) {
    Separation<T, D> b;
    std::memcpy(b.x, next, sizeof(b.x));
    if (Pass::VELOCITIES) std::memcpy(b.v, next + Pass::SIZE / 2, sizeof(b.v));
    T force[D], X[D], other[D];    // on j
    // what does not act through F_i: the virial's
    T(&beyond)[D] = (FLAGS & SUMS) ? other : force;
    for (int a = 0; a < D; a++) {
      force[a] = -t[a * D] * number_of<T, D>(row, k, 0);
      for (int c = 1; c < D; c++) force[a] -= t[a * D + c] * number_of<T, D>(row, k, c);
      X[a] = number_of<T, D>(row, k, D + a);
      if (FLAGS & SUMS) other[a] = 0.0;
    }
    if (FLAGS & HOURGLASS) {
      const T w = number_of<T, D>(row, k, 2 * D);
      const T stored = straighten(row.stiffness * w, F, b.x, X, beyond);
      if (FLAGS & SUMS) totals.energy += stored;
    }
    if (FLAGS & VISCOSITY) {
      // with several materials one by one, since the speed of sound is a number
      const State &sj = in.one_material ? si : in.state[in.type[row.partner[k]]];
      const T g = number_of<T, D>(row, k, 2 * D + 1);
      const T loss = viscous_force(viscosity, si, sj, g, b, beyond);
      if (FLAGS & SUMS) totals.artificial += loss;
    }
    if (FLAGS & SUMS)
      add_virial<D>(
          [&](int a, int c) FSI_INLINE_LAMBDA {
            return b.x[a] * beyond[c];
          },
          totals.virial);
    for (int a = 0; a < D; a++) {
      if (FLAGS & SUMS) force[a] += other[a];
      sum[a] += force[a];
    }
    Lanes<T>::add_rows(force, f, row.partner + k);
  }
  for (int a = 0; a < D; a++) f[row.i][a] -= Lanes<T>::sum(sum[a]);
}

// f: rows of row_of_forces(D), of local and ghost particles; laws: per type
template <class T, class Law, int D, int FLAGS>
FSI_INLINE void bond_rows(const BondRow *const rows, const int nrows, const Law *const laws,
                          const BondArguments in, double (*const f)[row_of_forces(D)])
{
  using L = Lanes<T>;
  using Pass = BondPass<T, D, FLAGS>;
  std::vector<double> kept;
  BondTotals<T> totals;
  for (int n = 0; n < nrows; n++) {
    const BondRow row = rows[n];
    if (kept.size() < (size_t) (row.n / Pass::W + 1) * Pass::SIZE)
      kept.resize((size_t) 2 * (row.n / Pass::W + 1) * Pass::SIZE);
    T F[D * D], A[D * D];
    gather_row<T, D, FLAGS>(row, in.points, kept.data(), F, A);
    double Fi[D * D], t[D * D];
    for (int k = 0; k < D * D; k++) Fi[k] = L::sum(F[k]);
    differentiate<T, Law, D, FLAGS>(row, laws[in.type[row.i]], in, Fi, A, t);
    push_row<T, D, FLAGS>(row, in, Fi, t, kept.data(), totals, f);
  }
  if (FLAGS & BondFlag::SUMS) {
    in.sums->energy += L::sum(totals.energy);
    in.sums->artificial += L::sum(totals.artificial);
    for (int k = 0; k < 6; k++) in.sums->virial[k] += L::sum(totals.virial[k]);
  }
}

}    // namespace LAMMPS_NS::FSI

#endif
