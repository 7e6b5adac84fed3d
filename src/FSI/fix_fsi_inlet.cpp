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
#include "fix_fsi_inlet.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix_fsi.h"
#include "fsi_find.h"
#include "fsi_gather.h"
#include "fsi_hub.h"
#include "fsi_number_density.h"
#include "fsi_open_end.h"
#include "fsi_pair_laws.h"
#include "fsi_record.h"
#include "fsi_refusals.h"
#include "neighbor.h"
#include "pair_fsi_fluid.h"
#include "update.h"

using namespace LAMMPS_NS;
using namespace FSI;

static constexpr double AUTO = OpenEnd::AUTO;
static constexpr int PRESSURE = OpenEnd::PRESSURE;

struct FixFSIInlet::Members {
  OpenEnd end;
  PlaneFit fit;
  Buffer buffer;
  Absorber absorber;
  Fullness fullness;
  Members(LAMMPS *lmp, const Fix *fix) :
      end(lmp, fix), fit(lmp, end), buffer(lmp, end), absorber(lmp, end), fullness(lmp, end)
  {
  }
};

FixFSIInlet::FixFSIInlet(LAMMPS *lmp, int narg, char **arg) :
    FixFields(lmp, narg, arg, std::string("fix ") + arg[2]), members(new Members(lmp, this)),
    end(members->end)
{
  if (narg < 5) utils::missing_cmd_args(FLERR, end.command, error);
  const std::string face = arg[3];
  if (face.size() != 3 || face[0] < 'x' || face[0] > 'z' ||
      (face.substr(1) != "lo" && face.substr(1) != "hi"))
    error->all(FLERR, "Unknown {} face {}: expected xlo, xhi, ylo, yhi, zlo or zhi", end.command,
               face);
  end.axis = face[0] - 'x';
  end.side = face[1] == 'l' ? 1.0 : -1.0;
  if (end.axis >= domain->dimension)
    error->all(FLERR, "{} {} is not possible for dimension 2", end.label, face);
  end.position = numeric(lmp, end.label + " " + face, arg[4]);

  std::string velocity[3], pressure;
  keywords.key("velocity").word(velocity[0], "").word(velocity[1], "").word(velocity[2], "");
  keywords.key("pressure").word(pressure, "");
  keywords.key("absorb")
      .number(members->absorber.absorb, end.outlet ? AUTO : 0.0, Range::from(0.0))
      .or_word("auto", AUTO);
  keywords.key("buffer").number(given_length, AUTO, Range::above(0.0)).or_word("auto", AUTO);
  keywords.key("region").word(end.region_id, "");
  keywords.parse(narg - 5, arg + 5);
  read_given(velocity, pressure, arg[3]);

  force_reneighbor = 1;
  next_reneighbor = -1;    // whenever lists are built
  scalar_flag = vector_flag = 1;
  size_vector = 11;
  extscalar = 1;
  extvector = 0;
  global_freq = 1;
  members->buffer.set_fields(fields);
  register_fields();
  name = fmt::format("{} {} {} {} {}", style, id, face, end.position, given_length);
  if (const auto record = take_over(name)) goes_on(*record);
}

// another one of this ID at this place goes on with it
FixFSIInlet::~FixFSIInlet()
{
  if (filled) hand_on(name, record());
}

void FixFSIInlet::read_given(const std::string *velocity, const std::string &pressure,
                             const char *face)
{
  const std::string &label = end.label;
  if (!velocity[0].empty() && !pressure.empty())
    error->all(FLERR,
               "{} {} takes velocity or pressure, not both: the other one is that of the fluid",
               label, face);
  if (velocity[0].empty() && pressure.empty() && !end.outlet)
    error->all(FLERR, "{} {} requires keyword velocity or pressure", label, face);
  if (pressure == "free" && members->absorber.absorb > 0.0)
    error->all(FLERR, "{} absorb is not for pressure free, which has no value to go back to",
               label);
  if (velocity[0].empty()) {
    end.background = pressure.empty();
    if (!end.background && pressure != "free")
      end.given.read(PRESSURE, pressure, "pressure", "v_name or free");
    return;
  }
  for (int d = 0; d < 3; d++) {
    end.given.read(d, velocity[d], "velocity");
    if (d >= domain->dimension &&
        (end.given.source(d) != Values::NUMBER || end.given.number(d) != 0.0))
      error->all(FLERR, "{} velocity along z must be 0 in 2D, not {}", label, velocity[d]);
  }
}

