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

#include "fix_fsi.h"

#include "atom.h"
#include "atom_vec.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix_fsi_dt.h"
#include "fix_fsi_report.h"
#include "fix_fsi_stream.h"
#include "fix_fsi_stress.h"
#include "fix_fsi_wall_mirror.h"
#include "fix_fsi_wall_particle.h"
#include "fix_gravity.h"
#include "force.h"
#include "fsi_advice.h"
#include "fsi_check.h"
#include "fsi_gradient.h"
#include "fsi_kernel.h"
#include "fsi_lattice.h"
#include "fsi_record.h"
#include "fsi_tensor.h"
#include "group.h"
#include "memory.h"
#include "modify.h"
#include "neighbor.h"
#include "output.h"
#include "pair_fsi_fluid.h"
#include "pair_fsi_solid.h"
#include "pair_fsi_solid_tl.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace FSI;

/* ---------------------------------------------------------------------- */

FixFSI::FixFSI(LAMMPS *lmp, int narg, char **arg) :
    FixFields(lmp, narg, arg), keywords(lmp, "fix fsi"), psi(nullptr), rate(nullptr),
    shift(nullptr), grad(nullptr), wmask(nullptr), ledger(false), taken{}, wall_velocity(nullptr), wall_stiffness(nullptr), fix_stress(nullptr), fluid(nullptr),
    solid(nullptr), solid_tl(nullptr), fix_dt(nullptr), profile(nullptr), check(nullptr), stagger(0.0), forward(lmp, state), back(lmp, state),
    scalar_back(lmp, state), summed(nullptr), beyond(nullptr), ratio(nullptr), tally_dt(0.0), need_psi(false), need_grad(false), need_shift(false), keep_psi(false),
    send_psi(true), nlocal_ready(-1), ids_checked(false)
{
  if (!atom->style_match("fsi")) error->all(FLERR, "Fix fsi requires atom_style fsi");

  static const std::vector<std::string> modes = {"continuity", "summation", "ratio"};
  static const char *const other_kernel = "masses of particles and bonds of total-Lagrangian solids are still those of the old one";
  static const char *const other_mode = "continuity and ratio go on from the density that there is, summation makes it anew";
  keywords.argument("particle spacing").number(dx, 0.0, Range::above(0.0)).kept("that of the particles cannot change");
  keywords.argument("kernel").choice(kernel, CUBIC, {"cubic", "quintic", "wendland"}).changes(other_kernel);
  keywords.argument("smoothing length over spacing").number(hdx, 0.0, Range::between(0.9, 4.0)).changes(other_kernel);
  keywords.key("fluid").choice(density_fluid, CONTINUITY, modes, "density").changes(other_mode);
  keywords.key("solid").choice(density_solid, CONTINUITY, modes, "density").changes(other_mode);
  keywords.key("substeps").integer(given_substeps, 1, 1, 10000);
  keywords.key("surface/every").integer(surface_every, 1, 1);
  keywords.key("mach").number(mach, 1.0, Range::above(0.0)).or_word("off", Check::OFF);
  keywords.parse(narg - 3, arg + 3);
  substeps = given_substeps;

  dim = domain->dimension;
  h = hdx * dx;
  with_kernel(kernel, dim, h, [&](const auto &k) {
    cut = k.cut;
    psi_bulk = lattice_number_density(k, dx);
    wdx = k.W(dx);
    w0 = k.W(0.0);
  });
  state.resize(atom->ntypes + 1);
  check = new Check(lmp, this);

  time_integrate = 1;
  force_reneighbor = 1;
  create_attribute = 1;
  restart_global = 1;
  keep_psi = surface_every > 1 && density_fluid == CONTINUITY && density_solid == CONTINUITY;
  set_fields();
  register_fields();
  comm_reverse = 1;    // more with solids, see init()
}

/* ---------------------------------------------------------------------- */

FixFSI::~FixFSI()
{
  delete check;
}

/* ----------------------------------------------------------------------
   the arrays that the effects need which there are now
------------------------------------------------------------------------- */

void FixFSI::set_fields()
{
  const bool ratios = density_fluid == RATIO || density_solid == RATIO;
  const bool noslip = std::any_of(particle_walls.begin(), particle_walls.end(), [](const auto *fix) { return !fix->slip; });
  const bool sticks = fluid && fluid->sticks_to_solids();
  fields.set("reference of ratio", Fields::FILE, ratios, ratio);
  fields.set("number density", keep_psi ? Fields::FILE : Fields::STEP, keep_psi || need_psi, psi);
  fields.set("density rate", Fields::STEP, fluid && density_fluid == CONTINUITY, rate);
  fields.set("shift", Fields::STEP, need_shift, shift, nshift());
  fields.set("velocity gradient", Fields::STEP, need_grad, grad, need_grad ? ngrad() : 0);
  fields.set("walls near", Fields::STEP, !wall_fixes.empty(), wmask);
  fields.set("wall velocity", Fields::STEP, noslip || sticks, wall_velocity, 3);
  fields.set("velocity beyond solids", Fields::STEP, sticks, beyond, dim + 1);
  fields.set("wall stiffness", Fields::STEP, !particle_walls.empty() && several_stiffnesses(), wall_stiffness);

  forward.clear();
  forward.add(atom->rho, {NONE, FLUID, SOLID, RIGID});
  if (need_psi) forward.add(psi, {NONE, FLUID, SOLID, RIGID}, &send_psi);
  if (solid) {
    forward.add(fix_stress->stress, 0, dim == 2 ? 3 : 6, {SOLID});
    forward.add(grad, dim * dim, dim * solid->terms(), {SOLID});
  }
  if (sticks) forward.add(wall_velocity, 0, dim, {SOLID});
  back.clear();
  if (sticks) back.add(beyond, 0, dim + 1, {SOLID});
  if (need_grad) back.add(grad, 0, ngrad(), {SOLID});
  if (fluid && density_fluid == CONTINUITY) back.add(rate, {FLUID, RIGID});
  if (need_shift) back.add(shift, 0, nshift(), {FLUID, RIGID});
  scalar_back.clear();
  scalar_back.add(summed, {NONE, FLUID, SOLID, RIGID});
  comm_forward = forward.size();
  comm_reverse = std::max(1, back.size());
}

