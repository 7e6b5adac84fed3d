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

#include "fsi_fields.h"

#include "atom.h"
#include "atom_vec_fsi.h"
#include "comm.h"
#include "error.h"
#include "force.h"
#include "fsi_profile.h"
#include "fsi_record.h"
#include "memory.h"
#include "modify.h"
#include "pair.h"

#include <algorithm>
#include <cstring>
#include <map>

using namespace LAMMPS_NS;
using namespace FSI;

Fields::~Fields()
{
  for (auto &f : fields)
    f.with([this](auto *&own, auto *&) {
      memory->destroy(own);
    });
}

void Fields::set(const std::string &name, Life life, bool wanted, double *&array)
{
  Field f = {name, life, 1};
  f.one_of = &array;
  set(f, wanted);
}

void Fields::set(const std::string &name, Life life, bool wanted, double **&array, int columns)
{
  Field f = {name, life, columns};
  f.many_of = &array;
  set(f, wanted);
}

void Fields::set(const std::string &name, Life life, bool wanted, int *&array)
{
  Field f = {name, life, 1};
  f.integers_of = &array;
  set(f, wanted);
}

Fields::Field *Fields::find(const std::string &name)
{
  for (auto &f : fields)
    if (f.name == name) return &f;
  return nullptr;
}

static const auto hand_over = [](auto *own, auto *&of_owner) {
  of_owner = own;
};

void Fields::set(Field f, bool wanted)
{
  Field *old = find(f.name);
  if (old && wanted && old->columns == f.columns && old->life == f.life) {
    // whose array it is may be another one of the same name
    old->one_of = f.one_of;
    old->many_of = f.many_of;
    old->integers_of = f.integers_of;
    old->with(hand_over);
    return;
  }
  f.with(hand_over);    // null
  if (old) {
    free(*old);
    fields.erase(fields.begin() + (old - fields.data()));
  }
  if (!wanted) return;
  fields.push_back(f);
  if (f.life == STEP) return;
  resize(fields.back(), atom->nmax);
  for (int i = 0; i < atom->nlocal; i++) std::fill_n(fields.back().at(i), f.columns, 0.0);
}

void Fields::free(Field &f)
{
  f.with([this](auto *&own, auto *&of_owner) {
    memory->destroy(own);
    of_owner = nullptr;
  });
}

void Fields::resize(Field &f, int rows)
{
  const std::string name = "fsi:" + f.name;
  f.rows = rows;
  if (f.one_of) memory->grow(f.one, rows, name.c_str());
  if (f.many_of) memory->grow(f.many, rows, f.columns, name.c_str());
  if (f.integers_of) memory->grow(f.integers, rows, name.c_str());
  f.with(hand_over);
}

bool Fields::any(Life life) const
{
  return std::any_of(fields.begin(), fields.end(), [=](const Field &f) {
    return f.life >= life;
  });
}

void Fields::grow()
{
  for (auto &f : fields) {
    if (f.life != STEP || f.rows >= atom->nmax) continue;
    resize(f, atom->nmax);
    if (f.integers)
      memset(f.integers, 0, f.rows * sizeof(int));
    else
      memset(f.at(0), 0, (size_t) f.rows * f.columns * sizeof(double));
  }
}

double Fields::memory_usage() const
{
  double bytes = 0.0;
  for (const auto &f : fields)
    bytes += (double) f.rows * f.columns * (f.integers ? sizeof(int) : sizeof(double));
  return bytes;
}

void Fields::grow_lasting(int nmax)
{
  for (auto &f : fields)
    if (f.life != STEP) resize(f, nmax);
}

void Fields::copy(int i, int j)
{
  for (auto &f : fields)
    if (f.life != STEP) std::copy_n(f.at(i), f.columns, f.at(j));
}

void Fields::begin(int i)
{
  for (auto &f : fields)
    if (f.life != STEP) std::fill_n(f.at(i), f.columns, 0.0);
}

int Fields::pack(int i, double *buf) const
{
  double *const first = buf;
  for (const auto &f : fields)
    if (f.life != STEP) buf = std::copy_n(f.at(i), f.columns, buf);
  return buf - first;
}

int Fields::unpack(int i, const double *buf)
{
  const double *const first = buf;
  for (auto &f : fields)
    if (f.life != STEP) {
      std::copy_n(buf, f.columns, f.at(i));
      buf += f.columns;
    }
  return buf - first;
}

/* ----------------------------------------------------------------------
   restart files
------------------------------------------------------------------------- */

static const std::string FIELD = "field ";

void Fields::write(Record &record) const
{
  for (const auto &f : fields)
    if (f.life == RESTART) record.add(FIELD + f.name, std::to_string(f.columns));
}

void Fields::read(const Record &record, const std::vector<std::string> &forget)
{
  has_record = true;
  for (auto &f : fields) f.in_file = -1;
  int place = 1;
  for (const auto &line : record.all()) {
    if (line.first.compare(0, FIELD.size(), FIELD) != 0) continue;
    const std::string name = line.first.substr(FIELD.size());
    const int columns = std::stoi(line.second);
    Field *const f = find(name);
    if (f && f->life == RESTART && std::find(forget.begin(), forget.end(), name) == forget.end()) {
      if (f->columns != columns)
        error->all(FLERR,
                   "The restart file has {} numbers of {} for each atom, this script's {} needs {}",
                   columns, name, record.style, f->columns);
      f->in_file = place;
    }
    place += columns;
  }
}

