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

#include "fsi_check.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fsi_find.h"
#include "fsi_gather.h"
#include "fsi_hub.h"
#include "fsi_kernel.h"
#include "fsi_keywords.h"
#include "fsi_limits.h"
#include "fsi_record.h"
#include "lmptype.h"
#include "math_extra.h"
#include "universe.h"
#include "update.h"
#include "write_restart.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace FSI;

static constexpr double SUSPECT = 1.6;    // over the usual Courant number: may be the cause

// as LAMMPS names the log files of partitions
static std::string of_partition(const Universe *all, const std::string &name)
{
  return all->nworlds > 1 ? fmt::format("{}.{}", name, all->iworld) : name;
}

Stop::Stop(LAMMPS *lmp, const std::string &name, const Discretization &disc, const StepState &step,
           const std::vector<Part *> &parts) :
    Pointers(lmp),
    name(name), restart_file(of_partition(universe, "fsi_stop.restart")),
    dump_file(of_partition(universe, "fsi_stop.dump")), disc(disc), step(step), parts(parts)
{
}

Finding Stop::finding(Trouble trouble, int i, double value, int j) const
{
  const double *const x = atom->x[i];
  return {value, {x[0], x[1], x[2]}, atom->tag[i], j < 0 ? 0 : atom->tag[j], atom->type[i], trouble,
          0};
}

Finding Stop::not_finite(int i, bool forces) const
{
  static constexpr double ZERO[3] = {0.0, 0.0, 0.0};
  const double *const f = forces ? atom->f[i] : ZERO, *const v = atom->v[i], *const x = atom->x[i];
  const double values[] = {f[0] + f[1] + f[2], MathExtra::lensq3(v), atom->rho[i],
                           x[0] + x[1] + x[2], atom->rmass[i]};
  for (int k = FORCE; k <= MASS; k++) {
    if (std::abs(values[k]) < HUGE_SQUARE) continue;
    Finding found = finding(FINITE, i, values[k]);
    found.field = k;
    return found;
  }
  return {};
}

Finding Stop::worst(const Finding &of_rank, double key) const
{
  return of_least(of_rank.tag ? -key : 1.0e300, of_rank, world);
}

std::string Stop::describe(const std::string &what, const Finding &all, When when) const
{
  static constexpr const char *fields[] = {"force", "velocity", "density", "position", "mass"};
  auto text = name + ": " +
      (all.trouble == FINITE ? fmt::format("{} is not finite ({})", fields[all.field], all.value)
                             : what);
  text += fmt::format(" on step {}", update->ntimestep);
  if (all.tag)
    text += fmt::format(", atom {} (type {}) at {}", all.tag, all.type, place_text(all.x));
  if (all.other) text += fmt::format(", and atom {}", all.other);
  const Neighbor body = nearest_body(all);
  if (too_near(body)) {
    const bool solid = body.species == SOLID;
    text +=
        fmt::format(", {:.2g} from atom {} of {}, whose spacing is {:g}: fluid ", body.distance,
                    body.tag, solid ? fmt::format("body {}", body.molecule) : "a wall", body.dx);
    text += std::string(body.around ? "inside" : "pressed into") + (solid ? " a solid" : " a wall");
  }
  return text + ". Try " + advice(all, when, body);
}

// On all ranks. A body is around a place if the directions to its particles near it all but cancel.
Stop::Neighbor Stop::nearest_body(const Finding &all) const
{
  Neighbor body = {1.0e300, disc.dx, 0, 0, NONE, false};
  if (!all.tag || disc.state[all.type].species != FLUID ||
      !std::isfinite(all.x[0] + all.x[1] + all.x[2]))
    return body;
  const int *const type = atom->type;
  const auto for_near = [&](auto f) {
    for (int i = 0; i < atom->nlocal; i++) {
      if (!disc.state[type[i]].is_body()) continue;
      double d[3];
      for (int k = 0; k < 3; k++) d[k] = k < disc.dim ? atom->x[i][k] - all.x[k] : 0.0;
      if (!std::isfinite(d[0] + d[1] + d[2])) continue;
      to_nearest_image(*domain, d);
      const double r = MathExtra::len3(d);
      if (r < disc.largest_cut) f(i, r, d);
    }
  };
  for_near([&](int i, double r, const double *) {
    if (r < body.distance)
      body = {
          r,    disc.dx_of(type[i]), atom->tag[i], atom->molecule[i], disc.state[type[i]].species,
          false};
  });
  body = of_least(body.distance, body, world);
  double local[4] = {}, sum[4];
  for_near([&](int i, double r, const double *d) {
    if (atom->molecule[i] != body.molecule || r == 0.0 ||
        r > 1.5 * std::max(body.dx, 0.5 * disc.dx))
      return;
    for (int k = 0; k < 3; k++) local[k] += d[k] / r;
    local[3] += 1.0;
  });
  MPI_Allreduce(local, sum, 4, MPI_DOUBLE, MPI_SUM, world);
  body.around = MathExtra::len3(sum) < 0.5 * sum[3];
  return body;
}