/* ---------------------------------------------------------------------- */

FixFSI *FixFSI::find(LAMMPS *lmp, const std::string &who)
{
  auto fixes = lmp->modify->get_fix_by_style("^fsi$");
  if (fixes.empty()) lmp->error->all(FLERR, "{} requires fix fsi, which holds particle spacing and kernel", who);
  return dynamic_cast<FixFSI *>(fixes[0]);
}

FixFSI *FixFSI::ready(LAMMPS *lmp, const std::string &who)
{
  FixFSI *const hub = find(lmp, who);
  int mine = hub->nlocal_ready != lmp->atom->nlocal, any = 0;
  MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, lmp->world);
  if (any) lmp->error->all(FLERR, "{} needs a run before it, if only run 0, and after atoms are made or deleted", who);
  return hub;
}

/* ---------------------------------------------------------------------- */

int FixFSI::setmask()
{
  return INITIAL_INTEGRATE | PRE_EXCHANGE | PRE_FORCE | FINAL_INTEGRATE;
}

/* ---------------------------------------------------------------------- */

void FixFSI::init()
{
  if (modify->get_fix_by_style("^fsi$").size() > 1) error->all(FLERR, "There can be only one fix fsi");
  if (update->whichflag == 2)
    error->all(FLERR, "Fix fsi does not support minimize: there is no energy of all particles; run with fix viscous or artificial/visc to a state of rest");
  if (utils::strmatch(update->integrate_style, "^respa"))
    error->all(FLERR, "Fix fsi does not support run_style respa");
  if (update->dt < 0.0) error->all(FLERR, "Fix fsi: timestep {} must be >= 0", update->dt);
  if (comm->cutghostuser > 0.0 && comm->cutghostuser < cut)
    error->all(FLERR, "Kernel support {} of fix fsi is larger than the comm_modify cutoff {}", cut, comm->cutghostuser);
  if (domain->dimension != dim)
    error->all(FLERR, "Dimension was {} when fix fsi was defined and is {} now", dim, domain->dimension);
  if (domain->triclinic) error->all(FLERR, "Fix fsi does not support triclinic boxes");

  fluid = dynamic_cast<PairFSIFluid *>(force->pair_match("fsi/fluid", 1));
  solid = dynamic_cast<PairFSISolid *>(force->pair_match("fsi/solid", 1));
  solid_tl = dynamic_cast<PairFSISolidTL *>(force->pair_match("fsi/solid/tl", 1));
  if (!fluid && !solid && !solid_tl)
    error->all(FLERR, "Fix fsi requires pair_style fsi/fluid, fsi/solid or fsi/solid/tl");
  if (substeps > 1 && !solid_tl) error->all(FLERR, "Fix fsi substeps requires pair_style fsi/solid/tl");
  if (solid_tl && density_solid != CONTINUITY)
    error->all(FLERR, "Fix fsi solid density summation and ratio are for pair_style fsi/solid: that of fsi/solid/tl follows from its strain");
  if (solid_tl && fluid && fluid->shares_stress())
    error->all(FLERR, "Pair style fsi/solid/tl requires couple wall in pair_style fsi/fluid: its stress is not one that crosses to the fluid");

  // the plain forces of a solid end at its face with half a kernel of neighbours missing, which the fluid's pairs supply; forces with
  // corrected gradients are complete without them
  if (fluid && fluid->shares_stress() && solid && solid->terms())
    error->all(FLERR, "Pair style fsi/fluid couple pressure and full require pair_style fsi/solid gradient plain: with corrected gradients "
                      "use couple wall");

  auto stress = modify->get_fix_by_style("^fsi/stress$");
  if (stress.size() > 1) error->all(FLERR, "There can be only one fix fsi/stress");
  fix_stress = stress.empty() ? nullptr : dynamic_cast<FixFSIStress *>(stress[0]);
  if (solid && !fix_stress)
    error->all(FLERR, "Pair style fsi/solid requires fix fsi/stress: without it a solid has no shear stress");
  if (solid_tl && solid_tl->hypoelastic() && !fix_stress) error->all(FLERR, "Pair style fsi/solid/tl law hypo requires fix fsi/stress");

  auto dt = modify->get_fix_by_style("^fsi/dt$");
  fix_dt = dt.empty() ? nullptr : dynamic_cast<FixFSIDt *>(dt[0]);
  stagger = 0.0;
  nlocal_ready = -1;
  restore_clock();
  auto report = modify->get_fix_by_style("^fsi/report$");
  profile = report.empty() ? nullptr : &dynamic_cast<FixFSIReport *>(report[0])->profile;

  wall_fixes.clear();
  for (auto &fix : modify->get_fix_by_style("^fsi/wall/mirror$"))
    wall_fixes.push_back(dynamic_cast<FixFSIWallMirror *>(fix));
  gather_walls();
  particle_walls.clear();
  for (auto &fix : modify->get_fix_by_style("^fsi/wall/particle$"))
    particle_walls.push_back(dynamic_cast<FixFSIWallParticle *>(fix));

  streams.clear();
  for (auto &fix : modify->get_fix_by_style("^fsi/stream$")) streams.push_back(dynamic_cast<FixFSIStream *>(fix));

  need_psi = density_fluid != CONTINUITY || (fluid && fluid->surface_ratio > 0.0) ||
      (solid && density_solid != CONTINUITY);
  need_grad = solid != nullptr;
  need_shift = fluid && fluid->shifting > 0.0;
  set_fields();

  ledger = !modify->get_compute_by_style("^fsi/energy$").empty();

  // pair forces and density rates need the velocities of ghosts
  comm->ghost_velocity = 1;

  for (int i = 0; i < atom->nlocal; i++) {
    if (state[atom->type[i]].species == NONE)
      error->one(FLERR, "Atom {} is of type {}, which has no material: give it one in pair_coeff", atom->tag[i],
                 atom->type[i]);
    if (state[atom->type[i]].species == RIGID &&
        std::none_of(particle_walls.begin(), particle_walls.end(), [&](const Fix *fix) { return atom->mask[i] & fix->groupbit; }))
      error->one(FLERR, "Atom {} of type {} is of a wall, but in no fix fsi/wall/particle", atom->tag[i], atom->type[i]);
    give_defaults(i);
  }
  find_gravity();
  check->init();
}

