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
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "fsi_announce.h"
#include "fsi_check.h"
#include "fsi_kernel.h"
#include "fsi_lattice.h"
#include "fsi_order.h"
#include "fsi_part.h"
#include "fsi_record.h"
#include "group.h"
#include "modify.h"
#include "neighbor.h"
#include "output.h"
#include "pair.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace FSI;

/* ---------------------------------------------------------------------- */

FixFSI::FixFSI(LAMMPS *lmp, int narg, char **arg) :
    FixFields(lmp, narg, arg), keywords(lmp, "fix fsi"), psi(nullptr), shift(nullptr), wmask(nullptr), ledger(false), taken{},
    wall_velocity(nullptr), wall_stiffness(nullptr), noslip_walls(false), body_forces(lmp), profile(nullptr), check(nullptr), stagger(0.0),
    surface_ratio(0.0), surface_max(false), forward(lmp, state), back(lmp, state), scalar_back(lmp, state), summed(nullptr), ratio(nullptr),
    tally_dt(0.0), need_psi(false), keep_psi(false), send_psi(true), states_entered(false), nlocal_ready(-1), ids_checked(false)
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
  const bool particle_walls = !modify->get_fix_by_style("^fsi/wall/particle$").empty();
  fields.set("reference of ratio", Fields::FILE, ratios, ratio);
  fields.set("number density", keep_psi ? Fields::FILE : Fields::STEP, keep_psi || need_psi, psi);
  fields.set("walls near", Fields::STEP, walls.any(), wmask);
  fields.set("wall velocity", Fields::STEP, noslip_walls, wall_velocity, 3);
  fields.set("wall stiffness", Fields::STEP, particle_walls && several_stiffnesses(), wall_stiffness);

  forward.clear();
  forward.add(atom->rho, {NONE, FLUID, SOLID, RIGID});
  if (need_psi) forward.add(psi, {NONE, FLUID, SOLID, RIGID}, &send_psi);
  back.clear();
  for (auto *p : parts) p->add_messages(forward, back);
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
  hub->find_parts();    // commands since the last run may have changed them
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

  const bool solid = force->pair_match("fsi/solid", 1), solid_tl = force->pair_match("fsi/solid/tl", 1);
  if (!solid && !solid_tl && !force->pair_match("fsi/fluid", 1))
    error->all(FLERR, "Fix fsi requires pair_style fsi/fluid, fsi/solid or fsi/solid/tl");
  if (substeps > 1 && !solid_tl) error->all(FLERR, "Fix fsi substeps requires pair_style fsi/solid/tl");
  if (solid_tl && density_solid != CONTINUITY)
    error->all(FLERR, "Fix fsi solid density summation and ratio are for pair_style fsi/solid: that of fsi/solid/tl follows from its strain");

  stagger = 0.0;
  nlocal_ready = -1;
  states_entered = false;
  restore_clock();
  find_parts();
  profile = nullptr;
  shift = nullptr;
  noslip_walls = surface_max = false;
  surface_ratio = 0.0;
  for (auto *p : parts) {
    if (auto *counters = p->counters()) profile = counters;
    p->set_fields(*this);
  }
  gather_walls();
  need_psi = density_fluid != CONTINUITY || surface_ratio > 0.0 || (solid && density_solid != CONTINUITY);
  set_fields();

  ledger = !modify->get_compute_by_style("^fsi/energy$").empty();

  // pair forces and density rates need the velocities of ghosts
  comm->ghost_velocity = 1;

  const auto particle_walls = modify->get_fix_by_style("^fsi/wall/particle$");
  for (int i = 0; i < atom->nlocal; i++) {
    if (state[atom->type[i]].species == NONE)
      error->one(FLERR, "Atom {} is of type {}, which has no material: give it one in pair_coeff", atom->tag[i],
                 atom->type[i]);
    if (state[atom->type[i]].species == RIGID &&
        std::none_of(particle_walls.begin(), particle_walls.end(), [&](const Fix *fix) { return atom->mask[i] & fix->groupbit; }))
      error->one(FLERR, "Atom {} of type {} is of a wall, but in no fix fsi/wall/particle", atom->tag[i], atom->type[i]);
    give_defaults(i);
  }
  body_forces.find(*this);
  check->init();
}

/* ---------------------------------------------------------------------- */

