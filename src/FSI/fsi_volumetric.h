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

// Nearly incompressible solids, which would lock (theory.rst, Locking): what lambda exceeds that of
// a Poisson's ratio of LOCAL acts on a smoothed volumetric strain,
//   U = sum_i V_i k u(theta_i),  theta_i = sum_j w_ij m_j,
// i: particles that move; j: i and its partners of the same material; m_j: the law's volumetric
// strain of F_j (fsi_solid_laws.h). w_ij: weights of a least-squares fit of a linear function
// to the m_j, at i, with weights 1 - |X|^2/R^2, R the support. Projected strains: Hughes, Int. J.
// Numer. Meth. Eng. 15, 1413 (1980); patches of F-bar: de Souza Neto, Pires and Owen, ibid. 62, 353
// (2005). The force is minus the derivative of U: j has the stress (q_j/V_j) dm/dF with
//   q_j = sum_i V_i k u'(theta_i) w_ij.
// Held particles count in no U: they have no freedom with which to meet a constraint, and clamps
// would be too stiff by up to 3 per cent.

#ifndef LMP_FSI_VOLUMETRIC_H
#define LMP_FSI_VOLUMETRIC_H

#include "fsi_bond_rows.h"

#include <algorithm>
#include <vector>

namespace LAMMPS_NS::FSI {

struct VolumetricStrain {
  static constexpr double LOCAL = 0.3;          // Poisson's ratio whose lambda is not smoothed
  static constexpr double LOCKS_ABOVE = 0.4;    // up to this one bodies bend as they should

  std::vector<double> modulus;                // k, per type, 0: not smoothed. Empty: nothing is
  std::vector<double> weight, own;            // w_ij of rows' partners, in whole blocks; w_ii
  std::vector<double> stiffness;              // k V_i of each row, 0: held, or not smoothed
  std::vector<double> strain, mean, force;    // m, theta and q, per particle

  bool on() const { return !modulus.empty(); }
  void resize(size_t n)
  {
    if (strain.size() >= n) return;
    for (auto *x : {&strain, &mean, &force}) x->resize(n, 0.0);
  }
  double memory_usage() const
  {
    return bytes_of(modulus, weight, own, stiffness, strain, mean, force);
  }

  static double excess(const Material &m)
  {
    const double mu = m.shear_modulus(), lambda = m.bulk_modulus() - 2.0 / 3.0 * mu;
    return std::max(0.0, lambda - 2.0 * mu * LOCAL / (1.0 - 2.0 * LOCAL));
  }

  // moves(i); same(i, j): of one material; cut: support by type
  template <int D, class Moves, class Same, class Cut>
  void find_weights(const std::vector<BondRow> &rows, const int *type, Moves moves, Same same,
                    Cut cut)
  {
    own.clear();
    weight.clear();
    stiffness.clear();
    for (const BondRow &row : rows) {
      const double k = modulus[type[row.i]];
      const size_t first = weight.size();
      weight.resize(first + whole_blocks(row.n), 0.0);
      own.push_back(k > 0.0 ? fit<D>(row, 1.0 / cut(type[row.i]), same, &weight[first]) : 0.0);
      stiffness.push_back(moves(row.i) ? k * row.volume : 0.0);
    }
  }

 private:
  // returns the weight of i itself
  template <int D, class Same>
  static double fit(const BondRow &row, double inv, Same same, double *w)
  {
    constexpr int N = D + 1;
    double A[packed_size(N)] = {1.0}, c[N], phi[N] = {1.0};
    const auto read = [&](int k) {
      const double *const X = row.numbers + number_of_bond(k, 2 * D + 2) + D * BOND_BLOCK;
      double rsq = 0.0;
      for (int a = 0; a < D; a++) {
        phi[1 + a] = X[a * BOND_BLOCK] * inv;
        rsq += phi[1 + a] * phi[1 + a];
      }
      return std::max(0.0, 1.0 - rsq);
    };
    for (int k = 0; k < row.n; k++) {
      if (!same(row.i, row.partner[k])) continue;
      w[k] = read(k);
      for (int a = 0, m = 0; a < N; a++)
        for (int b = 0; b <= a; b++) A[m++] += w[k] * phi[a] * phi[b];
    }
    gradient_coefficients<1, N>(A, c, FLAT);
    for (int k = 0; k < row.n; k++) {
      if (w[k] == 0.0) continue;
      read(k);
      double s = c[0];
      for (int a = 1; a < N; a++) s += c[a] * phi[a];
      w[k] *= s;
    }
    return c[0];
  }
};

// m of the particles of rows first to last - 1
template <class T, class Law, int D>
FSI_INLINE void find_volumetric_strains(const std::vector<BondRow> &rows, int first, int last,
                                        const int *type, const double *points, VolumetricStrain &s)
{
  for (int r = first; r < last; r++) {
    const BondRow &row = rows[r];
    if (s.modulus[type[row.i]] == 0.0) continue;
    double F[D * D];
    deform_row<T, D, false>(row, points, F);
    s.strain[row.i] = Law::template volumetric_strain<D>(F);
  }
}

// theta of the particles of these rows, where it counts or of all; adds to force, q of them and
// of their partners; the energy
template <class T, class Law>
FSI_INLINE double smooth_volumetric_strains(const std::vector<BondRow> &rows, int first, int last,
                                            bool of_all, VolumetricStrain &s, double *force)
{
  using L = Lanes<T>;
  constexpr int W = L::WIDTH;
  double energy = 0.0;
  const double *next = s.weight.data();
  for (int r = 0; r < first; r++) next += whole_blocks(rows[r].n);
  for (int r = first; r < last; r++) {
    const BondRow &row = rows[r];
    const double k = s.stiffness[r], *const w = next;
    next += whole_blocks(row.n);
    if (k == 0.0 && !of_all) continue;
    T sum = 0.0;
    for (int n = 0; n < row.n; n += W)
      sum += L::load(w + n) * L::read(s.strain.data(), row.partner + n);
    const double theta = s.own[r] * s.strain[row.i] + L::sum(sum);
    s.mean[row.i] = theta;
    if (k == 0.0) continue;
    const double q = k * Law::volumetric_slope(theta);
    energy += k * Law::volumetric_energy(theta);
    for (int n = 0; n < row.n; n += W) L::add(q * L::load(w + n), force, row.partner + n);
    force[row.i] += q * s.own[r];
  }
  return energy;
}

}    // namespace LAMMPS_NS::FSI

#endif
