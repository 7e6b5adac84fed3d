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

#include "fsi_implicit_viscosity.h"

#include "atom.h"
#include "error.h"
#include "force.h"
#include "fsi_fields.h"
#include "fsi_fluid_terms.h"
#include "fsi_gather.h"
#include "fsi_pair_sets.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace FSI;

// What is left of the forces that viscosity has to balance, and of its own at the start
static constexpr double LEFT = 1.0e-4;
static constexpr int MOST = 2000;    // iterations

const std::vector<double> &ImplicitViscosity::solve(PairSets &pairs,
                                                    const FluidParticles &particles,
                                                    const ForceLaws &laws, const double *f,
                                                    int columns)
{
  disc.dim == 2 ? solve<2>(pairs, particles, laws, f, columns)
                : solve<3>(pairs, particles, laws, f, columns);
  return w;
}

// A row of the system for what fix fsi moves: inertia; what does not move keeps its velocity
template <int D> void ImplicitViscosity::begin(const double *f, int columns)
{
  const size_t n = (size_t) D * (atom->nlocal + atom->nghost);
  blocks.clear();
  k.clear();
  diagonal.assign(n, 0.0);
  given.assign(n, 0.0);
  driving.assign(n, 0.0);
  w.resize(n);
  for (size_t i = 0; i < n / D; i++)
    for (int d = 0; d < D; d++) w[D * i + d] = atom->v[i][d];
  for (int i = 0; i < atom->nlocal; i++)
    for (int d = 0; d < D; d++)
      given[D * i + d] = driving[D * i + d] = f[columns * i + d] +
          atom->rmass[i] * step.body_forces.of_type[atom->type[i]][d] + step.unforeseen[i][d];
  free.assign(n, 0);
  for (int i = 0; i < atom->nlocal; i++)
    if (disc.state[atom->type[i]].species == FLUID && (atom->mask[i] & disc.mover->groupbit))
      std::fill_n(&free[D * i], D, 1);
}

template <int D> void ImplicitViscosity::pull()
{
  for (const auto &pull : step.pulls) {
    const size_t a = D * pull.i + pull.d;
    if (pull.rate == HUGE_VAL) {
      free[a] = 0;
      w[a] = pull.to;
    } else {
      const double per_velocity = atom->rmass[pull.i] * pull.rate / force->ftm2v;
      diagonal[a] += per_velocity;
      given[a] += per_velocity * pull.to;
    }
  }
}

template <int D>
void ImplicitViscosity::add_pairs(const PairSet &set, const FluidPairs &pairs,
                                  const ForceLaws &laws)
{
  const FluidParticles &in = pairs.in;
  const bool fluids = set.kind == WITH_FLUID;
  if (!fluids && set.what == PairSet::SOLIDS && laws.solids_slip) return;
  const auto *const point = reinterpret_cast<const Point<D> *>(in.points);
  const Mirror image = pairs.mirror ? *pairs.mirror : Mirror();
  const auto viscosity = [&](int i) {
    return laws.viscosity ? laws.viscosity[i] : in.state[in.type[i]].viscosity;
  };
  if (fluids) {
    Block block = {pairs.rows, {1.0, 1.0, 1.0}, k.size()};
    for (int d = 0; d < D; d++) block.sign[d] = image.rubbing_sign[d];
    blocks.push_back(block);
  }
  const ChosenKernel kernel(disc.kernel, D, set.h);
  for (const Row &row : pairs.rows)
    for (const int *j = row.j; j < row.j + row.n; j++) {
      const Point<D> &pi = point[row.i], &pj = point[*j];
      double x[D];
      places_apart<true>(image, pi.x, pj.x, x);
      const State &of_i = in.state[in.type[row.i]], &of_j = in.state[in.type[*j]];
      double g = -kernel.gradient(std::sqrt(FSI::product(x, x))) * pi.rho * pi.vol * of_i.inv_rho0 *
          pj.vol;
      if (of_j.species != SOLID) g *= pj.rho * of_j.inv_rho0;    // as in explicit forces
      if (pairs.mirror && *j == row.i) g *= 0.5;    // it is seen from both sides of the pair
      if (in.visible.part) g = as_visible(in, j, g);
      if (fluids) {
        const double both = 2.0 * g * between(viscosity(row.i), viscosity(*j));
        k.push_back(both);
        for (int d = 0; d < D; d++) {
          const double u = both * image.rubbing_v[d];
          for (const int a : {row.i, *j}) {
            diagonal[D * a + d] += both;
            given[D * a + d] += u;
          }
        }
        continue;
      }
      if (of_j.species == RIGID && !of_j.noslip) continue;
      const double of_face =
          2.0 * cut_off(in, j, g) * viscosity(row.i) * backfill_weight_of(in, row.i, in.type[*j]);
      const bool thin = in.ratio[in.type[*j]].thin;
      for (int d = 0; d < D; d++) {
        const double sign = image.rubbing_sign[d], own = image.slip_sign[d];
        const double beyond = thin ? 2.0 * atom->v[*j][d] - image.slip_v[d]
                                   : laws.wall_velocity[*j][d] + own * laws.before[row.i][d];
        diagonal[D * row.i + d] += of_face * (1.0 + sign * own);
        given[D * row.i + d] += of_face * (sign * beyond + image.rubbing_v[d]);
      }
    }
}

