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

#include "fix_fsi_refine.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix_fsi.h"
#include "fix_fsi_inlet.h"
#include "fsi_fields.h"
#include "fsi_find.h"
#include "fsi_gather.h"
#include "fsi_hub.h"
#include "fsi_kernel.h"
#include "fsi_keywords.h"
#include "fsi_population.h"
#include "fsi_record.h"
#include "fsi_refine.h"
#include "fsi_sight.h"
#include "math_extra.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace FSI;

// Spacings from one level to the next: half the mass, so long as this part of it
static constexpr double RATIO_ERROR = 0.02;
// Distance in spacings over which two merge; over which one does that has found none at the edge
// of its zone, and is half as far again out as need be
static constexpr double REACH = 1.2, FAR_REACH = 1.7, FAR = 1.5;
// Nearer pairs come first: in steps of an eighth of a spacing, with edges that no lattice's
// distances are near, since the two see their distance with different round-off
static constexpr double PER_SPACING = 8.0, OFF_LATTICE = 0.37;
// One that has found no partner comes before all others: further out there is none left for it
static constexpr int LATER = 100;
static constexpr int ROUNDS = 3;          // of choosing partners
static constexpr double CROWDED = 2.5;    // spacings: what is as near makes a place less empty
static constexpr int SWEEPS = 12;         // of choosing a direction again
static constexpr size_t MAX_LEVELS = 12;
static constexpr double SAME = 1.0e-12;      // what comes from one material
static constexpr double TOO_COARSE = 1.5;    // spacing of a fluid over that of a body it meets
static constexpr int PASSES = 3;             // out of guards: the next wall particle may be as near

FixFSIRefine::FixFSIRefine(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), label("Fix fsi/refine"), zones(new Zones(lmp, label))
{
  if (!atom->style_match("fsi")) error->all(FLERR, "{} requires atom_style fsi", label);
  if (narg < 4) utils::missing_cmd_args(FLERR, "fix fsi/refine", error);
  every = integer(lmp, label + " N", arg[3], 1);
  level_of.assign(atom->ntypes + 1, -1);
  static const std::vector<std::string> keys = {"types", "finest", "region", "distance", "settle"};
  for (int k = 4; k < narg;) {
    const std::string key = arg[k++];
    const bool one = key == "settle" || key == "finest";
    std::vector<std::string> values;
    while (k < narg && !(one && values.size()) &&
           std::find(keys.begin(), keys.end(), arg[k]) == keys.end())
      values.emplace_back(arg[k++]);
    if (one && values.empty()) utils::missing_cmd_args(FLERR, "fix fsi/refine " + key, error);
    if (key == "types")
      read_types(values);
    else if (key == "region")
      zones->read_regions(values);
    else if (key == "distance")
      zones->read_distances(values);
    else if (key == "settle")
      settle_steps = integer(lmp, label + " settle", values[0], 0, 1000);
    else if (key == "finest")
      finest_dx = numeric(lmp, label + " finest", values[0], Range::above(0.0));
    else
      error->all(FLERR, "Unknown fix fsi/refine keyword {}: expected {}", key, list_of(keys));
  }
  if (finest_dx > 0.0 ? !types.empty() : types.size() < 2)
    error->all(FLERR,
               "{} requires keyword types with two atom types or more, the coarsest first, or "
               "keyword finest",
               label);
  zones->check_number(types.size());
  directions = split_directions(domain->dimension);
  force_reneighbor = 1;
  vector_flag = 1;
  size_vector = NTOTAL;
  extvector = 1;
  global_freq = 1;
  restart_global = 1;
}

FixFSIRefine::~FixFSIRefine() = default;

void FixFSIRefine::read_types(const std::vector<std::string> &words)
{
  types.clear();
  for (const auto &word : words) {
    const int type = integer(lmp, label + " types", word, 1, atom->ntypes);
    if (level_of[type] >= 0) error->all(FLERR, "{} types: {} is there twice", label, type);
    level_of[type] = (int) types.size();
    types.push_back(type);
  }
  if (types.size() > MAX_LEVELS)
    error->all(FLERR, "{} types: there are {}, expected {} at most", label, types.size(),
               MAX_LEVELS);
}

