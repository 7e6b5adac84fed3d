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

#include "fsi_pair_sets.h"

#include "atom.h"
#include "error.h"
#include "force.h"
#include "fsi_cells.h"
#include "fsi_kernel.h"
#include "fsi_sight.h"
#include "neigh_list.h"
#include "neighbor.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace FSI;

void PairSets::init(const Discretization &disc_in, StepState &step_in, bool full)
{
  disc = &disc_in;
  step = &step_in;
  fluid_types.clear();
  other_types.clear();
  is_fluid.assign(atom->ntypes + 1, 0);
  has_solids = false;
  for (int t = 1; t <= atom->ntypes; t++) {
    const int species = disc->state[t].species;
    if (species == NONE) continue;
    (species == FLUID ? fluid_types : other_types).push_back(t);
    is_fluid[t] = species == FLUID;
    has_solids = has_solids || species == SOLID;
  }
  sets.clear();
  beside.clear();
  of_hidden.clear();
  add_sets_of_levels(full);
  for (auto &set : sets) find_ratios(set);
  if (!disc->sight) return;
  disc->sight->tabulate();
  for (const size_t k : of_two_levels) {
    PairSet set = sets[k];
    set.what = PairSet::HIDDEN;
    set.loops = set.of_forces = make_fluid_loops(disc->kernel, disc->dim, set.h, false);
    of_hidden.push_back(sets.size());
    sets.push_back(set);
  }
}

void PairSets::add_sets_of_levels(bool full)
{
  const auto &levels = disc->levels;
  const size_t n = levels.size();
  of_two_levels.assign(n * n, 0);
  const auto make_loops = [this](double h, bool packs) {
    return make_fluid_loops(disc->kernel, disc->dim, h, packs);
  };
  for (size_t l = 0; l < n; l++) {
    PairSet set;
    set.level = l;
    set.h = levels[l].h;
    set.cut = levels[l].cut;
    set.wdx = levels[l].wdx;
    const auto loops = make_loops(levels[l].h, have_packs());
    of_two_levels[n * l + l] = sets.size();
    for (set.what = PairSet::FLUIDS; set.what < PairSet::OF_LEVEL; set.what++) {
      const bool solids = set.what == PairSet::SOLIDS;
      set.loops = loops;
      set.of_forces = solids && full ? make_loops(levels[l].h, false) : loops;
      set.kind = set.what == PairSet::WALLS ? WITH_WALL
          : !solids                         ? WITH_FLUID
          : full                            ? WITH_SOLID_FULL
                                            : WITH_SOLID;
      sets.push_back(set);
    }
  }
  for (size_t a = 0; a < n; a++)
    for (size_t b = 0; b < n; b++) {
      if (a == b) continue;
      PairSet set;
      set.level = a;
      set.unlike = true;
      set.h = 0.5 * (levels[a].h + levels[b].h);
      const ChosenKernel kernel(disc->kernel, disc->dim, set.h);
      set.cut = kernel.cut;
      set.wdx = kernel.W(spacing_between(levels[a], levels[b]));
      set.loops = set.of_forces = make_loops(set.h, have_packs());
      of_two_levels[n * a + b] = sets.size();
      sets.push_back(set);
    }
}

void PairSets::find_ratios(PairSet &set) const
{
  const double dx = disc->levels[set.level].dx;
  set.ratio.assign(atom->ntypes + 1, VolumeRatio());
  for (int t = 1; t <= atom->ntypes; t++) {
    const bool fluid = disc->state[t].species == FLUID, thin = disc->thin[t] != 0.0;
    const double ratio = disc->dx_of(t) / dx;
    if (ratio == 1.0 && !thin) continue;
    if (!fluid) set.unequal = true;
    set.ratio[t] = {disc->dim == 3 ? ratio * ratio * ratio : ratio * ratio,
                    fluid ? 0.0 : disc->sharper_of(t, dx), thin};
  }
}

