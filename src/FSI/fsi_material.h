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

// Materials: what a *.fsi file says about a fluid or a solid, and the equations of state.

#ifndef LMP_FSI_MATERIAL_H
#define LMP_FSI_MATERIAL_H

#include "fsi_viscosity.h"

#include <map>
#include <string>
#include <vector>

namespace LAMMPS_NS {
class LAMMPS;

namespace FSI {

  enum Species { NONE, FLUID, SOLID, RIGID };

  // Trivially copyable: it is sent to other ranks as it is.
  struct Material {
    char name[64] = {};
    int species = NONE;        // FLUID, SOLID or RIGID (wall)
    double rho0 = 0.0;         // reference density
    double viscosity = 0.0;    // fluid: dynamic viscosity, at rest if a law has it vary
    Viscosity law;
    double sound = 0.0;        // fluid: numerical speed of sound, 0 = that of its pair style
    double young = 0.0;        // solid: Young's modulus
    double poisson = 0.0;      // solid: Poisson's ratio
    double yield = 0.0;        // solid: yield stress, 0 = elastic
    double hardening = 0.0;    // solid: slope of the yield stress over equivalent plastic strain
    // solid: a Prony series, parts of the shear modulus that relax, and their times
    static constexpr int MAX_PRONY = 8;
    struct Prony {
      double g = 0.0, tau = 0.0;
    } prony[MAX_PRONY];
    int nprony = 0;

    // solid, 3D and plane strain: shear and bulk modulus
    double shear_modulus() const { return 0.5 * young / (1.0 + poisson); }
    double bulk_modulus() const { return young / (3.0 * (1.0 - 2.0 * poisson)); }
    // solid, plane stress: E/(2(1-nu)), the in-plane bulk modulus of a trace over two axes
    double plane_stress_modulus() const { return young / (2.0 * (1.0 - poisson)); }
  };

  // Of a solid: the configuration that its equations of motion refer to; 0 where no style moves it.
  enum Form { UPDATED_LAGRANGIAN = 1, TOTAL_LAGRANGIAN };

  // Equation of state of one atom type, and what loops need of its material.
  // Linear, paper eq. 16: p = p0 + c^2 (rho - rho0). Tait: p = p0 + rho0 c^2/7 ((rho/rho0)^7 - 1),
  // the same slope at rho0.
  struct State {
    int species = NONE;
    int form = 0;
    int tait = 0;
    double rho0 = 0.0, inv_rho0 = 0.0, c = 0.0, csq = 0.0, inv_csq = 0.0, p0 = 0.0;
    double floor = -1.0e300;    // lowest pressure; 0 where the material carries no tension
    double shear = 0.0;         // shear modulus G
    double viscosity = 0.0;     // dynamic viscosity, at rest if a law has it vary
    Viscosity law;
    double h = 0.0, w0 = 0.0;    // smoothing length, W(0)
    double yield = 0.0, hardening = 0.0;
    // wall, entered by its fix fsi/wall/particle
    bool kept = false, noslip = false;
    double guard = 0.0;    // distance at which it begins to push fluid off

    // fluids: is it one shear rate where they meet? Of others it jumps, for the stress does not
    bool shears_as(const State &b) const { return viscosity == b.viscosity && law == b.law; }
    bool is_body() const { return species == SOLID || species == RIGID; }
    // square of the fastest waves: sound of a fluid, longitudinal waves of a solid, (K + 4G/3)/rho0
    double wave_speed_sq() const { return species == FLUID ? csq : csq + 4.0 / 3.0 * shear / rho0; }
    FSI_INLINE double pressure(double rho) const
    {
      double p;
      if (tait) {
        const double s = rho / rho0, s2 = s * s;
        p = p0 + rho0 * csq * (1.0 / 7.0) * (s2 * s2 * s2 * s - 1.0);
      } else
        p = p0 + csq * (rho - rho0);
      return p > floor ? p : floor;
    }
    // energy per mass that pressure() stores from rho0 on: the integral of p/rho^2, floor included
    double energy(double rho) const;
    double density(double p) const;    // the inverse of pressure(), for initial states
  };

  // Reads the materials called names from a *.fsi file (LAMMPS potential file: header with DATE and
  // UNITS, then one material per line: name, fluid, solid or wall, keyword-value pairs). Every rank
  // gets the result. "NULL" gives species NONE. Errors name the file, the material and the keyword.
  // `given`: lines of such a file by the name of their material, from the script; they come before
  // those of the file, which "NULL" says that there is none of.
  std::vector<Material> read_materials(LAMMPS *lmp, const std::string &file,
                                       const std::vector<std::string> &names,
                                       const std::map<std::string, std::string> &given);
  std::vector<Material> read_all_materials(LAMMPS *lmp, const std::string &file);

  // a line of such a file; what it says. "NULL" is a material of species NONE. where: "in file F"
  std::string describe(const Material &);
  Material read_material(LAMMPS *lmp, const std::string &where, const std::string &line);

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
