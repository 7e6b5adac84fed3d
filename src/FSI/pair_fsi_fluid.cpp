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

#include "pair_fsi_fluid.h"

#include "atom.h"
#include "comm.h"
#include "compute_fsi_force.h"
#include "error.h"
#include "fix_fsi.h"
#include "fix_fsi_stress.h"
#include "force.h"
#include "fsi_contact.h"
#include "fsi_density_diffusion.h"
#include "fsi_kernel.h"
#include "fsi_shift.h"
#include "fsi_tensor.h"
#include "fsi_viscosity_artificial.h"
#include "fsi_viscosity_laminar.h"
#include "modify.h"
#include "neigh_list.h"
#include "neighbor.h"
#include "update.h"

#include <cmath>
#include <cstring>
#include <type_traits>
#include <utility>

using namespace LAMMPS_NS;
using namespace FSI;

/* ---------------------------------------------------------------------- */

PairFSIFluid::PairFSIFluid(LAMMPS *lmp) :
    PairFSI(lmp, "fsi/fluid"), mixed(false), near_step(-1), force_loop(nullptr), rate_loop(nullptr)
{
  keywords.key("sound").number(sound, 0.0, Range::above(0.0));
  keywords.key("eos").choice(tait, 0, {"linear", "tait"});
  artificial_row("fluid");
  keywords.key("laminar/visc").set(laminar, PLAIN).effect("laminar viscosity");
  keywords.key("laminar/visc/central").set(laminar, CENTRAL);
  keywords.key("density/diffusion").number(delta, 0.0, Range::from(0.0)).effect("density diffusion {}");
  keywords.key("shift").number(shifting, 0.0, Range::between(0.0, 1.0)).effect("particle shifting {}");
  keywords.key("surface")
      .number(surface_ratio, 0.0, Range::from_to_below(0.0, 1.0), "ratio")
      .choice(surface_max, 0, {"bulk", "max"}, "reference")
      .effect("free surface where psi is below {}");
  keywords.key("tension").logical(tension, false).effect("tension in the fluid");
  keywords.key("background").number(background, 0.0).effect("background pressure {}");
  keywords.key("couple").choice(couple, WALL, {"wall", "pressure", "full"});
  keywords.key("extrapolate").logical(extrapolate, false);
}

void PairFSIFluid::check_settings()
{
  if (sound == 0.0) error->all(FLERR, "Pair style fsi/fluid needs keyword sound with a speed of sound > 0");
}

/* ---------------------------------------------------------------------- */

bool PairFSIFluid::handles(int a, int b) const
{
  return a == FLUID || b == FLUID;
}

/* ---------------------------------------------------------------------- */

State PairFSIFluid::make_state(const Material &m) const
{
  // a solid's state is that of pair_style fsi/solid, if there is one: it enters its own afterwards
  if (m.species == SOLID) return solid_state(m, false);
  State s;
  s.species = m.species;
  s.rho0 = m.rho0;
  s.c = sound;
  s.csq = sound * sound;
  if (m.species == RIGID) {
    // its density is what says its pressure, its volume should be that of fluid under this pressure
    for (const auto &other : material)
      if (other.species == FLUID) s.csq = sound * sound * other.rho0 / m.rho0;
  } else
    s.tait = tait;
  s.inv_csq = 1.0 / s.csq;
  s.p0 = background;
  if (!tension) s.floor = 0.0;
  s.viscosity = m.viscosity;
  return s;
}

/* ----------------------------------------------------------------------
   choose the loops for kernel, dimension and the effects that the script names
------------------------------------------------------------------------- */

void PairFSIFluid::init_style()
{
  PairFSI::init_style();
  if (delta > 0.0 && hub->density_fluid != FixFSI::CONTINUITY)
    error->all(FLERR, "Pair style fsi/fluid density/diffusion requires fix fsi with fluid continuity");
  if (shifting > 0.0 && hub->density_fluid != FixFSI::CONTINUITY)
    error->all(FLERR, "Pair style fsi/fluid shift requires fix fsi with fluid continuity");
  if (laminar) {
    bool any = false;
    for (const auto &m : material) any = any || m.viscosity > 0.0;
    if (!any && comm->me == 0)
      error->warning(FLERR, "Pair style fsi/fluid laminar/visc has nothing to act on: no fluid has a viscosity");
  }
  force_computes.clear();
  for (auto *compute : modify->get_compute_by_style("^fsi/force$")) force_computes.push_back(dynamic_cast<ComputeFSIForce *>(compute));
  if (extrapolate && (couple != WALL || !has_solids()) && comm->me == 0)
    error->warning(FLERR, "Pair style fsi/fluid extrapolate has nothing to act on: {}",
                   has_solids() ? "it is for couple wall" : "there is no solid");
  with_kernel(hub->kernel, hub->dim, hub->h, [&](const auto &k) { select<std::decay_t<decltype(k)>>(); });
}

