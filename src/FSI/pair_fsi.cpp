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

#include "pair_fsi.h"

#include "atom_vec_fsi.h"
#include "comm.h"
#include "error.h"
#include "fix_fsi.h"
#include "fix_fsi_reference.h"
#include "fix_fsi_stress.h"
#include "force.h"
#include "fsi_find.h"
#include "fsi_gather.h"
#include "fsi_record.h"
#include "fsi_refusals.h"
#include "memory.h"
#include "modify.h"
#include "neighbor.h"
#include "pair_hybrid.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace FSI;

PairFSI::PairFSI(LAMMPS *lmp, const char *style_in) :
    Pair(lmp), style(style_in), keywords(lmp, "pair_style " + style)
{
  restartinfo = 1;
  one_coeff = 1;
  manybody_flag = 1;    // forces depend on the densities of both particles: no pairwise energy
  single_enable = 0;
  no_virial_fdotr_compute = 0;
}

PairFSI::~PairFSI()
{
  if (allocated) {
    memory->destroy(setflag);
    memory->destroy(cutsq);
  }
}

void PairFSI::allocate()
{
  allocated = 1;
  const int n = atom->ntypes + 1;
  memory->create(setflag, n, n, "pair:setflag");
  memory->create(cutsq, n, n, "pair:cutsq");
  material.assign(n, Material{});
}

void PairFSI::settings(int narg, char **arg)
{
  keywords.parse(narg, arg);
  check_settings();
  disc = nullptr;
}

// pair_coeff * * file name_1 ... name_ntypes, or the last ones left to levels of fix fsi/refine
void PairFSI::coeff(int narg, char **arg)
{
  const bool keeps = narg > 4 && strcmp(arg[narg - 1], "levels") == 0;
  if (keeps) narg--;
  first_level = keeps ? narg - 2 : 0;
  check_pair_coeff(narg, arg);
  if (!allocated) allocate();
  auto *const avec = AtomVecFSI::of(atom);
  const std::vector<std::string> names(arg + 3, arg + narg);
  auto found = read_materials(lmp, arg[2], names,
                              avec ? avec->materials : std::map<std::string, std::string>());
  std::copy(found.begin(), found.end(), material.begin() + 1);
  if (keeps) keep_levels();
  disc = nullptr;
  set_flags();
  check_species();
}

// they are of the first fluid, which other styles leave alone
void PairFSI::keep_levels()
{
  const auto kept = material.begin() + first_level;
  const auto fluid = std::find_if(material.begin() + 1, kept, [](const Material &m) {
    return m.species == FLUID;
  });
  if (fluid == kept && handles(FLUID, FLUID))
    error->all(FLERR, "Pair_coeff of pair style {} has levels, expected a fluid before it", style);
  const Material of_levels = fluid == kept ? Material{} : *fluid;
  std::fill(kept, material.end(), of_levels);
}

void PairFSI::check_pair_coeff(int narg, char **arg) const
{
  if (narg < 2 || strcmp(arg[0], "*") != 0 || strcmp(arg[1], "*") != 0)
    error->all(FLERR,
               "Pair style {} needs pair_coeff * * followed by a material file and one material "
               "per atom type",
               style);
  if (first_level ? narg > 3 + atom->ntypes : narg != 3 + atom->ntypes)
    error->all(
        FLERR,
        "Pair_coeff of pair style {} has {} materials, expected one for each of {} atom types",
        style, narg > 3 ? narg - 3 : 0, atom->ntypes);
}

// Of a type that no style has a force for LAMMPS says only "All pair coeffs are not set". Before
// the first run: later one pair_coeff after another may change materials.
static std::string in_words(const Material &m)
{
  static const char *const words[] = {"", "fluid ", "solid ", "wall "};
  return m.species == NONE ? "no material" : std::string("the ") + words[m.species] + m.name;
}

void PairFSI::check_species() const
{
  if (update->first_update) return;
  const bool solid_style = style != "fsi/fluid";
  for (int t = 1; t <= atom->ntypes && force->pair == this; t++)
    if (setflag[t][t] == 0)
      error->all(FLERR, "Pair_coeff of pair style {} gives atom type {} {}: expected a {}", style,
                 t, in_words(material[t]), solid_style ? "solid" : "fluid, solid or wall");
  const PairFSI *fluid = solid_style ? nullptr : this, *solid = solid_style ? this : nullptr;
  for (const auto *const other : pairs_of<PairFSI>(lmp))
    if (other->allocated) (other->facts().style == Facts::OF_FLUIDS ? fluid : solid) = other;
  for (int t = 1; fluid && solid && t <= atom->ntypes; t++) {
    const Material &f = fluid->material[t], &s = solid->material[t];
    if ((f.species == SOLID && s.species != SOLID) ||
        (f.species != SOLID && f.species != NONE && s.species == SOLID))
      error->all(FLERR,
                 "Pair_coeff gives atom type {} {} in pair style fsi/fluid and {} in {}: expected "
                 "the same solid in both, or {}",
                 t, in_words(f), in_words(s), solid->style,
                 f.species == SOLID ? "another material in fsi/fluid" : "NULL in " + solid->style);
  }
}

