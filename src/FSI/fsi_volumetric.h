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

// Nearly incompressible solids. Bent bodies lock, most with an even number of particles across, where the pressure is asked to vanish
// at more places than the displacements can satisfy. So what lambda exceeds that of a Poisson's ratio of LOCAL acts on a smoothed
// volumetric strain,
//   U = sum_i V_i k u(theta_i),  theta_i = sum_j w_ij m_j,  j: i and its partners of the same material,
// m_j the law's volumetric strain of F_j (fsi_elastic.h). w_ij is that of a least-squares fit of a linear function to the m_j, at i, with
// weights 1 - |X|^2/R^2, R the support: sum_j w_ij = 1, sum_j w_ij X_ij = 0. A linear strain, as that of bending, stays as it is, so
// that nothing gets soft; what varies from particle to particle is taken out: the spaces of the element Q2/P1 (de Souza Neto et al., Computational
// Methods for Plasticity, 2008, sec. 15; Hughes, Int. J. Numer. Meth. Eng. 15, 1413, 1980, for the projected strain).
// The force is minus the derivative of U: particle j has the stress (q_j/V_j) dm/dF, q_j = sum_i V_i k u'(theta_i) w_ij.

#ifndef LMP_FSI_VOLUMETRIC_H
#define LMP_FSI_VOLUMETRIC_H

#include "fsi_bond_rows.h"

#include <algorithm>
#include <vector>

namespace LAMMPS_NS {
namespace FSI {

  struct VolumetricStrain {
    static constexpr double LOCAL = 0.3;          // Poisson's ratio whose lambda is not smoothed
    static constexpr double LOCKS_ABOVE = 0.4;    // up to this one bodies bend as they should without

    std::vector<double> modulus;    // k, per type; 0: not smoothed. Empty: nothing is
    std::vector<double> weight, own;    // w_ij of each row's partners, in whole blocks, and of its particle
    std::vector<double> strain, force;    // m and q, per particle

    bool on() const { return !modulus.empty(); }
    double memory_usage() const
    {
      return (double) (modulus.capacity() + weight.capacity() + own.capacity() + strain.capacity() + force.capacity()) * sizeof(double);
    }

    static double excess(const Material &m)
    {
      const double lambda = m.bulk_modulus() - 2.0 / 3.0 * m.shear_modulus();
      return std::max(0.0, lambda - 2.0 * m.shear_modulus() * LOCAL / (1.0 - 2.0 * LOCAL));
    }

    // same(i, j): of one material; cut: support by type
    template <int D, class Same, class Cut> void find_weights(const std::vector<BondRow> &rows, const int *type, Same same, Cut cut)
    {
      own.clear();
      weight.clear();
      for (const BondRow &row : rows) {
        const size_t first = weight.size();
        weight.resize(first + whole_blocks(row.n), 0.0);
        own.push_back(modulus[type[row.i]] > 0.0 ? fit<D>(row, 1.0 / cut(type[row.i]), same, &weight[first]) : 0.0);
      }
    }

   private:
    // returns the weight of i itself
    template <int D, class Same> static double fit(const BondRow &row, double inv, Same same, double *w)
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

  // m of the rows' particles
  template <class T, class Law, int D>
  FSI_INLINE void find_volumetric_strains(const std::vector<BondRow> &rows, const int *type, const double *points, VolumetricStrain &s)
  {
    using L = Lanes<T>;
    constexpr int NV = 2 * D + 2, W = L::WIDTH;
    for (const BondRow &row : rows) {
      if (s.modulus[type[row.i]] == 0.0) continue;
      T from[2 * D], F[D * D];
      for (int a = 0; a < 2 * D; a++) from[a] = points[row_of_points(D) * row.i + a];
      for (T &x : F) x = 0.0;
      for (int k = 0; k < row.n; k += W) {
        Separation<T, D> b;
        b.read(row.partner + k, points, from, false);
        const double *const G = row.numbers + (W == BOND_BLOCK ? (size_t) k * NV : number_of_bond(k, NV));
        for (int c = 0; c < D; c++) {
          const T g = L::load(G + c * BOND_BLOCK);
          for (int a = 0; a < D; a++) F[a * D + c] += b.x[a] * g;
        }
      }
      double Fi[D * D];
      for (int k = 0; k < D * D; k++) Fi[k] = L::sum(F[k]);
      s.strain[row.i] = Law::template volumetric_strain<D>(Fi);
    }
  }

  // adds to q of the rows' particles and their partners; the energy
  template <class T, class Law>
  FSI_INLINE double push_by_smoothed_strains(const std::vector<BondRow> &rows, const int *type, VolumetricStrain &s)
  {
    using L = Lanes<T>;
    constexpr int W = L::WIDTH;
    double energy = 0.0;
    const double *w = s.weight.data(), *own = s.own.data();
    for (const BondRow &row : rows) {
      const double k = s.modulus[type[row.i]] * row.volume, self = *own++;
      const double *const first = w;
      w += whole_blocks(row.n);
      if (k == 0.0) continue;
      T sum = 0.0;
      for (int n = 0; n < row.n; n += W) sum += L::load(first + n) * L::read(s.strain.data(), row.partner + n);
      const double theta = self * s.strain[row.i] + L::sum(sum), q = k * Law::volumetric_slope(theta);
      energy += k * Law::volumetric_energy(theta);
      for (int n = 0; n < row.n; n += W) L::add(q * L::load(first + n), s.force.data(), row.partner + n);
      s.force[row.i] += q * self;
    }
    return energy;
  }

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
