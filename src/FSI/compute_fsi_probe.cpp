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

#include "compute_fsi_probe.h"

#include "arg_info.h"
#include "atom.h"
#include "domain.h"
#include "error.h"
#include "fix_fsi.h"
#include "fix_store_atom.h"
#include "fsi_gather.h"
#include "fsi_gradient.h"
#include "fsi_hub.h"
#include "fsi_kernel.h"
#include "fsi_keywords.h"
#include "fsi_rows.h"
#include "fsi_sight.h"
#include "group.h"
#include "math_extra.h"
#include "memory.h"
#include "modify.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace FSI;

static constexpr double MOST = 1.0e7;    // points of one place
static constexpr double SAME = 1.02;     // of spacings of a fluid's level and of a body in it
static constexpr double REACH = 2.0;     // of a fit in spacings: it has enough at a corner, too
static constexpr double INDEPENDENCE = 0.05;    // a direction has it with two rows or more

ComputeFSIProbe::ComputeFSIProbe(LAMMPS *lmp, int narg, char **arg) : Compute(lmp, narg, arg)
{
  static const std::vector<std::string> names = {"p",     "rho", "vx", "vy", "vz", "fill",
                                                 "level", "wet", "ux", "uy", "uz"};
  int iarg = 3;
  while (iarg < narg) {
    const std::string word = arg[iarg++];
    const auto it = std::find(names.begin(), names.end(), word);
    if (it != names.end())
      quantity.push_back(it - names.begin());
    else if (utils::strmatch(word, "^c_"))
      read_sampled(word);
    else if (word == "point" || word == "patch" || word == "line")
      iarg += read_place(word, narg - iarg, arg + iarg);
    else if (word == "extrapolate") {
      if (iarg == narg) utils::missing_cmd_args(FLERR, "compute fsi/probe extrapolate", error);
      extrapolate = utils::logical(FLERR, arg[iarg++], false, lmp);
    } else {
      auto known = names;
      known.insert(known.end(), {"c_ID", "point", "patch", "line", "extrapolate"});
      error->all(FLERR, "Unknown compute fsi/probe argument {}: expected {}", word, list_of(known));
    }
  }
  if (quantity.empty()) error->all(FLERR, "Compute fsi/probe needs a quantity: {}", list_of(names));
  if (places.empty()) error->all(FLERR, "Compute fsi/probe needs a place: point, patch or line");
  for (const int q : quantity)
    for (const auto &place : places)
      if (of_body(q) || of_body(quantity[0])) {
        if (of_body(q) != of_body(quantity[0]) || !std::equal(place.from, place.from + 3, place.to))
          error->all(FLERR, "Compute fsi/probe ux, uy, uz need points, and no other quantity");
      } else if (place.line != (q == LEVEL || q == WET))
        error->all(FLERR, "Compute fsi/probe {} needs {}", q < SAMPLED ? names[q] : "c_ID",
                   place.line ? "a point or a patch, not a line" : "a line");

  create_attribute = of_body(quantity[0]);
  for (size_t k = 0; k < places.size() && create_attribute; k++)
    places[k].kept = dynamic_cast<FixStoreAtom *>(modify->add_fix(
        fmt::format("{}_FSI_{} {} STORE/ATOM 4 0 0 1", id, k, group->names[igroup])));

  const int rows = places.size(), columns = quantity.size();
  if (rows * columns == 1) {
    scalar_flag = 1;
    extscalar = 0;
  } else if (rows == 1 || columns == 1) {
    vector_flag = 1;
    extvector = 0;
    size_vector = rows * columns;
    memory->create(vector, size_vector, "fsi/probe:vector");
  } else {
    array_flag = 1;
    extarray = 0;
    size_array_rows = rows;
    size_array_cols = columns;
    memory->create(array, rows, columns, "fsi/probe:array");
  }
}

void ComputeFSIProbe::read_sampled(const std::string &word)
{
  const ArgInfo given(word, ArgInfo::COMPUTE);
  if (given.get_type() != ArgInfo::COMPUTE || given.get_dim() > 1)
    error->all(FLERR, "Compute fsi/probe {}: expected c_ID or c_ID[n]", word);
  quantity.push_back(SAMPLED + sampled.size());
  sampled.push_back({given.get_name(), given.get_index1()});
}

