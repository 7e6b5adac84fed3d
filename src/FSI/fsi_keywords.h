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

// The arguments of a command, one row each: what it is called, what values follow, where they go,
// what they are if nothing is said, what they may be. Parsing, messages, the list of effects and
// what stands in restart files come from these rows. And values that may be variables.

#ifndef LMP_FSI_KEYWORDS_H
#define LMP_FSI_KEYWORDS_H

#include "pointers.h"

#include <string>
#include <vector>

namespace LAMMPS_NS::FSI {

class Record;

// What a number may be. Sizes but 0 are from SMALLEST to LARGEST, so that products are numbers.
struct Range {
  static constexpr double SMALLEST = 1.0e-20, LARGEST = 1.0e20;
  double low = -LARGEST, high = LARGEST;
  bool low_open = true, high_open = true;    // without the end itself

  static constexpr Range above(double low) { return {low, LARGEST, true, true}; }
  static constexpr Range from(double low) { return {low, LARGEST, false, true}; }
  static constexpr Range between(double low, double high) { return {low, high, false, false}; }
  static constexpr Range from_to_below(double low, double high) { return {low, high, false, true}; }
  static constexpr Range inside(double low, double high) { return {low, high, true, true}; }

  bool holds(double x) const
  {
    return (low_open ? x > low : x >= low) && (high_open ? x < high : x <= high);
  }
  std::string text() const;
};

// A number, or an integer, that stands in a command; else an error that says what it is and what
// was expected. Alone: on this rank only; other: a word that may stand there, too
double numeric(LAMMPS *, const std::string &what, const std::string &value, const Range & = {},
               bool alone = false, const std::string &other = "");
int integer(LAMMPS *, const std::string &what, const std::string &value, int least,
            int most = MAXSMALLINT);

// its number; an error that names the command, as in a message, if there is none
int group_of(LAMMPS *, const std::string &command, const std::string &name);

// one, two or three
std::string list_of(const std::vector<std::string> &words);
// of a particle, in messages: far from the origin six digits do not tell two apart
std::string place_text(const double *x);

class Keywords : protected Pointers {
 private:
  struct Value {
    enum Kind { NUMBER, INTEGER, CHOICE, LOGICAL, WORD, SET, PER_TYPE };
    explicit Value(Kind kind, double start = 0.0, const std::string &what = "") :
        kind(kind), start(start), what(what)
    {
    }
    Kind kind;
    double *number = nullptr;
    int *n = nullptr;
    std::string *word = nullptr;
    std::vector<double> *each = nullptr;
    double start;    // number, integer, index of a choice, what a keyword sets
    bool types_alone = false;
    std::string start_word;
    Range range;
    int least = 0, most = 0;
    std::vector<std::string> words;
    std::string what;     // its name in messages
    std::string other;    // a word that stands for other_number
    double other_number = 0.0;

    // words that follow
    int count() const { return kind == SET ? 0 : kind == PER_TYPE && !types_alone ? 2 : 1; }
    void begin() const;
    bool at_start() const;
    std::string text() const;
  };
  struct Row {
    std::string name;
    bool keyword;
    std::vector<Value> values;
    std::string effect, restart;
    bool must_not_change = false, may_change = false;

    int count() const;    // words that follow
    std::string text() const;
  };

 public:
  Keywords(LAMMPS *, const std::string &command);    // as a user writes it
  Keywords(const Keywords &) = delete;               // rows hold addresses of their owner

  // a row: an argument that stands before all keywords, or a keyword. Its values follow in the
  // order in which they are described; what: their names in messages, of more than one
  Keywords &argument(const std::string &name) { return add(Row{name, false}); }
  Keywords &key(const std::string &name) { return add(Row{name, true}); }
  Keywords &number(double &where, double start, const Range & = {}, const std::string &what = "");
  Keywords &integer(int &where, int start, int least, int most = MAXSMALLINT);
  Keywords &choice(int &where, int start, const std::vector<std::string> &words,
                   const std::string &what = "");
  Keywords &logical(int &where, bool start) { return flag(Value::LOGICAL, where, start); }
  Keywords &word(std::string &where, const std::string &start);    // any
  // atom types and a number, as often as wanted; 0: not given
  Keywords &per_type(std::vector<double> &where, const Range & = {}, bool types_alone = false);
  // atom types alone, 1 if named
  Keywords &types(std::vector<double> &where) { return per_type(where, {}, true); }
  // no value follows: the keyword sets it; 0 without
  Keywords &set(int &where, int value) { return flag(Value::SET, where, value); }
  // of the last value: a word that stands for a number, or for no word
  Keywords &or_word(const std::string &word, double number = 0.0);
  // of the last row: the effect in words, {} stands for its first value; on if a number is not 0,
  // or another value not the one at the start
  Keywords &effect(const std::string &text) { return with(&Row::effect, text); }
  // of the last row: a run from a restart file must not change it, or may, and what that does
  Keywords &kept(const std::string &why) { return changes(why).with(&Row::must_not_change, true); }
  Keywords &changes(const std::string &consequence) { return with(&Row::restart, consequence); }
  // or may as a matter of course, without a warning
  Keywords &of_a_run() { return with(&Row::may_change, true); }

  // what is not named gets what it has at the start
  void parse(const std::vector<std::string> &words);
  void parse(int narg, char **arg) { parse({arg, arg + narg}); }
  bool knows(const std::string &keyword) const;

  void write(Record &) const;
  void read(const Record &);
  // rows that differ from a restart file, or from the last run: an error, or a warning that names
  // both sides and says what happens. Between runs a change of what has no consequence is meant
  static constexpr char OF_RESTART[] = "when the restart file was written";
  void compare(const Record &, const std::string &when = OF_RESTART) const;
  bool differs(const Record &, const std::string &name) const;

  struct Effect {
    std::string name, keyword;
    bool on = false;
  };
  std::vector<Effect> effects() const;

 private:
  const std::string command, title;
  std::vector<Row> rows;

  Keywords &add(Row);
  Keywords &add(Value);
  Keywords &flag(Value::Kind, int &where, int start);
  template <class T> Keywords &with(T Row::*what, const T &value)    // of the last row
  {
    rows.back().*what = value;
    return *this;
  }
  void begin() const;
  void take(const Row &, const Value &, const std::string &) const;
};

// What may stand in a command as a number, as an equal-style variable, or as an atom-style one. A
// variable may sum over ranks: all of them evaluate it together. What is asked alone, as for an
// atom that is made, has the values of the last time.
class Values : protected Pointers {
 public:
  enum Source { FREE, NUMBER, EQUAL, ATOM };    // FREE: none was given

  // command: as a user writes it, fix fsi/stream
  Values(LAMMPS *lmp, const std::string &command, int n) : Pointers(lmp), command(command), list(n)
  {
  }
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
  double **each = nullptr;    // of atom-style variables
  int nmax = 0;
  int variable(Value &) const;
  int shared_group() const;              // of all commands: LAMMPS has 32
  void mark(int i, int igroup) const;    // in it, or out of it
};

}    // namespace LAMMPS_NS::FSI

#endif
