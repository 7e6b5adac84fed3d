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

#include "fsi_hub.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix_gravity.h"
#include "fsi_cells.h"
#include "fsi_find.h"
#include "fsi_gather.h"
#include "fsi_kernel.h"
#include "fsi_keywords.h"
#include "fsi_lammps_access.h"
#include "fsi_part.h"
#include "fsi_preset.h"
#include "fsi_record.h"
#include "group.h"
#include "lammps.h"
#include "math_const.h"
#include "math_extra.h"
#include "modify.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <map>

using namespace LAMMPS_NS;
using namespace FSI;
using MathConst::MY_PI;

void Discretization::resolve(const std::vector<double> &spacing)
{
  const auto resolution_of = [&](double own) {
    Resolution r;
    r.dx = own;
    r.h = hdx * own;
    const ChosenKernel k(kernel, dim, r.h);
    r.cut = k.cut;
    r.psi_bulk = lattice_number_density(k, own);
    r.wdx = k.W(own);
    r.w0 = k.W(0.0);
    return r;
  };
  const Resolution fluid = resolution_of(dx);
  static_cast<Resolution &>(*this) = fluid;
  central_length_sq = FSI::central_length_sq(ChosenKernel(kernel, dim, hdx), 1.0) / (hdx * hdx);
  largest_cut = cut;
  levels = {fluid};
  level_of.assign(spacing.size(), 0);
  resolution.clear();
  for (const double own : spacing) {
    resolution.push_back(own > 0.0 ? resolution_of(own) : fluid);
    largest_cut = std::max(largest_cut, resolution.back().cut);
  }
}

void Discretization::resolve_levels(const std::vector<int> &types)
{
  types_of_levels = types;
  std::vector<double> spacing = given_spacing;
  for (size_t k = 1; k < types.size(); k++)
    if (spacing[types[k]] == 0.0)
      spacing[types[k]] = dx_of(types[0]) * std::pow(2.0, -(double) k / dim);
  if (types.size() > 1) resolve(spacing);
}

std::vector<std::string> Discretization::begin(LAMMPS *lmp, const Keywords &keywords,
                                               std::vector<std::string> words)
{
  dim = lmp->domain->dimension;
  kernel_named = words.size() > 1 && !keywords.knows(words[1]);
  if (kernel_named || words.empty()) return words;
  const KernelChoice chosen = kernel_of(facts_of_fluids(lmp).preset, dim);
  words.insert(words.begin() + 1,
               {chosen.kernel == QUINTIC ? "quintic" : "wendland", fmt::format("{}", chosen.hdx)});
  return words;
}

void FSI::choose_skin(LAMMPS *lmp, double dx)
{
  static const std::map<std::string, double> unset = {
      {"lj", 0.3},  {"real", 2.0},     {"metal", 2.0}, {"si", 0.001},
      {"cgs", 0.1}, {"electron", 2.0}, {"micro", 0.1}, {"nano", 0.1}};    // Update::set_units()
  double &skin = lmp->neighbor->skin;
  const auto it = unset.find(lmp->update->unit_style);
  if (it == unset.end() || skin != it->second) return;
  skin = 0.4 * dx;
  if (lmp->comm->me == 0)
    utils::logmesg(
        lmp, "Fix fsi: neighbor skin {:g}, 0.4 spacings; command neighbor sets another\n", skin);
}

void Discretization::enter_state(int type, const State &s)
{
  if (!states_entered) state.assign(state.size(), State());
  states_entered = true;
  // that of a solid is of the style that moves it, in whatever order a hybrid style has them
  if (state[type].form && !s.form) return;
  state[type] = s;
  state[type].h = resolution[type].h;
  state[type].w0 = resolution[type].w0;
}

void Discretization::find_levels()
{
  levels.resize(1);
  for (size_t t = 1; t < state.size(); t++)
    if (state[t].species == FLUID && dx_of(t) < dx) levels.push_back(resolution[t]);
  std::sort(levels.begin() + 1, levels.end(), [](const Resolution &a, const Resolution &b) {
    return a.dx > b.dx;
  });
  const auto same = [](const Resolution &a, const Resolution &b) {
    return a.dx == b.dx;
  };
  levels.erase(std::unique(levels.begin(), levels.end(), same), levels.end());
  level_of.assign(state.size(), 0);
  for (size_t t = 1; t < state.size(); t++)
    for (size_t l = 0; l < levels.size(); l++)
      if (state[t].species == FLUID && dx_of(t) == levels[l].dx) level_of[t] = l;
}

