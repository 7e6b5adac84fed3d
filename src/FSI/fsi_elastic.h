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

// Laws of the total-Lagrangian solid: from the deformation gradient F (D x D, row-major, F_aB =
// dx_a/dX_B) the first Piola-Kirchhoff stress P = d(psi)/dF, the energy density psi per reference
// volume, and P_zz of plane strain. Lame's constants: lambda = K - 2G/3, mu = G.
//
// Of a nearly incompressible solid a part of the volumetric energy, k u(m), may be smoothed
// (fsi_volumetric.h). m is the law's measure of volumetric strain: volumetric_strain(), and dm/dF
// where there is room for it; volumetric_energy() is u, volumetric_slope() du/dm.

#ifndef LMP_FSI_ELASTIC_H
#define LMP_FSI_ELASTIC_H

#include "fsi_tensor.h"

#include <cmath>
#include <string_view>

namespace LAMMPS_NS {
namespace FSI {

  template <int D> struct PiolaStress {
    double P[D * D];
    double zz = 0.0;        // Cauchy stress normal to the plane times J (2D)
    double energy = 0.0;    // per reference volume
  };

  // What most laws declare of themselves (fsi_solid_laws.h): no plane stress, no rates, no history
  struct Hyperelastic {
    static constexpr bool PLANE_STRESS = false, BY_RATE = false;
    static constexpr std::string_view HISTORY = "";
  };

  // m = ln J, dm/dF = F^-T
  struct LogarithmOfVolume {
    template <int D> static double volumetric_strain(const double *F, double *derivative = nullptr)
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
    template <int D> static double volumetric_strain(const double *F, double *derivative = nullptr)
    {
      double m = 0.0;
      for (int n = 0; n < D * D; n++) {
        m += F[n] * F[n];
        if (derivative) derivative[n] = F[n];
      }
      return 0.5 * (m - D);
    }
    static double volumetric_energy(double m) { return 0.5 * m * m; }
    static double volumetric_slope(double m) { return m; }
    template <int D> PiolaStress<D> operator()(const double *F, const double * = nullptr) const
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
    static double volumetric_energy(double m) { return 0.5 * m * m; }
    static double volumetric_slope(double m) { return m; }
    template <int D> PiolaStress<D> operator()(const double *F, const double * = nullptr) const
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
    static double volumetric_energy(double m) { return std::expm1(m) - m; }
    static double volumetric_slope(double m) { return std::expm1(m); }
    template <int D> PiolaStress<D> operator()(const double *F, const double *deviator) const
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

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
