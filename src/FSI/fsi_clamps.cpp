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
#include "fix.h"
#include "force.h"
#include "fsi_gather.h"
#include "fsi_scene.h"
#include "math_extra.h"
#include "modify.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <set>

// there without package RIGID: then there is no fix rigid, and no body
#if __has_include("fix_rigid.h")
#include "fix_rigid.h"
#include "fix_rigid_small.h"
#include "rigid_const.h"
#define LMP_FSI_HAS_RIGID
#endif

using namespace LAMMPS_NS;
using namespace FSI;

#ifdef LMP_FSI_HAS_RIGID

// LAMMPS shows the state of its rigid bodies to classes derived from their fix only
namespace {
struct Rigid : public FixRigid {
  static constexpr auto early = &Rigid::earlyflag, count = &Rigid::nbody;
  static constexpr auto of_atom = &Rigid::body, flags = &Rigid::eflags;
  static constexpr auto have_sizes = &Rigid::extended;
  static constexpr auto images = &Rigid::xcmimage;
  static constexpr auto mass = &Rigid::masstotal;
  static constexpr auto place = &Rigid::displace, center = &Rigid::xcm, velocity = &Rigid::vcm,
                        moments = &Rigid::inertia, momentum = &Rigid::angmom, spin = &Rigid::omega,
                        turned = &Rigid::quat, axis_x = &Rigid::ex_space, axis_y = &Rigid::ey_space,
                        axis_z = &Rigid::ez_space, free_force = &Rigid::fflag,
                        free_torque = &Rigid::tflag, langevin = &Rigid::langextra;
  static constexpr auto gravity = &Rigid::id_gravity;
  static constexpr auto field = &Rigid::gvec;
};
struct Small : public FixRigidSmall {
  static constexpr auto early = &Small::earlyflag, own = &Small::nlocal_body,
                        ghosts = &Small::nghost_body, thermal = &Small::langflag;
  static constexpr auto of_atom = &Small::bodytag;
  static constexpr auto owned = &Small::bodyown, flags = &Small::eflags;
  static constexpr auto have_sizes = &Small::extended;
  static constexpr auto images = &Small::xcmimage;
  static constexpr auto place = &Small::displace;
  static constexpr auto bodies = &Small::body;
  static constexpr auto gravity = &Small::id_gravity;
  static constexpr auto field = &Small::gvec;
};

FixRigid *large(Fix *fix)
{
  return static_cast<FixRigid *>(fix);
}
FixRigidSmall *small(Fix *fix)
{
  return static_cast<FixRigidSmall *>(fix);
}
}    // namespace

// What moves its bodies in another way is left to its own, half a step ahead. With sub-steps that
// is refused, here or by pair_style fsi/solid/tl.
void Clamps::find()
{
  bodies.clear();
  elastic = false;
  for (auto &fix : modify->get_fix_by_style("^rigid")) {
    Body body = {};
    body.fix = fix;
    body.small = utils::strmatch(fix->style, "^rigid/small$");
    if (!body.small && !utils::strmatch(fix->style, "^rigid$")) continue;
    std::set<tagint> mine;
    bool solids = false;
    for (int i = 0; i < atom->nlocal; i++) {
      const tagint b = id_of(body, i);
      if (b < 0 || scene.state[atom->type[i]].species == NONE ||
          atom->mask[i] & scene.mover->groupbit)
        continue;
      mine.insert(b);
      solids = solids || scene.is_total_lagrangian(i);
    }
    const bool in_substeps = anywhere(solids && takes_substeps(), world);
    const auto ids = gather(mine, world);
    const auto expected = expected_of(fix);
    if (in_substeps && !expected.empty())
      error->all(FLERR,
                 "Fix {} (style {}) moves particles of elastic bodies with sub-steps: expected {}",
                 fix->id, fix->style, expected);
    if (ids.empty() || !expected.empty()) continue;
    if (body.small) refuse_new_ids(fix);
    elastic = elastic || in_substeps;
    for (const tagint id : ids) {
      body.id = id;
      for (int d = 0; d < 6; d++)
        body.free[d] = body.small ? 1.0
            : d < 3               ? (large(fix)->*Rigid::free_force)[id][d]
                                  : (large(fix)->*Rigid::free_torque)[id][d - 3];
      bodies.push_back(body);
    }
  }
  sums.resize(6 * bodies.size());
}

bool Clamps::known(const Fix *fix) const
{
  return std::any_of(bodies.begin(), bodies.end(), [=](const Body &b) {
    return b.fix == fix;
  });
}

bool Clamps::takes_substeps() const
{
  return scene.substeps > 1 ||
      std::any_of(scene.parts.begin(), scene.parts.end(), [](const Part *p) {
           return p->facts().chooses_substeps;
         });
}

