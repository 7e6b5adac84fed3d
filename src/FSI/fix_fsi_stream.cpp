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
#include "fix_fsi_stream.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix_fsi.h"
#include "force.h"
#include "fsi_gather.h"
#include "fsi_hub.h"
#include "fsi_keywords.h"
#include "fsi_record.h"
#include "fsi_refusals.h"
#include "group.h"
#include "math_const.h"
#include "neighbor.h"
#include "region.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace FSI;

FixFSIStream::FixFSIStream(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), keywords(lmp, "fix fsi/stream"),
    velocity(new Values(lmp, "fix fsi/stream", 3))
{
  if (!atom->style_match("fsi")) error->all(FLERR, "Fix fsi/stream requires atom_style fsi");
  if (narg < 6) utils::missing_cmd_args(FLERR, "fix fsi/stream", error);
  for (int d = 0; d < 3; d++) {
    const std::string word = arg[3 + d];
    if (word == "NULL") continue;
    if (d >= domain->dimension)
      error->all(FLERR, "Fix fsi/stream velocity along z must be NULL in 2D, not {}", word);
    velocity->read(d, word, "velocity", "NULL or v_name");
  }
  keywords.key("region").word(region_id, "");
  keywords.key("rate").number(rate, 0.0, Range::above(0.0));
  keywords.key("density").number(density_rate, 0.0, Range::from(0.0));
  keywords.key("along").choice(along, 0, {"x", "y", "z"});
  keywords.parse(narg - 6, arg + 6);
  if (region_id.empty())
    error->all(FLERR, "Fix fsi/stream requires keyword region: the zone in which it acts");
  if (rate == 0.0)
    error->all(
        FLERR,
        "Fix fsi/stream requires keyword rate: of the fluid's approach to the velocity, 1/time");
  if (!velocity->given(0) && !velocity->given(1) && !velocity->given(2) && density_rate == 0.0)
    error->all(FLERR, "Fix fsi/stream drives nothing: expected a velocity or keyword density");
  if (along >= domain->dimension)
    error->all(FLERR, "Fix fsi/stream along z: there is no flow along z in 2D");

  scalar_flag = vector_flag = 1;
  size_vector = 4;
  extscalar = extvector = 1;
  global_freq = 1;
  restart_global = 1;
}

FixFSIStream::~FixFSIStream() = default;

void FixFSIStream::init()
{
  FixFSI::find(lmp, "Fix fsi/stream")->link(disc, step, ledger);
  if (!facts_of_fluids(lmp).style)
    error->all(FLERR, "Fix fsi/stream requires pair_style fsi/fluid: it drives fluids");
  if (density_rate > 0.0 && disc->density_fluid != Discretization::CONTINUITY)
    refuse(error, Refused::STREAM_DENSITY);
  region = domain->get_region_by_id(region_id);
  if (!region) error->all(FLERR, "Region {} of fix fsi/stream does not exist", region_id);
  if (region->dynamic_check()) refuse(error, Refused::STREAM_REGION);
  const char name = "xyz"[along];
  if (!region->bboxflag)
    error->all(FLERR,
               "Region {} of fix fsi/stream must be inside of its faces: it has no ends along {}",
               region_id, name);
  const double lo[] = {region->extent_xlo, region->extent_ylo, region->extent_zlo};
  const double hi[] = {region->extent_xhi, region->extent_yhi, region->extent_zhi};
  low = lo[along];
  high = hi[along];
  // a number in a script may be that of the box but for its last digits
  const double little = 1.0e-9 * domain->prd[along];
  if (low < domain->boxlo[along] - little || high > domain->boxhi[along] + little)
    error->all(FLERR,
               "Region {} of fix fsi/stream, from {} to {} along {}, must be inside the box, from "
               "{} to {}",
               region_id, low, high, name, domain->boxlo[along], domain->boxhi[along]);

  velocity->find();
}

void FixFSIStream::setup(int vflag)
{
  last_step = -1;
  find_weights();
  const auto acts = [](const Member &m) {
    return m.weight > 0.0;
  };
  if (!anywhere(std::any_of(zone.begin(), zone.end(), acts), world))
    error->all(FLERR, "Region {} of fix fsi/stream has no fluid of group {}", region_id,
               group->names[igroup]);
  post_force(vflag);
}

// Fluid that may be in the zone before the next list
void FixFSIStream::find_zone()
{
  zone.clear();
  const double L = domain->prd[along], from = -neighbor->skin, to = high - low + neighbor->skin;
  for (int i = 0; i < atom->nlocal; i++) {
    const int species = disc->state[atom->type[i]].species;
    const bool fluid = species == FLUID && (atom->mask[i] & groupbit);
    if (!fluid && species != SOLID) continue;
    double s = atom->x[i][along] - low;
    if (domain->periodicity[along]) s -= L * std::floor((s - from) / L);
    if (s < from || s > to) continue;
    if (fluid)
      zone.push_back({i, 0.0});
    else if (in_zone(i) >= 0.0)    // it would be torn by what drives the fluid around it
      error->one(FLERR,
                 "Atom {} of a solid is in region {} of fix fsi/stream, which is for fluid alone",
                 atom->tag[i], region_id);
  }
}

