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

#include "fsi_material.h"

#include "comm.h"
#include "error.h"
#include "fsi_keywords.h"
#include "lammps.h"
#include "pointers.h"
#include "potential_file_reader.h"
#include "tokenizer.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <set>

using namespace LAMMPS_NS;
using namespace FSI;

double State::density(double p) const
{
  if (tait) return rho0 * std::pow(1.0 + 7.0 * (p - p0) / (rho0 * csq), 1.0 / 7.0);
  return rho0 + (p - p0) / csq;
}

// below the density at which the floor is reached p stays at the floor
double State::energy(double rho) const
{
  const auto integral = [this](double r) {
    const double s = r / rho0;
    if (tait) {
      const double b = rho0 * csq / 7.0;
      return b / rho0 * ((std::pow(s, 6) - 1.0) / 6.0 + 1.0 / s - 1.0) +
          p0 / rho0 * (1.0 - 1.0 / s);
    }
    return csq * (std::log(s) + 1.0 / s - 1.0) + p0 / rho0 * (1.0 - 1.0 / s);
  };
  if (floor > -1.0e299) {
    const double low = density(floor);
    if (rho < low) return integral(low) + floor * (1.0 / low - 1.0 / rho);
  }
  return integral(rho);
}

namespace {

const char *const SPECIES[] = {"NULL", "fluid", "solid", "wall"};
const char PRONY[] = "prony";    // of a solid: g tau, as often as wanted
// of a fluid whose viscosity varies: the least and the largest
const char LIMITS[] = "viscosity/limits";

// what follows the name and the species
const struct Property {
  const char *name;
  double Material::*value;
  std::vector<int> species;    // which have it
  bool needed;
  Range range;
} properties[] = {{"rho", &Material::rho0, {FLUID, SOLID, RIGID}, true, Range::above(0.0)},
                  {"viscosity", &Material::viscosity, {FLUID}, false, Range::from(0.0)},
                  {"sound", &Material::sound, {FLUID}, false, Range::from(0.0)},
                  {"young", &Material::young, {SOLID}, true, Range::above(0.0)},
                  {"poisson", &Material::poisson, {SOLID}, true, Range::inside(-1.0, 0.5)},
                  {"yield", &Material::yield, {SOLID}, false, Range::from(0.0)},
                  {"hardening", &Material::hardening, {SOLID}, false, Range::from(0.0)}};

// "" at the end of a line
std::string next(ValueTokenizer &values)
{
  return values.has_next() ? values.next_string() : "";
}

bool has(int species, const Property &p)
{
  return std::find(p.species.begin(), p.species.end(), species) != p.species.end();
}

// gives free functions the LAMMPS pointers that error->one() and friends need
class MaterialReader : protected Pointers {
 public:
  explicit MaterialReader(LAMMPS *lmp) : Pointers(lmp) {}

  std::vector<Material> read(const std::string &file)
  {
    std::vector<Material> all;
    if (file == SPECIES[NONE]) return all;
    if (utils::get_potential_file_path(file).empty())
      error->one(FLERR,
                 "Cannot open material file {}: it is neither in the working folder nor in those "
                 "of the environment variable LAMMPS_POTENTIALS; type  export "
                 "LAMMPS_POTENTIALS=<folder of the .fsi files>",
                 file);
    PotentialFileReader reader(lmp, file, "fsi material");
    while (char *line = reader.next_line()) all.push_back(parse("in file " + file, line));
    return all;
  }

  std::vector<Material> find(const std::string &file, const std::vector<std::string> &names,
                             const std::map<std::string, std::string> &given)
  {
    const auto all = read(file);
    std::vector<Material> found;
    for (const auto &name : names) {
      Material m = {};
      if (const auto it = given.find(name); it != given.end())
        m = parse("of command fsi/material", it->second.c_str());
      else if (name != SPECIES[NONE]) {
        int matches = 0;
        for (const auto &a : all)
          if (name == a.name) {
            m = a;
            matches++;
          }
        if (matches == 0) not_found(name, file, all, given);
        if (matches > 1)
          error->one(FLERR, "Material {} stands {} times in file {}", name, matches, file);
      }
      found.push_back(m);
    }
    return found;
  }

