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

#include "fsi_wet_solids.h"

#include "atom.h"
#include "compute_fsi_force.h"
#include "force.h"
#include "fsi_fields.h"
#include "fsi_fluid_terms.h"
#include "fsi_gather.h"
#include "fsi_kernel.h"
#include "fsi_pair_sets.h"
#include "fsi_tensor.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <iterator>

using namespace LAMMPS_NS;
using namespace FSI;

// solids that pass through mirror walls, or may before the next neighbor lists
void CutSolids::find_depths(const Walls &walls)
{
  const auto &wall = walls.wall;
  const int *const type = atom->type, n = wall.size();
  const auto *const x = vectors(atom->x), *const v = vectors(atom->v);
  std::vector<double> here(n * (atom->ntypes + 1), -INFINITY);
  const auto for_near = [&](auto f) {
    const InnerBox inner(wall, neighbor->skin);
    for (int i = 0; i < atom->nlocal; i++) {
      if (inner.contains(x[i]) || disc.state[type[i]].species != SOLID) continue;
      for (int k = 0; k < n; k++)
        if (!wall[k].finite) f(i, n * type[i] + k, wall[k]);
    }
  };
  for_near([&](int i, int m, const Wall &w) {
    here[m] = std::max(here[m], -w.distance(x[i]));
  });
  const auto all = over_ranks(here, MPI_MAX, world);
  may_pass = std::any_of(all.begin(), all.end(), [this](double depth) {
    return depth > -neighbor->skin;
  });
  depths.assign(all.size(), {0.0, 0.0});
  any = std::any_of(all.begin(), all.end(), [](double depth) {
    return depth > 0.0;
  });
  if (!any) return;
  std::fill(here.begin(), here.end(), -INFINITY);
  for_near([&](int i, int m, const Wall &w) {
    if (-w.distance(x[i]) == all[m])
      here[m] = std::max(here[m], -w.side * (v[i][w.axis] - w.velocity[w.axis]));
  });
  const auto speeds = over_ranks(here, MPI_MAX, world);
  for (size_t m = 0; m < all.size(); m++)
    if (all[m] > 0.0) depths[m] = {all[m], speeds[m]};
}

void CutSolids::find(StepState &step)
{
  const Walls &walls = step.walls;
  any = false;
  if (!walls.any() || !has_solids || (neighbor->ago && !may_pass)) return;
  find_depths(walls);
  if (!any) return;
  const int *const type = atom->type, nall = atom->nlocal + atom->nghost;
  const auto *const x = vectors(atom->x), *const v = vectors(atom->v);
  parts.assign(nall, 1.0);
  part_rates.assign(nall, 0.0);
  for (int i = 0; i < nall; i++) {
    if (disc.state[type[i]].species != SOLID) continue;
    const double dx = disc.dx_of(type[i]);
    parts[i] = walls.before(x[i], v[i], dx, &depths[walls.wall.size() * type[i]], part_rates[i]);
    step.wmask[i] = parts[i] > 0.0 ? walls.near(x[i], disc.cut, 0.5 * dx) : 0;
  }
}

const Cut *CutSolids::of_particles()
{
  cut = {parts.data(), part_rates.data()};
  return any ? &cut : nullptr;
}

// of a step with sub-steps: the types that are light in fluid of this level
std::vector<char> LightSolids::types(size_t level) const
{
  const auto &state = disc.state;
  const auto layer = [&](int t) {
    return state[t].rho0 * disc.dx_of(t);
  };
  double fluid = 0.0;
  for (int t = 1; t <= atom->ntypes; t++)
    if (state[t].species == FLUID && disc.level_of[t] == level) fluid = std::max(fluid, layer(t));
  std::vector<char> light(atom->ntypes + 1, 0);
  for (int t = 1; t <= atom->ntypes; t++)
    light[t] = state[t].species == SOLID && layer(t) < 0.5 * fluid;
  return light;
}

bool LightSolids::any() const
{
  if (step.substeps <= 1) return false;
  for (size_t level = 0; level < disc.levels.size(); level++) {
    const auto light = types(level);
    if (std::find(light.begin(), light.end(), 1) != light.end()) return true;
  }
  return false;
}