// Those that pair_coeff keeps. Of them as many are wanted as there are levels down to the spacing;
// of the others, of a fix before this one, all particles merge
void FixFSIRefine::find_types()
{
  const auto &kept = disc->types_of_levels;
  const int dim = disc->dim, given = (int) kept.size() - 1;
  if (given < 0) error->all(FLERR, "{} finest requires a fluid", label);
  const double coarse = disc->dx_of(kept[0]);
  const int number =
      (int) std::clamp(std::lround(dim * std::log2(coarse / finest_dx)), 1L, (long) MAX_LEVELS - 1);
  const double nearest = coarse * std::pow(2.0, -(double) number / dim);
  if (std::fabs(finest_dx / nearest - 1.0) > RATIO_ERROR)
    error->all(FLERR,
               "{} finest: {:g} is not the spacing of a finer level, {:g} times 2^(-k/{}): the "
               "nearest is {:g}",
               label, finest_dx, coarse, dim, nearest);
  if (given < number)
    error->all(FLERR,
               "{} finest: from {:g} to {:g} there are {} levels, for which pair_coeff keeps {} "
               "atom types: expected create_box {} and, as the last word of pair_coeff, levels",
               label, coarse, finest_dx, number, given, atom->ntypes + number - given);
  types.assign(kept.begin(), kept.begin() + std::min((size_t) given, MAX_LEVELS - 1) + 1);
  level_of.assign(atom->ntypes + 1, -1);
  for (size_t k = 0; k < types.size(); k++) level_of[types[k]] = k;
  finest = number;
}

void FixFSIRefine::init()
{
  FixFSI::find(lmp, label)->link(disc, step, ledger, ghosts, population);
  if (!facts_of_fluids(lmp).style)
    error->all(FLERR, "{} requires pair_style fsi/fluid: it is for fluids", label);
  finest = (int) types.size() - 1;
  if (finest_dx > 0.0) find_types();
  check_types();
  check_others();
  zones->init(*disc, {types.begin(), types.begin() + finest + 1});
  open_ends = fixes_of<FixFSIInlet>(lmp);
  next_reneighbor = (update->ntimestep / every + 1) * every;
  warned = false;
  population->leave_an_id_free();
}

// levels are of one fluid, and each has half the mass of the one before
void FixFSIRefine::check_types() const
{
  const double expected = std::pow(2.0, -1.0 / disc->dim);
  const State &first = disc->state[types[0]];
  for (int k = 0; k < (int) types.size(); k++) {
    const State &s = disc->state[types[k]];
    if (s.species != FLUID)
      error->all(FLERR, "{}: atom type {} is no fluid: its material is {}", label, types[k],
                 s.species == NONE        ? "missing"
                     : s.species == SOLID ? "a solid"
                                          : "a wall");
    const auto differs = [&](const char *what, double a, double b) {
      if (std::fabs(a - b) > SAME * std::fabs(a))
        error->all(FLERR,
                   "{}: atom types {} and {} have the {} {:g} and {:g}: expected one fluid, of "
                   "one material",
                   label, types[0], types[k], what, a, b);
    };
    differs("density", first.rho0, s.rho0);
    differs("sound", first.c, s.c);
    differs("viscosity", first.viscosity, s.viscosity);
    differs("background pressure", first.p0, s.p0);
    differs("lowest pressure", first.floor, s.floor);
    const bool laws = !(first.law == s.law);
    if (laws || first.tait != s.tait)
      error->all(FLERR, "{}: atom types {} and {} have different {}", label, types[0], types[k],
                 laws ? "laws of viscosity" : "equations of state");
    if (k == 0) continue;
    const double coarse = disc->dx_of(types[k - 1]), fine = disc->dx_of(types[k]);
    if (std::fabs(fine / coarse / expected - 1.0) > RATIO_ERROR)
      error->all(FLERR,
                 "{}: atom types {} and {} have spacings of {:g} and {:g}: expected {:g} of the "
                 "second, 2^(-1/{}) of the first, for particles of half the mass: fix fsi spacing",
                 label, types[k - 1], types[k], coarse, fine, expected * coarse, disc->dim);
  }
}

