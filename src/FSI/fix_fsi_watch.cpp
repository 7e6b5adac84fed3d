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

#include "fix_fsi_watch.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix_fsi.h"
#include "fix_fsi_wall_mirror.h"
#include "force.h"
#include "fsi_keywords.h"
#include "fsi_pack.h"
#include "modify.h"
#include "neigh_list.h"
#include "neighbor.h"
#include "pair_fsi_fluid.h"
#include "pair_fsi_solid.h"
#include "pair_fsi_solid_tl.h"
#include "update.h"
#include "write_restart.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace FSI;

static constexpr double BIG = 1.0e20;
static constexpr double HUGE_SQUARE = 1.0e200;    // of a speed: nothing finite gets there

struct About {
  const char *key, *what, *hint;
};
static constexpr About about[] = {
    {"", "force, velocity or density", "a shorter time step (fix fsi/dt), or look at what pushes this particle"},
    {"mach", "Mach number", "a shorter time step (fix fsi/dt); if the flow is that fast, a higher speed of sound"},
    {"distance", "distance over particle spacing", "kernel wendland, artificial viscosity, background pressure; look for overlapping particles at the start"},
    {"density", "density error |rho/rho0-1|", "a shorter time step, a higher speed of sound, density/diffusion; tension no at free surfaces"},
    {"courant", "Courant number", "a shorter time step (fix fsi/dt; timestep 0.25 h/(c+v)), more sub-steps for stiff solids"},
    {"energy", "growth of the kinetic energy", "a shorter time step (fix fsi/dt), artificial viscosity; look at this, the fastest particle"},
    {"lost", "number of lost particles", "walls where particles escape, or a larger box; lost off if they are meant to"},
    {"reflected", "number of reflections at mirror walls", "a larger distance from the wall at the start, artificial viscosity, a shorter time step"}};

/* ----------------------------------------------------------------------
   Is everything small, so that none of n particles can be one to look at? In a form that compilers turn into vector instructions;
   without them it is no shorter than to look.
------------------------------------------------------------------------- */

FSI_AVX2 static bool all_small(int n, const double *v, const double *f, const double *rho, double speed, double force)
{
  int64_t not_small = 0;
  const int64_t yes = 0, no = -1;    // as wide as a number
  for (int k = 0; k < 3 * n; k++) {
    not_small |= std::abs(v[k]) <= speed ? yes : no;
    not_small |= std::abs(f[k]) <= force ? yes : no;
  }
  for (int k = 0; k < n; k++) {
    not_small |= rho[k] > 0.0 ? yes : no;
    not_small |= rho[k] < BIG ? yes : no;
  }
  return !not_small;
}

/* ---------------------------------------------------------------------- */

FixFSIWatch::FixFSIWatch(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), nearest(BIG), hub(nullptr), energy_before(-1.0), reflected_before(-1.0), warned(0), violations(0)
{
  if (!atom->style_match("fsi")) error->all(FLERR, "Fix fsi/watch requires atom_style fsi");
  nevery = 1;
  Keywords keywords(lmp, "fix fsi/watch");
  keywords.argument("interval").integer(interval, 1, 1);
  limit[FINITE] = BIG;
  const auto row = [&](Quantity q, double start, const Range &range) {
    keywords.key(about[q].key).number(limit[q], start, range).or_word("off", q == DISTANCE ? 0.0 : BIG);
  };
  row(MACH, 0.5, Range::above(0.0));
  row(DISTANCE, 0.1, Range::inside(0.0, 1.0));
  row(DENSITY, 0.3, Range::above(0.0));
  row(COURANT, 0.45, Range::above(0.0));
  row(ENERGY, 10.0, Range::above(1.0));
  row(LOST, 0.0, Range::from(0.0));
  row(REFLECTED, BIG, Range::from(0.0));
  keywords.key("action").choice(warn, 0, {"stop", "warn"});
  keywords.key("restart").word(restart_file, "fsi_watch.restart").or_word("off");
  keywords.key("dump").word(dump_file, "fsi_watch.dump").or_word("off");
  keywords.parse(narg - 3, arg + 3);
  if (restart_file.find_first_of("*%") != std::string::npos)
    error->all(FLERR, "Fix fsi/watch restart {} must be the name of one file, without * and %", restart_file);

  clear();
  for (double &s : seen) s = 0.0;
  scalar_flag = vector_flag = 1;
  size_vector = NQUANTITY - 1;
  extscalar = extvector = 0;
  global_freq = 1;
  dynamic_group_allow = 1;
}

