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

// Laws of fluids whose viscosity depends on the shear rate, sqrt(2 D:D), D the rate of strain: the
// one place that lists them. To add a law write it, and its name in Viscosity::Laws. A law declares
//   NAME          the word in a material's line
//   PARAMETERS    the numbers that follow it there, and whether each has to be above 0
// and finds the dynamic viscosity of a rate. It may be infinite at rest: limits then say how much.

#ifndef LMP_FSI_VISCOSITY_H
#define LMP_FSI_VISCOSITY_H

#include "fsi_pack.h"

#include <cmath>

namespace LAMMPS_NS::FSI {

struct LawParameter {
  const char *name;
  bool positive;
};

// K rate^(n-1) (Ostwald and de Waele)
struct PowerLaw {
  static constexpr const char *NAME = "power";
  static constexpr LawParameter PARAMETERS[] = {{"K", true}, {"n", true}};
  FSI_INLINE static double viscosity(double rate, const double *p)
  {
    return p[0] * std::pow(rate, p[1] - 1.0);
  }
};

// eta_inf + (eta_0 - eta_inf) (1 + (lambda rate)^a)^((n-1)/a) (Yasuda 1979; Carreau 1972: a = 2)
struct CarreauYasuda {
  static constexpr const char *NAME = "carreau/yasuda";
  static constexpr LawParameter PARAMETERS[] = {
      {"eta_0", true}, {"eta_inf", false}, {"lambda", true}, {"n", true}, {"a", true}};
  FSI_INLINE static double viscosity(double rate, const double *p)
  {
    const double thinned = std::pow(1.0 + std::pow(p[2] * rate, p[4]), (p[3] - 1.0) / p[4]);
    return p[1] + (p[0] - p[1]) * thinned;
  }
};

// tau_y (1 - exp(-m rate))/rate + K rate^(n-1): Herschel and Bulkley 1926, n = 1: Bingham, with
// the regularization of Papanastasiou, J. Rheol. 31 (1987) 385
struct HerschelBulkley {
  static constexpr const char *NAME = "herschel/bulkley";
  static constexpr LawParameter PARAMETERS[] = {
      {"tau_y", false}, {"K", true}, {"n", true}, {"m", true}};
  FSI_INLINE static double viscosity(double rate, const double *p)
  {
    const double yields = rate > 0.0 ? -std::expm1(-p[3] * rate) / rate : p[3];
    return p[0] * yields + p[1] * std::pow(rate, p[2] - 1.0);
  }
};

template <class... Law> struct ViscosityLaws {
  static constexpr int N = sizeof...(Law), MAX_PARAMETERS = 5;
  static constexpr const char *NAMES[] = {Law::NAME...};
  static constexpr const LawParameter *PARAMETERS[] = {Law::PARAMETERS...};
  static constexpr int COUNTS[] = {sizeof(Law::PARAMETERS) / sizeof(LawParameter)...};

  FSI_INLINE static double viscosity(int law, double rate, const double *p)
  {
    double found = 0.0;
    int k = 0;
    ((k++ == law ? (void) (found = Law::viscosity(rate, p)) : void()), ...);
    return found;
  }
};

// Of a fluid, trivially copyable.
struct Viscosity {
  using Laws = ViscosityLaws<PowerLaw, CarreauYasuda, HerschelBulkley>;
  int law = -1;    // -1: it is constant
  double parameter[Laws::MAX_PARAMETERS] = {}, least = 0.0, most = INFINITY;

  bool varies() const { return law >= 0; }
  FSI_INLINE double operator()(double rate) const
  {
    return std::fmin(std::fmax(Laws::viscosity(law, rate, parameter), least), most);
  }
  bool operator==(const Viscosity &b) const
  {
    bool same = law == b.law && least == b.least && most == b.most;
    for (int k = 0; k < Laws::MAX_PARAMETERS; k++) same &= parameter[k] == b.parameter[k];
    return same;
  }
};

}    // namespace LAMMPS_NS::FSI

#endif
