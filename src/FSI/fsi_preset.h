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

// The recommended settings of a kind of scene, keyword preset of pair_style fsi/fluid. The one
// place that has them; doc/src/presets.csv is made of it, doc/choosing.md says why.

#ifndef LMP_FSI_PRESET_H
#define LMP_FSI_PRESET_H

#include "fsi_kernel.h"

namespace LAMMPS_NS::FSI {

// kernel and smoothing length over spacing
struct KernelChoice {
  int kernel;
  double hdx;
};

struct Preset {
  const char *name, *scenes;
  bool quintic;       // in 2D; Wendland in 3D, where its smaller support saves half the time
  bool background;    // of rho U^2
  bool full;          // the fluid fills a vessel: no surface, no stream
  const char *keywords;
};

static constexpr double SOUND_OVER_SPEED = 10.0;
static constexpr Preset PRESETS[] = {
    {"splash", "free surfaces and impacts", false, false, false,
     "density/diffusion 0.1 artificial/visc 0.02 0"},
    {"stream", "laminar flow past bodies, open or periodic", true, true, false,
     "density/diffusion 0.1 laminar/visc tension yes shift 0.25 shift/every 4"},
    {"closed", "vortices in a full box", true, false, true,
     "density/diffusion 0.1 laminar/visc tension yes shift 0.5"},
    {"waves", "small waves", true, false, false, "density/diffusion 0.1 laminar/visc/central"},
};

// without a preset it is that of bodies and of splashes
inline KernelChoice kernel_of(const Preset *preset, int dim)
{
  return preset && preset->quintic && dim == 2 ? KernelChoice{QUINTIC, 1.0}
                                               : KernelChoice{WENDLAND, 1.5};
}

}    // namespace LAMMPS_NS::FSI

#endif