/* ---------------------------------------------------------------------- */

int FixFSIWatch::setmask()
{
  return POST_FORCE | END_OF_STEP;
}

/* ----------------------------------------------------------------------
   LAMMPS stops at non-finite positions, too, but does not say whose: look before it does
------------------------------------------------------------------------- */

void FixFSIWatch::init()
{
  hub = FixFSI::find(lmp, "Fix fsi/watch");
  for (auto &fix : modify->get_fix_by_style("^fsi/watch$"))
    if (fix != this && static_cast<FixFSIWatch *>(fix)->restart_file == restart_file && !restart_file.empty())
      error->all(FLERR, "Two fixes fsi/watch ({} and {}) would write the same file {}", id, fix->id, restart_file);

  clear();
  const int *const mask = atom->mask;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(mask[i] & groupbit)) continue;
    const double *const x = atom->x[i], *const v = atom->v[i];
    const double sum = x[0] + x[1] + x[2] + v[0] + v[1] + v[2] + atom->rho[i] + atom->rmass[i];
    if (!std::isfinite(sum)) enter(FINITE, i, sum);
  }
  judge(START);
}

/* ---------------------------------------------------------------------- */

void FixFSIWatch::setup(int)
{
  speed_sq.resize(atom->ntypes + 1);
  for (int t = 1; t <= atom->ntypes; t++) speed_sq[t] = speed_sq_of(t);
  energy_before = reflected_before = -1.0;
  clear();
  check_speed(0.0);
  check_rest();
  judge(START);
}

/* ----------------------------------------------------------------------
   a warning is given once: then the loops need not look for what is known
------------------------------------------------------------------------- */

double FixFSIWatch::speed_sq_of(int type) const
{
  const State &s = hub->state[type];
  if (s.species == NONE || s.species == RIGID || limit[MACH] == BIG || (warned & 1 << MACH)) return HUGE_SQUARE;
  return limit[MACH] * limit[MACH] * s.wave_speed_sq();
}

/* ----------------------------------------------------------------------
   Before the kick: positions of local and ghost atoms are those of the middle of the step, velocities those of its start, and
   both can be brought back. So this is where a run is stopped with a state that can be written. At every step the velocities
   that the kick would give are checked, all else at every Nth.
------------------------------------------------------------------------- */

void FixFSIWatch::post_force(int)
{
  clear();
  check_speed(update->dt * force->ftm2v);
  if (update->ntimestep % interval == 0) check_rest();
  judge(MIDDLE);
  if (hub->substeps == 1) return;
  // the sub-steps of a solid may take it anywhere: keep a state to go back to
  const int n = atom->nlocal;
  kept.resize(6 * n);
  for (int i = 0; i < n; i++)
    for (int d = 0; d < 3; d++) {
      kept[6 * i + d] = atom->x[i][d];
      kept[6 * i + 3 + d] = atom->v[i][d];
    }
  kept_walls.clear();
  for (auto *fix : hub->wall_fixes)
    for (const auto &w : fix->walls) kept_walls.push_back(w.position);
}

/* ----------------------------------------------------------------------
   sub-steps of solids are taken after post_force: what happens in them shows only now
------------------------------------------------------------------------- */

void FixFSIWatch::end_of_step()
{
  if (hub->substeps == 1) return;
  clear();
  double **v = atom->v;
  for (const int i : hub->solid_tl->solids()) {
    if (!(atom->mask[i] & groupbit)) continue;
    const double vsq = v[i][0] * v[i][0] + v[i][1] * v[i][1] + v[i][2] * v[i][2];
    if (vsq <= speed_sq[atom->type[i]]) continue;
    if (vsq < HUGE_SQUARE) enter(MACH, i, std::sqrt(vsq / hub->state[atom->type[i]].wave_speed_sq()));
    else enter(FINITE, i, vsq);
  }
  judge(END);
}

/* ---------------------------------------------------------------------- */

void FixFSIWatch::clear()
{
  for (Finding &w : worst) w = {};
  worst[DISTANCE].value = BIG;
  for (double &t : total) t = 0.0;
}

/* ---------------------------------------------------------------------- */

void FixFSIWatch::enter(Quantity q, int i, double value, int j)
{
  Finding &w = worst[q];
  if (w.tag && (q == FINITE || (q == DISTANCE ? value >= w.value : value <= w.value))) return;
  w.value = value;
  w.other = j < 0 ? 0 : atom->tag[j];
  w.tag = atom->tag[i];
  w.type = atom->type[i];
  for (int d = 0; d < 3; d++) w.x[d] = atom->x[i][d];
}