// use(i, j, x_ij, seen, k, eta, reflection) for pairs of a fluid and a solid, whose change of
// velocity w within the step changes the force on the fluid by k x_ij (seen.w), if it is light, +
// eta w. Of an image of j in the walls of a reflection (else null) seen is x_ij, mirrored, as j
// itself sees it.
template <class Use>
void LightSolids::for_wet_pairs(PairSets &sets, const FluidParticles &particles, Use use) const
{
  static constexpr double HALF = 0.3;    // of the stiffness of a wet area, over rho c^2/dx
  const int *const type = atom->type;
  const auto visit = [&](const PairSet &set, const FluidPairs &pairs,
                         const Walls::Reflection *reflection, auto dim) {
    constexpr int D = dim();
    const ChosenKernel kernel(disc.kernel, D, set.h);
    const FluidParticles &in = pairs.in;
    const Mirror mirror = pairs.mirror ? *pairs.mirror : Mirror();
    const auto *const point = reinterpret_cast<const Point<D> *>(in.points);
    const std::vector<char> light = types(set.level);
    const double dx = disc.levels[set.level].dx;
    for (const Row &row : pairs.rows) {
      if (row.n == 0) continue;
      const int i = row.i, t = type[row.j[0]];
      if (!light[t] && !viscous) continue;
      const State &s = disc.state[type[i]];
      const double z = light[t] * HALF * s.rho0 * s.csq / dx * update->dt * backfill_of(in, i, t);
      const double eta = !viscous
          ? 0.0
          : backfill_weight_of(in, i, t) * (step.viscosity ? step.viscosity[i] : s.viscosity);
      for (const int *j = row.j; j < row.j + row.n; j++) {
        double x[D], seen[D];
        for (int d = 0; d < D; d++) {
          x[d] = point[i].x[d] - mirror.x[d] - mirror.sign[d] * point[*j].x[d];
          seen[d] = mirror.sign[d] * x[d];
        }
        const double rsq = product(x, x), r = std::sqrt(rsq);
        if (rsq >= kernel.cutsq || r == 0.0 || !(atom->mask[*j] & disc.mover->groupbit)) continue;
        const double v = point[i].vol * point[*j].vol * cut_off(in, j, kernel.gradient(r));
        use(i, *j, x, seen, -2.0 * z * v / r, -4.0 * eta * v, reflection);
      }
    }
  };
  sets.for_all(step.walls, particles, [&](const PairSet &set, const FluidPairs &pairs, int k) {
    if (set.what != PairSet::SOLIDS) return;
    const auto *const reflection = pairs.mirror ? &step.walls.reflections[k] : nullptr;
    disc.dim == 2 ? visit(set, pairs, reflection, std::integral_constant<int, 2>())
                  : visit(set, pairs, reflection, std::integral_constant<int, 3>());
  });
}

void LightSolids::find_impedances(PairSets &sets, const FluidParticles &particles)
{
  auto *const z = step.impedance, *const w = step.swerve;
  for (auto *rows : {z, z + 3, w})
    for (int d = 0; d < 3; d++) rows[d].assign(atom->nlocal + atom->nghost, 0.0);
  for_wet_pairs(sets, particles,
                [&](int, int j, const auto &, const auto &x, double k, double eta, const auto *) {
                  const int dim = std::size(x);
                  for (int a = 0; a < dim; a++)
                    for (int b = a; b < dim; b++)
                      z[Sym<3>::id(a, b)][j] += k * x[a] * x[b] + (a == b) * eta;
                });
  for (int a = 0; a < disc.dim; a++)
    for (int b = a; b < disc.dim; b++) ghosts.add(z[Sym<3>::id(a, b)].data());
}

void LightSolids::react(PairSets &sets, const FluidParticles &particles,
                        const std::vector<ComputeFSIForce *> &measures)
{
  const int dim = disc.dim, nlocal = atom->nlocal;
  const bool newton = force->newton_pair;
  std::vector<double> more[3];
  auto &w = step.swerve;
  for (int d = 0; d < dim; d++) {
    ghosts.send(w[d].data());
    more[d].assign(w[d].size(), 0.0);
  }
  for_wet_pairs(sets, particles,
                [&](int i, int j, const auto &x, const auto &seen, double k, double,
                    const Walls::Reflection *reflection) {
                  double push = 0.0;
                  for (size_t b = 0; b < std::size(x); b++) push += k * seen[b] * w[b][j];
                  const double share = share_of<double>(i, &j, nlocal, newton);
                  for (size_t a = 0; a < std::size(x); a++) {
                    more[a][i] += push * x[a];
                    more[a][j] -= push * seen[a];
                    if (reflection)
                      step.add_wall_force(step.walls.row().pushed(*reflection, a), a,
                                          share * push * (x[a] - seen[a]));
                  }
                });
  for (int d = 0; d < dim; d++) ghosts.add(more[d].data());
  double power = 0.0;    // that on solids is counted in their sub-steps
  for (int i = 0; i < atom->nlocal; i++) {
    const bool counts =
        (atom->mask[i] & disc.mover->groupbit) && disc.state[atom->type[i]].species == FLUID;
    double f[3] = {};
    for (int d = 0; d < dim; d++) {
      atom->f[i][d] += f[d] = more[d][i];
      if (counts)
        power += f[d] *
            (atom->v[i][d] + 0.5 * update->dt * force->ftm2v * atom->f[i][d] / atom->rmass[i]);
    }
    for (auto *measure : measures) measure->add_more(i, f);
  }
  ledger.tally(Ledger::COUPLING, -power);
}
