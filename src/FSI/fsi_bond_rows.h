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

// Forces of total-Lagrangian solids over the bonds of a particle (pair_style fsi/solid/tl), as many bonds at a time as the number type T
// holds (fsi_pack.h).
//
//   F_i = sum_j (x_j - x_i) (x) G_ij,  f_j = -V_i P(F_i) G_ij, and the opposite on i
// Hourglass control (after Ganzenmueller 2015, in energy form): psi_i gains sum_j zeta E V_i V_j W/|X|^2 |r_ij|^2/2,
//   r_ij = (x_j - x_i) - F_i X_ij: what the linear field F_i does not explain of its neighbours' positions. Its derivative with respect to
//   F_i is -zeta E (A - F_i M), A = sum_j w (x_j - x_i) (x) X_ij, M = sum_j w X_ij (x) X_ij, so that one pass over the bonds has it.
// Artificial viscosity (fsi_viscosity_artificial.h) with the reference kernel; each particle of a pair does half.

#ifndef LMP_FSI_BOND_ROWS_H
#define LMP_FSI_BOND_ROWS_H

#include "fsi_elastic.h"
#include "fsi_material.h"
#include "fsi_pack.h"
#include "fsi_viscosity_artificial.h"

#include <algorithm>
#include <type_traits>
#include <vector>

namespace LAMMPS_NS {
namespace FSI {

  // The bonds of local particle i: n of them, each with 2 D + 2 values (fix_fsi_reference.h).
  struct BondRow {
    int i, n;
    const int *partner;
    const double *values;
    double volume;    // of i in the energy's integral
    double stiffness; // zeta E of hourglass control
    double h;         // smoothing length of its body
  };

  // Doubles of a particle's position and velocity, of the force on it.
  constexpr int row_of_points(int dim) { return dim == 3 ? 8 : 4; }
  constexpr int row_of_bond_forces(int dim) { return dim == 3 ? 4 : 2; }

  struct BondSums {
    double energy = 0.0, artificial = 0.0, virial[6] = {};    // artificial: power that it takes
  };

  struct BondArguments {
    const double *points;    // per particle x, v
    const int *type;
    const State *state;
    const double *const *stress;    // per particle, of law hypo; null: none
    double alpha, beta;             // artificial viscosity
    bool one_material;              // all solids have one density and one speed of sound
    BondSums *sums;
  };

  namespace BondFlag {
    enum { HOURGLASS = 1, VISCOSITY = 2, SUMS = 4 };
  }

  template <class T, int D> struct Bond {
    T G[D], X[D], hourglass, viscous, x[D], v[D];

    Bond() = default;
    // G and x, and what the flags need
    FSI_INLINE Bond(const double *value, const int *partner, const double *points, const double *from, int flags)
    {
      const bool with_velocities = flags & (BondFlag::VISCOSITY | BondFlag::SUMS);
      constexpr int NV = 2 * D + 2, NP = row_of_points(D);
      if constexpr (std::is_same_v<T, double>) {
        for (int a = 0; a < D; a++) {
          G[a] = value[a];
          X[a] = value[D + a];
          x[a] = points[NP * partner[0] + a] - from[a];
          if (with_velocities) v[a] = points[NP * partner[0] + D + a] - from[D + a];
        }
        hourglass = value[2 * D];
        viscous = value[2 * D + 1];
      } else {
        const double *const b[] = {value, value + NV, value + 2 * NV, value + 3 * NV};
        const double *const p[] = {points + NP * partner[0], points + NP * partner[1], points + NP * partner[2], points + NP * partner[3]};
        T one[4], two[4];
        if (D == 2 && !flags) {
          T::columns(p[0], p[1], p[2], p[3], x[0], x[1]);
          x[0] -= from[0];
          x[1] -= from[1];
          T::columns(b[0], b[1], b[2], b[3], G[0], G[1]);
          return;
        }
        T::columns(p[0], p[1], p[2], p[3], one);
        if constexpr (D == 2) {
          x[0] = one[0] - from[0];
          x[1] = one[1] - from[1];
          v[0] = one[2] - from[2];
          v[1] = one[3] - from[3];
          T::columns(b[0], b[1], b[2], b[3], one);
          G[0] = one[0];
          G[1] = one[1];
          X[0] = one[2];
          X[1] = one[3];
          T::columns(b[0] + 4, b[1] + 4, b[2] + 4, b[3] + 4, hourglass, viscous);
        } else {
          for (int a = 0; a < D; a++) x[a] = one[a] - from[a];
          if (with_velocities) {
            v[0] = one[3] - from[3];
            T::columns(p[0] + 4, p[1] + 4, p[2] + 4, p[3] + 4, v[1], v[2]);
            v[1] -= from[4];
            v[2] -= from[5];
          }
          T::columns(b[0], b[1], b[2], b[3], one);
          for (int a = 0; a < D; a++) G[a] = one[a];
          if (!flags) return;
          T::columns(b[0] + 4, b[1] + 4, b[2] + 4, b[3] + 4, two);
          X[0] = one[3];
          X[1] = two[0];
          X[2] = two[1];
          hourglass = two[2];
          viscous = two[3];
        }
      }
    }
  };