/* ----------------------------------------------------------------------
   one pass over forces, velocities and densities; a comparison that NaN fails finds whatever is not finite.
   |v + k f| is below a limit if no component of v is above 0.9, and none of k f above 0.1, of it over the root of 3: most particles
   most of the time.
------------------------------------------------------------------------- */

void FixFSIWatch::check_speed(double kick)
{
  static const bool tell = have_packs();
  constexpr int BLOCK = 256;
  const int nlocal = atom->nlocal;
  if (nlocal == 0) return;
  const double *v = atom->v[0], *f = atom->f[0];
  const double *const rmass = atom->rmass, *const rho = atom->rho;
  const int *const mask = atom->mask, *const type = atom->type;
  const double *const largest = speed_sq.data();
  const int moves = hub->groupbit, watched = groupbit;
  if (neighbor->ago == 0 || kick == 0.0) lightest = *std::min_element(rmass, rmass + nlocal);
  const double limit = std::sqrt(*std::min_element(largest + 1, largest + atom->ntypes + 1) / 3.0);
  const double speed = 0.9 * limit, strength = kick > 0.0 ? 0.1 * limit * lightest / kick : BIG;
  for (int i = 0; i < nlocal; i++, v += 3, f += 3) {
    if (tell && i % BLOCK == 0) {
      const int n = std::min(BLOCK, nlocal - i);
      if (all_small(n, v, f, rho + i, speed, strength)) {
        i += n - 1;
        v += 3 * (n - 1);
        f += 3 * (n - 1);
        continue;
      }
    }
    if (!(mask[i] & watched)) continue;
    const double k = (mask[i] & moves) ? kick / rmass[i] : 0.0;
    const double a = v[0] + k * f[0], b = v[1] + k * f[1], c = v[2] + k * f[2];
    const double vsq = a * a + b * b + c * c;
    if (vsq <= largest[type[i]] && rho[i] > 0.0 && rho[i] < BIG) continue;
    if (!(vsq < HUGE_SQUARE && std::abs(rho[i]) < BIG)) enter(FINITE, i, vsq + rho[i]);
    else if (rho[i] <= 0.0) enter(DENSITY, i, 1.0 - rho[i] / hub->state[type[i]].rho0);
    else enter(MACH, i, std::sqrt(vsq / hub->state[type[i]].wave_speed_sq()));
  }
}

/* ----------------------------------------------------------------------
   the rest: Mach and Courant numbers, densities, pairs, sums
------------------------------------------------------------------------- */

