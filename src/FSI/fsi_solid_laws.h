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

// Laws of solids: stress from the deformation gradient, from rates and from a history.

#ifndef LMP_FSI_SOLID_LAWS_H
#define LMP_FSI_SOLID_LAWS_H

#include "fsi_tensor.h"

#include <cmath>
#include <initializer_list>
#include <string_view>

namespace LAMMPS_NS::FSI {

// Laws of the total-Lagrangian solid: from the deformation gradient F (D x D, row-major, F_aB =
// dx_a/dX_B) the first Piola-Kirchhoff stress P = d(psi)/dF, the energy density psi per reference
// volume, and P_zz of plane strain. Lame's constants: lambda = K - 2G/3, mu = G.
//
// Of a nearly incompressible solid a part of the volumetric energy, k u(m), may be smoothed
// (fsi_volumetric.h). m is the law's measure of volumetric strain: volumetric_strain(), and dm/dF
// where there is room for it; volumetric_energy() is u, volumetric_slope() du/dm.

template <int D> struct PiolaStress {
  double P[D * D];
  double zz = 0.0;        // Cauchy stress normal to the plane times J (2D)
  double energy = 0.0;    // per reference volume
};

// What most laws declare of themselves (fsi_law_list.h): no plane stress, no rates, no history
struct Hyperelastic {
  static constexpr bool PLANE_STRESS = false, BY_RATE = false;
  static constexpr std::string_view HISTORY = "";
  FSI_INLINE static double volumetric_energy(double m) { return 0.5 * m * m; }
  FSI_INLINE static double volumetric_slope(double m) { return m; }
};

// m = ln J, dm/dF = F^-T
struct LogarithmOfVolume {
  template <int D>
  FSI_INLINE static double volumetric_strain(const double *F, double *derivative = nullptr)
  {
    const double J = determinant<D>(F);
    if (derivative) {
      cofactor<D>(F, derivative);
      for (int n = 0; n < D * D; n++) derivative[n] /= J;
    }
    return std::log(J);
  }
};

// St. Venant-Kirchhoff: S = lambda tr(E) I + 2 mu E, E = (F^T F - I)/2, P = F S. Plane stress:
// lambda* = 2 lambda mu/(lambda + 2 mu)
struct StVenantKirchhoff : Hyperelastic {
  static constexpr char NAME[] = "svk", TITLE[] = "St. Venant-Kirchhoff";
  static constexpr bool PLANE_STRESS = true;
  double lambda, mu;
  bool plane_stress;
  StVenantKirchhoff(double bulk, double shear, bool plane_stress_in) :
      lambda(bulk - 2.0 / 3.0 * shear), mu(shear), plane_stress(plane_stress_in)
  {
    if (plane_stress) lambda = 2.0 * lambda * mu / (lambda + 2.0 * mu);
  }
  // m = tr E, dm/dF = F
  template <int D>
  FSI_INLINE static double volumetric_strain(const double *F, double *derivative = nullptr)
  {
    double m = 0.0;
    for (int n = 0; n < D * D; n++) {
      m += F[n] * F[n];
      if (derivative) derivative[n] = F[n];
    }
    return 0.5 * (m - D);
  }
  template <int D>
  FSI_INLINE PiolaStress<D> operator()(const double *F, const double * = nullptr) const
  {
    Sym<D> E;
    for (int a = 0; a < D; a++)
      for (int b = a; b < D; b++) {
        double s = (a == b) ? -1.0 : 0.0;
        for (int k = 0; k < D; k++) s += F[k * D + a] * F[k * D + b];
        E(a, b) = 0.5 * s;
      }
    PiolaStress<D> r;
    const double tr = E.trace();
    r.energy = 0.5 * lambda * tr * tr + mu * E.squared();
    if (D == 2 && !plane_stress) r.zz = lambda * tr;
    E *= 2.0 * mu;
    E += Sym<D>::identity(lambda * tr);
    for (int a = 0; a < D; a++) {
      double row[D];
      dot<D>(E, F + a * D, row);
      for (int b = 0; b < D; b++) r.P[a * D + b] = row[b];
    }
    return r;
  }
};

// compressible neo-Hookean: psi = mu/2 (tr(F^T F) - 3) - mu ln J + lambda/2 (ln J)^2
struct NeoHookean : Hyperelastic, LogarithmOfVolume {
  static constexpr char NAME[] = "neohookean", TITLE[] = "neo-Hookean";
  double lambda, mu;
  NeoHookean(double bulk, double shear, bool) : lambda(bulk - 2.0 / 3.0 * shear), mu(shear) {}
  template <int D>
  FSI_INLINE PiolaStress<D> operator()(const double *F, const double * = nullptr) const
  {
    PiolaStress<D> r;
    double C[D * D], trace = 0.0;
    cofactor<D>(F, C);
    const double J = determinant<D>(F), lnJ = std::log(J), k = (lambda * lnJ - mu) / J;
    for (int n = 0; n < D * D; n++) {
      r.P[n] = mu * F[n] + k * C[n];
      trace += F[n] * F[n];
    }
    r.zz = D == 2 ? lambda * lnJ : 0.0;
    r.energy = 0.5 * mu * (trace - D) - mu * lnJ + 0.5 * lambda * lnJ * lnJ;
    return r;
  }
};

// hypoelastic, as the updated-Lagrangian solid: sigma = -p I + S with S from fix fsi/stress and
// p = K (1/J - 1), P = J sigma F^-T
struct HypoElastic : Hyperelastic, LogarithmOfVolume {
  static constexpr char NAME[] = "hypo", TITLE[] = "hypoelastic";
  static constexpr bool PLANE_STRESS = true, BY_RATE = true;
  double bulk, shear;
  bool plane_stress;
  HypoElastic(double bulk_in, double shear_in, bool plane_stress_in) :
      bulk(bulk_in), shear(shear_in), plane_stress(plane_stress_in)
  {
  }
  FSI_INLINE static double volumetric_energy(double m) { return std::expm1(m) - m; }
  FSI_INLINE static double volumetric_slope(double m) { return std::expm1(m); }
  template <int D>
  FSI_INLINE PiolaStress<D> operator()(const double *F, const double *deviator) const
  {
    PiolaStress<D> r;
    double C[D * D];
    cofactor<D>(F, C);
    const double J = determinant<D>(F), p = bulk * (1.0 / J - 1.0);
    auto sigma = Sym<D>::load(deviator);
    double ss = sigma.squared();
    if (D == 2 && !plane_stress) {
      const double zz = -(deviator[0] + deviator[1]);
      ss += zz * zz;
      r.zz = J * (zz - p);
    }
    r.energy = bulk * (J - 1.0 - std::log(J)) + J * ss / (4.0 * shear);
    sigma += Sym<D>::identity(-p);
    for (int b = 0; b < D; b++) {
      double column[D], out[D];
      for (int a = 0; a < D; a++) column[a] = C[a * D + b];
      dot<D>(sigma, column, out);
      for (int a = 0; a < D; a++) r.P[a * D + b] = out[a];
    }
    return r;
  }
};

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

struct ViscoElastic : Hyperelastic, LogarithmOfVolume {
  static constexpr char NAME[] = "viscoelastic", TITLE[] = "viscoelastic (neo-Hookean, Prony)";
  static constexpr std::string_view HISTORY = "viscoelastic stress";