// what one splits in its zone another would merge again, outside of its own, and so on for ever
void FixFSIRefine::check_others() const
{
  for (const auto *const other : fixes_of<FixFSIRefine>(lmp)) {
    const bool same = std::any_of(types.begin(), types.end(), [other](int t) {
      return other->level_of[t] >= 0;
    });
    if (other == this || !same) continue;
    const auto both = find_particles(atom, world, [&](int i) {
      return level(i) >= 0 && (atom->mask[i] & other->groupbit);
    });
    if (both.count)
      error->all(FLERR,
                 "{}: fix {} and fix {} both have levels of {} particles, the first of them atom "
                 "{}: expected one fix, with regions that are unions of others",
                 label, id, other->id, both.count, both.first);
  }
}

// Before the first step, if it is one of those: all that is too coarse. Open ends begin with what
// is coarse, whichever fix comes first
void FixFSIRefine::setup_pre_exchange()
{
  for (auto *end : open_ends) end->setup_pre_exchange();
  const bool due = update->ntimestep % every == 0 && last_event != update->ntimestep;
  for (int k = 0; k < (due ? finest : 1); k++) event(due, false);
}

void FixFSIRefine::pre_exchange()
{
  if (update->ntimestep % every) return;
  next_reneighbor = update->ntimestep + every;
  event(true, true);
}

void FixFSIRefine::event(bool may_split, bool may_merge)
{
  const bool first = update->ntimestep == update->firststep;
  renew_ghosts(lmp);          // those that lists of before have are a step old
  step->gather_walls(lmp);    // likewise those of the last force
  if (disc->sight) disc->sight->find_bodies();
  std::fill_n(local, NTOTAL, 0.0);
  look(may_split, may_merge);
  if (zones->moving() || first) check_zones();
  if (first) warn_of_bodies();

  const auto divisions = plan_divisions();
  if (may_merge) choose_partners();
  std::vector<int> gone;
  const auto unions = may_merge ? plan_unions(gone) : std::vector<Union>();
  local[SPLITS] = divisions.size();
  local[MERGES] = unions.size();
  double all[NTOTAL];
  MPI_Allreduce(local, all, NTOTAL, MPI_DOUBLE, MPI_SUM, world);
  for (int k = 0; k < WAITING; k++) total[k] += all[k];
  if (may_merge) total[WAITING] = all[WAITING];
  if (may_split) last_event = update->ntimestep;
  if (all[SPLITS] == 0.0 && all[MERGES] == 0.0) return;

  unite(unions);
  population->begin();
  std::vector<Position> events;
  const auto add_event = [&](int i) {
    Position x = {atom->x[i][0], atom->x[i][1], atom->x[i][2]};
    domain->remap(x.data());
    events.push_back(x);
  };
  for (const auto &merged : unions) add_event(merged.i);
  const int before = atom->nlocal;
  divide(divisions);
  for (const auto &two : divisions) add_event(two.i);
  for (int i = before; i < atom->nlocal; i++) add_event(i);
  std::vector<tagint> released;
  for (const int i : gone) released.push_back(atom->tag[i]);
  population->remove(gone, ledger->account(Ledger::LEVELS));
  population->release(released);
  population->end();
  if (settle_steps == 0) return;
  renew_ghosts(lmp);
  std::vector<char> moves(atom->nlocal);
  for (int i = 0; i < atom->nlocal; i++)
    moves[i] = level(i) >= 0 && !in_open_end(i, 0) && is_moved(i, lmp);
  Settling(lmp, *disc, *step, *ledger, moves, events).run(settle_steps);
}

