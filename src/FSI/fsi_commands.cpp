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

#include "fsi_commands.h"

#include "atom.h"
#include "atom_vec_fsi.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix_fsi.h"
#include "fix_fsi_dt.h"
#include "fsi_cells.h"
#include "fsi_check.h"
#include "fsi_find.h"
#include "fsi_gather.h"
#include "fsi_hub.h"
#include "fsi_keywords.h"
#include "fsi_material.h"
#include "fsi_refusals.h"
#include "group.h"
#include "input.h"
#include "math_extra.h"
#include "modify.h"
#include "update.h"
#include "variable.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

using namespace LAMMPS_NS;
using namespace FSI;

static constexpr double NEXT = 1.2;    // spacings: the next column, not the diagonal neighbor

// of command fsi/`name`: names and bits of its groups, arguments `first` group-ID and `second`
// group-ID; materials and masses are entered, ghosts are there
static const Discretization &prepare(LAMMPS *lmp, const std::string &name, const std::string &first,
                                     const std::string &second, int narg, char **arg,
                                     std::string (&names)[2], int (&bit)[2])
{
  if (lmp->domain->box_exist == 0)
    lmp->error->all(FLERR, "Fsi/{} command before simulation box is defined", name);
  Keywords keywords(lmp, "fsi/" + name);
  keywords.argument(first + " group-ID").word(names[0], "");
  keywords.argument(second + " group-ID").word(names[1], "");
  keywords.parse(narg, arg);
  for (int k = 0; k < 2; k++) bit[k] = lmp->group->bitmask[group_of(lmp, "Fsi/" + name, names[k])];
  const Discretization &disc = FixFSI::find(lmp, "Fsi/" + name)->disc;
  lmp->init();
  renew_ghosts(lmp);
  return disc;
}

void FSIClamp::command(int narg, char **arg)
{
  std::string names[2];
  int bit[2];
  const Discretization &disc = prepare(lmp, "clamp", "free", "clamp", narg, arg, names, bit);
  if (names[0] == "all" || names[1] == "all")
    error->all(FLERR, "Fsi/clamp group-ID all: expected a group of a part");
  const int *const type = atom->type;
  int *const mask = atom->mask;
  const auto in = [&](int i, int k) {
    return mask[i] & bit[k] && disc.state[type[i]].form == TOTAL_LAGRANGIAN;
  };
  for (const auto &fix : modify->get_fix_by_style("^rigid"))
    if (find_particles(atom, world, [&](int i) {
          return in(i, 1) && mask[i] & fix->groupbit;
        }).count)
      error->all(FLERR,
                 "Fsi/clamp {} {}: fix {} (style {}) knows its particles already, and would not "
                 "move those that come: expected it after fsi/clamp",
                 names[0], names[1], fix->id, fix->style);
  if (update->first_update)
    error->all(FLERR,
               "Fsi/clamp {} {}: the body has moved, and would be held where it is: expected it "
               "before the first run",
               names[0], names[1]);
  const Cells clamps(atom, disc.dim, NEXT * disc.largest_cut, [&](int i) {
    return in(i, 1);
  });
  std::vector<int> over;
  for (int i = 0; i < atom->nlocal; i++) {
    const auto of_body = [&](int j) {
      return atom->molecule[j] == atom->molecule[i];
    };
    if (in(i, 0) && !in(i, 1) && clamps.any_within(atom->x[i], NEXT * disc.dx_of(type[i]), of_body))
      over.push_back(i);
  }
  bool moved = false;
  for (const int i : over) {
    mask[i] = (mask[i] & ~bit[0]) | bit[1];
    std::fill_n(atom->v[i], 3, 0.0);    // whoever moves the clamp gives it another
    moved |= (mask[i] & disc.mover->groupbit) != 0;
  }
  if (anywhere(moved, world))
    error->all(
        FLERR,
        "Fsi/clamp {} {}: fix {} (style fsi) would still move the particles that go to {}: "
        "expected its group {} as the first one, and one that it does not move as the second",
        names[0], names[1], disc.mover->id, names[1], group->names[disc.mover->igroup]);
  const bigint all = count_of(over.size(), world);
  if (all == 0)
    error->all(FLERR,
               "Fsi/clamp {} {}: no particle of the first group is within {} spacings of one of "
               "the second: expected two parts of one body (molecule ID) of pair style "
               "fsi/solid/tl",
               names[0], names[1], NEXT);
  if (comm->me == 0)
    utils::logmesg(lmp, "  fsi/clamp: {} particles go from {} to {}\n", all, names[0], names[1]);
}

