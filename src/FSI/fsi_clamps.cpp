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

#include "fsi_clamps.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "fsi_gather.h"
#include "fsi_hub.h"
#include "fsi_refusals.h"
#include "math_extra.h"
#include "modify.h"
#include "update.h"

#include <algorithm>
#include <set>

using namespace LAMMPS_NS;
using namespace FSI;

// What moves its bodies in another way is left to its own, half a step ahead. With sub-steps that
// is refused, here or by pair_style fsi/solid/tl.
void Clamps::find()
{
  bodies.clear();
  number.clear();
  fixes.clear();
  elastic = false;
  for (const auto &rigid : rigid_bodies(lmp)) {
    const Fix *const fix = rigid->fix;
    std::set<tagint> local;
    bool solids = false;
    for (int i = 0; i < atom->nlocal; i++) {
      const tagint b = rigid->id_of(i);
      if (b < 0 || disc.state[atom->type[i]].species == NONE ||
          atom->mask[i] & disc.mover->groupbit)
        continue;
      local.insert(b);
      solids = solids || disc.state[atom->type[i]].form == TOTAL_LAGRANGIAN;
    }
    const bool in_substeps = anywhere(solids && step.takes_substeps(lmp), world);
    const auto ids = gather(local, world);
    const auto expected = expected_of(*rigid);
    if (in_substeps && !expected.empty())
      refuse(error, Refused::RIGID_STYLES, fix->id, fix->style, expected);
    if (ids.empty()) continue;
    if (!expected.empty()) {
      if (update->whichflag && comm->me == 0)
        error->warning(FLERR,
                       "Fix {} (style {}) leads the fluid by half a step, a first-order error: "
                       "expected {}",
                       fix->id, fix->style, expected);
      continue;
    }
    refuse_new_ids(*rigid);
    fixes.push_back(rigid);
    elastic = elastic || in_substeps;
    for (const tagint id : ids) {
      Body body = {};
      body.fix = rigid.get();
      body.id = id;
      for (int d = 0; d < 6; d++) body.free[d] = rigid->free(id, d);
      number[{rigid.get(), id}] = (int) bodies.size();
      bodies.push_back(body);
    }
  }
  sums.resize(6 * bodies.size());
}

bool Clamps::known(const Fix *fix) const
{
  return std::any_of(fixes.begin(), fixes.end(), [=](const auto &rigid) {
    return rigid->fix == fix;
  });
}

const Clamps::Body *Clamps::find(const RigidBodies &rigid, tagint id) const
{
  const auto at = number.find({&rigid, id});
  return at == number.end() ? nullptr : &bodies[at->second];
}

// for its bodies to be moved here; empty: they are
std::string Clamps::expected_of(const RigidBodies &rigid) const
{
  const auto &all = modify->get_fix_list();
  if (std::find(all.begin(), all.end(), rigid.fix) < std::find(all.begin(), all.end(), disc.mover))
    return fmt::format("after fix {}, which finds the forces on them", disc.mover->id);
  if (rigid.is_thermal()) return "no keyword langevin, or fix rigid";
  if (rigid.is_early())
    return fmt::format("bodyforces late in fix_modify, since fix {} finds the forces on them later",
                       disc.mover->id);
  return {};
}

// fix rigid/small knows its bodies by the ID of an atom, which delete_atoms changes
void Clamps::refuse_new_ids(const RigidBodies &rigid) const
{
  for (int i = 0; i < atom->nlocal; i++)
    if (const tagint known = rigid.id_by(i); known >= 0 && known != atom->tag[i])
      error->one(FLERR,
                 "Fix {} (style {}) knows a body by the ID {} of an atom that has the ID {} now: "
                 "after delete_atoms define the fix again, or use compress no",
                 rigid.fix->id, rigid.fix->style, known, atom->tag[i]);
}

void Clamps::find_members()
{
  members.clear();
  for (const auto &rigid : fixes)
    for (int i = 0; i < atom->nlocal; i++)
      if (const Body *const b = find(*rigid, rigid->id_of(i)))
        members.push_back({i, (int) (b - bodies.data())});
}

