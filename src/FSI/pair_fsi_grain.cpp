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

#include "pair_fsi_grain.h"

#include "atom.h"
#include "error.h"
#include "fix_fsi.h"
#include "force.h"
#include "fsi_gather.h"
#include "fsi_gradient.h"
#include "fsi_hub.h"
#include "fsi_kernel.h"
#include "fsi_pair_laws.h"
#include "fsi_profile.h"
#include "fsi_refusals.h"
#include "fsi_rows.h"
#include "fsi_sight.h"
#include "memory.h"
#include "neigh_list.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace FSI;
using MathConst::MY_PI;

// Sums of V W times what the fluid has, x_ji over h: of one; of places; their moments, packed; of
// velocities; density, viscosity, pressure; of pressure times places; and of (h_j/h)^2
template <int D> struct Sums {
  enum { ONE, X, XX = X + D, V = XX + packed_size(D), RHO = V + D, ETA, P, PX, HH = PX + D };
  static constexpr int N = HH + 1;
};

PairFSIGrain::PairFSIGrain(LAMMPS *lmp) : Pair(lmp), least_floor(0.0)
{
  restartinfo = 1;      // there is nothing to keep, and a hybrid style keeps its names
  manybody_flag = 1;    // what a pair gives depends on all fluid around: no pairwise energy
  single_enable = 0;
  comm_forward = 3;
  comm_reverse = Sums<3>::N;
}

PairFSIGrain::~PairFSIGrain()
{
  if (!allocated) return;
  memory->destroy(setflag);
  memory->destroy(cutsq);
}

void PairFSIGrain::allocate()
{
  allocated = 1;
  const int n = atom->ntypes + 1;
  memory->create(setflag, n, n, "pair:setflag");
  memory->create(cutsq, n, n, "pair:cutsq");
  for (int i = 0; i < n; i++) std::fill_n(setflag[i], n, 0);
}

void PairFSIGrain::settings(int narg, char **arg)
{
  if (narg > 0) error->all(FLERR, "Pair style fsi/grain takes no arguments, but has {}", arg[0]);
  disc = nullptr;
}

void PairFSIGrain::coeff(int narg, char **arg)
{
  if (narg != 2)
    error->all(FLERR,
               "Pair_coeff of pair style fsi/grain takes the type of a fluid and that of grains "
               "alone{}",
               narg > 2 ? std::string(", but has ") + arg[2] : "");
  if (!allocated) allocate();
  int low, high, from, to;
  utils::bounds(FLERR, arg[0], 1, atom->ntypes, low, high, error);
  utils::bounds(FLERR, arg[1], 1, atom->ntypes, from, to, error);
  for (int i = low; i <= high; i++)
    for (int j = from; j <= to; j++) setflag[std::min(i, j)][std::max(i, j)] = 1;
  disc = nullptr;
}

void PairFSIGrain::init_style()
{
  if (!atom->style_match("fsi") || !atom->radius_flag)
    error->all(FLERR,
               "Pair style fsi/grain requires atom_style hybrid fsi sphere: grains have a radius");
  FixFSI::find(lmp, "Pair style fsi/grain")->link(disc, step, ledger, ghosts);
  if (!facts_of_fluids(lmp).style) refuse(error, Refused::GRAINS);
  neighbor->add_request(this);
}

double PairFSIGrain::init_one(int i, int j)
{
  if (setflag[i][j] == 0) error->all(FLERR, "All pair coeffs are not set: types {} and {}", i, j);
  const auto &state = disc->state;
  const int a = state[i].species, b = state[j].species;
  static const char *const words[] = {"no material", "a fluid", "a solid", "a wall"};
  if (std::min(a, b) != NONE || std::max(a, b) != FLUID)
    error->all(FLERR,
               "Pair_coeff of pair style fsi/grain: atom type {} has {} and type {} {}: expected a "
               "fluid and grains, which have none (NULL in pair_style fsi/fluid)",
               i, words[a], j, words[b]);
  if (state[a == NONE ? j : i].law.varies()) refuse(error, Refused::GRAINS_VISCOSITY);
  check_radii(a == NONE ? i : j);
  return disc->cut;
}