int Fields::restart_size() const
{
  int n = 1;
  for (const auto &f : fields)
    if (f.life == RESTART) n += f.columns;
  return n;
}

int Fields::pack_restart(int i, double *buf) const
{
  double *const first = buf++;
  for (const auto &f : fields)
    if (f.life == RESTART) buf = std::copy_n(f.at(i), f.columns, buf);
  first[0] = buf - first;
  return buf - first;
}

void Fields::unpack_restart(int i, int nth)
{
  if (!has_record)
    error->one(FLERR,
               "The restart file was written by another version of the FSI package: it does not "
               "say what it has of each atom");
  take(i, restart_values(atom->extra[i], nth));
}

void Fields::take(int i, const double *values)
{
  for (auto &f : fields)
    if (f.in_file > 0) std::copy_n(values + f.in_file, f.columns, f.at(i));
}

std::vector<double> Fields::pack_all() const
{
  std::vector<double> rows, row(restart_size() + 1);
  if (!any(RESTART)) return rows;
  for (int i = 0; i < atom->nlocal; i++) {
    pack_restart(i, row.data());
    row.back() = (double) atom->tag[i];
    if (std::count(row.begin() + 1, row.end() - 1, 0.0) < (int) row.size() - 2)
      rows.insert(rows.end(), row.begin(), row.end());
  }
  return rows;
}

void Fields::unpack_all(const std::vector<double> &rows)
{
  std::map<double, const double *> of_id;
  for (size_t k = 0; k < rows.size(); k += (size_t) rows[k] + 1)
    of_id[rows[k + (size_t) rows[k]]] = &rows[k];
  for (int i = 0; i < atom->nlocal; i++) {
    const auto found = of_id.find((double) atom->tag[i]);
    if (found != of_id.end()) take(i, found->second);
  }
}

const double *FSI::restart_values(const double *extra, int nth)
{
  while (nth-- > 0) extra += static_cast<int>(extra[0]);
  return extra;
}

/* ----------------------------------------------------------------------
   a fix with fields
------------------------------------------------------------------------- */

FixFields::FixFields(LAMMPS *lmp, int narg, char **arg, const std::string &command) :
    Fix(lmp, narg, arg), command(command), keywords(lmp, command), fields(lmp)
{
  if (!atom->style_match("fsi"))
    error->all(FLERR, "F{} requires atom_style fsi", command.substr(1));
  restart_global = 1;
}

FixFields::~FixFields()
{
  if (!modify->get_fix_by_id(id)) return;
  if (grows) atom->delete_callback(id, Atom::GROW);
  if (restarts) atom->delete_callback(id, Atom::RESTART);
}

void FixFields::register_fields()
{
  create_attribute = 1;
  if (!grows && fields.any(Fields::ATOM)) {
    add_callback(Atom::GROW, atom->extra_grow, atom->nextra_grow);
    grows = true;
  }
  if (!restarts && fields.any(Fields::RESTART)) {
    add_callback(Atom::RESTART, atom->extra_restart, atom->nextra_restart);
    restarts = true;
    restart_peratom = 1;
  }
}

void FixFields::write_restart(FILE *fp)
{
  Record record(lmp, command);
  keywords.write(record);
  fields.write(record);
  record.write(fp);
}

void FixFields::restart(char *buf)
{
  const Record record(lmp, command, buf);
  keywords.compare(record);
  fields.read(record);
}

void FixFields::hand_on(const std::string &name, Record record)
{
  fields.write(record);
  AtomVecFSI::of(atom)->of_fixes[name] = {std::make_shared<Record>(record), fields.pack_all()};
}

std::shared_ptr<const Record> FixFields::take_over(const std::string &name)
{
  const auto &kept = AtomVecFSI::of(atom)->of_fixes[name];
  if (!kept.record) return nullptr;
  fields.read(*kept.record);
  fields.unpack_all(kept.rows);
  return kept.record;
}

// LAMMPS books the fix that is being constructed, which stands behind all others. A field that is
// first wanted later, in init(), is that of a fix in the list.
void FixFields::add_callback(int kind, int *&booked, int &n)
{
  const int mine = modify->find_fix(id), constructed = modify->nfix;
  atom->add_callback(kind);
  if (mine < 0) return;
  std::replace(booked, booked + n, constructed, mine);
  std::sort(booked, booked + n);
}

/* ----------------------------------------------------------------------
   messages
------------------------------------------------------------------------- */

static int mask_of(std::initializer_list<int> species)
{
  int mask = 0;
  for (const int s : species) mask |= 1 << s;
  return mask;
}

void Message::add(double *&array, std::initializer_list<int> species, int n)
{
  columns.push_back({&array, nullptr, 0, n, mask_of(species)});
}