  void not_found(const std::string &name, const std::string &file, const std::vector<Material> &all,
                 const std::map<std::string, std::string> &given)
  {
    std::string known, by_command;
    for (const auto &a : all) known += std::string(" ") + a.name;
    for (const auto &g : given) by_command += " " + g.first;
    if (by_command.empty()) by_command = " none";
    if (file == SPECIES[NONE])
      error->one(FLERR, "Material {} was not given by command fsi/material, which has given:{}",
                 name, by_command);
    error->one(FLERR,
               "Material {} not found in file {}, which has:{}; command fsi/material has given:{}",
               name, file, known, by_command);
  }

  Material parse(const std::string &where, const char *line)
  {
    Material m = {};
    try {
      ValueTokenizer values(line);
      const std::string name = values.next_string();
      if (name.size() >= sizeof(m.name))
        error->one(FLERR, "Material name {} {} is longer than {} characters", name, where,
                   sizeof(m.name) - 1);
      strcpy(m.name, name.c_str());

      const std::string species = values.next_string();
      m.species = std::find(std::begin(SPECIES), std::end(SPECIES), species) - std::begin(SPECIES);
      if (m.species == NONE || m.species > RIGID)
        error->one(FLERR, "Material {} {} is of unknown species {}: expected fluid, solid or wall",
                   name, where, species);

      std::string known;
      std::set<std::string> given;
      for (const auto &p : properties)
        if (has(m.species, p)) known += (known.empty() ? "" : ", ") + std::string(p.name);
      if (m.species == SOLID) known += std::string(", ") + PRONY;
      if (m.species == FLUID)
        for (const char *const law : Viscosity::Laws::NAMES) known += std::string(", ") + law;
      if (m.species == FLUID) known += std::string(", ") + LIMITS;
      for (std::string key = next(values), after; !key.empty(); key = after) {
        const std::string what = fmt::format("Material {} {}: {}", name, where, key);
        if (key == PRONY && m.species == SOLID) {
          after = parse_prony(what, values, m);
          continue;
        }
        if (m.species == FLUID && parse_law(what, key, values, m.law)) {
          after = next(values);
          continue;
        }
        const auto p =
            std::find_if(std::begin(properties), std::end(properties), [&](const Property &q) {
              return key == q.name && has(m.species, q);
            });
        if (p == std::end(properties))
          error->one(FLERR, "Unknown keyword {} of {} {} {}: expected {}", key, species, name,
                     where, known);
        m.*p->value = numeric(lmp, what, values.next_string(), p->range, true);
        given.insert(key);
        after = next(values);
      }
      for (const auto &p : properties)
        if (p.needed && has(m.species, p) && !given.count(p.name))
          error->one(FLERR, "Material {} {} needs {} {}", name, where, p.name, p.range.text());
      if (m.law.varies() || std::isfinite(m.law.most))
        end_law(fmt::format("Material {} {}", name, where), m);
    } catch (TokenizerException &e) {
      error->one(FLERR, "Cannot read a line of materials {}: {}", where, e.what());
    }
    return m;
  }

  // is it the key of a law of viscosity, or of its limits?
  bool parse_law(const std::string &what, const std::string &key, ValueTokenizer &values,
                 Viscosity &law)
  {
    using Laws = Viscosity::Laws;
    const auto number = [&](const char *of, const Range &range) {
      return numeric(lmp, what + " " + of, next(values), range, true);
    };
    if (key == LIMITS) {
      law.least = number("least", Range::from(0.0));
      law.most = number("largest", Range::above(law.least));
      return true;
    }
    const int found =
        std::find(std::begin(Laws::NAMES), std::end(Laws::NAMES), key) - std::begin(Laws::NAMES);
    if (found == Laws::N) return false;
    if (law.varies())
      error->one(FLERR, "{}: expected one law of viscosity, after {}", what, Laws::NAMES[law.law]);
    law.law = found;
    for (int k = 0; k < Laws::COUNTS[found]; k++) {
      const LawParameter &p = Laws::PARAMETERS[found][k];
      law.parameter[k] = number(p.name, p.positive ? Range::above(0.0) : Range::from(0.0));
    }
    return true;
  }

