/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   Copyright (2003) Sandia Corporation.  Under the terms of Contract
   DE-AC04-94AL85000 with Sandia Corporation, the U.S. Government retains
   certain rights in this software.  This software is distributed under
   the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "fsi_keywords.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "fsi_record.h"
#include "group.h"
#include "input.h"
#include "memory.h"
#include "modify.h"
#include "update.h"
#include "variable.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>
#include <utility>

using namespace LAMMPS_NS;
using namespace FSI;

std::string Range::text() const
{
  if (low > -LARGEST && high < LARGEST && !low_open && !high_open)
    return fmt::format("between {:g} and {:g}", low, high);
  std::string text;
  if (low > -LARGEST) text = fmt::format("{} {:g}", low_open ? ">" : ">=", low);
  if (high < LARGEST)
    text += fmt::format("{}{} {:g}", text.empty() ? "" : " and ", high_open ? "<" : "<=", high);
  return text.empty() ? "a number" : text;
}

double FSI::numeric(LAMMPS *lmp, const std::string &what, const std::string &value,
                    const Range &range, bool alone, const std::string &other)
{
  const double x = std::strtod(value.c_str(), nullptr), size = std::fabs(x);
  const auto expected = range.text() + (other.empty() ? "" : ", or " + other);
  std::string wrong;
  if (!utils::is_double(value))
    wrong = "is not a number: expected " + expected;
  else if (size >= Range::LARGEST)
    wrong = fmt::format("is too large: expected {}, below {:g}", expected, Range::LARGEST);
  else if (!range.holds(x))
    wrong = "must be " + expected;
  else if (x != 0.0 && size < Range::SMALLEST)
    wrong = fmt::format("is too small: expected {}, above {:g}", expected, Range::SMALLEST);
  if (wrong.empty()) return x;
  if (alone) lmp->error->one(FLERR, "{} {} {}", what, value, wrong);
  lmp->error->all(FLERR, "{} {} {}", what, value, wrong);
  return 0.0;
}

int FSI::integer(LAMMPS *lmp, const std::string &what, const std::string &value, int least,
                 int most)
{
  const auto expected = most == MAXSMALLINT ? fmt::format(">= {}", least)
                                            : fmt::format("between {} and {}", least, most);
  if (!utils::is_integer(value))
    lmp->error->all(FLERR, "{} {} is not an integer: expected {}", what, value, expected);
  const double x = std::strtod(value.c_str(), nullptr);    // of any length
  if (x < least || x > most) lmp->error->all(FLERR, "{} {} must be {}", what, value, expected);
  return static_cast<int>(x);
}

int FSI::group_of(LAMMPS *lmp, const std::string &command, const std::string &name)
{
  const int igroup = lmp->group->find(name);
  if (igroup == -1) lmp->error->all(FLERR, "{} group-ID {} does not exist", command, name);
  return igroup;
}

std::string FSI::place_text(const double *x)
{
  return fmt::format("{:.10g} {:.10g} {:.10g}", x[0], x[1], x[2]);
}

std::string FSI::list_of(const std::vector<std::string> &words)
{
  std::string text;
  for (size_t k = 0; k < words.size(); k++)
    text += (k == 0 ? "" : k + 1 < words.size() ? ", " : " or ") + words[k];
  return text;
}

// ---- building the rows ----

// pair_style name->Pair style name, fix name->Fix name
static std::string sentence(const std::string &command)
{
  std::string text = command;
  text[0] = toupper(text[0]);
  std::replace(text.begin(), std::find(text.begin(), text.end(), ' '), '_', ' ');
  return text;
}

Keywords::Keywords(LAMMPS *lmp, const std::string &command_in) :
    Pointers(lmp), command(command_in), title(sentence(command_in))
{
}

Keywords &Keywords::add(Row row)
{
  rows.push_back(std::move(row));
  return *this;
}