// from its lower end, over its length; < 0: not in it
double FixFSIStream::in_zone(int i) const
{
  double x[3] = {atom->x[i][0], atom->x[i][1], atom->x[i][2]};
  domain->remap(x);
  return x[along] > low && x[along] < high && region->match(x[0], x[1], x[2])
      ? (x[along] - low) / (high - low)
      : -1.0;
}

// sin^2 along the axis: smooth, 0 at the ends
void FixFSIStream::find_weights()
{
  if (last_step == update->ntimestep) return;
  region->prematch();
  if (last_step < 0 || neighbor->ago == 0) find_zone();
  last_step = update->ntimestep;
  for (auto &member : zone) {
    const double s = std::sin(MathConst::MY_PI * std::max(in_zone(member.i), 0.0));
    member.weight = s * s;
  }
}

// d rho/dt = -k w (rho - mean), the mean with the same weights, of each type: the mean stays
void FixFSIStream::advance(bool advance)
{
  if (!advance) return;
  const double dt = update->dt + step->dt_offset;
  find_weights();
  if (density_rate == 0.0) return;
  const int *const type = atom->type, n = atom->ntypes + 1;
  double *const rho = atom->rho;
  std::vector<double> local(2 * n, 0.0);
  const auto part = [&](double weight) {
    return -std::expm1(-density_rate * weight * dt);
  };
  for (const auto &[i, weight] : zone) {
    if (weight == 0.0) continue;
    const double a = part(weight);
    local[2 * type[i]] += a;
    local[2 * type[i] + 1] += a * rho[i];
  }
  const auto all = over_ranks(local, MPI_SUM, world);
  for (const auto &[i, weight] : zone) {
    if (weight == 0.0) continue;
    const double mean = all[2 * type[i] + 1] / all[2 * type[i]];
    set_density(i, rho[i] + part(weight) * (mean - rho[i]), atom, *disc, *ledger, Ledger::FIELDS);
  }
}

double FixFSIStream::target(int d, int i) const
{
  const double u = (*velocity)(d, i);
  if (!std::isfinite(u))
    error->one(FLERR, "Fix fsi/stream: velocity {} along {} of atom {} is no number{}", u, "xyz"[d],
               atom -> tag[i], velocity -> see(d));
  return u;
}

// Implicit viscosity has the force m k w (u - v) with the velocity at the end of the step: how fast
// a steady flow is does not depend on the step
void FixFSIStream::end_state(bool advance)
{
  first_pull = end_of_pulls = step->pulls.size();
  foreseen = advance && step->unforeseen;
  if (!foreseen) return;
  velocity->evaluate_for(zone, 0, 3);
  for (const auto &[i, weight] : zone)
    for (int d = 0; weight > 0.0 && d < 3; d++)
      if (velocity->given(d)) step->pulls.push_back({i, d, rate * weight, target(d, i)});
  end_of_pulls = step->pulls.size();
}

void FixFSIStream::push(int i, int d, double f)
{
  atom->f[i][d] += f;
  given[d] += f;
  // in the middle of the kick
  given[3] +=
      f * (atom->v[i][d] + 0.5 * update->dt * force->ftm2v * atom->f[i][d] / atom->rmass[i]);
}

// explicit: the force that brings v to u(1 - a) + a v in this step, a = exp(-k w dt): stable for
// any rate
void FixFSIStream::post_force(int)
{
  find_weights();    // in setup
  std::fill_n(given, 4, 0.0);
  const double dt = update->dt;
  for (size_t k = first_pull; k < end_of_pulls; k++) {
    const auto &[i, d, of_rate, to, v] = step->pulls[k];
    push(i, d, atom->rmass[i] * of_rate * (to - v) / force->ftm2v);
  }
  if (!foreseen) {
    velocity->evaluate_for(zone, 0, 3);
    for (const auto &[i, weight] : zone) {
      const double part = -std::expm1(-rate * weight * dt);
      for (int d = 0; part > 0.0 && d < 3; d++)
        if (velocity->given(d))
          push(i, d, atom->rmass[i] * part * (target(d, i) - atom->v[i][d]) / (dt * force->ftm2v));
    }
  }
  ledger->tally(Ledger::FIELDS, -given[3]);
  if (update->ntimestep > update->firststep) work += dt * given[3];
}

double FixFSIStream::compute_scalar()
{
  return sum_of(work, world);
}

double FixFSIStream::compute_vector(int n)
{
  return sum_of(given[n], world);
}

void FixFSIStream::write_restart(FILE *fp)
{
  const double all = compute_scalar();
  Record record(lmp, "fix fsi/stream");
  record.add("velocity", velocity->text());
  keywords.write(record);
  record.add("work", std::vector<double>{all});
  record.write(fp);
}

void FixFSIStream::restart(char *buf)
{
  const Record record(lmp, "fix fsi/stream", buf);
  work = comm->me == 0 ? record.numbers("work")[0] : 0.0;
  keywords.compare(record);
  const std::string before = record.has("velocity") ? record.value("velocity") : velocity->text();
  if (before != velocity->text() && comm->me == 0)
    error->warning(FLERR, "Fix fsi/stream: velocity was {} {}, and is {} now", before,
                   Keywords::OF_RESTART, velocity->text());
}

double FixFSIStream::memory_usage()
{
  return (double) zone.capacity() * sizeof(Member) + velocity->memory_usage();
}