void FixFSIInlet::init()
{
  auto *const fix_fsi =
      FixFSI::find(lmp, end.label)->link(disc, step, ledger, ghosts, number_density);
  if (!facts_of_fluids(lmp).style)
    error->all(FLERR, "{} requires pair_style fsi/fluid: it is for fluids", end.label);
  if (disc->density_fluid != Discretization::CONTINUITY)
    refuse(error, Refused::END_DENSITY, end.label);
  if (!neighbor->dist_check) refuse(error, Refused::END_LISTS, end.label);
  end.init(disc, given_length);
  check_made();
  driven = false;
  for (const auto *other : fixes_of<FixFSIInlet>(lmp))
    driven = driven || !other->end.has_own_velocity();
  warned_of_far = members->fullness.warned = false;
  const Values &given = end.given;
  if (given.source(PRESSURE) == Values::NUMBER && end.is_far(given.number(PRESSURE))) {
    const State &soft = end.softest();
    const double away = std::fabs(given.number(PRESSURE) - soft.p0);
    error->all(FLERR,
               "{}: pressure {:g} is {:.3g} rho c^2 from the background, {:g}: expected {:g} at "
               "most. Is it in units {}? Else take sound {:.3g} or more in pair_style fsi/fluid",
               end.name, given.number(PRESSURE), away / (soft.rho0 * soft.csq), soft.p0,
               OpenEnd::FAR, update->unit_style, std::sqrt(away / (OpenEnd::FAR * soft.rho0)));
  }
  members->buffer.init(*ledger, fix_fsi->population);
}

// the buffer is full: plane and length are those of before
void FixFSIInlet::check_made() const
{
  if (made.empty() ||
      (std::fabs(end.position - made[0]) <= 1.0e-6 * disc->dx &&
       std::fabs(end.length - made[1]) <= 1.0e-6 * disc->dx))
    return;
  error->all(FLERR,
             "{}: {} has its plane at {:.10g} with a buffer of {:g}, here it is {:.10g} with {:g}: "
             "expected the same, since the buffer is full. Give keyword buffer if the skin has "
             "changed",
             end.name, of_file ? "the restart file" : "the last run", made[0], made[1],
             end.position, end.length);
}

bool FixFSIInlet::holds(const double *x) const
{
  return end.holds(x);
}

void FixFSIInlet::setup_pre_exchange()
{
  for (const auto &w : step->walls.wall) {
    const double s = end.side * (w.position - end.position);
    if (w.axis == end.axis && !w.finite && s < 0.5 * disc->dx && s > -end.length)
      error->all(FLERR, "{}: the mirror wall {} at {} closes it", end.name, w.face(), w.position);
    const auto [from, to] = std::minmax({end.position, end.end()});
    if (end.has_own_velocity() && w.axis != end.axis && w.velocity[w.axis] != 0.0 &&
        w.lo[end.axis] < to && w.hi[end.axis] > from && comm->me == 0)
      error->warning(FLERR,
                     "{}: the mirror wall {} moves beside its buffer, which has no velocity along "
                     "{}, and pressures go wrong: let a part of it move that ends before the plane "
                     "(range)",
                     end.name, w.face(), "xyz"[w.axis]);
  }
  const bool was_filled = filled;
  filled = true;
  made = {end.position, end.length};
  of_file = false;
  if (was_filled) return;
  members->buffer.populate();
  members->absorber.find_area();
}

void FixFSIInlet::pre_exchange()
{
  std::vector<const OpenEnd *> ends;
  for (const auto *fix : fixes_of<FixFSIInlet>(lmp)) ends.push_back(&fix->end);
  members->buffer.exchange(ends);
}

void FixFSIInlet::start_step()
{
  members->buffer.start_step();
}