Keywords &Keywords::add(Value v)
{
  v.begin();
  rows.back().values.push_back(std::move(v));
  return *this;
}

Keywords &Keywords::number(double &where, double start, const Range &range, const std::string &what)
{
  Value v(Value::NUMBER, start, what);
  v.range = range;
  v.number = &where;
  return add(v);
}

Keywords &Keywords::integer(int &where, int start, int least, int most)
{
  Value v(Value::INTEGER, start);
  v.least = least;
  v.most = most;
  v.n = &where;
  return add(v);
}

Keywords &Keywords::choice(int &where, int start, const std::vector<std::string> &words,
                           const std::string &what)
{
  Value v(Value::CHOICE, start, what);
  v.words = words;
  v.n = &where;
  return add(v);
}

Keywords &Keywords::flag(Value::Kind kind, int &where, int start)
{
  Value v(kind, start);
  v.n = &where;
  return add(v);
}

Keywords &Keywords::word(std::string &where, const std::string &start)
{
  Value v(Value::WORD);
  v.start_word = start;
  v.word = &where;
  return add(v);
}

Keywords &Keywords::per_type(std::vector<double> &where, const Range &range, bool types_alone)
{
  Value v(Value::PER_TYPE);
  v.range = range;
  v.types_alone = types_alone;
  v.each = &where;
  where.resize(atom->ntypes + 1);
  return add(v);
}

Keywords &Keywords::or_word(const std::string &word, double number)
{
  Value &v = rows.back().values.back();
  v.other = word;
  v.other_number = number;
  return *this;
}

// ---- one value ----

void Keywords::Value::begin() const
{
  if (number)
    *number = start;
  else if (word)
    *word = start_word;
  else if (each)
    std::fill(each->begin(), each->end(), start);
  else
    *n = kind == SET ? 0 : static_cast<int>(start);
}

bool Keywords::Value::at_start() const
{
  if (number) return *number == start;
  if (word) return *word == start_word;
  if (each)
    return std::all_of(each->begin(), each->end(), [this](double x) {
      return x == start;
    });
  return *n == (kind == SET ? 0 : static_cast<int>(start));
}

// as a user would write it
std::string Keywords::Value::text() const
{
  switch (kind) {
    case NUMBER:
      return !other.empty() && *number == other_number ? other : fmt::format("{}", *number);
    case INTEGER:
      return std::to_string(*n);
    case CHOICE:
      return words[*n];
    case WORD:
      return !other.empty() && word->empty() ? other : *word;
    case PER_TYPE: {
      std::string list;
      for (size_t t = 1; t < each->size(); t++)
        if ((*each)[t] != start)
          list += fmt::format("{}{}", list.empty() ? "" : " ", t) +
              (types_alone ? "" : fmt::format(" {}", (*each)[t]));
      return list.empty() ? "none" : list;
    }
    default:
      return (kind == SET ? *n == static_cast<int>(start) : *n) ? "yes" : "no";
  }
}

void Keywords::take(const Row &row, const Value &v, const std::string &text) const
{
  const auto name = row.name + (v.what.empty() ? "" : " " + v.what);
  const bool other = !v.other.empty() && text == v.other;
  switch (v.kind) {
    case Value::NUMBER:
      *v.number = other ? v.other_number
                        : FSI::numeric(lmp, title + " " + name, text, v.range, false, v.other);
      break;
    case Value::INTEGER:
      *v.n = FSI::integer(lmp, title + " " + name, text, v.least, v.most);
      break;
    case Value::WORD:
      *v.word = other ? "" : text;
      break;
    case Value::SET:
      *v.n = static_cast<int>(v.start);
      break;
    case Value::PER_TYPE: {
      const size_t gap = text.find(' ');
      int first, last;
      utils::bounds_typelabel(FLERR, text.substr(0, gap), 1, atom->ntypes, first, last, lmp,
                              Atom::ATOM);
      const double x = v.types_alone
          ? 1.0
          : FSI::numeric(lmp, title + " " + name, text.substr(gap + 1), v.range);
      std::fill(v.each->begin() + first, v.each->begin() + last + 1, x);
      break;
    }
    case Value::LOGICAL:
      for (const char *yes : {"yes", "on", "true"})
        if (text == yes) return void(*v.n = 1);
      for (const char *no : {"no", "off", "false"})
        if (text == no) return void(*v.n = 0);
      error->all(FLERR, "Unknown {} {} {}: expected yes or no", command, name, text);
      break;
    case Value::CHOICE: {
      const auto it = std::find(v.words.begin(), v.words.end(), text);
      if (it == v.words.end())
        error->all(FLERR, "Unknown {} {} {}: expected {}", command, name, text, list_of(v.words));
      *v.n = it - v.words.begin();
    }
  }
}