static constexpr double NEVER = 1e9;

// This part of a particle's cell a cell of the body covers, squares or cubes. Cells of a lattice
// fill space, so the sum over the fluid is the body's volume in it, wherever the two lattices lie.
static double covered(const double *xi, double a, const double *xj, double b, int dim)
{
  double part = 1.0;
  for (int d = 0; d < dim; d++) {
    const double common = std::min({0.5 * (a + b) - std::fabs(xi[d] - xj[d]), a, b});
    part *= std::max(common, 0.0) / a;
  }
  return part;
}

// Of each particle of fluid that a body covers the key, of others NEVER; sum: how many, and their
// mass. First goes what is covered most and nearest to the body, in spacings, so that none that
// stays is too near; of the same by place.
template <class IsFluid, class IsBody>
static std::vector<double> find_covered(const LAMMPS *lmp, const Discretization &disc,
                                        IsFluid is_fluid, IsBody is_body, double *sum)
{
  const Atom *const atom = lmp->atom;
  double **const x = atom->x;
  const int *const type = atom->type;
  std::vector<double> key(atom->nlocal, NEVER);
  const Cells bodies(atom, disc.dim, disc.largest_cut, is_body);
  for (int i = 0; i < atom->nlocal; i++) {
    if (!is_fluid(i)) continue;
    const double dx = disc.dx_of(type[i]);
    double part = 0.0, nearest = 4.0 * dx;
    bodies.around(x[i], [&](int j, double) {
      part += covered(x[i], dx, x[j], disc.dx_of(type[j]), disc.dim);
      nearest =
          std::min(nearest, std::hypot(x[i][0] - x[j][0], x[i][1] - x[j][1], x[i][2] - x[j][2]));
    });
    if (part == 0.0) continue;
    sum[0] += part;
    sum[1] += part * atom->rmass[i];
    key[i] = std::floor((nearest / dx - part) * 1e4 + 0.5) + part_by_place(x[i], lmp->domain);
  }
  return key;
}

// What stays within the guard of a wall would be shot off: it moves out, if it can. How many do
template <class Stays, class IsBody>
static bigint keep_off_guards(LAMMPS *lmp, const Discretization &disc, const StepState &step,
                              Stays stays, IsBody is_body)
{
  constexpr int PASSES = 10;    // the next wall particle may be as near
  Atom *const atom = lmp->atom;
  const Cells bodies(atom, disc.dim, disc.largest_cut, [&](int j) {
    return is_body(j) && disc.state[atom->type[j]].species == RIGID;
  });
  bigint moved = 0;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!stays(i)) continue;
    double at[3];
    std::copy_n(atom->x[i], 3, at);
    bool within = false;
    for (int pass = 0; pass < PASSES; pass++) {
      const auto away = disc.out_of_guards(atom, bodies, disc.dx_of(atom->type[i]), at);
      within = within || MathExtra::len3(away.data()) > 0.0;
      for (int d = 0; d < 3; d++) at[d] += away[d];
    }
    if (!within || !step.walls.is_before_planes(at)) continue;
    std::copy_n(at, 3, atom->x[i]);
    moved++;
  }
  return count_of(moved, lmp->world);
}