// The density of the buffer is that of its pressure: the fluid's at the plane with the weight of
// what lies between, or as given.
void FixFSIInlet::advance(bool advance)
{
  auto &[open, fit, buffer, absorber, fullness] = *members;
  if (neighbor->ago == 0) {
    end.find_places();
    fit.share();
  }
  if (!advance) return;
  const double dt = update->dt + step->dt_offset;
  const bool wants_velocity = end.has_own_velocity(), wants_pressure = end.has_own_pressure();
  const bool varies = !end.given.name(PRESSURE).empty();
  if (varies) end.given.evaluate_for(end.places, PRESSURE, 1);
  const auto &g = step->body_forces.of_type;
  end.measure(g, varies && !warned_of_far);
  fit.measure();
  fullness.keep(*ledger, dt);    // knows the flow of now, after a restart, too
  absorber.advance(dt, driven);
  check_far();
  buffer.check_supply();

  const double speed = end.side * end.average(OpenEnd::SPEED),
               inner = end.side * end.average(OpenEnd::INNER_SPEED, OpenEnd::INNER_WEIGHT);
  for (auto &place : end.places) {
    const int i = place.i, type = atom->type[i];
    hold_shift(i, place.inside);
    if (place.inside > 0.0) continue;
    const State &state = disc->state[type];
    double values[2] = {0.0, 0.0};
    place.known = fit.at(atom->x[i], values);
    place.normal = values[0];
    if (!wants_pressure) {
      place.normal += place.known ? speed - inner : speed;
      place.known = end.sum[OpenEnd::WEIGHT] > 0.0;
    }
    double p;
    if (wants_pressure)
      p = place.known
          ? values[wants_velocity] + state.rho0 * g[type][end.axis] * end.side * place.inside
          : state.p0;
    else
      p = (end.background ? state.p0 : end.value(PRESSURE, i)) + absorber.gradient * place.inside +
          state.rho0 * state.c * absorber.wave + absorber.added;
    set_density(i, state.density(std::max(p, state.floor)), atom, *disc, *ledger, Ledger::FIELDS);
    // by that density: rates at the buffer's end depend on lists
    buffer.follow(i, place.inside, fullness.column);
  }
  if (step->unforeseen) buffer.add_pulls(absorber.wave, step->pulls);
}

void FixFSIInlet::check_far()
{
  if (end.sum[OpenEnd::TOO_FAR] == 0.0 || warned_of_far) return;
  warned_of_far = true;
  if (comm->me == 0)
    error->warning(FLERR,
                   "{}: pressure of variable {} is more than {} rho c^2 from the background: the "
                   "fluid is no longer hardly compressed. Is it in units {}? Else take a higher "
                   "sound in pair_style fsi/fluid",
                   end.name, end.given.name(PRESSURE), OpenEnd::FAR, update->unit_style);
}

// Shifting carries no particle through the plane: the buffer, which moves as is given, could not
// give back what comes. Along the axis it fades over the kernel's support before the plane; what is
// left there is less than the distance from it.
void FixFSIInlet::hold_shift(int i, double inside)
{
  double *const *const velocity = step->shift_velocity;
  const bool has_velocity = velocity[0];
  const int dim = disc->dim;
  if (inside <= 0.0) {
    if (step->shifts) std::fill_n(step->shift[i], 2 * dim, 0.0);
    for (int d = 0; has_velocity && d < dim; d++) velocity[d][i] = 0.0;
  } else if (step->shifts && inside < disc->cut) {
    const double part = inside / disc->cut;
    dim == 2 ? Shift<2>::reduce(step->shift[i], has_velocity, end.axis, part)
             : Shift<3>::reduce(step->shift[i], has_velocity, end.axis, part);
    if (has_velocity) velocity[end.axis][i] *= part;
  }
}

