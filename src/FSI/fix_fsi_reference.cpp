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

#include "fix_fsi_reference.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "fix_fsi.h"
#include "fsi_changes.h"
#include "fsi_damage.h"
#include "fsi_fields.h"
#include "fsi_find.h"
#include "fsi_gather.h"
#include "fsi_hub.h"
#include "fsi_part.h"
#include "fsi_record.h"
#include "fsi_refusals.h"
#include "fsi_self_contact.h"

#include <cmath>
#include <set>

using namespace LAMMPS_NS;
using namespace FSI;

struct FixFSIReference::Members {
  Damage damage;
  SelfContact self;
  Swaps swaps;
  Members(LAMMPS *lmp, BondStore &bonds) : damage(lmp, bonds), self(lmp, bonds), swaps(lmp) {}
};

FixFSIReference::FixFSIReference(LAMMPS *lmp, int narg, char **arg) :
    BondStore(lmp, narg, arg), members(new Members(lmp, *this)), damage(members->damage),
    self(members->self), swaps(members->swaps)
{
  restart_global = 1;
}

FixFSIReference::~FixFSIReference()
{
  if (auto *const now = FixFSI::there(lmp)) now->changes.forget();
}

void FixFSIReference::init()
{
  // has a script put in its place what is not of this package?
  resting = facts_of_solids(lmp).style != Facts::OF_TOTAL_LAGRANGIAN_SOLIDS;
  images.clear_planes();
  if (resting) return;
  FixFSI::find(lmp, "Fix FSI_REFERENCE")->link(disc, messages);
  find_planes();
  if (!any()) {
    made.clear();
    self.joined.clear();
    choose(images.planes.any(), self.range > 0.0);
  } else if (made != as_now())
    error->all(FLERR,
               "Pair style fsi/solid/tl {}: the bonds of its bodies were made with {}, and stay so",
               as_now(), made);
  if (self.range > 0.0 && !keeps_places) refuse(error, Refused::SELF_LATE);
}

void FixFSIReference::find_planes()
{
  Walls walls;
  std::vector<WallForce> forces;
  for (auto *p : fixes_of<Part>(lmp)) p->add_walls(walls, forces);
  images.find_planes(walls, forces);
  if (!images.planes.any()) return;
  if (self.range > 0.0) refuse(error, Refused::SELF_SYMMETRY, "fsi/solid/tl");
  const auto &planes = images.planes.wall;
  const double least = 2.0 * disc->largest_cut;
  for (size_t b = 1; b < planes.size(); b++) {
    const double apart = planes[b].position - planes[b - 1].position;
    if (planes[b].axis == planes[b - 1].axis && std::fabs(apart) < least)
      error->all(FLERR,
                 "Planes of symmetry at {} = {} and {} are too close: expected two supports of the "
                 "kernel, {}, between them",
                 "xyz"[planes[b].axis], planes[b - 1].position, planes[b].position, least);
  }
}

void FixFSIReference::setup_post_neighbor()
{
  if (resting) return;
  follow_commands();
  const int before = changes;
  take_bare();
  reserve_everywhere();
  if (changes == before) find_partners();
  refuse_split_bodies();
  self.find_joined();
  self.find_image_pairs();
  end_taking();
  self.begin_to_look();
  self.look();
}

void FixFSIReference::post_neighbor()
{
  if (resting) return;
  find_partners();
  self.look();
}

void FixFSIReference::find_partners()
{
  resolve();
  damage.forget();
  swaps.find([this](int i) {
    return is_solid(i);
  });
  self.find_pairs();
  self.find_image_pairs();
}

