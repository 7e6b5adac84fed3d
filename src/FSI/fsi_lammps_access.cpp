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
  using Modify::id_restart_global, Modify::style_restart_global, Modify::used_restart_global;
};

struct OfComm : public CommBrick {
  using CommBrick::nswap, CommBrick::sendlist, CommBrick::sendnum, CommBrick::sendproc,
      CommBrick::recvproc, CommBrick::firstrecv, CommBrick::recvnum, CommBrick::pbc_flag,
      CommBrick::pbc, CommBrick::multi_reduce, CommBrick::bordergroup;
};

struct OfGravity : public FixGravity {
  using FixGravity::disable, FixGravity::varflag, FixGravity::CONSTANT;
};

struct OfFix : public Fix {
  using Fix::instance_me;
};

}    // namespace

std::vector<std::pair<std::string, std::string>> FSI::not_taken_from_restart(const Modify *modify)
{
  std::vector<std::pair<std::string, std::string>> found;
  for (int k = 0; k < modify->nfix_restart_global; k++)
    if (!(modify->*&OfModify::used_restart_global)[k])
      found.emplace_back((modify->*&OfModify::style_restart_global)[k],
                         (modify->*&OfModify::id_restart_global)[k]);
  return found;
}

bool FSI::find_exchanges(const Comm *comm, std::vector<Exchange> &found)
{
  const auto *const brick = dynamic_cast<const CommBrick *>(comm);
  found.clear();
  for (int k = 0; brick && k < brick->*&OfComm::nswap; k++)
    found.push_back({(brick->*&OfComm::sendlist)[k], (brick->*&OfComm::sendnum)[k],
                     (brick->*&OfComm::sendproc)[k], (brick->*&OfComm::recvproc)[k],
                     (brick->*&OfComm::firstrecv)[k], (brick->*&OfComm::recvnum)[k],
                     (brick->*&OfComm::pbc_flag)[k], (brick->*&OfComm::pbc)[k]});
  return brick != nullptr;
}

bool FSI::has_reduced_ghosts(const Comm *comm)
{
  return comm->*&OfComm::multi_reduce || comm->*&OfComm::bordergroup;
}

bool FSI::is_disabled(const FixGravity *fix)
{
  return fix->*&OfGravity::disable;
}

bool FSI::has_variable(const FixGravity *fix)
{
  return fix->*&OfGravity::varflag != OfGravity::CONSTANT;
}

int FSI::number_of(const Fix *fix)
{
  return fix->*&OfFix::instance_me;
}

std::vector<BodyState> RigidBodies::states() const
{
  std::vector<BodyState> all;
  for (const Entry &e : entries(false)) {
    BodyState s = {};
    s.id = e.id;
    s.mass = e.mass;
    std::copy_n(e.inertia, 3, s.inertia);
    std::copy_n(e.x, 3, s.x);
    std::copy_n(e.v, 3, s.v);
    std::copy_n(e.q, 4, s.q);
    std::copy_n(e.L, 3, s.L);
    all.push_back(s);
  }
  return all;
}

void RigidBodies::store(const std::function<const BodyNow *(tagint)> &of) const
{
  for (const Entry &e : entries(true)) {
    const BodyNow *const b = of(e.id);
    if (!b) continue;
    std::copy_n(b->x, 3, e.x);
    std::copy_n(b->v, 3, e.v);
    std::copy_n(b->q, 4, e.q);
    std::copy_n(b->L, 3, e.L);
    std::copy_n(b->omega, 3, e.omega);
    std::copy_n(b->ex, 3, e.ex);
    std::copy_n(b->ey, 3, e.ey);
    std::copy_n(b->ez, 3, e.ez);
  }
}

#ifdef LMP_FSI_HAS_RIGID

const int RigidBodies::TORQUE = RigidConst::TORQUE;