// Of each particle: the zones that it is in, and what it is to do. A particle merges a coarse
// spacing outside of its zone, so that one that moves to and fro at the edge does not change.
void FixFSIRefine::look(bool may_split, bool may_merge)
{
  const bool at_start = update->ntimestep == update->firststep;    // else in the middle of a step
  zones->find(*disc, FAR * disc->dx_of(types[0]), at_start ? 0.0 : 0.5 * update->dt);
  carried.assign(atom->nlocal + atom->nghost, 0);
  for (int i = 0; i < atom->nlocal; i++) {
    const int now = level(i);
    if (now < 0) continue;
    check_mass(i);
    int wish = 0;
    for (int k = 1; k <= finest; k++)
      if (zones->has(k, i, 0.0)) wish |= 1 << k;
    const bool leaves = in_open_end(i, wish);
    if (may_split && now < finest && (wish & 1 << (now + 1))) wish |= SPLIT;
    if (may_merge && now > 0 && !leaves && !(wish & 1 << now)) {
      const double margin = disc->dx_of(types[now - 1]);
      const auto within = [&](double distance) {
        return now <= finest && zones->has(now, i, distance);
      };
      if (!within(margin)) wish |= within(FAR * margin) ? MERGE : MERGE | EAGER;
    }
    carried[i] = wish;
  }
  ghosts->send(carried);
}

// a level is a mass, too: a type set since leaves those of another one
void FixFSIRefine::check_mass(int i) const
{
  const int t = atom->type[i];
  const double m = atom->rmass[i], usual = lattice_mass(*disc, t);
  if (m > 0.6 * usual && m < 1.6 * usual) return;
  error->one(FLERR,
             "{}: atom {} of type {} has mass {:g}, expected some {:g} on this level. Commands "
             "that set types leave masses as they are: set ... mass",
             label, atom->tag[i], t, m, usual);
}

// of this group, and a level of its fluid
int FixFSIRefine::level(int i) const
{
  return (atom->mask[i] & groupbit) ? level_of[atom->type[i]] : -1;
}

// what is in a buffer is left to that, also one that has found no partner on its way
bool FixFSIRefine::in_open_end(int i, int wish) const
{
  const double *const x = atom->x[i];
  for (const auto *end : open_ends) {
    if (!end->holds(x)) continue;
    if (wish)
      error->one(FLERR,
                 "Atom {} at {} is in the buffer of fix {}, and in the zone of a finer "
                 "level: keep open ends in the coarsest level, away from what fix {} refines",
                 atom->tag[i], place_text(x), end->id, id);
    return true;
  }
  return false;
}

// Between the zone of a level and the end of that of the one before: at least the support of the
// coarser one's kernel. As far as there is fluid.
void FixFSIRefine::check_zones() const
{
  for (int k = 1; k < finest; k++) {
    const double support = disc->resolution[types[k - 1]].cut;
    const Cells inner(atom, disc->dim, support, [&](int j) {
      return level(j) >= 0 && (carried[j] & 1 << (k + 1));
    });
    for (int i = 0; i < atom->nlocal; i++) {
      if (level(i) < 0 || (carried[i] & 1 << k)) continue;
      const double *const x = atom->x[i];
      inner.around(x, [&](int j, double rsq) {
        if (rsq >= support * support) return;
        error->one(FLERR,
                   "Atom {} at {} is not in the zone of type {}, but only {:.3g} from "
                   "atom {}, which is in that of type {}{}: fix {} needs zones inside each other, "
                   "at least the kernel's support of type {} apart, {:g}",
                   atom->tag[i], place_text(x), types[k], std::sqrt(rsq), atom->tag[j],
                   types[k + 1], zones->names(k), id, types[k - 1], support);
      });
    }
  }
}