void FixFSIWatch::check_rest()
{
  double **x = atom->x;
  double **v = atom->v;
  const double *const rmass = atom->rmass, *const rho = atom->rho;
  const int *const mask = atom->mask, *const type = atom->type;
  const double dt = update->dt, h = hub->h;

  struct Of {
    double csq, rho0, mass, fastest;    // of a type Mach and Courant number grow with the speed
    int species;
  };
  std::vector<Of> all_of(atom->ntypes + 1, {0.0, 1.0, 0.0, -1.0, NONE});
  for (int t = 1; t <= atom->ntypes; t++) {
    const State &s = hub->state[t];
    all_of[t] = {s.species == NONE ? 0.0 : s.wave_speed_sq(), s.rho0, 0.0, -1.0, s.species};
  }
  double kinetic = 0.0, furthest = -1.0;    // furthest from the density at rest
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(mask[i] & groupbit)) continue;
    Of &of = all_of[type[i]];
    if (of.species == RIGID) continue;    // neither compressed nor integrated
    const double vsq = v[i][0] * v[i][0] + v[i][1] * v[i][1] + v[i][2] * v[i][2];
    kinetic += rmass[i] * vsq;
    of.mass += rmass[i];
    if (vsq > of.fastest) {
      of.fastest = vsq;
      const double c = std::sqrt(of.csq), speed = std::sqrt(vsq);
      enter(MACH, i, speed / c);
      if (of.species == FLUID) enter(COURANT, i, dt * (c + speed) / h);
      else enter(COURANT, i, dt * c / (hub->is_total_lagrangian(i) ? hub->substeps : 1) / h);
      enter(ENERGY, i, vsq);
    }
    const double error = std::abs((of.species == FLUID ? rho[i] / of.rho0 : hub->density_ratio(i)) - 1.0);
    if (error > furthest) {
      furthest = error;
      enter(DENSITY, i, error);
    }
  }
  // kinetic energy, and what of it is small: that of a hundredth of the speed of waves
  double mine[3] = {0.5 * kinetic, 0.0, (double) atom->nlocal}, all[3];
  for (const Of &of : all_of) mine[1] += 0.5e-4 * of.mass * of.csq;

  // pairs whose neighbour lists are at hand: all but those inside one total-Lagrangian body
  if (limit[DISTANCE] > 0.0) {
    double smallest = BIG;
    for (const Pair *pair : {(Pair *) hub->fluid, (Pair *) hub->solid, (Pair *) hub->solid_tl}) {
      if (!pair || !pair->list) continue;
      const NeighList *const list = pair->list;
      for (int ii = 0; ii < list->inum; ii++) {
        const int i = list->ilist[ii];
        if (!(mask[i] & groupbit)) continue;
        for (int jj = 0; jj < list->numneigh[i]; jj++) {
          const int j = list->firstneigh[i][jj] & NEIGHMASK;
          const double a = x[i][0] - x[j][0], b = x[i][1] - x[j][1], c = x[i][2] - x[j][2];
          const double rsq = a * a + b * b + c * c;
          if (rsq >= smallest) continue;
          smallest = rsq;
          enter(DISTANCE, i, std::sqrt(rsq) / hub->dx, j);
        }
      }
    }
  }

  MPI_Allreduce(mine, all, 3, MPI_DOUBLE, MPI_SUM, world);
  const double scale = std::max(energy_before, all[1]);
  total[ENERGY] = energy_before >= 0.0 && scale > 0.0 ? all[0] / scale : 0.0;
  energy_before = all[0];
  total[LOST] = (double) atom->natoms - all[2];
  double reflected = 0.0;
  for (auto *fix : hub->wall_fixes) reflected += fix->compute_scalar();
  total[REFLECTED] = reflected_before >= 0.0 ? reflected - reflected_before : 0.0;
  reflected_before = reflected;

  double own[NQUANTITY];
  for (int q = 0; q < NQUANTITY; q++) own[q] = q == DISTANCE ? -worst[q].value : q >= ENERGY ? total[q] : worst[q].value;
  MPI_Allreduce(own, seen, NQUANTITY, MPI_DOUBLE, MPI_MAX, world);
  seen[DISTANCE] = -seen[DISTANCE];
  if (limit[DISTANCE] > 0.0) nearest = std::min(nearest, seen[DISTANCE]);
}

/* ----------------------------------------------------------------------
   all ranks agree on what is wrong, and warn or stop together
------------------------------------------------------------------------- */

void FixFSIWatch::judge(When when)
{
  int mine = 0, crossed;
  if (worst[FINITE].tag) mine |= 1 << FINITE;
  for (int q = MACH; q < NQUANTITY; q++) {
    const double value = q >= ENERGY ? total[q] : worst[q].value;
    if (q == DISTANCE ? value < limit[q] : value > limit[q]) mine |= 1 << q;
  }
  // a maximum per bit: LAMMPS' stand-in for MPI in serial builds has no bitwise or
  int bits[NQUANTITY], all_bits[NQUANTITY];
  for (int q = 0; q < NQUANTITY; q++) bits[q] = mine >> q & 1;
  MPI_Allreduce(bits, all_bits, NQUANTITY, MPI_INT, MPI_MAX, world);
  crossed = 0;
  for (int q = 0; q < NQUANTITY; q++) crossed |= all_bits[q] << q;
  if (!crossed) return;

  for (int k = 0; k < NQUANTITY; k++) {
    const auto q = static_cast<Quantity>(k);
    if (!(crossed & 1 << q)) continue;
    violations++;
    if (!warn || q == FINITE) stop(q, when);    // there is nothing to go on with
    if (warned & 1 << q) continue;
    warned |= 1 << q;
    if (q == MACH)
      for (int t = 1; t <= atom->ntypes; t++) speed_sq[t] = HUGE_SQUARE;
    Finding all;
    const auto text = describe(q, all);
    if (comm->me == 0) error->warning(FLERR, text);
  }
}

/* ----------------------------------------------------------------------
   the worst of all ranks, and what to say about it
------------------------------------------------------------------------- */