// nearer than half the distance of fluid at rest from its face, or within it
bool Stop::too_near(const Neighbor &body) const
{
  return body.species != NONE &&
      (body.distance < 0.25 * (disc.dx + body.dx) || (body.around && body.distance < body.dx));
}

// How to get a shorter step, and whether the Courant number of the particle is suspect
std::string Stop::shorter_step(const Finding &all, bool &suspect) const
{
  const State none, &s = all.tag ? disc.state[all.type] : none;
  const bool fluid = !all.tag || s.species == FLUID,
             waves = s.species == FLUID || s.species == SOLID,
             solid_tl = facts_of_solids(lmp).style == Facts::OF_TOTAL_LAGRANGIAN_SOLIDS;
  const double usual = fluid ? Limits::FLUID_FACTOR * Limits::safe[Limits::SOUND]
                             : Limits::SOLID_FACTOR * Limits::safe[Limits::ELASTIC];
  const double number = !waves ? 0.0
                               : update->dt * std::sqrt(s.wave_speed_sq()) /
          (s.species == SOLID ? step.substeps : 1) / disc.h_of(all.type);
  suspect = number > SUSPECT * usual;
  std::string tip;
  if (suspect)
    tip = fmt::format("a shorter time step (the Courant number is {:.2g}, {:g} is usual): ", number,
                      usual);
  if (!any_is(parts, &Facts::chooses_step))
    return tip + "fix fsi/dt" + (solid_tl ? " with substeps auto" : "");
  if (!fluid && solid_tl && !any_is(parts, &Facts::chooses_substeps))
    return tip + "substeps auto of fix fsi/dt";
  return tip + fmt::format("a smaller cfl/{} of fix fsi/dt", fluid ? "fluid" : "solid");
}

// What to try: against what, for whom (NONE: all), at the start of a run only?, the keyword of an
// effect that must be off, or with + on, for it to help, or null.
static constexpr bool START_ONLY = true, ANY_TIME = false;
static constexpr struct Tip {
  Trouble trouble;
  Species of;
  bool start_only;
  const char *effect, *text;
} TIPS[] = {
    // clang-format off
    {FINITE, NONE, START_ONLY, nullptr, "run 0 before velocity create, which needs masses"},
    {FINITE, NONE, ANY_TIME, nullptr, "a look at what pushes this particle"},
    {FINITE, SOLID, ANY_TIME, "hourglass", "hourglass"},
    {MACH, NONE, START_ONLY, nullptr,
     "velocity ... units box (its default are lattice units per time)"},
    {MACH, FLUID, ANY_TIME, nullptr,
     "a higher speed of sound, if the flow is meant to be that fast"},
    {MACH, FLUID, ANY_TIME, "artificial/visc", "artificial/visc 0.02 0"},
    {MACH, SOLID, ANY_TIME, "artificial/visc", "artificial/visc 0.1 0"},
    {MACH, SOLID, ANY_TIME, "hourglass", "hourglass"},
    {DISTANCE, NONE, START_ONLY, nullptr, "a look for overlapping particles"},
    {DISTANCE, NONE, ANY_TIME, "wendland", "kernel wendland"},
    {DISTANCE, NONE, ANY_TIME, "artificial/visc", "artificial/visc 0.02 0"},
    {DISTANCE, NONE, ANY_TIME, "shift", "shift"},
    {DISTANCE, NONE, ANY_TIME, "background",
     "a background pressure, if there is no free surface"},
    {DENSITY, FLUID, ANY_TIME, nullptr, "a higher speed of sound"},
    {DENSITY, NONE, ANY_TIME, "density/diffusion", "density/diffusion 0.1"},
    {DENSITY, SOLID, ANY_TIME, "hourglass", "hourglass"},
    {DENSITY, SOLID, ANY_TIME, "+law svk",
     "law neohookean, which stays stiff when it is compressed"},
    {DENSITY, FLUID, ANY_TIME, "+tension", "tension no, if there is a free surface"},
    {ENERGY, NONE, ANY_TIME, nullptr, "a look at this, the fastest particle"},
    {ENERGY, FLUID, ANY_TIME, "artificial/visc", "artificial/visc 0.02 0"},
    {ENERGY, SOLID, ANY_TIME, "artificial/visc", "artificial/visc 0.1 0"},
    {LOST, NONE, ANY_TIME, nullptr,
     "walls where particles escape, or a larger box; if they are meant to leave, thermo_modify "
     "lost ignore"}};
