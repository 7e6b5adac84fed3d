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

#include "fsi_lammps_access.h"

#include "atom.h"
#include "comm_brick.h"
#include "fix_gravity.h"
#include "lammps.h"
#include "modify.h"

#include <algorithm>

#if __has_include("fix_rigid.h")
#include "fix_rigid.h"
#include "fix_rigid_small.h"
#include "rigid_const.h"
#define LMP_FSI_HAS_RIGID
#endif

using namespace LAMMPS_NS;
using namespace FSI;

namespace {

struct OfModify : public Modify {
  static constexpr auto id = &OfModify::id_restart_global, style = &OfModify::style_restart_global;
  static constexpr auto used = &OfModify::used_restart_global;
};

struct OfComm : public CommBrick {
  static constexpr auto number = &OfComm::nswap;
  static constexpr auto to = &OfComm::sendproc, from = &OfComm::recvproc, nsend = &OfComm::sendnum,
                        nrecv = &OfComm::recvnum, first = &OfComm::firstrecv,
                        flag = &OfComm::pbc_flag;
  static constexpr auto list = &OfComm::sendlist, shifts = &OfComm::pbc;
};

struct OfGravity : public FixGravity {
  static bool is_disabled(const FixGravity *fix) { return fix->*&OfGravity::disable; }
  static bool has_variable(const FixGravity *fix) { return fix->*&OfGravity::varflag != CONSTANT; }
};

struct OfFix : public Fix {
  static constexpr auto number = &OfFix::instance_me;
};

}    // namespace

std::vector<std::pair<std::string, std::string>> FSI::not_taken_from_restart(const Modify *modify)
{
  std::vector<std::pair<std::string, std::string>> found;
  for (int k = 0; k < modify->nfix_restart_global; k++)
    if (!(modify->*OfModify::used)[k])
      found.emplace_back((modify->*OfModify::style)[k], (modify->*OfModify::id)[k]);
  return found;
}

bool FSI::find_exchanges(const Comm *comm, std::vector<Exchange> &found)
{
  const auto *const brick = dynamic_cast<const CommBrick *>(comm);
  found.clear();
  for (int k = 0; brick && k < brick->*OfComm::number; k++)
    found.push_back({(brick->*OfComm::list)[k], (brick->*OfComm::nsend)[k], (brick->*OfComm::to)[k],
                     (brick->*OfComm::from)[k], (brick->*OfComm::first)[k],
                     (brick->*OfComm::nrecv)[k], (brick->*OfComm::flag)[k],
                     (brick->*OfComm::shifts)[k]});
  return brick != nullptr;
}

bool FSI::is_disabled(const FixGravity *fix)
{
  return OfGravity::is_disabled(fix);
}

bool FSI::has_variable(const FixGravity *fix)
{
  return OfGravity::has_variable(fix);
}

int FSI::number_of(const Fix *fix)
{
  return fix->*OfFix::number;
}

#ifdef LMP_FSI_HAS_RIGID

const int RigidBodies::TORQUE = RigidConst::TORQUE;