std::string FixFSIWatch::describe(Quantity q, Finding &all)
{
  struct {
    double key;
    int rank;
  } mine = {q == FINITE ? 1.0 : q == DISTANCE ? -worst[q].value : worst[q].value, comm->me}, first;
  if (!worst[q].tag) mine.key = -BIG;
  MPI_Allreduce(&mine, &first, 1, MPI_DOUBLE_INT, MPI_MAXLOC, world);
  all = worst[q];
  MPI_Bcast(&all, sizeof(Finding), MPI_BYTE, first.rank, world);
  if (q >= ENERGY) all.value = total[q];

  auto text = fmt::format("Fix fsi/watch: {}", about[q].what);
  if (q == FINITE) text += fmt::format(" is not finite ({})", all.value);
  else text += fmt::format(" {:.4g} is {} the limit {:g}", all.value, q == DISTANCE ? "below" : "above", limit[q]);
  text += fmt::format(" on step {}", update->ntimestep);
  if (all.tag) text += fmt::format(", atom {} (type {}) at {:.6g} {:.6g} {:.6g}", all.tag, all.type, all.x[0], all.x[1], all.x[2]);
  if (all.other) text += fmt::format(", and atom {}", all.other);
  text += fmt::format(". Try {}", about[q].hint);
  // twice what is usual
  if (q != COURANT && seen[COURANT] > 0.5) text += fmt::format(". At the last check the Courant number was {:.3g}", seen[COURANT]);
  return text;
}

/* ----------------------------------------------------------------------
   In the middle of a step positions, walls and densities of fluids go back to its start: a state from which the step can be
   repeated. (Density and stress of fsi/solid stay where they are, a step too far: an error of one step's strain.)
------------------------------------------------------------------------- */

void FixFSIWatch::stop(Quantity q, When when)
{
  Finding all;
  auto text = describe(q, all);
  if (when == END) {
    for (int i = 0; i < atom->nlocal; i++)
      for (int d = 0; d < 3; d++) {
        atom->x[i][d] = kept[6 * i + d];
        atom->v[i][d] = kept[6 * i + 3 + d];
      }
    int k = 0;
    for (auto *fix : hub->wall_fixes)
      for (auto &w : fix->walls) w.position = kept_walls[k++];
  }
  if (when != START) {
    const double back = -0.5 * update->dt;
    for (int i = 0; i < atom->nlocal; i++)
      if (atom->mask[i] & hub->groupbit)
        for (int d = 0; d < hub->dim; d++) atom->x[i][d] += back * atom->v[i][d];
    if (hub->fluid && hub->density_fluid == FixFSI::CONTINUITY)
      for (int i = 0; i < atom->nlocal; i++)
        if (hub->state[atom->type[i]].species == FLUID) atom->rho[i] -= (update->dt + hub->stagger) * hub->rate[i];
    for (auto *fix : hub->wall_fixes)
      for (auto &w : fix->walls) w.position += back * w.velocity[w.axis];
    update->ntimestep--;
  }

  int mine = 1, writable;
  for (int i = 0; i < atom->nlocal; i++) {
    const double *const x = atom->x[i], *const v = atom->v[i];
    if (!std::isfinite(x[0] + x[1] + x[2] + v[0] + v[1] + v[2] + atom->rho[i])) mine = 0;
  }
  MPI_Allreduce(&mine, &writable, 1, MPI_INT, MPI_MIN, world);
  const bool finite = writable;

  if (all.tag && !dump_file.empty()) {
    write_neighbours(all);
    text += fmt::format(". Particles around it: {}", dump_file);
  }
  if (!restart_file.empty() && !finite) text += ". No restart file: the state is not finite any more";
  if (!restart_file.empty() && finite) {
    // an error of write_restart would hide what this is about
    if (comm->me == 0) {
      FILE *fp = fopen(restart_file.c_str(), "wb");
      writable = fp != nullptr;
      if (fp) fclose(fp);
    }
    MPI_Bcast(&writable, 1, MPI_INT, 0, world);
    if (writable) {
      bigint n = atom->nlocal;
      MPI_Allreduce(&n, &atom->natoms, 1, MPI_LMP_BIGINT, MPI_SUM, world);
      domain->pbc();
      domain->reset_box();
      // what has left a fixed box since the last reneighboring would be missing when the file is read
      double mine[6], ends[6];
      for (int d = 0; d < 3; d++) {
        mine[d] = -domain->boxlo[d];
        mine[3 + d] = domain->boxhi[d];
        for (int i = 0; i < atom->nlocal && !domain->periodicity[d]; i++) {
          if (atom->x[i][d] < domain->boxlo[d]) mine[d] = std::max(mine[d], hub->dx - atom->x[i][d]);
          if (atom->x[i][d] >= domain->boxhi[d]) mine[3 + d] = std::max(mine[3 + d], hub->dx + atom->x[i][d]);
        }
      }
      MPI_Allreduce(mine, ends, 6, MPI_DOUBLE, MPI_MAX, world);
      for (int d = 0; d < 3; d++) {
        domain->boxlo[d] = -ends[d];
        domain->boxhi[d] = ends[3 + d];
      }
      WriteRestart write(lmp);
      write.multiproc_options(0, 0, nullptr);
      write.write(restart_file);
      text += fmt::format(". State of step {}: {}", update->ntimestep, restart_file);
    } else
      text += fmt::format(". Restart file {} cannot be written: {}", restart_file, utils::getsyserror());
  }
  error->all(FLERR, text);
}