/* ---------------------------------------------------------------------- */

void FixFSI::setup(int)
{
  clock.reset();
  announce();
  check->setup();
}

/* ----------------------------------------------------------------------
   say what is simulated, when it changes: every effect that is on, every one that is not and how to turn it on, and what memory and
   messages they need
------------------------------------------------------------------------- */

void FixFSI::announce()
{
  static const char *const modes[] = {"continuity", "summation", "ratio"};
  static const char *const kernels[] = {"cubic spline", "quintic spline", "Wendland C2"};
  std::vector<PairFSI::Effect> effects;
  if (fluid) effects.push_back({fmt::format("density of the fluid by {}", modes[density_fluid]), "", true});
  if (solid) effects.push_back({fmt::format("density of the solid by {}", modes[density_solid]), "", true});
  for (const PairFSI *pair : {(PairFSI *) fluid, (PairFSI *) solid, (PairFSI *) solid_tl})
    if (pair)
      for (const auto &e : pair->effects()) effects.push_back(e);
  if (fluid) effects.push_back({fmt::format("{} mirror walls", walls.wall.size()), "fix fsi/wall/mirror", !wall_fixes.empty()});
  if (fluid && fluid->surface_ratio > 0.0)
    effects.push_back({fmt::format("surface looked for every {} steps", surface_every), "fix fsi surface/every", keep_psi});
  if (fix_stress) effects.push_back({"plasticity", "fix fsi/stress plastic", fix_stress->plastic != 0});
  if (solid_tl) effects.push_back({fmt::format("{} solid sub-steps", substeps), "fix fsi substeps", substeps > 1});
  if (fluid) effects.push_back({fmt::format("{} groups of wall particles", particle_walls.size()), "fix fsi/wall/particle", !particle_walls.empty()});
  effects.push_back({"energy ledger", "compute fsi/energy", ledger});
  std::string on, off;
  effects_on.clear();
  for (const auto &e : effects) {
    if (e.on) {
      on += "\n    " + e.name;
      effects_on.push_back(e.name);
    } else off += (off.empty() ? "" : ", ") + e.keyword;
  }

  const int ng = need_grad ? ngrad() : 0, ns = need_shift ? nshift() : 0;
  const int fluid_bytes = 8 * (fluid ? 2 * dim + 4 + (density_fluid == CONTINUITY) + ns : 0) + (wall_fixes.empty() ? 0 : 4);
  std::string text = fmt::format("FSI: {}, h = {:g} dx, dx = {:g}\n  on: {}\n  off (keyword that turns it on): {}\n", kernels[kernel],
                                 h / dx, dx, on, off.empty() ? "none" : off);
  if (fluid)
    with_kernel(kernel, dim, h, [&](const auto &k) {
      const auto s = lattice_stiffness(k, dx);
      text += fmt::format("  a lattice of the fluid under a pressure p has, for 0, a modulus of {:.3f} p when stretched, {:.3f} p in shear\n",
                          s.stretch, s.shear);
    });
  text += fmt::format("  arrays of all particles: {} bytes each{}{}\n", 8 * (need_psi + ng) + fluid_bytes,
                      need_psi ? ", number density" : "", ng ? ", velocity gradient" : "");
  // what crosses ranks beyond positions and forces: messages to a neighbor, bytes of a ghost
  const bool newton = force->newton_pair, hourglass = solid && solid->has_hourglass();
  const int nwalls = particle_walls.size(), forward = 1 + hourglass + nwalls;
  const bool send = need_psi && !keep_psi;
  const int back = newton * (((fluid && density_fluid == CONTINUITY) || ng) + send + hourglass + nwalls);
  const int both = 1 + send * (1 + newton);
  const int fluid_ghost = fluid ? both + newton * (density_fluid == CONTINUITY) * (1 + ns) : 0;
  int solid_ghost = both;
  if (solid) solid_ghost += (dim == 2 ? 3 : 6) + dim * solid->terms() + newton * ng + hourglass * (dim * dim + newton * dim);
  if (beyond) solid_ghost += dim + newton * (dim + 1);
  if (solid_tl) solid_ghost += substeps * dim + (substeps > 1 ? substeps * solid_tl->comm_forward : 0);
  text += fmt::format("  messages to each neighbor rank in a step, beyond positions and forces: {} forward, {} back{}\n", forward, back,
                      !solid_tl ? "" : substeps > 1 ? fmt::format("; {} each way for solid sub-steps, where they carry solids", substeps) : "; 1 back for solid forces");
  text += fmt::format("  they carry for each ghost:{}{}\n", fluid ? fmt::format(" {} bytes of a fluid", 8 * fluid_ghost) : "",
                      solid || solid_tl ? fmt::format("{} {} bytes of a solid", fluid ? "," : "", 8 * solid_ghost) : "");
  if (need_psi && keep_psi)
    text += fmt::format("  every {} steps: {} message back and {} bytes of a ghost more, number density\n", surface_every, (int) newton,
                        8 * (1 + newton));
  if (text == announced) return;
  announced = text;
  if (comm->me == 0) utils::logmesg(lmp, text);
  advise(lmp, *this);
  warn_idle();
}

/* ----------------------------------------------------------------------
   an atom that was never given a mass or a density gets those of the stress-free lattice
------------------------------------------------------------------------- */

void FixFSI::give_defaults(int i)
{
  const State &s = state[atom->type[i]];
  if (s.species == NONE) return;    // before init()
  if (atom->rmass[i] == 0.0) atom->rmass[i] = s.rho0 / psi_bulk;
  if (atom->rho[i] == 0.0) atom->rho[i] = s.rho0;
}

/* ---------------------------------------------------------------------- */

