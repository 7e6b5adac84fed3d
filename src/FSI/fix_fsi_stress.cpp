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

#include "fix_fsi_stress.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix_fsi.h"
#include "fsi_changes.h"
#include "fsi_find.h"
#include "fsi_gather.h"
#include "fsi_hub.h"
#include "fsi_refusals.h"
#include "fsi_solid_laws.h"
#include "math_extra.h"
#include "modify.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>

using namespace LAMMPS_NS;
using namespace FSI;

FixFSIStress::FixFSIStress(LAMMPS *lmp, int narg, char **arg) :
    FixFields(lmp, narg, arg, "fix fsi/stress"), stress(nullptr), hourglass(nullptr),
    ns(domain->dimension == 2 ? 3 : 6), start(nullptr), strain(nullptr), left(nullptr)
{
  keywords.key("plane")
      .choice(plane_stress, 0, {"strain", "stress"})
      .kept("the deviator in the file is that of the other");
  keywords.key("plastic")
      .set(plastic, 1)
      .changes("the plastic strain begins with 0, or is forgotten");
  keywords.parse(narg - 3, arg + 3);
  if (plane_stress && domain->dimension == 3) refuse(error, Refused::PLANE_STRESS_3D);
  if (plastic && plane_stress) refuse(error, Refused::PLASTIC_PLANE);
  choose_fields();
  register_fields();
}

FixFSIStress::~FixFSIStress()
{
  if (auto *const now = FixFSI::there(lmp)) now->changes.forget();
}

void FixFSIStress::choose_fields()
{
  const Facts facts = facts_of_solids(lmp);
  const bool updated = facts.style == Facts::OF_SOLIDS;
  fields.set("stress", Fields::RESTART, true, stress, ns);
  fields.set("plastic strain", Fields::RESTART, plastic, strain);
  fields.set("place at the start", Fields::RESTART, updated && facts.self_contact, start,
             domain->dimension + 1);
  fields.set("hourglass force", Fields::RESTART, facts.hourglass, hourglass, domain->dimension);
}

void FixFSIStress::init()
{
  if (fixes_of<FixFSIStress>(lmp).size() > 1)
    error->all(FLERR, "There can be only one fix fsi/stress");
  const Discretization &disc = FixFSI::find(lmp, "Fix fsi/stress")->disc;
  choose_fields();    // another pair_style command may have changed what is kept
  // what had a stress keeps it, what had none never gets the right one
  for (int i = 0; i < atom->nlocal && update->whichflag == 1; i++) {
    double &first = stress[i][0];
    const bool solid = disc.state[atom->type[i]].species == FSI::SOLID;
    if (solid ? first == FOREIGN : first != FOREIGN && first != 0.0)
      error->one(FLERR,
                 "Atom {} of type {} is {} solid{} when a run began: delete it and create another "
                 "in its place",
                 atom->tag[i], atom->type[i], solid ? "a" : "no",
                 solid ? " now and was none" : " any more, as it was");
    if (!solid) first = FOREIGN;
  }
  if (left && update->whichflag == 1) look_for_turns(disc);
  bool yields = false;
  for (const auto &s : disc.state) yields = yields || s.yield > 0.0;
  if (comm->me == 0 && plastic && !yields)
    error->warning(FLERR,
                   "Fix fsi/stress plastic has nothing to act on: no material has a yield stress");
  if (comm->me == 0 && yields && !plastic)
    error->warning(
        FLERR,
        "A material has a yield stress, but stays elastic: fix fsi/stress lacks keyword plastic");
}

void FixFSIStress::post_run()
{
  fields.set("place after a run", Fields::ATOM, true, left, 3);
  for (int i = 0; i < atom->nlocal; i++) std::copy_n(atom->x[i], 3, left[i]);
}

// Stresses know of turns by velocities only, not of what a command does between runs: then
// particles of a body move differently
void FixFSIStress::look_for_turns(const Discretization &disc)
{
  constexpr double SMALL = 1.0e-3;
  std::map<tagint, int> first;    // of this rank, by body
  const auto found = find_particles(atom, world, [&](int i) {
    const auto is_zero = [](double s) {
      return s == 0.0;
    };
    if (disc.state[atom->type[i]].species != FSI::SOLID ||
        std::all_of(stress[i], stress[i] + ns, is_zero))
      return false;
    const int j = first.emplace(atom->molecule[i], i).first->second;
    double d[3];
    for (int k = 0; k < 3; k++) d[k] = atom->x[i][k] - left[i][k] - (atom->x[j][k] - left[j][k]);
    to_nearest_image(*domain, d);
    return MathExtra::len3(d) > SMALL * disc.dx;
  });
  if (found.count && comm->me == 0)
    error->warning(FLERR,
                   "Fix fsi/stress: a command has turned or strained a body since the last run, "
                   "that of atom {}: its stress stays as it was",
                   found.first);
  fields.set("place after a run", Fields::ATOM, false, left, 3);
}

