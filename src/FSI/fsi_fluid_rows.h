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

// The loops of fsi_fluid_loops.h, row by row, for a kernel: one text for numbers one by one and
// several side by side (T: double or Pack).
//
// No branch on distance: W and its gradient vanish beyond the support. The last vector of a row is
// padded with i: x_ij = 0 cancels gradient terms; W(0) and images get weight 0. Constants come by
// value: stores to the sums could alias what is behind a reference.

#ifndef LMP_FSI_FLUID_ROWS_H
#define LMP_FSI_FLUID_ROWS_H

#include "fsi_contact.h"
#include "fsi_couple_paper.h"
#include "fsi_density_diffusion.h"
#include "fsi_fluid_loops.h"
#include "fsi_kernel.h"
#include "fsi_rows.h"
#include "fsi_shift.h"
#include "fsi_tensor.h"
#include "fsi_viscosity.h"

#include <type_traits>

namespace LAMMPS_NS {
namespace FSI {

  // what a loop is compiled for: effects; sums of powers; neighbors that are images; results for
  // neighbors, too; neighbors of another spacing; shifting, with what tells surfaces or what it
  // changes of velocities; pairs that thin bodies hide in part; shifting beside fluid of another
  // spacing
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
      FADES = 8192
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
    return in.visible->part[j - in.visible->first] * w;
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
    double factors[ROW], own_factors[D];    // of what a pair adds to j, to have what i has of it
    T both[L::totals(N + 1)], of_i[N];