void Clamps::store() const
{
  for (const auto &rigid : fixes)
    rigid->store([&](tagint id) {
      return find(*rigid, id);
    });
}

// calls use(body, its state) for all. Those of fix rigid/small with particles of walls or solids,
// few among many, go to each rank
template <class Use> void Clamps::with_states(Use use)
{
  for (const auto &rigid : fixes) {
    std::vector<BodyState> states;
    for (const BodyState &s : rigid->states())
      if (find(*rigid, s.id)) states.push_back(s);
    if (rigid->small) states = gather(states, world);
    for (const BodyState &s : states) use(bodies[number[{rigid.get(), s.id}]], s);
  }
}

void Clamps::follow(Body &b) const
{
  MathExtra::q_to_exyz(b.q, b.ex, b.ey, b.ez);
  MathExtra::angmom_to_omega(b.L, b.ex, b.ey, b.ez, b.inertia, b.omega);
}

// free flight: turned about the angular velocity of half the time, exact in 2D and else of second
// order
void Clamps::drift(Body &b, double t) const
{
  const auto turn = [](double *q, const double *omega, double time) {
    const double rate = MathExtra::len3(omega);
    if (rate == 0.0) return;
    const double axis[3] = {omega[0] / rate, omega[1] / rate, omega[2] / rate};
    double by[4], turned[4];
    MathExtra::axisangle_to_quat(axis, rate * time, by);
    MathExtra::quatquat(by, q, turned);
    std::copy_n(turned, 4, q);
    MathExtra::qnormalize(q);
  };
  double start[4];
  std::copy_n(b.q, 4, start);
  turn(b.q, b.omega, 0.5 * t);
  follow(b);
  std::copy_n(start, 4, b.q);
  turn(b.q, b.omega, t);
  follow(b);
  for (int d = 0; d < 3; d++) b.x[d] += t * b.v[d];
}

void Clamps::kick(Body &b, double t, const double *force_and_torque) const
{
  const double tf = t * force->ftm2v, tm = tf / b.mass;
  for (int d = 0; d < 3; d++) {
    b.v[d] += tm * force_and_torque[d] * b.free[d];
    b.L[d] += tf * force_and_torque[3 + d] * b.free[3 + d];
  }
  follow(b);
}

// from the center of its body
void Clamps::arm(const Member &m, double *r) const
{
  const Body &b = bodies[m.body];
  MathExtra::matvec(b.ex, b.ey, b.ez, b.fix->displace()[m.i], r);
  if (domain->dimension == 2) r[2] = 0.0;
}

void Clamps::place(const std::vector<Member> &list) const
{
  for (const Member &m : list) {
    const Body &b = bodies[m.body];
    double r[3], x[3], around[3];
    arm(m, r);
    MathExtra::add3(b.x, r, x);
    domain->unmap_inv(x, b.fix->image()[m.i]);
    MathExtra::cross3(b.omega, r, around);
    for (int d = 0; d < domain->dimension; d++) {
      atom->x[m.i][d] = x[d];
      atom->v[m.i][d] = b.v[d] + around[d];
    }
  }
}

// Force and torque of each body, of all ranks. Whole: with what has torques of its own.
void Clamps::sum(const std::vector<Member> &list, const double *const *f, bool whole)
{
  std::vector<double> local(sums.size(), 0.0);
  for (const Member &m : list) {
    double r[3], push[3] = {}, torque[3];
    for (int d = 0; d < domain->dimension; d++) push[d] = f[m.i][d];
    arm(m, r);
    MathExtra::cross3(r, push, torque);
    const int *const flags = bodies[m.body].fix->flags();
    if (whole && flags && flags[m.i] & RigidBodies::TORQUE)
      MathExtra::add3(torque, atom->torque[m.i], torque);
    for (int d = 0; d < 3; d++) {
      local[6 * m.body + d] += push[d];
      local[6 * m.body + 3 + d] += torque[d];
    }
  }
  sums = over_ranks(std::move(local), MPI_SUM, world);
}