  static constexpr int MAX_TERMS = 8;
  struct Term {
    double g = 0.0, tau = 0.0;
  };
  double bulk, mu;
  int nterms = 0;
  Term terms[MAX_TERMS];
  ViscoElastic(double bulk_in, double shear, std::initializer_list<Term> of = {}) :
      bulk(bulk_in), mu(shear)
  {
    for (const Term &term : of) terms[nterms++] = term;
  }

  // Components of a symmetric tensor with the axis normal to the plane: xx yy xy zz in 2D, the
  // order of Sym<3> in 3D.
  template <int D> static constexpr int NS = D == 2 ? 4 : 6;
  template <int D> static constexpr bool diagonal(int c) { return D == 2 ? c != 2 : c < 3; }
  template <int D> FSI_INLINE static double contract(const double *a, const double *b)
  {
    double sum = 0.0;
    for (int c = 0; c < NS<D>; c++) sum += (diagonal<D>(c) ? 1.0 : 2.0) * a[c] * b[c];
    return sum;
  }
  // X_k of a q_k
  template <int D> FSI_INLINE double stored(const double *q, double g) const
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
  template <int D> FSI_INLINE static void square(const double *M, double *out)
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
    return dim == 2 ? FIRST<2> + nterms * NS<2> : FIRST<3> + nterms * NS<3>;
  }

