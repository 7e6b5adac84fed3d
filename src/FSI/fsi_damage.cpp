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

#include "fsi_damage.h"

#include "atom.h"
#include "domain.h"
#include "fsi_hub.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace FSI;

void Damage::break_bonds(double stretch, const Energy &energy, const Spare &spare)
{
  domain->dimension == 2 ? break_as<2>(stretch, energy, spare)
                         : break_as<3>(stretch, energy, spare);
}

// No particle of this rank's solids moves relative to another by more than the diagonal of the box
// that holds all their displacements. So a particle whose most stretched bond has more than this
// left is not looked at, and the same bonds break at the same step.
template <int D> void Damage::move_apart()
{
  double **x = atom->x;
  const size_t size = (bonds.solids.size() + bonds.ghosts.size()) * D;
  const bool anew = seen.size() != size;
  if (anew) {
    seen.resize(size);
    slack.assign(bonds.solids.size(), 0.0);
  }
  double lo[D], hi[D], sum = 0.0, *before = seen.data();
  std::fill_n(lo, D, std::numeric_limits<double>::max());
  std::fill_n(hi, D, -std::numeric_limits<double>::max());
  for (const auto *set : {&bonds.solids, &bonds.ghosts})
    for (const int i : *set)
      for (int a = 0; a < D; a++) {
        const double d = x[i][a] - *before;
        *before++ = x[i][a];
        lo[a] = std::min(lo[a], d);
        hi[a] = std::max(hi[a], d);
      }
  // images move the other way
  for (const auto &plane : bonds.images.planes.wall) {
    hi[plane.axis] = std::max(hi[plane.axis], -lo[plane.axis]);
    lo[plane.axis] = -hi[plane.axis];
  }
  for (int a = 0; a < D; a++) sum += (hi[a] - lo[a]) * (hi[a] - lo[a]);
  apart = anew ? 0.0 : apart + std::sqrt(sum) + 1e-9 * bonds.disc->dx;    // more than round-off
}

// left: how far particles may move apart until it is, at most
template <int D>
bool Damage::is_longer(int i, int k, double stretch, double **x, double &left) const
{
  const double *const X = bonds.bond(i, k) + D * BOND_BLOCK, *const xj = x[bonds.partners(i)[k]];
  double rsq = 0.0, Rsq = 0.0;
  for (int a = 0; a < D; a++) {
    rsq += (xj[a] - x[i][a]) * (xj[a] - x[i][a]);
    Rsq += X[a * BOND_BLOCK] * X[a * BOND_BLOCK];
  }
  if (rsq > stretch * stretch * Rsq) return true;
  left = std::min(left, apart + stretch * std::sqrt(Rsq) - std::sqrt(rsq));
  return false;
}

void Damage::crush(int i, const Spare &spare, double &left)
{
  if (!bonds.bears(i)) return;
  const double more = spare(i);
  left = std::min(left, apart + more);
  if (more > 0.0) return;
  bonds.weight(i) = 0.0;
  bonds.changes++;
}

template <int D> void Damage::break_as(double stretch, const Energy &energy, const Spare &spare)
{
  if (bonds.solids.empty()) return;
  move_apart<D>();
  bonds.images.update(atom->x);
  double **x = bonds.images.positions(atom->x);
  for (size_t s = 0; s < bonds.solids.size(); s++) {
    if (apart < slack[s]) continue;
    const int i = bonds.solids[s], n = bonds.count(i);
    slack[s] = std::numeric_limits<double>::max();
    crush(i, spare, slack[s]);
    double before = -1.0;
    int kept = 0;
    for (int k = 0; k < n; k++) {
      if (is_longer<D>(i, k, stretch, x, slack[s])) {
        if (before < 0.0) before = energy(i);
        continue;
      }
      if (kept < k) bonds.move(i, k, kept);
      kept++;
    }
    if (kept == n) continue;
    bonds.keep_first(i, kept);
    if (!bonds.renew(i)) bonds.weight(i) = 0.0;
    crush(i, spare, slack[s]);
    const double after = energy(i);
    if (after > before) bonds.weight(i) *= before / after;
    bonds.changes++;
  }
}