bool FixFSI::is_moved(int i) const
{
  if (atom->mask[i] & groupbit) return true;
  for (auto &fix : modify->get_fix_list())
    if (fix->time_integrate && atom->mask[i] & fix->groupbit) return true;
  return false;
}

/* ----------------------------------------------------------------------
   what a pair style knows of an atom type
------------------------------------------------------------------------- */

void FixFSI::enter_state(int type, const State &s)
{
  state[type] = s;
}

/* ----------------------------------------------------------------------
   all fix gravity commands, and which of them act on all particles of a type: only then two neighbours are pushed alike, and what is
   hydrostatic between them has a meaning
------------------------------------------------------------------------- */

namespace {
struct Peek : FixGravity {
  static bool is_disabled(const FixGravity *fix) { return fix->*&Peek::disable; }
  static bool has_variable(const FixGravity *fix) { return fix->*&Peek::varflag != CONSTANT; }
};
}    // namespace

void FixFSI::find_gravity()
{
  body_forces.clear();
  for (auto &fix : modify->get_fix_by_style("^gravity"))
    if (auto *g = dynamic_cast<FixGravity *>(fix)) {
      body_forces.push_back({g, Peek::is_disabled(g) ? 0 : g->groupbit, Peek::has_variable(g), {0.0, 0.0, 0.0}});
      g->init();    // its variables are looked up
    }
  const int ntypes = atom->ntypes, nfields = body_forces.size();
  const auto at = [ntypes](int field, int type) { return (size_t) field * (ntypes + 1) + type; };
  std::vector<int> without(nfields * (ntypes + 1), 0), with(without), some(without);
  for (int i = 0; i < atom->nlocal; i++)
    for (int k = 0; k < nfields; k++) (atom->mask[i] & body_forces[k].mask ? with : without)[at(k, atom->type[i])] = 1;
  acts_on_all.resize(without.size());
  MPI_Allreduce(without.data(), acts_on_all.data(), (int) without.size(), MPI_INT, MPI_MAX, world);
  MPI_Allreduce(with.data(), some.data(), (int) with.size(), MPI_INT, MPI_MAX, world);
  for (int k = 0; k < nfields; k++)
    for (int t = 1; t <= ntypes; t++) {
      if (some[at(k, t)] && acts_on_all[at(k, t)] && state[t].species == FLUID && comm->me == 0)
        error->warning(FLERR, "Fix gravity {} acts on a part of the particles of type {} only: for what is hydrostatic between them, as in "
                              "density diffusion, it does not count", body_forces[k].fix->id, t);
      acts_on_all[at(k, t)] = body_forces[k].mask && !acts_on_all[at(k, t)];
    }
  gravity.assign(ntypes + 1, {0.0, 0.0, 0.0});
}

/* ----------------------------------------------------------------------
   Body forces of this step. Fix gravity evaluates its variables when it acts, after the pair styles: it is asked to do so earlier, with
   nothing to act on. Where the field changes, so does the potential energy of what is there, which the ledger has to know; taken in
   the middle between two steps, positions are those of whole steps.
------------------------------------------------------------------------- */

void FixFSI::update_gravity(bool advance)
{
  gravity.assign(atom->ntypes + 1, {0.0, 0.0, 0.0});
  size_t on = 0;
  for (auto &field : body_forces) {
    if (field.varies) {
      const int groupbit = field.fix->groupbit;
      field.fix->groupbit = 0;
      field.fix->post_force(0);
      field.fix->groupbit = groupbit;
    }
    int dim_of_extract;
    const auto *now = static_cast<double *>(field.fix->extract("gvec", dim_of_extract));
    if (field.varies && ledger && advance) {
      const double dth = 0.5 * update->dt;
      for (int i = 0; i < atom->nlocal; i++)
        if ((atom->mask[i] & field.mask) && state[atom->type[i]].species != RIGID)
          for (int d = 0; d < dim; d++)
            taken[FIELDS] += atom->rmass[i] * (now[d] - field.g[d]) * (atom->x[i][d] - (atom->mask[i] & groupbit ? dth * atom->v[i][d] : 0.0));
    }
    std::copy_n(now, 3, field.g);
    for (int t = 0; t <= atom->ntypes; t++, on++)
      if (t > 0 && acts_on_all[on])
        for (int d = 0; d < 3; d++) gravity[t][d] += field.g[d];
  }
}

/* ---------------------------------------------------------------------- */

std::array<double, 3> FixFSI::body_force(int i) const
{
  std::array<double, 3> g = {0.0, 0.0, 0.0};
  for (const auto &field : body_forces)
    if (atom->mask[i] & field.mask)
      for (int d = 0; d < 3; d++) g[d] += field.g[d];
  return g;
}

/* ---------------------------------------------------------------------- */

bool FixFSI::several_stiffnesses() const
{
  double first = 0.0;
  for (const auto &s : state) {
    if (s.species != FLUID) continue;
    const double K = s.rho0 * s.csq;
    if (first == 0.0) first = K;
    else if (std::abs(K - first) > 1.0e-12 * first) return true;
  }
  return false;
}

/* ----------------------------------------------------------------------
   one list of walls from all fixes fsi/wall/mirror
------------------------------------------------------------------------- */

void FixFSI::gather_walls()
{
  walls.wall.clear();
  for (auto *fix : wall_fixes) {
    fix->first = walls.wall.size();
    for (const auto &w : fix->walls) walls.wall.push_back(w);
  }
  if (walls.wall.size() > Walls::MAXWALL)
    error->all(FLERR, "There are {} mirror walls, more than the {} supported", walls.wall.size(), Walls::MAXWALL);
  walls.find_reflections();
}

/* ---------------------------------------------------------------------- */

int FixFSI::ngrad() const
{
  const int terms = solid->terms();
  if (terms == 0) return dim * dim;
  return dim * terms + 2 * packed_size(terms);
}

/* ---------------------------------------------------------------------- */

void FixFSI::add_wall_force(int wall, int axis, double f)
{
  for (auto *fix : wall_fixes)
    if (wall >= fix->first && wall < fix->first + (int) fix->walls.size()) fix->force[wall - fix->first][axis] -= f;
}