// S:S/(4G), with S_zz of plane strain
template <int D>
static double shear_energy_density(const Sym<D> &s, double shear, bool plane_stress)
{
  double ss = s.squared();
  if (D == 2 && !plane_stress) ss += (s.c[0] + s.c[1]) * (s.c[0] + s.c[1]);
  return ss / (4.0 * shear);
}

template <int D>
double FixFSIStress::advance_stress(int i, const double *L, double dt, const State &material,
                                    bool account)
{
  auto s = Sym<D>::load(stress[i]);
  // of the same stress a larger volume stores more, for which the rate of stress does no work
  double work = 0.0, growth = 0.0;
  for (int d = 0; account && d < D; d++) growth += 0.5 * dt * L[d * (D + 1)];
  if (account) work -= growth * shear_energy_density(s, material.shear, plane_stress);
  jaumann_update<D>(s, L, dt, material.shear, plane_stress);
  if (plastic && material.yield > 0.0)
    work += radial_return<D>(s, strain[i], material.shear, material.yield, material.hardening);
  s.store(stress[i]);
  if (account) work -= growth * shear_energy_density(s, material.shear, plane_stress);
  return work;
}

template double FixFSIStress::advance_stress<2>(int, const double *, double, const State &, bool);
template double FixFSIStress::advance_stress<3>(int, const double *, double, const State &, bool);

// Where solids were when they were first seen, for contact of a body with itself; ghosts are told.
void FixFSIStress::enter_start(const std::vector<State> &state, Ghosts &ghosts)
{
  const int dim = domain->dimension;
  for (int i = 0; i < atom->nlocal; i++) {
    if (state[atom->type[i]].species != SOLID || start[i][dim] != 0.0) continue;
    std::copy_n(atom->x[i], dim, start[i]);
    start[i][dim] = 1.0;
  }
  Message places(lmp, state);
  places.add(start, 0, dim, {SOLID});
  ghosts.send(places);
}

double FixFSIStress::distance_at_start(int i, int j) const
{
  double sum = 0.0;
  for (int a = 0; a < domain->dimension; a++) {
    double d = start[i][a] - start[j][a];
    if (domain->periodicity[a]) d -= domain->prd[a] * std::round(d / domain->prd[a]);
    sum += d * d;
  }
  return std::sqrt(sum);
}

double FixFSIStress::shear_energy(int i, double shear) const
{
  const double *const s = stress[i], volume = atom->rmass[i] / atom->rho[i];
  return volume *
      (ns == 3 ? shear_energy_density(Sym<2>::load(s), shear, plane_stress)
               : shear_energy_density(Sym<3>::load(s), shear, plane_stress));
}

std::vector<FixFSIStress::Effect> FixFSIStress::effects() const
{
  return {{"plasticity", "fix fsi/stress plastic", plastic != 0}};
}

void FixFSIStress::find_idle(const Census &all, const Idle &nothing) const
{
  if (!facts_of_solids(lmp).by_rate)
    nothing("Fix fsi/stress", "no solid is hypoelastic");
  else if (all.solids == 0)
    nothing("Fix fsi/stress", "no particle is a solid");
}

// ---- FSI_HISTORY ----

static constexpr char ID[] = "FSI_HISTORY";

// arguments: columns, name in one word
static std::string spaced(std::string word)
{
  std::replace(word.begin(), word.end(), '_', ' ');
  return word;
}

FixFSIHistory::FixFSIHistory(LAMMPS *lmp, int narg, char **arg) :
    FixFields(lmp, narg, arg, "fix FSI_HISTORY"), of(nullptr),
    name(narg == 5 ? spaced(arg[4]) : ""), columns(narg == 5 ? atoi(arg[3]) : 0)
{
  if (columns < 1) error->all(FLERR, "Fix FSI_HISTORY is made by pair_style fsi/solid/tl alone");
  fields.set(name, Fields::RESTART, true, of, columns);
  register_fields();
}

FixFSIHistory::~FixFSIHistory()
{
  if (auto *const now = FixFSI::there(lmp)) now->changes.forget();
}

FixFSIHistory *FixFSIHistory::keep(LAMMPS *lmp, std::string_view name, int columns)
{
  Modify *const modify = lmp->modify;
  auto *const old = dynamic_cast<FixFSIHistory *>(modify->get_fix_by_id(ID));
  if (old && old->name == name && old->columns == columns) return old;
  if (old) {
    if (lmp->comm->me == 0)
      lmp->error->warning(FLERR, "Pair style fsi/solid/tl: the {} of its bodies is forgotten",
                          old->name);
    modify->delete_fix(ID);
  }
  if (name.empty()) return nullptr;
  std::string word(name);
  std::replace(word.begin(), word.end(), ' ', '_');
  return dynamic_cast<FixFSIHistory *>(
      modify->add_fix(fmt::format("{} all FSI_HISTORY {} {}", ID, columns, word)));
}