FluidPairs PairSets::pairs_of(const PairSet &set, const std::vector<Row> &rows,
                              const std::vector<double> &visible, const Mirror *mirror,
                              const FluidParticles &particles)
{
  FluidPairs pairs = {set.kind, rows, mirror, particles};
  pairs.in.ratio = set.ratio.data();
  pairs.in.unequal = set.unequal;
  pairs.in.unlike = set.unlike;
  if (set.what == PairSet::HIDDEN && !rows.empty()) pairs.in.visible = {visible.data(), rows[0].j};
  return pairs;
}

bool PairSets::has_rows_with_walls() const
{
  return std::any_of(sets.begin(), sets.end(), [](const PairSet &set) {
    return set.what == PairSet::WALLS && !set.rows.rows.empty();
  });
}

double PairSets::beyond_lists() const
{
  double widest = 0.0;
  for (int t = 1; t <= atom->ntypes; t++)
    if (disc->state[t].species == SOLID) widest = std::max(widest, disc->dx_of(t));
  return disc->largest_cut + widest;
}

double PairSets::memory_usage() const
{
  double bytes = bytes_of(sorted_at, beside);
  for (const auto &set : sets) {
    bytes += set.rows.memory_usage() + bytes_of(set.near, set.visible);
    for (const auto &rows : set.images) bytes += rows.memory_usage();
  }
  return bytes;
}

void PairSets::check() const
{
  if (elsewhere)
    error->all(FLERR,
               "{} keeps its pairs on its device: what else is found from pairs of particles, as "
               "number densities and shear rates, is not supported with it",
               elsewhere);
}

void PairSets::find_reach(bool may_sort)
{
  disc->dim == 2 ? find_reach<2>(may_sort) : find_reach<3>(may_sort);
}

// Loops are at atom->x and half a step before it. Where lists have just been built, sorted_at is of
// other atoms.
template <int D> void PairSets::find_reach(bool may_sort)
{
  const auto *const x = vectors(atom->x), *const v = vectors(atom->v);
  const int nall = atom->nlocal + atom->nghost;
  const size_t size = may_sort ? (size_t) D * atom->nmax : 0;
  if (sorted_at.size() < size) sorted_at.resize(size);
  const auto *const old = reinterpret_cast<const double(*)[D]>(sorted_at.data());
  const auto parts = step->in_parts(nall, [=](int first, int last) {
    std::array<double, 2> most = {};
    for (int i = first; i < last; i++) {
      double vsq = 0.0, rsq = 0.0;
      for (int d = 0; d < D; d++) vsq += v[i][d] * v[i][d];
      for (int d = 0; may_sort && d < D; d++) rsq += (x[i][d] - old[i][d]) * (x[i][d] - old[i][d]);
      most = {std::max(most[0], vsq), std::max(most[1], rsq)};
    }
    return most;
  });
  double fastest = 0.0, farthest = 0.0;
  for (const auto &[first, most] : parts) {
    fastest = std::max(fastest, most[0]);
    farthest = std::max(farthest, most[1]);
  }
  // what a pair comes nearer in a step
  const double nearer = 2.0 * update->dt * std::sqrt(fastest);
  double walls = 0.0;
  for (const Wall &wall : step->walls.wall) walls += 2.0 * std::fabs(wall.velocity[wall.axis]);
  for (auto &set : sets) set.reach = within(set) + nearer + update->dt * walls;
  sorts = neighbor->ago == 0 || 2.0 * std::sqrt(farthest) + 0.5 * nearer > margin;
  if (!sorts || !may_sort) return;
  // for as many steps as a third of the skin lasts: more pairs cost more than to sort again
  const double skin = neighbor->skin,
               steps = std::floor(0.35 * skin / std::max(nearer, 0.04 * skin) + 0.5);
  margin = 1.15 * (std::max(steps, 1.0) - 0.5) * nearer;
  step->for_particles(nall, [=, dth = 0.5 * update->dt, to = sorted_at.data()](int i) {
    for (int d = 0; d < D; d++) to[D * i + d] = x[i][d] - dth * v[i][d];
  });
}