void ComputeFSIProbe::find_sampled()
{
  for (auto &s : sampled) {
    s.compute = modify->get_compute_by_id(s.id);
    if (!s.compute) error->all(FLERR, "Compute fsi/probe c_{}: there is no such compute", s.id);
    if (!s.compute->peratom_flag)
      error->all(FLERR, "Compute fsi/probe c_{} is not a per-atom compute", s.id);
    const int columns = s.compute->size_peratom_cols;
    if (s.column > columns || (s.column == 0 && columns > 0))
      error->all(FLERR, "Compute fsi/probe c_{}: expected {}", s.id,
                 columns ? fmt::format("a column from 1 to {}", columns) : "no column");
  }
}

// returns how many of the words that follow it has taken
int ComputeFSIProbe::read_place(const std::string &kind, int narg, char **arg)
{
  const bool point = kind == "point";
  const int n = std::min(narg, point ? 3 : 6);
  Place place;
  place.line = kind == "line";
  Keywords words(lmp, "compute fsi/probe " + kind);
  for (double &x : place.from) words.argument("at").number(x, 0.0);
  for (double &x : place.to)
    if (!point) words.argument("to").number(x, 0.0);
  words.parse(n, arg);
  if (point) std::copy_n(place.from, 3, place.to);
  if (domain->dimension == 2) place.from[2] = place.to[2] = 0.0;
  for (int d = 0; d < 3; d++)
    if (!place.line && place.to[d] < place.from[d])
      error->all(FLERR, "Compute fsi/probe patch ends at {} = {} below its start {}", "xyz"[d],
                 place.to[d], place.from[d]);
  if (!point && std::equal(place.from, place.from + 3, place.to))
    error->all(FLERR, "Compute fsi/probe {} has no extent: use point", kind);
  places.push_back(place);
  return n;
}

ComputeFSIProbe::~ComputeFSIProbe()
{
  for (const auto &place : places)
    if (place.kept && modify->nfix) modify->delete_fix(place.kept->id);
  if (vector_flag) memory->destroy(vector);
  if (array_flag) memory->destroy(array);
}

void ComputeFSIProbe::init()
{
  disc = &FixFSI::find(lmp, "Compute fsi/probe")->disc;
  find_sampled();
  listed = -1;
  points.clear();
  nsums = places[0].line ? 2 : 1 + quantity.size();
  for (auto &place : places) {
    set_grid(place, disc->levels.back().dx);    // the finest fluid's
    place.first = points.size() / 3;
    for (int a = 0; a < place.n[0]; a++)
      for (int b = 0; b < place.n[1]; b++)
        for (int c = 0; c < place.n[2]; c++)
          for (int d = 0; d < 3; d++)
            points.push_back(place.origin[d] + a * place.step[0][d] + b * place.step[1][d] +
                             c * place.step[2][d]);
  }
}

// of a scene that has fluid: other may be poured later
void ComputeFSIProbe::find_idle(const Census &all, const Idle &nothing) const
{
  if (all.fluids > 0 && !of_body(quantity[0]) && find_particles(atom, world, [this](int i) {
                                                   return atom->mask[i] & groupbit &&
                                                       disc->state[atom->type[i]].species == FLUID;
                                                 }).count == 0)
    nothing("Compute fsi/probe", fmt::format("group {} has no fluid", group->names[igroup]));
}

void ComputeFSIProbe::set_arrays(int i)
{
  for (const auto &place : places) std::fill_n(place.kept->astore[i], 4, 0.0);
}

// points of solids: once, where the first run finds them; a restart file has what was taken
void ComputeFSIProbe::setup()
{
  for (auto &place : places) {
    if (!place.kept) continue;
    for (int i = 0; i < atom->nlocal; i++) place.taken |= place.kept->astore[i][0] != 0.0;
    place.taken = anywhere(place.taken, world);
    if (!place.taken) take(place);
    place.taken = true;
  }
}

