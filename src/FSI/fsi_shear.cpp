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

#include "fsi_shear.h"

#include "atom.h"
#include "fsi_fields.h"
#include "fsi_fluid_terms.h"
#include "fsi_pair_sets.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace FSI;

// The determinant of sum_j V_j x_ji (x) grad_i W_ij is 1 inside a fluid, some 1e-3 in its corners;
// below this a gradient says nothing
static constexpr double FEW = 1.0e-4;

// numbers per particle: grad v, and how far it is known: 0 where neighbors are few, 1 from half a
// support on, as at a flat surface
static constexpr int numbers_of(int dim)
{
  return dim * dim + 1;
}

// of a particle: sums of slopes_of_pair(), by V_i
template <int D> static constexpr int NSUMS = (Sym<D>::N + D * D + 3) / 4 * 4;

// OF_FLUIDS: the neighbors take part, too
template <class T, class K, bool IMAGES, bool OF_FLUIDS>
static void add_rows(const RowSpan rows, const Mirror &mirror, const K &kernel,
                     const FluidParticles &in, const ForceLaws &laws, double *sums)
{
  constexpr int D = K::DIM, ROW = NSUMS<D>;
  const auto *const point = reinterpret_cast<const Point<D> *>(in.points);
  auto *const sum = reinterpret_cast<double(*)[ROW]>(sums);
  run_loop<T>([&](auto number) FSI_INLINE_LAMBDA {
    using Number = decltype(number);
    for (const Row &row : rows) {
      if (row.n == 0) continue;
      const int type_j = in.type[row.j[0]];
      const State &other = in.state[type_j];
      if (other.species == RIGID && !other.noslip) continue;    // there is no fluid beyond it
      if (OF_FLUIDS && !other.shears_as(in.state[in.type[row.i]])) continue;
      const bool thin = in.ratio[type_j].thin;
      const double backfill = backfill_of(in, row.i, type_j);
      const Particle<Number, D> pi(point[row.i]);
      Number of_i[ROW];
      for (Number &s : of_i) s = 0.0;
      for_neighbors<Number, IMAGES>(row, [&](const int *j, const Number &weight) FSI_INLINE_LAMBDA {
        const Particle<Number, D> pj(point, j);
        Number x[D], v[D], u[D], part[ROW];
        for (Number &p : part) p = 0.0;
        for (int d = 0; d < D; d++)
          u[d] = OF_FLUIDS ? pj.v[d]
              : thin       ? 2.0 * pj.v[d] - mirror.own_velocity(d, pi.v[d])
                           : Lanes<Number>::make([&](int k) {
                         return laws.wall_velocity[j[k]][d];
                       });
        places_apart<IMAGES>(mirror, pi.x, pj.x, x);
        rubbing_apart<IMAGES>(mirror, pi.v, u, v);
        Number g = kernel.gradient(root(product(x, x))) * (backfill * pi.vol) * pj.vol;
        if (!OF_FLUIDS) g = cut_off(in, j, g);
        if (IMAGES) g = weight * g;
        if constexpr (std::is_same_v<Number, double>)
          if (in.visible.part) g = as_visible(in, j, g);
        slopes_of_pair<D>(part, g, x, v);
        for (int k = 0; k < ROW; k++) of_i[k] += part[k];
        if (!OF_FLUIDS) return;
        if (IMAGES) {
          for (int d = 0; d < D; d++) x[d] = -mirror.sign[d] * x[d];
          rubbing_apart<IMAGES>(mirror, pj.v, pi.v, v);
          slopes_of_pair<D>(part, g, x, v);
        }
        Lanes<Number>::add_rows(part, sum, j);
      });
      for (int k = 0; k < ROW; k++) sum[row.i][k] += Lanes<Number>::sum(of_i[k]);
    }
  });
}

