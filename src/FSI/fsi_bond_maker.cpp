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

// Takes the reference configuration of total-Lagrangian solids: bonds each particle to its
// neighbors of the same body where they are now, and to their images in planes of symmetry; and
// finds its part in the integral of the energy.

#include "fsi_bond_store.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fsi_cells.h"
#include "fsi_fields.h"
#include "fsi_gather.h"
#include "fsi_gradient.h"
#include "fsi_hub.h"
#include "fsi_kernel.h"
#include "math_extra.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <type_traits>
#include <vector>

using namespace LAMMPS_NS;
using namespace FSI;

namespace {
class BondMaker : protected Pointers {
 public:
  BondMaker(LAMMPS *lmp, BondStore &bonds) : Pointers(lmp), disc(*bonds.disc), bonds(bonds) {}
  void take(const std::vector<int> &bare);    // local solids without bonds

 private:
  const Discretization &disc;
  BondStore &bonds;
  // of the particle that is bonded: neighbors, X_j - X_i, weights V_j W, planes of images, G_ij
  std::vector<int> near, bits;
  std::vector<double> dX, w, G;

  double volume(int i) const;
  void check_planes(const std::vector<int> &bare) const;
  template <int D> void bond_all(const std::vector<int> &bare);
  template <int D> void report(bigint *counts) const;
  template <int D, class Weights>
  int bond(int i, const ChosenKernel &, const Cells &, const Weights &);
  template <int D> void find_neighbors(int i, const ChosenKernel &, const Cells &);
  template <int D> double measure(int i, int j, double cut, double *X) const;
  template <int D> void find_images(int i, const ChosenKernel &);
  template <int D> void enter_bonds(int i, const ChosenKernel &);
};
}    // namespace

void BondStore::take(const std::vector<int> &bare)
{
  BondMaker(lmp, *this).take(bare);
}

void BondMaker::take(const std::vector<int> &bare)
{
  if (bonds.images.planes.any()) check_planes(bare);
  domain->dimension == 2 ? bond_all<2>(bare) : bond_all<3>(bare);
}

double BondMaker::volume(int i) const
{
  return atom->rmass[i] / disc.state[atom->type[i]].rho0;
}

// Bodies that are cut by a plane of symmetry: their particles are where the lattice of the whole
// has them, before the plane. Those that end short of it would be glued to their images.
void BondMaker::check_planes(const std::vector<int> &bare) const
{
  static constexpr double LEAST = 0.25, MOST = 0.75;    // spacings, half a one is meant
  for (const auto &plane : bonds.images.planes.wall) {
    std::set<tagint> there, close;
    for (const int i : bare) {
      if (!(atom->mask[i] & plane.joins)) continue;
      const double dx = disc.dx_of(atom->type[i]), d = plane.distance(atom->x[i]);
      if (d < LEAST * dx)
        error->one(FLERR,
                   "Solid atom {} of body {} is {:g} before the plane of symmetry {} {}: "
                   "expected half a spacing, {:g}, or more",
                   atom->tag[i], atom->molecule[i], d, plane.face(), plane.position, 0.5 * dx);
      if (d < MOST * dx) there.insert(atom->molecule[i]);
      if (d < disc.resolution[atom->type[i]].cut / 2.0) close.insert(atom->molecule[i]);
    }
    there = gather(there, world);
    for (const tagint body : gather(close, world))
      if (!there.count(body))
        error->all(
            FLERR,
            "Body {} ends short of the plane of symmetry at {} = {}: expected half a spacing "
            "between them, or leave it out of the group of fix fsi/wall/mirror",
            body, "xyz"[plane.axis], plane.position);
  }
}