/* ----------------------------------------------------------------------
   text dump of all particles within three cutoffs
------------------------------------------------------------------------- */

void FixFSIWatch::write_neighbours(const Finding &all)
{
  static constexpr int NCOL = 13;
  const double reach = 3.0 * hub->cut;
  std::vector<double> mine;
  for (int i = 0; i < atom->nlocal; i++) {
    const double *const x = atom->x[i], *const v = atom->v[i], *const f = atom->f[i];
    double d[3] = {x[0] - all.x[0], x[1] - all.x[1], x[2] - all.x[2]};
    const bool itself = atom->tag[i] == all.tag;    // wherever it is
    if (!itself) {
      if (!std::isfinite(d[0] + d[1] + d[2])) continue;
      domain->minimum_image(d);
      if (d[0] * d[0] + d[1] * d[1] + d[2] * d[2] > reach * reach) continue;
    }
    for (const double value : {(double) atom->tag[i], (double) atom->type[i], (double) atom->molecule[i], x[0], x[1], x[2], v[0], v[1],
                               v[2], f[0], f[1], f[2], atom->rho[i]})
      mine.push_back(value);
  }
  int n = mine.size();
  std::vector<int> counts(comm->nprocs), starts(comm->nprocs, 0);
  MPI_Gather(&n, 1, MPI_INT, counts.data(), 1, MPI_INT, 0, world);
  for (int k = 1; k < comm->nprocs; k++) starts[k] = starts[k - 1] + counts[k - 1];
  std::vector<double> rows(comm->me == 0 ? starts.back() + counts.back() : 0);
  MPI_Gatherv(mine.data(), n, MPI_DOUBLE, rows.data(), counts.data(), starts.data(), MPI_DOUBLE, 0, world);
  if (comm->me) return;

  FILE *fp = fopen(dump_file.c_str(), "w");
  if (!fp) {
    error->warning(FLERR, "Fix fsi/watch cannot write file {}: {}", dump_file, utils::getsyserror());
    return;
  }
  char bounds[9];
  domain->boundary_string(bounds);
  utils::print(fp, "ITEM: TIME\n{:.16g}\n", update->atime + (update->ntimestep - update->atimestep) * update->dt);
  utils::print(fp, "ITEM: TIMESTEP\n{}\nITEM: NUMBER OF ATOMS\n{}\nITEM: BOX BOUNDS {}\n", update->ntimestep, rows.size() / NCOL,
               bounds);
  for (int d = 0; d < 3; d++) utils::print(fp, "{:.16g} {:.16g}\n", domain->boxlo[d], domain->boxhi[d]);
  utils::print(fp, "ITEM: ATOMS id type mol x y z vx vy vz fx fy fz rho\n");
  for (size_t k = 0; k < rows.size(); k += NCOL) {
    utils::print(fp, "{:.0f} {:.0f} {:.0f}", rows[k], rows[k + 1], rows[k + 2]);
    for (int c = 3; c < NCOL; c++) utils::print(fp, " {:.16g}", rows[k + c]);
    utils::print(fp, "\n");
  }
  fclose(fp);
}

/* ----------------------------------------------------------------------
   number of checks that found something, so far
------------------------------------------------------------------------- */

double FixFSIWatch::compute_scalar()
{
  return static_cast<double>(violations);
}

/* ----------------------------------------------------------------------
   of the last check: Mach number, distance, density error, Courant number, energy growth, lost, reflected
------------------------------------------------------------------------- */

double FixFSIWatch::compute_vector(int k)
{
  return seen[k + 1];
}