// one without a diameter has LAMMPS', 1: neighbor lists of contacts would be of all particles
void PairFSIGrain::check_radii(int type) const
{
  for (int k = 0; k < atom->nlocal; k++)
    if (atom->type[k] == type && atom->radius[k] > disc->cut)
      error->one(
          FLERR,
          "Pair style fsi/grain: atom {} of type {} has the diameter {:g}: expected grains "
          "smaller than the fluid's kernel, whose support is {:g}. Use set type {} diameter, "
          "after create_atoms",
          atom->tag[k], type, 2.0 * atom->radius[k], disc->cut, type);
}

std::vector<Part::Effect> PairFSIGrain::effects() const
{
  return {{"grains: pressure gradient and drag of Schiller and Naumann", "fsi/grain", true}};
}

// LAMMPS' contact goes by radii: between points as far apart as those of a wall grains fall through
void PairFSIGrain::find_idle(const Census &, const Idle &nothing) const
{
  const auto meets_grains = [this](const Pair *contact, int t) {
    for (int g = 1; g <= atom->ntypes; g++)
      if (disc->state[g].species == NONE && contact->setflag[std::min(g, t)][std::max(g, t)])
        return true;
    return false;
  };
  const Pair *contact, *last = nullptr;
  for (int k = 1; (contact = force->pair_match("^gran", 0, k)) != last; k++) {
    last = contact;    // the only one has all numbers
    for (int t = 1; t <= atom->ntypes && contact; t++) {
      if (!disc->state[t].is_body() || !meets_grains(contact, t)) continue;
      const auto points = find_particles(atom, world, [=](int i) {
        return atom->type[i] == t && atom->radius[i] == 0.0;
      });
      if (points.count)
        nothing(fmt::format("Contact of grains with type {}", t),
                fmt::format("{} of its particles have no diameter: set type {} diameter",
                            points.count, t));
    }
  }
}

void PairFSIGrain::compute(int eflag, int vflag)
{
  FixFSI::check_pre_no(lmp, disc);
  const Phase phase(step->profile, Profile::FLUID_FORCES);
  ev_init(eflag, vflag);
  find_grains();
  disc->dim == 2 ? sum_up<2>() : sum_up<3>();
  if (force->newton_pair) reverse_comm(step->profile, comm, this);
  disc->dim == 2 ? forces<2>() : forces<3>();
  forward_comm(step->profile, comm, this);
  disc->dim == 2 ? give_back<2>() : give_back<3>();
  if (vflag_fdotr) virial_fdotr_compute();
}

void PairFSIGrain::find_grains()
{
  const int nall = atom->nlocal + atom->nghost, dim = disc->dim;
  std::vector<char> is_grain(atom->ntypes + 1, 0);
  least_floor = 0.0;
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++)
      if (setflag[i][j])
        for (const int t : {i, j}) {
          const State &s = disc->state[t];
          is_grain[t] = s.species == NONE;
          if (s.species == FLUID) least_floor = std::min({least_floor, s.floor, -s.p0});
        }
  grains.clear();
  number.assign(nall, -1);
  for (int i = 0; i < nall; i++)
    if (is_grain[atom->type[i]]) {
      number[i] = grains.size();
      grains.push_back(i);
    }
  sums.assign(grains.size() * (dim == 2 ? Sums<2>::N : Sums<3>::N), 0.0);
  given.assign(grains.size() * dim, 0.0);
}