template <int D> void BondMaker::bond_all(const std::vector<int> &bare)
{
  const int *const type = atom->type;
  // bodies by their smoothing length, in the order of the first of each
  std::vector<double> all_h;
  for (const int i : bare)
    if (std::find(all_h.begin(), all_h.end(), disc.h_of(type[i])) == all_h.end())
      all_h.push_back(disc.h_of(type[i]));
  // LAMMPS' list would be of all particles, and stay
  const double widest = disc.largest_cut;
  const Cells solids(atom->x, atom->nlocal + atom->nghost, D, widest / 3.0, [this](int i) {
    return bonds.is_solid(i);
  });
  const GradientWeights<D> weights;
  bigint counts[6] = {};    // particles, bonds, particles by order reached
  bonds.expect(bare.size());
  for (const double h : all_h) {
    const ChosenKernel kernel(disc.kernel, D, h);
    for (const int i : bare) {
      if (disc.h_of(type[i]) != h) continue;
      const int order = bond<D>(i, kernel, solids, weights);
      counts[0]++;
      counts[1] += near.size();
      counts[2 + order]++;
    }
  }
  report<D>(counts);
}

template <int D> void BondMaker::report(bigint *counts) const
{
  bigint all[6];
  MPI_Allreduce(counts, all, 6, MPI_LMP_BIGINT, MPI_SUM, world);
  if (comm->me) return;
  utils::logmesg(lmp, "  fsi/solid/tl: reference of {} particles taken, {:.1f} bonds each\n",
                 all[0], double(all[1]) / all[0]);
  if (bonds.quadratic)
    utils::logmesg(lmp,
                   "    gradients: {} exact for quadratic fields, {} for part of their terms, {} "
                   "for linear fields only\n",
                   all[2 + Gradient<D>::QUADRATIC], all[2 + Gradient<D>::PARTIAL],
                   all[2 + Gradient<D>::LINEAR]);
}

// what its gradient is exact for
template <int D, class Weights>
int BondMaker::bond(int i, const ChosenKernel &kernel, const Cells &solids, const Weights &weights)
{
  find_neighbors<D>(i, kernel, solids);
  if (bonds.images.planes.any()) find_images<D>(i, kernel);
  const int n = near.size();
  G.resize((size_t) n * D);
  const auto order = weights(n, dX.data(), w.data(), kernel.h, bonds.quadratic, G.data());
  if (order == Gradient<D>::DEFICIENT)
    error->one(FLERR,
               "Solid atom {} of body {} has {} neighbors of its own body within {}: too "
               "few, or all in one {}, for a deformation gradient. A body must be at least "
               "two particles thick, and one body one molecule ID",
               atom->tag[i], atom->molecule[i], n, kernel.cut, D == 2 ? "line" : "plane");
  enter_bonds<D>(i, kernel);
  return order;
}

template <int D>
void BondMaker::find_neighbors(int i, const ChosenKernel &kernel, const Cells &solids)
{
  const tagint *const tag = atom->tag, *const molecule = atom->molecule;
  const double cutsq = BondStore::WITHIN * kernel.cutsq;
  near.clear();
  solids.around(atom->x[i], kernel.cut, [&](int j, double rsq) {
    if (rsq < cutsq && j != i && molecule[j] == molecule[i]) near.push_back(j);
  });
  // whatever ranks there are
  std::sort(near.begin(), near.end(), [tag](int a, int b) {
    return tag[a] < tag[b];
  });
  dX.resize(near.size() * D);
  w.resize(near.size());
  for (size_t k = 0; k < near.size(); k++) {
    const double rsq = measure<D>(i, near[k], kernel.cut, &dX[k * D]);
    w[k] = volume(near[k]) * kernel.W(std::sqrt(rsq));
  }
}

// X_j - X_i of neighbors that may be bonded, its square
template <int D> double BondMaker::measure(int i, int j, double cut, double *X) const
{
  const tagint *const tag = atom->tag, *const molecule = atom->molecule;
  const int *const type = atom->type;
  const bool periodic = is_periodic(*domain);
  double rsq = 0.0;
  bool halfway = false;    // round the box: the image on the other side is as near
  for (int a = 0; a < D; a++) {
    X[a] = atom->x[j][a] - atom->x[i][a];
    rsq += X[a] * X[a];
    halfway = halfway ||
        (periodic && domain->periodicity[a] &&
         2.0 * std::fabs(X[a]) > (1.0 - 1.0e-9) * domain->prd[a]);
  }
  if (disc.h_of(type[j]) != disc.h_of(type[i]))
    error->one(FLERR,
               "Solid atoms {} and {} of body {} have the spacings {:g} and {:g} of types {} and "
               "{}: a body has one",
               tag[i], tag[j], molecule[i], disc.dx_of(type[i]), disc.dx_of(type[j]), type[i],
               type[j]);
  if (rsq == 0.0)
    error->one(FLERR,
               "Solid atoms {} and {} of body {} are at the same place: regions overlap, or share "
               "an edge that particles lie on; delete_atoms overlap",
               tag[i], tag[j], molecule[i]);
  if (halfway || (periodic && domain->closest_image(i, j) != j))
    error->one(FLERR,
               "Solid atoms {} and {} are neighbors through more than one image: a periodic box "
               "must be wider than two supports, {}, of the kernel",
               tag[i], tag[j], 2.0 * cut);
  return rsq;
}