int Keywords::Row::count() const
{
  int n = 0;
  for (const auto &v : values) n += v.count();
  return n;
}

std::string Keywords::Row::text() const
{
  std::string text;
  for (const auto &v : values) text += (text.empty() ? "" : " ") + v.text();
  return text;
}

// ---- the command ----

void Keywords::begin() const
{
  for (const auto &row : rows)
    for (const auto &v : row.values) v.begin();
}

bool Keywords::knows(const std::string &keyword) const
{
  return std::any_of(rows.begin(), rows.end(), [&](const Row &r) {
    return r.keyword && r.name == keyword;
  });
}

void Keywords::parse(const std::vector<std::string> &arg)
{
  const int narg = arg.size();
  std::vector<std::string> known;
  for (const auto &row : rows)
    if (row.keyword) known.push_back(row.name);
  begin();
  int iarg = 0;
  std::set<std::string> given;
  auto row = rows.begin();
  while (iarg < narg || (row != rows.end() && !row->keyword)) {
    const bool keyword = row == rows.end() || row->keyword;
    auto it = row;
    if (keyword) {
      it = std::find_if(rows.begin(), rows.end(), [&](const Row &r) {
        return r.keyword && r.name == arg[iarg];
      });
      if (it == rows.end()) {
        if (known.empty()) error->all(FLERR, "{} takes no argument {}", title, arg[iarg]);
        error->all(FLERR, "Unknown {} keyword {}: expected {}", command, arg[iarg], list_of(known));
      }
      iarg++;
      if (!given.insert(it->name).second && it->values.front().kind != Value::PER_TYPE &&
          comm->me == 0)
        error->warning(FLERR, "{} {} is given twice: the last counts", command, it->name);
    } else
      row++;
    if (iarg + it->count() > narg)
      utils::missing_cmd_args(FLERR, keyword ? command + " " + it->name : command, error);
    for (const auto &v : it->values) {
      std::string text;
      for (int k = 0; k < v.count(); k++) text += (k ? " " : "") + arg[iarg + k];
      take(*it, v, text);
      iarg += v.count();
    }
  }
}

// ---- restart ----

void Keywords::write(Record &record) const
{
  for (const auto &row : rows) record.add(row.name, row.text());
}

void Keywords::read(const Record &record)
{
  begin();
  for (const auto &row : rows) {
    if (record.value(row.name) == row.text()) continue;    // not named: may be outside of its range
    const auto words = utils::split_words(record.value(row.name));
    if (words.size() != row.values.size())
      error->all(FLERR, "The restart file is damaged in {} of {}", row.name, record.style);
    for (size_t k = 0; k < words.size(); k++)
      if (row.values[k].kind != Value::SET || words[k] == "yes") take(row, row.values[k], words[k]);
  }
}

bool Keywords::differs(const Record &record, const std::string &name) const
{
  for (const auto &row : rows)
    if (row.name == name) return record.has(name) && record.value(name) != row.text();
  return false;
}