/* ---------------------------------------------------------------------- */

void FixFSI::setup_pre_force(int)
{
  update_state(false);
}

/* ----------------------------------------------------------------------
   A run that goes on from a restart file must be the uninterrupted run bit for bit, so sums must keep their order, which is
   that of atoms and neighbour lists. So the first step of a run, and the one after a restart was written, do the same: wrap
   positions, rebuild, and put the atoms of each rank in an order that depends on nothing but where they are and their IDs.
------------------------------------------------------------------------- */

bool FixFSI::fresh_start() const
{
  const bigint before = update->ntimestep - 1;
  return before == update->firststep || (output->restart_flag && before == output->last_restart);
}

/* ---------------------------------------------------------------------- */

void FixFSI::pre_exchange()
{
  check->positions();
  if (!fresh_start()) return;
  domain->pbc();
  if (domain->box_change) {
    domain->reset_box();
    comm->setup();
    if (neighbor->style) neighbor->setup_bins();
  }
  comm->exchange();
  sort_by_place();
}

/* ----------------------------------------------------------------------
   By cells of space, by ID in each: what is near in space is near in memory, whatever IDs are like. Cells as wide as the support (half and
   double that made no difference), which do not depend on the box, whose bounds may follow the particles.
------------------------------------------------------------------------- */

void FixFSI::sort_by_place()
{
  const int n = atom->nlocal;
  if (n == atom->nmax) atom->avec->grow(0);    // room for the atom in hand
  struct Place {
    std::array<bigint, 3> cell;    // slowest first
    tagint tag;
    int i;
    bool operator<(const Place &other) const { return cell != other.cell ? cell < other.cell : tag < other.tag; }
  };
  const double per_length = 1.0 / cut;
  std::vector<Place> places(n);
  for (int i = 0; i < n; i++) {
    const double *const x = atom->x[i];
    places[i] = {{(bigint) std::floor(x[2] * per_length), (bigint) std::floor(x[1] * per_length), (bigint) std::floor(x[0] * per_length)}, atom->tag[i], i};
  }
  std::sort(places.begin(), places.end());
  std::vector<int> order(n);    // new place i gets the atom that is now at order[i]
  for (int i = 0; i < n; i++) order[i] = places[i].i;
  for (int start = 0; start < n; start++) {
    if (order[start] == start) continue;
    atom->avec->copy(start, n, 0);
    int i = start;
    while (order[i] != start) {
      atom->avec->copy(order[i], i, 0);
      const int next = order[i];
      order[i] = i;
      i = next;
    }
    atom->avec->copy(n, i, 0);
    order[i] = i;
  }
}

/* ----------------------------------------------------------------------
   paper eq. 15: drift to the middle of the step
------------------------------------------------------------------------- */

void FixFSI::initial_integrate(int)
{
  if (fix_dt) fix_dt->start_of_step();
  if (fresh_start()) {
    next_reneighbor = update->ntimestep;
    domain->pbc();
  }
  dim == 2 ? drift<2>() : drift<3>();
}

template <int D> void FixFSI::drift()
{
  Row *const x = rows(atom->x), *const v = rows(atom->v);
  const int *const mask = atom->mask;
  const double dth = 0.5 * update->dt;
  for (int i = 0; i < atom->nlocal; i++)
    if (mask[i] & groupbit)
      for (int d = 0; d < D; d++) x[i][d] += dth * v[i][d];
}

/* ---------------------------------------------------------------------- */

void FixFSI::pre_force(int)
{
  update_state(true);
}

/* ----------------------------------------------------------------------
   paper eqs. 17 and 18: kick, and drift to the end of the step
------------------------------------------------------------------------- */

void FixFSI::final_integrate()
{
  check->before_kick();
  if (substeps > 1) substep_solids();
  dim == 2 ? kick<2>() : kick<3>();
}

template <int D> void FixFSI::kick()
{
  Row *const x = rows(atom->x), *const v = rows(atom->v), *const f = rows(atom->f);
  const double *const rmass = atom->rmass;
  const int *const mask = atom->mask, *const type = atom->type;
  const double dt = update->dt, dtf = dt * force->ftm2v, dth = 0.5 * dt;
  const bool no_solids = substeps > 1;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(mask[i] & groupbit)) continue;
    if (no_solids && state[type[i]].species == SOLID) continue;
    const double dtfm = dtf / rmass[i];
    for (int d = 0; d < D; d++) {
      v[i][d] += dtfm * f[i][d];
      x[i][d] += dth * v[i][d];
    }
    if (need_shift && state[type[i]].species == FLUID)
      for (int d = 0; d < D; d++) x[i][d] += shift[i][d];
  }
}

/* ----------------------------------------------------------------------
   Stiff solids: from the state at the start of the step on, position Verlet with a step that many times shorter. What acts on
   them from outside (f: fluid, gravity, ...), taken at the middle of the step, is held: what the fluid has lost in momentum, the
   solid gains, to round-off.
------------------------------------------------------------------------- */

void FixFSI::substep_solids()
{
  const Phase phase(profile, Profile::SOLID);
  double **x = atom->x;
  double **v = atom->v;
  double **f = atom->f;
  double **fs = nullptr;
  const double *const rmass = atom->rmass;
  const double dt = update->dt / substeps, dth = 0.5 * dt, back = -0.5 * update->dt;
  std::vector<int> moving, held;
  for (const int i : solid_tl->solids())
    if (atom->mask[i] & groupbit) moving.push_back(i);
    else if (profile) held.push_back(i);
  const auto hold = [&](double t) {
    for (const int i : held)
      for (int d = 0; d < dim; d++) profile->impulse_held[d] += t * fs[i][d];
  };

  const auto drift = [&](double t) {
    for (const int i : moving)
      for (int d = 0; d < dim; d++) x[i][d] += t * v[i][d];
  };
  tally_dt = ledger ? dt : 0.0;
  check->before_substeps();
  drift(back);
  for (int n = 0; n < substeps; n++) {
    drift(dth);
    solid_tl->forward_positions();
    solid_tl->advance_stress(dt);
    std::fill_n(solid_tl->virial, 6, 0.0);
    solid_tl->internal_forces();
    fs = solid_tl->force_of_solids();
    for (const int i : moving) {
      const double dtfm = dt * force->ftm2v / rmass[i];
      for (int d = 0; d < dim; d++) v[i][d] += dtfm * (f[i][d] + fs[i][d]);
    }
    hold(dt);
    drift(dth);
  }
  check->after_substeps();
  hold(-update->dt);    // that of the last one is in f from here on
  // what is seen from outside: the whole force and its virial, which a hybrid style has summed up already
  if (force->pair != solid_tl)
    for (int k = 0; k < 6; k++) force->pair->virial[k] += solid_tl->virial[k];
  for (const int i : solid_tl->solids())
    for (int d = 0; d < dim; d++) f[i][d] += fs[i][d];
}