void FSIDisplace::command(int narg, char **arg)
{
  std::string names[2];
  int bit[2];
  const Discretization &disc = prepare(lmp, "displace", "fluid", "body", narg, arg, names, bit);
  StepState *step;
  FixFSI::find(lmp, "Fsi/displace")->link(step);
  step->gather_walls(lmp);
  const int *const type = atom->type, *const mask = atom->mask;
  const auto is_fluid = [&](int i) {
    return mask[i] & bit[0] && disc.state[type[i]].species == FLUID;
  };
  const auto is_body = [&](int j) {
    return mask[j] & bit[1] && disc.state[type[j]].species != FLUID;
  };
  for (int k = 0; k < 2; k++)
    if (find_particles(atom, world, [&](int i) {
          return k == 0 ? is_fluid(i) : is_body(i);
        }).count == 0)
      error->all(FLERR, "Fsi/displace group-ID {} has no particle of {}", names[k],
                 k == 0 ? "a fluid" : "a body");

  double here[3] = {}, all[3];    // particles, mass in whose place the body is; what goes
  const auto key = find_covered(lmp, disc, is_fluid, is_body, here);
  MPI_Allreduce(here, all, 2, MPI_DOUBLE, MPI_SUM, world);

  const double limit = limit_of(key, std::llround(all[0]), -NEVER, NEVER, world);
  here[0] = 0.0;
  const std::string gone = "FSI_DISPLACED";
  const int igone = group->find_or_create(gone.c_str());
  for (int i = 0; i < atom->nlocal; i++)
    if (key[i] < limit) {
      atom->mask[i] |= group->bitmask[igone];
      here[0]++;
      here[2] += atom->rmass[i];
    }
  MPI_Allreduce(here, all, 3, MPI_DOUBLE, MPI_SUM, world);
  const bigint moved = keep_off_guards(
      lmp, disc, *step,
      [&](int i) {
        return is_fluid(i) && key[i] >= limit;
      },
      is_body);
  if (comm->me == 0)
    utils::logmesg(lmp,
                   "  fsi/displace: {} is in the place of {:.6g} of {}, {} particles of {:.6g} go, "
                   "{} move out of the guard of walls\n",
                   names[1], all[1], names[0], all[0], all[2], moved);
  if (all[0] == 0.0 && comm->me == 0)
    error->warning(FLERR, "Fsi/displace {} {}: the body is in no fluid", names[0], names[1]);
  input->one(fmt::format("delete_atoms group {} compress no", gone));
  input->one(fmt::format("group {} delete", gone));
}

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
  input->one(fmt::format("dump fsi_dump {} custom 1 \"{}\" {}", group, file, columns));
  input->one(fmt::format("dump_modify fsi_dump every/time {} time yes sort id{}", every, names));
}

// A name that is given again is the new material; a pair style has it from its next pair_coeff on.
void FSIMaterial::command(int narg, char **arg)
{
  auto *const avec = AtomVecFSI::of(atom);
  if (!avec) error->all(FLERR, "Fsi/material requires atom_style fsi before it");
  if (narg < 2)
    error->all(FLERR,
               "Fsi/material expects a name, fluid, solid or wall, and keywords with values, or "
               "file and the name of a material file");
  if (narg == 2 && strcmp(arg[0], "file") == 0) {
    for (const Material &m : read_all_materials(lmp, arg[1])) avec->materials[m.name] = describe(m);
    return;
  }
  const std::string name = arg[0];
  if (name == describe({}))
    error->all(FLERR, "Fsi/material {}: this name stands for no material in pair_coeff", name);
  std::string line = name;
  for (int k = 1; k < narg; k++) line += std::string(" ") + arg[k];
  if (comm->me == 0)
    read_material(lmp, "of command fsi/material", line);    // what is wrong with it is an error
  MPI_Barrier(world);
  avec->materials[name] = line;
}

// fsi/set (its arguments: fsi_set.rst). The mass follows the density, so that a particle keeps the
// volume of its place in the lattice: else still water settles off (doc/notes/fluid.md, Density)
enum Given { DENSITY, PRESSURE, HYDROSTATIC, VOLUME };

