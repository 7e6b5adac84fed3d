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

#include "fsi_settling.h"

#include "atom.h"
#include "comm.h"
#include "fsi_cells.h"
#include "fsi_kernel.h"
#include "fsi_scene.h"
#include "math_extra.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace FSI;

// A step over the sum of V grad W dx^2, and the longest over dx
static constexpr double STRENGTH = 0.15, LONGEST = 0.05;
// Sums of V W: particles with the first are at a surface and stay, with the second move as others
static constexpr double SURFACE = 0.9, INSIDE = 0.95;
static constexpr double SKIN = 1.0;    // of rows, in spacings

Settling::Settling(LAMMPS *lmp, Scene &scene, const std::vector<char> &moves,
                   const std::vector<Position> &changed) :
    Pointers(lmp),
    scene(scene)
{
  const double of_body = scene.cut + scene.dx, beyond = scene.cut + 1.1 * of_body;
  const Everywhere events(lmp, beyond, changed);
  // the others hold nobody off: who moves is within the support of an event
  const auto bodies = everywhere(lmp, of_body, [&](int j) {
    const int species = scene.state[atom->type[j]].species;
    return (species == SOLID || species == RIGID) && events.nearest(atom->x[j]) < beyond * beyond;
  });
  mobility.assign(atom->nlocal, 0.0);
  for (int i = 0; i < atom->nlocal; i++) {
    if (!moves[i]) continue;
    const double *const x = atom->x[i];
    const double cut = scene.resolution[atom->type[i]].cut, dx = scene.dx_of(atom->type[i]);
    const double event = events.nearest(x);
    if (event >= cut * cut) continue;
    double body = std::sqrt(std::min((cut + dx) * (cut + dx), bodies.nearest(x)));
    for (const auto &wall : scene.walls.wall)
      if (wall.finite && wall.spans(x, cut)) body = std::min(body, std::fabs(wall.distance(x)));
    mobility[i] =
        std::min(1.0, 2.0 - 2.0 * std::sqrt(event) / cut) * std::max(0.0, (body - cut) / dx);
  }
}

void Settling::find_rows()
{
  const int nall = atom->nlocal + atom->nghost;
  const double skin = SKIN * scene.dx;
  const Cells cells(atom->x, nall, scene.dim, scene.cut + skin, [&](int j) {
    return scene.state[atom->type[j]].species != NONE;
  });
  rows.clear();
  neighbors.clear();
  for (int i = 0; i < atom->nlocal; i++) {
    if (mobility[i] <= 0.0) continue;
    const int first = (int) neighbors.size();
    const double own = scene.resolution[atom->type[i]].cut;
    cells.around(atom->x[i], [&](int j, double rsq) {
      const double reach = 0.5 * (own + scene.resolution[atom->type[j]].cut) + skin;
      if (j != i && rsq < reach * reach) neighbors.push_back(j);
    });
    rows.push_back({i, first, (int) neighbors.size()});
  }
  start.resize(3 * nall);
  for (int i = 0; i < nall; i++) MathExtra::copy3(atom->x[i], &start[3 * i]);
}

bool Settling::rows_hold() const
{
  const double most = 0.5 * SKIN * scene.dx;
  for (int i = 0; i < atom->nlocal + atom->nghost; i++)
    if (MathExtra::distsq3(atom->x[i], &start[3 * i]) > most * most) return false;
  return true;
}

void Settling::run(int sweeps)
{
  volume.resize(atom->nlocal + atom->nghost);
  for (size_t j = 0; j < volume.size(); j++) volume[j] = atom->rmass[j] / atom->rho[j];
  with_kernel(scene.kernel, scene.dim, scene.h, [&](const auto &kernel) {
    using K = std::decay_t<decltype(kernel)>;
    std::vector<K> of_types;
    for (int a = 0; a <= atom->ntypes; a++)
      for (int b = 0; b <= atom->ntypes; b++)
        of_types.emplace_back(0.5 * (scene.h_of(a) + scene.h_of(b)));
    for (int k = 0; k < sweeps; k++) {
      if (k == 0 || !rows_hold()) find_rows();
      sweep(of_types);
      comm->forward_comm();
    }
  });
}

template <class K> void Settling::sweep(const std::vector<K> &of_types)
{
  double *const *const x = atom->x, *const account = scene.account(Ledger::LEVELS);
  const int *const type = atom->type;
  std::vector<double> steps(3 * rows.size());
  for (size_t r = 0; r < rows.size(); r++) {
    const auto &row = rows[r];
    const int i = row.i;
    const K *const with = &of_types[type[i] * (atom->ntypes + 1)];
    double *const d = &steps[3 * r], filled = volume[i] * with[type[i]].W(0.0);
    const int walls = scene.walls.near(x[i], scene.cut);
    const auto add = [&](const K &kernel, int j, double rsq, const double *away) {
      const double distance = std::sqrt(rsq), g = volume[j] * kernel.gradient(distance);
      for (int a = 0; a < K::DIM; a++) d[a] += g * away[a];
      filled += volume[j] * kernel.W(distance);
    };
    const auto add_images = [&](const K &kernel, int j, double rsq) {
      scene.walls.images(walls, rsq, x[i], x[j], kernel.cutsq,
                         [&](const Walls::Reflection &, double rsq_image, const double *away) {
                           add(kernel, j, rsq_image, away);
                         });
    };
    if (walls) add_images(with[type[i]], i, 0.0);
    for (int n = row.first; n < row.end; n++) {
      const int j = neighbors[n];
      const K &kernel = with[type[j]];
      double away[3] = {}, rsq = 0.0;
      for (int a = 0; a < K::DIM; a++) {
        away[a] = x[i][a] - x[j][a];
        rsq += away[a] * away[a];
      }
      if (rsq >= kernel.cutsq) continue;    // images are further away
      add(kernel, j, rsq, away);
      if (walls) add_images(kernel, j, rsq);
    }
    const double dx = scene.dx_of(type[i]),
                 full = std::clamp((filled - SURFACE) / (INSIDE - SURFACE), 0.0, 1.0);
    MathExtra::scale3(-STRENGTH * dx * dx * mobility[i] * full, d);
    const double length = MathExtra::len3(d);
    if (length > LONGEST * dx) MathExtra::scale3(LONGEST * dx / length, d);
  }
  for (size_t r = 0; r < rows.size(); r++) {
    const int i = rows[r].i;
    if (account) *account += scene.potential(i);
    for (int a = 0; a < K::DIM; a++) x[i][a] += steps[3 * r + a];
    if (account) *account -= scene.potential(i);
  }
}
