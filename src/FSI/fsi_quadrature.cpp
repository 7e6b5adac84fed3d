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

// The energy of a total-Lagrangian solid is an integral over particles in the middle of their
// cells: the midpoint rule, which lacks 1/n^2 of the bending stiffness of a plate n particles
// across. With its end corrections, 13/12, 7/8, 25/24 for the first three layers from a face (Press
// et al., Numerical Recipes, eq. 4.1.18), quadratic integrands are exact. They apply along each
// axis of the body's lattice; a body thinner than three layers, or not on a lattice, keeps plain
// volumes there. Masses do not change.

#include "fsi_bond_store.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fsi_gather.h"
#include "fsi_hub.h"
#include "math_extra.h"

#include <array>
#include <cmath>
#include <map>
#include <set>

using namespace LAMMPS_NS;
using namespace FSI;

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
    bonds.send(layer.data());
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
  bonds.weight(i) = w;
  return few > 1;
}

// a lattice of three by three cannot warp
void Quadrature::warn_of_bars(bigint bars, bigint all) const
{
  bigint of_rank[2] = {all, bars}, sum[2];
  MPI_Allreduce(of_rank, sum, 2, MPI_LMP_BIGINT, MPI_SUM, world);
  if (2 * sum[1] > sum[0] && comm->me == 0)
    error->warning(FLERR,
                   "Pair style fsi/solid/tl: {} of {} particles are of bars of three particles or "
                   "fewer through the thickness: twisted, their frequency is 10 to 16 % too high. "
                   "Take four",
                   sum[1], sum[0]);
}