/* ----------------------------------------------------------------------
   bring density and stress to the time of the positions, on local and ghost atoms
   advance = false in setup: a function of the state only, nothing evolves
------------------------------------------------------------------------- */

void FixFSI::update_state(bool advance)
{
  const int nall = atom->nlocal + atom->nghost;
  fields.grow();
  nlocal_ready = atom->nlocal;

  tally_dt = (ledger && advance) ? update->dt : 0.0;
  update_gravity(advance);
  Phase phase(profile);
  if (!wall_fixes.empty()) {
    phase.next(Profile::WALLS);
    for (auto *fix : wall_fixes) fix->clear_force();
    gather_walls();
    const Row *const x = rows(atom->x);
    // walls of particles go on behind a mirror themselves
    const Clearance away(walls.wall, cut);
    for (int i = 0; i < nall; i++)
      wmask[i] = away.holds(x[i]) || state[atom->type[i]].species == RIGID ? 0 : walls.near(x[i], cut);
  }

  if (fluid) fluid->begin_step();

  // the gradient's coefficients are needed by forces, so in setup too
  const bool gradient = need_grad && (advance || solid->terms() || beyond);
  if ((advance && rate) || gradient || beyond) {
    if (rate) memset(rate, 0, nall * sizeof(double));
    if (need_shift && nall) memset(shift[0], 0, (size_t) nall * nshift() * sizeof(double));
    if (gradient && nall) memset(grad[0], 0, (size_t) nall * ngrad() * sizeof(double));
    phase.next(Profile::DENSITY);
    if (rate && advance) fluid->density_rate(update->dt);
    if (beyond) {
      if (nall) memset(beyond[0], 0, (size_t) nall * (dim + 1) * sizeof(double));
      fluid->velocity_at_solids(beyond);
    }
    if (gradient) {
      phase.next(Profile::STRESS);
      solid->velocity_gradient(advance ? update->dt : 0.0);
    }
    if (force->newton_pair) reverse_comm(profile, comm, this);
    if (beyond) extrapolate_velocities();
    if (advance) advance_density();
    if (need_shift && advance) fluid->displacements(update->dt);
    if (gradient) {
      if (solid->terms() == 0) dim == 2 ? advance_solids<2, 0>(advance) : advance_solids<3, 0>(advance);
      else if (solid->terms() == dim) dim == 2 ? advance_solids<2, 2>(advance) : advance_solids<3, 3>(advance);
      else dim == 2 ? advance_solids<2, 5>(advance) : advance_solids<3, 9>(advance);
      if (advance && solid->has_hourglass()) solid->advance_hourglass(update->dt);
    }
  }
  send_psi = need_psi && (!keep_psi || !advance || neighbor->ago == 0);    // or to new ghosts
  if (need_psi && psi_is_due(advance)) {
    phase.next(Profile::DENSITY);
    number_density(psi);
    send_psi = true;
  }
  if (send_psi) {
    psi_reference = psi_bulk;
    if (fluid && fluid->surface_max) {
      double mine = 0.0;
      for (int i = 0; i < atom->nlocal; i++)
        if (state[atom->type[i]].species == FLUID && psi[i] > mine) mine = psi[i];
      MPI_Allreduce(&mine, &psi_reference, 1, MPI_DOUBLE, MPI_MAX, world);
    }
    if (density_fluid != CONTINUITY || density_solid != CONTINUITY) density_from_psi();
  }
  if (solid_tl && advance) {
    solid_tl->break_bonds();
    if (substeps == 1) solid_tl->advance_stress(update->dt);
  }
  if (advance)
    for (auto *fix : streams) fix->damp(update->dt + stagger);
  if (comm->nprocs > 1) phase.next(Profile::MESSAGES);
  forward_comm(profile, comm, this);
  for (auto *fix : particle_walls) fix->extrapolate(advance);
}

/* ----------------------------------------------------------------------
   velocity of solids in viscous forces: where fluid would be inside the solid, that with which the face has the solid's,
   2 v_s - sum v W/sum W, as for walls of particles
------------------------------------------------------------------------- */

void FixFSI::extrapolate_velocities()
{
  for (int i = 0; i < atom->nlocal; i++) {
    if (state[atom->type[i]].species != SOLID) continue;
    const double *const s = beyond[i], *const v = atom->v[i];
    for (int d = 0; d < dim; d++) wall_velocity[i][d] = s[dim] > 0.0 ? 2.0 * v[d] - s[d] / s[dim] : v[d];
  }
}

/* ----------------------------------------------------------------------
   setup goes on with what was kept, as a run must that goes on from a restart file
------------------------------------------------------------------------- */

bool FixFSI::psi_is_due(bool advance) const
{
  if (!keep_psi) return true;
  if (advance) return update->ntimestep % surface_every == 0;
  int mine = std::count(psi, psi + atom->nlocal, 0.0), all;
  MPI_Allreduce(&mine, &all, 1, MPI_INT, MPI_MAX, world);
  return all > 0;
}

/* ----------------------------------------------------------------------
   number density psi_i = sum_j W_ij, self included (paper eq. 8): over all neighbours for a fluid; for a solid over
   its own body, and over all neighbours in density mode summation, the paper's
------------------------------------------------------------------------- */