// whether it has been set
static bool set_density(const LAMMPS *lmp, int i, int what, const std::string &name, double value,
                        const State &s, const BodyForces &forces)
{
  const Atom *const atom = lmp->atom;
  if (s.species == NONE || s.species == RIGID) return false;    // walls: from the fluid
  if (s.form == TOTAL_LAGRANGIAN) return false;                 // density from its strain
  double rho = what == PRESSURE ? s.density(value) : value;
  if (what == HYDROSTATIC) {
    const auto g = forces.on(i);
    const double *x = atom->x[i], size = std::sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
    if (size == 0.0)
      lmp->error->one(FLERR, "Fsi/set hydrostatic: no fix gravity acts on atom {}", atom->tag[i]);
    const double height = -(g[0] * x[0] + g[1] * x[1] + g[2] * x[2]) / size;
    if (height > value) return false;
    rho = s.density(s.rho0 * size * (value - height) + s.p0);
  }
  if (!(rho > 0.0 && rho < Range::LARGEST))
    lmp->error->one(FLERR, "Fsi/set {} {} must be > 0",
                    what == Given::DENSITY ? "density" : name + ": density", rho);
  atom->rmass[i] *= rho / atom->rho[i];
  atom->rho[i] = rho;
  return true;
}

void FSISet::command(int narg, char **arg)
{
  if (domain->box_exist == 0) error->all(FLERR, "Fsi/set command before simulation box is defined");
  static const std::vector<std::string> names = {"density", "pressure", "hydrostatic", "volume"};
  std::string group_name, given;
  int what;
  Keywords keywords(lmp, "fsi/set");
  keywords.argument("group-ID").word(group_name, "");
  keywords.argument("keyword").choice(what, Given::DENSITY, names);
  keywords.argument("value").word(given, "");
  keywords.parse(narg, arg);
  const int igroup = group_of(lmp, "Fsi/set", group_name);
  int variable = -1;
  if (utils::strmatch(given, "^v_") && what != HYDROSTATIC) {
    variable = input->variable->find(given.c_str() + 2);
    if (variable < 0 || !input->variable->atomstyle(variable))
      error->all(FLERR, "Fsi/set {} {} is not an atom-style variable", names[what], given);
  }
  const double number = variable < 0 ? numeric(lmp, "Fsi/set " + names[what], given) : 0.0;

  FixFSI *const fix_fsi = FixFSI::find(lmp, "Fsi/set");
  if (update->ntimestep > 0 && comm->me == 0)
    error->warning(FLERR,
                   "Fsi/set {} {} after {} steps: masses change with densities, which is meant "
                   "before the first run",
                   group_name, names[what], update->ntimestep);
  lmp->init();    // materials, masses and gravity are entered there
  BodyForces &forces = fix_fsi->step.body_forces;
  forces.evaluate(fix_fsi->disc.state);
  if (what == HYDROSTATIC && std::none_of(forces.all.begin(), forces.all.end(), [](const auto &f) {
        return f.mask;
      }))
    refuse(error, Refused::HYDROSTATIC);

  std::vector<double> each(atom->nlocal, number);
  if (variable >= 0) input->variable->compute_atom(variable, igroup, each.data(), 1, 0);
  bigint count = 0;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & group->bitmask[igroup])) continue;
    if (what == VOLUME && !(each[i] > 0.0))
      error->one(FLERR, "Fsi/set volume {} must be > 0", each[i]);
    if (what == VOLUME) {
      // the density of a wall is that of the pressure on it
      const State &s = fix_fsi->disc.state[atom->type[i]];
      atom->rmass[i] = (s.species == RIGID ? s.rho0 : atom->rho[i]) * each[i];
    }
    count += what == VOLUME ||
        set_density(lmp, i, what, names[what], each[i], fix_fsi->disc.state[atom->type[i]], forces);
  }
  if (what == VOLUME) fix_fsi->check.know_masses();
  const bigint all = count_of(count, world);
  if (all == 0 && comm->me == 0)
    error->warning(FLERR, "Fsi/set {} {} {} acts on no particle", group_name, names[what], given);
  if (comm->me == 0)
    utils::logmesg(lmp, "  fsi/set: {} of {} particles\n", what == VOLUME ? "mass" : "density",
                   all);
}
