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

#include "fix_fsi_wall_particle.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "fix_fsi.h"
#include "fix_fsi_move.h"
#include "force.h"
#include "fsi_cells.h"
#include "fsi_find.h"
#include "fsi_gather.h"
#include "fsi_hub.h"
#include "fsi_kernel.h"
#include "fsi_keywords.h"
#include "fsi_preset.h"
#include "fsi_profile.h"
#include "fsi_record.h"
#include "fsi_rows.h"
#include "fsi_tensor.h"
#include "math_extra.h"
#include "modify.h"
#include "neighbor.h"
#include "pair_fsi_fluid.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace FSI;

static constexpr double AUTO = -1.0;
enum { AS_PRESET, MEAN, LINEAR };    // pressure

FixFSIWallParticle::FixFSIWallParticle(LAMMPS *lmp, int narg, char **arg) :
    FixFields(lmp, narg, arg, "fix fsi/wall/particle"), swaps(new Swaps(lmp))
{
  keywords.key("slip").logical(slip, true);
  keywords.key("pressure").choice(pressure, AS_PRESET, {"auto", "mean", "linear"});
  keywords.key("guard").number(guard, AUTO, Range::between(0.0, 1.0)).or_word("auto", AUTO);
  keywords.parse(narg - 3, arg + 3);
  scalar_flag = vector_flag = 1;
  size_vector = 3;
  extscalar = extvector = 1;
  global_freq = 1;
  fields.set("velocity of the last step", Fields::RESTART, true, before, 4);
  fields.set("velocity at the end of a run", Fields::ATOM, true, at_end, 3);
  register_fields();
  take_over(id);
  post_run();    // of what comes out of a restart file, too
}

// another one of this ID goes on with it
FixFSIWallParticle::~FixFSIWallParticle()
{
  follow_commands();
  hand_on(id, Record(lmp, style));
}

void FixFSIWallParticle::init()
{
  auto *const fix_fsi = FixFSI::find(lmp, "Fix fsi/wall/particle")->link(disc, step);
  const auto *fluid = first_of(pairs_of<PairFSIFluid>(lmp));
  if (!fluid)
    error->all(FLERR,
               "Fix fsi/wall/particle requires pair_style fsi/fluid: its walls are for fluids");

  enter_states(fix_fsi->disc.state, types_of_members());
  if (!slip && !fluid->has_laminar() && comm->me == 0)
    error->warning(FLERR,
                   "Fix fsi/wall/particle slip no has little to act on: pair_style fsi/fluid has "
                   "no laminar/visc");

  // A mean lacks what turns fluid along a curved wall, rho u^2/R over 1.3 dx. In a full vessel the
  // fluid is then pressed into the wall, its density falls below that of its volume, and tension
  // tears it off with the wall's energy: the more of it the longer shifting keeps it in order.
  const auto *const preset = fluid->facts().preset;
  linear = pressure == LINEAR || (pressure == AS_PRESET && preset && preset->full);
  movers = fixes_of<FixFSIMove>(lmp);
  follow_commands();
  fluid_density = 0.0;
  bool densities = false;
  for (const State &s : disc->state) {
    if (s.species != FLUID) continue;
    densities = densities || (fluid_density > 0.0 && s.rho0 != fluid_density);
    fluid_density = std::max(fluid_density, s.rho0);
  }
  find_floats();
  const bool stiffness = disc->several_stiffnesses();
  const int dim = disc->dim;
  first_moment = 2 + dim * (slip ? 1 : 2);
  first_stiffness = first_moment + (linear ? dim * (dim + 5) / 2 : turns ? dim : 0);
  mixed = linear && densities;
  several = linear && disc->has_levels();
  of_densities = first_stiffness + stiffness;
  of_spacings = of_densities + mixed;
  nsum = of_spacings + several;
  fields.set("sums over the fluid", Fields::STEP, true, sum, nsum);
  for (auto *message : {&to_ghosts, &from_ghosts}) {
    *message = std::make_unique<Message>(lmp, disc->state);
    (*message)->group = groupbit;
  }
  to_ghosts->add(atom->rho, {RIGID});
  if (stiffness) to_ghosts->add(step->wall_stiffness, {RIGID});
  if (!slip) to_ghosts->add(step->wall_velocity, 0, dim, {RIGID});
  from_ghosts->add(sum, 0, nsum, {RIGID});
  comm_forward = to_ghosts->size();
  comm_reverse = nsum;
}