void PairSets::look_past_thin_bodies(double *backfill, double *backfill_weight)
{
  Sight &sight = *disc->sight;
  sight.follow_bodies();
  const auto *const x = vectors(atom->x);
  const size_t n = disc->levels.size();
  struct Next {
    const Row *row, *end;
    double *part;
  };
  std::vector<Next> next;
  for (const size_t k : of_hidden) {
    const std::vector<Row> &rows = sets[k].rows.rows;
    next.push_back({rows.data(), rows.data() + rows.size(), sets[k].visible.data()});
  }
  for (const int i : beside) {
    const size_t level = disc->level_of[atom->type[i]];
    const auto here = [i](const Next &rows) {
      return rows.row != rows.end && rows.row->i == i;
    };
    double reach = disc->levels[level].cut;
    for (size_t k = n * level; k < n * (level + 1); k++)
      if (here(next[k])) reach = std::max(reach, sets[of_hidden[k]].cut);
    sight.look_from(x[i], reach);
    for (size_t k = n * level; k < n * (level + 1); k++) {
      const double cut = sets[of_hidden[k]].cut;
      for (Next &rows = next[k]; here(rows); rows.row++)
        for (int m = 0; m < rows.row->n; m++) *rows.part++ = sight.visible(x[rows.row->j[m]], cut);
    }
    const auto more = sight.backfill(level);
    backfill[i] = more.force;
    backfill_weight[i] = more.weight;
  }
}

// the largest support of a fluid particle and these neighbors
double PairSets::farthest_of(int i, const int *neighbors, int n) const
{
  const auto &resolution = disc->resolution;
  const int *const type = atom->type;
  double other = resolution[type[i]].cut;
  for (int jj = 0; jj < n; jj++) {
    const int t = type[neighbors[jj]];
    if (is_fluid[t]) other = std::max(other, resolution[t].cut);
  }
  return 0.5 * (resolution[type[i]].cut + other);
}

// rows of those fluid neighbors of i that thin bodies may hide before lists are built again: marks
// them
void PairSets::find_hidden(int i, const int *neighbors, int n)
{
  Sight &sight = *disc->sight;
  const double skin = neighbor->skin;
  const int *const type = atom->type;
  const auto &level = disc->level_of;
  const size_t *const of_levels = &of_hidden[disc->levels.size() * level[type[i]]];
  sight.look_from(atom->x[i], disc->has_levels() ? farthest_of(i, neighbors, n) : disc->cut, skin);
  hides.resize(n);
  for (int jj = 0; jj < n; jj++) {
    const int j = neighbors[jj];
    hides[jj] = is_fluid[type[j]] && sight.may_hide(atom->x[j], skin);
  }
  for (const int t : fluid_types) {
    const char *hidden = hides.data();
    sets[of_levels[level[t]]].rows.add(i, neighbors, n, false, false, [&](int j) {
      return *hidden++ && type[j] == t;
    });
  }
  beside.push_back(i);
}

static bool all_of_type(int t, const int *type, const int *j, int n)
{
  return std::all_of(j, j + n, [=](int k) {
    return type[k] == t;
  });
}

// the pairs of the neighbor list as rows of a fluid particle and neighbors of one type: those of
// one fluid alone are LAMMPS' own
void PairSets::find_rows(const NeighList *list)
{
  const int *const type = atom->type;
  for (auto &set : sets) set.rows.clear();
  with_others.clear();
  beside.clear();
  const auto &level = disc->level_of;
  const size_t ntypes = atom->ntypes + 1, nlevels = disc->levels.size();
  rows_of.resize(ntypes * ntypes);
  for (size_t a = 0; a < ntypes; a++)
    for (size_t b = 0; b < ntypes; b++)
      rows_of[ntypes * a + b] = &sets[of_two_levels[nlevels * level[a] + level[b]]].rows;

  std::vector<int> unmasked;
  const bool single =
      atom->ntypes == 1 && fluid_types.size() == 1 && !atom->molecular && !disc->sight;
  for (int ii = 0; ii < list->inum; ii++) {
    const int i = list->ilist[ii], *neighbors = list->firstneigh[i], n = list->numneigh[i];
    if (single && is_fluid[type[i]]) {
      sets[PairSet::FLUIDS].rows.rows.push_back({i, n, neighbors});
      continue;
    }
    if (atom->molecular) {
      unmasked.resize(n);
      for (int jj = 0; jj < n; jj++) unmasked[jj] = neighbors[jj] & NEIGHMASK;
      neighbors = unmasked.data();
    }
    if (is_fluid[type[i]]) {
      add_rows_of_fluid(i, neighbors, n);
      continue;
    }
    for (int jj = 0; jj < n; jj++)
      if (is_fluid[type[neighbors[jj]]]) with_others.push_back({neighbors[jj], i});
  }
  for (const size_t k : of_hidden) {
    PairSet &set = sets[k];
    set.rows.end();
    set.visible.clear();
    for (const Row &row : set.rows.rows) set.visible.resize(set.visible.size() + row.n);
  }
  for (auto &set : sets)
    if (!single && set.what == PairSet::FLUIDS) set.rows.end();
  add_pairs_behind_walls();
  if (!other_types.empty()) find_rows_with_others();
}

