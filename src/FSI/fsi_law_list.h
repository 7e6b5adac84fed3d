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

// The laws of total-Lagrangian solids, keyword law of pair_style fsi/solid/tl: the one place that
// lists them. To add a law write it (fsi_solid_laws.h), its name in SolidLaws and, where it has
// parameters beyond two moduli, make_law(). Each law declares, beside stress and volumetric strain,
//   NAME, TITLE     the word of the keyword; what it is in words
//   PLANE_STRESS    whether it has a form for plane stress
//   BY_RATE         its stress is that of fix fsi/stress, which velocity gradients change; else its
//                   energy is a function of the deformation gradient and of its history
//   HISTORY         what its history is called, empty: none. It has columns(dim) numbers of each
//                   particle, which begin with 0 (fix_fsi_stress.h), and takes a step with
//                   factors(dt), found once, and advance<D>(F, factors, history) of each particle,
//                   which returns the dissipated energy per reference volume.

#ifndef LMP_FSI_LAW_LIST_H
#define LMP_FSI_LAW_LIST_H

#include "fsi_material.h"
#include "fsi_solid_laws.h"

#include <algorithm>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

namespace LAMMPS_NS::FSI {

// bulk: modulus without what is smoothed (fsi_volumetric.h)
template <class L> L make_law(const Material &m, double bulk, bool plane_stress)
{
  return L(bulk, m.shear_modulus(), plane_stress);
}
template <> inline HypoElastic make_law(const Material &m, double bulk, bool plane_stress)
{
  return HypoElastic(plane_stress ? m.plane_stress_modulus() : bulk, m.shear_modulus(),
                     plane_stress);
}
template <> inline ViscoElastic make_law(const Material &m, double bulk, bool)
{
  static_assert(Material::MAX_PRONY <= ViscoElastic::MAX_TERMS, "");
  ViscoElastic law(bulk, m.shear_modulus());
  for (int k = 0; k < m.nprony; k++) law.terms[law.nterms++] = {m.prony[k].g, m.prony[k].tau};
  return law;
}

// of a law, as it declares it
struct LawFacts {
  const char *name, *title;
  bool plane_stress, by_rate;
  std::string_view history;
};

template <class... Law> class LawsOf {
 public:
  static constexpr LawFacts all[] = {
      {Law::NAME, Law::TITLE, Law::PLANE_STRESS, Law::BY_RATE, Law::HISTORY}...};
  static std::vector<std::string> names() { return {Law::NAME...}; }

  // the law of that number in names(); then it, per type, for materials
  void choose(int number)
  {
    const Lists none[] = {std::vector<Law>()...};
    of_type = none[number];
  }
  const LawFacts &facts() const { return all[of_type.index()]; }
  void make(const std::vector<Material> &materials, const std::vector<double> &smoothed,
            bool plane_stress)
  {
    const auto fill = [&](auto &laws) {
      using L = typename std::decay_t<decltype(laws)>::value_type;
      laws.clear();
      for (size_t t = 0; t < materials.size(); t++) {
        Material m = {};
        m.young = 1.0;    // of what is no solid: anything
        if (materials[t].species == SOLID) m = materials[t];
        const double less = smoothed.empty() ? 0.0 : smoothed[t];
        laws.push_back(make_law<L>(m, m.bulk_modulus() - less, plane_stress));
      }
    };
    std::visit(fill, of_type);
  }

  // call(laws per type): what it returns
  template <class Call> auto operator()(Call call) const
  {
    return std::visit(
        [&](const auto &laws) {
          return call(laws.data());
        },
        of_type);
  }

  int columns(int dim) const    // of the history
  {
    int most = 0;
    const auto find = [&](const auto &laws) {
      using L = typename std::decay_t<decltype(laws)>::value_type;
      if constexpr (!L::HISTORY.empty())
        for (const L &law : laws) most = std::max(most, law.columns(dim));
    };
    std::visit(find, of_type);
    return most;
  }

 private:
  using Lists = std::variant<std::vector<Law>...>;
  Lists of_type;
};

class SolidLaws : public LawsOf<StVenantKirchhoff, NeoHookean, HypoElastic, ViscoElastic> {};

}    // namespace LAMMPS_NS::FSI

#endif
