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


// Gradients at a particle from its neighbours: grad u_i = sum_j (u_j - u_i) (x) G_ij, the weights G_ij from moving least
// squares about i.
//
// Exact for linear fields (Bonet and Lok 1999 give the same property), or for quadratic ones. At a free face, where all
// neighbours are on one side, a gradient that is only exact for linear fields is that of a place about 0.6 dx inside the
// body: a bent plate with n particles across comes out soft by an error of order 1/n. Exactness for quadratic fields
// removes that error and costs nothing per step where the weights are computed once, in the reference configuration.

#ifndef LMP_FSI_GRADIENT_H
#define LMP_FSI_GRADIENT_H

#include <cstddef>
#include <vector>

namespace LAMMPS_NS {
namespace FSI {

  template <int D> struct Gradient {
    static constexpr int NLINEAR = D, NQUADRATIC = D * (D + 3) / 2;
    enum Order { DEFICIENT, LINEAR, PARTIAL, QUADRATIC };
  };
  constexpr int packed_size(int n) { return n * (n + 1) / 2; }

  // basis about a particle, x = offset times 1/length: x, y, (z), then, for quadratic exactness, their products
  template <int D, int TERMS> inline void gradient_basis(const double *x, double *phi)
  {
    int k = 0;
    for (; k < D; k++) phi[k] = x[k];
    if constexpr (TERMS > D)
      for (int a = 0; a < D; a++)
        for (int b = a; b < D; b++) phi[k++] = x[a] * x[b];
  }

  // The first D rows C (D x TERMS) of the inverse of A = sum_j w_j phi_j phi_j^T (packed lower triangle, by rows):
  // G_ij = w_ij C phi_j/length. Terms that the neighbours cannot tell from lower ones are left out (PARTIAL; LINEAR if all
  // quadratic ones are, as in a body two particles thick); DEFICIENT, with C not set, where neighbours lie in a line (2D)
  // or plane (3D) or are too few.
  template <int D, int TERMS> inline typename Gradient<D>::Order gradient_coefficients(const double *A, double *C)
  {
    // part of a term's own square that must be independent of earlier terms. Nearly dependent terms give large weights of both
    // signs, which amplify particle noise and cost time step: a body two particles thick whose particles are 0.01 dx off their
    // lattice would have 1/40 of the usual one. Quadratic terms have 0.05 or more on lattices (Wendland, h = 1.3 to 2 dx; 0.03 for
    // quintic, h = 0.9 dx), 0.02 or less in such a body up to 0.1 dx.
    constexpr double TOLERANCE = 1.0e-4, QUADRATIC_TOLERANCE = 0.025;
    const auto at = [](int a, int b) { return packed_size(a) + b; };

    // A = L d L^T
    double L[TERMS][TERMS] = {}, d[TERMS];
    int dropped = 0;
    for (int a = 0; a < TERMS; a++) {
      for (int b = 0; b < a; b++) {
        if (d[b] == 0.0) continue;
        double s = A[at(a, b)];
        for (int k = 0; k < b; k++) s -= L[a][k] * d[k] * L[b][k];
        L[a][b] = s / d[b];
      }
      d[a] = A[at(a, a)];
      for (int k = 0; k < a; k++) d[a] -= L[a][k] * L[a][k] * d[k];
      if (!(d[a] > (a < D ? TOLERANCE : QUADRATIC_TOLERANCE) * A[at(a, a)])) {
        if (a < D) return Gradient<D>::DEFICIENT;
        d[a] = 0.0;
        for (int k = 0; k < a; k++) L[a][k] = 0.0;
        dropped++;
      }
    }
    for (int a = 0; a < D; a++) {
      double *const c = C + a * TERMS;
      for (int k = 0; k < TERMS; k++) {
        c[k] = (k == a) ? 1.0 : 0.0;
        for (int b = a; b < k; b++) c[k] -= L[k][b] * c[b];
      }
      for (int k = 0; k < TERMS; k++) c[k] = d[k] > 0.0 ? c[k] / d[k] : 0.0;
      for (int k = TERMS - 1; k >= 0; k--)
        for (int b = k + 1; b < TERMS; b++) c[k] -= L[b][k] * c[b];
    }
    if (dropped == TERMS - D) return Gradient<D>::LINEAR;
    return dropped ? Gradient<D>::PARTIAL : Gradient<D>::QUADRATIC;
  }

  // the weights of one particle, from all its neighbours at once
  template <int D> class GradientWeights : public Gradient<D> {
   public:
    using Order = typename Gradient<D>::Order;

    // G (n x D, 1/length) for n neighbours at X_j - X_i = dX (n x D) with weights w > 0; scale = length of the order of |dX|;
    // quadratic = false asks for linear exactness only. Returns what was reached.
    Order operator()(int n, const double *dX, const double *w, double scale, bool quadratic, double *G)
    {
      return quadratic ? solve<Gradient<D>::NQUADRATIC>(n, dX, w, 1.0 / scale, G)
                       : solve<Gradient<D>::NLINEAR>(n, dX, w, 1.0 / scale, G);
    }

   private:
    std::vector<double> basis;

    template <int TERMS> Order solve(int n, const double *dX, const double *w, double inv, double *G)
    {
      basis.resize((size_t) n * TERMS);
      double A[packed_size(TERMS)] = {}, C[D * TERMS];
      for (int j = 0; j < n; j++) {
        double x[D], *phi = &basis[(size_t) j * TERMS];
        for (int a = 0; a < D; a++) x[a] = dX[j * D + a] * inv;
        gradient_basis<D, TERMS>(x, phi);
        for (int a = 0, m = 0; a < TERMS; a++)
          for (int b = 0; b <= a; b++) A[m++] += w[j] * phi[a] * phi[b];
      }
      const Order order = gradient_coefficients<D, TERMS>(A, C);
      if (order == Gradient<D>::DEFICIENT) return order;
      for (int j = 0; j < n; j++)
        for (int a = 0; a < D; a++) {
          double s = 0.0;
          for (int k = 0; k < TERMS; k++) s += C[a * TERMS + k] * basis[(size_t) j * TERMS + k];
          G[j * D + a] = w[j] * s * inv;
        }
      return order;
    }
  };

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
