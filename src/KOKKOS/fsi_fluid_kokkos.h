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

// The loops of pair_style fsi/fluid/kk: a thread for each particle, over LAMMPS' full list and over
// the images of what is in it. Each particle adds up what it has of its pairs, and no thread writes
// to another's; the terms are those of the loops on the host (fsi_fluid_terms.h), with half of the
// powers of a pair at each side.

#ifndef LMP_FSI_FLUID_KOKKOS_H
#define LMP_FSI_FLUID_KOKKOS_H

#include "kokkos_type.h"    // first: says what functions for a device are

#include "fsi_fluid_terms.h"
#include "fsi_kernel.h"
#include "neigh_list_kokkos.h"

namespace LAMMPS_NS::FSI {

// Arrays on the device; they grow only.
template <class T> using DeviceArray = Kokkos::View<T *, LMPDeviceType>;
template <class T> void grow(DeviceArray<T> &array, size_t n)
{
  if (array.extent(0) < n)
    array = DeviceArray<T>(Kokkos::view_alloc("fsi", Kokkos::WithoutInitializing), n + n / 8);
}
template <class T>
using HostArray = Kokkos::View<T *, Kokkos::HostSpace, Kokkos::MemoryTraits<Kokkos::Unmanaged>>;
template <class T> void to_device(const T *from, size_t n, DeviceArray<T> &to)
{
  grow(to, n);
  if (n)
    Kokkos::deep_copy(Kokkos::subview(to, std::make_pair((size_t) 0, n)),
                      HostArray<const T>(from, n));
}
template <class T> void to_host(const DeviceArray<T> &from, size_t n, T *to)
{
  if (n)
    Kokkos::deep_copy(HostArray<T>(to, n), Kokkos::subview(from, std::make_pair((size_t) 0, n)));
}

// of LAMMPS' particles
struct AtomArrays {
  typedef ArrayTypes<LMPDeviceType> AT;
  AT::t_kkfloat_1d_3_lr x;
  AT::t_kkfloat_1d_3 v;
  AT::t_kkfloat_1d rmass, rho;
  AT::t_int_1d type;
};

// Particles as loops read them, those of rates half a step ago
template <int D, bool OF_RATES> struct Gather {
  AtomArrays atoms;
  Point<D> *point;
  const State *state;
  const double *gravity;    // three numbers per type
  double t, delta;
  double *pressure_over_density;    // or null

  KOKKOS_FUNCTION void operator()(int i) const
  {
    const double x[3] = {atoms.x(i, 0), atoms.x(i, 1), atoms.x(i, 2)},
                 v[3] = {atoms.v(i, 0), atoms.v(i, 1), atoms.v(i, 2)};
    const int type = atoms.type(i);
    Point<D> p;
    p.place(x, v, t);
    p.fill(atoms.rho(i), atoms.rmass(i));
    const double pressure = state[type].pressure(p.rho);
    if (OF_RATES)
      p.diffuse(delta, state[type], gravity + 3 * type, x[2]);
    else
      p.press(pressure);
    point[i] = p;
    if (pressure_over_density) pressure_over_density[i] = pressure / p.rho;
  }
};

// Where images are: which walls each particle is near, and what each set of walls makes of it
struct ImageArrays {
  const int *near_walls;
  WallRow walls;
  const Reflection *reflection;
  const Mirror *mirror;
  int n;
  bool finite;    // may lines to images miss a wall?
  // where particles and walls are in the step, and segments divide pairs, also of rates
  AtomArrays::AT::t_kkfloat_1d_3_lr x;
  WallRow dividing;
  double cutsq;
};

struct FindNearWalls {
  AtomArrays atoms;
  WallRow walls;
  double cut;
  int *near_walls;
  KOKKOS_FUNCTION void operator()(int i) const
  {
    const double x[3] = {atoms.x(i, 0), atoms.x(i, 1), atoms.x(i, 2)};
    near_walls[i] = walls.near(x, cut, 0.0);
  }
};

// What a loop goes over
struct Meetings {
  typedef ArrayTypes<LMPDeviceType> AT;
  AT::t_int_1d ilist, numneigh;
  AT::t_neighbors_2d neighbors;
  ImageArrays images;

  // calls pair(j) for those that no segment divides from i
  template <class Pair> KOKKOS_FORCEINLINE_FUNCTION void for_pairs(int i, Pair pair) const
  {
    for (int jj = 0, n = numneigh(i); jj < n; jj++) {
      const int j = neighbors(i, jj) & NEIGHMASK;
      if (!images.finite || !divided(i, j)) pair(j);
    }
  }
  // calls pair(j, mirror, number of the reflection) for the images that i sees, also its own
  template <int D, class Pair>
  KOKKOS_FORCEINLINE_FUNCTION void for_images(int i, const Point<D> *point, Pair pair) const
  {
    const int mine = images.near_walls ? images.near_walls[i] : 0;
    for (int k = 0; mine && k < images.n; k++) {
      const Reflection &s = images.reflection[k];
      if ((mine & s.mask) != s.mask) continue;
      const Mirror mirror = images.mirror[k];
      for (int jj = -1, n = numneigh(i); jj < n; jj++) {
        const int j = jj < 0 ? i : neighbors(i, jj) & NEIGHMASK;
        if ((images.near_walls[j] & s.mask) == s.mask && sees(s, point[i], point[j]) &&
            (!images.finite || !divided(i, j)))
          pair(j, mirror, k);
      }
    }
  }

