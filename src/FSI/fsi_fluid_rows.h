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

#include "fsi_fluid_terms.h"

#include <type_traits>

namespace LAMMPS_NS::FSI {

// d rho_i/dt = m_i sum_j v_ij.grad_i W_ij, the rate of m_i psi_i (paper eqs. 8 and 12), which
// makes the work of the pair force -(p_i V_i^2 + p_j V_j^2) grad_i W_ij that of the pressures;
// and the sums of particle shifting
template <class T, class K, int KIND, int FLAGS>
FSI_INLINE void rate_rows(const RowSpan rows, const Mirror mirror, const K kernel,
                          const FluidParticles in, const RateLaws laws, double *const rate,
                          double (*const shift)[shift_row<K::DIM>(FLAGS)], PairSums *const sums,
                          std::vector<Row> *const near)
{
  constexpr int D = K::DIM;
  constexpr bool IMAGE = FLAGS & Flag::IMAGES, FLUID = KIND == WITH_FLUID,
                 SHIFTS = FLAGS & Flag::SHIFT;
  using L = Lanes<T>;
  const auto *const point = reinterpret_cast<const Point<D> *>(in.points);
  const Shift<D> law(laws.wdx, laws.wall_shift);
  T reachsq = laws.reach * laws.reach, by_diffusion = 0.0;
  Sieve<T, !IMAGE> sieve;
  ShiftOfRow<T, D, FLUID, FLAGS> shift_of(mirror);
  for (const Row row : rows) {
    if (row.n == 0) continue;
    const int i = row.i;
    const Particle<T, D> pi(point[i]);
    const RateConstants constant =
        constants_of_rates<KIND, FLAGS>(in, laws.delta, kernel.h, i, in.type[i], in.type[row.j[0]]);
    T sum = 0.0, flux = 0.0;
    if (SHIFTS) shift_of.open();
    if (near) sieve.open(row);
    const auto pair = [&](const int *j, const T &weight) FSI_INLINE_LAMBDA -> T {
      Particle<T, D> pj(point, j);
      if (IMAGE) pj.reflect(mirror);
      RatePair<T, D> m;
      relate<T, K, KIND, FLAGS>(kernel, in, pi, pj, j, weight, m);
      const auto shift_pair = [&](const T *rate_j) FSI_INLINE_LAMBDA {
        const T vol_j = (FLAGS & Flag::UNEQUAL) ? constant.backfill * pj.vol : pj.vol;
        // beside a surface the wall is no half-space, in which its factor is right
        constexpr bool STEEP = FLUID || (FLAGS & Flag::EDGES);
        shift_of.take(STEEP ? law.weight(m.w) : law.weight_of_wall(m.w), in, i, m.rsq,
                      pi.vol * vol_j * m.g, m.x, m.v, rate_j, j, shift);
      };
      if constexpr (SHIFTS && !FLUID) shift_pair(nullptr);
      const T s = flow<T, K, KIND, FLAGS>(kernel, in, constant, j, weight, m);
      sum += s;
      if (!FLUID) return m.rsq;    // density of a solid or a wall has other rates
      T rate_j = (FLAGS & Flag::UNEQUAL) ? constant.back * (pj.rho * pj.vol * s)
                                         : pj.rho * pj.vol * s;
      if (FLAGS & Flag::DIFFUSION)
        diffuse<T, FLAGS>(in, laws, constant, i, pi, pj, j, m.g, flux, rate_j, by_diffusion);
      if constexpr (SHIFTS) shift_pair(&rate_j);
      if (!shift_of.TAKES_RATES) L::add(rate_j, rate, j);
      return m.rsq;
    };
    for_neighbors<T, IMAGE>(row, [&](const int *j, const T &weight) FSI_INLINE_LAMBDA {
      const T rsq = pair(j, weight);
      if (near) sieve.take(reachsq < rsq, j);
    });
    if (near) near->push_back(sieve.close(row));    // of images the others are gone
    rate[i] += point[i].rho * constant.volume * point[i].vol * L::sum(sum) + L::sum(flux);
    if constexpr (is_cut(KIND, FLAGS))
      tally_coming_out<T, K, IMAGE>(near ? near->back() : row, mirror, kernel, in, laws, constant,
                                    sums);
    if constexpr (SHIFTS) shift_of.close(shift[i]);
  }
  if (FLAGS & Flag::SUMS) sums->diffusion += L::sum(by_diffusion);
}

// F_ij = -(p_i V_i^2 + p_j V_j^2 + Q_ij) grad_i W_ij + laminar viscosity (paper eq. 14)
template <class T, class K, int KIND, int FLAGS>
FSI_INLINE void force_rows(const RowSpan rows, const Mirror mirror, const K kernel,
                           const FluidParticles in, const ForceLaws laws,
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
  for (const Row row : rows) {
    if (row.n == 0) continue;
    const int i = row.i, type_j = in.type[row.j[0]];
    const RowConstants constant = constants_of_row<D, KIND, FLAGS>(in, laws, i, in.type[i], type_j);
    Particle<T, D> pi(point[i]);
    // neighbors of another volume count by it: omega p_i V_i^2 + p_j V_j^2/omega, omega = V_j/V_i
    // of the lattices
    const double backfill = (FLAGS & Flag::UNEQUAL) ? backfill_of(in, i, type_j) : 1.0,
                 back = (FLAGS & Flag::UNEQUAL) ? backfill / constant.volume : 1.0;
    if (FLAGS & Flag::UNEQUAL) pi.pv2 = backfill * constant.volume * pi.pv2;
    const bool own = KIND == WITH_SOLID || (KIND == WITH_WALL && constant.thin);
    double down[D];
    const bool deep =
        (FLAGS & Flag::IMAGES) && KIND == WITH_FLUID && is_below(laws, mirror, in.type[i], down);
    T sum[D];
    for (T &s : sum) s = 0.0;
    Taken<T, D> taken((FLAGS & Flag::SUMS) ? laws.taken : nullptr, mirror);
    for_neighbors<T, (FLAGS & Flag::IMAGES) != 0>(
        row, [&](const int *j, const T &weight) FSI_INLINE_LAMBDA {
          Particle<T, D> pj(point, j);
          const Particle<T, D> original = pj;
          if (FLAGS & Flag::IMAGES) pj.reflect(mirror);
          Between<T, D> m;
          relate<T, K, KIND, FLAGS>(kernel, in, constant, i, pi, pj, j, weight, m);
          T p = shared_pressure<T, KIND, D>(pi, pj, original.x, constant.extrapolate,
                                            constant.floor, back, own);
          if (deep) p += pressure_below<T, FLAGS, D>(down, pi, pj, m, by);
          T force[D], on_j[D], coupling[D], friction[D], friction_j[D], coupled;
          push<T, KIND, FLAGS>(artificial, laws, constant, pi, pj, p, m, force, coupling, friction,
                               coupled, by);
          hold_off<T, KIND, FLAGS>(in, laws, mirror, type_j, constant.bulk, j, pj.vol, m, force,
                                   coupled, by);
          react<T, KIND, FLAGS>(viscous, laws, mirror, pi, pj, original.v, j, constant, m, force,
                                on_j, friction, friction_j, by);
          if (FLAGS & Flag::SUMS) account<T, KIND, FLAGS>(m, force, pj.v, coupled, by);
          for (int d = 0; d < D; d++) {
            sum[d] += force[d];
            if (FLAGS & Flag::IMAGES) on_all[d] += m.share * (force[d] + on_j[d]);
          }
          if (FLAGS & Flag::SUMS) taken.add(coupling, friction, friction_j, j);
          L::add_rows(on_j, f, j);
        });
    taken.close(i);
    for (int d = 0; d < D; d++) f[i][d] += L::sum(sum[d]);
  }
  if (FLAGS & Flag::IMAGES)
    for (int d = 0; d < D; d++) total[d] += L::sum(on_all[d]);
  if (FLAGS & Flag::SUMS) sums->add(by);
}

// the sums of particle shifting alone
template <class T, class K, int FLAGS>
FSI_INLINE void shift_rows(const RowSpan rows, const Mirror mirror, const K kernel,
                           const FluidParticles in,
                           double (*const shift)[shift_row<K::DIM>(Flag::EDGES)])
{
  constexpr int D = K::DIM, WITH = (FLAGS & Flag::IMAGES) | Flag::EDGES;
  constexpr bool IMAGE = FLAGS & Flag::IMAGES;
  const auto *const point = reinterpret_cast<const Point<D> *>(in.points);
  ShiftOfRow<T, D, (FLAGS & Flag::BOTH) != 0, WITH> shift_of(mirror);
  for (const Row row : rows) {
    if (row.n == 0) continue;
    const int i = row.i;
    const Particle<T, D> pi(point[i]);
    const double backfill = !(FLAGS & Flag::BOTH) && in.thin ? backfill_of(in, i, in.type[row.j[0]])
                                                             : 1.0;
    shift_of.open();
    for_neighbors<T, IMAGE>(row, [&](const int *j, const T &weight) FSI_INLINE_LAMBDA {
      Particle<T, D> pj(point, j);
      if (IMAGE) pj.reflect(mirror);
      T x[D];
      difference(pi.x, pj.x, x);
      const T rsq = product(x, x);
      T g = kernel.gradient(root(rsq));
      if (!(FLAGS & Flag::BOTH)) g = cut_off(in, j, g);
      if (IMAGE) g = weight * g;
      if constexpr (FLAGS & Flag::PARTLY) g = as_visible(in, j, g);
      const T plain = 1.0, no_rate = 0.0;
      shift_of.take(plain, in, i, rsq, pi.vol * (backfill * pj.vol) * g, x, nullptr, &no_rate, j,
                    shift);
    });
    shift_of.close(shift[i]);
  }
}

// W_ij, or V_j x_ji.grad_i W_ij
template <class T, class K, int FLAGS>
FSI_INLINE void distance_rows(const RowSpan rows, const Mirror mirror, const K kernel,
                              const FluidParticles in, const double (*const x)[3],
                              const double *const vol, double *const sum)
{
  constexpr int D = K::DIM;
  using L = Lanes<T>;
  for (const Row row : rows) {
    if (row.n == 0) continue;
    const int i = row.i;
    // of neighbors of another spacing
    double volume = (FLAGS & Flag::UNEQUAL) ? in.ratio[in.type[row.j[0]]].volume : 1.0;
    if (in.thin)
      volume *=
          ((FLAGS & Flag::DIVERGENCE) ? backfill_of : backfill_weight_of)(in, i, in.type[row.j[0]]);
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
            const T r = x[i][d] - ((FLAGS & Flag::IMAGES) ? mirror.x[d] + mirror.sign[d] * xj : xj);
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

// The loops that are compiled, by kind of pair: with all of these flags and any of those. What is
// not here is an error of whoever asks for it (no_such_loop).
struct Compiled {
  int kind, always, maybe;
};
namespace Flag {
  constexpr int EFFECTS = ARTIFICIAL | LAMINAR | CENTRAL;

  // Pair by pair (SINGLE) there is one loop for all effects: those that are off have coefficients
  // of zero, and neighbors of the same spacing ratios that change nothing. What thin bodies hide
  // in part is visited in these alone.
  //
  // Of several pairs at a time (PACKED) density diffusion comes with what is rarely without: images
  // and slopes. Where shifting fades all rows are in the loops of unequal ones, as images of
  // solids are, of which there are few. Walls and solids are one kind.
  struct RatesTable {
    static constexpr int FLAGS =
        IMAGES | DIFFUSION | SUMS | UNEQUAL | SHIFT | SLOPES | PARTLY | EDGES | FADES;
    static constexpr Compiled PACKED[] = {
        {WITH_SOLID, 0, 0},
        {WITH_SOLID, UNEQUAL, IMAGES},
        {WITH_SOLID, SHIFT, 0},
        {WITH_SOLID, SHIFT | UNEQUAL, IMAGES},
        {WITH_SOLID, SHIFT | EDGES, 0},
        {WITH_SOLID, SHIFT | EDGES | UNEQUAL, IMAGES},
        {WITH_SOLID, SHIFT | UNEQUAL | FADES, IMAGES},
        {WITH_SOLID, SHIFT | EDGES | UNEQUAL | FADES, IMAGES},
        {WITH_FLUID, 0, 0},
        {WITH_FLUID, SHIFT | EDGES, 0},
        {WITH_FLUID, DIFFUSION, SUMS | IMAGES},
        {WITH_FLUID, DIFFUSION | SHIFT | EDGES, SUMS | IMAGES},
        {WITH_FLUID, DIFFUSION | SHIFT | SLOPES, SUMS | IMAGES},
        {WITH_FLUID, DIFFUSION | SUMS | UNEQUAL, IMAGES},
        {WITH_FLUID, DIFFUSION | SUMS | UNEQUAL | FADES | SHIFT | EDGES, IMAGES},
        {WITH_FLUID, DIFFUSION | SUMS | UNEQUAL | FADES | SHIFT | SLOPES, IMAGES},
    };
    static constexpr Compiled SINGLE[] = {
        {WITH_SOLID, UNEQUAL, IMAGES},
        {WITH_SOLID, SHIFT | UNEQUAL, IMAGES | EDGES | FADES},
        {WITH_FLUID, DIFFUSION | SUMS | UNEQUAL, IMAGES | PARTLY},
        {WITH_FLUID, DIFFUSION | SUMS | UNEQUAL | SHIFT | EDGES, IMAGES | PARTLY | FADES},
        {WITH_FLUID, DIFFUSION | SUMS | UNEQUAL | SHIFT | SLOPES, IMAGES | PARTLY | FADES},
    };
  };

  // With sums, images, neighbors of another spacing, both viscosities, or the central one there is
  // one loop for all effects. Images of another spacing, and of walls of particles, are few: their
  // sums may be for nothing.
  struct ForcesTable {
    static constexpr int FLAGS = EFFECTS | SUMS | IMAGES | UNEQUAL | PARTLY | VARIES;
    static constexpr Compiled PACKED[] = {
        {WITH_FLUID, 0, 0},
        {WITH_FLUID, ARTIFICIAL, 0},
        {WITH_FLUID, LAMINAR, 0},
        {WITH_FLUID, EFFECTS, SUMS | IMAGES},
        {WITH_FLUID, EFFECTS | UNEQUAL | SUMS, IMAGES | VARIES},
        {WITH_SOLID, 0, 0},
        {WITH_SOLID, ARTIFICIAL, 0},
        {WITH_SOLID, LAMINAR, 0},
        {WITH_SOLID, EFFECTS, SUMS | IMAGES},
        {WITH_SOLID, EFFECTS | UNEQUAL, SUMS},
        {WITH_SOLID, EFFECTS | UNEQUAL | SUMS, IMAGES},
        {WITH_WALL, 0, 0},
        {WITH_WALL, ARTIFICIAL, 0},
        {WITH_WALL, LAMINAR, 0},
        {WITH_WALL, EFFECTS, SUMS | UNEQUAL},
        {WITH_WALL, EFFECTS | SUMS | UNEQUAL | IMAGES, 0},
    };
    static constexpr Compiled SINGLE[] = {
        {WITH_FLUID, EFFECTS | UNEQUAL | SUMS, IMAGES | PARTLY | VARIES},
        {WITH_SOLID, EFFECTS | UNEQUAL | SUMS, IMAGES},
        {WITH_WALL, EFFECTS | UNEQUAL | SUMS, IMAGES},
        {WITH_SOLID_FULL, EFFECTS | SUMS, IMAGES},
    };
  };

  struct ShiftsTable {
    static constexpr int FLAGS = IMAGES | BOTH | PARTLY;
    static constexpr Compiled PACKED[] = {
        {WITH_FLUID, BOTH, IMAGES},
        {WITH_SOLID, 0, IMAGES},
    };
    static constexpr Compiled SINGLE[] = {
        {WITH_FLUID, BOTH, IMAGES | PARTLY},
        {WITH_SOLID, 0, IMAGES},
    };
  };

  struct DistancesTable {
    static constexpr int FLAGS = DIVERGENCE | IMAGES | BOTH | UNEQUAL | PARTLY;
    static constexpr Compiled PACKED[] = {
        {WITH_FLUID, 0, IMAGES | BOTH | UNEQUAL},
        {WITH_FLUID, DIVERGENCE, IMAGES | BOTH},
    };
    static constexpr Compiled SINGLE[] = {
        {WITH_FLUID, UNEQUAL, IMAGES | BOTH | PARTLY},
        {WITH_FLUID, DIVERGENCE, IMAGES | BOTH | PARTLY},
    };
  };
}    // namespace Flag

template <size_t N> constexpr bool is_compiled(const Compiled (&table)[N], int kind, int flags)
{
  for (const Compiled &c : table)
    if (c.kind == kind && (flags & c.always) == c.always && !(flags & ~(c.always | c.maybe)))
      return true;
  return false;
}

// T: double for loops pair by pair, Pack for several at a time
template <class T, class K> class FluidLoopsOf : public FluidLoops {
  static constexpr int D = K::DIM;
  static constexpr bool ONE_BY_ONE = std::is_same_v<T, double>;
  template <class Table> static constexpr bool has(int kind, int flags)
  {
    if constexpr (ONE_BY_ONE) return is_compiled(Table::SINGLE, kind, flags);
    return is_compiled(Table::PACKED, kind, flags);
  }
  const K kernel;

 public:
  explicit FluidLoopsOf(const K &kernel_in) : kernel(kernel_in) {}

  void rates(const FluidPairs &pairs, const RateLaws &laws, double *rate, double *shift,
             PairSums *sums, std::vector<Row> *near) const override
  {
    if (near) near->clear();
    PairSums unused;
    if ((ONE_BY_ONE || pairs.in.unlike) && !sums) sums = &unused;
    run(pairs.kind == WITH_FLUID ? WITH_FLUID : WITH_SOLID,
        flags_of_rates(pairs, laws, shift, sums), pairs, "rates", Flag::RatesTable(),
        [&](auto number, const Mirror &mirror, auto kind, auto flags) FSI_INLINE_LAMBDA {
          rate_rows<decltype(number), K, kind(), flags()>(
              pairs.rows, mirror, kernel, pairs.in, laws, rate,
              reinterpret_cast<double(*)[shift_row<D>(flags())]>(shift), sums, near);
        });
  }

  void forces(const FluidPairs &pairs, const ForceLaws &laws, double *force, double *total,
              PairSums *sums) const override
  {
    auto *const f = reinterpret_cast<double(*)[row_of_forces(D)]>(force);
    const bool full = pairs.kind == WITH_SOLID_FULL,
               varies = pairs.kind == WITH_FLUID && laws.viscosity;
    const int unequal = full ? 0
        : varies             ? Flag::UNEQUAL | Flag::VARIES
                             : unequal_flag(pairs, pairs.kind == WITH_WALL && pairs.mirror);
    PairSums unused;
    const bool counted = ONE_BY_ONE || (unequal && (varies || pairs.in.unlike || pairs.mirror));
    if (!sums && counted) sums = &unused;
    run(pairs.kind, flags_of_forces(pairs, unequal, laws, sums), pairs, "forces",
        Flag::ForcesTable(),
        [&](auto number, const Mirror &mirror, auto kind, auto flags) FSI_INLINE_LAMBDA {
          force_rows<decltype(number), K, kind(), flags()>(pairs.rows, mirror, kernel, pairs.in,
                                                           laws, f, total, sums);
        });
  }

  void shifts(const FluidPairs &pairs, double *shift) const override
  {
    const bool fluid = pairs.kind == WITH_FLUID;
    run(fluid ? WITH_FLUID : WITH_SOLID, flags_of(pairs) | (fluid ? Flag::BOTH : 0), pairs,
        "shifts", Flag::ShiftsTable(),
        [&](auto number, const Mirror &mirror, auto, auto flags) FSI_INLINE_LAMBDA {
          shift_rows<decltype(number), K, flags()>(
              pairs.rows, mirror, kernel, pairs.in,
              reinterpret_cast<double(*)[shift_row<D>(Flag::EDGES)]>(shift));
        });
  }

  void distances(const FluidPairs &pairs, bool both, const double (*x)[3], const double *vol,
                 double *sum) const override
  {
    run(WITH_FLUID,
        flags_of(pairs) | (vol ? Flag::DIVERGENCE : unequal_flag(pairs, false)) |
            (both ? Flag::BOTH : 0),
        pairs, "distances", Flag::DistancesTable(),
        [&](auto number, const Mirror &mirror, auto, auto flags) FSI_INLINE_LAMBDA {
          distance_rows<decltype(number), K, flags()>(pairs.rows, mirror, kernel, pairs.in, x, vol,
                                                      sum);
        });
  }

 private:
  // calls loop(number, mirror, kind, flags) as compiled for these, an error if the table has no
  // such row
  template <class Table, class Loop>
  static void run(int kind, int named, const FluidPairs &pairs, const char *what, Table, Loop loop)
  {
    bool ran = pairs.rows.size() == 0;
    const Mirror mirror = pairs.mirror ? *pairs.mirror : Mirror();
    with_flags<Table::FLAGS>(named, [&](auto flags) {
      const auto with_kind = [&](auto kind_is) {
        if constexpr (has<Table>(kind_is(), flags())) {
          if (kind != kind_is()) return;
          ran = true;
          run_loop<T>([&](auto number) FSI_INLINE_LAMBDA {
            loop(number, mirror, kind_is, flags);
          });
        }
      };
      with_kind(std::integral_constant<int, WITH_FLUID>());
      with_kind(std::integral_constant<int, WITH_WALL>());
      with_kind(std::integral_constant<int, WITH_SOLID>());
      with_kind(std::integral_constant<int, WITH_SOLID_FULL>());
    });
    if (!ran) no_such_loop(what, kind, named);
  }

  // what all loops have of it
  static int flags_of(const FluidPairs &pairs)
  {
    return (pairs.mirror ? Flag::IMAGES : 0) | (pairs.in.visible.part ? Flag::PARTLY : 0);
  }

  // Rows of fluids of two spacings, and of solids and walls of another spacing than the fluid's;
  // those that have it, among them, have ratios that change nothing. So have those that mirror
  // walls cut, images of walls and, in loops of rates, of solids.
  static int unequal_flag(const FluidPairs &pairs, bool images)
  {
    const FluidParticles &in = pairs.in;
    const bool of_solids = pairs.kind != WITH_FLUID && (in.unequal || in.cut || images);
    return ONE_BY_ONE || in.unlike || of_solids ? Flag::UNEQUAL : 0;
  }

  static int flags_of_rates(const FluidPairs &pairs, const RateLaws &laws, const double *shift,
                            const PairSums *sums)
  {
    using namespace Flag;
    const bool fluid = pairs.kind == WITH_FLUID, images = pairs.mirror,
               diffuses = fluid &&
        (ONE_BY_ONE || laws.delta > 0.0 || (shift && laws.fills) || images || pairs.in.unlike);
    const int shifting = !shift ? 0 : !laws.fills ? SHIFT | EDGES : fluid ? SHIFT | SLOPES : SHIFT;
    return flags_of(pairs) | shifting | (diffuses ? sums ? DIFFUSION | SUMS : DIFFUSION : 0) |
        (shift && pairs.in.fade ? FADES : 0) | unequal_flag(pairs, images);
  }

  static int flags_of_forces(const FluidPairs &pairs, int unequal, const ForceLaws &laws,
                             const PairSums *sums)
  {
    using namespace Flag;
    const bool artificial = laws.alpha > 0.0 || laws.beta > 0.0;
    const int special = flags_of(pairs) | (sums ? SUMS : 0) | unequal;
    const bool all = special || ONE_BY_ONE || laws.laminar == CENTRAL_LAMINAR ||
        (artificial && laws.laminar);
    return special | (all ? EFFECTS : artificial ? ARTIFICIAL : laws.laminar ? LAMINAR : 0);
  }
};

}    // namespace LAMMPS_NS::FSI

#endif