// adds V_i V_j W_ij (L_i - L_j), L = grad v as far as both are known, to the sums of both; an image
// has the signs of its walls
template <class T, class K, bool IMAGES, int D = K::DIM, int ROW>
static void add_differences(const RowSpan rows, const Mirror &mirror, const K &kernel,
                            const FluidParticles &in, const double *L, double (*const sum)[ROW])
{
  constexpr int N = numbers_of(D);
  const auto *const point = reinterpret_cast<const Point<D> *>(in.points);
  double sign[D * D];
  for (int k = 0; k < D * D; k++)
    sign[k] = IMAGES ? mirror.rubbing_sign[k / D] * mirror.sign[k % D] : 1.0;
  run_loop<T>([&](auto number) FSI_INLINE_LAMBDA {
    using Number = decltype(number);
    for (const Row &row : rows) {
      if (row.n == 0 || !in.state[in.type[row.i]].shears_as(in.state[in.type[row.j[0]]])) continue;
      const double *const Li = L + (size_t) N * row.i;
      const Particle<Number, D> pi(point[row.i]);
      Number of_i[D * D];
      for (Number &s : of_i) s = 0.0;
      for_neighbors<Number, IMAGES>(row, [&](const int *j, const Number &weight) FSI_INLINE_LAMBDA {
        const Particle<Number, D> pj(point, j);
        Number x[D], on_j[D * D];
        places_apart<IMAGES>(mirror, pi.x, pj.x, x);
        const auto of_j = [&](int k) FSI_INLINE_LAMBDA {
          return Lanes<Number>::make([&](int n) {
            return L[(size_t) N * j[n] + k];
          });
        };
        Number w =
            weight * kernel.W(root(product(x, x))) * (pi.vol * Li[N - 1]) * (pj.vol * of_j(N - 1));
        if constexpr (std::is_same_v<Number, double>)
          if (in.visible.part) w = as_visible(in, j, w);
        for (int k = 0; k < D * D; k++) {
          const Number Lj = of_j(k);
          of_i[k] += w * (Li[k] - sign[k] * Lj);
          on_j[k] = w * (Lj - sign[k] * Li[k]);
        }
        Lanes<Number>::add_rows(on_j, sum, j);
      });
      for (int k = 0; k < D * D; k++) sum[row.i][k] += Lanes<Number>::sum(of_i[k]);
    }
  });
}

bool Shear::varies() const
{
  return eddies > 0.0 || std::any_of(disc.state.begin(), disc.state.end(), [](const State &s) {
           return s.law.varies();
         });
}

void Shear::find_gradients(PairSets &pairs, const FluidParticles &particles, const ForceLaws &laws)
{
  disc.dim == 2 ? find_gradients<2>(pairs, particles, laws)
                : find_gradients<3>(pairs, particles, laws);
}

// calls loop(number, kernel, image, mirror, pairs, set) for all sets of pairs; images are few, and
// come pair by pair
template <int D, class Loop>
void Shear::for_rows(PairSets &pairs, const FluidParticles &particles, Loop loop) const
{
  pairs.for_all(step.walls, particles, [&](const PairSet &set, const FluidPairs &of_set, int) {
    with_kernel(disc.kernel, D, set.h, [&](const auto &kernel) {
      if constexpr (std::decay_t<decltype(kernel)>::DIM == D) {
        if (of_set.mirror)
          loop(0.0, kernel, std::true_type(), *of_set.mirror, of_set, set);
        else if (have_packs() && !of_set.in.visible.part)
          loop(Pack(), kernel, std::false_type(), Mirror(), of_set, set);
        else
          loop(0.0, kernel, std::false_type(), Mirror(), of_set, set);
      }
    });
  });
}

