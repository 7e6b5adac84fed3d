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

// Four numbers side by side give what four numbers one by one give.

#include "fsi_pair_laws.h"
#include "fsi_kernel.h"
#include "fsi_pack.h"

#include <cmath>
#include <gtest/gtest.h>
#include <string>

using namespace LAMMPS_NS::FSI;

#if FSI_PACKS

// a product and a sum may be rounded once or twice
static constexpr double ROUND = 1e-14;

static void expect(const double *got, const double *want)
{
  for (int k = 0; k < 4; k++) EXPECT_NEAR(got[k], want[k], ROUND * (1.0 + std::fabs(want[k]))) << "place " << k;
}

FSI_TARGET static void transpose(const double (*rows)[4], double (*columns)[4], double (*sums)[4])
{
  Pack c[4];
  Pack::columns(rows[0], rows[1], rows[2], rows[3], c);
  for (int n = 0; n < 4; n++)
    for (int k = 0; k < 4; k++) columns[n][k] = c[n].v[k];
  Pack::add_rows(c[0], c[1], c[2], 0.0, sums[0], sums[1], sums[2], sums[3], nullptr);
}

FSI_TARGET static void pairs_of_columns(const double (*rows)[4], double *first, double *second)
{
  Pack a, b;
  Pack::columns(rows[0], rows[1], rows[2], rows[3], a, b);
  for (int k = 0; k < 4; k++) {
    first[k] = a.v[k];
    second[k] = b.v[k];
  }
}

TEST(Pack, Columns)
{
  if (!have_packs()) return;
  double rows[4][4], columns[4][4], sums[4][4] = {}, first[4], second[4];
  for (int n = 0; n < 4; n++)
    for (int k = 0; k < 4; k++) rows[n][k] = 10 * n + k + 1;
  transpose(rows, columns, sums);
  pairs_of_columns(rows, first, second);
  for (int n = 0; n < 4; n++) {
    for (int k = 0; k < 4; k++) {
      EXPECT_EQ(columns[k][n], rows[n][k]);
      EXPECT_EQ(sums[n][k], k < 3 ? rows[n][k] : 0.0);    // back where they came from
    }
    EXPECT_EQ(first[n], rows[n][0]);
    EXPECT_EQ(second[n], rows[n][1]);
  }
}

// Numbers of four particles go to the rows of those, the rest of which stays; their totals, times
// factors, to one row more.
template <int n, int N>
FSI_TARGET static void scatter(const double (*of)[4], double (*rows)[N], const int *j, const double *factors, double *all)
{
  using L = Lanes<Pack>;
  Pack x[n];
  for (int d = 0; d < n; d++) x[d] = Pack::load(of[d]);
  if constexpr (N % 4) {
    L::add_rows(x, rows, j);
  } else {
    Pack total[L::totals(n)];
    for (Pack &t : total) t = 0.0;
    L::add_to_all(x, rows, j, total);
    L::template add_totals<n>(total, factors, all);
  }
}

template <int n, int N> static void expect_scattered()
{
  double of[n][4], rows[9][N] = {}, all[N] = {}, factors[N];
  const int j[4] = {7, 2, 0, 5};
  for (int d = 0; d < n; d++)
    for (int k = 0; k < 4; k++) of[d][k] = 100 * d + k + 1;
  for (int d = 0; d < N; d++) {
    rows[2][d] = 0.5;
    factors[d] = d % 3 ? d : -1.0;
  }
  scatter<n, N>(of, rows, j, factors, all);
  for (int d = 0; d < n && N % 4 == 0; d++) EXPECT_EQ(all[d], factors[d] * (400 * d + 10)) << n << " of " << N << ": total " << d;
  for (int i = 0; i < 9; i++)
    for (int d = 0; d < N; d++) {
      double want = i == 2 ? 0.5 : 0.0;
      for (int k = 0; k < 4; k++)
        if (j[k] == i && d < n) want += of[d][k];
      EXPECT_EQ(rows[i][d], want) << n << " of " << N << ": row " << i << ", number " << d;
    }
}

TEST(Pack, Rows)
{
  if (!have_packs()) return;
  expect_scattered<2, 2>();
  expect_scattered<3, 4>();
  expect_scattered<5, 12>();
  expect_scattered<12, 12>();
  expect_scattered<7, 24>();
  expect_scattered<22, 24>();
}

// every formula that loops over packs use, of numbers in which each branch is taken
template <class T> struct Values {
  T W, gradient, artificial, flux, loss, f[2], sum;
};

template <class K, class T> FSI_INLINE Values<T> evaluate(const T &q, const T &u, bool central)
{
  const K kernel(0.1);
  Values<T> r;
  const T x[2] = {0.1 * q * 0.6, 0.1 * q * 0.8}, v[2] = {u, 0.5 * u};
  const T rsq = x[0] * x[0] + x[1] * x[1];
  r.W = kernel.W(root(rsq));
  r.gradient = kernel.gradient(root(rsq));
  r.artificial = ArtificialViscosity(0.3, 0.7, 0.1)(T(x[0] * v[0] + x[1] * v[1]), rsq, T(1000.0 + u), 20.0, T(1e-4));
  r.flux = DensityDiffusion(0.1, 0.1, 20.0)(T(1000.0), T(1000.0 + u), greater(u, T(0.0)), r.gradient);
  r.f[0] = r.f[1] = 0.0;
  r.loss = LaminarViscosity<2>(central ? 0.01 : 0.0)(r.gradient, 0.02, T(1e-4), x, v, r.f);
  r.sum = q;
  r.sum += u;
  return r;
}

template <class K> FSI_TARGET static void side_by_side(const double *q, const double *u, bool central, double (*out)[4])
{
  const Values<Pack> r = evaluate<K>(Pack(q[0], q[1], q[2], q[3]), Pack(u[0], u[1], u[2], u[3]), central);
  const Pack *const all[] = {&r.W, &r.gradient, &r.artificial, &r.flux, &r.loss, &r.f[0], &r.f[1], &r.sum};
  for (int n = 0; n < 8; n++)
    for (int k = 0; k < 4; k++) out[n][k] = all[n]->v[k];
}

template <class K> static void compare()
{
  if (!have_packs()) return;
  for (bool central : {false, true})
    for (double from = 0.0; from < 3.3; from += 0.37) {    // through all pieces of a kernel and past its support
      const double q[4] = {from, 0.9 * from + 0.05, 1.7, 0.0}, u[4] = {0.3, -0.4, -2.0, 0.0};
      double got[8][4], want[8][4];
      side_by_side<K>(q, u, central, got);
      for (int k = 0; k < 4; k++) {
        const Values<double> r = evaluate<K>(q[k], u[k], central);
        const double all[] = {r.W, r.gradient, r.artificial, r.flux, r.loss, r.f[0], r.f[1], r.sum};
        for (int n = 0; n < 8; n++) want[n][k] = all[n];
      }
      for (int n = 0; n < 8; n++) {
        SCOPED_TRACE("value " + std::to_string(n) + " at q = " + std::to_string(from));
        expect(got[n], want[n]);
      }
    }
}

TEST(Pack, FormulasCubic2) { compare<Cubic<2>>(); }
TEST(Pack, FormulasCubic3) { compare<Cubic<3>>(); }
TEST(Pack, FormulasQuintic2) { compare<Quintic<2>>(); }
TEST(Pack, FormulasQuintic3) { compare<Quintic<3>>(); }
TEST(Pack, FormulasWendland2) { compare<Wendland<2>>(); }
TEST(Pack, FormulasWendland3) { compare<Wendland<3>>(); }

#endif