// bodies and walls meet fluid of their own spacing
void FixFSIRefine::warn_of_bodies()
{
  if (warned) return;
  warned = true;
  const int *const type = atom->type;
  const Cells bodies(atom, disc->dim, disc->cut, [&](int j) {
    return disc->state[type[j]].is_body();
  });
  const auto coarse = find_particles(atom, world, [&](int i) {
    const int now = level(i);
    if (now < 0 || now >= finest || (carried[i] & SPLIT)) return false;
    const double dx = disc->dx_of(type[i]);
    return bodies.any_within(atom->x[i], dx, [&](int j) {
      return dx > TOO_COARSE * disc->dx_of(type[j]);
    });
  });
  if (coarse.count && comm->me == 0)
    error->warning(FLERR,
                   "{}: {} fluid particles, the first of them atom {}, are beside a body or wall "
                   "of finer spacing: let the finest level reach a kernel's support beyond bodies",
                   label, coarse.count, coarse.first);
}

// Past thin bodies beside i, through which none splits or merges, or null
const Sight *FixFSIRefine::sight_from(int i) const
{
  Sight *const sight = disc->sight.get();
  if (!sight || !sight->near(atom->x[i])) return nullptr;
  sight->look_from(atom->x[i], disc->resolution[atom->type[i]].cut);
  return sight;
}

static uint64_t hash_of(tagint a, tagint b)
{
  uint64_t hash = 14695981039346656037ULL;
  for (const auto tag : {std::min(a, b), std::max(a, b)})
    for (int k = 0; k < 64; k += 8) hash = (hash ^ ((uint64_t) tag >> k & 255)) * 1099511628211ULL;
  return hash;
}

// Splitting. Halves stay as far from mirror walls as particles of their spacing, and in the box
double FixFSIRefine::crowd_of_walls(const double *x, double dx) const
{
  double sum = 0.0;
  for (const auto &wall : step->walls.wall) {
    if (!wall.spans(x, dx)) continue;
    const double s = wall.distance(x);
    if (wall.finite && s <= 0.0) continue;    // nothing splits through it: see Sight
    if (s <= 0.0) return HUGE_VAL;
    const double q = 0.5 * dx / s;
    sum += q * q * q * q;
  }
  for (int d = 0; d < disc->dim; d++)
    if (!domain->periodicity[d] && (x[d] <= domain->boxlo[d] || x[d] >= domain->boxhi[d]))
      return HUGE_VAL;
  return sum;
}

// velocity and density at the halves' places are those of linear fields through the neighbors;
// a density that is the largest or smallest around stays
template <int D> void FixFSIRefine::slopes(Division &two, const Cells &cells) const
{
  double *const *const x = atom->x, *const *const v = atom->v, *const rho = atom->rho;
  const int i = two.i;
  const double dx = disc->dx_of(atom->type[i]), cut = disc->resolution[atom->type[i]].cut;
  const Sight *const sight = sight_from(i);
  std::vector<int> near;    // the same sums in whatever order particles are
  cells.around(x[i], [&](int j, double rsq) {
    if (j == i || rsq >= cut * cut || level(j) < 0) return;
    if (!sight || sight->visible(x[j], cut) == 1.0) near.push_back(j);
  });
  std::sort(near.begin(), near.end(), [&](int a, int b) {
    return atom->tag[a] != atom->tag[b] ? atom->tag[a] < atom->tag[b] : a < b;
  });
  Slopes<D, D + 1> fit;
  double low = rho[i], high = rho[i];
  for (const int j : near) {
    double away[D], difference[D + 1], rsq = 0.0;
    for (int d = 0; d < D; d++) {
      away[d] = (x[j][d] - x[i][d]) / dx;
      rsq += away[d] * away[d];
      difference[d] = v[j][d] - v[i][d];
    }
    const double q = 1.0 - rsq * dx * dx / (cut * cut);
    difference[D] = rho[j] - rho[i];
    low = std::min(low, rho[j]);
    high = std::max(high, rho[j]);
    fit.add(away, q * q * atom->rmass[j] / rho[j], difference);
  }
  fit.solve();
  double drho = 0.0;
  for (int d = 0; d < D; d++) {
    for (int a = 0; a < D; a++) two.dv[d] += fit.slope[d][a] * two.dx[a] / dx;
    drho += fit.slope[D][d] * two.dx[d] / dx;
  }
  const double most = std::min(rho[i] - low, high - rho[i]);
  two.drho = std::clamp(drho, -most, most);
}