// points: half a spacing apart on a patch, in mid-cell; a quarter along a line, with both ends
void ComputeFSIProbe::set_grid(Place &place, double dx) const
{
  double length = 0.0;
  for (int d = 0; d < 3; d++) {
    const double extent = place.to[d] - place.from[d];
    length += extent * extent;
    place.n[d] = 1;
    std::fill_n(place.step[d], 3, 0.0);
    place.origin[d] = place.from[d];
    if (place.line) continue;
    // the tolerance: 0.1/0.005 is not 21 cells
    place.n[d] =
        std::max(1, static_cast<int>(std::min(std::ceil(2.0 * extent / dx - 1.0e-6), MOST + 1.0)));
    place.step[d][d] = extent / place.n[d];
    place.origin[d] += 0.5 * place.step[d][d];
  }
  if (place.line) {
    place.n[0] =
        1 + static_cast<int>(std::min(std::ceil(4.0 * std::sqrt(length) / dx - 1.0e-6), MOST));
    for (int d = 0; d < 3; d++) place.step[0][d] = (place.to[d] - place.from[d]) / (place.n[0] - 1);
  }
  double n = 1.0;
  for (const int k : place.n) n *= k;
  if (n > MOST)
    error->all(FLERR, "Compute fsi/probe {} has {:g} points, more than {:g}",
               place.line ? "line" : "patch", n, MOST);
}

double ComputeFSIProbe::Place::along(int d, const double *x) const
{
  const double *const e = step[d];
  return ((x[0] - origin[0]) * e[0] + (x[1] - origin[1]) * e[1] + (x[2] - origin[2]) * e[2]) /
      MathExtra::lensq3(e);
}

// Of a particle and its periodic images, those within a reach of a place along each axis: calls
// f(shift, x). In a box narrower than the support a point sees a particle more than once.
template <class F>
void ComputeFSIProbe::for_images(int i, const Place &place, double reach, F f) const
{
  int first[3] = {}, last[3] = {}, n[3];
  for (int d = 0; d < disc->dim; d++) {
    if (!domain->periodicity[d]) continue;
    const auto [low, high] = std::minmax(place.from[d], place.to[d]);
    const double L = domain->prd[d], x = atom->x[i][d];
    first[d] = static_cast<int>(std::clamp(std::ceil((low - reach - x) / L), -MOST, MOST));
    last[d] = static_cast<int>(std::clamp(std::floor((high + reach - x) / L), -MOST, MOST));
  }
  for (n[0] = first[0]; n[0] <= last[0]; n[0]++)
    for (n[1] = first[1]; n[1] <= last[1]; n[1]++)
      for (n[2] = first[2]; n[2] <= last[2]; n[2]++) {
        Particle p = {i};
        double x[3];
        for (int d = 0; d < 3; d++) {
          p.shift[d] = n[d] * domain->prd[d];
          x[d] = atom->x[i][d] + p.shift[d];
        }
        f(p, x);
      }
}

// squared distance to the nearest part of its grid
double ComputeFSIProbe::Place::distance_sq(const double *x, int dim) const
{
  double apart[3], rsq = 0.0;
  for (int d = 0; d < 3; d++) apart[d] = x[d] - origin[d];
  for (int k = 0; k < 3; k++) {
    if (n[k] == 1) continue;
    const double t = std::min(std::max(along(k, x), 0.0), n[k] - 1.0);
    for (int d = 0; d < 3; d++) apart[d] -= t * step[k][d];
  }
  for (int d = 0; d < dim; d++) rsq += apart[d] * apart[d];
  return rsq;
}

// Fluids have their own level, solids that of the fluid which may be beside them
size_t ComputeFSIProbe::level_of(int type) const
{
  size_t level = disc->level_of[type];
  if (disc->state[type].species == FLUID) return level;
  while (level + 1 < disc->levels.size() && disc->levels[level].dx > SAME * disc->dx_of(type))
    level++;
  return level;
}

// particles that may come within the kernel's support of a place before there are new lists
void ComputeFSIProbe::find_near()
{
  listed = neighbor->lastcall;
  const double reach = disc->cut + neighbor->skin;
  for (auto &place : places) {
    place.near.assign(disc->levels.size(), {});
    for (int i = 0; i < atom->nlocal; i++) {
      const int species = disc->state[atom->type[i]].species;
      if (species == FLUID ? !(atom->mask[i] & groupbit) : !place.line) continue;
      for_images(i, place, reach, [&](const Particle &p, const double *x) {
        if (place.distance_sq(x, disc->dim) < reach * reach)
          place.near[level_of(atom->type[i])].push_back(p);
      });
    }
  }
}

