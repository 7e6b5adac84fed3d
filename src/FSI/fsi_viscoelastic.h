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

// Rubber that relaxes: neo-Hookean, with a Prony series in shear. Finite-strain linear
// viscoelasticity: Simo, Comput. Methods Appl. Mech. Engrg. 60, 153 (1987); Simo and Hughes,
// Computational Inelasticity (1998), sec. 10.3; Holzapfel and Gasser, Comput. Methods Appl. Mech.
// Engrg. 190, 4379 (2001).
//   psi = K/2 (ln J)^2 + mu/2 (tr Cb - 3) - q:(Cb - I)/2 + sum_k X_k,  q = sum_k q_k
//   X_k = 3/2 g_k mu (1 - det(I - q_k/(g_k mu))^(1/3)) - tr(q_k)/2
//   Cb = J^(-2/3) C,  S = 2 d(psi)/dC
//   tau_k dq_k/dt + q_k = g_k s,  s = mu DEV[I],  DEV[A] = A - (C:A) C^-1/3
// K, mu: the instantaneous moduli [pressure]; g_k: part of mu that relaxes in the time tau_k. q_k
// is what has relaxed of the second Piola-Kirchhoff stress, so that at small strain
//   G(t) = mu (1 - sum_k g_k (1 - exp(-t/tau_k))).
// A step dt is exact where s changes at a constant rate (Taylor, Pister and Goudreau, Int. J.
// Numer. Meth. Eng. 2, 45 (1970)). What psi loses in it, at constant F, is dissipated. X_k is the
// Legendre transform of the part g_k of the neo-Hookean energy: psi is least where q_k = g_k s.
// It is convex, so that dissipation is not negative at any strain. At small strain X_k is
// q_k:q_k/(4 g_k mu).

#ifndef LMP_FSI_VISCOELASTIC_H
#define LMP_FSI_VISCOELASTIC_H

#include "fsi_elastic.h"
#include "fsi_tensor.h"

#include <cmath>
#include <vector>

namespace LAMMPS_NS {
namespace FSI {

  struct ViscoElastic : Hyperelastic, LogarithmOfVolume {
    static constexpr char NAME[] = "viscoelastic", TITLE[] = "viscoelastic (neo-Hookean, Prony)";
    static constexpr std::string_view HISTORY = "viscoelastic stress";

    struct Term {
      double g = 0.0, tau = 0.0;
    };
    double bulk, mu;
    std::vector<Term> terms;
    ViscoElastic(double bulk_in, double shear, const std::vector<Term> &terms_in) :
        bulk(bulk_in), mu(shear), terms(terms_in)
    {
    }

    // Components of a symmetric tensor with the axis normal to the plane: xx yy xy zz in 2D, the
    // order of Sym<3> in 3D.
    template <int D> static constexpr int NS = D == 2 ? 4 : 6;
    template <int D> static constexpr bool diagonal(int c) { return D == 2 ? c != 2 : c < 3; }
    template <int D> static double contract(const double *a, const double *b)
    {
      double sum = 0.0;
      for (int c = 0; c < NS<D>; c++) sum += (diagonal<D>(c) ? 1.0 : 2.0) * a[c] * b[c];
      return sum;
    }
    // X_k of a q_k
    template <int D> double stored(const double *q, double g) const
    {
      const double k = 1.0 / (g * mu);
      double A[6], trace = 0.0;
      for (int c = 0; c < NS<D>; c++) {
        A[c] = (diagonal<D>(c) ? 1.0 : 0.0) - k * q[c];
        if (diagonal<D>(c)) trace += q[c];
      }
      double det;
      if constexpr (D == 2)
        det = (A[0] * A[1] - A[2] * A[2]) * A[3];
      else
        det = A[0] * (A[1] * A[2] - A[5] * A[5]) - A[3] * (A[3] * A[2] - A[5] * A[4]) +
            A[4] * (A[3] * A[5] - A[1] * A[4]);
      return 1.5 * g * mu * (1.0 - std::cbrt(det)) - 0.5 * trace;
    }
    // M^T M of a matrix; 1 normal to the plane
    template <int D> static void square(const double *M, double *out)
    {
      for (int a = 0; a < D; a++)
        for (int b = a; b < D; b++) {
          double &sum = out[Sym<D>::id(a, b)] = 0.0;
          for (int k = 0; k < D; k++) sum += M[k * D + a] * M[k * D + b];
        }
      if (D == 2) out[3] = 1.0;
    }

