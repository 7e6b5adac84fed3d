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
#include "domain.h"
#include "error.h"
#include "fix_fsi.h"
#include "fsi_bond_rows.h"
#include "fsi_cells.h"
#include "fsi_changes.h"
#include "fsi_contact.h"
#include "fsi_fields.h"
#include "fsi_find.h"
#include "fsi_gather.h"
#include "fsi_gradient.h"
#include "fsi_images.h"
#include "fsi_kernel.h"
#include "fsi_part.h"
#include "fsi_record.h"
#include "fsi_swaps.h"
#include "math_extra.h"
#include "memory.h"
#include "modify.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <set>
#include <type_traits>
#include <unordered_map>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace FSI;

// sites of a lattice at the cutoff weigh nothing: round-off does not choose among them
static constexpr double WITHIN = 1.0 - 1.0e-9;
// of the spacing: neighbors are no further from where a lattice has them
static constexpr double NEAR = 0.05;

struct FixFSIReference::Members {
  Swaps swaps;
  Images images;
  explicit Members(LAMMPS *lmp) : swaps(lmp) {}
};

FixFSIReference::FixFSIReference(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), members(new Members(lmp)), quadratic(true), end_corrected(true),
    nvalue(2 * domain->dimension + 2), self_range(0.0), tears(false), changes(0),
    swaps(members->swaps), images(members->images), fix_fsi(nullptr), slot(nullptr), maxbond(0),
    nmoment(packed_size(domain->dimension)), keeps_images(false), keeps_places(false), apart(0.0),
    layer(nullptr), next_look(0), expected(0)
{
  has_record = resting = false;
  restart_peratom = restart_global = 1;
  create_attribute = 1;
  stores_ids = 1;
  maxexchange = 2;
  maxexchange_dynamic = 1;
  comm_forward = 2 * domain->dimension;
  grow_arrays(atom->nmax);
  atom->add_callback(Atom::GROW);
  atom->add_callback(Atom::RESTART);
  for (int i = 0; i < atom->nlocal; i++) set_arrays(i);
}

FixFSIReference::~FixFSIReference()
{
  if (modify->get_fix_by_id(id)) {
    atom->delete_callback(id, Atom::GROW);
    atom->delete_callback(id, Atom::RESTART);
  }
  memory->destroy(slot);
  if (auto *const now = FixFSI::there(lmp)) now->changes.forget();
}

const double *FixFSIReference::bond(int i, int k) const
{
  return numbers(i) + number_of_bond(k, nvalue);
}

double *FixFSIReference::bond_in(int s, int k)
{
  return &data[(size_t) s * maxbond * nvalue] + number_of_bond(k, nvalue);
}

int FixFSIReference::nplace() const
{
  return keeps_places ? domain->dimension : 0;
}

void FixFSIReference::init()
{
  // has a script put in its place what is not of this package?
  resting = facts_of_solids(lmp).style != Facts::OF_TOTAL_LAGRANGIAN_SOLIDS;
  images.clear_planes();
  if (resting) return;
  fix_fsi = FixFSI::find(lmp, "Fix FSI_REFERENCE");
  find_planes();
  if (!any()) {
    made.clear();
    keeps_images = images.planes.any();
    through.resize(keeps_images ? partner.size() : 0);
    keeps_places = self_range > 0.0;
  } else if (made != as_now())
    error->all(FLERR,
               "Pair style fsi/solid/tl {}: the bonds of its bodies were made with {}, and stay so",
               as_now(), made);
  if (self_range > 0.0 && !keeps_places)
    error->all(
        FLERR,
        "Pair style fsi/solid/tl self yes needs positions in the reference, which are kept only if "
        "it is on when the reference is taken: give it before the first run of the bodies");
}

void FixFSIReference::find_planes()
{
  Walls walls;
  std::vector<WallForce> forces;
  for (auto *p : fixes_of<Part>(lmp)) p->add_walls(walls, forces);
  images.find_planes(walls, forces);
  if (!images.planes.any()) return;
  if (self_range > 0.0)
    error->all(FLERR,
               "Pair style fsi/solid/tl self yes does not go with symmetry yes of fix "
               "fsi/wall/mirror: a body would not meet its own image");
  const auto &planes = images.planes.wall;
  for (size_t b = 1; b < planes.size(); b++) {
    const double apart = planes[b].position - planes[b - 1].position;
    if (planes[b].axis == planes[b - 1].axis && std::fabs(apart) < 2.0 * fix_fsi->largest_cut)
      error->all(FLERR,
                 "Planes of symmetry at {} = {} and {} are too close: expected two supports of the "
                 "kernel, {}, between them",
                 "xyz"[planes[b].axis], planes[b - 1].position, planes[b].position,
                 2.0 * fix_fsi->largest_cut);
  }
}

bool FixFSIReference::any() const
{
  return anywhere(std::any_of(slot, slot + atom->nlocal,
                              [](int s) {
                                return s >= 0;
                              }),
                  world);
}

void FixFSIReference::setup_post_neighbor()
{
  if (resting) return;
  follow_commands();
  const int before = changes;
  take();
  // a restart file, which rank 0 describes, needs the same largest size everywhere
  int all;
  MPI_Allreduce(&maxbond, &all, 1, MPI_INT, MPI_MAX, world);
  reserve(all);
  if (changes == before) resolve();
  refuse_split_bodies();
  for (int i = 0; i < atom->nlocal; i++)
    if (slot[i] == NO_BONDS) slot[i] = FOREIGN;
  if (next_look != MAXBIGINT) next_look = update->ntimestep;
  look_for_passing();
}

void FixFSIReference::post_neighbor()
{
  if (resting) return;
  resolve();
  look_for_passing();
}

// without there is one of each particle
bool FixFSIReference::is_periodic() const
{
  return std::any_of(domain->periodicity, domain->periodicity + domain->dimension, [](int p) {
    return p != 0;
  });
}

bool FixFSIReference::is_solid(int i) const
{
  return fix_fsi->state[atom->type[i]].species == SOLID;
}