/* ---------------------------------------------------------------------- */

template <class K> void PairFSIFluid::select()
{
  const bool walls = !modify->get_fix_by_style("^fsi/wall/mirror$").empty();
  const bool ledger = !modify->get_compute_by_style("^fsi/energy$").empty();
  int fluids = 0, solids = 0;
  for (const auto &m : material) {
    if (m.species == FLUID) fluids++;
    if (m.species == SOLID || m.species == RIGID) solids++;
  }
  mixed = solids > 0 || fluids > 1;

  const int flags = (has_artificial() ? ARTIFICIAL : 0) | (laminar ? LAMINAR : 0) | (walls ? MIRROR : 0) |
      (solids ? SOLIDS : 0) | (ledger ? LEDGER : 0);
  const int rflags = (delta > 0.0 ? DIFFUSION : 0) | (walls ? IMAGES : 0) | (mixed ? MIXED : 0) |
      (ledger ? TALLY : 0) | (shifting > 0.0 ? SHIFT : 0);

  pick_force<K>(flags, std::make_integer_sequence<int, NFORCE>());
  pick_rate<K>(rflags, std::make_integer_sequence<int, NRATE>());
}

template <class K, int... F> void PairFSIFluid::pick_force(int flags, std::integer_sequence<int, F...>)
{
  using Loop = void (PairFSIFluid::*)();
  static constexpr Loop table[] = {&PairFSIFluid::force_pairs<K, F>...};
  force_loop = table[flags];
}

template <class K, int... F> void PairFSIFluid::pick_rate(int flags, std::integer_sequence<int, F...>)
{
  using Loop = void (PairFSIFluid::*)(double);
  static constexpr Loop table[] = {&PairFSIFluid::rate_pairs<K, F>...};
  rate_loop = table[flags];
}

/* ---------------------------------------------------------------------- */

void PairFSIFluid::density_rate(double dt)
{
  (this->*rate_loop)(dt);
}

/* ---------------------------------------------------------------------- */

template <int D, class Rest> Point<D> *PairFSIFluid::gather(double t, Rest rest)
{
  constexpr size_t SIZE = sizeof(Point<D>) / sizeof(double);
  const int nall = atom->nlocal + atom->nghost;
  if (points.size() < nall * SIZE) points.resize(atom->nmax * SIZE);
  auto *const point = reinterpret_cast<Point<D> *>(points.data());
  const auto *const x = FixFSI::rows(atom->x), *const v = FixFSI::rows(atom->v);
  const double *const rho = atom->rho, *const rmass = atom->rmass;
  for (int i = 0; i < nall; i++) {
    Point<D> &p = point[i];
    for (int d = 0; d < D; d++) {
      p.v[d] = v[i][d];
      p.x[d] = x[i][d] + t * p.v[d];
    }
    p.rho = rho[i];
    p.vol = rmass[i] / p.rho;
    rest(i, p);
  }
  return point;
}

/* ----------------------------------------------------------------------
   rows of one fluid, which loops take four pairs at a time, and the others; all are others with newton off, with bonds of other
   styles, and where the processor cannot
------------------------------------------------------------------------- */

void PairFSIFluid::find_rows()
{
  if (neighbor->ago > 0) return;
  near_step = -1;
  const int *const type = atom->type;
  const bool can = have_packs() && force->newton_pair && atom->molecular == Atom::ATOMIC;
  rows.clear();
  other_rows.clear();
  for (int ii = 0; ii < list->inum; ii++) {
    const int i = list->ilist[ii];
    bool pure = can && hub->state[type[i]].species == FLUID;
    if (mixed)
      for (int jj = 0; jj < list->numneigh[i] && pure; jj++) pure = type[list->firstneigh[i][jj] & NEIGHMASK] == type[i];
    (pure ? rows : other_rows).push_back(i);
  }
}

/* ----------------------------------------------------------------------
   calls f(i, j, reflection, rsq, x_i - M x_j) for the images M x_j of what is near walls with i in these rows: with j = i for the
   own images of a fluid particle, and, if pairs, for those of its neighbours; position(i) says where particles are
------------------------------------------------------------------------- */

