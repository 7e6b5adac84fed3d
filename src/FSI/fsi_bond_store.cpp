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

#include "fsi_bond_store.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fsi_gather.h"
#include "fsi_gradient.h"
#include "fsi_hub.h"
#include "memory.h"
#include "modify.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

using namespace LAMMPS_NS;
using namespace FSI;

BondStore::BondStore(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), nvalue(2 * domain->dimension + 2), nmoment(packed_size(domain->dimension))
{
  restart_peratom = 1;
  create_attribute = 1;
  stores_ids = 1;
  maxexchange = 2;
  maxexchange_dynamic = 1;
  grow_arrays(atom->nmax);
  atom->add_callback(Atom::GROW);
  atom->add_callback(Atom::RESTART);
  for (int i = 0; i < atom->nlocal; i++) set_arrays(i);
}

BondStore::~BondStore()
{
  if (modify->get_fix_by_id(id)) {
    atom->delete_callback(id, Atom::GROW);
    atom->delete_callback(id, Atom::RESTART);
  }
  memory->destroy(slot);
}

void BondStore::choose(bool with_images, bool with_places)
{
  keeps_images = with_images;
  keeps_places = with_places;
  through.resize(keeps_images ? partner.size() : 0);
  places.resize(nbond.size() * nplace());
}

bool BondStore::any() const
{
  return anywhere(atom->nlocal > 0 && *std::max_element(slot, slot + atom->nlocal) >= 0, world);
}

bool BondStore::is_solid(int i) const
{
  return disc->state[atom->type[i]].species == SOLID;
}

int BondStore::nplace() const
{
  return keeps_places ? domain->dimension : 0;
}

bool BondStore::bonded(int i, int j) const
{
  const tagint *const of_i = partner_tags(i);
  return std::find(of_i, of_i + count(i), atom->tag[j]) != of_i + count(i);
}

void BondStore::make(int i, int n)
{
  slot[i] = new_slot(n);
  owner(i) = atom->tag[i];
}

void BondStore::enter(int i, int k, tagint partner_tag, int planes)
{
  partner[first(i) + k] = partner_tag;
  if (keeps_images) through[first(i) + k] = planes;
}

void BondStore::enter_place(int i, const double *x)
{
  std::copy_n(x, nplace(), places.begin() + (size_t) slot[i] * nplace());
}

void BondStore::move(int i, int from, int to)
{
  const size_t of_i = first(i);
  local[of_i + to] = local[of_i + from];
  partner[of_i + to] = partner[of_i + from];
  if (keeps_images) through[of_i + to] = through[of_i + from];
  for (int v = 0; v < nvalue; v++) bond(i, to)[v * BOND_BLOCK] = bond(i, from)[v * BOND_BLOCK];
}

void BondStore::complete(int i)
{
  const int n = count(i), D = domain->dimension;
  double M[packed_size(3)] = {};
  for (int k = n; k < whole_blocks(n); k++)
    for (int v = 0; v < nvalue; v++) bond(i, k)[v * BOND_BLOCK] = 0.0;
  for (int k = 0; k < n; k++) {
    const double *const X = bond(i, k) + D * BOND_BLOCK, w = X[D * BOND_BLOCK];
    for (int a = 0, m = 0; a < D; a++)
      for (int c = 0; c <= a; c++) M[m++] += w * X[a * BOND_BLOCK] * X[c * BOND_BLOCK];
  }
  std::copy_n(M, nmoment, &moment[(size_t) slot[i] * nmoment]);
}

bool BondStore::renew(int i)
{
  return domain->dimension == 2 ? renew_as<2>(i) : renew_as<3>(i);
}

template <int D> bool BondStore::renew_as(int i)
{
  const int n = count(i);
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
  if (weights(n, dX.data(), w.data(), disc->h_of(atom->type[i]), quadratic, G.data()) ==
      GradientWeights<D>::DEFICIENT)
    return false;
  for (int k = 0; k < n; k++)
    for (int a = 0; a < D; a++) bond(i, k)[a * BOND_BLOCK] = G[k * D + a];
  complete(i);
  return true;
}

