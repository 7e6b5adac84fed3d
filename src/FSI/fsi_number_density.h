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

// Number density, for what needs it: density by summation or ratio in place of continuity (the
// paper's), the free-surface rule.

#ifndef LMP_FSI_NUMBER_DENSITY_H
#define LMP_FSI_NUMBER_DENSITY_H

#include "pointers.h"

#include <functional>
#include <vector>

namespace LAMMPS_NS {
namespace FSI {

  class Fields;
  class Message;
  class Part;
  class Profile;
  class Scene;
  struct Discretization;
  struct StepState;

  class NumberDensity : protected Pointers {
   public:
    // adds what pairs left on ghosts to the local atoms
    using SumOverGhosts = std::function<void(double *)>;
    NumberDensity(LAMMPS *, Scene &, SumOverGhosts);
    void set_fields(Fields &);    // for the effects that there are now
    void add_messages(Message &to_ghosts);
    // of the positions in atom->x; and the densities that follow from it
    void renew();
    // of local atoms into n[0..nlocal-1], for ghosts as they are in atom->x; n has room for ghosts
    void find(double *n) const;

   private:
    Discretization &disc;
    StepState &step;
    const std::vector<Part *> &parts;
    Profile *const &profile;
    const SumOverGhosts add_ghosts;
    double *ratio;    // density mode ratio: rho/psi of the reference state; 0 = not taken yet
    void find_density();
  };

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