void FixFSI::setup(int)
{
  clock.reset();
  announce(lmp, *this);
  check->setup();
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
  if (!states_entered) state.assign(state.size(), State());
  states_entered = true;
  // that of a solid is of the style that moves it, in whatever order a hybrid style has them
  if (state[type].form && !s.form) return;
  state[type] = s;
}

/* ---------------------------------------------------------------------- */

void FixFSI::find_parts()
{
  parts.clear();
  for (const char *style : {"fsi/fluid", "fsi/solid", "fsi/solid/tl"})
    if (auto *p = dynamic_cast<Part *>(force->pair_match(style, 1))) parts.push_back(p);
  for (auto &fix : modify->get_fix_list())
    if (auto *p = dynamic_cast<Part *>(fix)) parts.push_back(p);
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
  wall_forces.clear();
  for (auto *p : parts) p->add_walls(walls, wall_forces);
  if (walls.wall.size() > Walls::MAXWALL)
    error->all(FLERR, "There are {} mirror walls, more than the {} supported", walls.wall.size(), Walls::MAXWALL);
  walls.find_reflections();
}

/* ---------------------------------------------------------------------- */

void FixFSI::add_wall_force(int wall, int axis, double f)
{
  wall_forces[wall][axis] -= f;
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
  sort_by_place(atom, cut);
}

/* ----------------------------------------------------------------------
   paper eq. 15: drift to the middle of the step
------------------------------------------------------------------------- */

void FixFSI::initial_integrate(int)
{
  for (auto *p : parts) p->start_step();
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
  for (auto *p : parts) p->prescribe();
  check->before_kick();
  if (substeps > 1)
    for (auto *p : parts) p->integrate_substeps();
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
    if (shift && state[type[i]].species == FLUID)
      for (int d = 0; d < D; d++) x[i][d] += shift[i][d];
  }
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
  body_forces.evaluate(*this, advance);
  Phase phase(profile);
  for (auto *p : parts) p->begin_state(advance);
  if (walls.any()) {
    phase.next(Profile::WALLS);
    gather_walls();
    const Row *const x = rows(atom->x);
    // walls of particles go on behind a mirror themselves
    const Clearance away(walls.wall, cut);
    for (int i = 0; i < nall; i++)
      wmask[i] = away.holds(x[i]) || state[atom->type[i]].species == RIGID ? 0 : walls.near(x[i], cut);
  }

  phase.next(Profile::DENSITY);
  bool sums = false;
  for (auto *p : parts) sums = p->add_rates(advance) || sums;
  if (sums && force->newton_pair) reverse_comm(profile, comm, this);
  for (auto *p : parts) p->advance(advance);
  send_psi = need_psi && (!keep_psi || !advance || neighbor->ago == 0);    // or to new ghosts
  if (need_psi && psi_is_due(advance)) {
    phase.next(Profile::DENSITY);
    number_density(psi);
    send_psi = true;
  }
  if (send_psi) {
    psi_reference = psi_bulk;
    if (surface_max) {
      double mine = 0.0;
      for (int i = 0; i < atom->nlocal; i++)
        if (state[atom->type[i]].species == FLUID && psi[i] > mine) mine = psi[i];
      MPI_Allreduce(&mine, &psi_reference, 1, MPI_DOUBLE, MPI_MAX, world);
    }
    if (density_fluid != CONTINUITY || density_solid != CONTINUITY) density_from_psi();
  }
  if (comm->nprocs > 1) phase.next(Profile::MESSAGES);
  forward_comm(profile, comm, this);
  for (auto *p : parts) p->end_state(advance);
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
  for (auto *p : parts) p->add_number_density(n, density_solid == SUMMATION);
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
  if (s.species == FLUID && surface_ratio > 0.0 && psi[i] <= surface_ratio * psi_reference) return 0.0;
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
   energies of the ledger
------------------------------------------------------------------------- */

double FixFSI::potential(int i) const
{
  const double *x = atom->x[i];
  const auto g = body_forces.on(i);
  return -atom->rmass[i] * (g[0] * x[0] + g[1] * x[1] + g[2] * x[2]);
}

double FixFSI::stored(int i) const
{
  return atom->rmass[i] * state[atom->type[i]].energy(atom->rho[i]);
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

void FixFSI::check_restart_ids()
{
  if (!ids_checked) check_ids(lmp);
  ids_checked = true;
}