int FixFSIRefine::choose_direction(int i, const Cells &cells) const
{
  const double *const x = atom->x[i];
  const int dim = disc->dim;
  const double dx = disc->dx_of(atom->type[i]), finer = split_spacing(dim),
               distance = split_distance(dim) * dx, reach = CROWDED * dx,
               cut = disc->resolution[atom->type[i]].cut;
  const Sight *const sight = sight_from(i);
  std::vector<SplitNeighbor> crowd;
  cells.around(x, [&](int j, double rsq) {
    if (j == i || rsq > reach * reach) return;
    SplitNeighbor n;
    MathExtra::sub3(atom->x[j], x, n.x);
    const double of_j = disc->dx_of(atom->type[j]);
    if (heading[j] == 0) {
      n.spacing = 0.5 * (finer * dx + of_j);
      crowd.push_back(n);
      return;
    }
    n.spacing = 0.5 * finer * (dx + of_j);
    const auto &e = directions[heading[j] - 1];
    const double to = split_distance(dim) * of_j;
    for (int d = 0; d < 3; d++) n.x[d] += to * e[d];
    crowd.push_back(n);
    for (int d = 0; d < 3; d++) n.x[d] -= 2.0 * to * e[d];
    crowd.push_back(n);
  });
  return split_direction(directions, crowd, distance, [&](const double *offset) {
    double at[3], behind[3];    // of its cell
    for (int d = 0; d < 3; d++) {
      at[d] = x[d] + offset[d];
      behind[d] = at[d] + 0.5 * finer * dx / distance * offset[d];
    }
    if (sight && sight->visible(behind, cut) < 1.0) return HUGE_VAL;
    return crowd_of_walls(at, dx);
  });
}

// Many may split at once, next to each other: they choose again when they know what their
// neighbors have chosen, half of them at a time, lest two step aside into each other's way
void FixFSIRefine::choose_directions(const std::vector<int> &which, const Cells &cells)
{
  heading.assign(atom->nlocal + atom->nghost, 0);
  for (int sweep = 0; sweep <= SWEEPS; sweep++) {
    std::vector<tagint> next(heading.begin(), heading.begin() + atom->nlocal);
    for (const int i : which)
      if (sweep == 0 || (hash_of(atom->tag[i], sweep) >> 20 & 1))
        next[i] = 1 + choose_direction(i, cells);
    std::copy(next.begin(), next.end(), heading.begin());
    ghosts->send(heading);
  }
}

// Not within the guard of a wall or solid, which would push them with energy out of nothing:
// both halves are as much farther from it
void FixFSIRefine::keep_off_bodies(Division &two, const Cells &cells) const
{
  const double *const x = atom->x[two.i], fine = disc->dx_of(types[level(two.i) + 1]);
  for (int pass = 0; pass < 2 * PASSES; pass++) {
    const double to = pass % 2 ? 1.0 : -1.0;
    double at[3];
    for (int d = 0; d < 3; d++) at[d] = x[d] + two.off[d] + to * two.dx[d];
    const auto away = disc->out_of_guards(atom, cells, fine, at);
    for (int d = 0; d < 3; d++) two.off[d] += away[d];
  }
}

// likewise what two become: the guard of the coarser level is wider
void FixFSIRefine::keep_off_bodies(std::vector<Union> &list) const
{
  const Cells bodies(atom, disc->dim, disc->cut, [&](int j) {
    return disc->state[atom->type[j]].is_body();
  });
  for (auto &merged : list)
    for (int pass = 0; pass < PASSES; pass++) {
      const double coarse = disc->dx_of(types[level(merged.i) - 1]);
      const auto away = disc->out_of_guards(atom, bodies, coarse, merged.x);
      for (int d = 0; d < 3; d++) merged.x[d] += away[d];
    }
}