// Over the pairs of the neighbor list, in which either may be the grain, with the fluid's kernel,
// as far as no thin body or segment of a mirror wall is between them
template <int D> void PairFSIGrain::sum_up()
{
  const ChosenKernel kernel(disc->kernel, D, disc->h);
  using Of = Sums<D>;
  const auto *const v = vectors(atom->v);
  const double *const rmass = atom->rmass, *const rho = atom->rho;
  const int *const type = atom->type;
  Sight *const sight = disc->sight.get();
  std::vector<double> finer;    // h over that of a type
  for (const Resolution &of : disc->resolution) finer.push_back(of.h > 0.0 ? disc->h / of.h : 1.0);
  touches.clear();
  for (int ii = 0; ii < list->inum; ii++) {
    const int i = list->ilist[ii];
    const bool grain_first = number[i] >= 0;
    const double per_h = grain_first ? kernel.hinv : -kernel.hinv;    // from the grain to the fluid
    const Row row = {i, list->numneigh[i], list->firstneigh[i]};
    const bool looks = sight && row.n > 0 && sight->near(atom->x[i]);
    if (looks) sight->look_from(atom->x[i], kernel.cut);
    for_near(row, atom->x, D, kernel.cutsq, [&](int j, const double *d, double rsq) {
      const int g = grain_first ? i : j, f = grain_first ? j : i;
      const double fine = finer[type[f]], r = fine * std::sqrt(rsq);
      if (r >= kernel.cut) return;
      const double part = looks ? sight->visible(atom->x[j], kernel.cut) : 1.0;
      if (part == 0.0) return;
      const double w = part * rmass[f] / rho[f] * (D == 3 ? fine : 1.0) * fine * fine * kernel.W(r),
                   p = w * pressure_of(f, atom, *disc, *step);
      touches.push_back({f, g, w});
      double *const sum = &sums[(size_t) number[g] * Of::N];
      sum[Of::ONE] += w;
      sum[Of::RHO] += w * rho[f];
      sum[Of::ETA] += w * disc->state[type[f]].viscosity;
      sum[Of::P] += p;
      sum[Of::HH] += w / (fine * fine);
      double *moment = sum + Of::XX, x[D];
      for (int a = 0; a < D; a++) {
        x[a] = per_h * d[a];
        sum[Of::X + a] += w * x[a];
        sum[Of::V + a] += w * v[f][a];
        sum[Of::PX + a] += p * x[a];
        for (int b = 0; b <= a; b++) *moment++ += w * x[a] * x[b];
      }
    });
  }
}

// Pressure and its gradient at the grain are those of the plane that fits best, which walls and
// surfaces on one side do not bend. In 2D a grain is as many spheres to a unit of depth as have
// together the volume pi r^2: it sinks as one of them does.
static constexpr double WIDE = 0.1;    // variance of places over h^2; two, dx = h/4 apart: 0.016

template <int D> void PairFSIGrain::forces()
{
  using Of = Sums<D>;
  const auto *const v = vectors(atom->v);
  auto *const f = vectors(atom->f);
  for (size_t k = 0; k < grains.size(); k++) {
    const int i = grains[k];
    const double *const sum = &sums[k * Of::N];
    if (i >= atom->nlocal || sum[Of::ONE] <= 0.0) continue;
    const double r = atom->radius[i], spheres = D == 2 ? 0.75 / r : 1.0;
    const double volume = 4.0 / 3.0 * MY_PI * r * r * r * spheres, per = 1.0 / sum[Of::ONE];

    double moments[packed_size(D)], slope[D] = {}, C[D * D], steepness = 0.0;
    double p = per * sum[Of::P];
    for (int a = 0, n = 0; a < D; a++)
      for (int b = 0; b <= a; b++, n++)
        moments[n] = sum[Of::XX + n] - per * sum[Of::X + a] * sum[Of::X + b];
    faded_inverse<D>(moments, C, WIDE * sum[Of::HH]);
    for (int a = 0; a < D; a++) {
      for (int b = 0; b < D; b++) slope[a] += C[a * D + b] * (sum[Of::PX + b] - p * sum[Of::X + b]);
      steepness += slope[a] * slope[a];
    }
    for (int a = 0; a < D; a++) p -= per * slope[a] * sum[Of::X + a];
    const double hinv = 1.0 / disc->h;
    const double part = least_floor < 0.0 ? 1.0 : immersed_part(p, std::sqrt(steepness) * hinv, r);

    double u[D], speed = 0.0;
    for (int a = 0; a < D; a++) {
      u[a] = per * sum[Of::V + a] - v[i][a];
      speed += u[a] * u[a];
    }
    // fades where there is no more fluid than in the corner of a box
    const double drag = spheres * std::min(1.0, 4.0 * sum[Of::ONE]) *
        drag_of_sphere(per * sum[Of::RHO], per * sum[Of::ETA], 2.0 * r, std::sqrt(speed));
    check_step(i, drag, update->dt * force->ftm2v);
    for (int a = 0; a < D; a++) {
      const double F = drag * u[a] - part * volume * slope[a] * hinv;
      f[i][a] += F;
      given[k * D + a] = per * F;
    }
  }
}