// Calls f with the index of each point of the grid that may be within the kernel's support of x.
template <class F> void ComputeFSIProbe::Place::for_points(const double *x, double cut, F f) const
{
  int lo[3] = {}, hi[3] = {};
  for (int d = 0; d < 3; d++) {
    if (n[d] == 1) continue;
    const double *const e = step[d];
    const double t = along(d, x), r = cut / MathExtra::len3(e);
    lo[d] = std::max(0, static_cast<int>(std::ceil(t - r)));
    hi[d] = std::min(n[d] - 1, static_cast<int>(std::floor(t + r)));
  }
  for (int a = lo[0]; a <= hi[0]; a++)
    for (int b = lo[1]; b <= hi[1]; b++)
      for (int c = lo[2]; c <= hi[2]; c++) f(first + (a * n[1] + b) * n[2] + c);
}

// mirror walls near each point, as bits; points on a wall are put where it is: not behind it
std::vector<int> ComputeFSIProbe::walls_near(const Walls &walls, std::vector<double> &at) const
{
  std::vector<int> mask(at.size() / 3, 0);
  if (walls.any())
    for (size_t k = 0; k < mask.size(); k++) {
      for (const auto &w : walls.wall)
        if (std::fabs(w.distance(&at[3 * k])) < 1.0e-6 * disc->dx) at[3 * k + w.axis] = w.position;
      mask[k] = walls.near(&at[3 * k], disc->cut);
    }
  return mask;
}

// What a particle gives to the sums of points around it
struct ComputeFSIProbe::Source {
  int i;
  double rho, pressure, floor;
  bool fluid;
};

void ComputeFSIProbe::add(const Place &place, const Source &of, double weight, double head,
                          const double *v, double *sum)
{
  sum[place.line && !of.fluid] += weight;
  for (size_t q = 0; q < quantity.size() && !place.line; q++) {
    if (quantity[q] == P)
      sum[q + 1] += weight * (extrapolate ? std::max(of.pressure + head, of.floor) : of.pressure);
    else if (quantity[q] == RHO)
      sum[q + 1] += weight * of.rho;
    else if (quantity[q] >= SAMPLED) {
      const Sampled &s = sampled[quantity[q] - SAMPLED];
      sum[q + 1] += weight *
          (s.column ? s.compute->array_atom[of.i][s.column - 1] : s.compute->vector_atom[of.i]);
    } else if (quantity[q] != FILL)
      sum[q + 1] += weight * v[quantity[q] - VX];
  }
}

// adds particles with this kernel near each place to its sums; at: points; mask: walls near them
void ComputeFSIProbe::add_level(size_t level, const Walls &walls, const std::vector<double> &at,
                                const std::vector<int> &mask)
{
  const ChosenKernel kernel(disc->kernel, disc->dim, disc->levels[level].h);
  Sight *const sight = disc->sight.get();
  const auto add_particle = [&](const Place &place, const Particle &p) {
    const int i = p.i, type = atom->type[i];
    const State &state = disc->state[type];
    const auto &g = step->body_forces.of_type[type];
    const bool fluid = state.species == FLUID;
    const Source of = {i, atom->rho[i], fluid ? pressure_of(i, atom, *disc, *step) : 0.0,
                       state.floor, fluid};
    double x[3];
    for (int d = 0; d < 3; d++) x[d] = atom->x[i][d] + p.shift[d];
    double vol = atom->rmass[i] / atom->rho[i];
    // behind a mirror wall a solid is not there, but its image
    if (state.species == SOLID)
      for (const auto &w : walls.wall) vol *= w.before(x, disc->dx_of(type));
    if (vol == 0.0) return;
    const int mask_i = walls.any()
        ? walls.near(x, disc->cut) & walls.mirroring(state.species == RIGID, atom->mask[i])
        : 0;
    const bool may_hide = sight && fluid && sight->near(atom->x[i]);
    if (may_hide) sight->look_from(atom->x[i], kernel.cut);
    place.for_points(x, kernel.cut, [&](int k) {
      const double *const xk = &at[3 * k];
      double *const sum = &sums[(size_t) k * nsums];
      double rsq = 0.0, head = 0.0;
      for (int d = 0; d < disc->dim; d++) {
        rsq += (xk[d] - x[d]) * (xk[d] - x[d]);
        head += of.rho * g[d] * (xk[d] - x[d]);
      }
      if (rsq >= kernel.cutsq) return;
      double part = vol;
      if (may_hide) {
        const double seen[3] = {xk[0] - p.shift[0], xk[1] - p.shift[1], xk[2] - p.shift[2]};
        part *= sight->visible(seen, kernel.cut);
      }
      add(place, of, kernel.W(std::sqrt(rsq)) * part, head, atom->v[i], sum);
      const int both = mask_i & mask[k];
      if (!both) return;
      walls.images(both, rsq, xk, x, kernel.cutsq,
                   [&](const Walls::Reflection &s, double rsq_image, const double *) {
                     double v[3];
                     Mirror(walls, s).reflect_velocity(atom->v[i], v);
                     add(place, of, kernel.W(std::sqrt(rsq_image)) * part, head, v, sum);
                   });
    });
  };
  for (const auto &place : places)
    for (const auto &p : place.near[level]) add_particle(place, p);
}