void Message::add(double **&array, int first, int n, std::initializer_list<int> species,
                  const bool *when)
{
  if (n > 0) columns.push_back({nullptr, &array, first, n, mask_of(species), when});
}

int Message::size() const
{
  int most = 0;
  for (int s = NONE; s <= RIGID; s++) {
    int n = 0;
    for (const auto &p : columns)
      if (p.species & 1 << s) n += p.n;
    most = std::max(most, n);
  }
  return most;
}

template <class Visit> void Message::visit(int i, Visit visit) const
{
  if (group && !(atom->mask[i] & group)) return;
  const int kind = 1 << state[atom->type[i]].species;
  for (const auto &p : columns)
    if ((p.species & kind) && (!p.when || *p.when)) visit(p.at(i), p.n);
}

int Message::pack(int n, const int *list, int first, double *buf) const
{
  double *const begin = buf;
  for (int k = 0; k < n; k++)
    visit(list ? list[k] : first + k, [&](const double *a, int m) {
      buf = std::copy_n(a, m, buf);
    });
  return buf - begin;
}

void Message::unpack(int n, int first, const double *buf) const
{
  for (int i = first; i < first + n; i++)
    visit(i, [&](double *a, int m) {
      std::copy_n(buf, m, a);
      buf += m;
    });
}

void Message::add_up(int n, const int *list, const double *buf) const
{
  for (int k = 0; k < n; k++)
    visit(list[k], [&](double *a, int m) {
      for (int c = 0; c < m; c++) a[c] += *buf++;
    });
}

const Message &Ghosts::message_of(double *rows, int columns)
{
  carried = rows;
  one_array.clear();
  one_array.add(carried, {NONE, FLUID, SOLID, RIGID}, columns);
  return one_array;
}

void Ghosts::send(const Message &message, int columns)
{
  carrier.sent = &message;
  forward_comm(profile, comm, &carrier, columns);
}

void Ghosts::add(const Message &message, int columns)
{
  carrier.sent = &message;
  if (force->newton_pair) reverse_comm(profile, comm, &carrier, columns);
}

void Ghosts::send(std::vector<tagint> &numbers)
{
  std::vector<double> bits(numbers.size());
  for (size_t i = 0; i < bits.size(); i++) bits[i] = ubuf(numbers[i]).d;
  send(bits.data());
  for (size_t i = atom->nlocal; i < bits.size(); i++) numbers[i] = (tagint) ubuf(bits[i]).i;
}

void Swaps::find(const std::function<bool(int)> &is_chosen)
{
  swaps.clear();
  std::vector<Exchange> exchanges;
  chosen = find_exchanges(comm, exchanges);
  for (const Exchange &e : exchanges) {
    Swap s;
    static_cast<Exchange &>(s) = e;
    std::copy_if(e.list, e.list + e.nsend, std::back_inserter(s.sent), is_chosen);
    for (int i = e.first; i < e.first + e.nrecv; i++) s.arriving += is_chosen(i);
    if (!s.sent.empty() || s.arriving > 0) swaps.push_back(s);
  }
}

// sends n numbers of out to a rank; returns those from another, at most so many
double *Swaps::pass(int to, int n, int from, int most)
{
  if (to == comm->me) return out.data();
  if ((int) in.size() < most) in.resize(most);
  MPI_Request request;
  if (most) MPI_Irecv(in.data(), most, MPI_DOUBLE, from, 0, world, &request);
  if (n) MPI_Send(out.data(), n, MPI_DOUBLE, to, 0, world);
  if (most) MPI_Wait(&request, MPI_STATUS_IGNORE);
  return in.data();
}

template <class Owner> void Swaps::forward(Profile *profile, Owner *owner, int size)
{
  const Phase phase = messages(profile, comm);
  if (!chosen) return comm->forward_comm(owner, size);
  if (size == 0) size = owner->comm_forward;
  for (Swap &s : swaps) {
    if (out.size() < s.sent.size() * size) out.resize(s.sent.size() * size);
    const int n = owner->pack_forward_comm(s.sent.size(), s.sent.data(), out.data(), s.flag, s.pbc);
    owner->unpack_forward_comm(s.nrecv, s.first, pass(s.to, n, s.from, s.arriving * size));
  }
}

template <class Owner> void Swaps::reverse(Profile *profile, Owner *owner, int size)
{
  const Phase phase = messages(profile, comm);
  if (!chosen) return comm->reverse_comm(owner, size);
  if (size == 0) size = owner->comm_reverse;
  for (auto s = swaps.rbegin(); s != swaps.rend(); ++s) {
    if ((int) out.size() < s->arriving * size) out.resize(s->arriving * size);
    const int n = owner->pack_reverse_comm(s->nrecv, s->first, out.data());
    owner->unpack_reverse_comm(s->sent.size(), s->sent.data(),
                               pass(s->from, n, s->to, s->sent.size() * size));
  }
}

template void Swaps::forward(Profile *, Pair *, int);
template void Swaps::forward(Profile *, Fix *, int);
template void Swaps::reverse(Profile *, Pair *, int);
template void Swaps::reverse(Profile *, Fix *, int);