// drag acts with the velocities of the start of a step, which must not turn around in it
void PairFSIGrain::check_step(int i, double drag, double dt) const
{
  if (drag * dt <= atom->rmass[i] || !is_moved(i, lmp)) return;
  error->one(
      FLERR,
      "Pair style fsi/grain: drag stops atom {} of type {}, radius {:g} and mass {:g} within "
      "a time of {:.3g}, but the time step is {:.3g}: expected a shorter time step or a "
      "larger grain",
      atom->tag[i], atom->type[i], atom->radius[i], atom->rmass[i],
      atom->rmass[i] / drag / force->ftm2v, update->dt);
}

template <int D> void PairFSIGrain::give_back()
{
  auto *const f = vectors(atom->f);
  const auto *const x = vectors(atom->x);
  const int nlocal = atom->nlocal, newton_pair = force->newton_pair;
  for (const Touch &touch : touches) {
    const int i = touch.fluid, g = touch.grain;
    double F[3] = {};
    for (int a = 0; a < D; a++) F[a] = -touch.weight * given[number[g] * D + a];
    if (newton_pair || i < nlocal)
      for (int a = 0; a < D; a++) f[i][a] += F[a];
    if (evflag)
      ev_tally_xyz(i, g, nlocal, newton_pair, 0.0, 0.0, F[0], F[1], F[2], x[i][0] - x[g][0],
                   x[i][1] - x[g][1], x[i][2] - x[g][2]);
  }
}

// the energy ledger is that of fluids and solids: what grains have taken, with velocities of the
// middle of the step
void PairFSIGrain::prescribe()
{
  if (!ledger->kept) return;
  const int dim = disc->dim, nlocal = atom->nlocal;
  const double half = 0.5 * update->dt * force->ftm2v;
  std::vector<double> on_fluid(nlocal + atom->nghost);
  double power = 0.0;
  for (int d = 0; d < dim; d++) {
    std::fill(on_fluid.begin(), on_fluid.end(), 0.0);
    for (const Touch &touch : touches)
      on_fluid[touch.fluid] += touch.weight * given[number[touch.grain] * dim + d];
    ghosts->add(on_fluid.data());
    for (int i = 0; i < nlocal; i++)
      if (on_fluid[i] != 0.0 && atom->mask[i] & disc->mover->groupbit)
        power += on_fluid[i] * (atom->v[i][d] + half * atom->f[i][d] / atom->rmass[i]);
  }
  ledger->tally(Ledger::COUPLING, power);
}

// of grains alone: sums come home, what they give goes to ghosts
int PairFSIGrain::pack_forward_comm(int n, int *listed, double *buf, int, int *)
{
  const int dim = disc->dim;
  double *const first = buf;
  for (int k = 0; k < n; k++)
    if (number[listed[k]] >= 0) buf = std::copy_n(&given[number[listed[k]] * dim], dim, buf);
  return buf - first;
}

void PairFSIGrain::unpack_forward_comm(int n, int first, double *buf)
{
  const int dim = disc->dim;
  for (int i = first; i < first + n; i++)
    if (number[i] >= 0) {
      std::copy_n(buf, dim, &given[number[i] * dim]);
      buf += dim;
    }
}

int PairFSIGrain::pack_reverse_comm(int n, int first, double *buf)
{
  const int row = disc->dim == 2 ? Sums<2>::N : Sums<3>::N;
  double *const begin = buf;
  for (int i = first; i < first + n; i++)
    if (number[i] >= 0) buf = std::copy_n(&sums[number[i] * row], row, buf);
  return buf - begin;
}

void PairFSIGrain::unpack_reverse_comm(int n, int *listed, double *buf)
{
  const int row = disc->dim == 2 ? Sums<2>::N : Sums<3>::N;
  for (int k = 0; k < n; k++)
    if (number[listed[k]] >= 0)
      for (int c = 0; c < row; c++) sums[number[listed[k]] * row + c] += *buf++;
}

double PairFSIGrain::memory_usage()
{
  return bytes_of(touches, grains, number, sums, given);
}

Facts PairFSIGrain::facts() const
{
  Facts facts;
  facts.style = Facts::OF_GRAINS;
  return facts;
}