template <class Position, class F>
void PairFSIFluid::for_images(const std::vector<int> &which, bool pairs, const Walls &walls, double cutsq, Position position, F f) const
{
  const int *const wmask = hub->wmask;
  for (const int i : which) {
    if (!wmask[i]) continue;
    const std::array<double, 3> xi = position(i);
    int j = i;
    const auto image = [&](const Walls::Reflection &s, double rsq, const double *dx) { f(i, j, s, rsq, dx); };
    if (hub->state[atom->type[i]].species == FLUID) walls.images(wmask[i], 0.0, xi.data(), xi.data(), cutsq, image);
    for (int jj = 0; jj < list->numneigh[i] && pairs; jj++) {
      j = list->firstneigh[i][jj] & NEIGHMASK;
      const int both = wmask[i] & wmask[j];
      if (!both) continue;
      const std::array<double, 3> xj = position(j);
      double rsq = 0.0;
      for (int d = 0; d < 3; d++) rsq += (xi[d] - xj[d]) * (xi[d] - xj[d]);
      if (rsq < cutsq) walls.images(both, rsq, xi.data(), xj.data(), cutsq, image);
    }
  }
}

/* ---------------------------------------------------------------------- */

const std::vector<int> &PairFSIFluid::near_walls()
{
  if (near_step != update->ntimestep) {
    near_step = update->ntimestep;
    near.clear();
    if (hub->wmask)
      for (const int i : rows)
        if (hub->wmask[i]) near.push_back(i);
  }
  return near;
}

/* ----------------------------------------------------------------------
   calls f(reflection, rows) with those of some rows that have images in it
------------------------------------------------------------------------- */

template <class F> void PairFSIFluid::for_reflections(const std::vector<int> &near, const Walls &walls, F f) const
{
  std::vector<int> some;
  for (const auto &s : walls.reflections) {
    some.clear();
    for (const int i : near)
      if ((hub->wmask[i] & s.mask) == s.mask) some.push_back(i);
    f(s, Rows{some, list->numneigh, list->firstneigh});
  }
}

/* ----------------------------------------------------------------------
   continuity: d rho_i/dt = m_i sum_j v_ij.grad_i W_ij, the rate of m_i psi_i (paper eqs. 8 and 12), which makes the work of
   the pair force -(p_i V_i^2 + p_j V_j^2) grad_i W_ij that of the pressures. Positions are those of time n, half a step
   before atom->x, where the velocities belong: the density leapfrogs from n-1/2 to n+1/2, second order in time.
   Solids count in the sums of shifting, but are not shifted.
------------------------------------------------------------------------- */