  // how each term goes on: q' = decay q + now s' + before s
  struct Factors {
    double decay[MAX_TERMS], now[MAX_TERMS], before[MAX_TERMS];
  };
  Factors factors(double dt) const
  {
    Factors f;
    for (int k = 0; k < nterms; k++) {
      const double x = dt / terms[k].tau, mean = x > 0.0 ? -std::expm1(-x) / x : 1.0;
      f.decay[k] = std::exp(-x);
      f.now[k] = terms[k].g * (1.0 - mean);
      f.before[k] = terms[k].g * (mean - f.decay[k]);
    }
    return f;
  }

  // The history after a step, at whose end the deformation gradient is F. Returns the energy per
  // reference volume that is dissipated, to second order: forces take the new q at the end of a
  // step, so that q changes at the mean strain. A particle that is turned inside out keeps its
  // history.
  template <int D> double advance(const double *F, const Factors &f, double *history) const
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
    for (int k = 0; k < nterms; k++, qk += NS<D>) {
      for (int c = 0; c < NS<D>; c++) {
        qk[c] = f.decay[k] * qk[c] + f.now[k] * s[c] + f.before[k] * last[c];
        q[c] += qk[c];
      }
      energy += stored<D>(qk, terms[k].g);
    }
    for (int c = 0; c < NS<D>; c++) last[c] = s[c];
    history[ENERGY<D>] = energy;
    return before - energy + contract<D>(q, mean);
  }

  template <int D>
  FSI_INLINE PiolaStress<D> operator()(const double *F, const double *history) const
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

// Jaumann rate, paper eq. 3.
// Deviatoric stress s^{n-1/2} -> s^{n+1/2} with the velocity gradient L (row-major D x D) of time
// n, G = shear:
//   ds/dt = 2G dev(e) + w s - s w,  e, w = symmetric and antisymmetric part of L,
// as s' = Q (Q s Q^T + 2G dt dev(e)) Q^T with Q = exp(dt w/2): second order in dt, and exact for
// rigid rotation. The deviator takes away a third of the trace in 3D and in plane strain, half of
// it in plane stress.
template <int D>
FSI_INLINE void jaumann_update(Sym<D> &s, const double *L, double dt, double shear,
                               bool plane_stress)
{
  double Q[D * D];
  rotation<D>(L, 0.5 * dt, Q);
  Sym<D> de = symmetric<D>(L);
  const double mean = de.trace() / (plane_stress ? 2.0 : 3.0);
  for (int a = 0; a < D; a++) de.c[a] -= mean;
  de *= 2.0 * shear * dt;
  s = rotate<D>(s, Q);
  s += de;
  s = rotate<D>(s, Q);
}

// J2 plasticity of hypoelastic solids: radial return of the deviatoric stress to the von Mises
// surface (Wilkins 1964; Simo and Hughes 1998, sec. 3.3.1), with linear isotropic hardening:
// sigma_y = yield + hardening * (equivalent plastic strain).
// s: elastic trial deviator, of plane strain in 2D, brought back to the surface; strain:
// equivalent plastic strain, which grows. Returns the plastic work per volume.
template <int D>
FSI_INLINE double radial_return(Sym<D> &s, double &strain, double shear, double yield,
                                double hardening)
{
  double ss = s.squared();
  if (D == 2) ss += (s.c[0] + s.c[1]) * (s.c[0] + s.c[1]);    // s_zz
  const double trial = std::sqrt(1.5 * ss), limit = yield + hardening * strain;
  if (trial <= limit) return 0.0;
  const double d = (trial - limit) / (3.0 * shear + hardening);
  s *= 1.0 - 3.0 * shear * d / trial;
  strain += d;
  return (limit + hardening * d) * d;
}

}    // namespace LAMMPS_NS::FSI

#endif
