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

// What may stand in a command as a number, as an equal-style variable, or as an atom-style one. A
// variable may sum over ranks: all of them evaluate it together. Who is asked alone, as for an atom
// that is made, has the values of the last time.

#ifndef LMP_FSI_VALUE_H
#define LMP_FSI_VALUE_H

#include "pointers.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {
namespace FSI {

  class Values : protected Pointers {
   public:
    enum Source { FREE, NUMBER, EQUAL, ATOM };    // FREE: none was given

    Values(LAMMPS *, const std::string &command, int n);    // as a user writes it: fix fsi/stream
    ~Values();
    Values(const Values &) = delete;

    // from the command: a number, v_name or other; what: its name in messages
    void read(int k, const std::string &word, const std::string &what,
              const std::string &other = "v_name");
    void set_variable(int k, const std::string &name);
    // in init(): an error if there is no such variable, or none of these styles
    void find();
    Source source(int k) const { return list[k].source; }
    bool given(int k) const { return list[k].source != FREE; }
    bool of_atoms() const;       // is any an atom-style variable?
    std::string text() const;    // as in the command

    // all ranks together, at the time that LAMMPS has; atom-style ones of the particles of a group;
    // n of them from the first one on
    void evaluate(int igroup, int first, int n, bool atoms = true);
    // of the particles i of the elements of a list
    template <class List> void evaluate_for(const List &particles, int first, int n)
    {
      const int igroup = of_atoms() ? shared_group() : 0;
      for (const auto &p : particles) mark(p.i, igroup);
      evaluate(igroup, first, n);
      for (const auto &p : particles) mark(p.i, igroup);
    }
    // of none or of an atom-style variable: 0
    double number(int k) const { return list[k].number; }
    double operator()(int k, int i) const
    {
      return list[k].source == ATOM ? each[i][k] : list[k].number;
    }
    const std::string &name(int k) const { return list[k].name; }
    std::string see(int k) const
    {
      return list[k].name.empty() ? "" : ", see variable " + list[k].name;
    }
    double memory_usage() const;

   private:
    struct Value {
      Source source = FREE;
      double number = 0.0;
      std::string name;    // of the variable; empty: a number
    };
    const std::string command;
    std::vector<Value> list;
    double **each;    // of atom-style variables
    int nmax;
    int variable(Value &) const;
    int shared_group() const;              // of all commands: LAMMPS has 32
    void mark(int i, int igroup) const;    // in it, or out of it
  };

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