template <class K, int FLAGS> void PairFSIFluid::rate_pairs(double dt)
{
  constexpr int D = K::DIM;
  const K kernel(hub->h);
  const double dth = 0.5 * dt;
  double **x = atom->x;
  double **v = atom->v;
  const int *const type = atom->type;
  const int nlocal = atom->nlocal;
  const bool newton = force->newton_pair;
  double *const rate = hub->rate;
  const State *const state = hub->state.data();
  const Walls walls = (FLAGS & IMAGES) ? hub->walls.moved(-dth) : Walls();
  const DensityDiffusion diffusion(delta, hub->h, sound, hub->gravity);
  const Shift<D> shift(hub->wdx);
  double *const *const sums = hub->shift;
  Point<D> *const point = gather<D>(-dth, [&](int i, Point<D> &p) {
    // who has pressure: without it on either side nothing is hydrostatic, and diffusion would push apart particles that fly free
    if (!(FLAGS & DIFFUSION)) return;
    const State &s = state[type[i]];
    p.p = s.pressure(p.rho) > s.floor ? 1.0 : 0.0;
    p.pv2 = diffusion.hydrostatic(p.position(x[i]).data(), s.rho0 * s.inv_csq);
  });

  const auto pair = [&](int i, int j, const Point<D> &pi, const Point<D> &pj, const double *xij, const double *vij, double rsq,
                        double share, double &rate_i) {
    const double g = kernel.gradient(std::sqrt(rsq));
    const double s = g * (vij[0] * xij[0] + vij[1] * xij[1] + (D == 3 ? vij[2] * xij[2] : 0.0));
    double ri = pi.rho * pi.vol * s, rj = pj.rho * pj.vol * s;
    if ((FLAGS & DIFFUSION) && (!(FLAGS & MIXED) || (type[i] == type[j]))) {
      const double k = diffusion(pi.rho, pj.rho, greater(pi.p, pj.p) * (pi.pv2 - pj.pv2), g);
      ri += k * pj.vol;
      rj -= k * pi.vol;
      if (FLAGS & TALLY) {
        // m p/rho^2 of what diffusion adds to rho
        hub->tally(FixFSI::DIFFUSION,
                   -share * k * pi.vol * pj.vol * (hub->pressure(i) / pi.rho - hub->pressure(j) / pj.rho));
      }
    }
    rate_i += ri;
    return rj;
  };
  const auto shift_pair = [&](int i, int j, double rsq, const double *xij, const double *xji) {
    const double r = std::sqrt(rsq), g = kernel.gradient(r), w = kernel.W(r);
    shift.add(sums[i], point[j].vol, g, w, rsq, xij);
    shift.add(sums[j], point[i].vol, g, w, rsq, xji);
  };

  const auto row = [&](int i) {
    const int *const jlist = list->firstneigh[i];
    const int jnum = list->numneigh[i];
    const Point<D> pi = point[i];
    double rate_i = 0.0;
    for (int jj = 0; jj < jnum; jj++) {
      const int j = jlist[jj] & NEIGHMASK;
      const Point<D> &pj = point[j];
      const double xij[3] = {pi.x[0] - pj.x[0], pi.x[1] - pj.x[1], D == 3 ? pi.x[D - 1] - pj.x[D - 1] : 0.0};
      const double rsq = xij[0] * xij[0] + xij[1] * xij[1] + (D == 3 ? xij[2] * xij[2] : 0.0);
      if (rsq >= kernel.cutsq) continue;
      const double vij[3] = {pi.v[0] - pj.v[0], pi.v[1] - pj.v[1], D == 3 ? pi.v[D - 1] - pj.v[D - 1] : 0.0};
      // without newton a pair across ranks is computed on both: each counts half of its energy
      const double share = (newton || j < nlocal) ? 1.0 : 0.5;
      rate[j] += pair(i, j, pi, pj, xij, vij, rsq, share, rate_i);
      if (FLAGS & SHIFT) {
        const double xji[3] = {-xij[0], -xij[1], -xij[2]};
        shift_pair(i, j, rsq, xij, xji);
      }
    }
    rate[i] += rate_i;
  };
  const auto image = [&](int i, int j, const Walls::Reflection &s, double rsq, const double *x_image) {
    double vij[3];
    walls.reflect_velocity(s, v[j], false, vij);
    for (int d = 0; d < 3; d++) vij[d] = v[i][d] - vij[d];
    if (j == i) {
      const double g = kernel.gradient(std::sqrt(rsq));
      rate[i] += point[i].rho * point[i].vol * g * (vij[0] * x_image[0] + vij[1] * x_image[1] + (D == 3 ? vij[2] * x_image[2] : 0.0));
      if (FLAGS & SHIFT) shift.add(sums[i], point[i].vol, g, kernel.W(std::sqrt(rsq)), rsq, x_image);
      return;
    }
    rate[j] += pair(i, j, point[i], point[j], x_image, vij, rsq, (newton || j < nlocal) ? 1.0 : 0.5, rate[i]);
    if (FLAGS & SHIFT) {
      double xji[3] = {-x_image[0], -x_image[1], -x_image[2]};
      walls.reflect_vector(s, xji);
      shift_pair(i, j, rsq, x_image, xji);
    }
  };

  find_rows();
  const std::vector<int> &near = near_walls();
  bool packed_images = false;
  for (const int i : other_rows) row(i);
#if FSI_PACKS
  if constexpr (!(FLAGS & (TALLY | SHIFT))) {
    packed_images = !walls.finite();
    rate_rows<K, (FLAGS & DIFFUSION) != 0, false>({rows, list->numneigh, list->firstneigh}, Mirror(), kernel, diffusion, point, rate);
    if ((FLAGS & IMAGES) && packed_images)
      for_reflections(near, walls, [&](const Walls::Reflection &s, const Rows &some) {
        rate_rows<K, (FLAGS & DIFFUSION) != 0, true>(some, Mirror(walls, s), kernel, diffusion, point, rate);
      });
  } else
#endif
    for (const int i : rows) row(i);
  if (FLAGS & IMAGES) {
    const auto position = [&](int i) { return point[i].position(x[i]); };
    for_images(near, !packed_images, walls, kernel.cutsq, position, image);
    for_images(other_rows, true, walls, kernel.cutsq, position, image);
  }
}

/* ---------------------------------------------------------------------- */

