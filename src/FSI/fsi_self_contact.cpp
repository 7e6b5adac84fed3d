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

#include "fsi_self_contact.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fsi_cells.h"
#include "fsi_fields.h"
#include "fsi_gather.h"
#include "fsi_hub.h"
#include "fsi_pair_laws.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace FSI;

double SelfContact::largest_dx() const
{
  double widest = 0.0;
  for (const int i : bonds.solids) widest = std::max(widest, bonds.disc->dx_of(atom->type[i]));
  return widest;
}

void SelfContact::find_pairs()
{
  pairs.clear();
  if (range == 0.0) return;
  const int dim = domain->dimension;
  std::vector<double> places((size_t) atom->nmax * dim);
  for (const int i : bonds.solids)
    std::copy_n(bonds.place(i), dim, places.begin() + (size_t) i * dim);
  bonds.messages->send(places.data(), dim);
  const Cells cells(atom->x, atom->nlocal + atom->nghost, dim,
                    range * largest_dx() + neighbor->skin, [this](int i) {
                      return bonds.is_solid(i);
                    });
  for (const int i : bonds.solids) find_pairs_of(i, places, cells);
}

void SelfContact::find_pairs_of(int i, const std::vector<double> &places, const Cells &cells)
{
  const int dim = domain->dimension;
  const double most = range * bonds.disc->dx_of(atom->type[i]),
               support = bonds.disc->resolution[atom->type[i]].cut;
  const size_t first = pairs.size();
  cells.around(atom->x[i], [&](int j, double rsq) {
    if (j == i || atom->molecule[j] != atom->molecule[i]) return;
    double Rsq = 0.0;
    for (int a = 0; a < dim; a++) {
      double X = places[(size_t) j * dim + a] - places[(size_t) i * dim + a];
      if (domain->periodicity[a]) X -= domain->prd[a] * std::round(X / domain->prd[a]);
      Rsq += X * X;
    }
    const bool neighbors = Rsq < BondStore::WITHIN * support * support;
    if (neighbors && !tears) return;
    const double reach = reach_within_body(most, std::sqrt(Rsq), neighbors),
                 near = reach + neighbor->skin;
    if (rsq < near * near) pairs.push_back({i, j, reach, neighbors});
  });
  // sums do not depend on the order of ghosts
  std::sort(pairs.begin() + first, pairs.end(), [this](const auto &a, const auto &b) {
    return atom->tag[a.j] < atom->tag[b.j];
  });
}

// A body that damage tears off a plane does not meet its image there, from which it was not apart.
void SelfContact::find_joined()
{
  std::vector<tagint> found;    // bodies and bits
  for (const int i : bonds.solids) {
    int bits = 0;
    for (int k = 0; k < bonds.count(i); k++) bits |= bonds.planes(i, k) & ~Images::HALF;
    int &known = joined[atom->molecule[i]];
    if (!(bits & ~known)) continue;
    known |= bits;
    found.insert(found.end(), {atom->molecule[i], bits});
  }
  found = gather(found, world);
  for (size_t k = 0; k < found.size(); k += 2) joined[found[k]] |= (int) found[k + 1];
}

void SelfContact::find_image_pairs()
{
  image_pairs.clear();
  const Images &images = bonds.images;
  if (!images.planes.any()) return;
  double most = neighbor->skin;
  for (int t = 1; t <= atom->ntypes; t++)
    most = std::max(most, neighbor->skin + range_of_images * bonds.disc->dx_of(t));
  std::vector<int> apart;
  for (const int i : bonds.solids)
    if (images.joins(atom->mask, i) &&
        !goes_on(atom->molecule[i], images.planes.near(atom->x[i], most)))
      apart.push_back(i);
  if (apart.empty()) return;
  const Cells cells(atom->x, atom->nlocal + atom->nghost, domain->dimension, most, [&](int j) {
    return bonds.is_solid(j) && images.joins(atom->mask, j);
  });
  for (const int i : apart) {
    const size_t first = image_pairs.size();
    cells.around(atom->x[i], [&](int j, double rsq) {
      if (atom->molecule[j] == atom->molecule[i] && rsq < most * most)
        image_pairs.push_back({i, j});
    });
    // sums do not depend on the order of ghosts
    std::sort(image_pairs.begin() + first, image_pairs.end(), [this](const auto &a, const auto &b) {
      return atom->tag[a.second] < atom->tag[b.second];
    });
  }
}

void SelfContact::begin_to_look()
{
  if (next_look != MAXBIGINT) next_look = update->ntimestep;
}

// Without contact parts of one body pass through each other. Looked for rarely: it takes long, and
// nothing depends on it but a warning.
void SelfContact::look()
{
  static constexpr int EVERY = 200;      // steps
  static constexpr double NEAR = 0.9;    // spacings
  if (update->ntimestep < next_look || range > 0.0) return;
  next_look = update->ntimestep + EVERY;
  struct {
    double r;
    tagint a, b, body;
  } nearest = {NEAR, 0, 0, 0};
  if (!bonds.solids.empty()) {
    const Cells cells(atom->x, atom->nlocal + atom->nghost, domain->dimension, NEAR * largest_dx(),
                      [this](int i) {
                        return bonds.is_solid(i);
                      });
    for (const int i : bonds.solids)
      cells.around(atom->x[i], [&](int j, double rsq) {
        const double r = std::sqrt(rsq) / bonds.disc->dx_of(atom->type[i]);
        if (r >= nearest.r || j == i || atom->molecule[j] != atom->molecule[i] ||
            bonds.bonded(i, j))
          return;
        nearest = {r, std::min(atom->tag[i], atom->tag[j]), std::max(atom->tag[i], atom->tag[j]),
                   atom->molecule[i]};
      });
  }
  const auto least = of_least(nearest.r, nearest, world);
  if (least.r >= NEAR) return;
  next_look = MAXBIGINT;
  if (comm->me == 0)
    error->warning(FLERR,
                   "Pair style fsi/solid/tl: atoms {} and {} of body {} have no bond and are "
                   "{:.2g} spacings apart at step {}: parts of one body pass through each other. "
                   "If they are two bodies, give each a molecule ID; for contact of a body with "
                   "itself contact 2 self yes",
                   least.a, least.b, least.body, least.r, update->ntimestep);
}