// likewise images of its neighbors and of itself in planes of symmetry
template <int D> void BondMaker::find_images(int i, const ChosenKernel &kernel)
{
  double **x = atom->x;
  const Images &images = bonds.images;
  const int own = images.joins(atom->mask, i) ? images.planes.near(x[i], kernel.cut) : 0;
  bits.assign(near.size(), 0);
  if (!own) return;
  const auto add = [&](int j, double rsq) {
    images.planes.images(own & images.planes.near(x[j], kernel.cut), rsq, x[i], x[j],
                         BondStore::WITHIN * kernel.cutsq,
                         [&](const Walls::Reflection &s, double image_rsq, const double *away) {
                           near.push_back(j);
                           bits.push_back(s.mask);
                           for (int a = 0; a < D; a++) dX.push_back(-away[a]);
                           w.push_back(volume(j) * kernel.W(std::sqrt(image_rsq)));
                         });
  };
  const int n = near.size();
  add(i, 0.0);
  for (int k = 0; k < n; k++) {
    if (!images.joins(atom->mask, near[k])) continue;
    double rsq = 0.0;
    for (int a = 0; a < D; a++) rsq += dX[k * D + a] * dX[k * D + a];
    add(near[k], rsq);
  }
}

template <int D> void BondMaker::enter_bonds(int i, const ChosenKernel &kernel)
{
  const int n = near.size();
  const double own = volume(i);
  bonds.make(i, n);
  bonds.enter_place(i, atom->x[i]);
  for (int k = 0; k < n; k++) {
    double *const value = bonds.bond(i, k);
    const double *d = &dX[k * D];
    double rsq = 0.0;
    for (int a = 0; a < D; a++) {
      value[a * BOND_BLOCK] = G[k * D + a];
      value[(D + a) * BOND_BLOCK] = d[a];
      rsq += d[a] * d[a];
    }
    const double r = std::sqrt(rsq), vv = own * volume(near[k]);
    value[2 * D * BOND_BLOCK] = vv * kernel.W(r) / rsq;
    value[(2 * D + 1) * BOND_BLOCK] = vv * kernel.gradient(r);
    bonds.enter(i, k, atom->tag[near[k]], bonds.keeps_images ? bits[k] : 0);
  }
  bonds.complete(i);
}

/* ----------------------------------------------------------------------
   quadrature
------------------------------------------------------------------------- */

// The energy of a total-Lagrangian solid is an integral over particles in the middle of their
// cells: the midpoint rule, which lacks 1/n^2 of the bending stiffness of a plate n particles
// across. With its end corrections, 13/12, 7/8, 25/24 for the first three layers from a face (Press
// et al., Numerical Recipes, eq. 4.1.18), quadratic integrands are exact. They apply along each
// axis of the body's lattice; a body thinner than three layers, or not on a lattice, keeps plain
// volumes there. Masses do not change.
namespace {
class Quadrature : protected Pointers {
 public:
  Quadrature(LAMMPS *lmp, BondStore &bonds) : Pointers(lmp), bonds(bonds) {}
  void find_weights(const std::vector<int> &of);    // of bonded particles, on all ranks together

 private:
  BondStore &bonds;
  struct Axes {
    tagint body, tag;    // of the particle they were found at
    double e[3][3];      // rows
  };
  // of each particle its partners one spacing away along directions 2 axis + (positive side), or
  // -1
  std::vector<std::array<int, 6>> ahead;
  // of local and ghost particles, by direction, layers to the face ahead; 0: deeper than three
  std::vector<double> layer;

