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
#include "lammps.h"
#include "pointers.h"
#include "potential_file_reader.h"
#include "tokenizer.h"

#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace FSI;

/* ---------------------------------------------------------------------- */

double State::density(double p) const
{
  if (tait) return rho0 * std::pow(1.0 + 7.0 * (p - p0) / (rho0 * csq), 1.0 / 7.0);
  return rho0 + (p - p0) / csq;
}

/* ----------------------------------------------------------------------
   below the density at which the floor is reached p stays at the floor
------------------------------------------------------------------------- */

double State::energy(double rho) const
{
  const auto integral = [this](double r) {
    const double s = r / rho0;
    if (tait) {
      const double b = rho0 * csq / 7.0;
      return b / rho0 * ((std::pow(s, 6) - 1.0) / 6.0 + 1.0 / s - 1.0) + p0 / rho0 * (1.0 - 1.0 / s);
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

// gives free functions the LAMMPS pointers that error->one() and friends need
class MaterialReader : protected Pointers {
 public:
  explicit MaterialReader(LAMMPS *lmp) : Pointers(lmp) {}

  std::vector<Material> read(const std::string &file, const std::vector<std::string> &names)
  {
    std::vector<Material> all;
    if (utils::get_potential_file_path(file).empty())
      error->one(FLERR, "Cannot open material file {}: it is neither in the working folder nor in those of the environment variable "
                        "LAMMPS_POTENTIALS; type  export LAMMPS_POTENTIALS=<folder of the .fsi files>", file);
    PotentialFileReader reader(lmp, file, "fsi material");
    while (char *line = reader.next_line()) all.push_back(parse(file, line));

    std::vector<Material> found;
    for (const auto &name : names) {
      Material m = {};
      if (name != "NULL") {
        int matches = 0;
        for (const auto &a : all)
          if (name == a.name) {
            m = a;
            matches++;
          }
        if (matches == 0) {
          std::string known;
          for (const auto &a : all) known += std::string(" ") + a.name;
          error->one(FLERR, "Material {} not found in file {}, which has:{}", name, file, known);
        }
        if (matches > 1) error->one(FLERR, "Material {} stands {} times in file {}", name, matches, file);
      }
      found.push_back(m);
    }
    return found;
  }

 private:
  Material parse(const std::string &file, const char *line)
  {
    Material m = {};
    try {
      ValueTokenizer values(line);
      const std::string name = values.next_string();
      if (name.size() >= sizeof(m.name))
        error->one(FLERR, "Material name {} in file {} is longer than {} characters", name, file, sizeof(m.name) - 1);
      strcpy(m.name, name.c_str());

      const std::string species = values.next_string();
      if (species == "fluid") m.species = FLUID;
      else if (species == "solid") m.species = SOLID;
      else if (species == "wall") m.species = RIGID;
      else
        error->one(FLERR, "Material {} in file {} is of unknown species {}: expected fluid, solid or wall", name, file, species);

      bool has_young = false, has_poisson = false;
      while (values.has_next()) {
        const std::string key = values.next_string();
        const double value = values.next_double();
        if (key == "rho") m.rho0 = value;
        else if (key == "viscosity" && m.species == FLUID) m.viscosity = value;
        else if (key == "young" && m.species == SOLID) {
          m.young = value;
          has_young = true;
        } else if (key == "poisson" && m.species == SOLID) {
          m.poisson = value;
          has_poisson = true;
        } else if (key == "yield" && m.species == SOLID) m.yield = value;
        else if (key == "hardening" && m.species == SOLID) m.hardening = value;
        else
          error->one(FLERR, "Unknown keyword {} of {} {} in file {}: expected {}", key, species, name, file,
                     m.species == FLUID ? "rho, viscosity" : m.species == RIGID ? "rho" : "rho, young, poisson, yield, hardening");
        if (!std::isfinite(value)) error->one(FLERR, "Value of {} of material {} in file {} is not finite", key, name, file);
      }
      if (m.rho0 <= 0.0) error->one(FLERR, "Material {} in file {} needs rho > 0", name, file);
      if (m.viscosity < 0.0) error->one(FLERR, "Material {} in file {} needs viscosity >= 0", name, file);
      if (m.species == SOLID) {
        if (!has_young || m.young <= 0.0) error->one(FLERR, "Material {} in file {} needs young > 0", name, file);
        if (!has_poisson || m.poisson <= -1.0 || m.poisson >= 0.5)
          error->one(FLERR, "Material {} in file {} needs poisson between -1 and 0.5", name, file);
        if (m.yield < 0.0 || m.hardening < 0.0)
          error->one(FLERR, "Material {} in file {} needs yield and hardening >= 0", name, file);
      }
    } catch (TokenizerException &e) {
      error->one(FLERR, "Cannot read a line of material file {}: {}", file, e.what());
    }
    return m;
  }
};

}    // namespace

/* ---------------------------------------------------------------------- */

std::vector<Material> FSI::read_materials(LAMMPS *lmp, const std::string &file, const std::vector<std::string> &names)
{
  std::vector<Material> found(names.size());
  if (lmp->comm->me == 0) found = MaterialReader(lmp).read(file, names);
  MPI_Bcast(found.data(), static_cast<int>(found.size() * sizeof(Material)), MPI_BYTE, 0, lmp->world);
  return found;
}