template <int D>
void Shear::find_gradients(PairSets &pairs, const FluidParticles &particles, const ForceLaws &laws)
{
  constexpr int ROW = NSUMS<D>, N = Sym<D>::N;
  const int nlocal = atom->nlocal, nall = nlocal + atom->nghost, *const type = atom->type;
  sums.assign((size_t) ROW * nall, 0.0);
  gradients.assign((size_t) numbers_of(D) * nall, 0.0);
  for_rows<D>(pairs, particles,
              [&](auto number, const auto &kernel, auto image, const Mirror &mirror,
                  const FluidPairs &of_set, const PairSet &set) {
                using T = decltype(number);
                using K = std::decay_t<decltype(kernel)>;
                // no fluid beyond solids that slip
                if (set.what == PairSet::SOLIDS && laws.solids_slip) return;
                (set.kind == WITH_FLUID ? add_rows<T, K, image(), true>
                                        : add_rows<T, K, image(), false>) (of_set.rows, mirror,
                                                                           kernel, of_set.in, laws,
                                                                           sums.data());
              });
  ghosts.add(sums.data(), ROW);
  for (int i = 0; i < nlocal; i++) {
    if (disc.state[type[i]].species != FLUID) continue;
    const double *const s = &sums[(size_t) ROW * i];
    double B[D * D], C[D * D], *const L = &gradients[(size_t) numbers_of(D) * i];
    for (int a = 0; a < D; a++)
      for (int b = 0; b < D; b++) B[a * D + b] = s[Sym<D>::id(a, b)];
    const double det = determinant<D>(B), vol = atom->rmass[i] / atom->rho[i];
    const double part = std::fabs(det) / std::pow(vol, D);
    if (part < FEW) continue;
    cofactor<D>(B, C);    // B is symmetric
    for (int a = 0; a < D; a++)
      for (int b = 0; b < D; b++)
        for (int c = 0; c < D; c++) L[a * D + b] += s[N + a * D + c] * C[c * D + b] / det;
    L[D * D] = std::min(1.0, 2.0 * part);
  }
  sharpen<D>(pairs, particles);
}

// What the kernel has smoothed is undone to first order (van Cittert; Stolz and Adams 1999):
//   grad v_i += sum_j V_j W_ij (grad v_i - grad v_j)  over fluids and their images, as far as both
// gradients are known, of one viscosity
template <int D> void Shear::sharpen(PairSets &pairs, const FluidParticles &particles)
{
  constexpr int ROW = D == 2 ? 4 : 12;    // the gradient by its components
  ghosts.send(gradients.data(), numbers_of(D));
  sums.assign((size_t) ROW * (atom->nlocal + atom->nghost), 0.0);
  for_rows<D>(pairs, particles,
              [&](auto number, const auto &kernel, auto image, const Mirror &mirror,
                  const FluidPairs &of_set, const PairSet &set) {
                if (set.kind == WITH_FLUID)
                  add_differences<decltype(number), std::decay_t<decltype(kernel)>, image()>(
                      of_set.rows, mirror, kernel, of_set.in, gradients.data(),
                      reinterpret_cast<double(*)[ROW]>(sums.data()));
              });
  ghosts.add(sums.data(), ROW);
  for (int i = 0; i < atom->nlocal; i++)
    for (int k = 0; k < D * D; k++)
      gradients[(size_t) numbers_of(D) * i + k] +=
          sums[(size_t) ROW * i + k] * atom->rho[i] / atom->rmass[i];
}

const double *Shear::gradient(int i) const
{
  return &gradients[(size_t) numbers_of(disc.dim) * i];
}

double Shear::rate(int i) const
{
  return std::sqrt(
      2.0 *
      (disc.dim == 2 ? symmetric<2>(gradient(i)).squared() : symmetric<3>(gradient(i)).squared()));
}

double Shear::viscosity_of(int i) const
{
  const State &s = disc.state[atom->type[i]];
  const double rate_i = rate(i), length = eddies * disc.dx_of(atom->type[i]);
  return (s.law.varies() ? s.law(rate_i) : s.viscosity) + s.rho0 * length * length * rate_i;
}

void Shear::stress(int i, double eta, double *sigma) const
{
  const int D = disc.dim;
  const double *const L = gradient(i);
  for (int a = 0; a < D; a++)
    for (int b = a; b < D; b++) sigma[Sym<3>::id(a, b)] = eta * (L[a * D + b] + L[b * D + a]);
}

void Shear::find_viscosities(PairSets &pairs, const FluidParticles &particles,
                             const ForceLaws &laws)
{
  find_gradients(pairs, particles, laws);
  viscosity.resize(atom->nlocal + atom->nghost);
  for (int i = 0; i < atom->nlocal; i++) {
    const State &s = disc.state[atom->type[i]];
    viscosity[i] = s.species == FLUID ? viscosity_of(i) : s.viscosity;
  }
  ghosts.send(viscosity.data());
}