   public:
    static constexpr bool TAKES_RATES = (FLAGS & Flag::SHIFT) && N > D;
    FSI_INLINE explicit ShiftOfRow(const Mirror &mirror_in) : mirror(mirror_in)
    {
      for (int k = 0; k < ROW; k++)
        factors[k] = k >= N                  ? 0.0
            : !Shift<D>::is_vector(k, EDGES) ? 1.0
            : IMAGES                         ? -mirror.sign[k % D]
                                             : -1.0;
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
        if constexpr (SLOPES) Shift<D>::slopes_of_pair(part, g, x, v);
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

  // sum_j W_ij d part_j/dt over solids that come out of walls. To rho_i they add m_i of it, and to
  // the energy of i m_i p_i/rho_i^2 of that, which no force on them does. A loop of its own: with
  // it the loop of all rows would cost 6 % more where there are none.
  template <class T, class K, bool IMAGE>
  FSI_INLINE double coming_out(const Row &row, const Mirror &mirror, const K &kernel,
                               const FluidParticles &in, double sharper)
  {
    constexpr int D = K::DIM;
    using L = Lanes<T>;
    const auto *const point = reinterpret_cast<const Point<D> *>(in.points);
    const Particle<T, D> pi(point[row.i]);
    T sum = 0.0;
    for_neighbors<T, IMAGE>(row, [&](const int *j, const T &) FSI_INLINE_LAMBDA {
      Particle<T, D> pj(point, j);
      if (IMAGE) pj.reflect(mirror);
      T x[D];
      difference(pi.x, pj.x, x);
      // of a place left over, i itself, the rate is 0
      sum += kernel.sharper(root(product(x, x)), sharper) * L::read(in.cut->rate, j);
    });
    return L::sum(sum);
  }

  // Diffusion acts within a fluid
  template <bool UNLIKE>
  FSI_INLINE DensityDiffusion diffusion_of(const FluidParticles &in, double delta, double h,
                                           int type_i, int type_j)
  {
    const bool one = type_i == type_j || (UNLIKE && in.is_one_fluid(type_i, type_j));
    return DensityDiffusion(one ? delta : 0.0, h, in.state[type_i].c);
  }

  // d rho_i/dt = m_i sum_j v_ij.grad_i W_ij, the rate of m_i psi_i (paper eqs. 8 and 12), which
  // makes the work of the pair force -(p_i V_i^2 + p_j V_j^2) grad_i W_ij that of the pressures;
  // and the sums of particle shifting
  template <class T, class K, int KIND, int FLAGS>
  FSI_INLINE void rate_rows(const Row *const rows, const int nrows, const Mirror mirror,
                            const K kernel, const FluidParticles in, const RateLaws laws,
                            double *const rate, double (*const shift)[shift_row<K::DIM>(FLAGS)],
                            PairSums *const sums, std::vector<Row> *const near)
  {
    constexpr int D = K::DIM;
    constexpr bool IMAGE = FLAGS & Flag::IMAGES,
                   CUT = KIND == WITH_SOLID && (FLAGS & Flag::UNEQUAL),
                   UNLIKE = KIND == WITH_FLUID && (FLAGS & Flag::UNEQUAL);
    using L = Lanes<T>;
    const auto *const point = reinterpret_cast<const Point<D> *>(in.points);
    const Shift<D> law(laws.wdx);
    T reachsq = laws.reach * laws.reach, by_diffusion = 0.0;
    Sieve<T, !IMAGE> sieve;
    ShiftOfRow<T, D, KIND == WITH_FLUID, FLAGS> shift_of(mirror);
    for (int n = 0; n < nrows; n++) {
      const Row row = rows[n];
      if (row.n == 0) continue;
      const int i = row.i, type_i = in.type[i], type_j = in.type[row.j[0]];
      const Particle<T, D> pi(point[i]);
      const auto diffusion = diffusion_of<UNLIKE>(in, laws.delta, kernel.h, type_i, type_j);
      const double sharper = (FLAGS & Flag::UNEQUAL) ? in.ratio[type_j].sharper : 0.0,
                   backfill = (FLAGS & Flag::UNEQUAL) ? backfill_of(in, i, type_j) : 1.0,
                   back = UNLIKE ? 1.0 / in.ratio[type_j].volume : 1.0;
      T sum = 0.0, flux = 0.0;
      if (FLAGS & Flag::SHIFT) shift_of.open();
      if (near) sieve.open(row);
      const auto pair = [&](const int *j, const T &weight) FSI_INLINE_LAMBDA -> T {
        Particle<T, D> pj(point, j);
        if (IMAGE) pj.reflect(mirror);
        T x[D], v[D];
        difference(pi.x, pj.x, x);
        difference(pi.v, pj.v, v);
        const T rsq = product(x, x), r = root(rsq);
        T w, g;
        of_kernel<FLAGS>(kernel, r, w, g);
        if (IMAGE) g = weight * g;
        if (CUT) g = cut_off(in, j, g);
        if constexpr (FLAGS & Flag::PARTLY) g = as_visible(in, j, g);
        const auto shift_pair = [&](const T &along, const T *rate_j) FSI_INLINE_LAMBDA {
          const T vol_j = (FLAGS & Flag::UNEQUAL) ? backfill * pj.vol : pj.vol;
          shift_of.take(law.weight(w), in, i, rsq, pi.vol * vol_j * along, x, v, rate_j, j, shift);
        };
        if constexpr ((FLAGS & Flag::SHIFT) && KIND != WITH_FLUID) shift_pair(g, nullptr);
        if ((FLAGS & Flag::UNEQUAL) && !UNLIKE) {
          g = kernel.sharper_gradient(r, sharper);
          if (IMAGE) g = weight * g;
          if (CUT) g = cut_off(in, j, g);
        }
        T s = g * product(v, x);
        // of a place left over, i itself, it is 0
        if (CUT && in.cut) s += kernel.sharper(r, sharper) * L::read(in.cut->rate, j);
        sum += s;
        if (KIND != WITH_FLUID) return rsq;    // density of a solid or a wall has other rates
        T rate_j = UNLIKE ? back * (pj.rho * pj.vol * s) : pj.rho * pj.vol * s;
        if (FLAGS & Flag::DIFFUSION) {
          const T k = lesser(pi.p, pj.p) * diffusion(pi.rho, pj.rho, pi.pv2 - pj.pv2, g);
          flux += k * pj.vol;
          rate_j -= k * pi.vol;
          if (FLAGS & Flag::SUMS)    // m p/rho^2 of what diffusion adds to rho
            by_diffusion -= share_of<T>(i, j, in.nlocal, in.newton) * k * pi.vol * pj.vol *
                (T(laws.pressure_over_density[i]) - L::read(laws.pressure_over_density, j));
        }
        if constexpr (FLAGS & Flag::SHIFT) shift_pair(g, &rate_j);
        if (!shift_of.TAKES_RATES) L::add(rate_j, rate, j);
        return rsq;
      };
      for_neighbors<T, IMAGE>(row, [&](const int *j, const T &weight) FSI_INLINE_LAMBDA {
        const T rsq = pair(j, weight);
        if (near) sieve.take(reachsq < rsq, j);
      });
      if (near) near->push_back(sieve.close(row));    // of images the others are gone
      const double volume = (FLAGS & Flag::UNEQUAL) ? backfill * in.ratio[type_j].volume : 1.0;
      rate[i] += point[i].rho * volume * point[i].vol * L::sum(sum) + L::sum(flux);
      if constexpr (CUT)
        if (in.cut && sums && (in.newton || i < in.nlocal))
          sums->walls -= laws.pressure_over_density[i] * point[i].rho * volume * point[i].vol *
              point[i].vol *
              coming_out<T, K, IMAGE>(near ? near->back() : row, mirror, kernel, in, sharper);
      if constexpr (FLAGS & Flag::SHIFT) shift_of.close(shift[i]);
    }
    if (FLAGS & Flag::SUMS) sums->diffusion += L::sum(by_diffusion);
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

  // What is constant in a row of forces.
  struct RowConstants {
    double c, bulk, floor;     // speed of sound of viscosity, modulus of the guard, lowest pressure
    double rubs, visc;         // 0 where a wall slips, else 1; sum of both viscosities
    double volume, sharper;    // of neighbors of another spacing
    bool thin;
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
    r.rubs = KIND == WITH_WALL && slips ? 0.0 : 1.0;
    r.visc = !laws.laminar || slips
        ? 0.0
        : 2.0 * (KIND == WITH_FLUID ? between(fluid.viscosity, other.viscosity) : fluid.viscosity);
    if (FLAGS & Flag::UNEQUAL) {
      r.volume = in.ratio[type_j].volume;
      r.sharper = in.ratio[type_j].sharper;
      r.visc *= backfill_weight_of(in, i, type_j);
    }
    r.thin = (FLAGS & Flag::UNEQUAL) && in.ratio[type_j].thin;
    if (KIND == WITH_SOLID || r.thin) {
      const auto *const g = KIND == WITH_WALL ? laws.gravity : laws.extrapolate;
      const double along = r.thin ? in.thin->backfill_weight[i] / in.thin->backfill[i] : 1.0;
      for (int d = 0; d < D; d++) r.extrapolate[d] = g ? along * g[type_i][d] : 0.0;
    }
    return r;
  }

  // Sums of a loop over rows: powers, virial.
  template <class T> struct Powers {
    T artificial = 0.0, laminar = 0.0, coupling = 0.0, walls = 0.0, guard = 0.0, virial[6];
    FSI_INLINE Powers()
    {
      for (T &w : virial) w = 0.0;
    }
    FSI_INLINE void add_to(PairSums *sums) const
    {
      using L = Lanes<T>;
      sums->artificial += L::sum(artificial);
      sums->laminar += L::sum(laminar);
      sums->coupling += L::sum(coupling);
      sums->walls += L::sum(walls);
      sums->guard += L::sum(guard);
      for (int k = 0; k < 6; k++) sums->virial[k] += L::sum(virial[k]);
    }
  };

  // Adds laminar viscosity to the force on i and, of images, on j; what it takes from their energy,
  // times 2 for images, which each pair meets from both sides.
  template <class T, int KIND, int FLAGS, int D>
  FSI_INLINE T rub(const LaminarViscosity<D> &viscous, const ForceLaws &laws, const Mirror &mirror,
                   const Particle<T, D> &pi, const Particle<T, D> &pj, const T (&velocity_of_j)[D],
                   const int *j, const RowConstants &constant, const T &g, const T (&x)[D],
                   const T (&v)[D], T (&force)[D], T (&on_j)[D])
  {
    using L = Lanes<T>;
    const double visc = constant.visc;
    // what fluid would have in the place of j, of a wall or solid
    const auto beyond_face = [&](int d) FSI_INLINE_LAMBDA {
      return constant.thin ? 2.0 * velocity_of_j[d] - pi.v[d] : L::make([&](int k) {
        return laws.wall_velocity[j[k]][d];
      });
    };
    const T vv = pi.vol * pj.vol;
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

  // Adds what coupling and friction take, as forces on the neighbors j and on i, to rows
  template <class T, int D> struct Taken {
    T of_i[2 * D];
    double (*const rows)[row_of_points(D)];
    FSI_INLINE explicit Taken(double *rows_in) :
        rows(reinterpret_cast<double (*)[row_of_points(D)]>(rows_in))
    {
      for (T &s : of_i) s = 0.0;
    }
    FSI_INLINE void add(const T (&coupling)[D], const T (&friction)[D], const int *j)
    {
      if (!rows) return;
      T of_j[2 * D];
      for (int d = 0; d < D; d++) {
        of_i[d] += coupling[d];
        of_i[D + d] += friction[d];
        of_j[d] = -coupling[d];
        of_j[D + d] = -friction[d];
      }
      Lanes<T>::add_rows(of_j, rows, j);
    }
    FSI_INLINE void close(int i) const
    {
      for (int d = 0; rows && d < 2 * D; d++) rows[i][d] += Lanes<T>::sum(of_i[d]);
    }
  };

  // Does a mirror wall cut off part of these neighbors' cells?
  constexpr bool is_cut(int kind, int flags)
  {
    return kind == WITH_SOLID_FULL || (kind == WITH_SOLID && (flags & Flag::UNEQUAL));
  }

  // A pair as its terms need it. weight: 0 in places that are left over; g = W'/r; pushing: that of
  // pressures; share: the part of its powers that this rank counts.
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
  FSI_INLINE void keep_out(const Contact &guard, const FluidParticles &in, double bulk,
                           const int *j, const Between<T, D> &m, T (&force)[D], Powers<T> &by)
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
                       Powers<T> &by)
  {
    // walls and solids have another velocity than i itself in places that are left over
    const T there = KIND == WITH_FLUID || (FLAGS & Flag::IMAGES) ? m.g : m.weight * m.g;
    if (FLAGS & Flag::SUMS)
      for (int d = 0; d < D; d++) friction[d] += force[d];
    const T loss = rub<T, KIND, FLAGS>(viscous, laws, mirror, pi, pj, velocity_of_j, j, constant,
                                       there, m.x, m.v, force, on_j);
    if (FLAGS & Flag::SUMS)
      for (int d = 0; d < D; d++) friction[d] -= force[d];
    if (FLAGS & Flag::SUMS)
      by.laminar += (FLAGS & Flag::IMAGES) ? 0.5 * m.share * loss : m.share * loss;
  }

  // F_ij = -(p_i V_i^2 + p_j V_j^2 + Q_ij) grad_i W_ij + laminar viscosity (paper eq. 14)
  template <class T, class K, int KIND, int FLAGS>
  FSI_INLINE void force_rows(const Row *const rows, const int nrows, const Mirror mirror,
                             const K kernel, const FluidParticles in, const ForceLaws laws,
                             double (*const f)[row_of_forces(K::DIM)], double *const total,
                             PairSums *const sums)
  {
    constexpr int D = K::DIM;
    using L = Lanes<T>;
    const auto *const point = reinterpret_cast<const Point<D> *>(in.points);
    const ArtificialViscosity artificial(laws.alpha, laws.beta, kernel.h);
    const LaminarViscosity<D> viscous(
        (FLAGS & Flag::CENTRAL) ? laws.central_length_sq * (kernel.h * kernel.h) : 0.0);
    Powers<T> by;
    T on_all[D];
    for (T &w : on_all) w = 0.0;
    for (int n = 0; n < nrows; n++) {
      const Row row = rows[n];
      if (row.n == 0) continue;
      const int i = row.i, type_j = in.type[row.j[0]];
      const RowConstants constant =
          constants_of_row<D, KIND, FLAGS>(in, laws, i, in.type[i], type_j);
      Particle<T, D> pi(point[i]);
      // neighbors of another volume count by it: omega p_i V_i^2 + p_j V_j^2/omega, omega = V_j/V_i
      // of the lattices
      const double backfill = (FLAGS & Flag::UNEQUAL) ? backfill_of(in, i, type_j) : 1.0,
                   back = (FLAGS & Flag::UNEQUAL) ? backfill / constant.volume : 1.0;
      if (FLAGS & Flag::UNEQUAL) pi.pv2 = backfill * constant.volume * pi.pv2;
      const bool own = KIND == WITH_SOLID || (KIND == WITH_WALL && constant.thin);
      double down[D];
      const bool deep = (FLAGS & Flag::IMAGES) && is_below(laws, mirror, in.type[i], down);
      T sum[D];
      for (T &s : sum) s = 0.0;
      Taken<T, D> taken((FLAGS & Flag::SUMS) && !(FLAGS & Flag::IMAGES) ? laws.taken : nullptr);
      for_neighbors<T, (FLAGS & Flag::IMAGES) != 0>(
          row, [&](const int *j, const T &weight) FSI_INLINE_LAMBDA {
            Particle<T, D> pj(point, j);
            const Particle<T, D> original = pj;
            if (FLAGS & Flag::IMAGES) pj.reflect(mirror);
            Between<T, D> m;
            relate<T, K, KIND, FLAGS>(kernel, in, constant, i, pi, pj, j, weight, m);
            T p = shared_pressure<T, KIND, D>(pi, pj, original.x, constant.extrapolate,
                                              constant.floor, back, own);
            if ((FLAGS & Flag::IMAGES) && KIND == WITH_FLUID && deep)
              p += pressure_below<T, FLAGS, D>(down, pi, pj, m, by);
            T force[D], on_j[D], coupling[D], friction[D], coupled;
            push<T, KIND, FLAGS>(artificial, laws, constant, pi, pj, p, m, force, coupling,
                                 friction, coupled, by);
            if (KIND == WITH_WALL || KIND == WITH_SOLID)
              keep_out<T, KIND, FLAGS>(laws.guard[type_j], in, constant.bulk, j, m, force, by);
            if constexpr (KIND == WITH_SOLID_FULL)
              if (laws.stress)
                coupled -= CouplePaper::add_stress<(FLAGS & Flag::IMAGES) != 0>(
                    laws.stress[*j], mirror, pj.vol * pj.vol * m.g, m.x, m.v, force);
            if ((FLAGS & Flag::SUMS) && KIND != WITH_FLUID) by.coupling += m.share * coupled;
            if (FLAGS & Flag::IMAGES)
              for (int d = 0; d < D; d++) on_j[d] = -mirror.sign[d] * force[d];
            if (FLAGS & Flag::LAMINAR)
              slow<T, KIND, FLAGS>(viscous, laws, mirror, pi, pj, original.v, j, constant, m, force,
                                   on_j, friction, by);
            if (!(FLAGS & Flag::IMAGES))
              for (int d = 0; d < D; d++) on_j[d] = -force[d];
            // what wall particles are given: they are not in the sum of energies
            if ((FLAGS & Flag::SUMS) && KIND == WITH_WALL)
              by.walls -= m.share * product(force, pj.v);
            if ((FLAGS & Flag::SUMS) && !(FLAGS & Flag::IMAGES)) {
              const auto stress = [&](int a, int c) FSI_INLINE_LAMBDA {
                return m.share * m.x[a] * force[c];
              };
              add_virial<D>(stress, by.virial);
            }
            for (int d = 0; d < D; d++) {
              sum[d] += force[d];
              if (FLAGS & Flag::IMAGES) on_all[d] += m.share * (force[d] + on_j[d]);
            }
            if ((FLAGS & Flag::SUMS) && !(FLAGS & Flag::IMAGES)) taken.add(coupling, friction, j);
            L::add_rows(on_j, f, j);
          });
      taken.close(i);
      for (int d = 0; d < D; d++) f[i][d] += L::sum(sum[d]);
    }
    if (FLAGS & Flag::IMAGES)
      for (int d = 0; d < D; d++) total[d] += L::sum(on_all[d]);
    if (FLAGS & Flag::SUMS) by.add_to(sums);
  }

  // the sums of particle shifting alone
  template <class T, class K, int FLAGS>
  FSI_INLINE void shift_rows(const Row *const rows, const int nrows, const Mirror mirror,
                             const K kernel, const FluidParticles in, const double wdx,
                             double (*const shift)[shift_row<K::DIM>(Flag::EDGES)])
  {
    constexpr int D = K::DIM, WITH = (FLAGS & Flag::IMAGES) | Flag::EDGES;
    constexpr bool IMAGE = FLAGS & Flag::IMAGES;
    const auto *const point = reinterpret_cast<const Point<D> *>(in.points);
    const Shift<D> law(wdx);
    ShiftOfRow<T, D, (FLAGS & Flag::BOTH) != 0, WITH> shift_of(mirror);
    for (int n = 0; n < nrows; n++) {
      const Row row = rows[n];
      if (row.n == 0) continue;
      const int i = row.i;
      const Particle<T, D> pi(point[i]);
      const double backfill =
          !(FLAGS & Flag::BOTH) && in.thin ? backfill_of(in, i, in.type[row.j[0]]) : 1.0;
      shift_of.open();
      for_neighbors<T, IMAGE>(row, [&](const int *j, const T &weight) FSI_INLINE_LAMBDA {
        Particle<T, D> pj(point, j);
        if (IMAGE) pj.reflect(mirror);
        T x[D];
        difference(pi.x, pj.x, x);
        const T rsq = product(x, x), r = root(rsq);
        T g = kernel.gradient(r);
        if (!(FLAGS & Flag::BOTH)) g = cut_off(in, j, g);
        if (IMAGE) g = weight * g;
        if constexpr (FLAGS & Flag::PARTLY) g = as_visible(in, j, g);
        const T no_rate = 0.0;
        shift_of.take(law.weight(kernel.W(r)), in, i, rsq, pi.vol * (backfill * pj.vol) * g, x,
                      nullptr, &no_rate, j, shift);
      });
      shift_of.close(shift[i]);
    }
  }

  // W_ij, or V_j x_ji.grad_i W_ij
  template <class T, class K, int FLAGS>
  FSI_INLINE void distance_rows(const Row *const rows, const int nrows, const Mirror mirror,
                                const K kernel, const FluidParticles in, const double (*const x)[3],
                                const double *const vol, double *const sum)
  {
    constexpr int D = K::DIM;
    using L = Lanes<T>;
    for (int n = 0; n < nrows; n++) {
      const Row row = rows[n];
      if (row.n == 0) continue;
      const int i = row.i;
      // of neighbors of another spacing
      double volume = (FLAGS & Flag::UNEQUAL) ? in.ratio[in.type[row.j[0]]].volume : 1.0;
      if (in.thin)
        volume *= ((FLAGS & Flag::DIVERGENCE) ? backfill_of
                                              : backfill_weight_of)(in, i, in.type[row.j[0]]);
      const double sharper = (FLAGS & Flag::UNEQUAL) ? in.ratio[in.type[row.j[0]]].sharper : 0.0,
                   back = (FLAGS & Flag::UNEQUAL) && in.unlike ? 1.0 / volume : 1.0;
      T of_i = 0.0;
      for_neighbors<T, (FLAGS & Flag::IMAGES) != 0>(
          row, [&](const int *j, const T &weight) FSI_INLINE_LAMBDA {
            T rsq = 0.0;
            for (int d = 0; d < D; d++) {
              const T xj = L::make([&](int k) {
                return x[j[k]][d];
              });
              const T r =
                  x[i][d] - ((FLAGS & Flag::IMAGES) ? mirror.x[d] + mirror.sign[d] * xj : xj);
              rsq += r * r;
            }
            const T r = root(rsq);
            if (FLAGS & Flag::DIVERGENCE) {
              T w = cut_off<T>(in, j, -weight * rsq * kernel.gradient(r));
              if constexpr (FLAGS & Flag::PARTLY) w = as_visible(in, j, w);
              of_i += w * L::read(vol, j);
              if (FLAGS & Flag::BOTH) L::add(w * vol[i], sum, j);
            } else {
              T w = weight * ((FLAGS & Flag::UNEQUAL) ? kernel.sharper(r, sharper) : kernel.W(r));
              if (FLAGS & Flag::UNEQUAL) w = cut_off(in, j, w);
              if constexpr (FLAGS & Flag::PARTLY) w = as_visible(in, j, w);
              of_i += w;
              if (FLAGS & Flag::BOTH) L::add((FLAGS & Flag::UNEQUAL) ? back * w : w, sum, j);
            }
          });
      sum[i] += volume * L::sum(of_i);
    }
  }

  // T: double for loops pair by pair, Pack for several at a time
  template <class T, class K> class FluidLoopsOf : public FluidLoops {
    static constexpr int D = K::DIM;
    static constexpr bool ONE_BY_ONE = std::is_same_v<T, double>;
    const K kernel;

   public:
    explicit FluidLoopsOf(const K &kernel_in) : kernel(kernel_in) {}

    void rates(PairKind kind, const std::vector<Row> &rows, const Mirror *image,
               const FluidParticles &in, const RateLaws &laws, double *rate, double *shift,
               PairSums *sums, std::vector<Row> *near) const override
    {
      using namespace Flag;
      if (near) near->clear();
      const Mirror mirror = image ? *image : Mirror();
      bool ran = rows.empty();
      const auto loop = [&](auto kind_is, auto flags) {
        ran = true;
        run_loop<T>([&](auto number) FSI_INLINE_LAMBDA {
          rate_rows<decltype(number), K, kind_is(), flags()>(
              rows.data(), rows.size(), mirror, kernel, in, laws, rate,
              reinterpret_cast<double(*)[shift_row<D>(flags())]>(shift), sums, near);
        });
      };
      // density diffusion, with a coefficient of zero where it is off, comes with what is rarely
      // without: images and slopes
      const bool fluid = kind == WITH_FLUID, unlike = in.unlike,
                 diffuses = fluid && (laws.delta > 0.0 || (shift && laws.fills) || image || unlike);
      PairSums unused;
      if (unlike && !sums) sums = &unused;
      const int shifting = !shift ? 0
          : !laws.fills           ? SHIFT | EDGES
          : fluid && !image       ? SHIFT | SLOPES
                                  : SHIFT;
      const int named = shifting |
          (diffuses || partly(in) ? sums ? DIFFUSION | SUMS : DIFFUSION : 0) |
          (shift && in.fade ? FADES : 0) | (image ? IMAGES : 0) | unequal_or_cut(kind, in) |
          partly(in);
      with_flags<IMAGES | DIFFUSION | SUMS | UNEQUAL | SHIFT | SLOPES | PARTLY | EDGES | FADES>(
          named, [&](auto flags) {
            constexpr int shifts = flags() & (SHIFT | SLOPES | EDGES);
            constexpr bool parts = flags() & PARTLY, diffusing = flags() & DIFFUSION,
                           alone = !(flags() & (DIFFUSION | SUMS)), plain = !(flags() & IMAGES),
                           unequal_rows = flags() & UNEQUAL, fades = flags() & FADES;
            // where shifting fades all rows are in the loops of unequal ones
            if constexpr (!parts && alone && (!fades || (unequal_rows && shifts != 0)) &&
                          (shifts == 0 || shifts == SHIFT || shifts == (SHIFT | EDGES)))
              if (!fluid) return loop(std::integral_constant<int, WITH_SOLID>(), flags);
            constexpr bool likes = !unequal_rows && !fades &&
                (!parts || (ONE_BY_ONE && diffusing)) && (diffusing || (plain && alone));
            constexpr bool unlikes = unequal_rows && (!parts || ONE_BY_ONE) && diffusing &&
                (flags() & SUMS) && fades == (shifts != 0);
            if constexpr ((likes || unlikes) &&
                          (shifts == 0 || shifts == (SHIFT | EDGES) ||
                           shifts == (plain ? SHIFT | SLOPES : SHIFT)))
              loop(std::integral_constant<int, WITH_FLUID>(), flags);
          });
      if (!ran) no_such_loop("rates", kind, named);
    }

    void forces(PairKind kind, const std::vector<Row> &rows, const Mirror *image,
                const FluidParticles &in, const ForceLaws &laws, double *force, double *total,
                PairSums *sums) const override
    {
      using namespace Flag;
      const Mirror mirror = image ? *image : Mirror();
      auto *const f = reinterpret_cast<double(*)[row_of_forces(D)]>(force);
      // with sums, images, neighbors of another spacing, both viscosities, the central one, or pair
      // by pair there is one loop for all effects: those that are off have coefficients of zero
      constexpr int EFFECTS = ARTIFICIAL | LAMINAR | CENTRAL;
      PairSums unused;
      const int unequal_rows = kind == WITH_SOLID_FULL ? 0 : unequal_or_cut(kind, in);
      if (!sums && (kind == WITH_SOLID_FULL || (image && unequal_rows) || in.unlike))
        sums = &unused;
      bool ran = rows.empty();
      const auto loop = [&](auto kind_is, auto flags) {
        ran = true;
        run_loop<T>([&](auto number) FSI_INLINE_LAMBDA {
          force_rows<decltype(number), K, kind_is(), flags()>(rows.data(), rows.size(), mirror,
                                                              kernel, in, laws, f, total, sums);
        });
      };
      const bool artificial = laws.alpha > 0.0 || laws.beta > 0.0;
      if (!sums && partly(in)) sums = &unused;
      const int special = (sums ? SUMS : 0) | (image ? IMAGES : 0) | unequal_rows | partly(in);
      const bool all = special || ONE_BY_ONE || laws.laminar == CENTRAL_LAMINAR ||
          (artificial && laws.laminar);
      with_flags<EFFECTS | SUMS | IMAGES | UNEQUAL | PARTLY>(
          special |
              (all                ? EFFECTS
                   : artificial   ? ARTIFICIAL
                   : laws.laminar ? LAMINAR
                                  : 0),
          [&](auto flags) {
            constexpr int effects = flags() & EFFECTS;
            constexpr bool alone = flags() == 0 || flags() == ARTIFICIAL || flags() == LAMINAR;
            // few: their sums may be for nothing
            constexpr bool counted = (flags() & SUMS) ||
                !((flags() & IMAGES) && (flags() & UNEQUAL));
            constexpr bool with_parts = flags() & PARTLY;
            if constexpr (with_parts) {
              if constexpr (ONE_BY_ONE && effects == EFFECTS && (flags() & SUMS))
                loop(std::integral_constant<int, WITH_FLUID>(), flags);
            } else if constexpr ((effects == EFFECTS && counted) || (alone && !ONE_BY_ONE)) {
              if constexpr (!(flags() & UNEQUAL) || (flags() & SUMS))
                if (kind == WITH_FLUID) loop(std::integral_constant<int, WITH_FLUID>(), flags);
              if (kind == WITH_SOLID) loop(std::integral_constant<int, WITH_SOLID>(), flags);
              if constexpr (!(flags() & IMAGES))    // walls of particles have no images
                if (kind == WITH_WALL) loop(std::integral_constant<int, WITH_WALL>(), flags);
              if constexpr (ONE_BY_ONE && (flags() & SUMS) && !(flags() & UNEQUAL))
                if (kind == WITH_SOLID_FULL)
                  loop(std::integral_constant<int, WITH_SOLID_FULL>(), flags);
            }
          });
      if (!ran) no_such_loop("forces", kind, special);
    }

    void shifts(PairKind kind, const std::vector<Row> &rows, const Mirror *image,
                const FluidParticles &in, double wdx, double *shift) const override
    {
      const Mirror mirror = image ? *image : Mirror();
      with_flags<Flag::IMAGES | Flag::BOTH | Flag::PARTLY>(
          (image ? Flag::IMAGES : 0) | (kind == WITH_FLUID ? Flag::BOTH : 0) | partly(in),
          [&](auto flags) {
            if constexpr ((flags() & Flag::PARTLY) && !(ONE_BY_ONE && (flags() & Flag::BOTH)))
              rows.empty() ? void() : no_such_loop("shifts", kind, flags());
            else
              run_loop<T>([&](auto number) FSI_INLINE_LAMBDA {
                shift_rows<decltype(number), K, flags()>(
                    rows.data(), rows.size(), mirror, kernel, in, wdx,
                    reinterpret_cast<double(*)[shift_row<D>(Flag::EDGES)]>(shift));
              });
          });
    }

    void number_density(PairKind kind, const std::vector<Row> &rows, bool both, const Mirror *image,
                        const FluidParticles &in, const double (*x)[3], double *sum) const override
    {
      distances(unequal_or_cut(kind, in), rows, both, image, in, x, nullptr, sum);
    }

    void position_divergence(const std::vector<Row> &rows, bool both, const Mirror *image,
                             const FluidParticles &in, const double (*x)[3], const double *vol,
                             double *sum) const override
    {
      distances(Flag::DIVERGENCE, rows, both, image, in, x, vol, sum);
    }

   private:
    // Rows of fluids of two spacings, and of solids and walls of another spacing than the fluid's;
    // those that have it, among them, have shares that change nothing.
    static int unequal(PairKind kind, const FluidParticles &in)
    {
      const bool solids = kind == WITH_SOLID || kind == WITH_WALL;
      return in.unlike || (in.unequal && solids) ? Flag::UNEQUAL : 0;
    }
    static int partly(const FluidParticles &in) { return in.visible ? Flag::PARTLY : 0; }
    // Those that mirror walls cut are in the same loops.
    static int unequal_or_cut(PairKind kind, const FluidParticles &in)
    {
      return in.cut && kind != WITH_FLUID ? Flag::UNEQUAL : unequal(kind, in);
    }

    void distances(int what, const std::vector<Row> &rows, bool both, const Mirror *image,
                   const FluidParticles &in, const double (*x)[3], const double *vol,
                   double *sum) const
    {
      const Mirror mirror = image ? *image : Mirror();
      with_flags<Flag::DIVERGENCE | Flag::IMAGES | Flag::BOTH | Flag::UNEQUAL | Flag::PARTLY>(
          what | (image ? Flag::IMAGES : 0) | (both ? Flag::BOTH : 0) | partly(in),
          [&](auto flags) {
            constexpr bool of_fluids = ONE_BY_ONE && (flags() & Flag::BOTH),
                           known = !(flags() & Flag::UNEQUAL) || !(flags() & Flag::DIVERGENCE);
            if constexpr (!known || (!of_fluids && (flags() & Flag::PARTLY)))
              rows.empty() ? void() : no_such_loop("distances", WITH_FLUID, flags());
            else
              run_loop<T>([&](auto number) FSI_INLINE_LAMBDA {
                distance_rows<decltype(number), K, flags()>(rows.data(), rows.size(), mirror,
                                                            kernel, in, x, vol, sum);
              });
          });
    }
  };

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