// what fix rigid itself adds to the sums: keywords langevin and gravity
void Clamps::add_own(const Body &b, double *force_and_torque) const
{
  const double *const langevin = b.fix->langevin(b.id), *const g = b.fix->gravity();
  for (int d = 0; d < 6 && langevin; d++) force_and_torque[d] += b.free[d] * langevin[d];
  for (int d = 0; d < 3 && g; d++) force_and_torque[d] += g[d] * b.mass;
  if (domain->dimension == 2) force_and_torque[2] = force_and_torque[3] = force_and_torque[4] = 0.0;
}

void Clamps::start_step()
{
  with_states([](Body &b, const BodyState &s) {
    static_cast<BodyState &>(b) = s;
    b.start = s;
  });
}

void Clamps::to_start()
{
  for (Body &b : bodies) {
    static_cast<BodyMotion &>(b) = b.start;
    follow(b);
  }
}

// Fix rigid has taken half a kick and a whole drift, as velocity Verlet does. Here the velocities
// are already those of the start of the step, and forces are those of its middle.
void Clamps::to_middle()
{
  to_start();
  find_members();
  for (Body &b : bodies) {
    drift(b, 0.5 * update->dt);
    std::copy_n(b.x, 3, b.middle);
  }
  store();
  place(members);
}

// fix rigid may have moved a body by a period of the box since
void Clamps::follow_boundary()
{
  with_states([](Body &b, const BodyState &s) {
    for (int d = 0; d < 3; d++) {
      b.start.x[d] += s.x[d] - b.middle[d];
      b.middle[d] = s.x[d];
    }
  });
}

void Clamps::begin_substeps(const std::vector<int> &solids)
{
  find_members();
  clamp.assign(atom->nlocal, 0);
  for (const int i : solids) clamp[i] = !(atom->mask[i] & disc.mover->groupbit);
  clamps.clear();
  for (const Member &m : members)
    if (clamp[m.i]) clamps.push_back(m);
  clamp.assign(atom->nlocal, 0);
  for (const Member &m : clamps) clamp[m.i] = 1;
  impulse.assign(3 * clamps.size(), 0.0);
  sum(members, atom->f, true);
  for (size_t k = 0; k < bodies.size(); k++) {
    Body &b = bodies[k];
    std::copy_n(&sums[6 * k], 6, b.outside);
    add_own(b, b.outside);
  }
  follow_boundary();
  to_start();
}

void Clamps::drift(double t)
{
  for (Body &b : bodies) drift(b, t);
  place(clamps);
}

void Clamps::kick(double t, const double *const *f)
{
  double *to = impulse.data();
  for (const Member &m : clamps)
    for (int d = 0; d < 3; d++) *to++ += d < domain->dimension ? f[m.i][d] : 0.0;
  sum(clamps, f, false);
  for (size_t k = 0; k < bodies.size(); k++) {
    for (int d = 0; d < 6; d++) sums[6 * k + d] += bodies[k].outside[d];
    kick(bodies[k], t, &sums[6 * k]);
  }
}

void Clamps::average(int substeps, double **f) const
{
  const double *from = impulse.data();
  for (const Member &m : clamps) {
    for (int d = 0; d < domain->dimension; d++) f[m.i][d] = from[d] / substeps;
    from += 3;
  }
}

void Clamps::take_step()
{
  if (elastic && step.substeps > 1) return;
  begin_substeps({});
  for (Body &b : bodies) {
    drift(b, 0.5 * update->dt);
    kick(b, update->dt, b.outside);
    drift(b, 0.5 * update->dt);
  }
  finish();
}

// Fix rigid takes half a kick more, by which its velocities are those at the end of the step. Its
// angular momentum is that of the sub-steps, not that of the mean force where a particle is in
// the end.
void Clamps::finish()
{
  sum(members, atom->f, true);
  for (size_t k = 0; k < bodies.size(); k++) {
    Body &b = bodies[k];
    add_own(b, &sums[6 * k]);
    kick(b, -0.5 * update->dt, &sums[6 * k]);
  }
  store();
  place(members);
}

// from the middle of the step to its start
void Clamps::go_back()
{
  if (!any()) return;
  find_members();
  follow_boundary();
  to_start();
  store();
  place(members);
}
