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

// The loops of pair_style fsi/fluid over pairs: what they read and write, and the choice among them
// by kernel and dimension.
//
// Pairs come as rows: a fluid particle i and neighbors j of one atom type, so that whatever depends
// on types is constant in a row. The images of neighbors in a mirror wall are rows of their own.
// One text serves numbers one by one and several side by side (fsi_pack.h); for several it is
// compiled once per kernel (fsi_fluid_loops_*.cpp), one by one for all (fsi_fluid_rows.cpp).

#ifndef LMP_FSI_FLUID_LOOPS_H
#define LMP_FSI_FLUID_LOOPS_H

#include "fsi_material.h"
#include "fsi_pair_laws.h"
#include "fsi_rows.h"
#include "fsi_walls.h"

#include <array>
#include <memory>
#include <vector>

namespace LAMMPS_NS::FSI {

// What a fluid particle meets, and by which rule: couple wall; couple full, the paper's
enum PairKind { WITH_FLUID, WITH_WALL, WITH_SOLID, WITH_SOLID_FULL };
constexpr bool with_solid(int kind)
{
  return kind == WITH_SOLID || kind == WITH_SOLID_FULL;
}

// The form of laminar viscosity
enum Laminar { NO_LAMINAR, PLAIN_LAMINAR, CENTRAL_LAMINAR };

// What a loop needs of a particle, side by side (in 2D a cache line).
template <int D> struct Point {
  double x[D], v[D], rho, vol;
  // force loop: pressure, p V^2; rate loop: 1 where there is pressure, else 0, and the
  // hydrostatic part of the density
  double p, pv2;

  // of an atom, where it is a time t later
  FSI_INLINE void place(const double *atom_x, const double *atom_v, double t)
  {
    for (int d = 0; d < D; d++) {
      v[d] = atom_v[d];
      x[d] = atom_x[d] + t * v[d];
    }
  }
  FSI_INLINE void fill(double density, double mass)
  {
    rho = density;
    vol = mass / rho;
  }
  // what forces read
  FSI_INLINE void press(double pressure)
  {
    p = pressure;
    pv2 = p * vol * vol;
  }
  // What density diffusion reads; z: of the atom, in 2D. Diffusion smooths pressures, so both of
  // a pair must have one. What has none, spray and surfaces, has the density that its few
  // neighbors leave: their exchange would empty the spray, beyond zero, and take volume from the
  // rest.
  FSI_INLINE void diffuse(double delta, const State &s, const double *gravity, double z)
  {
    constexpr double NONE = 1.0e-12;    // round-off of a fluid at rest without pressure
    p = pv2 = 0.0;
    if (delta == 0.0) return;
    const double at[3] = {x[0], x[1], D == 3 ? x[D - 1] : z};
    p = s.pressure(rho) - s.floor > NONE * s.rho0 * s.csq ? 1.0 : 0.0;
    pv2 = DensityDiffusion::hydrostatic(gravity, at, s.rho0 * s.inv_csq);
  }
  std::array<double, 3> position(const double *atom_x) const
  {
    return {x[0], x[1], D == 3 ? x[D - 1] : atom_x[2]};
  }
};

// continuity: rho^{n+1/2} = rho^{n-1/2} + dt (d rho/dt)^n; rho >= m W(0), the density of an
// isolated particle: diffusion could make that of ejected spray negative. The rate becomes the
// one that was taken.
FSI_INLINE double next_density(double rho, double mass, double w0, double dt, double &rate)
{
  const double next = rho + dt * rate, alone = mass * w0;
  if (next < alone) rate = (alone - rho) / dt;    // what undo_advance() takes
  return next < alone ? alone : next;
}

// Powers that terms take from the particles of all pairs visited, the energy that the guard
// holds, and their virial xx yy zz xy xz yz; T: as a loop adds them up
template <class T> struct Powers {
  T artificial = 0.0, laminar = 0.0, coupling = 0.0, walls = 0.0, diffusion = 0.0, guard = 0.0,
    virial[6];
  FSI_INLINE Powers()
  {
    for (T &w : virial) w = 0.0;
  }
  template <class Number> FSI_INLINE void add(const Powers<Number> &by)
  {
    using L = Lanes<Number>;
    artificial += L::sum(by.artificial);
    laminar += L::sum(by.laminar);
    coupling += L::sum(by.coupling);
    walls += L::sum(by.walls);
    diffusion += L::sum(by.diffusion);
    guard += L::sum(by.guard);
    for (int k = 0; k < 6; k++) virial[k] += L::sum(by.virial[k]);
  }
};
struct PairSums : Powers<double> {};

// How particles of a type count at a fluid particle, if their spacing is another (theory.rst)
struct VolumeRatio {
  double volume = 1.0;     // of a particle of the lattice over that of the fluid particle
  double sharper = 0.0;    // e of Kernel::sharper_gradient(): negative where it is coarser
  bool thin = false;       // the body counts as if it went on behind, and under the pressure of the
                           // side that meets it
};

// By particle: by how much more thin bodies count (fsi_sight.h), in forces and in sums of W
struct Thin {
  const double *backfill = nullptr, *backfill_weight = nullptr;
};

// By particle: how much of solids is before mirror walls, and its rate (Walls::before)
struct Cut {
  const double *part = nullptr, *rate = nullptr;
};

// By pair: how much of it thin bodies leave, of the rows' neighbors from first on (fsi_sight.h);
// null: all
struct Visible {
  const double *part = nullptr;
  const int *first = nullptr;
};

// Of all loops: by local and ghost particle.
struct FluidParticles {
  const double *points = nullptr;    // Point<D>
  const int *type = nullptr;
  const State *state = nullptr;
  int nlocal = 0;
  const VolumeRatio *ratio = nullptr;    // per type
  bool unequal = false;                  // does any type differ from fluids in it?
  const Thin *thin = nullptr;            // null: none is
  const Cut *cut = nullptr;              // null: none is
  // else a pair across ranks is visited on both: each counts half of powers and forces on walls
  bool newton = false;
  Visible visible;    // of pairs of fluids, in loops pair by pair
  // Of fluids of several spacings: are these rows of two of them, whose kernel is that of the
  // mean spacing? In steps of shifting rows of one spacing are taken for such, too.
  bool unlike = false;
  // per particle: what is left of shifting's weight where it sees fluid of another spacing
  const double *fade = nullptr;
  // types of different spacing that are one fluid
  FSI_INLINE bool is_one_fluid(int a, int b) const
  {
    return ratio[b].volume != 1.0 && state[a].rho0 == state[b].rho0 && state[a].csq == state[b].csq;
  }
};

// Rows of pairs of a kind, and particles as their loop sees them
struct FluidPairs {
  PairKind kind;
  RowSpan rows;
  const Mirror *mirror;    // the rows' neighbors are images in it; null: they are not
  FluidParticles in;
};

struct RateLaws {
  double delta = 0.0;                               // of density diffusion; 0: none
  const double *pressure_over_density = nullptr;    // per particle, with sums; or null
  double wdx = 0.0;                                 // W(dx), for shifting
  WallShift wall_shift;
  bool fills = false;    // shifting: the fluid has no surface
  double reach = 0.0;
};

struct ForceLaws {
  double alpha = 0.0, beta = 0.0;    // artificial viscosity
  int laminar = NO_LAMINAR;
  double central_length_sq = 0.0;       // over h^2; 0: the plain form
  const double *viscosity = nullptr;    // per particle; null: that of its state
  // per type: gravity, by which the pressure at a solid is extrapolated to it; null: it is not
  const std::array<double, 3> *extrapolate = nullptr;
  // 1: the ledger holds a compressive energy of solids that couples (density summation), else 0
  double stored = 0.0;
  const struct Contact *guard = nullptr;    // per type: of walls and solids
  bool solids_slip = false;
  // per particle, that no-slip walls of particles and solids have in viscous forces
  const double (*wall_velocity)[3] = nullptr;
  // per particle, velocities of when those were found; null: those of the loop
  const double (*before)[3] = nullptr;
  // per particle, of solids (couple full); null: they have none
  const double *const *stress = nullptr;
  const std::array<double, 3> *gravity = nullptr;    // per type
  // with sums: adds to rows of row_of_points(D) the forces, with the sign of what they take, of
  // coupling and of friction; or null
  double *taken = nullptr;
};

class FluidLoops {
 public:
  virtual ~FluidLoops() = default;