void StepState::begin_run()
{
  shift = nullptr;
  for (auto &row : impedance) row.clear();
}

void StepState::begin(double dt)
{
  const double sub = dt / substeps;
  dt_offset = last_dt > 0.0 ? 0.5 * (last_dt - dt) : 0.0;
  substep_offset = last_dt > 0.0 ? 0.5 * (last_sub - sub) : 0.0;
  last_dt = dt;
  last_sub = sub;
}

void StepState::write(Record &record) const
{
  record.add("last step", std::vector<double>{last_dt, last_sub});
}

void StepState::read(const Record &record)
{
  if (!record.has("last step")) return;
  const auto list = record.numbers("last step");
  last_dt = list[0];
  last_sub = list[1];
}

bool StepState::takes_substeps(LAMMPS *lmp) const
{
  return substeps > 1 || any_is(fixes_of<Part>(lmp), &Facts::chooses_substeps);
}

void StepState::gather_walls(LAMMPS *lmp)
{
  walls.wall.clear();
  wall_forces.clear();
  for (auto *p : parts) p->add_walls(walls, wall_forces);
  if (walls.wall.size() > Walls::MAXWALL)
    lmp->error->all(FLERR, "There are {} mirror walls, more than the {} supported",
                    walls.wall.size(), Walls::MAXWALL);
  walls.find_reflections();
}

void StepState::find_near_walls(const Atom *atom, const Discretization &disc)
{
  const int nall = atom->nlocal + atom->nghost;
  const Vector *const x = vectors(atom->x);
  const InnerBox inner(walls.wall, disc.cut);
  for_particles(nall, [=, &inner, &disc](int i) {
    int near = 0;
    if (!inner.contains(x[i])) {
      const bool of_wall = disc.state[atom->type[i]].species == RIGID;
      near = walls.near(x[i], disc.cut) & walls.mirroring(of_wall, atom->mask[i]);
    }
    wmask[i] = near;
  });
}

std::vector<std::string> Discretization::density_names(int species)
{
  if (species == FLUID) return {"continuity", "summation"};
  return {"continuity", "summation", "ratio"};
}

bool Discretization::several_stiffnesses() const
{
  double first = 0.0;
  for (const auto &s : state) {
    if (s.species != FLUID) continue;
    const double K = s.rho0 * s.csq;
    if (first == 0.0)
      first = K;
    else if (std::abs(K - first) > 1.0e-12 * first)
      return true;
  }
  return false;
}

double FSI::pressure_of(int i, const Atom *atom, const Discretization &disc, const StepState &step)
{
  const State &s = disc.state[atom->type[i]];
  if (s.species == FLUID && disc.surface_ratio > 0.0 &&
      step.psi[i] <= disc.surface_ratio * step.psi_reference)
    return 0.0;
  if (s.species == RIGID && step.wall_stiffness)
    return std::max(s.floor, s.p0 + step.wall_stiffness[i] * (atom->rho[i] / s.rho0 - 1.0));
  return s.pressure(atom->rho[i]);
}

double FSI::stored(int i, const Atom *atom, const Discretization &disc)
{
  return atom->rmass[i] * disc.state[atom->type[i]].energy(atom->rho[i]);
}

// As far as the deepest guard is deep, along the sum of the ways out of all
std::array<double, 3> Discretization::out_of_guards(const Atom *atom, const Cells &cells,
                                                    double spacing, const double *at) const
{
  std::array<double, 3> away = {};
  double deepest = 0.0;
  cells.around(at, [&](int j, double rsq) {
    const double r = std::sqrt(rsq), depth = guard_of(atom->type[j], spacing) - r;
    if (depth <= 0.0 || r == 0.0) return;
    deepest = std::max(deepest, depth);
    for (int d = 0; d < dim; d++) away[d] += depth / r * (at[d] - atom->x[j][d]);
  });
  const double length = MathExtra::len3(away.data());
  for (double &a : away) a *= length > 0.0 ? deepest / length : 0.0;
  return away;
}

void FSI::set_density(int i, double rho, Atom *atom, const Discretization &disc, Ledger &ledger,
                      Ledger::Term term)
{
  const double before = ledger.kept ? stored(i, atom, disc) : 0.0;
  atom->rho[i] = rho;
  if (ledger.kept) ledger.energy_out[term] += before - stored(i, atom, disc);
}

