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

  template <int D> class GradientWeights {
   public:
    static constexpr int NLINEAR = D, NQUADRATIC = D * (D + 3) / 2;
    enum Order { DEFICIENT, LINEAR, PARTIAL, QUADRATIC };

    // G (n x D, 1/length) for n neighbours at X_j - X_i = dX (n x D) with weights w > 0; scale = length of the order of |dX|;
    // quadratic = false asks for linear exactness only. Returns what was reached: quadratic terms that the neighbours cannot
    // tell from lower ones are left out (PARTIAL; LINEAR if all of them are, as in a body two particles thick);
    // DEFICIENT, with G not set, where neighbours lie in a line (2D) or plane (3D) or are too few.
    Order operator()(int n, const double *dX, const double *w, double scale, bool quadratic, double *G)
    {
      const int terms = quadratic ? NQUADRATIC : NLINEAR;
      const double inv = 1.0 / scale;
      basis.resize((size_t) n * terms);
      double A[NQUADRATIC][NQUADRATIC] = {};
      for (int j = 0; j < n; j++) {
        double *phi = basis.data() + (size_t) j * terms;
        int k = 0;
        for (int a = 0; a < D; a++) phi[k++] = dX[j * D + a] * inv;
        if (quadratic)
          for (int a = 0; a < D; a++)
            for (int b = a; b < D; b++) phi[k++] = phi[a] * phi[b];
        for (int a = 0; a < terms; a++)
          for (int b = 0; b <= a; b++) A[a][b] += w[j] * phi[a] * phi[b];
      }

      // A = L d L^T; a term whose pivot says that it depends on those before is left out
      double L[NQUADRATIC][NQUADRATIC] = {}, d[NQUADRATIC];
      int dropped = 0;
      for (int a = 0; a < terms; a++) {
        for (int b = 0; b < a; b++) {
          if (d[b] == 0.0) continue;
          double s = A[a][b];
          for (int k = 0; k < b; k++) s -= L[a][k] * d[k] * L[b][k];
          L[a][b] = s / d[b];
        }
        d[a] = A[a][a];
        for (int k = 0; k < a; k++) d[a] -= L[a][k] * L[a][k] * d[k];
        if (!(d[a] > TOLERANCE * A[a][a])) {
          if (a < D) return DEFICIENT;
          d[a] = 0.0;
          for (int k = 0; k < a; k++) L[a][k] = 0.0;
          dropped++;
        }
      }

      // rows 0 .. D-1 of the inverse, times the basis
      for (int a = 0; a < D; a++) {
        double c[NQUADRATIC] = {};
        c[a] = 1.0;
        for (int k = a + 1; k < terms; k++)
          for (int b = a; b < k; b++) c[k] -= L[k][b] * c[b];
        for (int k = 0; k < terms; k++) c[k] = d[k] > 0.0 ? c[k] / d[k] : 0.0;
        for (int k = terms - 1; k >= 0; k--)
          for (int b = k + 1; b < terms; b++) c[k] -= L[b][k] * c[b];
        for (int j = 0; j < n; j++) {
          const double *phi = basis.data() + (size_t) j * terms;
          double s = 0.0;
          for (int k = 0; k < terms; k++) s += c[k] * phi[k];
          G[j * D + a] = w[j] * s * inv;
        }
      }
      if (!quadratic || dropped == NQUADRATIC - NLINEAR) return LINEAR;
      return dropped ? PARTIAL : QUADRATIC;
    }

   private:
    // part of a term's own square that must be independent of earlier terms. Round-off would allow 1e-12; nearly dependent
    // terms give large weights of both signs, which cost time step and amplify particle noise.
    static constexpr double TOLERANCE = 1.0e-4;
    std::vector<double> basis;
  };

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