namespace {

struct OfRigid : public FixRigid {
  using FixRigid::earlyflag, FixRigid::displace, FixRigid::xcmimage, FixRigid::extended,
      FixRigid::eflags, FixRigid::id_gravity, FixRigid::gvec, FixRigid::body, FixRigid::nbody,
      FixRigid::masstotal, FixRigid::inertia, FixRigid::xcm, FixRigid::vcm, FixRigid::quat,
      FixRigid::angmom, FixRigid::omega, FixRigid::ex_space, FixRigid::ey_space, FixRigid::ez_space,
      FixRigid::fflag, FixRigid::tflag, FixRigid::langextra;
};

struct OfSmall : public FixRigidSmall {
  using FixRigidSmall::earlyflag, FixRigidSmall::displace, FixRigidSmall::xcmimage,
      FixRigidSmall::extended, FixRigidSmall::eflags, FixRigidSmall::id_gravity,
      FixRigidSmall::gvec, FixRigidSmall::body, FixRigidSmall::nlocal_body,
      FixRigidSmall::nghost_body, FixRigidSmall::bodyown, FixRigidSmall::bodytag,
      FixRigidSmall::langflag;
};

// what both have
template <class F, class Of> class BodiesOf : public RigidBodies {
 public:
  BodiesOf(Fix *fix, bool small) : RigidBodies(fix, small), f(static_cast<F *>(fix)) {}
  bool is_early() const override { return f->*&Of::earlyflag; }
  const double *const *displace() const override { return f->*&Of::displace; }
  const imageint *image() const override { return f->*&Of::xcmimage; }
  const int *flags() const override { return f->*&Of::extended ? f->*&Of::eflags : nullptr; }
  const double *gravity() const override { return f->*&Of::id_gravity ? f->*&Of::gvec : nullptr; }

 protected:
  F *const f;
};

class LargeBodies : public BodiesOf<FixRigid, OfRigid> {
 public:
  explicit LargeBodies(Fix *fix) : BodiesOf(fix, false) {}
  bool is_thermal() const override { return false; }
  tagint id_of(int i) const override { return (f->*&OfRigid::body)[i]; }
  tagint id_by(int) const override { return -1; }
  double free(tagint id, int d) const override
  {
    return d < 3 ? (f->*&OfRigid::fflag)[id][d] : (f->*&OfRigid::tflag)[id][d - 3];
  }
  // newer releases have these forces only with keyword langevin
  const double *langevin(tagint id) const override
  {
    const double *const *const forces = f->*&OfRigid::langextra;
    return forces ? forces[id] : nullptr;
  }
  std::vector<Entry> entries(bool) const override
  {
    std::vector<Entry> all;
    for (int k = 0; k < f->*&OfRigid::nbody; k++)
      all.push_back({k, (f->*&OfRigid::masstotal)[k], (f->*&OfRigid::inertia)[k],
                     (f->*&OfRigid::xcm)[k], (f->*&OfRigid::vcm)[k], (f->*&OfRigid::quat)[k],
                     (f->*&OfRigid::angmom)[k], (f->*&OfRigid::omega)[k],
                     (f->*&OfRigid::ex_space)[k], (f->*&OfRigid::ey_space)[k],
                     (f->*&OfRigid::ez_space)[k]});
    return all;
  }
};

class SmallBodies : public BodiesOf<FixRigidSmall, OfSmall> {
  const Atom *const atom;

 public:
  SmallBodies(Fix *fix, const Atom *atom) : BodiesOf(fix, true), atom(atom) {}
  bool is_thermal() const override { return f->*&OfSmall::langflag; }
  tagint id_of(int i) const override
  {
    const tagint id = (f->*&OfSmall::bodytag)[i];
    return id > 0 ? id : -1;
  }
  tagint id_by(int i) const override
  {
    return (f->*&OfSmall::bodyown)[i] >= 0 ? (f->*&OfSmall::bodytag)[i] : -1;
  }
  double free(tagint, int) const override { return 1.0; }
  const double *langevin(tagint) const override { return nullptr; }
  std::vector<Entry> entries(bool with_copies) const override
  {
    std::vector<Entry> all;
    const int n = f->*&OfSmall::nlocal_body + (with_copies ? f->*&OfSmall::nghost_body : 0);
    for (int k = 0; k < n; k++) {
      auto &b = (f->*&OfSmall::body)[k];
      all.push_back({atom->tag[b.ilocal], b.mass, b.inertia, b.xcm, b.vcm, b.quat, b.angmom,
                     b.omega, b.ex_space, b.ey_space, b.ez_space});
    }
    return all;
  }
};

}    // namespace

std::vector<std::shared_ptr<RigidBodies>> FSI::rigid_bodies(LAMMPS *lmp)
{
  std::vector<std::shared_ptr<RigidBodies>> found;
  for (auto *fix : lmp->modify->get_fix_by_style("^rigid"))
    if (utils::strmatch(fix->style, "^rigid/small$") ||
        utils::strmatch(fix->style, "^rigid/small/omp$"))
      found.push_back(std::make_shared<SmallBodies>(fix, lmp->atom));
    else if (utils::strmatch(fix->style, "^rigid$") || utils::strmatch(fix->style, "^rigid/omp$"))
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