// Solids cannot become something else between runs, nor the reverse.
void FixFSIReference::refuse_other_materials() const
{
  const tagint *const tag = atom->tag;
  for (int i = 0; i < atom->nlocal; i++) {
    if (slot[i] == FOREIGN && is_solid(i))
      error->one(FLERR,
                 "Atom {} of type {} is a solid now and was none when a run began: delete it and "
                 "create a solid in its place",
                 tag[i], atom->type[i]);
    if (slot[i] < 0) continue;
    if (!is_solid(i))
      error->one(FLERR,
                 "Atom {} of type {} is bonded to body {} and no solid any more: delete it and "
                 "create another in its place",
                 tag[i], atom->type[i], atom->molecule[i]);
    // volumes are masses over densities
    const double rho = atom->rho[i], rho0 = fix_fsi->state[atom->type[i]].rho0;
    if (std::fabs(rho - rho0) > 1.0e-9 * rho0)
      error->one(FLERR,
                 "Solid atom {} has the mass of a material of density {:g}, but that of its type "
                 "{} has {:g} now: make the body anew",
                 tag[i], rho, atom->type[i], rho0);
  }
}

// What commands between runs have done to bodies. Delete_atoms gives all atoms new IDs unless
// told not to: each bonded atom knows its old one. Bonds to those that are gone are cut, as by
// damage.
void FixFSIReference::follow_commands()
{
  refuse_other_materials();
  const tagint *const tag = atom->tag;
  bool mine = false;
  for (int i = 0; i < atom->nlocal && !mine; i++) {
    if (slot[i] < 0) continue;
    mine = owner[slot[i]] != tag[i];
    for (int k = 0; k < nbond[slot[i]] && !mine; k++) {
      const tagint t = partner[(size_t) slot[i] * maxbond + k];
      mine = t > atom->map_tag_max || atom->map(t) < 0;
    }
  }
  if (!anywhere(mine, world)) return;

  std::vector<tagint> ids;    // old and new
  for (int i = 0; i < atom->nlocal; i++)
    if (slot[i] >= 0) {
      ids.push_back(owner[slot[i]]);
      ids.push_back(tag[i]);
    }
  ids = gather(ids, world);
  std::unordered_map<tagint, tagint> now;
  for (size_t k = 0; k < ids.size(); k += 2) now[ids[k]] = ids[k + 1];

  bigint cut[3] = {0, 0, 0}, all[3];    // bonds, atoms that lost some, atoms that lost all
  std::set<tagint> bodies;
  for (int i = 0; i < atom->nlocal; i++) {
    if (slot[i] < 0) continue;
    const int s = slot[i];
    const size_t first = (size_t) s * maxbond;
    int kept = 0;
    for (int k = 0; k < nbond[s]; k++) {
      const auto it = now.find(partner[first + k]);
      if (it == now.end()) continue;
      move_bond(s, k, kept);
      partner[first + kept] = it->second;
      kept++;
    }
    owner[s] = tag[i];
    if (kept == nbond[s]) continue;
    cut[0] += nbond[s] - kept;
    cut[1]++;
    bodies.insert(atom->molecule[i]);
    nbond[s] = kept;
    if (domain->dimension == 2 ? !renew<2>(i) : !renew<3>(i)) cut[2]++;
  }
  MPI_Allreduce(cut, all, 3, MPI_LMP_BIGINT, MPI_SUM, world);
  if (all[0] == 0) return;
  if (end_corrected) {
    const auto changed = gather(bodies, world);
    std::vector<int> of_them;
    for (int i = 0; i < atom->nlocal; i++)
      if (slot[i] >= 0 && changed.count(atom->molecule[i])) of_them.push_back(i);
    find_quadrature(of_them);
  }
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
void FixFSIReference::take()
{
  std::vector<int> bare;
  for (int i = 0; i < atom->nlocal; i++)
    if (slot[i] < 0 && is_solid(i)) bare.push_back(i);
  if (!anywhere(!bare.empty(), world)) return;

  // a body is bonded at once
  std::set<tagint> bonded;
  for (int i = 0; i < atom->nlocal; i++)
    if (slot[i] >= 0) bonded.insert(atom->molecule[i]);
  bonded = gather(bonded, world);
  for (const int i : bare)
    if (bonded.count(atom->molecule[i]))
      error->one(FLERR,
                 "Solid atom {} has no bonds to body {}, which took them when an earlier run "
                 "began: make a body at once, or give the atom a molecule ID of its own",
                 atom->tag[i], atom->molecule[i]);

  made = as_now();
  // from now on its strain says what it is
  for (const int i : bare) atom->rho[i] = fix_fsi->state[atom->type[i]].rho0;
  if (images.planes.any()) check_planes(bare);
  domain->dimension == 2 ? take_reference<2>(bare) : take_reference<3>(bare);
  if (end_corrected) find_quadrature(bare);
}

// The energy is an integral over particles in the middle of their cells: the midpoint rule,
// which lacks 1/n^2 of the bending stiffness of a plate n particles across. With its end
// corrections, 13/12, 7/8, 25/24 for the first three layers from a face (Press et al., Numerical
// Recipes, eq. 4.1.18), quadratic integrands are exact. They apply along each axis of the body's
// lattice; a body thinner than three layers, or not on a lattice, keeps plain volumes there.
// Masses do not change.

// a bond (numbers BOND_BLOCK apart) along a direction
static double along(int dim, const double *X, const double *e)
{
  double s = 0.0;
  for (int a = 0; a < dim; a++) s += X[a * BOND_BLOCK] * e[a];
  return s;
}

static bool nearest(int dim, const double *X, double dx)
{
  double rsq = 0.0;
  for (int a = 0; a < dim; a++) rsq += X[a * BOND_BLOCK] * X[a * BOND_BLOCK];
  return std::fabs(std::sqrt(rsq) - dx) < NEAR * dx;
}

// axes of the lattice that i is on, from its nearest neighbors; false if these are too few
bool FixFSIReference::find_axes(int i, Axes &axes) const
{
  const int dim = domain->dimension;
  const double dx = fix_fsi->dx_of(atom->type[i]);
  double(*const e)[3] = axes.e;
  int k = 0;
  axes = {atom->molecule[i], atom->tag[i], {}};
  for (int b = 0; b < count(i) && k < dim - 1; b++) {
    const double *const X = bond(i, b) + dim * BOND_BLOCK;
    if (!nearest(dim, X, dx) || (k && std::fabs(along(dim, X, e[0])) > NEAR * dx)) continue;
    for (int a = 0; a < dim; a++) e[k][a] = X[a * BOND_BLOCK] / dx;
    k++;
  }
  if (dim == 3) {
    MathExtra::cross3(e[0], e[1], e[2]);
  } else {
    e[1][0] = -e[0][1];
    e[1][1] = e[0][0];
  }
  return k == dim - 1;
}

// whether all nearest neighbors of i lie along them, none of them behind a plane of symmetry
bool FixFSIReference::fits(int i, const Axes &axes) const
{
  const int dim = domain->dimension;
  const double dx = fix_fsi->dx_of(atom->type[i]);
  for (int b = 0; b < count(i); b++) {
    const double *const X = bond(i, b) + dim * BOND_BLOCK;
    int across = 0;
    for (int k = 0; k < dim; k++) across += std::fabs(along(dim, X, axes.e[k])) < NEAR * dx;
    if (nearest(dim, X, dx) && across < dim - 1) return false;
    if (keeps_images && through[(size_t) slot[i] * maxbond + b]) return false;
  }
  return true;
}

// axes of the lattices that are turned against the axes of the box, by body
std::map<tagint, FixFSIReference::Axes>
FixFSIReference::turned_lattices(const std::vector<int> &bare) const
{
  std::map<tagint, Axes> first, turned;    // of the first particle that has some
  Axes axes;
  const auto enter = [&first](const Axes &a) {
    const auto at = first.emplace(a.body, a).first;
    if (a.tag < at->second.tag) at->second = a;
  };
  for (const int i : bare)
    if (find_axes(i, axes)) enter(axes);
  std::vector<Axes> mine;
  for (const auto &body : first) mine.push_back(body.second);
  for (const auto &a : gather(mine, world)) enter(a);

  for (const auto &body : first) {
    for (const auto &e : body.second.e)
      for (const double c : e)
        if (std::fabs(c) > NEAR && std::fabs(c) < 1.0 - NEAR) turned.insert(body);
  }
  if (turned.empty()) return turned;
  std::set<tagint> no_lattice;
  for (const int i : bare) {
    const auto body = turned.find(atom->molecule[i]);
    if (body != turned.end() && !fits(i, body->second)) no_lattice.insert(body->first);
  }
  for (const tagint body : gather(no_lattice, world)) turned.erase(body);
  return turned;
}

void FixFSIReference::find_quadrature(const std::vector<int> &bare)
{
  static constexpr double correction[4] = {0.0, 1.0 / 12.0, -1.0 / 8.0, 1.0 / 24.0};
  const int dim = domain->dimension;
  resolve();
  std::vector<double> layers((size_t) atom->nmax * 2 * dim, 0.0);
  layer = layers.data();
  const auto turned = turned_lattices(bare);
  const Axes box = {0, 0, {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}};

  bigint of_bars = 0;    // of three particles across or fewer, along two axes
  // per particle, partners one spacing away along directions 2 axis + (positive side), or -1
  std::vector<std::array<int, 6>> ahead;
  for (const int i : bare) {
    ahead.emplace_back();
    ahead.back().fill(-1);
    const auto it = turned.find(atom->molecule[i]);
    const Axes &axes = it == turned.end() ? box : it->second;
    const double dx = fix_fsi->dx_of(atom->type[i]), near = NEAR * dx;
    for (int b = 0; b < count(i); b++) {
      const double *const X = bond(i, b) + dim * BOND_BLOCK;
      double rsq = 0.0;
      for (int a = 0; a < dim; a++) rsq += X[a * BOND_BLOCK] * X[a * BOND_BLOCK];
      if (rsq > 1.7 * dx * dx) continue;    // most: no need to look closer
      int direction = -1, others = 0;
      for (int a = 0; a < dim; a++) {
        const double s = along(dim, X, axes.e[a]);
        if (std::fabs(s) <= near)
          others++;
        else if (std::fabs(std::fabs(s) - dx) <= near)
          direction = 2 * a + (s > 0.0);
      }
      if (others < dim - 1 || direction < 0 || ahead.back()[direction] >= 0) continue;
      ahead.back()[direction] = partners(i)[b];
    }
  }
  // that of an image is that of its original, seen in the mirror
  const auto layer_of = [&](int j, int k) {
    return layer[images.original(j) * 2 * dim + (images.mirrors(j, k / 2) ? k ^ 1 : k)];
  };
  // layer 1 has nobody ahead, layer m has layer m-1 ahead; 0 = deeper than what has been found so
  // far
  for (int m = 1; m <= 3; m++) {
    for (size_t n = 0; n < bare.size(); n++)
      for (int i = bare[n], k = 0; k < 2 * dim; k++) {
        const int j = ahead[n][k];
        if (m == 1 ? j < 0 : (j >= 0 && layer_of(j, k) == m - 1)) layer[i * 2 * dim + k] = m;
      }
    comm->forward_comm(this);
  }
  for (const int i : bare) {
    double w = 1.0;
    int few = 0;
    for (int a = 0; a < dim; a++) {
      const int lo = (int) layer[i * 2 * dim + 2 * a], hi = (int) layer[i * 2 * dim + 2 * a + 1];
      few += lo && hi && lo + hi <= 4;    // three layers or fewer
      // fewer than three layers: no correction along this axis
      if ((lo && hi && lo + hi < 4)) continue;
      w *= 1.0 + correction[lo] + correction[hi];
    }
    quadrature[slot[i]] = w;
    of_bars += few > 1;
  }
  layer = nullptr;
  if (dim == 2) return;
  // a lattice of three by three cannot warp
  bigint mine[2] = {(bigint) bare.size(), of_bars}, all[2];
  MPI_Allreduce(mine, all, 2, MPI_LMP_BIGINT, MPI_SUM, world);
  if (2 * all[1] > all[0] && comm->me == 0)
    error->warning(FLERR,
                   "Pair style fsi/solid/tl: {} of {} particles are of bars of three particles or "
                   "fewer through the thickness: twisted, their frequency is 10 to 16 % too high. "
                   "Take four",
                   all[1], all[0]);
}

int FixFSIReference::pack_forward_comm(int n, int *list_, double *buf, int, int *)
{
  int m = 0;
  for (int ii = 0; ii < n; ii++)
    for (int k = 0; k < comm_forward; k++) buf[m++] = layer[list_[ii] * comm_forward + k];
  return m;
}

void FixFSIReference::unpack_forward_comm(int n, int first, double *buf)
{
  memcpy(layer + (size_t) first * comm_forward, buf, (size_t) n * comm_forward * sizeof(double));
}

// the neighbors of i of its own body, their separations, and weights V_j W
template <int D, class Kernel>
void FixFSIReference::find_neighbors(int i, const Kernel &kernel, const Cells &solids,
                                     std::vector<int> &near, std::vector<double> &dX,
                                     std::vector<double> &w) const
{
  double **x = atom->x;
  const tagint *const tag = atom->tag, *const molecule = atom->molecule;
  const int *const type = atom->type, type_i = type[i];
  const bool periodic = is_periodic();
  const double *const xi = x[i], cutsq = WITHIN * kernel.cutsq;
  const tagint body = molecule[i];
  near.clear();
  solids.around(xi, kernel.cut, [&](int j, double rsq) {
    if (rsq < cutsq && j != i && molecule[j] == body) near.push_back(j);
  });
  // whatever ranks there are
  std::sort(near.begin(), near.end(), [tag](int a, int b) {
    return tag[a] < tag[b];
  });
  dX.resize(near.size() * D);
  w.resize(near.size());
  for (size_t k = 0; k < near.size(); k++) {
    const int j = near[k];
    double rsq = 0.0, *const d = &dX[k * D];
    bool halfway = false;    // round the box: the image on the other side is as near
    for (int a = 0; a < D; a++) {
      d[a] = x[j][a] - xi[a];
      rsq += d[a] * d[a];
      halfway = halfway ||
          (periodic && domain->periodicity[a] &&
           2.0 * std::fabs(d[a]) > (1.0 - 1.0e-9) * domain->prd[a]);
    }
    if (type[j] != type_i && fix_fsi->h_of(type[j]) != fix_fsi->h_of(type_i))
      error->one(FLERR,
                 "Solid atoms {} and {} of body {} have the spacings {:g} and {:g} of types {} and "
                 "{}: a body has one",
                 tag[i], tag[j], molecule[i], fix_fsi->dx_of(type[i]), fix_fsi->dx_of(type[j]),
                 type[i], type[j]);
    if (rsq == 0.0)
      error->one(
          FLERR,
          "Solid atoms {} and {} of body {} are at the same place: regions overlap, or share "
          "an edge that particles lie on; delete_atoms overlap",
          tag[i], tag[j], molecule[i]);
    if (halfway || (periodic && domain->closest_image(i, j) != j))
      error->one(FLERR,
                 "Solid atoms {} and {} are neighbors through more than one image: a periodic box "
                 "must be wider than two supports, {}, of the kernel",
                 tag[i], tag[j], 2.0 * kernel.cut);
    w[k] = volume(j) * kernel.W(std::sqrt(rsq));
  }
}

// likewise images of its neighbors and of itself in planes of symmetry
template <int D, class Kernel>
void FixFSIReference::find_images(int i, const Kernel &kernel, std::vector<int> &near,
                                  std::vector<double> &dX, std::vector<double> &w,
                                  std::vector<int> &bits) const
{
  double **x = atom->x;
  const int own = images.joins(atom->mask, i) ? images.planes.near(x[i], kernel.cut) : 0;
  bits.assign(near.size(), 0);
  if (!own) return;
  const auto add = [&](int j, double rsq) {
    images.planes.images(own & images.planes.near(x[j], kernel.cut), rsq, x[i], x[j],
                         WITHIN * kernel.cutsq,
                         [&](const Walls::Reflection &s, double image_rsq, const double *away) {
                           near.push_back(j);
                           bits.push_back(s.mask);
                           for (int a = 0; a < D; a++) dX.push_back(-away[a]);
                           w.push_back(volume(j) * kernel.W(std::sqrt(image_rsq)));
                         });
  };
  const int n = near.size();
  add(i, 0.0);
  for (int k = 0; k < n; k++) {
    if (!images.joins(atom->mask, near[k])) continue;
    double rsq = 0.0;
    for (int a = 0; a < D; a++) rsq += dX[k * D + a] * dX[k * D + a];
    add(near[k], rsq);
  }
}

// Bodies that are cut by a plane of symmetry: their particles are where the lattice of the whole
// has them, before the plane. Those that end short of it would be glued to their images.
void FixFSIReference::check_planes(const std::vector<int> &bare) const
{
  static constexpr double LEAST = 0.25, MOST = 0.75;    // spacings, half a one is meant
  for (const auto &plane : images.planes.wall) {
    std::set<tagint> there, close;
    for (const int i : bare) {
      if (!(atom->mask[i] & plane.joins)) continue;
      const double dx = fix_fsi->dx_of(atom->type[i]), d = plane.distance(atom->x[i]);
      const char *const face = plane.side > 0.0 ? "lo" : "hi";
      if (d < LEAST * dx)
        error->one(FLERR,
                   "Solid atom {} of body {} is {:g} before the plane of symmetry {}{} {}: "
                   "expected half a spacing, {:g}, or more",
                   atom->tag[i], atom->molecule[i], d, "xyz"[plane.axis], face, plane.position,
                   0.5 * dx);
      if (d < MOST * dx) there.insert(atom->molecule[i]);
      if (d < fix_fsi->resolution[atom->type[i]].cut / 2.0) close.insert(atom->molecule[i]);
    }
    there = gather(there, world);
    for (const tagint body : gather(close, world))
      if (!there.count(body))
        error->all(
            FLERR,
            "Body {} ends short of the plane of symmetry at {} = {}: expected half a spacing "
            "between them, or leave it out of the group of fix fsi/wall/mirror",
            body, "xyz"[plane.axis], plane.position);
  }
}

// a slot with the bonds of i to them
template <int D, class Kernel>
void FixFSIReference::enter_bonds(int i, const Kernel &kernel, const std::vector<int> &near,
                                  const std::vector<double> &dX, const std::vector<double> &G,
                                  const std::vector<int> &bits)
{
  const int n = near.size();
  const double own = volume(i);
  slot[i] = new_slot(n);
  owner[slot[i]] = atom->tag[i];
  if (keeps_places) std::copy_n(atom->x[i], D, &place[(size_t) slot[i] * D]);
  for (int k = 0; k < n; k++) {
    double *const value = bond_in(slot[i], k);
    const double *d = &dX[k * D];
    double rsq = 0.0;
    for (int a = 0; a < D; a++) {
      value[a * BOND_BLOCK] = G[k * D + a];
      value[(D + a) * BOND_BLOCK] = d[a];
      rsq += d[a] * d[a];
    }
    const double r = std::sqrt(rsq), vv = own * volume(near[k]);
    value[2 * D * BOND_BLOCK] = vv * kernel.W(r) / rsq;
    value[(2 * D + 1) * BOND_BLOCK] = vv * kernel.gradient(r);
    partner[(size_t) slot[i] * maxbond + k] = atom->tag[near[k]];
    if (keeps_images) through[(size_t) slot[i] * maxbond + k] = bits[k];
  }
  complete_as<D>(slot[i]);
}

double FixFSIReference::volume(int i) const
{
  return atom->rmass[i] / fix_fsi->state[atom->type[i]].rho0;
}

template <int D> void FixFSIReference::take_reference(const std::vector<int> &bare)
{
  const int *const type = atom->type;
  // bodies by their smoothing length, in the order of the first of each
  std::vector<double> all_h;
  for (const int i : bare)
    if (std::find(all_h.begin(), all_h.end(), fix_fsi->h_of(type[i])) == all_h.end())
      all_h.push_back(fix_fsi->h_of(type[i]));
  // LAMMPS' list would be of all particles, and stay
  const double widest = fix_fsi->largest_cut;
  const Cells solids(atom->x, atom->nlocal + atom->nghost, D, widest / 3.0, [this](int i) {
    return is_solid(i);
  });
  GradientWeights<D> weights;
  std::vector<int> near, bits;
  std::vector<double> dX, w, G;
  bigint mine[6] = {};    // particles, bonds, particles by order reached
  expected = nbond.size() - unused.size() + bare.size();
  hold(expected);

  for (const double h : all_h)
    with_kernel(fix_fsi->kernel, D, h, [&](const auto &kernel) {
      if constexpr (std::decay_t<decltype(kernel)>::DIM == D)
        for (const int i : bare) {
          if (fix_fsi->h_of(type[i]) != h) continue;
          find_neighbors<D>(i, kernel, solids, near, dX, w);
          if (images.planes.any()) find_images<D>(i, kernel, near, dX, w, bits);
          const int n = near.size();
          G.resize((size_t) n * D);
          const auto order = weights(n, dX.data(), w.data(), h, quadratic, G.data());
          if (order == GradientWeights<D>::DEFICIENT)
            error->one(FLERR,
                       "Solid atom {} of body {} has {} neighbors of its own body within {}: too "
                       "few, or all in one {}, for a deformation gradient. A body must be at least "
                       "two particles thick, and one body one molecule ID",
                       atom->tag[i], atom->molecule[i], n, kernel.cut, D == 2 ? "line" : "plane");
          mine[0]++;
          mine[1] += n;
          mine[2 + order]++;
          enter_bonds<D>(i, kernel, near, dX, G, bits);
        }
    });

  bigint all[6];
  MPI_Allreduce(mine, all, 6, MPI_LMP_BIGINT, MPI_SUM, world);
  if (comm->me == 0) {
    utils::logmesg(lmp, "  fsi/solid/tl: reference of {} particles taken, {:.1f} bonds each\n",
                   all[0], double(all[1]) / all[0]);
    if (quadratic)
      utils::logmesg(lmp,
                     "    gradients: {} exact for quadratic fields, {} for part of their terms, {} "
                     "for linear fields only\n",
                     all[2 + GradientWeights<D>::QUADRATIC], all[2 + GradientWeights<D>::PARTIAL],
                     all[2 + GradientWeights<D>::LINEAR]);
  }
}

void FixFSIReference::break_bonds(double stretch, const Energy &energy,
                                  const std::function<double(int)> &spare)
{
  domain->dimension == 2 ? break_bonds_of_all<2>(stretch, energy, spare)
                         : break_bonds_of_all<3>(stretch, energy, spare);
}

// Nobody of this rank's solids moves relative to anybody else by more than the diagonal of the box
// that holds all their displacements. So a particle whose most stretched bond has more than this
// left is not looked at, and the same bonds break at the same step.
template <int D> void FixFSIReference::move_apart()
{
  double **x = atom->x;
  const size_t size = (solids.size() + ghosts.size()) * D;
  const bool anew = seen.size() != size;
  if (anew) {
    seen.resize(size);
    slack.assign(nbond.size(), 0.0);
  }
  double lo[D], hi[D], sum = 0.0, *before = seen.data();
  std::fill_n(lo, D, std::numeric_limits<double>::max());
  std::fill_n(hi, D, -std::numeric_limits<double>::max());
  for (const auto *set : {&solids, &ghosts})
    for (const int i : *set)
      for (int a = 0; a < D; a++) {
        const double d = x[i][a] - *before;
        *before++ = x[i][a];
        lo[a] = std::min(lo[a], d);
        hi[a] = std::max(hi[a], d);
      }
  // images move the other way
  for (const auto &plane : images.planes.wall) {
    hi[plane.axis] = std::max(hi[plane.axis], -lo[plane.axis]);
    lo[plane.axis] = -hi[plane.axis];
  }
  for (int a = 0; a < D; a++) sum += (hi[a] - lo[a]) * (hi[a] - lo[a]);
  apart = anew ? 0.0 : apart + std::sqrt(sum) + 1e-9 * fix_fsi->dx;    // more than round-off
}

template <int D>
void FixFSIReference::break_bonds_of_all(double stretch, const Energy &energy,
                                         const std::function<double(int)> &spare)
{
  const double limit = stretch * stretch;
  if (solids.empty()) return;
  move_apart<D>();
  images.update(atom->x, atom->v);
  double **x = images.positions(atom->x);
  for (const int i : solids) {
    double &reserve = slack[slot[i]];
    const size_t first = (size_t) slot[i] * maxbond;
    int &n = nbond[slot[i]];
    if (apart < reserve) continue;
    reserve = std::numeric_limits<double>::max();
    double &volume = quadrature[slot[i]];
    const auto crush = [&]() {
      if (n == 0 || volume == 0.0) return;
      const double left = spare(i);
      reserve = std::min(reserve, apart + left);
      if (left > 0.0) return;
      volume = 0.0;
      changes++;
    };
    crush();
    const auto longer = [&](int k) {
      const double *const X = bond(i, k) + D * BOND_BLOCK, *const xj = x[local[first + k]];
      double rsq = 0.0, Rsq = 0.0;
      for (int a = 0; a < D; a++) {
        rsq += (xj[a] - x[i][a]) * (xj[a] - x[i][a]);
        Rsq += X[a * BOND_BLOCK] * X[a * BOND_BLOCK];
      }
      if (rsq > limit * Rsq) return true;
      reserve = std::min(reserve, apart + stretch * std::sqrt(Rsq) - std::sqrt(rsq));
      return false;
    };
    double before = -1.0;
    int kept = 0;
    for (int k = 0; k < n; k++) {
      if (longer(k)) {
        if (before < 0.0) before = energy(i);
        continue;
      }
      if (kept < k) move_bond(slot[i], k, kept);
      kept++;
    }
    if (kept == n) continue;
    n = kept;
    renew<D>(i);
    crush();
    const double after = energy(i);
    if (after > before) volume *= before / after;
    changes++;
  }
}

// the gradient's weights from the bonds that are left; if they do not suffice, none is
template <int D> bool FixFSIReference::renew(int i)
{
  int &n = nbond[slot[i]];
  GradientWeights<D> weights;
  std::vector<double> dX((size_t) n * D), w(n), G((size_t) n * D);
  for (int k = 0; k < n; k++) {
    const double *const value = bond(i, k);
    double Rsq = 0.0;
    for (int a = 0; a < D; a++) {
      const double X = value[(D + a) * BOND_BLOCK];
      dX[k * D + a] = X;
      Rsq += X * X;
    }
    w[k] = value[2 * D * BOND_BLOCK] * Rsq;    // V_i V_j W: the factor V_i does not matter
  }
  if (weights(n, dX.data(), w.data(), fix_fsi->h_of(atom->type[i]), quadratic, G.data()) ==
      GradientWeights<D>::DEFICIENT) {
    n = 0;
    return false;
  }
  for (int k = 0; k < n; k++)
    for (int a = 0; a < D; a++) bond_in(slot[i], k)[a * BOND_BLOCK] = G[k * D + a];
  complete(slot[i]);
  return true;
}

// where the partners of each bond are: after atoms or ghosts have changed
void FixFSIReference::resolve()
{
  const tagint *const tag = atom->tag;
  const bool periodic = is_periodic();
  solids.clear();
  ghosts.clear();
  images.begin(atom->nlocal + atom->nghost);
  for (int i = 0; i < atom->nlocal; i++) {
    if (!is_solid(i)) continue;
    if (slot[i] < 0)
      error->one(FLERR,
                 "Solid atom {} has no reference configuration: it was made during a run. Make it "
                 "before one",
                 tag[i]);
    solids.push_back(i);
    const size_t first = (size_t) slot[i] * maxbond;
    const tagint *const of_i = &partner[first];
    int *const local_of_i = &local[first];
    const int n = nbond[slot[i]];
    for (int k = 0; k < n; k++) {
      const tagint t = of_i[k];
      int j = atom->map(t);
      if (j >= 0 && periodic) {
        // the image that is meant may be beyond the ghosts, too
        j = domain->closest_image(i, j);
        for (int a = 0; a < domain->dimension; a++)
          if (domain->periodicity[a] &&
              std::fabs(atom->x[j][a] - atom->x[i][a]) > 0.5 * domain->prd[a]) {
            j = -1;
            break;
          }
      }
      if (j < 0)
        error->one(FLERR,
                   "Bond of solid atoms {} and {} reaches beyond the ghost cutoff {}: one of them "
                   "was lost, the solid blew up (try a shorter time step, more sub-steps), or it "
                   "is stretched so far that comm_modify cutoff must be larger",
                   tag[i], t,
                   comm->cutghostuser > neighbor->cutneighmax ? comm->cutghostuser
                                                              : neighbor->cutneighmax);
      local_of_i[k] = keeps_images && through[first + k] ? images.find(j, through[first + k]) : j;
    }
    std::fill(local_of_i + n, local_of_i + whole_blocks(n), i);
  }
  for (int i = atom->nlocal; i < atom->nlocal + atom->nghost; i++)
    if (is_solid(i)) ghosts.push_back(i);
  changes++;
  seen.clear();
  swaps.find([this](int i) {
    return is_solid(i);
  });
  find_self_pairs();
}

// contact of a body with itself
bool FixFSIReference::bonded(int i, int j) const
{
  const tagint *const first = &partner[(size_t) slot[i] * maxbond];
  return std::find(first, first + count(i), atom->tag[j]) != first + count(i);
}

void FixFSIReference::find_self_pairs()
{
  near_itself.clear();
  if (self_range == 0.0) return;
  const int dim = domain->dimension;
  const double *const *const x = atom->x;
  std::vector<double> places((size_t) atom->nmax * comm_forward);
  layer = places.data();
  double widest = 0.0;
  for (const int i : solids) {
    std::copy_n(&place[(size_t) slot[i] * dim], dim, layer + (size_t) i * comm_forward);
    widest = std::max(widest, fix_fsi->dx_of(atom->type[i]));
  }
  comm->forward_comm(this);
  layer = nullptr;

  const Cells cells(x, atom->nlocal + atom->nghost, dim, self_range * widest + neighbor->skin,
                    [this](int i) {
                      return is_solid(i);
                    });
  for (const int i : solids) {
    const double most = self_range * fix_fsi->dx_of(atom->type[i]),
                 support = fix_fsi->resolution[atom->type[i]].cut;
    const size_t first = near_itself.size();
    cells.around(x[i], [&](int j, double rsq) {
      if (j == i || atom->molecule[j] != atom->molecule[i]) return;
      double Rsq = 0.0;
      for (int a = 0; a < dim; a++) {
        double X = places[(size_t) j * comm_forward + a] - places[(size_t) i * comm_forward + a];
        if (domain->periodicity[a]) X -= domain->prd[a] * std::round(X / domain->prd[a]);
        Rsq += X * X;
      }
      const bool neighbors = Rsq < WITHIN * support * support;
      if (neighbors && !tears) return;
      const double reach = reach_within_body(most, std::sqrt(Rsq), neighbors),
                   near = reach + neighbor->skin;
      if (rsq < near * near) near_itself.push_back({i, j, reach, neighbors});
    });
    // sums do not depend on the order of ghosts
    std::sort(near_itself.begin() + first, near_itself.end(), [this](const auto &a, const auto &b) {
      return atom->tag[a.j] < atom->tag[b.j];
    });
  }
}

// Without contact parts of one body pass through each other. Looked for rarely: it takes long, and
// nothing depends on it but a warning.
void FixFSIReference::look_for_passing()
{
  static constexpr int EVERY = 200;      // steps
  static constexpr double NEAR = 0.9;    // spacings
  if (update->ntimestep < next_look || self_range > 0.0) return;
  next_look = update->ntimestep + EVERY;
  double widest = 0.0;
  for (const int i : solids) widest = std::max(widest, fix_fsi->dx_of(atom->type[i]));
  struct {
    double r;
    tagint a, b, body;
  } mine = {NEAR, 0, 0, 0};
  if (!solids.empty()) {
    const Cells cells(atom->x, atom->nlocal + atom->nghost, domain->dimension, NEAR * widest,
                      [this](int i) {
                        return is_solid(i);
                      });
    for (const int i : solids)
      cells.around(atom->x[i], [&](int j, double rsq) {
        const double r = std::sqrt(rsq) / fix_fsi->dx_of(atom->type[i]);
        if (r >= mine.r || j == i || atom->molecule[j] != atom->molecule[i] || bonded(i, j)) return;
        mine = {r, std::min(atom->tag[i], atom->tag[j]), std::max(atom->tag[i], atom->tag[j]),
                atom->molecule[i]};
      });
  }
  const auto least = of_least(mine.r, mine, world);
  if (least.r >= NEAR) return;
  next_look = MAXBIGINT;
  if (comm->me == 0)
    error->warning(FLERR,
                   "Pair style fsi/solid/tl: atoms {} and {} of body {} have no bond and are "
                   "{:.2g} spacings apart at step {}: parts of one body pass through each other. "
                   "If they are two bodies, give each a molecule ID; for contact of a body with "
                   "itself contact 2 self yes",
                   least.a, least.b, least.body, least.r, update->ntimestep);
}

void FixFSIReference::move_bond(int s, int from, int to)
{
  const size_t first = (size_t) s * maxbond;
  local[first + to] = local[first + from];
  partner[first + to] = partner[first + from];
  if (keeps_images) through[first + to] = through[first + from];
  for (int v = 0; v < nvalue; v++)
    bond_in(s, to)[v * BOND_BLOCK] = bond_in(s, from)[v * BOND_BLOCK];
}

// what follows from the bonds of slot s
void FixFSIReference::complete(int s)
{
  domain->dimension == 2 ? complete_as<2>(s) : complete_as<3>(s);
}

template <int D> void FixFSIReference::complete_as(int s)
{
  const int n = nbond[s];
  double *const numbers_of = bond_in(s, 0), M[packed_size(D)] = {};
  for (int k = n; k < whole_blocks(n); k++)
    for (int v = 0; v < nvalue; v++) numbers_of[number_of_bond(k, nvalue) + v * BOND_BLOCK] = 0.0;
  for (int k = 0; k < n; k++) {
    const double *const X = numbers_of + number_of_bond(k, 2 * D + 2) + D * BOND_BLOCK,
                        w = X[D * BOND_BLOCK];
    for (int a = 0, m = 0; a < D; a++)
      for (int c = 0; c <= a; c++) M[m++] += w * X[a * BOND_BLOCK] * X[c * BOND_BLOCK];
  }
  std::copy_n(M, packed_size(D), &moment[(size_t) s * packed_size(D)]);
}

// what slots have of each bond: the lists, and how many numbers
template <class Call> void FixFSIReference::each_list(Call call)
{
  call(local, 1);
  call(partner, 1);
  if (keeps_images) call(through, 1);
  call(data, nvalue);
}

// every slot holds n bonds: one size, so that a freed slot serves any atom
void FixFSIReference::reserve(int n)
{
  if (n <= maxbond) return;
  const int old = maxbond, slots = nbond.size();
  maxbond = whole_blocks(n);
  maxexchange = 3 + maxbond * (nvalue + nwhole()) + nplace();
  each_list([&](auto &list, int width) {
    std::decay_t<decltype(list)> wider;
    wider.reserve(std::max((size_t) slots, expected) * maxbond * width);
    wider.resize((size_t) slots * maxbond * width);
    for (int s = 0; s < slots; s++)
      std::copy_n(list.begin() + (size_t) s * old * width, (size_t) whole_blocks(nbond[s]) * width,
                  wider.begin() + (size_t) s * maxbond * width);
    list.swap(wider);
  });
}

// room for so many slots: bodies are large, and lists that grow are there twice while they do
void FixFSIReference::hold(size_t n)
{
  each_list([&](auto &list, int width) {
    list.reserve(n * maxbond * width);
  });
  moment.reserve(n * packed_size(domain->dimension));
}

int FixFSIReference::new_slot(int n)
{
  reserve(n);
  int s;
  if (unused.empty()) {
    s = nbond.size();
    nbond.push_back(n);
    owner.push_back(0);
    quadrature.push_back(1.0);
    if (keeps_places) place.resize(nbond.size() * domain->dimension);
    each_list([&](auto &list, int width) {
      list.resize(nbond.size() * maxbond * width);
    });
    moment.resize(nbond.size() * packed_size(domain->dimension));
  } else {
    s = unused.back();
    unused.pop_back();
    nbond[s] = n;
    quadrature[s] = 1.0;
  }
  return s;
}

void FixFSIReference::grow_arrays(int n)
{
  memory->grow(slot, n, "FSI_REFERENCE:slot");
}

void FixFSIReference::copy_arrays(int i, int j, int delflag)
{
  // when atom j is deleted its place becomes free; otherwise its bonds have moved on with an
  // earlier copy
  if (delflag && slot[j] >= 0) unused.push_back(slot[j]);
  slot[j] = slot[i];
}

// number of bonds, then partner and values of each
int FixFSIReference::pack(int i, double *buf) const
{
  int m = 0;
  const int n = slot[i] < 0 ? slot[i] : nbond[slot[i]];
  buf[m++] = ubuf(n).d;
  if (n < 0) return m;
  buf[m++] = quadrature[slot[i]];
  const size_t first = (size_t) slot[i] * maxbond;
  for (int k = 0; k < n; k++) buf[m++] = ubuf(partner[first + k]).d;
  for (int k = 0; k < n && keeps_images; k++) buf[m++] = ubuf(through[first + k]).d;
  for (int k = 0; k < n; k++)
    for (int v = 0; v < nvalue; v++) buf[m++] = bond(i, k)[v * BOND_BLOCK];
  for (int a = 0; a < nplace(); a++) buf[m++] = place[(size_t) slot[i] * nplace() + a];
  return m;
}

int FixFSIReference::unpack(int i, const double *buf)
{
  int m = 0;
  const int n = (int) ubuf(buf[m++]).i;
  slot[i] = n;
  if (n < 0) return m;
  slot[i] = new_slot(n);
  owner[slot[i]] = atom->tag[i];
  quadrature[slot[i]] = buf[m++];
  const size_t first = (size_t) slot[i] * maxbond;
  for (int k = 0; k < n; k++) partner[first + k] = (tagint) ubuf(buf[m++]).i;
  for (int k = 0; k < n && keeps_images; k++) through[first + k] = (int) ubuf(buf[m++]).i;
  for (int k = 0; k < n; k++)
    for (int v = 0; v < nvalue; v++) bond_in(slot[i], k)[v * BOND_BLOCK] = buf[m++];
  for (int a = 0; a < nplace(); a++) place[(size_t) slot[i] * nplace() + a] = buf[m++];
  complete(slot[i]);
  return m;
}

// delete_atoms may have given the atom another ID since its bonds were looked at
int FixFSIReference::pack_exchange(int i, double *buf)
{
  buf[0] = ubuf(slot[i] < 0 ? 0 : owner[slot[i]]).d;
  return 1 + pack(i, buf + 1);
}

int FixFSIReference::unpack_exchange(int i, double *buf)
{
  const int n = 1 + unpack(i, buf + 1);
  if (slot[i] >= 0) owner[slot[i]] = (tagint) ubuf(buf[0]).i;
  return n;
}

int FixFSIReference::pack_restart(int i, double *buf)
{
  if (slot[i] >= 0 && owner[slot[i]] != atom->tag[i])
    error->one(FLERR,
               "Solid atom {} was atom {} in the last run: after delete_atoms give run 0 before a "
               "restart file is written",
               atom->tag[i], owner[slot[i]]);
  buf[0] = 1 + pack(i, buf + 1);
  return (int) buf[0];
}

std::string FixFSIReference::as_now() const
{
  std::string text = fmt::format("gradient {} volumes {}", quadratic ? "quadratic" : "linear",
                                 end_corrected ? "corrected" : "plain");
  for (const auto &plane : images.planes.wall)
    text += fmt::format(" symmetry {}{} {}", "xyz"[plane.axis], plane.side > 0.0 ? "lo" : "hi",
                        plane.position);
  return text;
}

void FixFSIReference::write_restart(FILE *fp)
{
  Record record(lmp, "fix FSI_REFERENCE");
  record.add("bonds", made.empty() ? as_now() : made);
  record.add("numbers of a bond", std::to_string(nvalue));
  record.add("positions", keeps_places ? "yes" : "no");
  if (keeps_images) record.add("images", "yes");
  record.write(fp);
}

void FixFSIReference::restart(char *buf)
{
  const Record record(lmp, "fix FSI_REFERENCE", buf);
  made = record.value("bonds");
  if (record.value("numbers of a bond") != std::to_string(nvalue))
    error->all(FLERR,
               "The restart file has bonds of {} numbers, this version of pair_style fsi/solid/tl "
               "needs {}",
               record.value("numbers of a bond"), nvalue);
  keeps_places = record.has("positions") && record.value("positions") == "yes";
  keeps_images = record.has("images");
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

int FixFSIReference::size_restart(int i)
{
  return slot[i] < 0 ? 2 : 3 + nbond[slot[i]] * (nvalue + nwhole()) + nplace();
}

double FixFSIReference::memory_usage()
{
  return (double) atom->nmax * sizeof(int) + images.memory_usage() +
      (double) (local.capacity() + through.capacity()) * sizeof(int) +
      (double) (partner.capacity() + owner.capacity()) * sizeof(tagint) +
      (double) (data.capacity() + moment.capacity() + quadrature.capacity() + place.capacity() +
                seen.capacity() + slack.capacity()) *
      sizeof(double) +
      (double) near_itself.capacity() * sizeof(SelfPair);
}