void PairFSI::set_flags()
{
  int count = 0;
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = 1; j <= atom->ntypes; j++) {
      const int a = material[i].species, b = material[j].species;
      const bool acts = a != NONE && b != NONE && handles(a, b);
      setflag[i][j] = acts || leaves_alone(a, b, force->pair == this) ? 1 : 0;
      count += acts;
    }
  if (count == 0)
    error->all(FLERR,
               "Pair_coeff gives pair style {} no pair to act on: none of its materials is a {}",
               style, handles(FLUID, FLUID) ? "fluid" : "solid");
}

// from the coarsest on: the first fluid, and the types that pair_coeff keeps for finer ones
std::vector<int> PairFSI::types_of_levels() const
{
  std::vector<int> types;
  for (int t = 1; t <= atom->ntypes; t++) {
    const bool kept = first_level && t >= first_level;
    if (material[t].species == FLUID && (types.empty() || kept)) types.push_back(t);
  }
  return types;
}

void PairFSI::init_style()
{
  if (!atom->style_match("fsi")) error->all(FLERR, "Pair style {} requires atom_style fsi", style);
  auto *const fix_fsi = FixFSI::find(lmp, "Pair style " + style)->link(disc, step, ledger, ghosts);
  if (!fix_fsi->ids_checked) check_ids(lmp, facts_of_solids(lmp).style == Facts::OF_SOLIDS);
  fix_fsi->ids_checked = true;
  const auto all = pairs_of<PairFSI>(lmp);
  if (std::count_if(all.begin(), all.end(), [this](const PairFSI *p) {
        return p->style == style;
      }) > 1)
    error->all(
        FLERR,
        "Pair style hybrid has {} more than once: one is for the materials of all atom types{}",
        style,
        style == "fsi/fluid"
            ? ", and a speed of sound of its own is keyword sound of a fluid in the material file"
            : "");
  check_same_materials();
  drop_reference();
  if (handles(FLUID, FLUID)) fix_fsi->disc.resolve_levels(types_of_levels());
  auto &density_of_solids = AtomVecFSI::of(atom)->density_of_solids;
  density_of_solids.resize(atom->ntypes + 1, 0.0);
  for (int t = 1; t <= atom->ntypes; t++) {
    if (!defines(material[t].species)) continue;
    fix_fsi->disc.enter_state(t, make_state(material[t]));
    density_of_solids[t] = material[t].species == SOLID ? material[t].rho0 : 0.0;
  }
  // before fixes and computes ask for masses
  for (int i = 0; i < atom->nlocal; i++) {
    const int species = disc->state[atom->type[i]].species;
    if (species != NONE && handles(FLUID, FLUID) == (species != SOLID))
      give_defaults(i, atom, *disc);
  }
  if (needs_neighbors())
    neighbor->add_request(this);
  else
    list = nullptr;    // that of an earlier run is gone
}

// Bodies keep their reference from one pair_style fsi/solid/tl to the next. Nobody could say what
// it means after a run in another style
void PairFSI::drop_reference() const
{
  Fix *const fix = modify->get_fix_by_id(FixFSIReference::ID);
  const auto *const reference = dynamic_cast<FixFSIReference *>(fix);
  if (!reference || facts_of_solids(lmp).style == Facts::OF_TOTAL_LAGRANGIAN_SOLIDS) return;
  if (reference->any() && comm->me == 0)
    error->warning(FLERR,
                   "There is no pair_style fsi/solid/tl any more: its bodies lose their reference, "
                   "and with it their strain");
  modify->delete_fix(FixFSIReference::ID);
  FixFSIHistory::keep(lmp, "", 0);
}

// a solid that has several styles has one material
void PairFSI::check_same_materials() const
{
  for (const auto *const other : pairs_of<PairFSI>(lmp)) {
    for (int t = 1; t <= atom->ntypes; t++) {
      const Material &a = material[t], &b = other->material[t];
      if (a.species == SOLID && b.species == SOLID && strcmp(a.name, b.name) != 0)
        error->all(FLERR,
                   "Pair_coeff of pair style {} gives atom type {} the material {}, that of {} {}: "
                   "expected the same",
                   style, t, a.name, other->style, b.name);
    }
  }
}

PairHybrid *PairFSI::hybrid_style() const
{
  return dynamic_cast<PairHybrid *>(force->pair);
}

// A hybrid style gives pairs to the last style that pair_coeff names for them
void PairFSI::check_pairs() const
{
  auto *const hybrid = hybrid_style();
  if (!hybrid) return;
  const auto has = [&](int a, int b, std::string name) {
    return hybrid->check_ijtype(a, b, name.data()) != 0;
  };
  for (int a = 1; a <= atom->ntypes; a++)
    for (int b = a; b <= atom->ntypes; b++)
      if (handles(material[a].species, material[b].species) && material[a].species != NONE &&
          material[b].species != NONE && !has(a, b, style) && !has(a, b, style + "/omp") &&
          !has(a, b, style + "/kk"))    // as the script names it
        refuse(error, Refused::ALL_PAIRS, style, a, b);
}

