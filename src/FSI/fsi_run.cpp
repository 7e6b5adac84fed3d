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

#include "fsi_run.h"

#include "atom.h"
#include "domain.h"
#include "error.h"
#include "fix_fsi.h"
#include "fix_fsi_dt.h"
#include "fsi_find.h"
#include "fsi_keywords.h"
#include "input.h"

#include <string>
#include <vector>

using namespace LAMMPS_NS;
using namespace FSI;

void FSIRun::command(int narg, char **arg)
{
  if (narg < 1) utils::missing_cmd_args(FLERR, "fsi/run", error);
  const double end = numeric(lmp, "Fsi/run time", arg[0], Range::above(0.0));
  FixFSI::find(lmp, "Fsi/run");
  auto *const there = first_of(fixes_of<FixFSIDt>(lmp));
  const auto keywords = utils::join_words({arg + 1, arg + narg}, " ");
  if (there && narg > 1)
    error->all(FLERR, "Fsi/run {}: expected no keyword, there is fix {} (style fsi/dt) already",
               keywords, there->id);
  if (there)
    there->stop_at(end);
  else
    input->one(fmt::format("fix fsi_dt all fsi/dt 10 stop {:.17g} {}", end, keywords));
  input->one("run 1000000000");    // ends before
}

void FSIDump::command(int narg, char **arg)
{
  if (narg < 2) utils::missing_cmd_args(FLERR, "fsi/dump", error);
  if (!atom->style_match("fsi")) error->all(FLERR, "Fsi/dump requires atom_style fsi");
  const std::string group = arg[0], every = arg[1];
  numeric(lmp, "Fsi/dump time", every, Range::above(0.0));
  std::vector<std::string> fields(arg + 2, arg + narg);
  std::string file = "particles.dump";
  const size_t n = fields.size();
  if (n > 0 && fields[n - 1] == "file") utils::missing_cmd_args(FLERR, "fsi/dump file", error);
  if (n > 1 && fields[n - 2] == "file") {
    file = fields[n - 1];
    fields.resize(n - 2);
  }
  std::string columns = "id type mol x y", names;
  columns += domain->dimension == 2 ? " vx vy" : " z vx vy vz";
  for (size_t k = 0; k < fields.size(); k++) {
    const auto column = fields.size() == 1 ? "c_fsi_dump" : fmt::format("c_fsi_dump[{}]", k + 1);
    columns += " " + column;
    names += fmt::format(" colname {} {}", column, fields[k]);
  }
  if (!fields.empty())
    input->one(
        fmt::format("compute fsi_dump {} fsi/atom {}", group, utils::join_words(fields, " ")));
  input->one(fmt::format("dump fsi_dump {} custom 1 {} {}", group, file, columns));
  input->one(fmt::format("dump_modify fsi_dump every/time {} time yes sort id{}", every, names));
}