double FSI::lattice_mass(const Discretization &disc, int type)
{
  const State &s = disc.state[type];
  const Resolution &r = disc.resolution[type];
  if (s.form != TOTAL_LAGRANGIAN) return s.rho0 / r.psi_bulk;
  return s.rho0 * (disc.dim == 2 ? r.dx * r.dx : r.dx * r.dx * r.dx);
}

// An atom that was never given a mass or a density gets those of the stress-free lattice: of a
// body that keeps its reference the cell's, which is exact; else 1/psi, whose sum is. Without a
// material it has one number for the checks of all densities: mass over volume
void FSI::give_defaults(int i, Atom *atom, const Discretization &disc)
{
  const int type = atom->type[i];
  const State &s = disc.state[type];
  const double r = atom->radius_flag ? atom->radius[i] : 0.0;
  if (s.species == NONE) {
    const double volume = r == 0.0 ? 1.0 / disc.psi_bulk
        : disc.dim == 2            ? MY_PI * r * r
                                   : 4.0 / 3.0 * MY_PI * r * r * r;
    atom->rho[i] = atom->rmass[i] / volume;
    return;
  }
  // that of atom_style sphere for all new particles, whatever they are; releases differ in its
  // last bit
  const bool of_sphere =
      atom->radius_flag && std::fabs(atom->rmass[i] / (MY_PI / 6.0) - 1.0) < 1e-15;
  if (atom->rmass[i] == 0.0 || of_sphere) atom->rmass[i] = lattice_mass(disc, type);
  if (atom->rho[i] == 0.0) atom->rho[i] = s.rho0;
  // likewise its radius: to fix rigid these are points, no spheres
  if (atom->radius_flag && atom->radius[i] == 0.5) atom->radius[i] = 0.0;
}

bool FSI::is_moved(int i, const LAMMPS *lmp)
{
  // not get_fix_list(), which makes the list anew: who asks in set_arrays() is called from a loop
  // over it
  const Modify *const modify = lmp->modify;
  for (int k = 0; k < modify->nfix; k++)
    if (modify->fix[k]->time_integrate && lmp->atom->mask[i] & modify->fix[k]->groupbit)
      return true;
  return false;
}

bool FSI::has_open_ends(const LAMMPS *lmp)
{
  for (const auto *p : fixes_of<Part>(lmp))
    if (p->rank() == Part::OPEN_ENDS) return true;
  return false;
}

static Facts facts_of(LAMMPS *lmp, Facts::Style least, Facts::Style most)
{
  for (const auto *p : pairs_of<Part>(lmp)) {
    const Facts facts = p->facts();
    if (facts.style >= least && facts.style <= most) return facts;
  }
  return {};
}

Facts FSI::facts_of_fluids(LAMMPS *lmp)
{
  return facts_of(lmp, Facts::OF_FLUIDS, Facts::OF_FLUIDS);
}

// there is one of the two (pair_fsi_solid_tl.cpp)
Facts FSI::facts_of_solids(LAMMPS *lmp)
{
  return facts_of(lmp, Facts::OF_SOLIDS, Facts::OF_TOTAL_LAGRANGIAN_SOLIDS);
}

void FSI::to_nearest_image(const Domain &box, double *d)
{
  for (int k = 0; k < 3; k++)
    if (box.periodicity[k] && std::fabs(d[k]) > box.prd_half[k])
      d[k] = std::remainder(d[k], box.prd[k]);
}

bool FSI::is_periodic(const Domain &box)
{
  return std::count(box.periodicity, box.periodicity + box.dimension, 0) < box.dimension;
}

void FSI::renew_ghosts(LAMMPS *lmp)
{
  lmp->domain->pbc();
  lmp->domain->reset_box();
  lmp->comm->setup();
  if (lmp->neighbor->style) lmp->neighbor->setup_bins();
  lmp->comm->exchange();
  lmp->comm->borders();
}

double FSI::part_by_place(const double *x, const Domain *domain)
{
  double part = 0.0, digit = 0.5;
  for (int d = 0; d < domain->dimension; d++, digit *= 1.0e-4)
    part += digit * (x[d] - domain->boxlo[d]) / domain->prd[d];
  return part;
}

/* ----------------------------------------------------------------------
   body forces
------------------------------------------------------------------------- */