void PairFSIFluid::displacements(double dt)
{
  const int *const type = atom->type;
  double *const *const sums = hub->shift;
  for (int i = 0; i < atom->nlocal; i++) {
    const State &s = hub->state[type[i]];
    if (s.species != FLUID) continue;
    const double reach = shifting * s.c * dt;
    if (hub->dim == 2) Shift<2>::displacement(sums[i], reach * hub->h, 0.25 * reach);
    else Shift<3>::displacement(sums[i], reach * hub->h, 0.25 * reach);
  }
}

/* ---------------------------------------------------------------------- */

// sums of what depends on the distance of a pair, walls' images included: collect(i, j, sum) for both of a pair, collect(i, i, sum)
// for the own images of i
template <class Term, class Collect> void PairFSIFluid::distance_sums(bool pairs_of_rows, Term term, Collect collect)
{
  const auto *const x = FixFSI::rows(atom->x);
  find_rows();
  with_kernel(hub->kernel, hub->dim, hub->h, [&](const auto &kernel) {
    const auto all_pairs = [&](const std::vector<int> &which) {
      for (const int i : which)
        for (int jj = 0; jj < list->numneigh[i]; jj++) {
          const int j = list->firstneigh[i][jj] & NEIGHMASK;
          double rsq = 0.0;
          for (int d = 0; d < 3; d++) rsq += (x[i][d] - x[j][d]) * (x[i][d] - x[j][d]);
          if (rsq >= kernel.cutsq) continue;
          const double s = term(kernel, rsq);
          collect(i, j, s);
          collect(j, i, s);
        }
    };
    all_pairs(other_rows);
    if (pairs_of_rows) all_pairs(rows);
    if (hub->wmask)
      for (const auto *which : {&rows, &other_rows})
        for_images(*which, true, hub->walls, kernel.cutsq, [x](int i) { return std::array<double, 3>{x[i][0], x[i][1], x[i][2]}; },
                   [&](int i, int j, const Walls::Reflection &, double rsq, const double *) {
                     const double s = term(kernel, rsq);
                     collect(i, j, s);
                     if (j != i) collect(j, i, s);
                   });
  });
}

void PairFSIFluid::number_density(double *psi, bool solids_too)
{
  const int *const type = atom->type;
  const State *const state = hub->state.data();
  distance_sums(!FSI_PACKS, [](const auto &kernel, double rsq) { return kernel.W(std::sqrt(rsq)); },
                [&](int i, int, double s) {
                  if (solids_too || state[type[i]].species == FLUID) psi[i] += s;
                });
#if FSI_PACKS
  with_kernel(hub->kernel, hub->dim, hub->h,
              [&](const auto &kernel) { density_rows({rows, list->numneigh, list->firstneigh}, kernel, FixFSI::rows(atom->x), psi); });
#endif
}

void PairFSIFluid::position_divergence(double *div)
{
  const double *const rho = atom->rho;
  const double *const rmass = atom->rmass;
  distance_sums(true, [](const auto &kernel, double rsq) { return -rsq * kernel.gradient(std::sqrt(rsq)); },
                [&](int i, int j, double s) { div[i] += s * rmass[j] / rho[j]; });
}

/* ---------------------------------------------------------------------- */

void PairFSIFluid::compute(int eflag, int vflag)
{
  const Phase phase(hub->profile, Profile::FLUID);
  ev_init(eflag, vflag);
  check_tally();

  for (auto *measure : force_computes) measure->tally(-1.0);
  (this->*force_loop)();
  for (auto *measure : force_computes) measure->tally(1.0);

  if (vflag_fdotr) virial_fdotr_compute();
}

/* ----------------------------------------------------------------------
   F_ij = -(p_i V_i^2 + p_j V_j^2 + Q_ij) grad_i W_ij + laminar viscosity (paper eq. 14), antisymmetric
   between fluid and solid:
     couple wall      both pressures are the fluid's: the solid is a moving wall to the fluid and takes the reaction
     couple pressure  pressures of both, no suction
     couple full      the whole stress of the solid crosses, as in the paper
------------------------------------------------------------------------- */

