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

#include "fsi_record.h"

#include "comm.h"
#include "error.h"
#include "fix.h"
#include "fsi_lammps_access.h"
#include "modify.h"
#include "update.h"

#include <cmath>
#include <cstdlib>
#include <cstring>

using namespace LAMMPS_NS;
using namespace FSI;

static constexpr char MAGIC[] = "FSI 2 ";    // of the format

Record::Record(LAMMPS *lmp, const std::string &style_in) : Pointers(lmp), style(style_in) {}

Record::Record(LAMMPS *lmp, const std::string &style_in, const char *text) :
    Pointers(lmp), style(style_in)
{
  const std::string first = MAGIC + style + "\n";
  if (strncmp(text, first.c_str(), first.size()) != 0)
    error->all(FLERR,
               "The restart file was written by another version of the FSI package: {} cannot read "
               "what is its own in it",
               style);
  for (text += first.size(); *text;) {
    const char *const tab = strchr(text, '\t'), *const end = strchr(text, '\n');
    if (!tab || !end || tab > end)
      error->all(FLERR, "The restart file is damaged in what {} keeps", style);
    lines.emplace_back(std::string(text, tab), std::string(tab + 1, end));
    text = end + 1;
  }
}

void Record::add(const std::string &name, const std::vector<double> &numbers)
{
  std::string text;
  // shortest that gives the same number
  for (const double x : numbers) text += fmt::format("{}{}", text.empty() ? "" : " ", x);
  add(name, text);
}

const std::string *Record::find(const std::string &name) const
{
  for (const auto &line : lines)
    if (line.first == name) return &line.second;
  return nullptr;
}

const std::string &Record::value(const std::string &name) const
{
  const std::string *const text = find(name);
  if (!text) error->all(FLERR, "The restart file has no {} of {}", name, style);
  return *text;
}

std::vector<double> Record::numbers(const std::string &name) const
{
  std::vector<double> list;
  for (const auto &word : utils::split_words(value(name)))
    list.push_back(std::strtod(word.c_str(), nullptr));
  return list;
}

void Record::write(FILE *fp) const
{
  if (comm->me) return;
  std::string text = MAGIC + style + "\n";
  for (const auto &line : lines) text += line.first + "\t" + line.second + "\n";
  const int size = text.size() + 1;
  fwrite(&size, sizeof(int), 1, fp);
  fwrite(text.c_str(), size, 1, fp);
}

Record Record::read(LAMMPS *lmp, const std::string &style, FILE *fp)
{
  Comm *const comm = lmp->comm;
  constexpr int FIRST = sizeof(MAGIC) - 1;
  int size = 0;
  std::vector<char> text(FIRST + 1, '\0');
  if (comm->me == 0) {
    // of another version anything may stand here
    utils::sfread(FLERR, &size, sizeof(int), 1, fp, nullptr, lmp->error);
    utils::sfread(FLERR, text.data(), 1, FIRST, fp, nullptr, lmp->error);
    if (strcmp(text.data(), MAGIC) != 0 || size <= FIRST)
      size = FIRST + 1;
    else {
      text.resize(size);
      utils::sfread(FLERR, &text[FIRST], 1, size - FIRST, fp, nullptr, lmp->error);
    }
  }
  MPI_Bcast(&size, 1, MPI_INT, 0, lmp->world);
  text.resize(size);
  MPI_Bcast(text.data(), size, MPI_CHAR, 0, lmp->world);
  text.back() = '\0';
  return {lmp, style, text.data()};
}

double Clock::now(const Update *update)
{
  return update->atime + (update->ntimestep - update->atimestep) * update->dt;
}

void Clock::write(Record &record) const
{
  record.add("step", std::to_string(update->ntimestep));
  record.add("clock's step", std::to_string(update->atimestep));
  record.add("clock", std::vector<double>{update->dt, update->atime});
}

void Clock::read(const Record &record)
{
  const auto at = record.numbers("clock");
  kept = Time{std::stoll(record.value("step")), std::stoll(record.value("clock's step")), at[0],
              at[1]};
}

// LAMMPS counts time from a step on, and forgets that step at each init: in a run that goes on
// without a timestep command the time since then is lost. With the numbers of the file it is that
// of the uninterrupted run, bit for bit. Where a command has set another time or step, that holds.
void Clock::restore()
{
  if (!kept) return;
  const Time &c = *kept;
  const double elapsed = c.time + (c.step - c.first_step) * c.dt, now = Clock::now(update);
  const bool forgotten = update->atime == c.time ||
      std::fabs(now - elapsed) <= 1.0e-12 * std::fabs(elapsed);
  if (update->ntimestep != c.step || !forgotten) return;
  if (update->dt == c.dt) {
    update->atime = c.time;
    update->atimestep = c.first_step;
  } else {
    update->atime = elapsed;
    update->atimestep = c.step;
  }
}

void FSI::check_ids(LAMMPS *lmp, bool updated_solids)
{
  Modify *const modify = lmp->modify;
  Error *const error = lmp->error;
  const bool first = lmp->comm->me == 0;
  for (const auto &[style_before, id_before] : not_taken_from_restart(modify)) {
    if (!utils::strmatch(style_before, "^fsi") && style_before != "FSI_REFERENCE") continue;
    for (const auto *fix : modify->get_fix_by_style("^" + style_before + "$")) {
      if (fix->restart_reset) continue;
      const auto text = fmt::format("Fix {} (style {}) takes nothing from the restart file, in "
                                    "which it had the ID {}: give it that ID",
                                    fix->id, style_before, id_before);
      if (style_before == "fsi" || style_before == "fsi/stress") error->all(FLERR, text);
      if (first) error->warning(FLERR, text);
    }
    if (style_before == "FSI_REFERENCE" && first && updated_solids)
      error->warning(FLERR,
                     "The strain of total-Lagrangian solids in the restart file is lost: they go "
                     "on in pair_style fsi/solid");
  }
}
