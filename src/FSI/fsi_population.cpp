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

#include "fsi_population.h"

#include "atom.h"
#include "atom_vec.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fsi_gather.h"
#include "fsi_hub.h"
#include "fsi_record.h"
#include "math_extra.h"

#include <algorithm>
#include <numeric>

using namespace LAMMPS_NS;
using namespace FSI;

Particle Population::copy_of(int i) const
{
  const double *const x = atom->x[i], *const v = atom->v[i];
  return {{x[0], x[1], x[2]}, {v[0], v[1], v[2]}, atom->rho[i],  atom->rmass[i],
          atom->tag[i],       atom->molecule[i],  atom->type[i], atom->mask[i]};
}

double Population::energy(int i) const
{
  return 0.5 * atom->rmass[i] * MathExtra::lensq3(atom->v[i]) + step.body_forces.potential(i) +
      stored(i, atom, disc);
}

// Where IDs are 1 to N LAMMPS takes them for ones that stay so (Atom::tag_consecutive() in dumps
// that sort), before any is made, and as many may come as leave: so one is left free, below the
// largest of a fluid.
void Population::leave_an_id_free()
{
  if (!atom->tag_consecutive()) return;
  tagint largest = 0;
  for (int i = 0; i < atom->nlocal; i++)
    if (disc.state[atom->type[i]].species == FLUID) largest = std::max(largest, atom->tag[i]);
  largest = over_ranks(largest, MPI_MAX, world);
  if (largest == 0 || atom->natoms >= MAXTAGINT) return;
  if (comm->me == 0)
    utils::logmesg(lmp, "  atom {} is {} from now on: particles come and go\n", largest,
                   atom->natoms + 1);
  begin();    // the map is of the old IDs
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->tag[i] == largest) atom->tag[i] = static_cast<tagint>(atom->natoms) + 1;
  renew_map();
}

void Population::renew_map()
{
  if (atom->map_style == Atom::MAP_NONE) return;
  atom->map_init();
  atom->map_set();
}

// Ghosts go, as in Comm::exchange(), which comes next: new atoms take their places
void Population::begin()
{
  if (atom->map_style != Atom::MAP_NONE) atom->map_clear();
  atom->nghost = 0;
  atom->avec->clear_bonus();
  made = removed = wanted = 0;
}

void Population::remove(const std::vector<int> &gone, double *account)
{
  for (auto i = gone.rbegin(); i != gone.rend(); i++) {
    if (account) *account += energy(*i);
    last_id = std::max(last_id, atom->tag[*i]);
    atom->avec->copy(atom->nlocal - 1, *i, 1);
    atom->nlocal--;
  }
  removed += gone.size();
}

// IDs that no particle has or had, behind each other: the largest n of any rank
std::vector<tagint> Population::new_ids(tagint n, const std::string &label)
{
  tagint local[2] = {last_id, n}, most[2];
  for (int i = 0; i < atom->nlocal; i++) local[0] = std::max(local[0], atom->tag[i]);
  MPI_Allreduce(local, most, 2, MPI_LMP_TAGINT, MPI_MAX, world);
  if (most[0] > MAXTAGINT - most[1])
    error->all(FLERR, "{}: there are no more atom IDs: LAMMPS with -DLAMMPS_BIGBIG has them",
               label);
  std::vector<tagint> list(most[1]);
  std::iota(list.begin(), list.end(), most[0] + 1);
  last_id = most[0] + most[1];
  wanted += most[1];
  maker = label;
  return list;
}

void Population::make(const std::vector<Particle> &all, const std::string &label, double *account)
{
  const auto list = new_ids(static_cast<tagint>(all.size()), label);
  const int first = atom->nlocal;
  for (size_t k = 0; k < all.size(); k++) {
    const Particle &p = all[k];
    double x[3] = {p.x[0], p.x[1], p.x[2]};
    if (!domain->ownatom(list[k], x, nullptr, 1)) continue;
    atom->avec->create_atom(p.type, x);
    const int i = atom->nlocal - 1;
    atom->tag[i] = list[k];
    atom->mask[i] = p.mask;
    atom->molecule[i] = p.molecule;
    atom->rho[i] = p.rho;
    atom->rmass[i] = p.rmass;
    std::copy_n(p.v, 3, atom->v[i]);
  }
  atom->data_fix_compute_variable(first, atom->nlocal);
  for (int i = first; account && i < atom->nlocal; i++) *account -= energy(i);
  made += atom->nlocal - first;
}

// Where particles come and go all the time, IDs that are free again come first: so the largest, and
// LAMMPS' map of IDs, does not grow without end. Commands between runs may have given them, too.
std::vector<tagint> Population::ids(int n, const std::string &label)
{
  std::vector<tagint> list;
  while ((int) list.size() < n && !free_ids.empty()) {
    const auto first = free_ids.begin(),
               last = first + std::min<size_t>(n - list.size(), free_ids.size());
    const std::vector<tagint> some(first, last);
    free_ids.erase(first, last);
    const auto used = in_use(some);
    for (size_t k = 0; k < some.size(); k++)
      if (!used[k]) list.push_back(some[k]);
  }
  wanted += list.size();
  const auto more = new_ids(n - (tagint) list.size(), label);
  list.insert(list.end(), more.begin(), more.end());
  return list;
}

// which of these, in rising order, particles have
std::vector<char> Population::in_use(const std::vector<tagint> &list) const
{
  std::vector<char> local(list.size(), 0);
  for (int i = 0; i < atom->nlocal; i++) {
    const auto at = std::lower_bound(list.begin(), list.end(), atom->tag[i]);
    if (at != list.end() && *at == atom->tag[i]) local[at - list.begin()] = 1;
  }
  return over_ranks(local, MPI_MAX, world);
}

int Population::copy(int i, tagint id)
{
  double x[3] = {atom->x[i][0], atom->x[i][1], atom->x[i][2]};    // arrays may grow meanwhile
  atom->avec->create_atom(atom->type[i], x);
  const int j = atom->nlocal - 1;
  atom->avec->copy(i, j, 0);
  atom->tag[j] = id;
  made++;
  return j;
}

void Population::release(const std::vector<tagint> &of_rank)
{
  const auto all = gather(of_rank, world);
  free_ids.insert(free_ids.end(), all.begin(), all.end());
  std::sort(free_ids.begin(), free_ids.end());
  // commands between runs may have given a free one to a particle that is gone now
  free_ids.erase(std::unique(free_ids.begin(), free_ids.end()), free_ids.end());
}

void Population::end()
{
  const bigint born = count_of(made, world), more = born - count_of(removed, world);
  last_id = over_ranks(last_id, MPI_MAX, world);
  if (born != wanted)
    error->all(FLERR, "{}: {} of {} new particles are outside the box", maker, wanted - born,
               wanted);
  atom->natoms += more;
  net += more;
  renew_map();
}

void Population::write(Record &record) const
{
  if (last_id > 0) record.add("last ID", std::to_string(last_id));
  std::string text;
  for (const tagint id : free_ids) text += fmt::format("{}{}", text.empty() ? "" : " ", id);
  if (!text.empty()) record.add("free IDs", text);
}

void Population::read(const Record &record)
{
  if (record.has("last ID"))
    last_id = std::max(last_id, static_cast<tagint>(std::stoll(record.value("last ID"))));
  if (!record.has("free IDs")) return;
  free_ids.clear();
  for (const auto &word : utils::split_words(record.value("free IDs")))
    free_ids.push_back(static_cast<tagint>(std::stoll(word)));
}