  // the law of a particle, a function of its own: it is no part of what takes several bonds at a time
  template <class Law, int D>
#if defined(__GNUC__)
  __attribute__((noinline))
#endif
  PiolaStress<D> evaluate(const Law &law, const double *F, const double *deviator)
  {
    return law.template operator()<D>(F, deviator);
  }

  // takes t F^T from a virial
  template <int D> FSI_INLINE void subtract_product(const double *t, const double *F, double *virial)
  {
    double component[D * D];
    for (int a = 0; a < D; a++)
      for (int c = 0; c < D; c++) {
        component[a * D + c] = 0.0;
        for (int k = 0; k < D; k++) component[a * D + c] -= t[a * D + k] * F[c * D + k];
      }
    add_virial<D>([&](int a, int c) { return component[a * D + c]; }, virial);
  }

  // takes what hourglass control adds to the derivative of the energy from t: F_i changes the straight lines that bonds are measured by
  template <class T, int D> FSI_INLINE void subtract_hourglass(double stiffness, const T *A, const T *M, const double *F, double *t)
  {
    double Ai[D * D], Mi[D * D];
    for (int a = 0; a < D; a++)
      for (int c = 0; c < D; c++) {
        Ai[a * D + c] = Lanes<T>::sum(A[a * D + c]);
        if (c <= a) Mi[a * D + c] = Mi[c * D + a] = Lanes<T>::sum(M[a * D + c]);
      }
    for (int a = 0; a < D; a++)
      for (int c = 0; c < D; c++) {
        double s = Ai[a * D + c];
        for (int k = 0; k < D; k++) s -= F[a * D + k] * Mi[k * D + c];
        t[a * D + c] -= stiffness * s;
      }
  }

  // adds hourglass control of a bond to the force on j; its energy
  template <class T, int D> FSI_INLINE T straighten(double stiffness, const double *F, const Bond<T, D> &b, T (&force)[D])
  {
    const T k = stiffness * b.hourglass;
    T energy = 0.0;
    for (int a = 0; a < D; a++) {
      T r = b.x[a];
      for (int c = 0; c < D; c++) r -= F[a * D + c] * b.X[c];
      force[a] -= k * r;
      energy += 0.5 * k * r * r;
    }
    return energy;
  }

  // adds artificial viscosity to the force on j; what it takes from their energy
  template <class T, int D>
  FSI_INLINE T rub(const ArtificialViscosity &viscosity, const State &si, const State &sj, const Bond<T, D> &b, T (&force)[D])
  {
    T vdotx = 0.0, rsq = 0.0;
    for (int a = 0; a < D; a++) {
      vdotx += b.v[a] * b.x[a];
      rsq += b.x[a] * b.x[a];
    }
    const T q = 0.5 * b.viscous * viscosity(vdotx, rsq, T(0.5 * (si.rho0 + sj.rho0)), 0.5 * (si.c + sj.c), T(1.0));
    for (int a = 0; a < D; a++) force[a] -= q * b.x[a];
    return q * vdotx;
  }

