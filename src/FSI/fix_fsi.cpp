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
#include "atom_vec_fsi.h"
#include "citeme.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fsi_changes.h"
#include "fsi_check.h"
#include "fsi_clamps.h"
#include "fsi_find.h"
#include "fsi_frame.h"
#include "fsi_gather.h"
#include "fsi_hub.h"
#include "fsi_kernel.h"
#include "fsi_keywords.h"
#include "fsi_number_density.h"
#include "fsi_part.h"
#include "fsi_population.h"
#include "fsi_profile.h"
#include "fsi_record.h"
#include "fsi_refusals.h"
#include "group.h"
#include "neighbor.h"
#include "output.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace FSI;

static const char cite_fsi[] =
    "FSI package: fluid-structure interaction by SPH\n\n"
    "@Misc{FSI,\n author = {{The authors of the FSI package for LAMMPS}},\n"
    " title = {FSI package for LAMMPS},\n note = {Version 0.9}\n}\n\n";

struct FixFSI::Members {
  std::vector<Part *> parts;
  Discretization disc;
  StepState step;
  Ledger ledger;
  Ghosts ghosts;
  Clock clock;
  Check check;
  Changes changes;
  Population population;
  NumberDensity number_density;
  Clamps clamps;
  SurfaceDeficit surface_deficit;
  Frame frame;

  Members(LAMMPS *lmp, FixFSI &fix) :
      disc(&fix, lmp->atom->ntypes), step(lmp, parts), ghosts(lmp, fix, disc.state, step.profile),
      clock(lmp), check(lmp, disc, step, parts), changes(lmp), population(lmp, disc, step),
      number_density(lmp, disc, step, ghosts, parts), clamps(lmp, disc, step),
      surface_deficit(lmp, disc, step, ledger, number_density), frame(lmp, step.walls)
  {
  }
};

// clang-format off
FixFSI::FixFSI(LAMMPS *lmp, int narg, char **arg) :
    FixFields(lmp, narg, arg, "fix fsi"), members(new Members(lmp, *this)), parts(members->parts),
    disc(members->disc), step(members->step), ledger(members->ledger), ghosts(members->ghosts),
    clock(members->clock), check(members->check), changes(members->changes),
    population(members->population), number_density(members->number_density),
    clamps(members->clamps), forward(lmp, disc.state), back(lmp, disc.state)
{
  if (lmp->citeme) lmp->citeme->add(cite_fsi);

  static const std::vector<std::string> names = {"cubic", "quintic", "wendland"};
  static const char *const kept = "that of the particles cannot change", *const of_kernel =
      "masses of particles and bonds of total-Lagrangian solids are still those of the old one",
      *const of_mode =
      "continuity and ratio go on from the density that there is, summation makes it anew";
  const auto positive = Range::above(0.0), ratios = Range::between(0.9, 4.0);
  keywords.argument("particle spacing").number(disc.dx, 0.0, positive).kept(kept);
  keywords.argument("kernel").choice(disc.kernel, CUBIC, names).changes(of_kernel);
  keywords.argument("smoothing length over spacing")
      .number(disc.hdx, 0.0, ratios).changes(of_kernel);
  keywords.key("scheme").choice(disc.article, 0, {"standard", "article"});
  const auto of_fluid = disc.density_names(FLUID), of_solid = disc.density_names(SOLID);
  keywords.key("fluid")
      .choice(disc.density_fluid, disc.CONTINUITY, of_fluid, "density").changes(of_mode);
  keywords.key("solid")
      .choice(disc.density_solid, disc.CONTINUITY, of_solid, "density").changes(of_mode);
  keywords.key("substeps").integer(given_substeps, 1, 1, 10000);
  keywords.key("spacing").per_type(disc.given_spacing, positive).kept(kept);
  keywords.key("thin").types(disc.thin);
  keywords.key("mach").number(disc.mach, 1.0, positive).or_word("off", Check::OFF);
  keywords.parse(disc.begin(lmp, keywords, {arg + 3, arg + narg}));
  step.substeps = given_substeps;
  if (disc.article && disc.density_fluid == disc.CONTINUITY) disc.density_fluid = disc.SUMMATION;
  if (disc.article && disc.density_solid == disc.CONTINUITY) disc.density_solid = disc.RATIO;

  disc.resolve();
  choose_skin(lmp, disc.dx);

  nevery = time_integrate = force_reneighbor = create_attribute = pre_exchange_migrate = 1;
  set_fields();
  register_fields();
  const auto &last = AtomVecFSI::of(atom)->of_fixes[command];
  if (!last.record || !changes.any_mass()) return;
  goes_on(*last.record, "in the last run");
  fields.unpack_all(last.rows);
}
// clang-format on