// sums go over all fluid: the first end makes them for all ends
void FixFSIInlet::end_state(bool advance)
{
  const auto ends = fixes_of<FixFSIInlet>(lmp);
  if (ends[0] != this || (advance && update->ntimestep % Fullness::LOOK_EVERY)) return;
  std::vector<Members *> looking, meeting;
  for (const auto *fix : ends) {
    Members *const end_members = fix->members.get();
    if (advance || end_members->fullness.now == 0.0) looking.push_back(end_members);
    if (advance && end_members->absorber.meets_pressure()) meeting.push_back(end_members);
  }
  std::vector<double> sums(looking.empty() ? 0 : atom->nmax);
  if (!looking.empty()) number_density->find(sums.data());
  for (auto *end_members : looking) end_members->fullness.look(sums.data());
  if (meeting.empty()) return;
  std::fill(sums.begin(), sums.end(), 0.0);
  first_of(pairs_of<PairFSIFluid>(lmp))->add_position_divergence(sums.data());
  ghosts->add(sums.data());
  const double time = Fullness::LOOK_EVERY * (update->dt + step->dt_offset);
  for (auto *end_members : meeting) end_members->absorber.meet_pressure(sums.data(), time);
}

void FixFSIInlet::prescribe()
{
  members->buffer.prescribe(members->absorber.wave);
  if (update->dt != 0.0) ledger->tally(Ledger::FIELDS, -members->buffer.push[3]);
}

double FixFSIInlet::compute_scalar()
{
  return members->buffer.mass_in;
}

double FixFSIInlet::compute_vector(int n)
{
  const Buffer &buffer = members->buffer;
  const double of_all[] = {buffer.passed_in, buffer.passed_out, end.sum[OpenEnd::MASS_FLOW],
                           end.sum[OpenEnd::VOLUME_FLOW], end.average(OpenEnd::MEAN_PRESSURE)};
  if (n >= 1 && n <= 5) return of_all[n - 1];
  if (n == 10) return members->fullness.mean;
  return sum_of(n == 0 ? buffer.count() : buffer.push[n - 6], world);
}

Record FixFSIInlet::record() const
{
  const auto &[open, fit, buffer, absorber, fullness] = *members;
  using Numbers = std::vector<double>;
  Record record(lmp, style);
  record.add("filled", Numbers{double(filled), buffer.served});
  record.add("buffer", Numbers{end.position, end.length});
  record.add("absorption", Numbers{absorber.wave, absorber.before, double(absorber.has_before)});
  record.add("gradient", Numbers{absorber.gradient, absorber.added, absorber.area});
  record.add("fill", Numbers{fullness.now, fullness.mean, fullness.column});
  record.add("passed", Numbers{buffer.passed_in, buffer.passed_out, buffer.mass_in});
  record.add("mean", Numbers(end.sum, end.sum + OpenEnd::NSUM));
  return record;
}

void FixFSIInlet::write_restart(FILE *fp)
{
  Record record = this->record();
  fields.write(record);
  record.write(fp);
}

void FixFSIInlet::restart(char *buf)
{
  const Record record(lmp, style, buf);
  goes_on(record);
  of_file = true;
  fields.read(record);
}

void FixFSIInlet::goes_on(const Record &record)
{
  auto &[open, fit, buffer, absorber, fullness] = *members;
  // a file of another version may lack some
  const auto take = [&](const char *key, const std::vector<double *> &to) {
    const auto numbers = record.has(key) ? record.numbers(key) : std::vector<double>();
    for (size_t k = 0; k < std::min(numbers.size(), to.size()); k++) *to[k] = numbers[k];
  };
  double was_filled = 0.0, has_before = 0.0;
  take("filled", {&was_filled, &buffer.served});
  if (record.has("buffer")) made = record.numbers("buffer");
  take("absorption", {&absorber.wave, &absorber.before, &has_before});
  take("gradient", {&absorber.gradient, &absorber.added, &absorber.area});
  take("fill", {&fullness.now, &fullness.mean, &fullness.column});
  take("passed", {&buffer.passed_in, &buffer.passed_out, &buffer.mass_in});
  std::vector<double *> sums;
  for (double &s : end.sum) sums.push_back(&s);
  take("mean", sums);
  filled = was_filled != 0.0;
  absorber.has_before = has_before != 0.0;
}

double FixFSIInlet::memory_usage()
{
  return FixFields::memory_usage() + end.given.memory_usage() + members->fit.memory_usage() +
      (double) end.places.capacity() * sizeof(OpenEnd::Place);
}