  bool is_nearest(const double *X, double dx) const;
  bool find_axes(int i, Axes &) const;
  bool fits(int i, const Axes &) const;
  std::map<tagint, Axes> turned_lattices(const std::vector<int> &) const;
  void find_ahead(const std::vector<int> &);
  int direction_of(const double *X, const Axes &, double dx) const;
  void count_layers(const std::vector<int> &);
  bool weigh(int i);
  void warn_of_bars(bigint bars, bigint all) const;
};
}    // namespace

void BondStore::find_weights(const std::vector<int> &of)
{
  Quadrature(lmp, *this).find_weights(of);
}

// of the spacing: neighbors are no further from where a lattice has them
static constexpr double NEAR = 0.05;

void Quadrature::find_weights(const std::vector<int> &of)
{
  find_ahead(of);
  count_layers(of);
  bigint bars = 0;
  for (const int i : of) bars += weigh(i);
  if (domain->dimension == 3) warn_of_bars(bars, of.size());
}

// a bond (numbers BOND_BLOCK apart) along a direction
static double along(int dim, const double *X, const double *e)
{
  double s = 0.0;
  for (int a = 0; a < dim; a++) s += X[a * BOND_BLOCK] * e[a];
  return s;
}

static double square(int dim, const double *X)
{
  double rsq = 0.0;
  for (int a = 0; a < dim; a++) rsq += X[a * BOND_BLOCK] * X[a * BOND_BLOCK];
  return rsq;
}

bool Quadrature::is_nearest(const double *X, double dx) const
{
  return std::fabs(std::sqrt(square(domain->dimension, X)) - dx) < NEAR * dx;
}

// axes of the lattice that i is on, from its nearest neighbors; false if these are too few
bool Quadrature::find_axes(int i, Axes &axes) const
{
  const int dim = domain->dimension;
  const double dx = bonds.disc->dx_of(atom->type[i]);
  double(*const e)[3] = axes.e;
  int k = 0;
  axes = {atom->molecule[i], atom->tag[i], {}};
  for (int b = 0; b < bonds.count(i) && k < dim - 1; b++) {
    const double *const X = bonds.bond(i, b) + dim * BOND_BLOCK;
    if (!is_nearest(X, dx) || (k && std::fabs(along(dim, X, e[0])) > NEAR * dx)) continue;
    for (int a = 0; a < dim; a++) e[k][a] = X[a * BOND_BLOCK] / dx;
    k++;
  }
  if (dim == 3) {
    MathExtra::cross3(e[0], e[1], e[2]);
  } else {
    e[1][0] = -e[0][1];
    e[1][1] = e[0][0];
  }
  return k == dim - 1;
}

// whether all nearest neighbors of i lie along them, none of them behind a plane of symmetry
bool Quadrature::fits(int i, const Axes &axes) const
{
  const int dim = domain->dimension;
  const double dx = bonds.disc->dx_of(atom->type[i]);
  for (int b = 0; b < bonds.count(i); b++) {
    const double *const X = bonds.bond(i, b) + dim * BOND_BLOCK;
    int across = 0;
    for (int k = 0; k < dim; k++) across += std::fabs(along(dim, X, axes.e[k])) < NEAR * dx;
    if ((is_nearest(X, dx) && across < dim - 1) || bonds.planes(i, b)) return false;
  }
  return true;
}

// axes of the lattices that are turned against the axes of the box, by body
std::map<tagint, Quadrature::Axes> Quadrature::turned_lattices(const std::vector<int> &of) const
{
  std::map<tagint, Axes> first, turned;    // of the first particle that has some
  Axes axes;
  const auto enter = [&first](const Axes &a) {
    const auto at = first.emplace(a.body, a).first;
    if (a.tag < at->second.tag) at->second = a;
  };
  for (const int i : of)
    if (find_axes(i, axes)) enter(axes);
  std::vector<Axes> of_rank;
  for (const auto &body : first) of_rank.push_back(body.second);
  for (const auto &a : gather(of_rank, world)) enter(a);

  for (const auto &body : first) {
    for (const auto &e : body.second.e)
      for (const double c : e)
        if (std::fabs(c) > NEAR && std::fabs(c) < 1.0 - NEAR) turned.insert(body);
  }
  if (turned.empty()) return turned;
  std::set<tagint> no_lattice;
  for (const int i : of) {
    const auto body = turned.find(atom->molecule[i]);
    if (body != turned.end() && !fits(i, body->second)) no_lattice.insert(body->first);
  }
  for (const tagint body : gather(no_lattice, world)) turned.erase(body);
  return turned;
}