// Solids cannot become something else between runs, nor the reverse.
void FixFSIReference::refuse_other_materials() const
{
  const tagint *const tag = atom->tag;
  for (int i = 0; i < atom->nlocal; i++) {
    if (is_foreign(i) && is_solid(i))
      error->one(FLERR,
                 "Atom {} of type {} is a solid now and was none when a run began: delete it and "
                 "create a solid in its place",
                 tag[i], atom->type[i]);
    if (!has(i)) continue;
    if (!is_solid(i))
      error->one(FLERR,
                 "Atom {} of type {} is bonded to body {} and no solid any more: delete it and "
                 "create another in its place",
                 tag[i], atom->type[i], atom->molecule[i]);
    // volumes are masses over densities
    const double rho = atom->rho[i], rho0 = disc->state[atom->type[i]].rho0;
    if (std::fabs(rho - rho0) > 1.0e-9 * rho0)
      error->one(FLERR,
                 "Solid atom {} has the mass of a material of density {:g}, but that of its type "
                 "{} has {:g} now: make the body anew",
                 tag[i], rho, atom->type[i], rho0);
  }
}

// has a bonded particle of this rank another ID, or lost a partner?
bool FixFSIReference::anything_gone()
{
  for (int i = 0; i < atom->nlocal; i++) {
    if (!has(i)) continue;
    if (owner(i) != atom->tag[i]) return true;
    for (int k = 0; k < count(i); k++) {
      const tagint t = partner_tags(i)[k];
      if (t > atom->map_tag_max || atom->map(t) < 0) return true;
    }
  }
  return false;
}

FixFSIReference::NewIDs FixFSIReference::new_ids()
{
  std::vector<tagint> ids;    // old and new
  for (int i = 0; i < atom->nlocal; i++)
    if (has(i)) {
      ids.push_back(owner(i));
      ids.push_back(atom->tag[i]);
    }
  ids = gather(ids, world);
  NewIDs now;
  for (size_t k = 0; k < ids.size(); k += 2) now[ids[k]] = ids[k + 1];
  return now;
}

// gives partners of i their new IDs and removes bonds to those that are gone: how many
int FixFSIReference::cut(int i, const NewIDs &now)
{
  const int n = count(i);
  int kept = 0;
  for (int k = 0; k < n; k++) {
    const auto it = now.find(partner_tags(i)[k]);
    if (it == now.end()) continue;
    move(i, k, kept);
    partner_tags(i)[kept++] = it->second;
  }
  owner(i) = atom->tag[i];
  keep_first(i, kept);
  return n - kept;
}

// What commands between runs have done to bodies. Delete_atoms gives all atoms new IDs unless
// told not to: each bonded atom knows its old one. Bonds to those that are gone are cut, as by
// damage.
void FixFSIReference::follow_commands()
{
  refuse_other_materials();
  if (!anywhere(anything_gone(), world)) return;
  const NewIDs now = new_ids();
  bigint of_rank[3] = {0, 0, 0}, all[3];    // bonds, atoms that lost some, atoms that lost all
  std::set<tagint> bodies;
  for (int i = 0; i < atom->nlocal; i++) {
    const int n = has(i) ? cut(i, now) : 0;
    if (n == 0) continue;
    of_rank[0] += n;
    of_rank[1]++;
    if (!renew(i)) {
      keep_first(i, 0);
      of_rank[2]++;
    }
    bodies.insert(atom->molecule[i]);
  }
  MPI_Allreduce(of_rank, all, 3, MPI_LMP_BIGINT, MPI_SUM, world);
  if (all[0] == 0) return;
  const auto changed = gather(bodies, world);
  std::vector<int> of_them;
  for (int i = 0; i < atom->nlocal; i++)
    if (has(i) && changed.count(atom->molecule[i])) of_them.push_back(i);
  correct_ends(of_them);
  if (comm->me == 0)
    utils::logmesg(lmp,
                   "  fsi/solid/tl: {} bonds to deleted particles are cut, gradients of {} "
                   "particles made anew, {} have no bonds left\n",
                   all[0], all[1], all[2]);
}