void PairSets::add_rows_of_fluid(int i, const int *neighbors, int n)
{
  const int *const type = atom->type;
  const size_t ntypes = atom->ntypes + 1;
  const bool looks = disc->sight && disc->sight->near(atom->x[i]);
  if (!looks && !atom->molecular && all_of_type(type[i], type, neighbors, n)) {
    rows_of[(ntypes + 1) * type[i]]->rows.push_back({i, n, neighbors});
    return;
  }
  if (looks) find_hidden(i, neighbors, n);
  // that of its own type stays if it is empty, for its own images
  for (const int t : fluid_types) {
    const char *hidden = hides.data();
    rows_of[ntypes * type[i] + t]->add(i, neighbors, n, false, t == type[i], [&](int j) {
      if (looks && *hidden++) return false;
      if (type[j] == t) return true;
      if (t == fluid_types[0] && !is_fluid[type[j]]) with_others.push_back({i, j});
      return false;
    });
  }
}

// The image of a solid's particle that is up to half a spacing behind a wall without end, from
// where on nothing of it counts, is nearer than itself by up to a spacing: these pairs LAMMPS does
// not list. (Lists of all particles that reach further cost 2 % more.)
void PairSets::add_pairs_behind_walls()
{
  const Walls &walls = step->walls;
  const int *const type = atom->type, nlocal = atom->nlocal, nall = nlocal + atom->nghost;
  const double skin = neighbor->skin, cut = disc->largest_cut;
  const auto passes = [&](int j) {
    if (disc->state[type[j]].species != SOLID) return false;
    const double deep = 0.5 * disc->dx_of(type[j]) + skin;
    return std::any_of(walls.wall.begin(), walls.wall.end(), [&](const Wall &w) {
      return !w.finite && w.distance(atom->x[j]) < skin && w.distance(atom->x[j]) > -deep;
    });
  };
  if (!walls.any() || !has_solids) return;
  const Cells solids(atom->x, nall, disc->dim, beyond_lists() + skin, passes);
  for (int i = 0; i < nall; i++)
    if (is_fluid[type[i]] && walls.near(atom->x[i], cut + skin, skin))
      solids.around(atom->x[i], [&](int j, double rsq) {
        const auto &of = disc->resolution;
        const double reach =
            std::max(of[type[i]].cut, of[type[j]].cut) + disc->dx_of(type[j]) + skin;
        const bool here = i < nlocal || (!force->newton_pair && j < nlocal);
        if (here && rsq >= neighbor->cutneighsq[type[i]][type[j]] && rsq < reach * reach)
          with_others.push_back({i, j});
      });
}

// rows of fluid particles and neighbors of other species, from their pairs
void PairSets::find_rows_with_others()
{
  const int *const type = atom->type, nall = atom->nlocal + atom->nghost;
  std::vector<int> first(nall + 2, 0), other(with_others.size());
  for (const auto &pair : with_others) first[pair[0] + 2]++;
  for (int i = 0; i < nall; i++) first[i + 2] += first[i + 1];
  for (const auto &pair : with_others) other[first[pair[0] + 1]++] = pair[1];
  for (int i = 0; i < nall; i++) {
    if (first[i] == first[i + 1]) continue;
    PairSet *const of_level = &sets[PairSet::OF_LEVEL * disc->level_of[type[i]]];
    for (const int t : other_types)
      of_level[disc->state[t].species == SOLID ? PairSet::SOLIDS : PairSet::WALLS].rows.add(
          i, &other[first[i]], first[i + 1] - first[i], false, false, [=](int j) {
            return type[j] == t;
          });
  }
  for (auto &set : sets)
    if (set.what == PairSet::WALLS || set.what == PairSet::SOLIDS) set.rows.end();
}

