/* -*- c++ -*- ----------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   Copyright (2003) Sandia Corporation.  Under the terms of Contract
   DE-AC04-94AL85000 with Sandia Corporation, the U.S. Government retains
   certain rights in this software.  This software is distributed under
   the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// The terms of the fluid's loops: what one pair, or a pack of them, adds to rates and forces. Each
// effect stands here once; a loop has those that its flags name (fsi_fluid_rows.h).

#ifndef LMP_FSI_FLUID_TERMS_H
#define LMP_FSI_FLUID_TERMS_H

#include "fsi_fluid_loops.h"
#include "fsi_kernel.h"
#include "fsi_pair_laws.h"
#include "fsi_rows.h"
#include "fsi_tensor.h"

#include <type_traits>

namespace LAMMPS_NS::FSI {

// what a loop is compiled for: effects; sums of powers; neighbors that are images; results for
// neighbors, too; neighbors of another spacing; shifting, with what tells surfaces or what it
// changes of velocities; pairs that thin bodies hide in part; shifting beside fluid of another
// spacing; viscosity that differs from particle to particle
namespace Flag {
  enum {
    ARTIFICIAL = 1,
    LAMINAR = 2,
    SUMS = 4,
    IMAGES = 8,
    DIFFUSION = 16,
    BOTH = 32,
    DIVERGENCE = 64,
    UNEQUAL = 128,
    SHIFT = 256,
    CENTRAL = 512,
    SLOPES = 1024,
    PARTLY = 2048,
    EDGES = 4096,
    FADES = 8192,
    VARIES = 16384
  };
}

template <class T, int D> struct Particle {
  T x[D], v[D], rho, vol, p, pv2;

  FSI_INLINE explicit Particle(const Point<D> &a)
  {
    for (int d = 0; d < D; d++) {
      x[d] = a.x[d];
      v[d] = a.v[d];
    }
    rho = a.rho;
    vol = a.vol;
    p = a.p;
    pv2 = a.pv2;
  }
  FSI_INLINE Particle(const Point<D> *point, const int *j)
  {
    if constexpr (std::is_same_v<T, double>) {
      *this = Particle(point[*j]);
    } else {
      const Point<D> &a = point[j[0]], &b = point[j[1]], &c = point[j[2]], &d = point[j[3]];
      T one[4], two[4];
      T::columns(a.x, b.x, c.x, d.x, one);
      T::columns(a.x + 4, b.x + 4, c.x + 4, d.x + 4, two);
      x[0] = one[0];
      x[1] = one[1];
      if constexpr (D == 2) {
        v[0] = one[2];
        v[1] = one[3];
        rho = two[0];
        vol = two[1];
        p = two[2];
        pv2 = two[3];
      } else {
        x[2] = one[2];
        v[0] = one[3];
        v[1] = two[0];
        v[2] = two[1];
        rho = two[2];
        vol = two[3];
        T::columns(&a.p, &b.p, &c.p, &d.p, p, pv2);
      }
    }
  }
  FSI_INLINE void reflect(const Mirror &mirror)
  {
    for (int d = 0; d < D; d++) {
      x[d] = mirror.x[d] + mirror.sign[d] * x[d];
      v[d] = mirror.v[d] + mirror.sign[d] * v[d];
    }
  }
};

// Of a particle less its neighbor, or less the neighbor's image: places, and velocities as
// viscosity has them
template <bool IMAGE, class T, int D>
FSI_INLINE void places_apart(const Mirror &mirror, const T (&xi)[D], const T (&xj)[D], T (&x)[D])
{
  for (int d = 0; d < D; d++) x[d] = xi[d] - (IMAGE ? mirror.x[d] + mirror.sign[d] * xj[d] : xj[d]);
}
template <bool IMAGE, class T, int D>
FSI_INLINE void rubbing_apart(const Mirror &mirror, const T (&vi)[D], const T (&vj)[D], T (&v)[D])
{
  for (int d = 0; d < D; d++)
    v[d] = vi[d] - (IMAGE ? mirror.rubbing_v[d] + mirror.rubbing_sign[d] * vj[d] : vj[d]);
}

// How much more neighbors of this type count at i: in forces of pressure; in sums of W and along
// the face
FSI_INLINE double backfill_of(const FluidParticles &in, int i, int type_j)
{
  return in.ratio[type_j].thin ? in.thin->backfill[i] : 1.0;
}
FSI_INLINE double backfill_weight_of(const FluidParticles &in, int i, int type_j)
{
  return in.ratio[type_j].thin ? in.thin->backfill_weight[i] : 1.0;
}

// Kernel or gradient of neighbors that mirror walls cut
template <class T> FSI_INLINE T cut_off(const FluidParticles &in, const int *j, const T &w)
{
  return in.cut ? Lanes<T>::read(in.cut->part, j) * w : w;
}

// Kernel or gradient of a pair that a thin body hides in part
FSI_INLINE double as_visible(const FluidParticles &in, const int *j, double w)
{
  return in.visible.part[j - in.visible.first] * w;
}

// Sums of particle shifting that a row of neighbors adds to those of i
template <int D> constexpr int shift_sums(int flags)
{
  return (flags & Flag::SLOPES) ? Shift<D>::SLOPES : (flags & Flag::EDGES) ? Shift<D>::EDGES : D;
}
template <int D> constexpr int shift_row(int flags)
{
  return Shift<D>::row(!(flags & Flag::EDGES));
}

// Shifting's weights of a pair for i and for j, less the more they see of another spacing
template <int FLAGS, class T>
FSI_INLINE void weigh(const T &weight, const FluidParticles &in, int i, const int *j, T &of_i,
                      T &of_j)
{
  of_i = of_j = weight;
  if (!(FLAGS & Flag::FADES)) return;
  of_i = 1.0 + in.fade[i] * (weight - 1.0);
  of_j = 1.0 + Lanes<T>::read(in.fade, j) * (weight - 1.0);
}

// W, which shifting alone needs, and g = W'/r
template <int FLAGS, class K, class T>
FSI_INLINE void of_kernel(const K &kernel, const T &r, T &w, T &g)
{
  if constexpr (FLAGS & Flag::SHIFT)
    kernel.both(r, w, g);
  else
    g = kernel.gradient(r);
}

// The sums of particle shifting that a row adds to those of i and, if BOTH are shifted, of its
// neighbors, with their rates of density where there are all of the sums. Solids and walls count,
// but are not shifted.
template <class T, int D, bool BOTH, int FLAGS> class ShiftOfRow {
  static constexpr bool EDGES = FLAGS & Flag::EDGES, SLOPES = FLAGS & Flag::SLOPES,
                        FADES = FLAGS & Flag::FADES, IMAGES = FLAGS & Flag::IMAGES;
  static constexpr int N = shift_sums<D>(FLAGS), ROW = shift_row<D>(FLAGS);
  using L = Lanes<T>;
  const Mirror mirror;
  const double mirrors_flow;              // 1 where the flow goes on beyond a wall that slips
  double factors[ROW], own_factors[D];    // of what a pair adds to j, to have what i has of it
  T both[L::totals(N + 1)], of_i[N];

 public:
  static constexpr bool TAKES_RATES = (FLAGS & Flag::SHIFT) && N > D;
  FSI_INLINE explicit ShiftOfRow(const Mirror &mirror_in) :
      mirror(mirror_in), mirrors_flow(mirror_in.slips())
  {
    for (int k = 0; k < ROW; k++)
      factors[k] = k >= N                  ? 0.0
          : !Shift<D>::is_vector(k, EDGES) ? 1.0
          : IMAGES                         ? -mirror.sign[k % D]
                                           : -1.0;
    if (IMAGES && SLOPES) Shift<D>::signs_of_slopes(mirror.sign, factors);
    // of what fades each has its own sum
    for (int d = 0; d < D; d++) own_factors[d] = factors[d];
    for (int d = 0; FADES && d < D; d++) factors[d] = 0.0;
  }
  FSI_INLINE void open()
  {
    for (T &s : both) s = 0.0;
    for (T &s : of_i) s = 0.0;
  }
  // g: V_i V_j W'/r; v: difference of velocities
  FSI_INLINE void take(const T &weight, const FluidParticles &in, int i, const T &rsq, const T &g,
                       const T (&x)[D], const T *v, const T *rate_j, const int *j,
                       double (*const shift)[ROW])
  {
    T part[N + 1], back[D], weight_i, weight_j;
    weigh<FLAGS>(weight, in, i, j, weight_i, weight_j);
    for (int d = 0; d < D; d++) back[d] = IMAGES ? mirror.sign[d] * x[d] : x[d];
    Shift<D>::template of_pair<EDGES>(part, g, BOTH ? weight_j : weight_i, rsq, back);
    if constexpr (!BOTH) {
      for (int k = 0; k < N; k++) of_i[k] += part[k];
    } else {
      if constexpr (SLOPES && IMAGES) {
        T v_back[D];
        for (int d = 0; d < D; d++) v_back[d] = mirror.sign[d] * v[d];
        slopes_of_pair<D>(part + D, mirrors_flow * g, back, v_back);
      } else if constexpr (SLOPES)
        slopes_of_pair<D>(part + D, g, x, v);
      if constexpr (EDGES || SLOPES)
        part[N] = *rate_j;
      else
        part[N] = 0.0;
      if (FADES)
        for (int d = 0; d < D; d++) of_i[d] += g * weight_i * back[d];
      L::add_to_all(part, shift, j, both);
    }
  }
  FSI_INLINE void close(double *shift_i) const
  {
    if (BOTH) L::template add_totals<N + 1>(both, factors, shift_i);
    for (int k = 0; k < (BOTH ? FADES * D : N); k++)
      shift_i[k] += (k < D ? own_factors[k] : factors[k]) * L::sum(of_i[k]);
  }
};

// Diffusion acts within a fluid
template <bool UNLIKE>
FSI_INLINE DensityDiffusion diffusion_of(const FluidParticles &in, double delta, double h,
                                         int type_i, int type_j)
{
  const bool one = type_i == type_j || (UNLIKE && in.is_one_fluid(type_i, type_j));
  return DensityDiffusion(one ? delta : 0.0, h, in.state[type_i].c);
}

// Does a mirror wall cut off part of these neighbors' cells?
constexpr bool is_cut(int kind, int flags)
{
  return kind == WITH_SOLID_FULL || (kind == WITH_SOLID && (flags & Flag::UNEQUAL));
}

// A pair as its rates need it: W, which shifting alone needs, and g = W'/r
template <class T, int D> struct RatePair {
  T x[D], v[D], rsq, r, w, g;
};

// What is constant in a row of rates. backfill: by how much more thin neighbors count; back: the
// fluid's volume over the neighbor's; volume: of neighbors of another spacing
struct RateConstants {
  DensityDiffusion diffusion;
  double sharper, backfill, back, volume;
};
template <int KIND, int FLAGS>
FSI_INLINE RateConstants constants_of_rates(const FluidParticles &in, double delta, double h, int i,
                                            int type_i, int type_j)
{
  constexpr bool UNEQUAL = FLAGS & Flag::UNEQUAL, UNLIKE = KIND == WITH_FLUID && UNEQUAL;
  const double backfill = UNEQUAL ? backfill_of(in, i, type_j) : 1.0;
  return {diffusion_of<UNLIKE>(in, delta, h, type_i, type_j),
          UNEQUAL ? in.ratio[type_j].sharper : 0.0, backfill,
          UNLIKE ? 1.0 / in.ratio[type_j].volume : 1.0,
          UNEQUAL ? backfill * in.ratio[type_j].volume : 1.0};
}

// sum_j W_ij d part_j/dt over solids that come out of walls. To rho_i they add m_i of it, and to
// the energy of i m_i p_i/rho_i^2 of that, which no force on them does: it goes into the ledger.
// A loop of its own: with it the loop of all rows would cost 6 % more where there are none.
template <class T, class K, bool IMAGE>
FSI_INLINE void tally_coming_out(const Row &row, const Mirror &mirror, const K &kernel,
                                 const FluidParticles &in, const RateLaws &laws,
                                 const RateConstants &constant, PairSums *sums)
{
  constexpr int D = K::DIM;
  using L = Lanes<T>;
  if (!in.cut || !sums || !laws.pressure_over_density || !(in.newton || row.i < in.nlocal)) return;
  const auto *const point = reinterpret_cast<const Point<D> *>(in.points);
  const Point<D> &p = point[row.i];
  const Particle<T, D> pi(p);
  T sum = 0.0;
  for_neighbors<T, IMAGE>(row, [&](const int *j, const T &) FSI_INLINE_LAMBDA {
    Particle<T, D> pj(point, j);
    if (IMAGE) pj.reflect(mirror);
    T x[D];
    difference(pi.x, pj.x, x);
    // of a place left over, i itself, the rate is 0
    sum += kernel.sharper(root(product(x, x)), constant.sharper) * L::read(in.cut->rate, j);
  });
  sums->walls -=
      laws.pressure_over_density[row.i] * p.rho * constant.volume * p.vol * p.vol * L::sum(sum);
}

template <class T, class K, int KIND, int FLAGS, int D>
FSI_INLINE void relate(const K &kernel, const FluidParticles &in, const Particle<T, D> &pi,
                       const Particle<T, D> &pj, const int *j, const T &weight, RatePair<T, D> &m)
{
  difference(pi.x, pj.x, m.x);
  difference(pi.v, pj.v, m.v);
  m.rsq = product(m.x, m.x);
  m.r = root(m.rsq);
  of_kernel<FLAGS>(kernel, m.r, m.w, m.g);
  if (FLAGS & Flag::IMAGES) m.g = weight * m.g;
  if (is_cut(KIND, FLAGS)) m.g = cut_off(in, j, m.g);
  if constexpr (FLAGS & Flag::PARTLY) m.g = as_visible(in, j, m.g);
}

// v_ij.grad_i W_ij, and what of j comes out of a mirror wall; of neighbors of another spacing
// with their own kernel, which takes the place of g
template <class T, class K, int KIND, int FLAGS, int D>
FSI_INLINE T flow(const K &kernel, const FluidParticles &in, const RateConstants &constant,
                  const int *j, const T &weight, RatePair<T, D> &m)
{
  constexpr bool CUT = is_cut(KIND, FLAGS);
  if ((FLAGS & Flag::UNEQUAL) && KIND != WITH_FLUID) {
    m.g = kernel.sharper_gradient(m.r, constant.sharper);
    if (FLAGS & Flag::IMAGES) m.g = weight * m.g;
    if (CUT) m.g = cut_off(in, j, m.g);
  }
  T s = m.g * product(m.v, m.x);
  // of a place left over, i itself, it is 0
  if (CUT && in.cut) s += kernel.sharper(m.r, constant.sharper) * Lanes<T>::read(in.cut->rate, j);
  return s;
}

// What density diffusion adds to the rates of i and j; by: m p/rho^2 of it
template <class T, int FLAGS, int D>
FSI_INLINE void diffuse(const FluidParticles &in, const RateLaws &laws,
                        const RateConstants &constant, int i, const Particle<T, D> &pi,
                        const Particle<T, D> &pj, const int *j, const T &g, T &flux, T &rate_j,
                        T &by)
{
  const T k = lesser(pi.p, pj.p) * constant.diffusion(pi.rho, pj.rho, pi.pv2 - pj.pv2, g);
  flux += k * pj.vol;
  rate_j -= k * pi.vol;
  constexpr bool SINGLE = std::is_same_v<T, double>;    // these loops have sums that none asks for
  if ((FLAGS & Flag::SUMS) && (!SINGLE || laws.pressure_over_density))
    by -= share_of<T>(i, j, in.nlocal, in.newton) * k * pi.vol * pj.vol *
        (T(laws.pressure_over_density[i]) - Lanes<T>::read(laws.pressure_over_density, j));
}

// Pressure p_i V_i^2 + p_j V_j^2 that fluid particle i and its neighbor share (paper eq. 14);
// x_j: of the neighbor itself, not of its image; back: the fluid's volume over the neighbor's;
// own: is it the fluid's own, whatever the neighbor has?
template <class T, int KIND, int D>
FSI_INLINE T shared_pressure(const Particle<T, D> &pi, const Particle<T, D> &pj, const T *x_j,
                             const double *extrapolate, double floor, double back, bool own)
{
  const T both = pi.pv2 + back * pj.pv2;
  if (KIND == WITH_SOLID_FULL || !own) return both;
  // the solid is a moving wall to the fluid, under the fluid's pressure, and takes the reaction
  T p = pi.p;
  for (int d = 0; d < D; d++) p += pi.rho * extrapolate[d] * (x_j[d] - pi.x[d]);
  return pi.pv2 + greater(p, T(floor)) * (back * pj.vol) * pj.vol;
}

// Viscosity between two fluids: the harmonic mean, with which the stress is the same on both
// sides of their interface, as the flux of heat in Cleary and Monaghan, J. Comput. Phys. 148
// (1999) 227
FSI_INLINE double between(double a, double b)
{
  return a == b ? a : 2.0 * a * b / (a + b);
}

// the sum of those of i and j; of_i: that of a row, whose i has half of it if they vary
template <int KIND, int FLAGS, class T>
FSI_INLINE auto both_viscosities(const ForceLaws &laws, double of_i, const int *j)
{
  if constexpr (KIND == WITH_FLUID && (FLAGS & Flag::VARIES)) {
    const T of_j = Lanes<T>::read(laws.viscosity, j);
    // no fluid with laminar viscosity has none of it where it varies
    return 2.0 * of_i * of_j / greater(0.5 * of_i + of_j, T(1.0e-300));
  } else
    return of_i;
}

// What is constant in a row of forces.
struct RowConstants {
  double c, bulk, floor;     // speed of sound of viscosity, modulus of the guard, lowest pressure
  double rubs, visc;         // 0 where a wall slips, else 1; sum of both viscosities
  double at_rest;            // volume of i at rest, over the density of j at rest (of solids: 1)
  double volume, sharper;    // of neighbors of another spacing
  bool thin;
  double changed[3];        // of the velocity of i, since that beyond faces was found
  double extrapolate[3];    // solids and thin walls: gravity, if pressures beyond them are
                            // hydrostatic
};
template <int D, int KIND, int FLAGS>
FSI_INLINE RowConstants constants_of_row(const FluidParticles &in, const ForceLaws &laws, int i,
                                         int type_i, int type_j)
{
  const State &fluid = in.state[type_i], &other = in.state[type_j];
  RowConstants r;
  r.c = KIND == WITH_FLUID                     ? 0.5 * (fluid.c + other.c)
      : KIND == WITH_WALL || fluid.c < other.c ? fluid.c
                                               : other.c;
  r.bulk = fluid.rho0 * fluid.csq;
  r.floor = fluid.floor;
  // beyond a wall or solid with no slip there is fluid, where it slips it does not rub
  const bool slips = KIND == WITH_FLUID ? false
      : KIND == WITH_WALL               ? !other.noslip
                                        : laws.solids_slip;
  const auto &own_point = reinterpret_cast<const Point<D> *>(in.points)[i];
  r.at_rest =
      own_point.rho * own_point.vol * fluid.inv_rho0 * (with_solid(KIND) ? 1.0 : other.inv_rho0);
  r.rubs = KIND == WITH_WALL && slips ? 0.0 : 1.0;
  const double own = laws.viscosity ? laws.viscosity[i] : fluid.viscosity;
  r.visc = !laws.laminar || slips
      ? 0.0
      : 2.0 * (KIND == WITH_FLUID && !laws.viscosity ? between(own, other.viscosity) : own);
  if (FLAGS & Flag::UNEQUAL) {
    r.volume = in.ratio[type_j].volume;
    r.sharper = in.ratio[type_j].sharper;
    r.visc *= backfill_weight_of(in, i, type_j);
  }
  r.thin = (FLAGS & Flag::UNEQUAL) && in.ratio[type_j].thin;
  for (int d = 0; d < D; d++) r.changed[d] = laws.before ? own_point.v[d] - laws.before[i][d] : 0.0;
  if (KIND == WITH_SOLID || r.thin) {
    const auto *const g = KIND == WITH_WALL ? laws.gravity : laws.extrapolate;
    const double along = r.thin ? in.thin->backfill_weight[i] / in.thin->backfill[i] : 1.0;
    for (int d = 0; d < D; d++) r.extrapolate[d] = g ? along * g[type_i][d] : 0.0;
  }
  return r;
}

// Volumes of fluids and walls in laminar viscosity are those at rest, m/rho0: shifting lets
// density drift from the number of particles, and m/rho would make viscosity too small twice
// over. Solids are as large as they are.
//
// Adds laminar viscosity to the force on i and, of images, on j; what it takes from their energy,
// times 2 for images, which each pair meets from both sides.
template <class T, int KIND, int FLAGS, int D>
FSI_INLINE T rub(const LaminarViscosity<D> &viscous, const ForceLaws &laws, const Mirror &mirror,
                 const Particle<T, D> &pi, const Particle<T, D> &pj, const T (&velocity_of_j)[D],
                 const int *j, const RowConstants &constant, const T &g, const T (&x)[D],
                 const T (&v)[D], T (&force)[D], T (&on_j)[D])
{
  using L = Lanes<T>;
  const auto visc = both_viscosities<KIND, FLAGS, T>(laws, constant.visc, j);
  // what fluid would have in the place of j, of a wall or solid; before a plane of symmetry i is
  // on both sides
  const auto beyond_face = [&](int d) FSI_INLINE_LAMBDA {
    if (constant.thin) return 2.0 * velocity_of_j[d] - mirror.own_velocity(d, pi.v[d]);
    return L::make([&](int k) {
             return laws.wall_velocity[j[k]][d];
           }) -
        mirror.slip_sign[d] * constant.changed[d];
  };
  const T vv = constant.at_rest * (with_solid(KIND) ? pj.vol : pj.rho * pj.vol);
  T rubbing[D], loss = 0.0;
  for (T &r : rubbing) r = 0.0;
  if (FLAGS & Flag::IMAGES) {
    // of both, each relative to the other's image, which a no-slip wall turns around
    const auto beyond = [&](int d, const T &u) FSI_INLINE_LAMBDA {
      return mirror.rubbing_v[d] + mirror.rubbing_sign[d] * u;
    };
    T w[D], seen[D], back[D], of_j[D];
    for (int d = 0; d < D; d++) {
      const T vj = KIND == WITH_FLUID ? velocity_of_j[d] : beyond_face(d);
      w[d] = pi.v[d] - beyond(d, vj);
      back[d] = vj - beyond(d, pi.v[d]);
      seen[d] = -mirror.sign[d] * x[d];
      of_j[d] = 0.0;
    }
    loss = viscous(g, visc, vv, x, w, rubbing) + viscous(g, visc, vv, seen, back, of_j);
    if ((FLAGS & Flag::SUMS) && KIND != WITH_FLUID) {
      // the power is that of the solid's own velocity
      loss = 0.0;
      for (int d = 0; d < D; d++)
        loss -= rubbing[d] * (pi.v[d] - beyond(d, velocity_of_j[d])) +
            of_j[d] * (velocity_of_j[d] - beyond(d, pi.v[d]));
    }
    for (int d = 0; d < D; d++) on_j[d] += of_j[d];
  } else if (KIND != WITH_FLUID) {
    // fluid beyond the wall or inside the solid, with the velocity extrapolated
    T w[D];
    for (int d = 0; d < D; d++) w[d] = pi.v[d] - beyond_face(d);
    viscous(g, visc, vv, x, w, rubbing);
    if (FLAGS & Flag::SUMS) loss = -product(rubbing, v);
  } else
    loss = viscous(g, visc, vv, x, v, rubbing);
  for (int d = 0; d < D; d++) force[d] += rubbing[d];
  return loss;
}

// Adds what coupling and friction take, as forces on i and on the neighbors j, of images as their
// wall turns them, to rows
template <class T, int D> struct Taken {
  T of_i[2 * D];
  double (*const rows)[row_of_points(D)];
  const Mirror &mirror;
  FSI_INLINE Taken(double *rows_in, const Mirror &mirror_in) :
      rows(reinterpret_cast<double (*)[row_of_points(D)]>(rows_in)), mirror(mirror_in)
  {
    for (T &s : of_i) s = 0.0;
  }
  FSI_INLINE void add(const T (&coupling)[D], const T (&friction)[D], const T (&friction_j)[D],
                      const int *j)
  {
    if (!rows) return;
    T of_j[2 * D];
    for (int d = 0; d < D; d++) {
      of_i[d] += coupling[d];
      of_i[D + d] += friction[d];
      of_j[d] = -mirror.sign[d] * coupling[d];
      of_j[D + d] = friction_j[d];
    }
    Lanes<T>::add_rows(of_j, rows, j);
  }
  FSI_INLINE void close(int i) const
  {
    for (int d = 0; rows && d < 2 * D; d++) rows[i][d] += Lanes<T>::sum(of_i[d]);
  }
};

// A pair as the terms of its force need it. weight: 0 in places that are left over; g = W'/r;
// pushing: that of pressures; share: the part of its powers that this rank counts.
template <class T, int D> struct Between {
  T x[D], v[D], rsq, vdotx, weight, g, pushing, share;
};

template <class T, class K, int KIND, int FLAGS, int D>
FSI_INLINE void relate(const K &kernel, const FluidParticles &in, const RowConstants &constant,
                       const int i, const Particle<T, D> &pi, const Particle<T, D> &pj,
                       const int *j, const T &weight, Between<T, D> &m)
{
  constexpr bool CUT = is_cut(KIND, FLAGS), UNLIKE = KIND == WITH_FLUID;
  difference(pi.x, pj.x, m.x);
  difference(pi.v, pj.v, m.v);
  m.weight = weight;
  m.rsq = product(m.x, m.x);
  m.vdotx = product(m.v, m.x);
  m.g = kernel.gradient(root(m.rsq));
  if (FLAGS & Flag::IMAGES) m.g = weight * m.g;
  if (CUT) m.g = cut_off(in, j, m.g);
  if constexpr (FLAGS & Flag::PARTLY) m.g = as_visible(in, j, m.g);
  m.pushing = m.g;
  if ((FLAGS & Flag::UNEQUAL) && !UNLIKE) {
    m.pushing = kernel.sharper_gradient(root(m.rsq), constant.sharper);
    if (FLAGS & Flag::IMAGES) m.pushing = weight * m.pushing;
    if (CUT) m.pushing = cut_off(in, j, m.pushing);
  }
  m.share = (FLAGS & (Flag::SUMS | Flag::IMAGES)) ? share_of<T>(i, j, in.nlocal, in.newton)
                                                  : T(1.0);
}

// The force of pressure p and of artificial viscosity on i. What they take, as forces: coupling,
// beyond the compression of the fluid and, in density mode summation, of the solid, and friction;
// coupled: the power of coupling.
template <class T, int KIND, int FLAGS, int D>
FSI_INLINE void push(const ArtificialViscosity &artificial, const ForceLaws &laws,
                     const RowConstants &constant, const Particle<T, D> &pi,
                     const Particle<T, D> &pj, T p, const Between<T, D> &m, T (&force)[D],
                     T (&coupling)[D], T (&friction)[D], T &coupled, Powers<T> &by)
{
  T viscous_push = 0.0, rubbing = 0.0;
  coupled = p - pi.pv2 - (KIND == WITH_WALL ? 0.0 : laws.stored) * pj.pv2;
  if (FLAGS & Flag::ARTIFICIAL) {
    T q = artificial(m.vdotx, m.rsq, 0.5 * (pi.rho + pj.rho), constant.c, pi.vol * pj.vol);
    if (KIND == WITH_WALL) q = constant.rubs * q;
    if (FLAGS & Flag::UNEQUAL)
      viscous_push = q * m.g;
    else
      p += q;
    if (FLAGS & Flag::SUMS) by.artificial += m.share * q * m.g * m.vdotx;
    rubbing = q * m.g;
  }
  p = (FLAGS & Flag::UNEQUAL) ? -(p * m.pushing + viscous_push) : -p * m.g;
  for (int d = 0; d < D; d++) {
    coupling[d] = KIND == WITH_FLUID ? T(0.0) : coupled * m.pushing * m.x[d];
    friction[d] = rubbing * m.x[d];
  }
  coupled = coupled * m.pushing * m.vdotx;
  for (int d = 0; d < D; d++) force[d] = p * m.x[d];
}

// gravity along the axes of hydrostatic walls; whether there is any
template <int D>
FSI_INLINE bool is_below(const ForceLaws &laws, const Mirror &mirror, int type, double (&down)[D])
{
  bool any = false;
  for (int d = 0; d < D; d++) {
    down[d] = laws.gravity ? mirror.deeper[d] * laws.gravity[type][d] : 0.0;
    any = any || down[d] != 0.0;
  }
  return any;
}

// Images below a hydrostatic wall have the pressure of fluid at rest where they are, the mean of
// both of a pair. What that takes is the wall's.
template <class T, int FLAGS, int D>
FSI_INLINE T pressure_below(const double (&down)[D], const Particle<T, D> &pi,
                            const Particle<T, D> &pj, const Between<T, D> &m, Powers<T> &by)
{
  T head = 0.0;
  for (int d = 0; d < D; d++) head -= down[d] * m.x[d];
  const T p = 0.5 * (pi.rho + pj.rho) * head * pi.vol * pj.vol;
  if (FLAGS & Flag::SUMS) by.walls += m.share * p * m.g * m.vdotx;
  return p;
}

// The guard keeps out what has no pressure of its own.
template <class T, int KIND, int FLAGS, int D>
FSI_INLINE void keep_out(const Contact &guard, const FluidParticles &in, double bulk, const int *j,
                         const Between<T, D> &m, T (&force)[D], Powers<T> &by)
{
  constexpr bool CUT = is_cut(KIND, FLAGS);
  T k = guard(m.rsq, bulk, bulk);
  if (FLAGS & Flag::IMAGES) k = m.weight * k;
  if (CUT) k = cut_off(in, j, k);
  for (int d = 0; d < D; d++) force[d] += k * m.x[d];
  if (FLAGS & Flag::SUMS) {
    T stored = m.weight * guard.stored(m.rsq, bulk);
    if (CUT) stored = cut_off(in, j, stored);
    by.guard += m.share * stored;
  }
}

// Laminar viscosity in the forces, in friction and in the powers.
template <class T, int KIND, int FLAGS, int D>
FSI_INLINE void slow(const LaminarViscosity<D> &viscous, const ForceLaws &laws,
                     const Mirror &mirror, const Particle<T, D> &pi, const Particle<T, D> &pj,
                     const T (&velocity_of_j)[D], const int *j, const RowConstants &constant,
                     const Between<T, D> &m, T (&force)[D], T (&on_j)[D], T (&friction)[D],
                     T (&friction_j)[D], Powers<T> &by)
{
  // walls and solids have another velocity than i itself in places that are left over
  const T there = KIND == WITH_FLUID || (FLAGS & Flag::IMAGES) ? m.g : m.weight * m.g;
  T before[D], before_j[D];
  for (int d = 0; d < D; d++) {
    before[d] = force[d];
    before_j[d] = on_j[d];
  }
  const T loss = rub<T, KIND, FLAGS>(viscous, laws, mirror, pi, pj, velocity_of_j, j, constant,
                                     there, m.x, m.v, force, on_j);
  for (int d = 0; d < D; d++) {
    friction[d] += before[d] - force[d];
    friction_j[d] = (FLAGS & Flag::IMAGES) ? friction_j[d] + before_j[d] - on_j[d] : -friction[d];
  }
  if (FLAGS & Flag::SUMS)
    by.laminar += (FLAGS & Flag::IMAGES) ? 0.5 * m.share * loss : m.share * loss;
}

// Of couple full, by which the source paper lets a fluid and a solid share one equation of motion
// (eq. 14): the mean of both pressures, and the solid's stress; kept to compare with. Adds the
// stress of solid j to the force on fluid i and gives its power; it is that of the particle, not of
// its image, so look from the solid
template <bool IMAGE, int D>
FSI_INLINE double add_stress(const double *stress, const Mirror &mirror, double v2g,
                             const double (&x)[D], const double (&v)[D], double (&force)[D])
{
  double seen[D], shear[D] = {}, power = 0.0;
  for (int d = 0; d < D; d++) seen[d] = (IMAGE ? mirror.sign[d] : 1.0) * x[d];
  dot<D>(Sym<D>::load(stress), seen, shear);
  for (int d = 0; d < D; d++) {
    const double s = (IMAGE ? mirror.sign[d] : 1.0) * shear[d] * v2g;
    force[d] += s;
    power += s * v[d];
  }
  return power;
}

// What keeps fluid and bodies apart beyond pressure: the guard, and of couple full the stress of
// the solid
template <class T, int KIND, int FLAGS, int D>
FSI_INLINE void hold_off(const FluidParticles &in, const ForceLaws &laws, const Mirror &mirror,
                         int type_j, double bulk, const int *j, const T &vol_j,
                         const Between<T, D> &m, T (&force)[D], T &coupled, Powers<T> &by)
{
  if (KIND == WITH_WALL || KIND == WITH_SOLID)
    keep_out<T, KIND, FLAGS>(laws.guard[type_j], in, bulk, j, m, force, by);
  if constexpr (KIND == WITH_SOLID_FULL)
    if (laws.stress)
      coupled -= add_stress<(FLAGS & Flag::IMAGES) != 0>(laws.stress[*j], mirror,
                                                         vol_j * vol_j * m.g, m.x, m.v, force);
}

// The force on j: the reaction, of an image turned as the wall turns it; laminar viscosity, which
// is another one on it
template <class T, int KIND, int FLAGS, int D>
FSI_INLINE void react(const LaminarViscosity<D> &viscous, const ForceLaws &laws,
                      const Mirror &mirror, const Particle<T, D> &pi, const Particle<T, D> &pj,
                      const T (&velocity_of_j)[D], const int *j, const RowConstants &constant,
                      const Between<T, D> &m, T (&force)[D], T (&on_j)[D], T (&friction)[D],
                      T (&friction_j)[D], Powers<T> &by)
{
  for (int d = 0; d < D; d++) {
    on_j[d] = -mirror.sign[d] * force[d];
    friction_j[d] = -mirror.sign[d] * friction[d];
  }
  if (FLAGS & Flag::LAMINAR)
    slow<T, KIND, FLAGS>(viscous, laws, mirror, pi, pj, velocity_of_j, j, constant, m, force, on_j,
                         friction, friction_j, by);
  if (!(FLAGS & Flag::IMAGES))
    for (int d = 0; d < D; d++) on_j[d] = -force[d];
}

// What a pair adds to powers and virial: coupled is the power of coupling; of walls of particles,
// which are not in the sum of energies, what they are given.
template <class T, int KIND, int FLAGS, int D>
FSI_INLINE void account(const Between<T, D> &m, const T (&force)[D], const T (&v_j)[D],
                        const T &coupled, Powers<T> &by)
{
  if (KIND != WITH_FLUID) by.coupling += m.share * coupled;
  if (KIND == WITH_WALL) by.walls -= m.share * product(force, v_j);
  if (FLAGS & Flag::IMAGES) return;
  const auto stress = [&](int a, int c) FSI_INLINE_LAMBDA {
    return m.share * m.x[a] * force[c];
  };
  add_virial<D>(stress, by.virial);
}

}    // namespace LAMMPS_NS::FSI

#endif