// clang-format on

// of the pair style of fluids or solids; and of the kernel
std::vector<Part::Effect> Stop::effects(bool of_fluid) const
{
  std::vector<Part::Effect> effects = {{"", "wendland", disc.kernel == WENDLAND}};
  for (const auto *p : pairs_of<Part>(lmp)) {
    const auto style = p->facts().style;
    if (!style || style == Facts::OF_GRAINS || (style == Facts::OF_FLUIDS) != of_fluid) continue;
    for (const auto &e : p->effects()) effects.push_back(e);
  }
  return effects;
}

// where fluid is in a body
static const char *keep_out(bool starts, bool solid)
{
  if (starts) return "fsi/displace, where the fluid is put around bodies";
  if (solid)
    return "a thicker or finer body, or solid/guard 0.75 of pair_style fsi/fluid, which keeps "
           "fluid out";
  return "a thicker wall, or guard 0.9 of fix fsi/wall/particle, which keeps fluid out";
}

std::string Stop::advice(const Finding &all, When when, const Neighbor &body) const
{
  const bool fluid = !all.tag || disc.state[all.type].species == FLUID, starts = when == START;
  const auto known = effects(fluid);
  // is there such an effect, on or off as this says?
  const auto met = [&](const char *effect) {
    if (!effect) return true;
    const bool on = *effect == '+';
    return std::any_of(known.begin(), known.end(), [&](const Part::Effect &e) {
      return e.keyword == effect + on && e.on == on;
    });
  };
  std::vector<std::string> tips;
  if (too_near(body)) tips.emplace_back(keep_out(starts, body.species == SOLID));
  for (const Tip &tip : TIPS)
    if (tip.trouble == all.trouble && (tip.of == NONE || (tip.of == FLUID) == fluid) &&
        (starts || update->ntimestep == 0 || !tip.start_only) && met(tip.effect))
      tips.emplace_back(tip.text);
  if (all.trouble != LOST && when != BEFORE && !(starts && all.trouble == DISTANCE)) {
    bool suspect;
    const auto tip = shorter_step(all, suspect);
    tips.insert(suspect ? tips.begin() : tips.end(), tip);
  }
  std::string text;
  for (const auto &tip : tips) text += (text.empty() ? "" : "; ") + tip;
  return text.empty() ? "a look at the particles around it" : text;
}

void Stop::stop(std::string text, const Finding &all, When when)
{
  if (when == DRIFTED || when == MIDDLE) go_back(when == MIDDLE);
  if (when != BEFORE && all.tag) {
    write_neighbors(all);
    text += fmt::format(". Particles around it: {}", dump_file);
  }
  if (when != BEFORE) text += write_state();
  error->all(FLERR, text);
}

// In the middle of a step positions, walls and densities go back to its start: a state from
// which the step can be repeated. (The stress of fsi/solid stays where it is, a step too far: an
// error of one step's strain.)
void Stop::go_back(bool advanced)
{
  const double back = -0.5 * update->dt;
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->mask[i] & disc.mover->groupbit)
      for (int d = 0; d < disc.dim; d++) atom->x[i][d] += back * atom->v[i][d];
  for (auto *p : parts) {
    if (advanced) p->undo_advance();
    p->go_back();
  }
  if (step.device) step.device->from_host();
  update->ntimestep--;
}