template <class K, int FLAGS> void PairFSIFluid::force_pairs()
{
  constexpr int D = K::DIM;
  const K kernel(hub->h);
  double **x = atom->x;
  double **v = atom->v;
  auto *const f = FixFSI::rows(atom->f);
  const int *const type = atom->type;
  const int nlocal = atom->nlocal;
  const bool newton = force->newton_pair;
  const bool tally_pairs = evflag && !vflag_fdotr;    // newton off, or a hybrid style with solids that need it
  const State *const state = hub->state.data();
  const Walls &walls = hub->walls;
  const bool surface_rule = surface_ratio > 0.0;
  Point<D> *const a = gather<D>(0.0, [&](int i, Point<D> &p) {
    const State &s = state[type[i]];
    p.p = surface_rule ? hub->pressure(i) : s.pressure(p.rho);
    p.pv2 = p.p * p.vol * p.vol;
  });
  const ArtificialViscosity artificial(alpha, beta, hub->h);
  const LaminarViscosity<D> viscous(hub->h, laminar == CENTRAL);
  const double *const gravity = hub->gravity;
  const double *const *const wall_velocity = hub->wall_velocity;
  const bool all_bodies = hub->density_solid == FixFSI::SUMMATION;

  // force of j on i without laminar viscosity; xij, vij may be those of an image of j
  const auto force_on_i = [&](int i, int j, const Point<D> &pi, const Point<D> &pj, double g, double rsq, const double *xij,
                              const double *vij, double share, double *fij) {
    const double vdotx = vij[0] * xij[0] + vij[1] * xij[1] + (D == 3 ? vij[2] * xij[2] : 0.0);
    double p = pi.pv2 + pj.pv2, c = sound;
    double shear[3] = {0.0, 0.0, 0.0};
    bool rubs = true;
    if ((FLAGS & SOLIDS) && state[type[i]].species != state[type[j]].species) {
      const State &si = state[type[i]], &sj = state[type[j]];
      const bool fluid_i = si.species == FLUID;
      const int nf = fluid_i ? i : j, ns = fluid_i ? j : i;
      c = si.c < sj.c ? si.c : sj.c;
      if (si.species == RIGID || sj.species == RIGID) {
        // the pressure of the wall is extrapolated already; the guard keeps out what has no pressure of its own
        const State &wall = state[type[ns]], &fluid = state[type[nf]];
        rubs = wall.noslip;
        if (rsq < wall.guard * wall.guard) {
          const double k = Contact(D, wall.guard)(rsq, fluid.rho0 * fluid.csq, fluid.rho0 * fluid.csq);
          for (int d = 0; d < D; d++) shear[d] = k * xij[d];
        }
      } else if (couple == WALL) {
        double pw = a[nf].p;
        if (extrapolate) {
          // hydrostatic difference from the fluid to the solid particle, also for images
          for (int d = 0; d < D; d++) pw += a[nf].rho * gravity[d] * (x[ns][d] - x[nf][d]);
          const double low = state[type[nf]].floor;
          if (pw < low) pw = low;
        }
        p = a[nf].pv2 + pw * a[ns].vol * a[ns].vol;
      } else if (couple == PRESSURE) {
        if (p < 0.0) p = 0.0;
      } else if (hub->fix_stress) {
        const auto s = Sym<D>::load(hub->fix_stress->stress[ns]);
        dot<D>(s, xij, shear);
        for (int d = 0; d < D; d++) shear[d] *= a[ns].vol * a[ns].vol * g;
      }
      if (FLAGS & LEDGER) {
        // beyond the compression of the fluid and, in density mode summation, of the solid
        double power = (p - a[nf].pv2 - (all_bodies && state[type[ns]].species == SOLID ? a[ns].pv2 : 0.0)) * g * vdotx;
        for (int d = 0; d < D; d++) power -= shear[d] * vij[d];
        hub->tally(FixFSI::COUPLING, share * power);
      }
    }
    if ((FLAGS & ARTIFICIAL) && rubs) {
      const double q = artificial(vdotx, rsq, 0.5 * (pi.rho + pj.rho), c, pi.vol * pj.vol);
      p += q;
      if (FLAGS & LEDGER) hub->tally(FixFSI::ARTIFICIAL, share * q * g * vdotx);
    }
    for (int d = 0; d < D; d++) fij[d] = -p * g * xij[d] + ((FLAGS & SOLIDS) ? shear[d] : 0.0);
  };

  // force on i and on j by each other's image; also adds to the force on the walls of the reflection
  const auto image_forces = [&](int i, int j, const Walls::Reflection &s, double rsq, const double *xij, double share,
                                double *fi, double *fj) {
    const double g = kernel.gradient(std::sqrt(rsq));
    double vimage[3], vij[3];
    walls.reflect_velocity(s, v[j], false, vimage);
    for (int d = 0; d < 3; d++) vij[d] = v[i][d] - vimage[d];
    double fij[3] = {0.0, 0.0, 0.0}, fji[3];
    force_on_i(i, j, a[i], a[j], g, rsq, xij, vij, fj ? share : 0.5 * share, fij);
    for (int d = 0; d < 3; d++) fji[d] = -fij[d];
    walls.reflect_vector(s, fji);
    if (FLAGS & LAMINAR) {
      const double visc = state[type[i]].viscosity + state[type[j]].viscosity, vv = a[i].vol * a[j].vol;
      walls.reflect_velocity(s, v[j], true, vimage);
      for (int d = 0; d < 3; d++) vij[d] = v[i][d] - vimage[d];
      double loss = 0.5 * viscous(g, rsq, visc, vv, xij, vij, fij);    // of both, each relative to the other's image
      double xji[3] = {-xij[0], -xij[1], -xij[2]};
      walls.reflect_vector(s, xji);
      walls.reflect_velocity(s, v[i], true, vimage);
      for (int d = 0; d < 3; d++) vij[d] = v[j][d] - vimage[d];
      loss += 0.5 * viscous(g, rsq, visc, vv, xji, vij, fji);
      if (FLAGS & LEDGER) hub->tally(FixFSI::LAMINAR, (fj ? 1.0 : 0.5) * share * loss);
    }
    for (int d = 0; d < D; d++) {
      fi[d] += fij[d];
      if (fj) fj[d] += fji[d];
      int w = s.w[0];
      for (int k = 1; k < s.n; k++)
        if (walls.wall[s.w[k]].axis == d) w = s.w[k];
      hub->add_wall_force(w, d, share * (fij[d] + (fj ? fji[d] : 0.0)));
    }
  };

  const auto row = [&](int i) {
    const int *const jlist = list->firstneigh[i];
    const int jnum = list->numneigh[i];
    const Point<D> pi = a[i];
    double fi[3] = {0.0, 0.0, 0.0};
    for (int jj = 0; jj < jnum; jj++) {
      const int j = jlist[jj] & NEIGHMASK;
      const Point<D> &pj = a[j];
      const double xij[3] = {pi.x[0] - pj.x[0], pi.x[1] - pj.x[1], D == 3 ? pi.x[D - 1] - pj.x[D - 1] : 0.0};
      const double rsq = xij[0] * xij[0] + xij[1] * xij[1] + (D == 3 ? xij[2] * xij[2] : 0.0);
      if (rsq >= kernel.cutsq) continue;
      const double g = kernel.gradient(std::sqrt(rsq));
      const double vij[3] = {pi.v[0] - pj.v[0], pi.v[1] - pj.v[1], D == 3 ? pi.v[D - 1] - pj.v[D - 1] : 0.0};
      // without newton a pair across ranks is computed on both: each counts half of wall forces and energies
      const double share = (newton || j < nlocal) ? 1.0 : 0.5;
      double fij[3];
      force_on_i(i, j, pi, pj, g, rsq, xij, vij, share, fij);
      if (FLAGS & LAMINAR) {
        const double visc = state[type[i]].viscosity + state[type[j]].viscosity, vv = pi.vol * pj.vol;
        double loss;
        if ((FLAGS & SOLIDS) && (state[type[i]].species == RIGID || state[type[j]].species == RIGID)) {
          // fluid beyond the wall, with the velocity extrapolated; none where it slips
          const double *const wi = state[type[i]].noslip ? wall_velocity[i] : pi.v, *const wj = state[type[j]].noslip ? wall_velocity[j] : pj.v;
          double vw[3], before[3] = {fij[0], fij[1], fij[2]};
          for (int d = 0; d < D; d++) vw[d] = wi[d] - wj[d];
          const bool noslip = state[type[i]].noslip || state[type[j]].noslip;
          loss = viscous(g, rsq, noslip ? 2.0 * visc : 0.0, vv, xij, vw, fij);
          if (FLAGS & LEDGER) {
            loss = 0.0;
            for (int d = 0; d < D; d++) loss -= (fij[d] - before[d]) * vij[d];
          }
        } else
          loss = viscous(g, rsq, visc, vv, xij, vij, fij);
        if (FLAGS & LEDGER) hub->tally(FixFSI::LAMINAR, share * loss);
      }
      if ((FLAGS & LEDGER) && (FLAGS & SOLIDS)) {
        // what wall particles are given: they are not in the sum of energies
        double power = 0.0;
        for (int d = 0; d < D; d++)
          power += fij[d] * ((state[type[i]].species == RIGID ? pi.v[d] : 0.0) - (state[type[j]].species == RIGID ? pj.v[d] : 0.0));
        hub->tally(FixFSI::WALLS, share * power);
      }
      for (int d = 0; d < D; d++) fi[d] += fij[d];
      if (newton || j < nlocal)
        for (int d = 0; d < D; d++) f[j][d] -= fij[d];
      if (tally_pairs)
        ev_tally_xyz(i, j, nlocal, newton, 0.0, 0.0, fij[0], fij[1], D == 3 ? fij[2] : 0.0, xij[0], xij[1], xij[2]);
    }
    for (int d = 0; d < D; d++) f[i][d] += fi[d];
  };
  const auto image = [&](int i, int j, const Walls::Reflection &s, double rsq, const double *x_image) {
    if (j == i) {
      image_forces(i, i, s, rsq, x_image, 1.0, f[i], nullptr);
      return;
    }
    const double share = (newton || j < nlocal) ? 1.0 : 0.5;
    double fj[3] = {0.0, 0.0, 0.0};
    if ((FLAGS & SOLIDS) && state[type[j]].species == SOLID) {
      // a solid's stress is that of the particle, not of its image: look from the solid
      double from_j[3] = {-x_image[0], -x_image[1], -x_image[2]};
      walls.reflect_vector(s, from_j);
      image_forces(j, i, s, rsq, from_j, share, fj, f[i]);
    } else
      image_forces(i, j, s, rsq, x_image, share, f[i], fj);
    if (newton || j < nlocal)
      for (int d = 0; d < D; d++) f[j][d] += fj[d];
  };

  find_rows();
  const std::vector<int> &near = near_walls();
  bool packed_images = false;
  for (const int i : other_rows) row(i);
#if FSI_PACKS
  if (!(FLAGS & LEDGER) && !tally_pairs) {
    packed_images = !(FLAGS & LAMINAR) && !walls.finite();
    constexpr int ROW = row_of_forces(D);
    if (ROW > 3) forces.assign((size_t) ROW * (nlocal + atom->nghost), 0.0);
    auto *const sums = reinterpret_cast<double(*)[ROW]>(ROW > 3 ? forces.data() : atom->f[0]);
    const auto forces_of = [&](auto images, const Rows &which, const Mirror &mirror, double *total) {
      force_rows<K, (FLAGS & ARTIFICIAL) != 0, (FLAGS & LAMINAR) != 0, decltype(images)::value>(
          which, mirror, kernel, artificial, sound, viscous, state, type, a, sums, total);
    };
    forces_of(std::false_type(), {rows, list->numneigh, list->firstneigh}, Mirror(), nullptr);
    if constexpr ((FLAGS & MIRROR) && !(FLAGS & LAMINAR))
      if (packed_images)
        for_reflections(near, walls, [&](const Walls::Reflection &s, const Rows &some) {
          double total[3] = {0.0, 0.0, 0.0};
          forces_of(std::true_type(), some, Mirror(walls, s), total);
          // of both particles of a pair: what is along the wall cancels, what is normal to it doubles
          for (int k = 0; k < s.n; k++) {
            const int axis = walls.wall[s.w[k]].axis;
            hub->add_wall_force(s.w[k], axis, 2.0 * total[axis]);
          }
        });
    if (ROW > 3)
      for (int i = 0; i < nlocal + atom->nghost; i++)
        for (int d = 0; d < D; d++) f[i][d] += sums[i][d];
  } else
#endif
    for (const int i : rows) row(i);
  if (FLAGS & MIRROR) {
    const auto position = [&](int i) { return a[i].position(x[i]); };
    for_images(near, !packed_images, walls, kernel.cutsq, position, image);
    for_images(other_rows, true, walls, kernel.cutsq, position, image);
  }
}

/* ---------------------------------------------------------------------- */

bool PairFSIFluid::has_solids() const
{
  for (const auto &m : material)
    if (m.species == SOLID) return true;
  return false;
}

/* ---------------------------------------------------------------------- */

std::vector<PairFSI::Effect> PairFSIFluid::effects() const
{
  static const char *const modes[] = {"wall", "pressure", "full"};
  auto list = keywords.effects();
  list.push_back({fmt::format("coupling of fluid and solid: {}{}", modes[couple], extrapolate ? ", extrapolated" : ""), "couple", has_solids()});
  return list;
}

/* ---------------------------------------------------------------------- */

double PairFSIFluid::memory_usage()
{
  return (double) (points.capacity() + forces.capacity()) * sizeof(double) + (double) (rows.capacity() + other_rows.capacity()) * sizeof(int);
}