std::vector<FixFSIRefine::Division> FixFSIRefine::plan_divisions()
{
  std::vector<Division> list;
  std::vector<int> which;
  for (int i = 0; i < atom->nlocal; i++)
    if (carried[i] & SPLIT) which.push_back(i);
  if (!anywhere(!which.empty(), world)) return list;
  std::sort(which.begin(), which.end(), [&](int a, int b) {
    return atom->tag[a] < atom->tag[b];
  });
  const Cells cells(atom, disc->dim, disc->cut, [&](int j) {
    return disc->state[atom->type[j]].species != NONE;
  });
  choose_directions(which, cells);
  for (const int i : which) {
    if (heading[i] == 0) continue;    // no room: next time
    Division two;
    two.i = i;
    const double distance = split_distance(disc->dim) * disc->dx_of(atom->type[i]);
    for (int d = 0; d < 3; d++) two.dx[d] = distance * directions[heading[i] - 1][d];
    disc->dim == 2 ? slopes<2>(two, cells) : slopes<3>(two, cells);
    keep_off_bodies(two, cells);
    list.push_back(two);
    const double m = atom->rmass[i];
    double spin[3];
    MathExtra::cross3(two.dx, two.dv, spin);
    local[GAINED] += 0.5 * m * MathExtra::lensq3(two.dv);
    for (int d = 0; d < 3; d++) local[SPIN + d] -= m * spin[d];
  }
  return list;
}

// Merging: pairs of which each is the other's best partner, by distance, then by a hash of both
// IDs, which knows no direction; then those that are left. Whole numbers, the same on all ranks.
void FixFSIRefine::choose_partners()
{
  const tagint *const tag = atom->tag;
  partner.assign(atom->nlocal + atom->nghost, 0);
  chosen.assign(atom->nlocal, -1);
  const auto wants = [&](int i) {
    return (carried[i] & MERGE) != 0;
  };
  const Cells cells(atom, disc->dim, FAR_REACH * disc->dx_of(types[1]), wants);
  for (int round = 0; round < ROUNDS; round++) {
    for (int i = 0; i < atom->nlocal; i++) {
      if (!wants(i) || partner[i] < 0) continue;
      chosen[i] = best_partner(i, cells);
      partner[i] = chosen[i] < 0 ? 0 : tag[chosen[i]];
    }
    ghosts->send(partner);
    std::vector<int> found;
    for (int i = 0; i < atom->nlocal; i++)
      if (partner[i] > 0 && partner[chosen[i]] == tag[i]) found.push_back(i);
    for (const int i : found) partner[i] = -partner[i];
    ghosts->send(partner);
  }
  for (int i = 0; i < atom->nlocal; i++) local[WAITING] += wants(i) && partner[i] >= 0;
}

// of those that have none; -1: there is none in reach
int FixFSIRefine::best_partner(int i, const Cells &cells) const
{
  const tagint *const tag = atom->tag;
  const double per_dx = 1.0 / disc->dx_of(atom->type[i]), cut = disc->resolution[atom->type[i]].cut;
  const Sight *const sight = sight_from(i);
  std::pair<int, uint64_t> best;
  int found = -1;
  cells.around(atom->x[i], [&](int j, double rsq) {
    if (tag[j] == tag[i] || partner[j] < 0 || atom->type[j] != atom->type[i]) return;
    const bool eager = (carried[i] | carried[j]) & EAGER;
    const double q = std::sqrt(rsq) * per_dx;
    if (q >= (eager ? FAR_REACH : REACH)) return;
    if (sight && sight->visible(atom->x[j], cut) < 1.0) return;
    const std::pair<int, uint64_t> key = {
        (eager ? 0 : LATER) + (int) (PER_SPACING * q + OFF_LATTICE), hash_of(tag[i], tag[j])};
    if (found >= 0 && !(key < best)) return;
    best = key;
    found = j;
  });
  return found;
}