    // History of a particle: q; sum of all X_k; s and (Cb - I)/2 of the last step; each q_k.
    template <int D> static constexpr int ENERGY = NS<D>;
    template <int D> static constexpr int LAST = NS<D> + 1;
    template <int D> static constexpr int FIRST = 3 * NS<D> + 1;
    int columns(int dim) const
    {
      const int n = terms.size();
      return dim == 2 ? FIRST<2> + n * NS<2> : FIRST<3> + n * NS<3>;
    }

    // how a term goes on: q' = decay q + now s' + before s
    struct Factors {
      double decay, now, before;
    };
    std::vector<Factors> factors(double dt) const
    {
      std::vector<Factors> all;
      for (const Term &term : terms) {
        const double x = dt / term.tau, decay = std::exp(-x), mean = -std::expm1(-x) / x;
        all.push_back({decay, term.g * (1.0 - mean), term.g * (mean - decay)});
      }
      return all;
    }

    // The history after a step, at whose end the deformation gradient is F. Returns the energy per
    // reference volume that is dissipated, to second order: forces take the new q at the end of a
    // step, so that q changes at the mean strain. A particle that is turned inside out keeps its
    // history.
    template <int D>
    double advance(const double *F, const std::vector<Factors> &factors, double *history) const
    {
      const double J = determinant<D>(F);
      if (!(J > 0.0)) return 0.0;
      double cof[D * D], C[NS<D>], inverse[NS<D>], mean[NS<D>], s[NS<D>];
      double *const q = history, *const last = history + LAST<D>, *const strain = last + NS<D>;
      double *qk = history + FIRST<D>;
      cofactor<D>(F, cof);
      square<D>(F, C);
      square<D>(cof, inverse);
      double third = 0.0;
      const double scale = 1.0 / std::cbrt(J * J);
      for (int c = 0; c < NS<D>; c++)
        if (diagonal<D>(c)) third += C[c] / 3.0;
      for (int c = 0; c < NS<D>; c++) {
        const double one = diagonal<D>(c) ? 1.0 : 0.0, inv = D == 2 && c == 3 ? 1.0 : 1.0 / (J * J);
        const double now = 0.5 * (scale * C[c] - one);
        mean[c] = 0.5 * (strain[c] + now);
        strain[c] = now;
        s[c] = mu * (one - third * inverse[c] * inv);
      }
      const double before = history[ENERGY<D>] - contract<D>(q, mean);
      double energy = 0.0;
      for (int c = 0; c < NS<D>; c++) q[c] = 0.0;
      for (size_t k = 0; k < terms.size(); k++, qk += NS<D>) {
        const Factors &f = factors[k];
        for (int c = 0; c < NS<D>; c++) {
          qk[c] = f.decay * qk[c] + f.now * s[c] + f.before * last[c];
          q[c] += qk[c];
        }
        energy += stored<D>(qk, terms[k].g);
      }
      for (int c = 0; c < NS<D>; c++) last[c] = s[c];
      history[ENERGY<D>] = energy;
      return before - energy + contract<D>(q, mean);
    }

    static double volumetric_energy(double m) { return 0.5 * m * m; }
    static double volumetric_slope(double m) { return m; }
    template <int D> PiolaStress<D> operator()(const double *F, const double *history) const
    {
      PiolaStress<D> r;
      double cof[D * D], C[NS<D>], A[NS<D>];
      cofactor<D>(F, cof);
      square<D>(F, C);
      const double J = determinant<D>(F), lnJ = std::log(J), scale = 1.0 / std::cbrt(J * J);
      double trace = 0.0, of_q = 0.0;
      for (int c = 0; c < NS<D>; c++) {
        A[c] = -history[c];
        if (!diagonal<D>(c)) continue;
        trace += C[c];
        of_q += history[c];
        A[c] += mu;
      }
      const double third = contract<D>(A, C) / 3.0, k = (bulk * lnJ - scale * third) / J;
      for (int a = 0; a < D; a++)
        for (int b = 0; b < D; b++) {
          double sum = 0.0;
          for (int c = 0; c < D; c++) sum += F[a * D + c] * A[Sym<D>::id(c, b)];
          r.P[a * D + b] = scale * sum + k * cof[a * D + b];
        }
      if (D == 2) r.zz = bulk * lnJ + scale * (A[3] - third);
      r.energy = 0.5 * bulk * lnJ * lnJ + 0.5 * mu * (scale * trace - 3.0) +
          0.5 * (of_q - scale * contract<D>(history, C)) + history[ENERGY<D>];
      return r;
    }
  };

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