void BondStore::end_taking()
{
  for (int i = 0; i < atom->nlocal; i++)
    if (slot[i] == NO_BONDS) slot[i] = FOREIGN;
}

// the particle that is meant: local, or the ghost that is near; -1: beyond the ghosts, too
int BondStore::find_partner(int i, tagint tag) const
{
  const int j = atom->map(tag);
  return j < 0 || !is_periodic(*domain) ? j : image_at(atom->x[i], j);
}

// of atom j; -1: a ghost that is not here
int BondStore::image_at(const double *place, int j) const
{
  j = domain->closest_image(place, j);
  for (int a = 0; a < domain->dimension; a++)
    if (domain->periodicity[a] && std::fabs(atom->x[j][a] - place[a]) > 0.5 * domain->prd[a])
      return -1;
  return j;
}

// A bond stretched past half a period has another image of its partner nearest to i: the one that
// is meant is where the deformation gradient puts it.
void BondStore::follow_long_bonds(int i, int *of_i) const
{
  double **x = atom->x;
  const int n = count(i), D = domain->dimension;
  for (int a = 0; a < D; a++) {
    if (!domain->periodicity[a]) continue;
    const auto span = [&](int k) {
      return of_i[k] < 0 ? 0.0 : x[of_i[k]][a] - x[i][a];
    };
    bool all_short = true;
    for (int k = 0; k < n; k++) all_short &= std::fabs(span(k)) < 0.25 * domain->prd[a];
    if (all_short) continue;
    double row[3] = {};    // of F
    for (int k = 0; k < n; k++)
      for (int c = 0; c < D; c++) row[c] += span(k) * bond(i, k)[c * BOND_BLOCK];
    for (int k = 0; k < n; k++) {
      if (of_i[k] < 0) continue;
      const double *const xj = x[of_i[k]];
      double place[3] = {xj[0], xj[1], xj[2]};
      place[a] = x[i][a];
      for (int c = 0; c < D; c++) place[a] += row[c] * bond(i, k)[(D + c) * BOND_BLOCK];
      of_i[k] = image_at(place, atom->map(atom->tag[of_i[k]]));
    }
  }
}

void BondStore::resolve()
{
  const tagint *const tag = atom->tag;
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
    int *const of_i = &local[first(i)], n = count(i);
    for (int k = 0; k < n; k++) of_i[k] = find_partner(i, partner_tags(i)[k]);
    if (is_periodic(*domain)) follow_long_bonds(i, of_i);
    for (int k = 0; k < n; k++) {
      const tagint t = partner_tags(i)[k];
      const int j = of_i[k], bits = planes(i, k);
      if (j < 0)
        error->one(
            FLERR,
            "Bond of solid atoms {} and {} reaches beyond the ghost cutoff {} at step {}: one "
            "of them was lost, the solid blew up (try a shorter time step, more sub-steps), "
            "or it is stretched so far that comm_modify cutoff must be larger",
            tag[i], t, std::max(comm->cutghostuser, neighbor->cutneighmax), update->ntimestep);
      of_i[k] = bits ? images.find(j, bits) : j;
    }
    std::fill(of_i + n, of_i + whole_blocks(n), i);
  }
  for (int i = atom->nlocal; i < atom->nlocal + atom->nghost; i++)
    if (is_solid(i)) ghosts.push_back(i);
  changes++;
}

/* ----------------------------------------------------------------------
   slots
------------------------------------------------------------------------- */

// what slots have of each bond: the lists, and how many numbers
template <class Call> void BondStore::each_list(Call call)
{
  call(local, 1);
  call(partner, 1);
  if (keeps_images) call(through, 1);
  call(data, nvalue);
}