// for its bodies to be moved here; empty: they are
std::string Clamps::expected_of(Fix *fix) const
{
  const bool is_small = utils::strmatch(fix->style, "small$");
  const auto &all = modify->get_fix_list();
  if (std::find(all.begin(), all.end(), fix) < std::find(all.begin(), all.end(), scene.mover))
    return fmt::format("after fix {}, whose sub-steps find the forces on them", scene.mover->id);
  if (is_small && small(fix)->*Small::thermal) return "no keyword langevin, or fix rigid";
  if (is_small ? small(fix)->*Small::early : large(fix)->*Rigid::early)
    return fmt::format("bodyforces late in fix_modify, since fix {} finds the forces on them later",
                       scene.mover->id);
  return {};
}

// fix rigid/small knows its bodies by the ID of an atom, which delete_atoms changes
void Clamps::refuse_new_ids(Fix *fix) const
{
  for (int i = 0; i < atom->nlocal; i++)
    if ((small(fix)->*Small::owned)[i] >= 0 && (small(fix)->*Small::of_atom)[i] != atom->tag[i])
      error->one(FLERR,
                 "Fix {} (style {}) knows a body by the ID {} of an atom that has the ID {} now: "
                 "after delete_atoms define the fix again, or use compress no",
                 fix->id, fix->style, (small(fix)->*Small::of_atom)[i], atom->tag[i]);
}

// of the body that atom i is in: an index in fix rigid, a tag in fix rigid/small; -1: in none
tagint Clamps::id_of(const Body &b, int i) const
{
  if (!b.small) return (large(b.fix)->*Rigid::of_atom)[i];
  const tagint id = (small(b.fix)->*Small::of_atom)[i];
  return id > 0 ? id : -1;
}

void Clamps::find_members()
{
  members.clear();
  of_fixes([this](size_t first, size_t last) {
    const auto of = entries(first, last);
    for (size_t k = first; k < last; k++) {
      Body &b = bodies[k];
      b.displace = b.small ? small(b.fix)->*Small::place : large(b.fix)->*Rigid::place;
      b.image = b.small ? small(b.fix)->*Small::images : large(b.fix)->*Rigid::images;
      b.flags = b.small ? small(b.fix)->*Small::flags : large(b.fix)->*Rigid::flags;
      if (!(b.small ? small(b.fix)->*Small::have_sizes : large(b.fix)->*Rigid::have_sizes))
        b.flags = nullptr;
    }
    for (int i = 0; i < atom->nlocal; i++) {
      const tagint id = id_of(bodies[first], i);
      if (id < 0) continue;
      const auto at = of.find(id);
      if (at != of.end()) members.push_back({i, (int) at->second});
    }
  });
}

// state of a body here and there; fix rigid has all on each rank, fix rigid/small has each on the
// rank of one of its atoms, and copies where others are: of those with particles of walls or
// solids, few among many, each rank gets it
std::vector<Clamps::State> Clamps::states(Fix *fix,
                                          const std::unordered_map<tagint, size_t> &of) const
{
  std::vector<State> mine;
  State s = {};
  if (!utils::strmatch(fix->style, "small$")) {
    FixRigid *const r = large(fix);
    for (int b = 0; b < r->*Rigid::count; b++) {
      s.id = b;
      std::copy_n((r->*Rigid::center)[b], 3, s.x);
      std::copy_n((r->*Rigid::velocity)[b], 3, s.v);
      std::copy_n((r->*Rigid::turned)[b], 4, s.q);
      std::copy_n((r->*Rigid::momentum)[b], 3, s.L);
      s.mass = (r->*Rigid::mass)[b];
      std::copy_n((r->*Rigid::moments)[b], 3, s.inertia);
      mine.push_back(s);
    }
    return mine;
  }
  for (int k = 0; k < small(fix)->*Small::own; k++) {
    const auto &b = (small(fix)->*Small::bodies)[k];
    s.id = atom->tag[b.ilocal];
    if (!of.count(s.id)) continue;
    std::copy_n(b.xcm, 3, s.x);
    std::copy_n(b.vcm, 3, s.v);
    std::copy_n(b.quat, 4, s.q);
    std::copy_n(b.angmom, 3, s.L);
    s.mass = b.mass;
    std::copy_n(b.inertia, 3, s.inertia);
    mine.push_back(s);
  }
  return gather(mine, world);
}

// calls use(first, last) for the bodies of each fix
template <class Use> void Clamps::of_fixes(Use use) const
{
  for (size_t first = 0, last; first < bodies.size(); first = last) {
    for (last = first; last < bodies.size() && bodies[last].fix == bodies[first].fix;) last++;
    use(first, last);
  }
}

// which of those it is that a fix knows by this
std::unordered_map<tagint, size_t> Clamps::entries(size_t first, size_t last) const
{
  std::unordered_map<tagint, size_t> of;
  for (size_t k = first; k < last; k++) of[bodies[k].id] = k;
  return of;
}