// does the line between i and the image of j pass through the walls of this reflection?
bool PairSets::sees(int i, int j, const Walls &walls, int reflection, const double *places) const
{
  const auto *const x = vectors(atom->x);
  const auto position = [&](int k) -> std::array<double, 3> {
    if (!places) return {x[k][0], x[k][1], x[k][2]};
    return disc->dim == 2 ? reinterpret_cast<const Point<2> *>(places)[k].position(x[k])
                          : reinterpret_cast<const Point<3> *>(places)[k].position(x[k]);
  };
  const auto xi = position(i), xj = position(j);
  double rsq = 0.0;
  for (int d = 0; d < 3; d++) rsq += (xi[d] - xj[d]) * (xi[d] - xj[d]);
  double away[3];
  return walls.sees(walls.reflections[reflection], xi.data(), xj.data(), disc->cut * disc->cut, rsq,
                    away);
}

// rows of images, one list per reflection: of local fluid particles themselves, and of the
// neighbors that are near its walls, too, both together not farther than the support; segments of
// walls reflect a pair only if the line between them passes through
void PairSets::find_images(const Walls &walls, const double *places)
{
  const int n = walls.reflections.size();
  for (auto &set : sets) {
    if (set.what == PairSet::WALLS && !walls.joined_by(~0)) continue;
    set.visible_images.resize(n);
    for (auto &visible : set.visible_images) visible.clear();
    set.images.resize(n);
    for (auto &rows : set.images) rows.clear();
    find_images_of(set, walls, places);
    for (auto &rows : set.images) rows.end();
  }
}

void PairSets::find_images_of(PairSet &set, const Walls &walls, const double *places)
{
  const int *const wmask = step->wmask, *const type = atom->type, n = walls.reflections.size();
  const auto *const x = vectors(atom->x);
  const bool finite = walls.finite(), hidden = set.what == PairSet::HIDDEN;
  RowList *const images = set.images.data();
  const Walls::Reflection *const reflections = walls.reflections.data();
  const Wall *const wall_of = step->walls.wall.data();
  const double reach = set.reach;
  const Row *const rows = set.rows.rows.data();
  const auto at_walls = step->those(set.rows.rows.size(), [=](int r) {
    return wmask[rows[r].i] != 0;
  });
  for (const int r : at_walls) {
    const Row &row = rows[r];
    const int i = row.i;
    // of a pair and its images it is the same
    const double *const parts_of_row = hidden ? set.visible.data() + (row.j - rows->j) : nullptr;
    const bool of_own_type = set.what == PairSet::FLUIDS && i < atom->nlocal &&
        (row.n == 0 || type[row.j[0]] == type[i]);
    for (int k = 0; k < n; k++) {
      const int mask = reflections[k].mask;
      if ((wmask[i] & mask) != mask) continue;
      const Wall &wall = wall_of[reflections[k].w[0]];
      const double farthest = reach - wall.distance(x[i]);
      if (hidden) {
        const double *of_pair = parts_of_row;
        images[k].add(i, row.j, row.n, false, false, [&](int j) {
          const double seen = *of_pair++;
          if ((wmask[j] & mask) != mask || (finite && !sees(i, j, walls, k, places))) return false;
          set.visible_images[k].push_back(seen);
          return true;
        });
      } else if (finite)
        images[k].add(i, row.j, row.n, of_own_type && sees(i, i, walls, k, places), false,
                      [&](int j) {
                        return (wmask[j] & mask) == mask && sees(i, j, walls, k, places);
                      });
      else
        images[k].add(i, row.j, row.n, of_own_type, false, [&](int j) {
          return (wmask[j] & mask) == mask && wall.distance(x[j]) < farthest;
        });
    }
  }
}