void FixFSIWallParticle::post_run()
{
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->mask[i] & groupbit) std::copy_n(atom->v[i], 3, at_end[i]);
}

// A command that gives particles another velocity between runs does not accelerate them in a step
void FixFSIWallParticle::follow_commands()
{
  for (int i = 0; i < atom->nlocal; i++)
    if ((atom->mask[i] & groupbit) && before[i][3] > 0.0)
      for (int d = 0; d < 3; d++) before[i][d] += atom->v[i][d] - at_end[i][d];
  post_run();    // not every init() is that of a run
}

// 1 for each that there is on any rank; and finds whether such that fluid sticks to are moved
std::vector<int> FixFSIWallParticle::types_of_members()
{
  int moved = 0;    // groups that something moves, where fluid sticks
  for (const auto &fix : modify->get_fix_list())
    if (fix->time_integrate && !slip) moved |= fix->groupbit;
  std::vector<int> types(atom->ntypes + 1, 0);
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    if (disc->state[atom->type[i]].species != RIGID)
      error->one(FLERR,
                 "Atom {} of fix fsi/wall/particle {} is of type {}, whose material is not a wall",
                 atom->tag[i], id, atom->type[i]);
    if (atom->mask[i] & disc->mover->groupbit)
      error->one(FLERR,
                 "Atom {} of fix fsi/wall/particle {} is also in the group of fix fsi: leave it "
                 "out, and move it with fix move or fix rigid",
                 atom->tag[i], id);
    types[atom->type[i]] = 1;
    if (atom->mask[i] & moved) types[0] = 1;
  }
  types = over_ranks(types, MPI_MAX, world);
  turns = types[0];
  return types;
}

void FixFSIWallParticle::enter_states(std::vector<State> &state, const std::vector<int> &types)
{
  // rerun calls init() of fixes once for each frame, and not that of pair styles
  for (size_t t = 0; t < entered.size(); t++)
    if (entered[t]) state[t].kept = false;
  entered = types;
  for (int t = 1; t <= atom->ntypes; t++) {
    if (!types[t]) continue;
    State &s = state[t];
    if (s.kept) error->all(FLERR, "Atom type {} is in two fixes fsi/wall/particle", t);
    s.kept = true;
    s.noslip = !slip;
    // fluid with tension has no spray that loses its density, and where it flows along a wall the
    // guard is noise
    const double spacings = guard != AUTO ? guard : s.floor < 0.0 ? 0.0 : 0.9;
    // of the distance from the fluid
    s.guard = spacings * 0.5 * (disc->dx + disc->dx_of(t));
  }
}

void FixFSIWallParticle::set_fields(Discretization &of_run)
{
  of_run.noslip_walls = of_run.noslip_walls || !slip;
}

template <class F> void FixFSIWallParticle::for_pairs(size_t level, double cutsq, F f) const
{
  auto *fluid = first_of(pairs_of<PairFSIFluid>(lmp));
  if (!fluid) return;    // a script has put another style in its place since the last run
  fluid->for_rows_with_walls([&](size_t of, const std::vector<Row> &rows, const Mirror &mirror) {
    if (of != level) return;
    for (const Row &row : rows) {
      if (!(atom->mask[row.j[0]] & groupbit)) continue;    // a type is in one such fix
      double x[3];
      mirror.reflect(atom->x[row.i], x);
      for_near(row, x, atom->x, disc->dim, cutsq, [&](int w, const double *d, double rsq) {
        f(w, row.i, d, rsq, mirror);
      });
    }
  });
}