// what the next one has to keep, if particles have masses since
FixFSI::~FixFSI()
{
  if (parts.empty()) return;
  Record now = record();
  const double *const account = ledger.energy_out;
  if (ledger.kept) now.add("ledger", std::vector<double>(account, account + Ledger::NTERM));
  hand_on(command, now);
}

Record FixFSI::record() const
{
  Record record(lmp, command);
  keywords.write(record);
  check.write(record);
  step.write(record);
  population.write(record);
  members->surface_deficit.write(record);
  return record;
}

// arrays of the effects that are on
void FixFSI::set_fields()
{
  const bool particle_walls = any_is(parts, &Facts::particle_walls);
  number_density.set_fields(fields);
  members->surface_deficit.set_array(fields);
  for (int d = 0; d < 3; d++)
    fields.set(std::string("velocity of shifting along ") + "xyz"[d], Fields::RESTART,
               d < disc.dim && facts_of_fluids(lmp).density_follows_shift, step.shift_velocity[d]);
  fields.set("walls near", Fields::STEP, step.walls.any(), step.wmask);
  fields.set("wall velocity", Fields::STEP, disc.noslip_walls, step.wall_velocity, 3);
  fields.set("unforeseen force", Fields::RESTART, facts_of_fluids(lmp).implicit_viscosity,
             step.unforeseen, 3);
  fields.set("wall stiffness", Fields::STEP, particle_walls && disc.several_stiffnesses(),
             step.wall_stiffness);

  forward.clear();
  forward.add(atom->rho, {FLUID, SOLID, RIGID});
  number_density.add_messages(forward);
  back.clear();
  for (auto *p : parts) p->add_messages(forward, back);
  comm_forward = std::max(Ghosts::MOST_COLUMNS, forward.size());
  comm_reverse = std::max(Ghosts::MOST_COLUMNS, back.size());
}

FixFSI *FixFSI::there(LAMMPS *lmp)
{
  return first_of(fixes_of<FixFSI>(lmp));
}

FixFSI *FixFSI::find(LAMMPS *lmp, const std::string &who)
{
  FixFSI *const fix = there(lmp);
  if (!fix)
    lmp->error->all(FLERR, "{} requires fix fsi, which holds particle spacing and kernel", who);
  return fix;
}

FixFSI *FixFSI::ready(LAMMPS *lmp, const std::string &who)
{
  FixFSI *const fix_fsi = find(lmp, who);
  fix_fsi->find_parts();    // commands since the last run may have changed them
  bool mine = fix_fsi->changes.of_atoms() || pairs_of<Part>(lmp).empty();
  for (const auto *p : fix_fsi->parts) mine |= !p->is_set_up();
  if (anywhere(mine, lmp->world))
    lmp->error->all(FLERR,
                    "{} needs a run before it, if only run 0, and another after atoms are made, "
                    "deleted or changed, after a pair style, and after a command that sets all up "
                    "anew, as write_restart, write_data and balance do",
                    who);
  return fix_fsi;
}

bool FixFSI::has(LAMMPS *lmp, const Discretization *known)
{
  const auto *const fix = there(lmp);
  return fix && known == &fix->disc;
}

void FixFSI::check_pre_no(LAMMPS *lmp, const Discretization *known)
{
  if (!Changes::in_first_step(lmp->update)) return;
  if (!has(lmp, known) || !there(lmp)->changes.known_setup()) refuse(lmp->error, Refused::PRE_NO);
}

int FixFSI::setmask()
{
  return INITIAL_INTEGRATE | POST_INTEGRATE | PRE_EXCHANGE | PRE_FORCE | FINAL_INTEGRATE |
      END_OF_STEP | POST_RUN;
}