// sums of V W and of V W times each quantity over fluid particles and their images in mirror walls;
// along lines of V W over fluids and over solids
void ComputeFSIProbe::sum_up()
{
  FixFSI::ready(lmp, "Compute fsi/probe")->link(disc, step);
  find_sampled();    // a script may have put another in its place since the last run
  for (const auto &s : sampled) {
    if (!s.compute->is_initialized())
      error->all(FLERR, "Compute fsi/probe c_{} needs a run before it, if only run 0", s.id);
    if (!(s.compute->invoked_flag & INVOKED_PERATOM)) {
      s.compute->compute_peratom();
      s.compute->invoked_flag |= INVOKED_PERATOM;
    }
  }
  // who is in a dynamic group is another thing at any step
  if (listed != neighbor->lastcall || update->whichflag == 0 || group->dynamic[igroup]) find_near();

  const int npoints = points.size() / 3;
  sums.assign((size_t) npoints * nsums, 0.0);
  all.resize(sums.size());

  const Walls &walls = step->walls;
  std::vector<double> at(points);
  const std::vector<int> mask = walls_near(walls, at);
  for (size_t level = 0; level < disc->levels.size(); level++) add_level(level, walls, at, mask);
  MPI_Allreduce(sums.data(), all.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, world);
}

// mean over the points of a place of quantity k; 0 where no fluid is within the kernel's support
double ComputeFSIProbe::field(const Place &place, int k) const
{
  if (place.kept) return place.u[quantity[k] - UX];
  double mean = 0.0;
  for (int m = 0; m < place.size(); m++) {
    const double *const sum = &all[(size_t) (place.first + m) * nsums];
    if (quantity[k] == FILL)
      mean += sum[0];
    else if (sum[0] > 0.0)
      mean += sum[k + 1] / sum[0];
  }
  return mean / place.size();
}

// Water is where fluid fills more than half of what solids leave: F > (1 - S)/2. The level is where
// that ends last, seen from the line's start; wet is the length over which it holds.
double ComputeFSIProbe::level(const Place &place, bool wet) const
{
  const auto excess = [&](int m) {
    const double *const sum = &all[(size_t) (place.first + m) * nsums];
    return sum[1] < 0.5 ? 2.0 * sum[0] + sum[1] - 1.0 : -1.0;
  };
  const int last = place.n[0] - 1;
  double top = 0.0, length = 0.0, here = excess(0);
  for (int m = 0; m < last; m++) {
    const double next = excess(m + 1);
    if (here > 0.0 && next > 0.0) {
      length += 1.0;
      top = m + 1.0;
    } else if (here > 0.0) {
      length += here / (here - next);
      top = m + here / (here - next);
    } else if (next > 0.0) {
      length += next / (next - here);
      top = m + 1.0;
    }
    here = next;
  }
  return (wet ? length : top) * MathExtra::len3(place.step[0]);
}

// A particle of a fit to a solid: r from the point, or its displacement
struct ComputeFSIProbe::Fitted {
  tagint tag, body;
  double weight, r[3];
  bool operator<(const Fitted &other) const { return tag < other.tag; }
};

