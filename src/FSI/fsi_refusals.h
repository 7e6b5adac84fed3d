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

// What does not go together: all refusals of one feature beside another. A refusal says what, what
// it requires or does not go with, and why. The manual's table is made of these rows (page
// "refusals"), in this order; a row is used by the style that refuses, or marked as LAMMPS' own.

#ifndef LMP_FSI_REFUSALS_H
#define LMP_FSI_REFUSALS_H

#include "error.h"

namespace LAMMPS_NS::FSI {

// "WHAT requires WITH: WHY" or "WHAT does not go with WITH: WHY"; {}: names, in this order
struct Refusal {
  enum Rule { REQUIRES, NOT_WITH } rule;
  const char *what, *with, *why;
};

namespace Refused {
  inline constexpr auto REQUIRES = Refusal::REQUIRES, NOT_WITH = Refusal::NOT_WITH;
  inline constexpr char STANDARD[] = "density by continuity, as fix fsi scheme standard has it";
  inline constexpr char WALL[] = "couple wall in pair_style fsi/fluid";
  inline constexpr char JUMP[] = "number densities are not smooth where two lattices meet";

  // fix fsi
  inline constexpr Refusal
      DEFORM = {NOT_WITH, "A fluid or hypoelastic solid", "fix {} (style {})",
                "the box would move particles, and densities and stresses would not follow: move "
                "walls instead"},
      INCLUDE = {NOT_WITH, "Fix fsi", "neigh_modify include",
                 "particles without neighbors have no pressure"},
      ONCE = {NOT_WITH, "A fluid", "neigh_modify once",
              "its particles would keep the neighbors that they had at the start of a run"},
      REDUCED_GHOSTS = {NOT_WITH, "Fix fsi", "comm_modify reduce/multi or group",
                        "particles need all neighbors as ghosts"},
      SHAPES = {NOT_WITH, "Fix fsi", "ellipsoid, line, tri or body of atom_style hybrid",
                "they give all particles masses or shapes of their own"},
      SCALED = {NOT_WITH, "Fix fsi", "pair_style hybrid/scaled",
                "densities and sub-steps would not be scaled"},
      ALL_PAIRS = {REQUIRES, "Pair style {}",
                   "its pairs of types {} and {}, which another pair_coeff takes",
                   "sums would lack neighbors, use pair_style hybrid/overlay"},
      TRICLINIC = {NOT_WITH, "Fix fsi", "a triclinic box",
                   "images in walls are those of an orthogonal one"},
      SUBSTEPS = {REQUIRES, "Fix fsi substeps", "pair_style fsi/solid/tl",
                  "its forces alone are a sum over bonds that sub-steps can take"},
      SUMS_OF_SOLIDS = {NOT_WITH, "Fix fsi solid density summation or ratio",
                        "pair_style fsi/solid/tl", "its density follows from its strain"},
      SPACING_UPDATED =
          {REQUIRES, "Fix fsi spacing {:g} of type {}", "pair_style fsi/solid/tl",
           "the sums of pair_style fsi/solid are over whatever is near, with one kernel"},
      SPACING_DENSITY = {REQUIRES, "Fix fsi spacing {:g} of type {}", STANDARD,
                         "number densities are those of one spacing"},
      SPACING_COUPLE = {REQUIRES, "Fix fsi spacing {:g} of type {}", WALL,
                        "a pressure of the body's own is that of its own volumes"},
      SPACING_FLUIDS = {REQUIRES, "Fix fsi spacing {:g} of type {}, a fluid,", STANDARD, JUMP},
      SPACING_SOLIDS = {REQUIRES, "Fix fsi spacing {:g} of type {}, a fluid,",
                        "another mode than fix fsi solid summation", JUMP},
      SPACING_FLUIDS_COUPLE = {REQUIRES, "Fix fsi spacing {:g} of type {}, a fluid,", WALL,
                               "a pressure of the body's own is that of its own volumes"},
      SPACING_SURFACES = {REQUIRES, "Fix fsi spacing {:g} of type {}, a fluid,",
                          "pair_style fsi/fluid density/surface no", JUMP},
      THIN_DENSITY = {REQUIRES, "Fix fsi thin {}", STANDARD,
                      "number densities would jump where a body comes between"},
      THIN_COUPLE = {REQUIRES, "Fix fsi thin {}", WALL, "each side has its own pressure"},

      // fluids
      CONTINUITY = {REQUIRES, "Pair style fsi/fluid {}", STANDARD, "it is a rate of density"},
      SURFACES = {NOT_WITH, "Pair style fsi/fluid density/surface", "tension yes or background",
                  "it is for fluids with a free surface"},
      FULL_TOTAL = {REQUIRES, "Pair style fsi/solid/tl", WALL,
                    "its stress is not one that crosses to the fluid"},
      FULL_CORRECTED =
          {REQUIRES, "Pair style fsi/fluid couple full", "pair_style fsi/solid gradient plain",
           "corrected gradients are complete without the fluid's pairs: use couple wall"},
      IMPLICIT = {REQUIRES, "Pair style fsi/fluid laminar/implicit", "laminar/visc",
                  "its system is that of the plain form"},
      GRAINS_VISCOSITY = {REQUIRES, "Pair style fsi/grain", "fluids of constant viscosity",
                          "the drag of grains is that of Newtonian fluids"},
      GRAINS = {REQUIRES, "Pair style fsi/grain", "pair_style fsi/fluid beside it",
                "use pair_style hybrid/overlay"},