namespace {

struct OfRigid : public FixRigid {
  static constexpr auto early = &OfRigid::earlyflag, count = &OfRigid::nbody;
  static constexpr auto of_atom = &OfRigid::body, flags = &OfRigid::eflags;
  static constexpr auto have_sizes = &OfRigid::extended;
  static constexpr auto images = &OfRigid::xcmimage;
  static constexpr auto mass = &OfRigid::masstotal;
  static constexpr auto place = &OfRigid::displace, center = &OfRigid::xcm,
                        velocity = &OfRigid::vcm, moments = &OfRigid::inertia,
                        momentum = &OfRigid::angmom, spin = &OfRigid::omega,
                        turned = &OfRigid::quat, axis_x = &OfRigid::ex_space,
                        axis_y = &OfRigid::ey_space, axis_z = &OfRigid::ez_space,
                        free_force = &OfRigid::fflag, free_torque = &OfRigid::tflag,
                        langevin = &OfRigid::langextra;
  static constexpr auto gravity = &OfRigid::id_gravity;
  static constexpr auto field = &OfRigid::gvec;
};

struct OfSmall : public FixRigidSmall {
  static constexpr auto early = &OfSmall::earlyflag, own = &OfSmall::nlocal_body,
                        ghosts = &OfSmall::nghost_body, thermal = &OfSmall::langflag;
  static constexpr auto of_atom = &OfSmall::bodytag;
  static constexpr auto owned = &OfSmall::bodyown, flags = &OfSmall::eflags;
  static constexpr auto have_sizes = &OfSmall::extended;
  static constexpr auto images = &OfSmall::xcmimage;
  static constexpr auto place = &OfSmall::displace;
  static constexpr auto bodies = &OfSmall::body;
  static constexpr auto gravity = &OfSmall::id_gravity;
  static constexpr auto field = &OfSmall::gvec;
};

// what both have
template <class F, class Of> class BodiesOf : public RigidBodies {
 public:
  BodiesOf(Fix *fix, bool small) : RigidBodies(fix, small), f(static_cast<F *>(fix)) {}
  bool is_early() const override { return f->*Of::early; }
  const double *const *displace() const override { return f->*Of::place; }
  const imageint *image() const override { return f->*Of::images; }
  const int *flags() const override { return f->*Of::have_sizes ? f->*Of::flags : nullptr; }
  const double *gravity() const override { return f->*Of::gravity ? f->*Of::field : nullptr; }

 protected:
  F *const f;
};

class LargeBodies : public BodiesOf<FixRigid, OfRigid> {
 public:
  explicit LargeBodies(Fix *fix) : BodiesOf(fix, false) {}
  bool is_thermal() const override { return false; }
  tagint id_of(int i) const override { return (f->*OfRigid::of_atom)[i]; }
  tagint id_by(int) const override { return -1; }
  double free(tagint id, int d) const override
  {
    return d < 3 ? (f->*OfRigid::free_force)[id][d] : (f->*OfRigid::free_torque)[id][d - 3];
  }
  // newer releases have these forces only with keyword langevin
  const double *langevin(tagint id) const override
  {
    const double *const *const forces = f->*OfRigid::langevin;
    return forces ? forces[id] : nullptr;
  }
  std::vector<BodyState> states() const override
  {
    std::vector<BodyState> all(f->*OfRigid::count);
    for (size_t b = 0; b < all.size(); b++) {
      BodyState &s = all[b];
      s.id = b;
      s.mass = (f->*OfRigid::mass)[b];
      std::copy_n((f->*OfRigid::center)[b], 3, s.x);
      std::copy_n((f->*OfRigid::velocity)[b], 3, s.v);
      std::copy_n((f->*OfRigid::turned)[b], 4, s.q);
      std::copy_n((f->*OfRigid::momentum)[b], 3, s.L);
      std::copy_n((f->*OfRigid::moments)[b], 3, s.inertia);
    }
    return all;
  }
  void store(const std::function<const BodyNow *(tagint)> &of) const override
  {
    for (int k = 0; k < f->*OfRigid::count; k++) {
      const BodyNow *const b = of(k);
      if (!b) continue;
      std::copy_n(b->x, 3, (f->*OfRigid::center)[k]);
      std::copy_n(b->v, 3, (f->*OfRigid::velocity)[k]);
      std::copy_n(b->q, 4, (f->*OfRigid::turned)[k]);
      std::copy_n(b->L, 3, (f->*OfRigid::momentum)[k]);
      std::copy_n(b->omega, 3, (f->*OfRigid::spin)[k]);
      std::copy_n(b->ex, 3, (f->*OfRigid::axis_x)[k]);
      std::copy_n(b->ey, 3, (f->*OfRigid::axis_y)[k]);
      std::copy_n(b->ez, 3, (f->*OfRigid::axis_z)[k]);
    }
  }
};

class SmallBodies : public BodiesOf<FixRigidSmall, OfSmall> {
  const Atom *const atom;

 public:
  SmallBodies(Fix *fix, const Atom *atom) : BodiesOf(fix, true), atom(atom) {}
  bool is_thermal() const override { return f->*OfSmall::thermal; }
  tagint id_of(int i) const override
  {
    const tagint id = (f->*OfSmall::of_atom)[i];
    return id > 0 ? id : -1;
  }
  tagint id_by(int i) const override
  {
    return (f->*OfSmall::owned)[i] >= 0 ? (f->*OfSmall::of_atom)[i] : -1;
  }
  double free(tagint, int) const override { return 1.0; }
  const double *langevin(tagint) const override { return nullptr; }
  std::vector<BodyState> states() const override
  {
    std::vector<BodyState> all(f->*OfSmall::own);
    for (size_t k = 0; k < all.size(); k++) {
      const auto &b = (f->*OfSmall::bodies)[k];
      BodyState &s = all[k];
      s.id = atom->tag[b.ilocal];
      s.mass = b.mass;
      std::copy_n(b.xcm, 3, s.x);
      std::copy_n(b.vcm, 3, s.v);
      std::copy_n(b.quat, 4, s.q);
      std::copy_n(b.angmom, 3, s.L);
      std::copy_n(b.inertia, 3, s.inertia);
    }
    return all;
  }
  void store(const std::function<const BodyNow *(tagint)> &of) const override
  {
    for (int k = 0; k < f->*OfSmall::own + f->*OfSmall::ghosts; k++) {
      auto &to = (f->*OfSmall::bodies)[k];
      const BodyNow *const b = of(atom->tag[to.ilocal]);
      if (!b) continue;
      std::copy_n(b->x, 3, to.xcm);
      std::copy_n(b->v, 3, to.vcm);
      std::copy_n(b->q, 4, to.quat);
      std::copy_n(b->L, 3, to.angmom);
      std::copy_n(b->omega, 3, to.omega);
      std::copy_n(b->ex, 3, to.ex_space);
      std::copy_n(b->ey, 3, to.ey_space);
      std::copy_n(b->ez, 3, to.ez_space);
    }
  }
};

}    // namespace

std::vector<std::shared_ptr<RigidBodies>> FSI::rigid_bodies(LAMMPS *lmp)
{
  std::vector<std::shared_ptr<RigidBodies>> found;
  for (auto *fix : lmp->modify->get_fix_by_style("^rigid"))
    if (utils::strmatch(fix->style, "^rigid/small$"))
      found.push_back(std::make_shared<SmallBodies>(fix, lmp->atom));
    else if (utils::strmatch(fix->style, "^rigid$"))
      found.push_back(std::make_shared<LargeBodies>(fix));
  return found;
}

#else

const int RigidBodies::TORQUE = 0;

std::vector<std::shared_ptr<RigidBodies>> FSI::rigid_bodies(LAMMPS *)
{
  return {};
}

#endif