void FixFSI::number_density(double *n)
{
  memset(n, 0, (atom->nlocal + atom->nghost) * sizeof(double));
  for (int i = 0; i < atom->nlocal; i++) n[i] = w0;
  if (fluid) fluid->number_density(n, density_solid == SUMMATION);
  if (solid) solid->number_density(n, density_solid == SUMMATION);
  add_ghosts(n);
}

/* ---------------------------------------------------------------------- */

void FixFSI::position_divergence(double *n)
{
  memset(n, 0, (atom->nlocal + atom->nghost) * sizeof(double));
  fluid->position_divergence(n);
  add_ghosts(n);
}

/* ----------------------------------------------------------------------
   to local atoms what pairs left on their ghosts
------------------------------------------------------------------------- */

void FixFSI::add_ghosts(double *n)
{
  summed = n;
  if (force->newton_pair) reverse_comm(profile, comm, this);
  summed = nullptr;
}

/* ---------------------------------------------------------------------- */

double FixFSI::pressure(int i) const
{
  const State &s = state[atom->type[i]];
  if (s.species == FLUID && fluid->surface_ratio > 0.0 && psi[i] <= fluid->surface_ratio * psi_reference) return 0.0;
  if (s.species == RIGID && wall_stiffness) return std::max(s.floor, s.p0 + wall_stiffness[i] * (atom->rho[i] / s.rho0 - 1.0));
  return s.pressure(atom->rho[i]);
}

/* ----------------------------------------------------------------------
   summation: rho_i = m_i psi_i (paper eq. 12)
   ratio: rho_i = rho_i^0 psi_i/psi_i^0 with the reference taken when the mode starts
------------------------------------------------------------------------- */

void FixFSI::density_from_psi()
{
  double *rho = atom->rho;
  const double *const rmass = atom->rmass;
  const int *const type = atom->type;
  for (int i = 0; i < atom->nlocal; i++) {
    if (state[type[i]].species == RIGID) continue;
    const int mode = state[type[i]].species == FLUID ? density_fluid : density_solid;
    if (mode == SUMMATION) rho[i] = rmass[i] * psi[i];
    else if (mode == RATIO) {
      if (ratio[i] == 0.0) ratio[i] = rho[i] / psi[i];
      rho[i] = ratio[i] * psi[i];
    }
  }
}

/* ----------------------------------------------------------------------
   fluids, continuity: rho^{n+1/2} = rho^{n-1/2} + dt (d rho/dt)^n; nobody is thinner than he would be alone (with diffusion in particles that
   are shot out of a crowd)
------------------------------------------------------------------------- */

void FixFSI::advance_density()
{
  if (!rate) return;
  double *rho = atom->rho;
  const int *const type = atom->type;
  const double dt = update->dt + stagger;
  for (int i = 0; i < atom->nlocal; i++)
    if (state[type[i]].species == FLUID) rho[i] = std::max(rho[i] + dt * rate[i], atom->rmass[i] * w0);
}

/* ----------------------------------------------------------------------
   energies of the ledger
------------------------------------------------------------------------- */

double FixFSI::potential(int i) const
{
  const double *x = atom->x[i];
  const auto g = body_force(i);
  return -atom->rmass[i] * (g[0] * x[0] + g[1] * x[1] + g[2] * x[2]);
}

double FixFSI::stored(int i) const
{
  return atom->rmass[i] * state[atom->type[i]].energy(atom->rho[i]);
}

// V S:S/(4G), with S_zz of plane strain
double FixFSI::shear_energy(int i) const
{
  if (!has_stress(i)) return 0.0;
  const double *s = fix_stress->stress[i];
  double ss;
  if (dim == 2) {
    ss = Sym<2>::load(s).squared();
    if (!fix_stress->plane_stress) ss += (s[0] + s[1]) * (s[0] + s[1]);
  } else
    ss = Sym<3>::load(s).squared();
  return atom->rmass[i] / atom->rho[i] * ss / (4.0 * state[atom->type[i]].shear);
}

double FixFSI::density_ratio(int i) const
{
  return is_total_lagrangian(i) ? 1.0 / solid_tl->volume_ratio(i) : atom->rho[i] / state[atom->type[i]].rho0;
}

/* ----------------------------------------------------------------------
   solids: velocity gradient L from its sums; stress and, in continuity mode, density from L
------------------------------------------------------------------------- */

template <int D, int TERMS> void FixFSI::advance_solids(bool advance)
{
  double *rho = atom->rho;
  const int *const type = atom->type;
  const double dt = update->dt + stagger;
  for (int i = 0; i < atom->nlocal; i++) {
    const State &s = state[type[i]];
    if (s.species != SOLID) continue;
    double *L = grad[i];
    if constexpr (TERMS > 0) {
      // L = [sum_j w_ij (v_j - v_i)(x)phi_j] C^T
      double C[D * TERMS], force_C[D * TERMS], full[D * D] = {};
      const double *const moments = L + D * TERMS;
      // hardly any neighbours: torn off, no strain, no stress to share
      if (gradient_coefficients<D, TERMS>(moments, C) == Gradient<D>::DEFICIENT) std::fill_n(C, D * TERMS, 0.0);
      if (gradient_coefficients<D, TERMS>(moments + packed_size(TERMS), force_C) == Gradient<D>::DEFICIENT)
        std::fill_n(force_C, D * TERMS, 0.0);
      for (int a = 0; a < D; a++)
        for (int b = 0; b < D; b++)
          for (int k = 0; k < TERMS; k++) full[a * D + b] += L[a * TERMS + k] * C[b * TERMS + k];
      const double inv = 1.0 / h;
      for (int k = 0; k < D * D; k++) L[k] = full[k] * inv;
      for (int k = 0; k < D * TERMS; k++) L[D * D + k] = force_C[k] * inv;
    }
    if (!advance) continue;
    const double work = fix_stress->advance<D>(i, L, dt, s);
    if (density_solid == CONTINUITY) {
      double div = 0.0;
      for (int a = 0; a < D; a++) div += L[a * D + a];
      // d rho/dt = -rho div v, centred: second order, and positive for any step
      rho[i] *= (1.0 - 0.5 * dt * div) / (1.0 + 0.5 * dt * div);
    }
    if (ledger) {
      // what the strain stores; what the pair forces deliver, with the same stress and velocity, is taken off in
      // pair_style fsi/solid: their difference is what the gradient's correction costs
      auto sigma = Sym<D>::load(fix_stress->stress[i]);
      sigma += Sym<D>::identity(-s.pressure(rho[i]));
      double power = 0.0;
      for (int a = 0; a < D; a++)
        for (int b = 0; b < D; b++) power += sigma(a, b) * L[a * D + b];
      tally(GRADIENT, -power * atom->rmass[i] / rho[i]);
      taken[PLASTIC] += work * atom->rmass[i] / rho[i];
    }
  }
}