// all fix gravity commands, and which of them act on all particles of a type: only then two
// neighbors are pushed alike, and what is hydrostatic between them has a meaning
void BodyForces::find()
{
  all.clear();
  for (auto *g : fixes_of<FixGravity>(lmp)) {
    all.push_back({g, is_disabled(g) ? 0 : g->groupbit, has_variable(g), {}, {}});
    g->init();    // its variables are looked up
  }
  acts_on_all.assign(all.size() * (atom->ntypes + 1), 0);
  warned = acts_on_all;
}

// Of the particles that there are now: levels and buffers may be empty at the start of a run, and
// a dynamic group at any step
void BodyForces::find_whole_types(const std::vector<State> &state)
{
  const int ntypes = atom->ntypes, nfields = all.size(), n = acts_on_all.size();
  std::vector<int> local(2 * n, 0);    // type by type: with, without
  for (int i = 0; i < atom->nlocal; i++)
    for (int k = 0; k < nfields; k++)
      local[(atom->mask[i] & all[k].mask ? 0 : n) + k * (ntypes + 1) + atom->type[i]] = 1;
  const auto any = over_ranks(local, MPI_MAX, world);
  for (int at = 0; at < n; at++) {
    const int k = at / (ntypes + 1), t = at % (ntypes + 1);
    acts_on_all[at] = any[at] && !any[n + at];
    if (!any[at] || !any[n + at] || state[t].species != FLUID || warned[at]++ || comm->me > 0)
      continue;
    error->warning(FLERR,
                   "Fix gravity {} acts on a part of the particles of type {} only: for what "
                   "is hydrostatic between them, as in density diffusion, it does not count",
                   all[k].fix->id, t);
  }
}

// Body forces of this step. Fix gravity evaluates its variables when it acts, after the pair
// styles: it is asked to do so earlier, with nothing to act on.
void BodyForces::evaluate(const std::vector<State> &state)
{
  const bool dynamic = std::any_of(all.begin(), all.end(), [this](const Field &field) {
    return group->dynamic[field.fix->igroup] != 0;
  });
  if ((neighbor->ago == 0 && !all.empty()) || dynamic) find_whole_types(state);
  of_type.assign(atom->ntypes + 1, {0.0, 0.0, 0.0});
  size_t on = 0;
  for (auto &field : all) {
    if (field.varies) {
      const int groupbit = field.fix->groupbit;
      field.fix->groupbit = 0;
      field.fix->post_force(0);
      field.fix->groupbit = groupbit;
    }
    int dim_of_extract;
    const auto *now = static_cast<double *>(field.fix->extract("gvec", dim_of_extract));
    for (int d = 0; d < 3; d++) field.change[d] = now[d] - field.g[d];
    std::copy_n(now, 3, field.g);
    for (int t = 0; t <= atom->ntypes; t++, on++)
      if (t > 0 && acts_on_all[on])
        for (int d = 0; d < 3; d++) of_type[t][d] += field.g[d];
  }
}

// Where a field changes, so does the potential energy of what is there, which the ledger has to
// know.
double BodyForces::work(const std::vector<State> &state, int groupbit) const
{
  const double dth = 0.5 * update->dt;
  double sum = 0.0;
  for (const auto &field : all) {
    if (!field.varies) continue;
    for (int i = 0; i < atom->nlocal; i++)
      if ((atom->mask[i] & field.mask) && state[atom->type[i]].species != RIGID &&
          state[atom->type[i]].species != NONE) {
        double x[3];
        domain->unmap(atom->x[i], atom->image[i], x);
        for (int d = 0; d < domain->dimension; d++)
          sum += atom->rmass[i] * field.change[d] *
              (x[d] - (atom->mask[i] & groupbit ? dth * atom->v[i][d] : 0.0));
      }
  }
  return sum;
}

std::array<double, 3> BodyForces::on(int i) const
{
  std::array<double, 3> g = {0.0, 0.0, 0.0};
  for (const auto &field : all)
    if (atom->mask[i] & field.mask)
      for (int d = 0; d < 3; d++) g[d] += field.g[d];
  return g;
}

// gravity may pull through a periodic face
double BodyForces::potential(int i) const
{
  double x[3];
  domain->unmap(atom->x[i], atom->image[i], x);
  const auto g = on(i);
  return -atom->rmass[i] * (g[0] * x[0] + g[1] * x[1] + g[2] * x[2]);
}