void Clamps::store() const
{
  of_fixes([this](size_t first, size_t last) {
    if (!bodies[first].small) {
      for (size_t k = first; k < last; k++) store_large(bodies[k]);
      return;
    }
    FixRigidSmall *const fix = small(bodies[first].fix);
    const auto of = entries(first, last);
    const int n = fix->*Small::own + fix->*Small::ghosts;
    for (int k = 0; k < n; k++) {
      auto &to = (fix->*Small::bodies)[k];
      const auto at = of.find(atom->tag[to.ilocal]);
      if (at == of.end()) continue;
      const Body &b = bodies[at->second];
      std::copy_n(b.x, 3, to.xcm);
      std::copy_n(b.v, 3, to.vcm);
      std::copy_n(b.q, 4, to.quat);
      std::copy_n(b.L, 3, to.angmom);
      std::copy_n(b.omega, 3, to.omega);
      std::copy_n(b.ex, 3, to.ex_space);
      std::copy_n(b.ey, 3, to.ey_space);
      std::copy_n(b.ez, 3, to.ez_space);
    }
  });
}

void Clamps::store_large(const Body &b) const
{
  FixRigid *const r = large(b.fix);
  std::copy_n(b.x, 3, (r->*Rigid::center)[b.id]);
  std::copy_n(b.v, 3, (r->*Rigid::velocity)[b.id]);
  std::copy_n(b.q, 4, (r->*Rigid::turned)[b.id]);
  std::copy_n(b.L, 3, (r->*Rigid::momentum)[b.id]);
  std::copy_n(b.omega, 3, (r->*Rigid::spin)[b.id]);
  std::copy_n(b.ex, 3, (r->*Rigid::axis_x)[b.id]);
  std::copy_n(b.ey, 3, (r->*Rigid::axis_y)[b.id]);
  std::copy_n(b.ez, 3, (r->*Rigid::axis_z)[b.id]);
}

// calls use(body, its state) for all
template <class Use> void Clamps::with_states(Use use)
{
  of_fixes([&](size_t first, size_t last) {
    const auto of = entries(first, last);
    for (const State &s : states(bodies[first].fix, of)) {
      const auto at = of.find(s.id);
      if (at != of.end()) use(bodies[at->second], s);
    }
  });
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
  MathExtra::matvec(b.ex, b.ey, b.ez, b.displace[m.i], r);
  if (domain->dimension == 2) r[2] = 0.0;
}

void Clamps::place(const std::vector<Member> &list) const
{
  for (const Member &m : list) {
    const Body &b = bodies[m.body];
    double r[3], x[3], around[3];
    arm(m, r);
    MathExtra::add3(b.x, r, x);
    domain->unmap_inv(x, b.image[m.i]);
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
  std::vector<double> mine(sums.size(), 0.0);
  for (const Member &m : list) {
    double r[3], one[3] = {}, torque[3];
    for (int d = 0; d < domain->dimension; d++) one[d] = f[m.i][d];
    arm(m, r);
    MathExtra::cross3(r, one, torque);
    const int *const flags = bodies[m.body].flags;
    if (whole && flags && flags[m.i] & RigidConst::TORQUE)
      MathExtra::add3(torque, atom->torque[m.i], torque);
    for (int d = 0; d < 3; d++) {
      mine[6 * m.body + d] += one[d];
      mine[6 * m.body + 3 + d] += torque[d];
    }
  }
  if (comm->nprocs == 1)
    sums = mine;
  else
    MPI_Allreduce(mine.data(), sums.data(), mine.size(), MPI_DOUBLE, MPI_SUM, world);
}

// what fix rigid itself adds to the sums: keywords langevin and gravity
void Clamps::add_own(const Body &b, double *force_and_torque) const
{
  // newer releases have the forces of keyword langevin only with it
  const double *const *const forces = b.small ? nullptr : large(b.fix)->*Rigid::langevin;
  const double *const langevin = forces ? forces[b.id] : nullptr;
  const bool field = b.small ? small(b.fix)->*Small::gravity : large(b.fix)->*Rigid::gravity;
  const double *const g = b.small ? small(b.fix)->*Small::field : large(b.fix)->*Rigid::field;
  for (int d = 0; d < 6 && langevin; d++) force_and_torque[d] += b.free[d] * langevin[d];
  for (int d = 0; d < 3 && field; d++) force_and_torque[d] += g[d] * b.mass;
  if (domain->dimension == 2) force_and_torque[2] = force_and_torque[3] = force_and_torque[4] = 0.0;
}

void Clamps::start_step()
{
  with_states([](Body &b, const State &s) {
    static_cast<State &>(b) = s;
    b.start = s;
  });
}

void Clamps::to_start()
{
  for (Body &b : bodies) {
    static_cast<Motion &>(b) = b.start;
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
  with_states([](Body &b, const State &s) {
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
  for (const int i : solids) clamp[i] = !(atom->mask[i] & scene.mover->groupbit);
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
  if (elastic && scene.substeps > 1) return;
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

#else

void Clamps::find() {}
bool Clamps::known(const Fix *) const
{
  return false;
}
void Clamps::start_step() {}
void Clamps::to_middle() {}
void Clamps::begin_substeps(const std::vector<int> &) {}
void Clamps::drift(double) {}
void Clamps::kick(double, const double *const *) {}
void Clamps::average(int, double **) const {}
void Clamps::take_step() {}
void Clamps::finish() {}
void Clamps::go_back() {}

#endif