void FixFSI::post_run()
{
  changes.end_run();
}

void FixFSI::init()
{
  if (fixes_of<FixFSI>(lmp).size() > 1) error->all(FLERR, "There can be only one fix fsi");
  check.before_init();
  changes.begin_run();
  disc.states_entered = false;
  clock.restore();
  find_parts();
  step.begin_run();
  disc.noslip_walls = false;
  disc.surface_ratio = 0.0;
  for (auto *p : parts) p->set_fields(disc);
  clamps.find();
  step.gather_walls(lmp);
  set_fields();
  register_fields();

  ledger.kept = any_is(computes_of<Part>(lmp), &Facts::keeps_account);
  ledger.guarding[0] = ledger.guarding[1] = 0.0;

  // pair forces and density rates need the velocities of ghosts
  comm->ghost_velocity = 1;

  find_others();
  members->frame.init();
  check.materials();
  for (int i = 0; i < atom->nlocal; i++) give_defaults(i, atom, disc);
  step.body_forces.find();
  check.init();
}

void FixFSI::setup(int)
{
  clock.forget();
  announce(lmp, disc, step, parts, ledger.kept, announced);
  check.setup();
  changes.set_up();
}

void FixFSI::find_parts()
{
  auto parts = pairs_of<Part>(lmp);
  std::sort(parts.begin(), parts.end(), [](const Part *a, const Part *b) {
    return a->facts().style < b->facts().style;
  });
  for (auto *p : fixes_of<Part>(lmp)) parts.push_back(p);
  parts.insert(parts.end(), {&members->surface_deficit, &members->clamps, &ledger});
  std::stable_sort(parts.begin(), parts.end(), [](const Part *a, const Part *b) {
    return a->rank() < b->rank();
  });
  // a step goes through them when an end asks for a compute, which asks for this
  if (members->parts != parts) members->parts = parts;
}

// A run that goes on from a restart file must be the uninterrupted run bit for bit, so sums must
// keep their order, which is that of atoms and neighbour lists. So the first step of a run, and
// the one after a restart was written, do the same: wrap positions, rebuild, and put the atoms
// of each rank in an order that depends on nothing but where they are and their IDs.
bool FixFSI::fresh_start() const
{
  const bigint before = update->ntimestep - 1;
  return before == update->firststep || (output->restart_flag && before == output->last_restart);
}

void FixFSI::pre_exchange()
{
  check.positions();
  if (!fresh_start()) return;
  domain->pbc();
  if (domain->box_change) {
    domain->reset_box();
    comm->setup();
    if (neighbor->style) neighbor->setup_bins();
  }
  comm->exchange();
  if (step.device) step.device->to_host();
  sort_by_place(atom, disc.dx);
  if (step.device) step.device->from_host();
}

// paper eq. 15: drift to the middle of the step
void FixFSI::initial_integrate(int)
{
  changes.check_pre_no();
  for (auto *p : parts) p->start_step();
  step.begin(update->dt);
  members->frame.move();
  if (fresh_start()) {
    next_reneighbor = update->ntimestep;
    domain->pbc();
  }
  drift();
}

// after fix rigid has moved its bodies
void FixFSI::post_integrate()
{
  if (clamps.any()) clamps.to_middle();
}

// paper eqs. 17 and 18: kick, and drift to the end of the step
void FixFSI::final_integrate()
{
  for (auto *p : parts) p->prescribe();
  check.before_kick();
  if (step.substeps > 1)
    for (auto *p : parts) p->integrate_substeps();
  if (clamps.any()) clamps.take_step();
  ledger.set_tally(update->dt);
  for (auto *p : parts) p->react();
  kick();
  turn();
  if (step.walls.any()) step.walls = step.walls.moved(0.5 * update->dt);    // for computes
}

