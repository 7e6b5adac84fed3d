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

// Particles of types without a material, which other pair styles are for, as grains: fix fsi moves
// those of its group, and nothing else of the package looks at them. And what nobody has said of
// new particles of either kind.

#ifndef LMP_FSI_OTHERS_H
#define LMP_FSI_OTHERS_H

#include "pointers.h"

namespace LAMMPS_NS {
namespace FSI {
  struct Discretization;

  class Others : protected Pointers {
   public:
    Others(LAMMPS *lmp, const Discretization &disc) : Pointers(lmp), disc(disc), spins(false) {}
    void init();
    // mass of a particle of this type's stress-free lattice
    static double lattice_mass(const Discretization &, int type);
    // mass and density, where there are none
    void give_defaults(int i) const;
    void turn(double dt) const;    // kicks angular velocities of those with a radius

   private:
    const Discretization &disc;
    bool spins;
    void give_density(int i) const;
    bool has_mass_of_new_sphere(int i) const;
  };

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