// What is added to the mean of the fluid's pressures p at a wall particle by weighted least squares
// for a pressure linear in d = x_wall - x: -mean(d).C^-1 cov(d, p), C = cov(d, d). In both means p
// has on it what body forces and the wall's acceleration a add on the way, -rho a.d, so that only
// the rest is extrapolated. Particles in a line or plane tell nothing across it: 0.005 dx^2 more of
// variance in all directions takes the rest for constant there.
template <int D>
double FixFSIWallParticle::beyond_mean(const double *moments, double W, double p, double rho,
                                       double dx, const double *a) const
{
  const double *const d = moments, *const dd = d + D, *const pd = dd + D * (D + 1) / 2;
  double C[D * D], adjoint[D * D], covariance[D];
  for (int k = 0, m = 0; k < D; k++) {
    for (int l = k; l < D; l++, m++)
      C[k * D + l] = C[l * D + k] = dd[m] / W - d[k] * d[l] / (W * W);
    covariance[k] = (pd[k] - p * d[k]) / W;
  }
  for (int k = 0; k < D; k++)
    for (int l = 0; l < D; l++) covariance[k] -= rho * a[l] * C[k * D + l];
  for (int k = 0; k < D; k++) C[k * D + k] += 0.005 * dx * dx;
  cofactor<D>(C, adjoint);
  double sum = 0.0;
  for (int k = 0; k < D; k++)
    for (int l = 0; l < D; l++) sum -= d[k] / W * adjoint[k * D + l] * covariance[l];
  return sum / determinant<D>(C);
}

// Particles of a wall beside each other turn together, or are no rigid body
static constexpr double BESIDE = 2.0;    // spacings

void FixFSIWallParticle::find_near()
{
  const Cells wall(atom->x, atom->nlocal + atom->nghost, disc->dim,
                   BESIDE * disc->dx + neighbor->skin, [this](int i) {
                     return (atom->mask[i] & groupbit) != 0;
                   });
  first.clear();
  near.clear();
  for (const int i : members) {
    first.push_back(near.size());
    if (i >= atom->nlocal) break;
    const double reach = BESIDE * disc->dx_of(atom->type[i]) + neighbor->skin;
    wall.around(atom->x[i], reach, [&](int j, double rsq) {
      if (j != i && rsq < reach * reach) near.push_back(j);
    });
  }
  first.push_back(near.size());
}

// What a rigid wall's velocity changes by on the way from local member m: omega x way, omega by
// least squares from the particles around it. None where these do not move as a rigid body.
void FixFSIWallParticle::add_turn(int m, const double *way, double *v) const
{
  static constexpr double RIGID_TO = 1.0e-3;    // of what omega leaves, over all
  const double *const *const x = atom->x, *const *const speed = atom->v;
  const int i = members[m];
  const double reach = BESIDE * disc->dx_of(atom->type[i]);
  double M[9] = {}, moment[3] = {}, total = 0.0;
  for (int k = first[m]; k < first[m + 1]; k++) {
    double d[3], u[3], across[3];
    MathExtra::sub3(x[near[k]], x[i], d);
    MathExtra::sub3(speed[near[k]], speed[i], u);
    const double rsq = MathExtra::lensq3(d), rest = 1.0 - rsq / (reach * reach);
    if (rest <= 0.0) continue;
    const double w = rest * rest;
    MathExtra::cross3(d, u, across);
    for (int a = 0; a < 3; a++) {
      moment[a] += w * across[a];
      for (int b = 0; b < 3; b++) M[3 * a + b] += w * ((a == b) * rsq - d[a] * d[b]);
    }
    total += w * MathExtra::lensq3(u);
  }
  if (total == 0.0) return;
  // particles in a line tell nothing of a turn about it
  const double least = 1.0e-9 * (M[0] + M[4] + M[8]);
  for (int a = 0; a < 3; a++) M[4 * a] += least;
  double adjoint[9], omega[3] = {}, turn[3];
  cofactor<3>(M, adjoint);
  const double inverse = 1.0 / determinant<3>(M);
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++) omega[a] += inverse * adjoint[3 * a + b] * moment[b];
  if (total - MathExtra::dot3(omega, moment) > RIGID_TO * total) return;
  MathExtra::cross3(omega, way, turn);
  for (int d = 0; d < disc->dim; d++) v[d] += turn[d];
}