void BondStore::reserve(int n)
{
  if (n <= maxbond) return;
  const int old = maxbond, slots = nbond.size();
  maxbond = whole_blocks(n);
  maxexchange = maxsize_restart();
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

void BondStore::reserve_everywhere()
{
  reserve(over_ranks(maxbond, MPI_MAX, world));
}

void BondStore::expect(size_t more)
{
  expected = nbond.size() - unused.size() + more;
  each_list([&](auto &list, int width) {
    list.reserve(expected * maxbond * width);
  });
  moment.reserve(expected * nmoment);
}

int BondStore::new_slot(int n)
{
  reserve(n);
  int s;
  if (unused.empty()) {
    s = nbond.size();
    nbond.push_back(n);
    tag_of.push_back(0);
    quadrature.push_back(1.0);
    places.resize(nbond.size() * nplace());
    each_list([&](auto &list, int width) {
      list.resize(nbond.size() * maxbond * width);
    });
    moment.resize(nbond.size() * nmoment);
  } else {
    s = unused.back();
    unused.pop_back();
    nbond[s] = n;
    quadrature[s] = 1.0;
  }
  return s;
}

/* ----------------------------------------------------------------------
   atoms that come and go
------------------------------------------------------------------------- */

void BondStore::grow_arrays(int nmax)
{
  memory->grow(slot, nmax, "FSI_REFERENCE:slot");
}

void BondStore::copy_arrays(int i, int j, int delflag)
{
  // when atom j is deleted its place becomes free; otherwise its bonds have moved on with an
  // earlier copy
  if (delflag && slot[j] >= 0) unused.push_back(slot[j]);
  slot[j] = slot[i];
}

// number of bonds, then partner and values of each
int BondStore::pack(int i, double *buf) const
{
  int m = 0;
  const int n = slot[i] < 0 ? slot[i] : nbond[slot[i]];
  buf[m++] = ubuf(n).d;
  if (n < 0) return m;
  buf[m++] = weight(i);
  for (int k = 0; k < n; k++) buf[m++] = ubuf(partner_tags(i)[k]).d;
  for (int k = 0; k < n && keeps_images; k++) buf[m++] = ubuf(planes(i, k)).d;
  for (int k = 0; k < n; k++)
    for (int v = 0; v < nvalue; v++) buf[m++] = bond(i, k)[v * BOND_BLOCK];
  std::copy_n(place(i), nplace(), buf + m);
  return m + nplace();
}

int BondStore::unpack(int i, const double *buf)
{
  int m = 0;
  const int n = (int) ubuf(buf[m++]).i;
  slot[i] = n;
  if (n < 0) return m;
  make(i, n);
  weight(i) = buf[m++];
  for (int k = 0; k < n; k++) partner[first(i) + k] = (tagint) ubuf(buf[m++]).i;
  for (int k = 0; k < n && keeps_images; k++) through[first(i) + k] = (int) ubuf(buf[m++]).i;
  for (int k = 0; k < n; k++)
    for (int v = 0; v < nvalue; v++) bond(i, k)[v * BOND_BLOCK] = buf[m++];
  enter_place(i, buf + m);
  complete(i);
  return m + nplace();
}

// delete_atoms may have given the atom another ID since its bonds were looked at
int BondStore::pack_exchange(int i, double *buf)
{
  buf[0] = ubuf(slot[i] < 0 ? 0 : owner(i)).d;
  return 1 + pack(i, buf + 1);
}

int BondStore::unpack_exchange(int i, double *buf)
{
  const int n = 1 + unpack(i, buf + 1);
  if (slot[i] >= 0) owner(i) = (tagint) ubuf(buf[0]).i;
  return n;
}

int BondStore::pack_restart(int i, double *buf)
{
  if (slot[i] >= 0 && owner(i) != atom->tag[i])
    error->one(FLERR,
               "Solid atom {} was atom {} in the last run: after delete_atoms give run 0 before a "
               "restart file is written",
               atom->tag[i], owner(i));
  buf[0] = 1 + pack(i, buf + 1);
  return (int) buf[0];
}

int BondStore::size_restart(int i)
{
  return slot[i] < 0 ? 2 : 3 + nbond[slot[i]] * (nvalue + nwhole()) + nplace();
}

double BondStore::memory_usage()
{
  return (double) atom->nmax * sizeof(int) + images.memory_usage() +
      bytes_of(local, through, partner, tag_of, data, moment, quadrature, places);
}