// The second drift may take particles out of the box, and a restart file could not be read: a
// shrink-wrapped box goes along, and what leaves a fixed one does so with the next drift
void FixFSI::end_of_step()
{
  if (update->ntimestep != output->next_restart || domain->nonperiodic == 0) return;
  domain->reset_box();
  if (step.device) step.device->to_host();
  for (int i = 0; i < atom->nlocal; i++)
    for (int d = 0; d < 3; d++) {
      const double lo = domain->boxlo[d], hi = domain->boxhi[d];
      double &x = atom->x[i][d];
      if (!domain->periodicity[d]) x = std::clamp(x, lo, std::nextafter(hi, lo));
    }
  if (step.device) step.device->from_host();
}

// bring density and stress of local and ghost atoms to the time of the positions; not to advance,
// in setup: a function of the state only
void FixFSI::update_state(bool advance)
{
  fields.grow();
  changes.in_step();
  step.inverted = -1;
  step.pulls.clear();
  step.behind = advance ? 0.5 * update->dt : 0.0;
  ledger.set_tally(advance ? update->dt : 0.0);
  if (advance) ledger.follow_exchange();
  step.body_forces.evaluate(disc.state);
  if (ledger.kept && advance)
    ledger.energy_out[Ledger::FIELDS] += step.body_forces.work(disc.state, groupbit);
  Phase phase(step.profile);
  for (auto *p : parts) p->begin_state(advance);
  if (step.walls.any()) {
    phase.next(Profile::WALLS);
    step.gather_walls(lmp);
    find_near_walls();
  }

  phase.next(Profile::DENSITY);
  bool sums = false;
  for (auto *p : parts) sums = p->add_rates(advance) || sums;
  if (sums) ghosts.add(back);
  for (auto *p : parts) p->advance(advance);
  number_density.renew();
  if (comm->nprocs > 1) phase.next(Profile::MESSAGES);
  send_state();
  for (auto *p : parts) p->end_state(advance);
}

void FixFSI::find_near_walls()
{
  step.find_near_walls(atom, disc);
}

void FixFSI::send_state()
{
  ghosts.send(forward);
}

void FixFSI::set_arrays(int i)
{
  fields.begin(i);
  changes.made(i);
  if (!parts.empty()) give_defaults(i, atom, disc);    // not before the first run
  if (update->whichflag == 1 && !disc.state[atom->type[i]].is_body() && !is_moved(i, lmp))
    error->one(FLERR,
               "Atom {} was made during a run and is not in group {} of fix {}: no fix "
               "integrates it. Give the fix that makes it that group",
               atom->tag[i], group->names[igroup], id);
}

void FixFSI::write_restart(FILE *fp)
{
  double all[Ledger::NTERM];
  MPI_Allreduce(ledger.energy_out, all, Ledger::NTERM, MPI_DOUBLE, MPI_SUM, world);
  Record record = this->record();
  fields.write(record);
  if (ledger.kept) record.add("ledger", std::vector<double>(all, all + Ledger::NTERM));
  clock.write(record);
  record.add("atoms", std::to_string(count_of(atom->nlocal, world)));
  record.write(fp);
}

void FixFSI::goes_on(const Record &record, const std::string &when)
{
  keywords.compare(record, when);
  check.read(record);
  step.read(record);
  population.read(record);
  const bool other_kernel = keywords.differs(record, "kernel") ||
      keywords.differs(record, "smoothing length over spacing");
  if (other_kernel &&
      (disc.density_fluid == disc.SUMMATION || disc.density_solid == disc.SUMMATION))
    error->all(FLERR,
               "Fix fsi: density mode summation must keep kernel and smoothing length, for "
               "which the masses of its particles were made");
  fields.read(record, {other_kernel ? "reference of ratio" : ""});
  members->surface_deficit.read(record);
  if (!record.has("ledger")) return;
  const auto terms = record.numbers("ledger");
  std::copy_n(terms.begin(), std::min(terms.size(), (size_t) Ledger::NTERM), ledger.energy_out);
}

void FixFSI::restart(char *buf)
{
  const Record record(lmp, command, buf);
  if (record.has("atoms")) changes.in_file = std::stoll(record.value("atoms"));
  changes.check_file();
  goes_on(record, Keywords::OF_RESTART);
  if (comm->me) std::fill_n(ledger.energy_out, Ledger::NTERM, 0.0);    // they are sums of all
  clock.read(record);
}