void Quadrature::find_ahead(const std::vector<int> &of)
{
  const auto turned = turned_lattices(of);
  const Axes box = {0, 0, {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}};
  ahead.resize(of.size());
  for (size_t n = 0; n < of.size(); n++) {
    const int i = of[n];
    const auto it = turned.find(atom->molecule[i]);
    const double dx = bonds.disc->dx_of(atom->type[i]);
    ahead[n].fill(-1);
    for (int b = 0; b < bonds.count(i); b++) {
      const int direction = direction_of(bonds.bond(i, b) + domain->dimension * BOND_BLOCK,
                                         it == turned.end() ? box : it->second, dx);
      if (direction >= 0 && ahead[n][direction] < 0) ahead[n][direction] = bonds.partners(i)[b];
    }
  }
}

// of a bond of one spacing along an axis; else -1
int Quadrature::direction_of(const double *X, const Axes &axes, double dx) const
{
  const int dim = domain->dimension;
  if (square(dim, X) > 1.7 * dx * dx) return -1;    // most: no need to look closer
  int direction = -1, others = 0;
  for (int a = 0; a < dim; a++) {
    const double s = along(dim, X, axes.e[a]);
    if (std::fabs(s) <= NEAR * dx)
      others++;
    else if (std::fabs(std::fabs(s) - dx) <= NEAR * dx)
      direction = 2 * a + (s > 0.0);
  }
  return others < dim - 1 ? -1 : direction;
}

// layer 1 has no particle ahead, layer m has layer m-1 ahead
void Quadrature::count_layers(const std::vector<int> &of)
{
  const int dim = domain->dimension;
  layer.assign((size_t) atom->nmax * 2 * dim, 0.0);
  // that of an image is that of its original, seen in the mirror
  const auto layer_of = [&](int j, int k) {
    return layer[bonds.images.original(j) * 2 * dim + (bonds.images.mirrors(j, k / 2) ? k ^ 1 : k)];
  };
  for (int m = 1; m <= 3; m++) {
    for (size_t n = 0; n < of.size(); n++)
      for (int i = of[n], k = 0; k < 2 * dim; k++) {
        const int j = ahead[n][k];
        if (m == 1 ? j < 0 : (j >= 0 && layer_of(j, k) == m - 1)) layer[i * 2 * dim + k] = m;
      }
    bonds.messages->send(layer.data(), 2 * dim);
  }
}

// whether it is of a bar, of three particles across or fewer along two axes
bool Quadrature::weigh(int i)
{
  static constexpr double correction[4] = {0.0, 1.0 / 12.0, -1.0 / 8.0, 1.0 / 24.0};
  double w = 1.0;
  int few = 0;
  for (int a = 0; a < domain->dimension; a++) {
    const double *const of_axis = &layer[(i * domain->dimension + a) * 2];
    const int lo = (int) of_axis[0], hi = (int) of_axis[1];
    few += lo && hi && lo + hi <= 4;    // three layers or fewer
    // fewer than three layers: no correction along this axis
    if (lo && hi && lo + hi < 4) continue;
    w *= 1.0 + correction[lo] + correction[hi];
  }
  if (bonds.weight(i) > 0.0) bonds.weight(i) = w;    // else crushed, torn off
  return few > 1;
}

// a lattice of three by three cannot warp
void Quadrature::warn_of_bars(bigint bars, bigint all) const
{
  bars = count_of(bars, world);
  all = count_of(all, world);
  if (2 * bars > all && comm->me == 0)
    error->warning(FLERR,
                   "Pair style fsi/solid/tl: {} of {} particles are of bars of three particles or "
                   "fewer through the thickness: twisted, their frequency is 10 to 16 % too high. "
                   "Take four",
                   bars, all);
}