// y = A x of local particles; x gets its ghosts
template <int D> void ImplicitViscosity::multiply(std::vector<double> &x, std::vector<double> &y)
{
  ghosts.send(x.data(), D);
  std::fill(y.begin(), y.end(), 0.0);
  for (const Block &block : blocks) {
    const double *of_pair = k.data() + block.first;
    for (const Row &row : block.rows) {
      const double *const xi = &x[D * row.i];
      double sum[D] = {};
      for (const int *j = row.j; j < row.j + row.n; j++) {
        const double kij = *of_pair++, *const xj = &x[D * *j];
        double *const yj = &y[D * *j];
        for (int d = 0; d < D; d++) {
          sum[d] -= kij * block.sign[d] * xj[d];
          yj[d] -= kij * block.sign[d] * xi[d];
        }
      }
      for (int d = 0; d < D; d++) y[D * row.i + d] += sum[d];
    }
  }
  ghosts.add(y.data(), D);
  for (size_t i = 0; i < (size_t) D * atom->nlocal; i++) y[i] += diagonal[i] * x[i];
}

template <int D>
void ImplicitViscosity::solve(PairSets &pairs, const FluidParticles &particles,
                              const ForceLaws &laws, const double *f, int columns)
{
  const int nlocal = atom->nlocal;
  begin<D>(f, columns);
  pairs.for_all(step.walls, particles, [&](const PairSet &set, const FluidPairs &of_set, int) {
    add_pairs<D>(set, of_set, laws);
  });
  ghosts.add(diagonal.data(), D);
  ghosts.add(given.data(), D);
  pull<D>();
  const size_t n = w.size();
  std::vector<double> z(n, 0.0);
  for (auto *of : {&r, &p, &Ap}) of->assign(n, 0.0);
  const double per_dt = 1.0 / (update->dt * force->ftm2v);
  multiply<D>(w, Ap);
  double scale = 0.0;
  for (int i = 0; i < nlocal; i++) {
    const double inertia = atom->rmass[i] * per_dt;
    for (size_t a = D * i; a < (size_t) D * (i + 1); a++) {
      if (!free[a]) continue;
      r[a] = given[a] - Ap[a];
      const double viscous = r[a] - driving[a];
      scale += (driving[a] * driving[a] + viscous * viscous) / inertia;
      diagonal[a] += inertia;
    }
  }
  const double enough = LEFT * LEFT * sum_of(scale, world);
  double rz = 0.0;
  for (int niterations = 0;; niterations++) {
    double sums[2] = {}, all[2];
    for (size_t a = 0; a < (size_t) D * nlocal; a++) {
      if (!free[a]) continue;
      z[a] = r[a] / diagonal[a];
      sums[0] += r[a] * z[a];
      sums[1] += r[a] * r[a] / (atom->rmass[a / D] * per_dt);
    }
    MPI_Allreduce(sums, all, 2, MPI_DOUBLE, MPI_SUM, world);
    if (!(all[1] > enough)) break;    // what is not a number others find
    if (niterations == MOST)
      error->all(FLERR, "Pair style fsi/fluid laminar/implicit: not solved in {} iterations", MOST);
    const double beta = niterations ? all[0] / rz : 0.0;
    rz = all[0];
    for (size_t a = 0; a < (size_t) D * nlocal; a++) p[a] = z[a] + beta * p[a];
    multiply<D>(p, Ap);
    double pAp = 0.0;
    for (size_t a = 0; a < (size_t) D * nlocal; a++) pAp += p[a] * Ap[a];
    const double alpha = rz / sum_of(pAp, world);
    for (size_t a = 0; a < (size_t) D * nlocal; a++) {
      w[a] += alpha * p[a];
      r[a] -= free[a] * alpha * Ap[a];
    }
  }
  ghosts.send(w.data(), D);
  for (auto &pull : step.pulls) pull.end = w[D * pull.i + pull.d];
}

void ImplicitViscosity::find_unforeseen()
{
  const double dt = update->dt * force->ftm2v;
  for (int i = 0; i < atom->nlocal; i++)
    for (int d = 0; d < disc.dim; d++) {
      const size_t a = disc.dim * i + d;
      double &f = step.unforeseen[i][d];
      f = free[a] ? f + atom->f[i][d] - atom->rmass[i] * (w[a] - atom->v[i][d]) / dt : 0.0;
    }
}

double ImplicitViscosity::memory_usage() const
{
  return (double) (k.capacity() + 7 * w.capacity()) * sizeof(double) + bytes_of(free);
}