      // solids
      TWO_SOLIDS = {NOT_WITH, "Pair style fsi/solid", "pair_style fsi/solid/tl",
                    "bodies are of one form"},
      STRESS = {REQUIRES, "Pair style fsi/solid", "fix fsi/stress",
                "without it a solid has no shear stress"},
      LAW_STRESS = {REQUIRES, "Pair style fsi/solid/tl law {}", "fix fsi/stress",
                    "its stress is integrated in time"},
      PLANE_OF_STRESS = {REQUIRES, "Pair style fsi/solid/tl law {} with plane {}",
                         "the same of fix fsi/stress", "both are of one body"},
      PLANE_3D = {REQUIRES, "Pair style fsi/solid/tl plane stress", "dimension 2",
                  "in 3D the stress is what it is"},
      PLANE_LAW = {REQUIRES, "Pair style fsi/solid/tl plane stress", "law {}",
                   "others do not know the strain across the plane"},
      SMOOTHED_PLANE = {NOT_WITH, "Pair style fsi/solid/tl volumetric smoothed", "plane stress",
                        "it does not lock: expected auto or local"},
      SMOOTHED_DAMAGE = {NOT_WITH, "Pair style fsi/solid/tl volumetric smoothed", "damage",
                         "torn bonds would make energy: expected auto or local"},
      PLANE_STRESS_3D = {REQUIRES, "Fix fsi/stress plane", "dimension 2",
                         "in 3D the stress is what it is"},
      PLASTIC_PLANE = {REQUIRES, "Fix fsi/stress plastic", "plane strain in 2D",
                       "the yield condition is that of three dimensions"},
      SELF_SYMMETRY = {NOT_WITH, "Pair style {} self yes", "symmetry yes of fix fsi/wall/mirror",
                       "a body would not meet its own image"},
      SELF_LATE = {REQUIRES, "Pair style fsi/solid/tl self yes",
                   "bodies that had it from their first run on",
                   "positions in the reference are kept only then"},
      BALANCE = {REQUIRES, "Pair style fsi/solid/tl", "a place before fix balance",
                 "bonds find their partners by atom ID; or give atom_modify map yes first"},
      RESET_IDS = {NOT_WITH, "A total-Lagrangian body", "reset_atoms id",
                   "bonds know their partners by atom ID (LAMMPS refuses)"},
      CONSTRAINED = {NOT_WITH, "A solid with sub-steps", "fix {} (style {}) on atom {}",
                     "it does not see forces inside the solid: leave what is held out of the "
                     "group of fix {}"},
      RIGID_STYLES = {NOT_WITH, "A body with sub-steps", "fix {} (style {})", "expected {}"},

      // open ends, streams, levels
      END_DENSITY = {REQUIRES, "{}", STANDARD, "a sum cannot be prescribed"},
      END_LISTS =
          {REQUIRES, "{}", "neigh_modify check yes",
           "particles are made and deleted when lists are built, before they have moved far"},
      END_PERIODIC = {REQUIRES, "{}", "a fixed boundary (f) in {}",
                      "fluid would come in at the other side"},
      END_REGION = {REQUIRES, "{}", "a region that does not move or change",
                    "its ends are those of the buffer"},
      STREAM_DENSITY = {REQUIRES, "Fix fsi/stream density", STANDARD, "a sum cannot be damped"},
      STREAM_REGION = {REQUIRES, "Fix fsi/stream", "a region that does not move or change",
                       "its weight is that of a place"},

      // time
      CHECK_SUBSTEPS = {NOT_WITH, "Fix fsi/dt substeps auto", "check", "a check changes nothing"},
      CHECK_STOP = {NOT_WITH, "Fix fsi/dt stop", "check", "a check changes nothing"},
      RESET_STEP = {NOT_WITH, "Fix fsi/dt", "fix dt/reset", "both would set the time step"},
      MOVE_STEP = {NOT_WITH, "Fix fsi/dt", "fix {} (style {})",
                   "its time step cannot change: use fix fsi/move"},
      STEP_ORDER = {REQUIRES, "Fix fsi/dt", "fix {} (style {}) after fix {}",
                    "with which the time step changes"},
      PRE_NO = {NOT_WITH, "Run with pre no",
                "other fixes, computes, regions or pair styles than those of the last setup",
                "leave out pre no"},

      // commands and computes
      HYDROSTATIC = {REQUIRES, "Fsi/set hydrostatic", "fix gravity",
                     "the pressure is that of a weight"},
      ENERGY_GROUP = {REQUIRES, "Compute fsi/energy", "group all", "pairs have no group"},
      SHEAR_RATE = {REQUIRES, "Compute fsi/atom {}", "pair_style fsi/fluid",
                    "it is that of a fluid"},
      PLASTIC_STRAIN = {REQUIRES, "Compute fsi/atom plastic/strain", "fix fsi/stress plastic",
                        "it has the plastic strain"};
}    // namespace Refused

template <class... Names>
[[noreturn]] void refuse(Error *error, const Refusal &r, const Names &...names)
{
  const char *const rule = r.rule == Refusal::REQUIRES ? "requires" : "does not go with";
  error->all(FLERR, fmt::format("{} {} {}: {}", r.what, rule, r.with, r.why), names...);
}

}    // namespace LAMMPS_NS::FSI

#endif