/* ----------------------------------------------------------------------
   ghosts get density, number density where in use, stress and the gradient's coefficients where they are solid; back come the sums that
   pairs left on them
------------------------------------------------------------------------- */

int FixFSI::pack_forward_comm(int n, int *list, double *buf, int, int *)
{
  return forward.pack(n, list, buf);
}

void FixFSI::unpack_forward_comm(int n, int first, double *buf)
{
  forward.unpack(n, first, buf);
}

int FixFSI::pack_reverse_comm(int n, int first, double *buf)
{
  return (summed ? scalar_back : back).pack_back(n, first, buf);
}

void FixFSI::unpack_reverse_comm(int n, int *list, double *buf)
{
  (summed ? scalar_back : back).add_up(n, list, buf);
}

/* ---------------------------------------------------------------------- */

void FixFSI::set_arrays(int i)
{
  fields.begin(i);
  give_defaults(i);
  if (update->whichflag == 1 && state[atom->type[i]].species == FLUID && !is_moved(i))
    error->one(FLERR, "Fluid atom {} was made during a run and is not in group {} of fix {}: it would hang in the air. Give the fix that "
                      "makes it that group", atom->tag[i], group->names[igroup], id);
}

/* ----------------------------------------------------------------------
   Restart files: the command, the clock, what the ledger's terms have taken; per atom the reference of density mode ratio, or the
   number density that is kept.
------------------------------------------------------------------------- */

void FixFSI::write_restart(FILE *fp)
{
  double all[NTERM];
  MPI_Allreduce(taken, all, NTERM, MPI_DOUBLE, MPI_SUM, world);
  Record record(lmp, "fix fsi");
  keywords.write(record);
  record.add("step", std::to_string(update->ntimestep));
  record.add("clock's step", std::to_string(update->atimestep));
  record.add("clock", std::vector<double>{update->dt, update->atime});
  if (ledger) record.add("ledger", std::vector<double>(all, all + NTERM));
  fields.write(record);
  record.write(fp);
}

void FixFSI::restart(char *buf)
{
  const Record record(lmp, "fix fsi", buf);
  keywords.compare(record);
  const bool other_kernel = keywords.differs(record, "kernel") || keywords.differs(record, "smoothing length over spacing");
  if (other_kernel && (density_fluid == SUMMATION || density_solid == SUMMATION))
    error->all(FLERR, "Fix fsi: density mode summation must keep kernel and smoothing length of the restart file, for which its masses were made");
  if (other_kernel) fields.read(record, {"reference of ratio", "number density"});
  else fields.read(record);

  const auto at = record.numbers("clock");
  clock = Clock{std::stoll(record.value("step")), std::stoll(record.value("clock's step")), at[0], at[1]};
  if (record.has("ledger") && comm->me == 0) {
    const auto terms = record.numbers("ledger");
    std::copy_n(terms.begin(), std::min(terms.size(), (size_t) NTERM), taken);
  }
}

/* ----------------------------------------------------------------------
   LAMMPS counts time from a step on, and forgets that step at each init: in a run that goes on without a timestep command the time
   since then is lost. With the numbers of the file it is that of the uninterrupted run, bit for bit. Where a command has set another
   time or step, that holds.
------------------------------------------------------------------------- */

void FixFSI::restore_clock()
{
  if (!clock) return;
  const Clock &c = *clock;
  const double elapsed = c.time + (c.step - c.first_step) * c.dt, now = update->atime + (update->ntimestep - update->atimestep) * update->dt;
  const bool forgotten = update->atime == c.time || std::fabs(now - elapsed) <= 1.0e-12 * std::fabs(elapsed);
  if (update->ntimestep != c.step || !forgotten) return;
  if (update->dt == c.dt) {
    update->atime = c.time;
    update->atimestep = c.first_step;
  } else {
    update->atime = elapsed;
    update->atimestep = c.step;
  }
}

/* ---------------------------------------------------------------------- */

// LAMMPS shows what it has read to classes derived from its own only
namespace {
struct Stored : public Modify {
  static constexpr auto global_id = &Stored::id_restart_global, global_style = &Stored::style_restart_global;
  static constexpr auto global_used = &Stored::used_restart_global;
};
}    // namespace

void FixFSI::check_restart_ids()
{
  if (ids_checked) return;
  ids_checked = true;
  for (int k = 0; k < modify->nfix_restart_global; k++) {
    if ((modify->*Stored::global_used)[k]) continue;
    const std::string style_before = (modify->*Stored::global_style)[k], id_before = (modify->*Stored::global_id)[k];
    if (!utils::strmatch(style_before, "^fsi")) continue;
    for (const auto *fix : modify->get_fix_by_style("^" + style_before + "$")) {
      if (fix->restart_reset) continue;
      const auto text = fmt::format("Fix {} (style {}) takes nothing from the restart file, in which it had the ID {}: give it that ID",
                                    fix->id, style_before, id_before);
      if (style_before == "fsi" || style_before == "fsi/stress") error->all(FLERR, text);
      if (comm->me == 0) error->warning(FLERR, text);
    }
    if (style_before == "fsi/reference" && force->pair_match("^fsi/solid$", 0) && comm->me == 0)
      error->warning(FLERR, "The strain of total-Lagrangian solids in the restart file is lost: they go on in pair_style fsi/solid");
  }
}