  // adds m_i dpsi_i/dt, with density diffusion, to rate, and the sums of particle shifting, times
  // -V_i, to shift, rows of Shift<D>::row(laws.fills), where rates of neighbors are behind the
  // sums; shift, sums: or null; near: becomes the rows of what is within laws.reach, which are
  // the first of each row from then on, of images its only ones; or null
  virtual void rates(const FluidPairs &, const RateLaws &, double *rate, double *shift,
                     PairSums *sums, std::vector<Row> *near) const = 0;
  // adds pressure, viscosity and what keeps fluid out of walls to force, rows of
  // row_of_forces(D); of images the sum of the forces on all particles to total[D]
  virtual void forces(const FluidPairs &, const ForceLaws &, double *force, double *total,
                      PairSums *sums) const = 0;
  // adds the plain sums of particle shifting alone, times -V_i, to rows of Shift<D>::row(false)
  virtual void shifts(const FluidPairs &, double *shift) const = 0;
  // adds W_ij, by the neighbors' share, to sum, or with volumes V_j x_ji.grad_i W_ij; to that of
  // neighbors only if both
  virtual void distances(const FluidPairs &, bool both, const double (*x)[3], const double *vol,
                         double *sum) const = 0;
};

// an error of whoever asks for it
[[noreturn]] void no_such_loop(const char *what, int kind, int flags);
// packs: several pairs at a time, of all kinds but WITH_SOLID_FULL
std::shared_ptr<FluidLoops> make_fluid_loops(int kernel, int dim, double h, bool packs);
std::shared_ptr<FluidLoops> make_fluid_loops_cubic(int dim, double h);
std::shared_ptr<FluidLoops> make_fluid_loops_quintic(int dim, double h);
std::shared_ptr<FluidLoops> make_fluid_loops_wendland(int dim, double h);

}    // namespace LAMMPS_NS::FSI

#endif