// sums over the fluid around each particle of the wall
void FixFSIWallParticle::sum_up()
{
  const int dim = disc->dim;
  double **v = atom->v;
  const double *const rho = atom->rho;
  const int *const mask = atom->mask, *const type = atom->type;
  const bool stiffness = step->wall_stiffness;
  if (neighbor->ago == 0) {
    members.clear();
    for (int i = 0; i < atom->nlocal + atom->nghost; i++)
      if (mask[i] & groupbit) members.push_back(i);
    swaps->find([=](int i) {
      return (mask[i] & groupbit) != 0;
    });
    if (turns) find_near();
  }
  fields.grow();
  for (const int i : members) std::fill_n(sum[i], nsum, 0.0);

  for_levels(*disc, [&](size_t level, const auto &kernel) {
    const auto add = [&](int w, int j, const double *d, double rsq, const Mirror &mirror) {
      const double W = kernel.W(std::sqrt(rsq));
      double *const s = sum[w];
      s[0] += W;
      const auto &g = step->body_forces.of_type[type[j]];
      double p = pressure_of(j, atom, *disc, *step);
      for (int k = 0; k < dim; k++) {
        p += rho[j] * g[k] * d[k];
        s[2 + k] += W * rho[j] * d[k];
      }
      s[1] += W * p;
      double *m = s + first_moment;
      if (linear || turns)
        for (int k = 0; k < dim; k++) *m++ += W * d[k];
      if (linear) {
        for (int k = 0; k < dim; k++)
          for (int l = k; l < dim; l++) *m++ += W * d[k] * d[l];
        for (int k = 0; k < dim; k++) *m++ += W * p * d[k];
      }
      if (stiffness) s[first_stiffness] += W * disc->state[type[j]].rho0 * disc->state[type[j]].csq;
      if (mixed) s[of_densities] += W * disc->state[type[j]].rho0;
      if (several) s[of_spacings] += W * disc->levels[level].dx * disc->levels[level].dx;
      if (!slip)
        for (int k = 0; k < dim; k++)
          s[2 + dim + k] += W * (mirror.v[k] + mirror.sign[k] * v[j][k]);
    };
    for_pairs(level, kernel.cutsq, add);
  });
  sent = from_ghosts.get();
  if (force->newton_pair) swaps->reverse<Fix>(step->profile, this);
}

// The pressure of a float lags by a step behind its acceleration a, as -M a with M = 0.4 rho dx of
// an area wet on both sides: with less mass than that a grows from step to step. With a part w of
// it, and the rest of the mean before, it does not below w = 2/(1 + M/m).
void FixFSIWallParticle::find_floats()
{
  static constexpr double LIGHT = 0.5;    // over the fluid's density
  floats = 0;
  for (const auto &fix : modify->get_fix_by_style("^rigid")) floats |= fix->groupbit;
  of_newest.clear();
  for (const State &s : disc->state)
    of_newest.push_back(std::min(1.0, s.rho0 / (LIGHT * fluid_density)));
}

double FixFSIWallParticle::newest(int i) const
{
  return atom->mask[i] & floats ? of_newest[atom->type[i]] : 1.0;
}

// Acceleration: in this step where the motion is known, else in the last; a wall that is set in
// motion has none in its first step
void FixFSIWallParticle::find_acceleration(int i, double *a) const
{
  const double *const old = before[i], *from = old, *to = atom->v[i];
  double known = old[3], span = update->dt + 2.0 * step->dt_offset, next[3];
  for (const auto *mover : movers)
    if ((atom->mask[i] & mover->groupbit) && mover->velocity_at_end(i, next)) {
      from = atom->v[i];
      to = next;
      known = 1.0;
      span = update->dt;
    }
  for (int k = 0; k < disc->dim; k++)
    a[k] = known > 0.0 ? newest(i) * (to[k] - from[k]) / span : 0.0;
}

