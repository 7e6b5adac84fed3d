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

// Solids that fluids press on in ways of their own: those that pass through mirror walls, and those
// that are light and take sub-steps.

#ifndef LMP_FSI_WET_SOLIDS_H
#define LMP_FSI_WET_SOLIDS_H

#include "fsi_fluid_loops.h"
#include "fsi_hub.h"
#include "pointers.h"

#include <vector>

namespace LAMMPS_NS {
class ComputeFSIForce;

namespace FSI {
  class Ghosts;
  class PairSets;

  // How much of the solids' particles is before mirror walls, and its rate
  class CutSolids : protected Pointers {
   public:
    CutSolids(LAMMPS *lmp, const Discretization &disc, bool has_solids) :
        Pointers(lmp), disc(disc), has_solids(has_solids)
    {
    }
    // where particles are in this step; takes what is behind walls out of step.wmask
    void find(StepState &step);
    const Cut *of_particles();    // null: no solid passes through a wall
    double memory_usage() const { return bytes_of(parts, part_rates); }

   private:
    const Discretization &disc;
    const bool has_solids;
    bool any = false, may_pass = false;    // is one cut, may one be before the next lists?
    std::vector<Walls::Depth> depths;      // per type and wall
    std::vector<double> parts, part_rates;
    Cut cut;
    void find_depths(const Walls &);
  };

  // Solids whose layers weigh less than half of one of the fluid: their sub-steps feel how the
  // fluid's force changes within the step (theory.rst). Under implicit viscosity all feel it of
  // viscous forces; of that fluids have no reaction, which would shake their layer beside solids.
  class LightSolids : protected Pointers {
   public:
    LightSolids(LAMMPS *lmp, const Discretization &disc, StepState &step, Ledger &ledger,
                Ghosts &ghosts, bool viscous) :
        Pointers(lmp),
        disc(disc), step(step), ledger(ledger), ghosts(ghosts), viscous(viscous)
    {
    }
    bool any() const;
    bool resisted() const { return step.substeps > 1 && (viscous || any()); }
    // particles are those of the loop of forces
    void find_impedances(PairSets &, const FluidParticles &);
    // the reaction: what solids have not got of the impulse, fluids have not given
    void react(PairSets &, const FluidParticles &, const std::vector<ComputeFSIForce *> &measures);

   private:
    const Discretization &disc;
    StepState &step;
    Ledger &ledger;
    Ghosts &ghosts;
    const bool viscous;
    std::vector<char> types(size_t level) const;
    template <class Use> void for_wet_pairs(PairSets &, const FluidParticles &, Use) const;
  };

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