  // f: rows of row_of_bond_forces(D), of local and ghost particles; laws: per type
  template <class T, class Law, int D, int FLAGS>
  FSI_INLINE void bond_rows(const std::vector<BondRow> &rows, const Law *const laws, const BondArguments in,
                            double (*const f)[row_of_bond_forces(D)])
  {
    using namespace BondFlag;
    using L = Lanes<T>;
    constexpr int NV = 2 * D + 2, NP = row_of_points(D), W = L::WIDTH;
    // the bonds of a row as read once, kept for the second pass over them; copied, since doubles need not be where packs may be
    constexpr int SIZE = (FLAGS ? sizeof(Bond<T, D>) : sizeof(Bond<T, D>::G)) / sizeof(double);
    std::vector<double> kept;
    T energy = 0.0, artificial = 0.0, virial[6] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    for (const BondRow &row : rows) {
      const int i = row.i;
      const ArtificialViscosity viscosity(in.alpha, in.beta, row.h);
      const double *const from = in.points + NP * i;
      // the last bonds that do not fill T, with others of no weight to i itself
      const int full = row.n & ~(W - 1);
      double last_values[W * NV];
      int last_partner[W];
      if (kept.size() < (size_t) (row.n / W + 1) * SIZE) kept.resize((size_t) 2 * (row.n / W + 1) * SIZE);
      double *end = kept.data();
      T F[D * D], A[D * D], M[D * D];
      for (int k = 0; k < D * D; k++) F[k] = A[k] = M[k] = 0.0;
      const auto take = [&](const double *values, const int *partner) __attribute__((always_inline)) {
        const Bond<T, D> b(values, partner, in.points, from, FLAGS);
        for (int a = 0; a < D; a++)
          for (int c = 0; c < D; c++) {
            F[a * D + c] += b.x[a] * b.G[c];
            if (FLAGS & HOURGLASS) A[a * D + c] += b.hourglass * b.x[a] * b.X[c];
            if ((FLAGS & HOURGLASS) && c <= a) M[a * D + c] += b.hourglass * b.X[a] * b.X[c];
          }
        __builtin_memcpy(end, &b.G, SIZE * sizeof(double));
        end += SIZE;
      };
      if (W > 1 && full < row.n) {
        std::fill_n(std::copy_n(row.values + full * NV, (row.n - full) * NV, last_values), (W - row.n + full) * NV, 0.0);
        std::fill_n(std::copy_n(row.partner + full, row.n - full, last_partner), W - row.n + full, i);
      }
      // one place for the text of a bond: see for_neighbors() of fsi_fluid_rows.h
      const double *values = row.values;
      const int *partner = row.partner;
      for (int left = row.n; left > 0; left -= W, values += W * NV, partner += W) {
        if (left < W) {
          values = last_values;
          partner = last_partner;
        }
        take(values, partner);
      }

      double Fi[D * D];
      for (int k = 0; k < D * D; k++) Fi[k] = L::sum(F[k]);
      const auto piola = evaluate<Law, D>(laws[in.type[i]], Fi, in.stress ? in.stress[i] : nullptr);
      double t[D * D];    // derivative of the energy of i with respect to F_i
      for (int k = 0; k < D * D; k++) t[k] = row.volume * piola.P[k];
      if (FLAGS & HOURGLASS) subtract_hourglass<T, D>(row.stiffness, A, M, Fi, t);
      if (FLAGS & SUMS) {
        in.sums->energy += row.volume * piola.energy;
        subtract_product<D>(t, Fi, in.sums->virial);
      }

      const State &si = in.state[in.type[i]];
      T sum[D];
      for (T &s : sum) s = 0.0;
      const double *next = kept.data();
      const auto push = [&](const int *partner) __attribute__((always_inline)) {
        Bond<T, D> b;
        __builtin_memcpy(&b.G, next, SIZE * sizeof(double));
        next += SIZE;
        T force[D], extra[D];    // on j; beyond what acts through F_i
        for (int a = 0; a < D; a++) {
          force[a] = -t[a * D] * b.G[0];
          for (int c = 1; c < D; c++) force[a] -= t[a * D + c] * b.G[c];
          extra[a] = 0.0;
        }
        if (FLAGS & HOURGLASS) {
          const T stored = straighten(row.stiffness, Fi, b, extra);
          if (FLAGS & SUMS) energy += stored;
        }
        if (FLAGS & VISCOSITY) {
          // with several materials one by one, since the speed of sound is a number
          const T loss = rub(viscosity, si, in.one_material ? si : in.state[in.type[*partner]], b, extra);
          if (FLAGS & SUMS) artificial += loss;
        }
        if (FLAGS & SUMS) add_virial<D>([&](int a, int c) __attribute__((always_inline)) { return b.x[a] * extra[c]; }, virial);
        for (int a = 0; a < D; a++) {
          if (FLAGS) force[a] += extra[a];
          sum[a] += force[a];
        }
        L::add_rows(force, f, partner, D);
      };
      partner = row.partner;
      for (int left = row.n; left > 0; left -= W, partner += W) {
        if (left < W) partner = last_partner;
        push(partner);
      }
      for (int a = 0; a < D; a++) f[i][a] -= L::sum(sum[a]);
    }
    if (FLAGS & SUMS) {
      in.sums->energy += L::sum(energy);
      in.sums->artificial += L::sum(artificial);
      for (int k = 0; k < 6; k++) in.sums->virial[k] += L::sum(virial[k]);
    }
  }

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
