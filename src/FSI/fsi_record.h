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

// What a style leaves in a restart file: text, a line for each thing that it keeps, with its name.
// Numbers come back bit for bit.

#ifndef LMP_FSI_RECORD_H
#define LMP_FSI_RECORD_H

#include "pointers.h"

#include <cstdio>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace LAMMPS_NS::FSI {

class Record : protected Pointers {
 public:
  Record(LAMMPS *, const std::string &style);    // to be written
  // that was read; an error if it is none of this style
  Record(LAMMPS *, const std::string &style, const char *text);

  void add(const std::string &name, const std::string &value) { lines.emplace_back(name, value); }
  void add(const std::string &name, const std::vector<double> &numbers);
  bool has(const std::string &name) const { return find(name) != nullptr; }
  // an error if there is no such line
  const std::string &value(const std::string &name) const;
  std::vector<double> numbers(const std::string &name) const;
  const std::vector<std::pair<std::string, std::string>> &all() const { return lines; }

  void write(FILE *) const;    // by rank 0: its size in bytes, then the text
  static Record read(LAMMPS *, const std::string &style, FILE *);

  // errors and warnings about this record begin with this
  const std::string style;

 private:
  std::vector<std::pair<std::string, std::string>> lines;
  const std::string *find(const std::string &name) const;
};

// Simulated time as a restart file has it, which LAMMPS forgets where it has no timestep command
// after reading.
class Clock : protected Pointers {
 public:
  explicit Clock(LAMMPS *lmp) : Pointers(lmp) {}
  static double now(const Update *);    // simulated time of this step
  void write(Record &) const;
  void read(const Record &);
  void restore();                    // before the first run after a restart file was read
  void forget() { kept.reset(); }    // from that run on

 private:
  struct Time {
    bigint step = 0, first_step = 0;
    double dt = 0.0, time = 0.0;
  };
  std::optional<Time> kept;
};

// once, before the first run after a restart file was read: what the file keeps for fixes of the
// package that go by another ID now
void check_ids(LAMMPS *, bool updated_solids);

}    // namespace LAMMPS_NS::FSI

#endif