void Keywords::compare(const Record &record, const std::string &when) const
{
  for (const auto &row : rows) {
    const bool meant = row.may_change || (row.restart.empty() && when != OF_RESTART);
    if (meant || !differs(record, row.name)) continue;
    const auto text =
        fmt::format("{}: {} was {} {}, and is {} now{}", title, row.name, record.value(row.name),
                    when, row.text(), row.restart.empty() ? "" : ": " + row.restart);
    if (row.must_not_change) error->all(FLERR, text);
    if (comm->me == 0) error->warning(FLERR, text);
  }
}

std::vector<Keywords::Effect> Keywords::effects() const
{
  std::vector<Effect> list;
  for (const auto &row : rows) {
    if (row.effect.empty()) continue;
    bool on = false;
    for (const auto &v : row.values)
      on = on ||
          (v.kind == Value::NUMBER ? *v.number != 0.0 : v.kind != Value::CHOICE && !v.at_start());
    std::string name = row.effect;
    const size_t gap = name.find("{}");
    if (gap != std::string::npos) name.replace(gap, 2, fmt::format("{:g}", *row.values[0].number));
    list.push_back({name, row.name, on});
  }
  return list;
}

// ---- numbers and variables ----

Values::~Values()
{
  memory->destroy(each);
}

void Values::read(int k, const std::string &word, const std::string &what, const std::string &other)
{
  if (utils::strmatch(word, "^v_")) return set_variable(k, word.substr(2));
  list[k].number = numeric(lmp, sentence(command) + " " + what, word, {}, false, other);
  list[k].source = NUMBER;
}

void Values::set_variable(int k, const std::string &name)
{
  list[k].name = name;
  list[k].source = EQUAL;    // or atom-style, see find()
}

// Each time by its name: a variable that is deleted gives its number in LAMMPS' list to others
int Values::variable(Value &v) const
{
  const int n = input->variable->find(v.name.c_str());
  if (n < 0) error->all(FLERR, "Variable {} of {} does not exist", v.name, command);
  if (input->variable->equalstyle(n))
    v.source = EQUAL;
  else if (input->variable->atomstyle(n))
    v.source = ATOM;
  else
    error->all(FLERR, "Variable {} of {} must be equal-style or atom-style", v.name, command);
  return n;
}

void Values::find()
{
  for (auto &v : list)
    if (!v.name.empty()) variable(v);
}

bool Values::of_atoms() const
{
  return std::any_of(list.begin(), list.end(), [](const Value &v) {
    return v.source == ATOM;
  });
}

std::string Values::text() const
{
  std::string text;
  for (const auto &v : list) {
    const auto number = v.source == FREE ? "NULL" : fmt::format("{}", v.number);
    text += (text.empty() ? "" : " ") + (v.name.empty() ? number : "v_" + v.name);
  }
  return text;
}

void Values::evaluate(int igroup, int first, int n, bool atoms)
{
  if (atoms && of_atoms() && atom->nmax > nmax) {
    nmax = atom->nmax;
    memory->destroy(each);
    memory->create(each, nmax, list.size(), "fsi:values");
  }
  modify->clearstep_compute();
  for (int k = first; k < first + n; k++) {
    Value &v = list[k];
    if (v.name.empty()) continue;
    const int index = variable(v);
    if (v.source == ATOM) {
      v.number = 0.0;
      if (atoms) input->variable->compute_atom(index, igroup, &each[0][k], list.size(), 0);
      continue;
    }
    v.number = input->variable->compute_equal(index);
    if (!std::isfinite(v.number))
      error->all(FLERR, "Variable {} of {} is {} on step {}: expected a number", v.name, command,
                 v.number, update->ntimestep);
  }
  modify->addstep_compute(update->ntimestep + 1);
}

int Values::shared_group() const
{
  return group->find_or_create("fsi_variables");
}

void Values::mark(int i, int igroup) const
{
  if (igroup) atom->mask[i] ^= group->bitmask[igroup];
}

double Values::memory_usage() const
{
  return (double) nmax * list.size() * sizeof(double);
}