void *PairFSI::extract(const char *name, int &dim_of_extract)
{
  dim_of_extract = 0;
  return strcmp(name, "alpha") == 0 ? &alpha : nullptr;
}

Facts PairFSI::facts() const
{
  Facts facts;
  facts.alpha = alpha;
  facts.contact = contact_range;
  facts.self_contact = self_contact;
  return facts;
}

std::string PairFSI::named_effects() const
{
  std::string named;
  for (const auto &e : effects())
    if (e.on) named += (named.empty() ? " with " : ", ") + e.keyword;
  return named;
}

// is there more than one solid body? pairs need not ask if there is not
bool PairFSI::several_bodies() const
{
  tagint low = MAXTAGINT, high = 0;
  for (int i = 0; i < atom->nlocal; i++)
    if (material[atom->type[i]].species == SOLID) {
      low = std::min(low, atom->molecule[i]);
      high = std::max(high, atom->molecule[i]);
    }
  low = over_ranks(low, MPI_MIN, world);    // one after the other, as on all ranks
  high = over_ranks(high, MPI_MAX, world);
  return low < high;
}

double PairFSI::init_one(int i, int j)
{
  if (setflag[i][j] == 0) error->all(FLERR, "All pair coeffs are not set: types {} and {}", i, j);
  const double own = disc->resolution[i].cut, other = disc->resolution[j].cut;
  if (!handles(material[i].species, material[j].species)) return 0.0;
  const bool fluids = material[i].species == FLUID && material[j].species == FLUID;
  return fluids ? 0.5 * (own + other) : std::max(own, other);
}

/* ----------------------------------------------------------------------
   keywords that several styles have
------------------------------------------------------------------------- */

void PairFSI::artificial_row(const std::string &of)
{
  keywords.key("artificial/visc")
      .number(alpha, 0.0, Range::from(0.0), "alpha")
      .number(beta, 0.0, Range::from(0.0), "beta")
      .effect("artificial viscosity of the " + of + ", alpha {}");
}

void PairFSI::contact_row()
{
  keywords.key("contact").number(contact_range, 1.0, Range::from(1.0));
  keywords.key("self").logical(self_contact, false).effect("contact of a body with itself");
}

void PairFSI::check_contact() const
{
  if (contact_range * disc->dx > disc->cut * (1.0 + 1.0e-12))
    error->all(FLERR,
               "Pair style {} contact {} must not exceed the kernel's support, {:g} spacings",
               style, contact_range, disc->cut / disc->dx);
}

// the solid's speed of sound is that of its bulk modulus (paper eq. 21)
State PairFSI::solid_state(const Material &m, bool plane_stress) const
{
  State s;
  s.species = SOLID;
  s.rho0 = m.rho0;
  s.inv_rho0 = 1.0 / s.rho0;
  s.csq = (plane_stress ? m.plane_stress_modulus() : m.bulk_modulus()) / m.rho0;
  s.inv_csq = 1.0 / s.csq;
  s.c = std::sqrt(s.csq);
  s.shear = m.shear_modulus();
  s.yield = m.yield;
  s.hardening = m.hardening;
  return s;
}

bool PairFSI::any_relaxes() const
{
  return std::any_of(material.begin(), material.end(), [](const Material &m) {
    return m.nprony > 0;
  });
}

void PairFSI::check_tally()
{
  if (vflag_atom)
    error->all(FLERR,
               "Pair style {} has no per-atom virial: use compute fsi/atom for stress and pressure",
               style);
}

// restart files: keywords, and materials as they stand in their file
void PairFSI::write_restart_settings(FILE *fp)
{
  Record record(lmp, "pair_style " + style);
  keywords.write(record);
  record.write(fp);
}

void PairFSI::read_restart_settings(FILE *fp)
{
  keywords.read(Record::read(lmp, "pair_style " + style, fp));
}

void PairFSI::write_restart(FILE *fp)
{
  write_restart_settings(fp);
  Record record(lmp, "pair_coeff " + style);
  for (int t = 1; t <= atom->ntypes; t++) record.add(std::to_string(t), describe(material[t]));
  record.add("levels from", std::to_string(first_level));
  record.write(fp);
}

void PairFSI::read_restart(FILE *fp)
{
  read_restart_settings(fp);
  allocate();
  const auto record = Record::read(lmp, "pair_coeff " + style, fp);
  for (int t = 1; t <= atom->ntypes; t++)
    material[t] = read_material(lmp, "in the restart file", record.value(std::to_string(t)));
  first_level = record.has("levels from") ? std::stoi(record.value("levels from")) : 0;
  set_flags();
}