// the one of the lower ID becomes both, on its rank; the other's rank deletes it
std::vector<FixFSIRefine::Union> FixFSIRefine::plan_unions(std::vector<int> &gone)
{
  std::vector<Union> list;
  for (int i = 0; i < atom->nlocal; i++) {
    if (partner[i] >= 0) continue;
    const int j = chosen[i];
    if (atom->tag[j] < atom->tag[i]) {
      gone.push_back(i);
      continue;
    }
    const double m = atom->rmass[i], n = atom->rmass[j], part = n / (m + n), reduced = m * part;
    double away[3], faster[3], spin[3];
    MathExtra::sub3(atom->x[j], atom->x[i], away);
    MathExtra::sub3(atom->v[j], atom->v[i], faster);
    Union merged;
    merged.i = i;
    merged.energy = population->energy(i);    // a ghost has no image flags: see remove()
    merged.rmass = m + n;
    merged.rho = merged.rmass / (m / atom->rho[i] + n / atom->rho[j]);
    for (int d = 0; d < 3; d++) {
      merged.x[d] = atom->x[i][d] + part * away[d];
      merged.v[d] = atom->v[i][d] + part * faster[d];
    }
    list.push_back(merged);
    MathExtra::cross3(away, faster, spin);
    local[LOST] += 0.5 * reduced * MathExtra::lensq3(faster);
    for (int d = 0; d < 3; d++) local[SPIN + d] += reduced * spin[d];
  }
  if (!list.empty()) keep_off_bodies(list);
  return list;
}

void FixFSIRefine::unite(const std::vector<Union> &unions)
{
  double *const account = ledger->account(Ledger::LEVELS);
  for (const auto &merged : unions) {
    const int i = merged.i;
    std::copy_n(merged.x, 3, atom->x[i]);
    std::copy_n(merged.v, 3, atom->v[i]);
    atom->rho[i] = merged.rho;
    atom->rmass[i] = merged.rmass;
    atom->type[i] = types[level(i) - 1];
    if (account) *account += merged.energy - population->energy(i);
  }
}

void FixFSIRefine::divide(const std::vector<Division> &divisions)
{
  double *const account = ledger->account(Ledger::LEVELS);
  std::vector<tagint> parents;
  for (const auto &two : divisions) parents.push_back(atom->tag[two.i]);
  auto all = gather(parents, world);
  std::sort(all.begin(), all.end());
  const auto ids = population->ids((int) all.size(), label);
  for (const auto &two : divisions) {
    const int i = two.i;
    if (account) *account += population->energy(i);
    atom->type[i] = types[level(i) + 1];
    atom->rmass[i] *= 0.5;
    const auto nth = std::lower_bound(all.begin(), all.end(), atom->tag[i]) - all.begin();
    const int j = population->copy(i, ids[nth]);
    const auto move = [&](int k, double to) {
      for (int d = 0; d < disc->dim; d++) {
        atom->x[k][d] += two.off[d] + to * two.dx[d];
        atom->v[k][d] += to * two.dv[d];
      }
      atom->rho[k] += to * two.drho;
      if (account) *account -= population->energy(k);
    };
    move(i, 1.0);
    move(j, -1.0);
  }
}

void FixFSIRefine::write_restart(FILE *fp)
{
  Record record(lmp, style);
  record.add("totals", std::vector<double>(total, total + NTOTAL));
  record.add("last event", std::to_string(last_event));
  record.write(fp);
}

void FixFSIRefine::restart(char *buf)
{
  const Record record(lmp, style, buf);
  const auto totals = record.numbers("totals");
  std::copy_n(totals.begin(), std::min(totals.size(), (size_t) NTOTAL), total);
  last_event = std::stoll(record.value("last event"));
}

double FixFSIRefine::memory_usage()
{
  return bytes_of(carried, partner, heading, chosen);
}
