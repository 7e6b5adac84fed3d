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

#ifdef ATOM_CLASS
// clang-format off
AtomStyle(fsi,AtomVecFSI);
// clang-format on
#else

#ifndef LMP_ATOM_VEC_FSI_H
#define LMP_ATOM_VEC_FSI_H

#include "atom_vec.h"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace LAMMPS_NS {
namespace FSI {
  class Record;
}    // namespace FSI

// Particles of fluid or solid: mass, density, and the body they belong to (the molecule ID; 0 for
// fluid). These are what a restart must carry for every particle. Stress and the like live with the
// fix that evolves them; pressure and number density are functions of the state and live with fix
// fsi.

class AtomVecFSI : virtual public AtomVec {
 public:
  AtomVecFSI(class LAMMPS *);
  ~AtomVecFSI() override;
  static AtomVecFSI *of(class Atom *);    // that style, of a hybrid, too; or null

  void grow_pointers() override;
  void create_atom_post(int) override;
  void data_atom_post(int) override;
  void pack_data_pre(int) override;
  void pack_data_post(int) override;
  int property_atom(const std::string &) override;
  void pack_property_atom(int, double *, int, int) override;

  // lines of a material file that command fsi/material has given, by name
  std::map<std::string, std::string> materials;
  std::vector<double> density_of_solids;    // in data files, by type; 0: of no solid
  // until the next run: what fixes that are gone had of each particle (Fields::pack_all), and their
  // record, by the names that they gave (FixFields::hand_on)
  struct Kept {
    std::shared_ptr<const FSI::Record> record;
    std::vector<double> rows;
  };
  std::map<std::string, Kept> of_fixes;

 private:
  double *rmass, *rho;
  double kept = 0.0;    // density, while a data file is written
};

}    // namespace LAMMPS_NS

#endif
#endif