// contact would push bonded particles apart that have got molecule IDs of their own
void FixFSIReference::refuse_split_bodies() const
{
  for (const int i : solids)
    for (int k = 0; k < count(i); k++) {
      const int j = images.original(partners(i)[k]);
      if (atom->molecule[i] != atom->molecule[j])
        error->one(
            FLERR,
            "Solid atoms {} and {} are bonded, but of the bodies {} and {} now: a body keeps "
            "one molecule ID. To part it delete_atoms, and create a body in place of the "
            "rest",
            atom->tag[i], atom->tag[j], atom->molecule[i], atom->molecule[j]);
    }
}

// solids without a reference take the positions of now
void FixFSIReference::take_bare()
{
  std::vector<int> bare;
  for (int i = 0; i < atom->nlocal; i++)
    if (!has(i) && is_solid(i)) bare.push_back(i);
  if (!anywhere(!bare.empty(), world)) return;

  // a body is bonded at once
  std::set<tagint> bonded;
  for (int i = 0; i < atom->nlocal; i++)
    if (has(i)) bonded.insert(atom->molecule[i]);
  bonded = gather(bonded, world);
  for (const int i : bare)
    if (bonded.count(atom->molecule[i]))
      error->one(FLERR,
                 "Solid atom {} has no bonds to body {}, which took them when an earlier run "
                 "began: make a body at once, or give the atom a molecule ID of its own",
                 atom->tag[i], atom->molecule[i]);

  made = as_now();
  // from now on its strain says what it is
  for (const int i : bare) atom->rho[i] = disc->state[atom->type[i]].rho0;
  take(bare);
  correct_ends(bare);
}

// of these and no others, whose faces have not changed
void FixFSIReference::correct_ends(const std::vector<int> &of)
{
  if (!end_corrected) return;
  find_partners();
  find_weights(of);
}

std::string FixFSIReference::as_now() const
{
  std::string text = fmt::format("gradient {} volumes {}", quadratic ? "quadratic" : "linear",
                                 end_corrected ? "corrected" : "plain");
  for (const auto &plane : images.planes.wall)
    text += fmt::format(" symmetry {} {}", plane.face(), plane.position);
  return text;
}

void FixFSIReference::write_restart(FILE *fp)
{
  Record record(lmp, "fix FSI_REFERENCE");
  record.add("bonds", made.empty() ? as_now() : made);
  record.add("numbers of a bond", std::to_string(nvalue));
  record.add("stressed by", stressed_by);
  record.add("positions", keeps_places ? "yes" : "no");
  if (keeps_images) {
    record.add("images", "yes");
    std::vector<double> bodies;
    for (const auto &[body, bits] : self.joined)
      bodies.insert(bodies.end(), {(double) body, (double) bits});
    record.add("bodies at planes", bodies);
  }
  record.write(fp);
}

void FixFSIReference::restart(char *buf)
{
  const Record record(lmp, "fix FSI_REFERENCE", buf);
  made = record.value("bonds");
  if (record.has("stressed by")) stressed_by = record.value("stressed by");
  if (record.value("numbers of a bond") != std::to_string(nvalue))
    error->all(FLERR,
               "The restart file has bonds of {} numbers, this version of pair_style fsi/solid/tl "
               "needs {}",
               record.value("numbers of a bond"), nvalue);
  choose(record.has("images"), record.has("positions") && record.value("positions") == "yes");
  if (record.has("bodies at planes")) {
    const auto bodies = record.numbers("bodies at planes");
    for (size_t k = 0; k < bodies.size(); k += 2)
      self.joined[(tagint) bodies[k]] = (int) bodies[k + 1];
  }
  has_record = true;
}

void FixFSIReference::unpack_restart(int i, int nth)
{
  if (!has_record)
    error->one(FLERR,
               "The restart file was written by another version of the FSI package: it does not "
               "say what its bonds are");
  unpack(i, restart_values(atom->extra[i], nth) + 1);
}

double FixFSIReference::memory_usage()
{
  return BondStore::memory_usage() + damage.memory_usage() + bytes_of(self.pairs, self.image_pairs);
}