// p_w = [sum p W + (g - a_w).sum rho (x_w - x) W]/sum W over the fluid around it (Adami et al., eq.
// 27), a_w: acceleration of the wall; velocity of viscous forces 2 v_w - sum v W/sum W (eq. 23),
// with the wall's velocity half way to the fluid that the mean is of, so that fluid sticks to the
// surface of what turns. Of fluids of different rho c^2 the wall has the mean, likewise
void FixFSIWallParticle::end_state(bool advance)
{
  const Phase phase(step->profile, Profile::WALLS);
  const int dim = disc->dim;
  double **v = atom->v;
  double *rho = atom->rho;
  sum_up();
  if (advance) old.resize(4 * members.size());
  for (size_t m = 0; m < members.size(); m++) {
    const int i = members[m];
    if (i >= atom->nlocal) break;    // ghosts come last
    const State &state = disc->state[atom->type[i]];
    const double *const s = sum[i], *const moments = s + first_moment;
    double p = s[1], a[3] = {};
    if (advance) find_acceleration(i, a);
    for (int k = 0; k < dim; k++) {
      p -= a[k] * s[2 + k];
      if (!slip)
        step->wall_velocity[i][k] = 2.0 * v[i][k] - (s[0] > 0.0 ? s[2 + dim + k] / s[0] : v[i][k]);
    }
    if (turns && s[0] > 0.0) {
      double way[3] = {};    // from the wall to the fluid
      for (int k = 0; k < dim; k++) way[k] = -moments[k] / s[0];
      add_turn(m, way, step->wall_velocity[i]);
    }
    p = s[0] > 0.0 ? p / s[0] : state.p0;
    if (linear && s[0] > 0.0) {
      const double of_fluid = mixed ? s[of_densities] / s[0] : fluid_density,
                   dx = several ? std::sqrt(s[of_spacings] / s[0]) : disc->dx;
      p += dim == 2 ? beyond_mean<2>(moments, s[0], s[1] / s[0], of_fluid, dx, a)
                    : beyond_mean<3>(moments, s[0], s[1] / s[0], of_fluid, dx, a);
    }
    p = std::max(p, state.floor);
    if (step->wall_stiffness) {
      const double K = step->wall_stiffness[i] = s[0] > 0.0 ? s[first_stiffness] / s[0]
                                                            : state.rho0 * state.csq;
      rho[i] = state.rho0 * (1.0 + (p - state.p0) / K);
    } else
      rho[i] = state.density(p);
    if (advance) {
      std::copy_n(before[i], 4, &old[4 * m]);
      const double part = newest(i);
      if (part == 1.0 || before[i][3] == 0.0)
        std::copy_n(v[i], 3, before[i]);
      else
        for (int k = 0; k < 3; k++) before[i][k] += part * (v[i][k] - before[i][k]);
      before[i][3] = 1.0;
    }
  }
  sent = to_ghosts.get();
  swaps->forward<Fix>(step->profile, this);
}

void FixFSIWallParticle::undo_advance()
{
  for (size_t m = 0; m < members.size() && members[m] < atom->nlocal; m++)
    std::copy_n(&old[4 * m], 4, before[members[m]]);
}

void FixFSIWallParticle::tally_fluids(double sign)
{
  const int n = atom->nlocal + (force->newton_pair ? atom->nghost : 0);
  if (sign < 0.0) std::fill_n(force_on, 3, 0.0);
  for (const int i : members)
    if (i < n)
      for (int d = 0; d < 3; d++) force_on[d] += sign * atom->f[i][d];
}

double FixFSIWallParticle::compute_vector(int n)
{
  return sum_of(force_on[n], world);
}

// pairs of fluid and wall within the guard's distance
double FixFSIWallParticle::compute_scalar()
{
  // before the first run, or with a new fix fsi
  if (!FixFSI::has(lmp, disc)) return 0.0;
  if (update->whichflag == 0) FixFSI::ready(lmp, "Fix fsi/wall/particle");    // rows may be stale
  double counted = 0.0;
  for (size_t level = 0; level < disc->levels.size(); level++)
    for_pairs(level, HUGE_VAL, [&](int w, int j, const double *, double rsq, const Mirror &) {
      const double limit = disc->guard_of(atom->type[w], disc->levels[level].dx);
      // without newton a pair across ranks is in the lists of both
      if (rsq < limit * limit)
        counted += (force->newton_pair || (w < atom->nlocal && j < atom->nlocal)) ? 1.0 : 0.5;
    });
  return sum_of(counted, world);
}

double FixFSIWallParticle::memory_usage()
{
  return FixFields::memory_usage() + bytes_of(members) + bytes_of(old);
}