 private:
  KOKKOS_FORCEINLINE_FUNCTION bool divided(int i, int j) const
  {
    const auto &x = images.x;
    const double xi[3] = {x(i, 0), x(i, 1), x(i, 2)}, xj[3] = {x(j, 0), x(j, 1), x(j, 2)};
    return images.dividing.divide(xi, xj);
  }
  template <int D>
  KOKKOS_FORCEINLINE_FUNCTION bool sees(const Reflection &s, const Point<D> &i,
                                        const Point<D> &j) const
  {
    if (!images.finite) return true;
    const double xi[3] = {i.x[0], i.x[1], D == 3 ? i.x[D - 1] : 0.0},
                 xj[3] = {j.x[0], j.x[1], D == 3 ? j.x[D - 1] : 0.0};
    double rsq = 0.0, away[3];
    for (int d = 0; d < 3; d++) rsq += (xi[d] - xj[d]) * (xi[d] - xj[d]);
    return images.walls.sees(s, xi, xj, images.cutsq, rsq, away);
  }
};

// What all loops have
template <class K> struct FluidLoopKokkos : Meetings {
  static constexpr int D = K::DIM;
  K kernel;
  FluidParticles in;
  explicit FluidLoopKokkos(const K &k) : kernel(k) {}
  KOKKOS_FORCEINLINE_FUNCTION const Point<D> *points() const
  {
    return reinterpret_cast<const Point<D> *>(in.points);
  }
  // lists have the skin's pairs, too; what is not a number is not far: it is to be seen
  KOKKOS_FORCEINLINE_FUNCTION bool is_far(const Particle<double, D> &i,
                                          const Particle<double, D> &j) const
  {
    double x[D];
    difference(i.x, j.x, x);
    return product(x, x) >= kernel.cutsq;
  }
};

// Rates of density; sums: the power of diffusion
template <class K, bool SUMS> struct RateLoop : FluidLoopKokkos<K> {
  static constexpr int D = K::DIM, FLAGS = Flag::DIFFUSION | (SUMS ? Flag::SUMS : 0);
  using Base = FluidLoopKokkos<K>;
  RateLaws laws;
  double *rate;
  explicit RateLoop(const K &k) : Base(k) {}

  KOKKOS_FUNCTION void operator()(int ii) const
  {
    double none = 0.0;
    (*this)(ii, none);
  }
  KOKKOS_FUNCTION void operator()(int ii, double &power) const
  {
    const int i = this->ilist(ii);
    const Point<D> *const point = this->points();
    const Particle<double, D> pi(point[i]);
    double sum = 0.0, flux = 0.0, by = 0.0;
    this->for_pairs(i, [&](int j) {
      add<FLAGS>(i, pi, j, Particle<double, D>(point[j]), sum, flux, by);
    });
    this->for_images(i, point, [&](int j, const Mirror &mirror, int) {
      Particle<double, D> pj(point[j]);
      pj.reflect(mirror);
      add<FLAGS | Flag::IMAGES>(i, pi, j, pj, sum, flux, by);
    });
    rate[i] = pi.rho * pi.vol * sum + flux;
    power += 0.5 * by;
  }

 private:
  template <int WITH>
  KOKKOS_FORCEINLINE_FUNCTION void add(int i, const Particle<double, D> &pi, int j,
                                       const Particle<double, D> &pj, double &sum, double &flux,
                                       double &by) const
  {
    const FluidParticles &in = this->in;
    if (this->is_far(pi, pj)) return;
    const RateConstants constant = constants_of_rates<WITH_FLUID, WITH>(
        in, laws.delta, this->kernel.h, i, in.type[i], in.type[j]);
    RatePair<double, D> m;
    relate<double, K, WITH_FLUID, WITH>(this->kernel, in, pi, pj, &j, 1.0, m);
    sum += flow<double, K, WITH_FLUID, WITH>(this->kernel, in, constant, &j, 1.0, m);
    double of_j = 0.0;    // finds its own
    diffuse<double, WITH>(in, laws, constant, i, pi, pj, &j, m.g, flux, of_j, by);
  }
};

// Forces; sums: powers, virial, and forces on walls, three numbers each
template <class K, bool SUMS> struct ForceLoop : FluidLoopKokkos<K> {
  static constexpr int D = K::DIM,
                       FLAGS = Flag::ARTIFICIAL | Flag::LAMINAR | Flag::CENTRAL |
      (SUMS ? Flag::SUMS : 0);
  using Base = FluidLoopKokkos<K>;
  ForceLaws laws;
  AtomArrays::AT::t_kkacc_1d_3 f;
  double *friction;    // per particle, D numbers; or null

  enum { ARTIFICIAL, LAMINAR, WALLS, VIRIAL, NPOWERS = VIRIAL + 6 };
  typedef double value_type[];
  unsigned value_count = NPOWERS;
  explicit ForceLoop(const K &k) : Base(k) {}

  KOKKOS_FUNCTION void operator()(int ii) const { (*this)(ii, nullptr); }
  KOKKOS_FUNCTION void operator()(int ii, double *sums) const
  {
    const int i = this->ilist(ii), type = this->in.type[i];
    const Point<D> *const point = this->points();
    const Particle<double, D> pi(point[i]);
    const ArtificialViscosity artificial(laws.alpha, laws.beta, this->kernel.h);
    const LaminarViscosity<D> viscous(laws.central_length_sq * (this->kernel.h * this->kernel.h));
    double force[D], rubbing[D];
    for (int d = 0; d < D; d++) force[d] = rubbing[d] = 0.0;
    Powers<double> by;
    this->for_pairs(i, [&](int j) {
      double of_pair[D];
      if (!find<FLAGS>(artificial, viscous, i, pi, j, point[j], Mirror(), nullptr, of_pair,
                       SUMS ? rubbing : nullptr, by))
        return;
      for (int d = 0; d < D; d++) force[d] += of_pair[d];
    });
    this->for_images(i, point, [&](int j, const Mirror &mirror, int k) {
      double of_pair[D], down[D];
      const bool deep = is_below(laws, mirror, type, down);
      if (!find<FLAGS | Flag::IMAGES>(artificial, viscous, i, pi, j, point[j], mirror,
                                      deep ? &down : nullptr, of_pair, SUMS ? rubbing : nullptr,
                                      by))
        return;
      const Reflection &s = this->images.reflection[k];
      for (int d = 0; d < D; d++) {
        force[d] += of_pair[d];
        sums[NPOWERS + 3 * this->images.walls.pushed(s, d) + d] += of_pair[d];
      }
    });
    for (int d = 0; d < D; d++) f(i, d) += force[d];
    if (!SUMS) return;
    for (int d = 0; d < D && friction; d++) friction[D * i + d] = rubbing[d];
    sums[ARTIFICIAL] += by.artificial;
    sums[LAMINAR] += by.laminar;
    sums[WALLS] += by.walls;
    for (int k = 0; k < 6; k++) sums[VIRIAL + k] += by.virial[k];
  }

 private:
  // Of a pair that is not far. down: gravity along hydrostatic walls, or null; rubbing: what
  // friction adds up to, or null
  template <int WITH>
  KOKKOS_FORCEINLINE_FUNCTION bool
  find(const ArtificialViscosity &artificial, const LaminarViscosity<D> &viscous, int i,
       const Particle<double, D> &pi, int j, const Point<D> &at_j, const Mirror &mirror,
       const double (*down)[D], double (&force)[D], double *rubbing, Powers<double> &by) const
  {
    const FluidParticles &in = this->in;
    const Particle<double, D> original(at_j);
    Particle<double, D> pj(original);
    if (WITH & Flag::IMAGES) pj.reflect(mirror);
    if (this->is_far(pi, pj)) return false;
    const RowConstants constant =
        constants_of_row<D, WITH_FLUID, WITH>(in, laws, i, in.type[i], in.type[j]);
    Between<double, D> m;
    relate<double, K, WITH_FLUID, WITH>(this->kernel, in, constant, i, pi, pj, &j, 1.0, m);
    m.share = 0.5;
    double p = shared_pressure<double, WITH_FLUID, D>(pi, pj, original.x, constant.extrapolate,
                                                      constant.floor, 1.0, false);
    if (down) p += pressure_below<double, WITH, D>(*down, pi, pj, m, by);
    double on_j[D], coupling[D], friction[D], friction_j[D], coupled;
    push<double, WITH_FLUID, WITH>(artificial, laws, constant, pi, pj, p, m, force, coupling,
                                   friction, coupled, by);
    react<double, WITH_FLUID, WITH>(viscous, laws, mirror, pi, pj, original.v, &j, constant, m,
                                    force, on_j, friction, friction_j, by);
    if (SUMS) account<double, WITH_FLUID, WITH>(m, force, pj.v, coupled, by);
    for (int d = 0; d < D && rubbing; d++) rubbing[d] += friction[d];
    return true;
  }
};

}    // namespace LAMMPS_NS::FSI

#endif