// in an order in which sums are the same on any number of ranks
std::vector<ComputeFSIProbe::Fitted> ComputeFSIProbe::gather_fit(std::vector<Fitted> fit) const
{
  fit = gather(fit, world);
  std::sort(fit.begin(), fit.end());
  return fit;
}

// weights that give fields which are linear in place at the point; they fall to 0 at the reach
void ComputeFSIProbe::take(const Place &place)
{
  std::vector<Fitted> fit;
  for (int i = 0; i < atom->nlocal; i++) {
    const int type = atom->type[i];
    if (!(atom->mask[i] & groupbit) || !disc->state[type].is_body()) continue;
    Fitted one = {atom->tag[i], atom->molecule[i], 1.0, {}};
    for (int d = 0; d < disc->dim; d++) one.r[d] = atom->x[i][d] - place.from[d];
    to_nearest_image(*domain, one.r);
    for (double &r : one.r) {
      r /= REACH * disc->dx_of(type);
      one.weight -= r * r;
    }
    if (one.weight > 0.0) fit.push_back(one);
  }
  fit = gather_fit(fit);
  if (fit.empty())
    error->all(FLERR, "Compute fsi/probe {}: no solid of group {} within {} spacings of {}", id,
               group->names[igroup], REACH, place_text(place.from));
  const Fitted *nearest = fit.data();
  for (const auto &one : fit)
    if (one.weight > nearest->weight) nearest = &one;
  double moments[packed_size(4)] = {}, row[4];
  for (auto &one : fit) {
    if (one.body != nearest->body) one.weight = 0.0;
    const double phi[] = {1.0, one.r[0], one.r[1], one.r[2]};
    for (int a = 0, k = 0; a < 4; a++)
      for (int b = 0; b <= a; b++) moments[k++] += one.weight * phi[a] * phi[b];
  }
  gradient_coefficients<1, 4>(moments, row, INDEPENDENCE);
  for (auto &one : fit)
    one.weight *= row[0] + row[1] * one.r[0] + row[2] * one.r[1] + row[3] * one.r[2];
  for (int i = 0; i < atom->nlocal; i++)
    for (const auto &one : fit)
      if (atom->tag[i] == one.tag) {
        place.kept->astore[i][0] = one.weight;
        domain->unmap(atom->x[i], atom->image[i], place.kept->astore[i] + 1);
      }
}

void ComputeFSIProbe::displace(Place &place) const
{
  std::vector<Fitted> fit;
  for (int i = 0; i < atom->nlocal; i++) {
    const double *const kept = place.kept->astore[i];
    if (kept[0] == 0.0) continue;
    Fitted one = {atom->tag[i], 0, kept[0], {}};
    domain->unmap(atom->x[i], atom->image[i], one.r);
    for (int d = 0; d < 3; d++) one.r[d] -= kept[d + 1];
    fit.push_back(one);
  }
  double sum = 0.0;
  std::fill_n(place.u, 3, 0.0);
  for (const auto &one : gather_fit(fit)) {
    sum += one.weight;
    for (int d = 0; d < 3; d++) place.u[d] += one.weight * one.r[d];
  }
  if (std::fabs(sum - 1.0) > 1.0e-9)
    error->all(FLERR, "Compute fsi/probe {} {}", id,
               place.taken ? "has lost particles around its point" : "needs a run before it");
}

void ComputeFSIProbe::evaluate(double *result)
{
  if (!of_body(quantity[0])) sum_up();
  for (auto &place : places) {
    if (place.kept) displace(place);
    for (size_t k = 0; k < quantity.size(); k++)
      *result++ = place.line ? level(place, quantity[k] == WET) : field(place, k);
  }
}

double ComputeFSIProbe::compute_scalar()
{
  invoked_scalar = update->ntimestep;
  evaluate(&scalar);
  return scalar;
}

void ComputeFSIProbe::compute_vector()
{
  invoked_vector = update->ntimestep;
  evaluate(vector);
}

void ComputeFSIProbe::compute_array()
{
  invoked_array = update->ntimestep;
  evaluate(array[0]);
}

double ComputeFSIProbe::memory_usage()
{
  double bytes = bytes_of(points, sums, all);
  for (const auto &place : places)
    for (const auto &near : place.near) bytes += bytes_of(near);
  return bytes;
}