// restart file, and what to say of it
std::string Stop::write_state()
{
  bool lost = false;
  for (int i = 0; i < atom->nlocal; i++) lost |= not_finite(i, false).tag != 0;
  if (anywhere(lost, world)) return ". No restart file: the state is not finite any more";

  // an error of write_restart would hide what this is about
  int writable = 0;
  if (comm->me == 0) {
    FILE *fp = fopen(restart_file.c_str(), "wb");
    writable = fp != nullptr;
    if (fp) fclose(fp);
  }
  MPI_Bcast(&writable, 1, MPI_INT, 0, world);
  if (!writable)
    return fmt::format(". Restart file {} cannot be written: {}", restart_file,
                       utils::getsyserror());
  atom->natoms = count_of(atom->nlocal, world);
  domain->pbc();
  domain->reset_box();
  if (step.device) step.device->to_host();
  // what has left a fixed box since the last reneighboring would be missing when the file is read
  double outward[6], ends[6];
  for (int d = 0; d < 3; d++) {
    outward[d] = -domain->boxlo[d];
    outward[3 + d] = domain->boxhi[d];
    for (int i = 0; i < atom->nlocal && !domain->periodicity[d]; i++) {
      if (atom->x[i][d] < domain->boxlo[d])
        outward[d] = std::max(outward[d], disc.dx - atom->x[i][d]);
      if (atom->x[i][d] >= domain->boxhi[d])
        outward[3 + d] = std::max(outward[3 + d], disc.dx + atom->x[i][d]);
    }
  }
  MPI_Allreduce(outward, ends, 6, MPI_DOUBLE, MPI_MAX, world);
  for (int d = 0; d < 3; d++) {
    domain->boxlo[d] = -ends[d];
    domain->boxhi[d] = ends[3 + d];
  }
  WriteRestart write(lmp);
  write.multiproc_options(0, 0, nullptr);
  write.write(restart_file);
  return fmt::format(". State of step {}: {}", update->ntimestep, restart_file);
}

// text dump of all particles within three cutoffs
void Stop::write_neighbors(const Finding &all) const
{
  struct Row {
    tagint tag, molecule;
    int type;
    double numbers[10];
  };
  const double reach = 3.0 * disc.largest_cut;
  std::vector<Row> local;
  for (int i = 0; i < atom->nlocal; i++) {
    const double *const x = atom->x[i], *const v = atom->v[i], *const f = atom->f[i];
    double d[3] = {x[0] - all.x[0], x[1] - all.x[1], x[2] - all.x[2]};
    const bool itself = atom->tag[i] == all.tag;    // wherever it is
    if (!itself) {
      if (!std::isfinite(d[0] + d[1] + d[2])) continue;
      to_nearest_image(*domain, d);
      if (MathExtra::lensq3(d) > reach * reach) continue;
    }
    local.push_back({atom->tag[i],
                     atom->molecule[i],
                     atom->type[i],
                     {x[0], x[1], x[2], v[0], v[1], v[2], f[0], f[1], f[2], atom->rho[i]}});
  }
  const auto rows = gather(local, world);
  if (comm->me) return;

  FILE *fp = fopen(dump_file.c_str(), "w");
  if (!fp) {
    error->warning(FLERR, "{} cannot write file {}: {}", name, dump_file, utils::getsyserror());
    return;
  }
  char bounds[9];
  domain->boundary_string(bounds);
  utils::print(fp, "ITEM: TIME\n{:.16g}\n", Clock::now(update));
  utils::print(fp, "ITEM: TIMESTEP\n{}\nITEM: NUMBER OF ATOMS\n{}\nITEM: BOX BOUNDS {}\n",
               update->ntimestep, rows.size(), bounds);
  for (int d = 0; d < 3; d++)
    utils::print(fp, "{:.16g} {:.16g}\n", domain->boxlo[d], domain->boxhi[d]);
  utils::print(fp, "ITEM: ATOMS id type mol x y z vx vy vz fx fy fz rho\n");
  for (const Row &row : rows) {
    utils::print(fp, "{} {} {}", row.tag, row.type, row.molecule);
    for (const double number : row.numbers) utils::print(fp, " {:.16g}", number);
    utils::print(fp, "\n");
  }
  fclose(fp);
}