  void end_law(const std::string &what, Material &m)
  {
    if (!m.law.varies()) error->one(FLERR, "{}: {} expected beside a law", what, LIMITS);
    const char *const name = Viscosity::Laws::NAMES[m.law.law];
    if (m.viscosity > 0.0) error->one(FLERR, "{}: expected viscosity or {}, not both", what, name);
    m.viscosity = m.law(0.0);
    if (!std::isfinite(m.viscosity))
      error->one(FLERR, "{}: {} has no bound at rest: expected {} least largest", what, name,
                 LIMITS);
  }

  // pairs of numbers up to the next keyword, which it returns; "" at the end
  std::string parse_prony(const std::string &what, ValueTokenizer &values, Material &m)
  {
    double sum = 0.0;
    std::string word = next(values);
    m.nprony = 0;
    do {
      if (m.nprony == Material::MAX_PRONY)
        error->one(FLERR, "{} has more than {} terms", what, Material::MAX_PRONY);
      auto &term = m.prony[m.nprony++];
      term.g = numeric(lmp, what + " g", word, Range::inside(0.0, 1.0), true);
      term.tau = numeric(lmp, what + " tau", next(values), Range::above(0.0), true);
      sum += term.g;
      word = next(values);
    } while (!word.empty() && utils::is_double(word));
    if (sum >= 1.0)
      error->one(FLERR, "{}: the sum of all g is {:.10g}, expected below 1: a part must not relax",
                 what, sum);
    return word;
  }
};

}    // namespace

// what rank 0 has, on all
static std::vector<Material> share(LAMMPS *lmp, std::vector<Material> found)
{
  int n = found.size();
  MPI_Bcast(&n, 1, MPI_INT, 0, lmp->world);
  found.resize(n);
  MPI_Bcast(found.data(), static_cast<int>(n * sizeof(Material)), MPI_BYTE, 0, lmp->world);
  return found;
}

std::vector<Material> FSI::read_materials(LAMMPS *lmp, const std::string &file,
                                          const std::vector<std::string> &names,
                                          const std::map<std::string, std::string> &given)
{
  std::vector<Material> found;
  if (lmp->comm->me == 0) found = MaterialReader(lmp).find(file, names, given);
  return share(lmp, found);
}

std::vector<Material> FSI::read_all_materials(LAMMPS *lmp, const std::string &file)
{
  std::vector<Material> found;
  if (lmp->comm->me == 0) found = MaterialReader(lmp).read(file);
  return share(lmp, found);
}

std::string FSI::describe(const Material &m)
{
  if (m.species == NONE) return SPECIES[NONE];
  std::string line = fmt::format("{} {}", m.name, SPECIES[m.species]);
  for (const auto &p : properties)
    if (has(m.species, p) && !(m.law.varies() && p.value == &Material::viscosity))
      line += fmt::format(" {} {}", p.name, m.*p.value);
  if (m.law.varies()) {
    line += std::string(" ") + Viscosity::Laws::NAMES[m.law.law];
    for (int k = 0; k < Viscosity::Laws::COUNTS[m.law.law]; k++)
      line += fmt::format(" {}", m.law.parameter[k]);
    if (std::isfinite(m.law.most))
      line += fmt::format(" {} {} {}", LIMITS, m.law.least, m.law.most);
  }
  for (int k = 0; k < m.nprony; k++)
    line +=
        fmt::format("{} {} {}", k ? "" : std::string(" ") + PRONY, m.prony[k].g, m.prony[k].tau);
  return line;
}

Material FSI::read_material(LAMMPS *lmp, const std::string &where, const std::string &line)
{
  return line == SPECIES[NONE] ? Material{} : MaterialReader(lmp).parse(where, line.c_str());
}
