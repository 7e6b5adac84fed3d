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

#include "pair_fsi_fluid.h"

#include "atom.h"
#include "comm.h"
#include "compute_fsi_force.h"
#include "error.h"
#include "fix_fsi.h"
#include "fix_fsi_stress.h"
#include "force.h"
#include "fsi_cells.h"
#include "fsi_contact.h"
#include "fsi_density_diffusion.h"
#include "fsi_fields.h"
#include "fsi_find.h"
#include "fsi_fluid_loops.h"
#include "fsi_kernel.h"
#include "fsi_levels.h"
#include "fsi_profile.h"
#include "fsi_shift.h"
#include "fsi_sight.h"
#include "neigh_list.h"
#include "neighbor.h"
#include "pair_hybrid.h"
#include "update.h"

#include <algorithm>
#include <array>
#include <cmath>

using namespace LAMMPS_NS;
using namespace FSI;

static const std::vector<std::string> coupling_names = {"wall", "full"};    // Couple

// What fluids meet: fluids, walls, solids, which each level has; fluids that thin bodies may hide
enum { FLUIDS, WALLS, SOLIDS, OF_LEVEL, HIDDEN = OF_LEVEL, NKINDS };

// Pairs of one kernel: what fluid particles of one level of the scene meet, and pairs of two levels
struct PairFSIFluid::Meeting {
  int what = FLUIDS;
  PairKind kind = WITH_FLUID;
  size_t level = 0;    // of the fluid particles
  bool unlike = false;
  double h = 0.0, cut = 0.0, wdx = 0.0;            // of the kernel: W(mean spacing) last
  std::shared_ptr<FluidLoops> loops, of_forces;    // all; those of forces
  RowList rows;                                    // of the neighbor list
  std::vector<RowList> images;                     // by reflection; walls of particles have none
  // of images: the support, and what a pair comes nearer in a step
  double reach = INFINITY;
  // of these, what is within the support and a margin: the lists have the skin's pairs, too
  std::vector<Row> near;
  // of pairs that thin bodies may hide: what is left of each, and of those of images
  std::vector<double> visible;
  std::vector<std::vector<double>> visible_images;
};

// Of fluid particles of a level, per type: how its particles count, where it pushes fluid off
struct PairFSIFluid::Shares {
  std::vector<Share> of_type;
  bool unequal = false;    // is any solid or wall of another spacing than the fluid, or thin?
  std::vector<Contact> guards;
};

struct PairFSIFluid::Members {
  Fields fields;
  // what loops get the address of
  Thin thin_bodies = {};
  Visible seen_pairs = {};
  Cut cut_solids = {};
  explicit Members(LAMMPS *lmp) : fields(lmp) {}
};

PairFSIFluid::PairFSIFluid(LAMMPS *lmp) :
    PairFSI(lmp, "fsi/fluid"), members(new Members(lmp)), couple(WALL), images_step(-1),
    near_known(false), sorts(true), margin(0.0), cut(false), solids_pass(false), fade(nullptr),
    fill(nullptr), fill_weight(nullptr), fields(members->fields), rate(nullptr), beyond(nullptr),
    hybrid(nullptr), no_fdotr_before(0)
{
  keywords.key("sound").number(sound, 0.0, Range::above(0.0));
  keywords.key("eos").choice(tait, 0, {"linear", "tait"});
  artificial_row("fluid");
  keywords.key("laminar/visc").set(laminar, PLAIN_LAMINAR).effect("laminar viscosity");
  keywords.key("laminar/visc/central").set(laminar, CENTRAL_LAMINAR);
  keywords.key("solid/slip").logical(solids_slip, false);
  keywords.key("solid/guard").number(solids_guard, 0.5, Range::between(0.0, 1.0));
  keywords.key("density/diffusion")
      .number(delta, 0.0, Range::between(0.0, 0.5))    // more is unstable at the usual step
      .effect("density diffusion {}");
  keywords.key("density/surface").logical(surfaces, false);
  keywords.key("shift")
      .number(shifting, 0.0, Range::between(0.0, 1.0))
      .effect("particle shifting {}");
  keywords.key("shift/every").integer(shift_every, 1, 1);
  keywords.key("surface")
      .number(surface_ratio, 0.0, Range::from_to_below(0.0, 1.0))
      .effect("free surface where psi is below {}");
  keywords.key("tension").logical(tension, false).effect("tension in the fluid");
  keywords.key("background").number(background, 0.0).effect("background pressure {}");
  keywords.key("couple").choice(given_couple, WALL, coupling_names);
  keywords.key("extrapolate").logical(extrapolate, false);
}

PairFSIFluid::~PairFSIFluid()
{
  give_back_virial();
}

void PairFSIFluid::give_back_virial()
{
  if (hybrid) hybrid->no_virial_fdotr_compute = no_fdotr_before;
  hybrid = nullptr;
}

const std::vector<Row> &PairFSIFluid::rows_with_walls(size_t level) const
{
  static const std::vector<Row> none;
  if (meetings.empty()) return none;    // not set up yet
  const Meeting &m = meetings[OF_LEVEL * level + WALLS];
  return near_known ? m.near : m.rows.rows;
}

bool PairFSIFluid::has_rows_with_walls() const
{
  return std::any_of(meetings.begin(), meetings.end(), [](const Meeting &m) {
    return m.what == WALLS && !m.rows.rows.empty();
  });
}

bool PairFSIFluid::handles(int a, int b) const
{
  return a == FLUID || b == FLUID;
}

State PairFSIFluid::make_state(const Material &m) const
{
  // a solid's state is that of pair_style fsi/solid, if there is one: it enters its own afterwards
  if (m.species == SOLID) return solid_state(m, false);
  State s;
  s.species = m.species;
  s.rho0 = m.rho0;
  s.inv_rho0 = 1.0 / s.rho0;
  if (m.species == RIGID) {
    // its density is what says its pressure, its volume should be that of fluid under this
    // pressure; if fluids differ in this, that of the fluid that is near (fix fsi/wall/particle)
    const auto first = std::find_if(material.begin(), material.end(), [](const Material &other) {
      return other.species == FLUID;
    });
    s.csq = sound_of(*first) * sound_of(*first) * first->rho0 / m.rho0;
    s.c = std::sqrt(s.csq);
  } else {
    s.c = sound_of(m);
    s.csq = s.c * s.c;
    s.tait = tait;
  }
  s.inv_csq = 1.0 / s.csq;
  s.p0 = background;
  if (!tension) s.floor = 0.0;
  s.viscosity = m.viscosity;
  return s;
}

double PairFSIFluid::sound_of(const Material &m) const
{
  if (m.sound > 0.0) return m.sound;
  if (sound == 0.0)
    error->all(FLERR,
               "Fluid {} has no speed of sound: give it keyword sound in its material file, or "
               "pair_style fsi/fluid one for all fluids that have none of their own",
               m.name);
  return sound;
}

// choose the loops for kernel, dimension and the effects that the script names
void PairFSIFluid::init_style()
{
  NeighList *const lists = list;    // LAMMPS makes no others where all is asked for as before
  PairFSI::init_style();
  list = lists;
  for (const auto &of_continuity :
       {std::make_pair(delta > 0.0, "density/diffusion"),
        std::make_pair(surfaces != 0, "density/surface"), std::make_pair(shifting > 0.0, "shift")})
    if (of_continuity.first && fix_fsi->density_fluid != FixFSI::CONTINUITY)
      error->all(FLERR,
                 "Pair style fsi/fluid {} requires density by continuity, as fix fsi scheme "
                 "standard has it",
                 of_continuity.second);
  if (surfaces && (tension || background != 0.0))
    error->all(FLERR,
               "Pair style fsi/fluid density/surface is for fluids with a free surface: without "
               "tension yes and background");
  if (laminar) {
    bool any = false;
    for (const auto &m : material) any = any || m.viscosity > 0.0;
    if (!any && comm->me == 0)
      error->warning(
          FLERR,
          "Pair style fsi/fluid laminar/visc has nothing to act on: no fluid has a viscosity");
  }
  if (!fix_fsi->sight) beside.clear();
  force_computes = computes_of<ComputeFSIForce>(lmp);
  const Facts of_solids = facts_of_solids(lmp);
  couple = fix_fsi->article && of_solids.style == Facts::OF_SOLIDS ? FULL : given_couple;
  if (extrapolate && (couple != WALL || !has_solids()) && comm->me == 0)
    error->warning(FLERR, "Pair style fsi/fluid extrapolate has nothing to act on: {}",
                   has_solids() ? "it is for couple wall" : "there is no solid");
  if (solids_slip && (!laminar || !has_solids()) && comm->me == 0)
    error->warning(FLERR, "Pair style fsi/fluid solid/slip has nothing to act on: {}",
                   has_solids() ? "there is no laminar/visc" : "there is no solid");
  fix_fsi->find_levels();
  find_meetings();
  find_shares();
  beside.clear();
  // a hybrid style would take the virial of images, too, with that of pairs: pairs have to count
  // their own
  give_back_virial();
  if (force->pair != this && any_is(fixes_of<Part>(lmp), &Facts::mirror_walls)) {
    hybrid = force->pair;
    no_fdotr_before = hybrid->no_virial_fdotr_compute;
    hybrid->no_virial_fdotr_compute = 1;
  }
  if (couple != WALL && of_solids.style == Facts::OF_TOTAL_LAGRANGIAN_SOLIDS)
    error->all(FLERR,
               "Pair style fsi/solid/tl requires couple wall in pair_style fsi/fluid: its stress "
               "is not one that crosses to the fluid");
  // the plain forces of a solid end at its face with half a kernel of neighbors missing, which the
  // fluid's pairs supply; forces with corrected gradients are complete without them
  if (couple != WALL && of_solids.corrected_gradients)
    error->all(FLERR,
               "Pair style fsi/fluid couple full requires pair_style fsi/solid gradient plain: "
               "with corrected gradients use couple wall");
  double &ghosts = comm->cutghostuser;    // 0: LAMMPS chooses; too small: fix fsi says so
  if (has_solids() && any_is(fixes_of<Part>(lmp), &Facts::mirror_walls) &&
      (ghosts == 0.0 || ghosts >= fix_fsi->largest_cut))
    ghosts = std::max(ghosts, beyond_lists() + neighbor->skin);
  open_ends = fix_fsi->has_open_ends();
  fix_stress = FixFSIStress::find(lmp);
}

void PairFSIFluid::find_meetings()
{
  const auto &levels = fix_fsi->levels;
  const size_t n = levels.size();
  meetings.clear();
  of_two_levels.assign(n * n, 0);
  of_hidden.clear();
  const auto make_loops = [this](double h, bool packs) {
    return make_fluid_loops(fix_fsi->kernel, fix_fsi->dim, h, packs);
  };
  for (size_t l = 0; l < n; l++) {
    Meeting m;
    m.level = l;
    m.h = levels[l].h;
    m.cut = levels[l].cut;
    m.wdx = levels[l].wdx;
    const auto loops = make_loops(levels[l].h, have_packs());
    of_two_levels[n * l + l] = meetings.size();
    for (m.what = FLUIDS; m.what < OF_LEVEL; m.what++) {
      m.loops = loops;
      m.of_forces = m.what == SOLIDS && couple != WALL ? make_loops(levels[l].h, false) : m.loops;
      m.kind = m.what == WALLS ? WITH_WALL
          : m.what != SOLIDS   ? WITH_FLUID
          : couple == WALL     ? WITH_SOLID
                               : WITH_SOLID_FULL;
      meetings.push_back(m);
    }
  }
  for (size_t a = 0; a < n; a++)
    for (size_t b = 0; b < n; b++) {
      if (a == b) continue;
      Meeting m;
      m.level = a;
      m.unlike = true;
      m.h = 0.5 * (levels[a].h + levels[b].h);
      const double dx = 0.5 * (levels[a].dx + levels[b].dx);
      with_kernel(fix_fsi->kernel, fix_fsi->dim, m.h, [&](const auto &kernel) {
        m.cut = kernel.cut;
        m.wdx = kernel.W(dx);
      });
      m.loops = m.of_forces = make_loops(m.h, have_packs());
      of_two_levels[n * a + b] = meetings.size();
      meetings.push_back(m);
    }
  if (!fix_fsi->sight) return;
  fix_fsi->sight->tabulate();
  for (const size_t k : of_two_levels) {
    Meeting m = meetings[k];
    m.what = HIDDEN;
    m.loops = m.of_forces = make_loops(m.h, false);
    of_hidden.push_back(meetings.size());
    meetings.push_back(m);
  }
}

void PairFSIFluid::find_shares()
{
  shares.assign(fix_fsi->levels.size(), Shares());
  for (size_t l = 0; l < shares.size(); l++) {
    shares[l].of_type.assign(atom->ntypes + 1, Share());
    for (int t = 1; t <= atom->ntypes; t++) {
      const bool fluid = material[t].species == FLUID, thin = fix_fsi->thin[t] != 0.0;
      const double dx = fix_fsi->levels[l].dx, ratio = fix_fsi->dx_of(t) / dx;
      if (ratio == 1.0 && !thin) continue;
      if (!fluid) shares[l].unequal = true;
      shares[l].of_type[t] = {fix_fsi->dim == 3 ? ratio * ratio * ratio : ratio * ratio,
                              fluid ? 0.0 : fix_fsi->sharper_of(t, dx), thin};
    }
  }
}

Facts PairFSIFluid::facts() const
{
  Facts facts = PairFSI::facts();
  facts.style = Facts::OF_FLUIDS;
  facts.laminar = laminar;
  facts.couples_stress = couple != WALL;
  facts.density_at_surfaces = surfaces;
  facts.density_follows_shift = shifting > 0.0 && fills();
  facts.shift_every = shifting > 0.0 ? shift_every : 0;
  return facts;
}

// what density follows: between open ends, where nothing else holds the number of particles
double *const *PairFSIFluid::velocity_of_shifting() const
{
  return fix_fsi->shift_velocity[0] && open_ends ? fix_fsi->shift_velocity : nullptr;
}

// numbers of an atom in the array of shifting, and those of them that are sums

int PairFSIFluid::nshift() const
{
  return fix_fsi->dim == 2 ? Shift<2>::row(fills()) : Shift<3>::row(fills());
}

int PairFSIFluid::shift_sums() const
{
  return fix_fsi->dim == 2 ? Shift<2>::sums(fills()) : Shift<3>::sums(fills());
}

// Is this one of several styles of a hybrid one that leaves it all its pairs? Then it takes LAMMPS'
// list of all pairs: the hybrid style would have its own copied from that.
bool PairFSIFluid::has_all_pairs() const
{
  auto *const all = dynamic_cast<PairHybrid *>(force->pair);
  if (!all) return false;
  char name[] = "fsi/fluid";
  for (int a = 1; a <= atom->ntypes; a++)
    for (int b = a; b <= atom->ntypes; b++)
      if (setflag[a][b] && handles(material[a].species, material[b].species) &&
          !all->check_ijtype(a, b, name))
        return false;
  return true;
}

void PairFSIFluid::set_fields(Scene &scene)
{
  if (has_all_pairs()) neighbor->add_request(this);    // after init_style()
  fields.set("density rate", Fields::STEP, scene.density_fluid == FixFSI::CONTINUITY, rate);
  fields.set("shift", Fields::STEP, shifting > 0.0, scene.shift, nshift());
  fields.set("fade of shifting", Fields::STEP, shifting > 0.0 && scene.has_levels(), fade);
  fields.set("velocity beyond solids", Fields::STEP, sticks_to_solids(), beyond, scene.dim + 1);
  fields.set("room behind thin bodies", Fields::STEP, scene.sight != nullptr, fill);
  fields.set("weight behind thin bodies", Fields::STEP, scene.sight != nullptr, fill_weight);
  scene.noslip_walls = scene.noslip_walls || sticks_to_solids();
  scene.surface_ratio = surface_ratio == 0.0 && scene.article ? 0.9 : surface_ratio;
}

void PairFSIFluid::add_messages(Message &to_ghosts, Message &back)
{
  if (sticks_to_solids()) to_ghosts.add(fix_fsi->wall_velocity, 0, fix_fsi->dim, {SOLID});
  if (sticks_to_solids()) back.add(beyond, 0, fix_fsi->dim + 1, {SOLID});
  if (fix_fsi->density_fluid == FixFSI::CONTINUITY) back.add(rate, {FLUID, RIGID});
  if (shifting > 0.0) back.add(fix_fsi->shift, 0, shift_sums(), {FLUID, RIGID}, &fix_fsi->shifts);
}

void PairFSIFluid::add_costs(Costs &costs) const
{
  const int newton = force->newton_pair, continuity = fix_fsi->density_fluid == FixFSI::CONTINUITY,
            ns = shifting > 0.0 ? shift_sums() : 0;
  costs.bytes += 8 * ((2 + continuity) * fix_fsi->dim + 4 + continuity + (ns ? nshift() : 0));
  costs.sums = costs.sums || continuity;
  costs.fluid_ghost += newton * continuity * (1 + (shift_every == 1 ? ns : 0));
  if (ns && shift_every > 1)
    costs.rarely += fmt::format("  every {} steps: {} bytes of a ghost more, particle shifting\n",
                                shift_every, 8 * newton * ns);
  if (fix_fsi->shift_velocity[0]) costs.bytes += 8 * fix_fsi->dim;
  if (velocity_of_shifting()) costs.fluid_ghost += fix_fsi->dim;
  if (fix_fsi->sight) {
    costs.bytes += 16;
    costs.fluid_ghost += 2;
    costs.forward += 2;
  }
  const int d = is_light(0) ? fix_fsi->dim : 0, back = newton * d * (d + 3) / 2;
  costs.forward += d;
  costs.back += back;
  costs.solid_ghost += d + back;
  costs.fluid_ghost += d + back;
  if (sticks_to_solids()) costs.solid_ghost += fix_fsi->dim + newton * (fix_fsi->dim + 1);
}

void PairFSIFluid::find_idle(const Census &all, const Idle &nothing) const
{
  if (shift_every > 1 && shifting == 0.0)
    nothing("Pair style fsi/fluid shift/every", "keyword shift is 0");
  if (all.fluids == 0) nothing("Pair style fsi/fluid" + named_effects(), "no particle is a fluid");
}

void PairFSIFluid::begin_state(bool advance)
{
  images_step = -1;
  near_known = false;
  fix_fsi->shifts = advance && shifting > 0.0 && update->ntimestep % shift_every == 0;
  if (neighbor->ago) return;
  fields.grow();
  if (fix_fsi->sight) fix_fsi->sight->find_bodies();
  find_rows();
  if (!fill) return;
  std::fill_n(fill, atom->nlocal + atom->nghost, 1.0);
  std::fill_n(fill_weight, atom->nlocal + atom->nghost, 1.0);
}

double PairFSIFluid::within(const Meeting &m) const
{
  return fix_fsi->has_levels() ? m.cut : fix_fsi->largest_cut;
}

// Loops are at atom->x and half a step before it. Where lists have just been built, sorted_at is of
// other atoms.
template <int D> void PairFSIFluid::find_reach()
{
  const auto *const x = FixFSI::rows(atom->x), *const v = FixFSI::rows(atom->v);
  const int nall = atom->nlocal + atom->nghost;
  const size_t size = rate ? (size_t) D * atom->nmax : 0;
  if (sorted_at.size() < size) sorted_at.resize(size);
  const auto *const old = reinterpret_cast<const double(*)[D]>(sorted_at.data());
  double fastest = 0.0, farthest = 0.0;
  for (int i = 0; i < nall; i++) {
    double vsq = 0.0, rsq = 0.0;
    for (int d = 0; d < D; d++) vsq += v[i][d] * v[i][d];
    for (int d = 0; rate && d < D; d++) rsq += (x[i][d] - old[i][d]) * (x[i][d] - old[i][d]);
    fastest = std::max(fastest, vsq);
    farthest = std::max(farthest, rsq);
  }
  // what a pair comes nearer in a step
  const double nearer = 2.0 * update->dt * std::sqrt(fastest);
  double walls = 0.0;
  for (const Wall &wall : fix_fsi->walls.wall) walls += 2.0 * std::fabs(wall.velocity[wall.axis]);
  for (auto &m : meetings) m.reach = within(m) + nearer + update->dt * walls;
  sorts = neighbor->ago == 0 || 2.0 * std::sqrt(farthest) + 0.5 * nearer > margin;
  if (!sorts || !rate) return;
  // for as many steps as a third of the skin lasts: more pairs cost more than to sort again
  const double skin = neighbor->skin,
               steps = std::floor(0.35 * skin / std::max(nearer, 0.04 * skin) + 0.5);
  margin = 1.15 * (std::max(steps, 1.0) - 0.5) * nearer;
  for (int i = 0; i < nall; i++)
    for (int d = 0; d < D; d++) sorted_at[D * i + d] = x[i][d] - 0.5 * update->dt * v[i][d];
}

bool PairFSIFluid::add_rates(bool advance)
{
  fields.grow();
  if (fill) look_past_thin_bodies();
  find_cut_solids();
  if (rate || fix_fsi->walls.any()) fix_fsi->dim == 2 ? find_reach<2>() : find_reach<3>();
  const size_t nall = atom->nlocal + atom->nghost;
  if (rate) std::fill_n(rate, nall, 0.0);
  if (fix_fsi->shifts && nall) std::fill_n(fix_fsi->shift[0], nall * nshift(), 0.0);
  const Phase phase(fix_fsi->profile, Profile::DENSITY);
  if (fix_fsi->shifts && fade) find_fades();
  if (rate && advance)
    fix_fsi->dim == 2 ? add_density_rate<2>(update->dt) : add_density_rate<3>(update->dt);
  if (beyond) {
    if (nall) std::fill_n(beyond[0], nall * (fix_fsi->dim + 1), 0.0);
    add_velocities_at_solids();
  }
  return (rate && advance) || beyond;
}

void PairFSIFluid::advance(bool advance)
{
  const Phase phase(fix_fsi->profile, Profile::DENSITY);
  if (beyond) extrapolate_velocities();
  if (!rate || !advance) return;
  advance_density();
  if (!fix_fsi->shifts) return;
  const double dt = update->dt * shift_every;
  if (fix_fsi->dim == 2)
    fills() ? displacements<2, true>(dt) : displacements<2, false>(dt);
  else
    fills() ? displacements<3, true>(dt) : displacements<3, false>(dt);
}

// the sums of find_fades over some rows; seen: how much of pairs, or of all of them all
template <class T, class K>
void PairFSIFluid::add_fades(const K &kernel, const std::vector<Row> &rows, const Visible &seen)
{
  constexpr int D = K::DIM;
  const auto *const x = FixFSI::rows(atom->x), *const v = FixFSI::rows(atom->v);
  const double *const volume = volumes.data();
  double *const sums = fade;
  run_loop<T>([&](auto number) FSI_INLINE_LAMBDA {
    using Number = decltype(number);
    for (const Row &row : rows) {
      const double *const xi = x[row.i], *const vi = v[row.i];
      Number sum = 0.0;
      for_neighbors<Number, false>(row, [&](const int *j, const Number &there) FSI_INLINE_LAMBDA {
        Number rsq = 0.0, vx = 0.0;
        for (int d = 0; d < D; d++) {
          const auto of = [&](const auto *rows, double own) FSI_INLINE_LAMBDA {
            return own - Lanes<Number>::make([&](int k) FSI_INLINE_LAMBDA {
                     return rows[j[k]][d];
                   });
          };
          const Number away = of(x, xi[d]);
          rsq += away * away;
          vx += away * of(v, vi[d]);
        }
        // no direction where both are at one place
        Number w = there * kernel.W(root(rsq)) * (vx * vx / greater(rsq, Number(1.0e-300)));
        if constexpr (std::is_same_v<Number, double>)
          if (seen.part) w *= seen.part[j - seen.first];
        sum += Lanes<Number>::read(volume, j) * w;
        Lanes<Number>::add(volume[row.i] * w, sums, j);
      });
      sums[row.i] += Lanes<Number>::sum(sum);
    }
  });
}

// Shifting's factor 1 + 0.2 (W_ij/W(dx))^4 gives it another state of rest than the force of
// pressure has. Where particles stand on one lattice both are at rest; where two lattices meet they
// would work against each other without end. Where the flow distorts the order of particles the
// factor keeps them apart. So of it is left min(1, (u/u0)^2), u^2 = sum_j V_j W_ij (v_ij.e_ij)^2
// over fluid, e_ij the direction from one to the other: the speed with which neighbors come and go.
void PairFSIFluid::find_fades()
{
  static constexpr double SLOW = 0.003;    // u0 over the speed of sound (doc/notes/levels.md)
  const int nlocal = atom->nlocal, nall = nlocal + atom->nghost, *const type = atom->type;
  std::fill_n(fade, nall, 0.0);
  volumes.resize(nall);
  for (int i = 0; i < nall; i++) volumes[i] = atom->rmass[i] / atom->rho[i];
  for (const auto &m : meetings) {
    const std::vector<Row> &rows = m.rows.rows;
    if ((m.what != FLUIDS && m.what != HIDDEN) || rows.empty()) continue;
    with_kernel(fix_fsi->kernel, fix_fsi->dim, m.h, [&](const auto &kernel) {
      if (m.what == HIDDEN)
        add_fades<double>(kernel, rows, {m.visible.data(), rows[0].j});
      else
        have_packs() ? add_fades<Pack>(kernel, rows, {}) : add_fades<double>(kernel, rows, {});
    });
  }
  fix_fsi->add_ghosts(fade);
  for (int i = 0; i < nlocal; i++) {
    const State &s = fix_fsi->state[type[i]];
    if (s.species == FLUID) fade[i] = std::min(1.0, fade[i] / (SLOW * SLOW * s.csq));
  }
  fix_fsi->send_to_ghosts(fade);
}

// solids that pass through mirror walls, or may before the next neighbor lists
void PairFSIFluid::find_depths()
{
  const auto &wall = fix_fsi->walls.wall;
  const int *const type = atom->type, n = wall.size();
  const auto *const x = FixFSI::rows(atom->x), *const v = FixFSI::rows(atom->v);
  std::vector<double> mine(n * (atom->ntypes + 1), -INFINITY), all(mine.size()),
      speeds(mine.size());
  const auto for_near = [&](auto f) {
    const InnerBox inner(wall, neighbor->skin);
    for (int i = 0; i < atom->nlocal; i++) {
      if (inner.contains(x[i]) || fix_fsi->state[type[i]].species != SOLID) continue;
      for (int k = 0; k < n; k++)
        if (!wall[k].finite) f(i, n * type[i] + k, wall[k]);
    }
  };
  for_near([&](int i, int m, const Wall &w) {
    mine[m] = std::max(mine[m], -w.distance(x[i]));
  });
  MPI_Allreduce(mine.data(), all.data(), mine.size(), MPI_DOUBLE, MPI_MAX, world);
  solids_pass = std::any_of(all.begin(), all.end(), [this](double depth) {
    return depth > -neighbor->skin;
  });
  depths.assign(all.size(), {0.0, 0.0});
  cut = std::any_of(all.begin(), all.end(), [](double depth) {
    return depth > 0.0;
  });
  if (!cut) return;
  std::fill(mine.begin(), mine.end(), -INFINITY);
  for_near([&](int i, int m, const Wall &w) {
    if (-w.distance(x[i]) == all[m])
      mine[m] = std::max(mine[m], -w.side * (v[i][w.axis] - w.velocity[w.axis]));
  });
  MPI_Allreduce(mine.data(), speeds.data(), mine.size(), MPI_DOUBLE, MPI_MAX, world);
  for (size_t m = 0; m < all.size(); m++)
    if (all[m] > 0.0) depths[m] = {all[m], speeds[m]};
}

// how much of each solid particle is before the walls
void PairFSIFluid::find_cut_solids()
{
  const Walls &walls = fix_fsi->walls;
  cut = false;
  if (!walls.any() || !has_solids() || (neighbor->ago && !solids_pass)) return;
  find_depths();
  if (!cut) return;
  const int *const type = atom->type, nall = atom->nlocal + atom->nghost;
  const auto *const x = FixFSI::rows(atom->x), *const v = FixFSI::rows(atom->v);
  parts.assign(nall, 1.0);
  part_rates.assign(nall, 0.0);
  for (int i = 0; i < nall; i++) {
    if (fix_fsi->state[type[i]].species != SOLID) continue;
    const double dx = fix_fsi->dx_of(type[i]);
    parts[i] = walls.before(x[i], v[i], dx, &depths[walls.wall.size() * type[i]], part_rates[i]);
    fix_fsi->wmask[i] = parts[i] > 0.0 ? walls.near(x[i], fix_fsi->cut, 0.5 * dx) : 0;
  }
}

// what thin bodies hide and how much more they count, where particles are in this step
void PairFSIFluid::look_past_thin_bodies()
{
  Sight &sight = *fix_fsi->sight;
  sight.follow_bodies();
  const auto *const x = FixFSI::rows(atom->x);
  const size_t n = fix_fsi->levels.size();
  struct Next {
    const Row *row, *end;
    double *part;
  };
  std::vector<Next> next;
  for (const size_t k : of_hidden) {
    const std::vector<Row> &rows = meetings[k].rows.rows;
    next.push_back({rows.data(), rows.data() + rows.size(), meetings[k].visible.data()});
  }
  for (const int i : beside) {
    const size_t level = fix_fsi->level_of[atom->type[i]];
    const auto here = [i](const Next &one) {
      return one.row != one.end && one.row->i == i;
    };
    double reach = fix_fsi->levels[level].cut;
    for (size_t k = n * level; k < n * (level + 1); k++)
      if (here(next[k])) reach = std::max(reach, meetings[of_hidden[k]].cut);
    sight.look_from(x[i], reach);
    for (size_t k = n * level; k < n * (level + 1); k++) {
      const double cut = meetings[of_hidden[k]].cut;
      for (Next &one = next[k]; here(one); one.row++)
        for (int m = 0; m < one.row->n; m++) *one.part++ = sight.visible(x[one.row->j[m]], cut);
    }
    const auto more = sight.fill(level);
    fill[i] = more.force;
    fill_weight[i] = more.weight;
  }
  fix_fsi->send_to_ghosts(fill);
  fix_fsi->send_to_ghosts(fill_weight);
}

// continuity: rho^{n+1/2} = rho^{n-1/2} + dt (d rho/dt)^n; rho >= m W(0), the density of an
// isolated particle: diffusion could make that of ejected spray negative
void PairFSIFluid::advance_density()
{
  double *const rho = atom->rho;
  const int *const type = atom->type;
  const double dt = update->dt + fix_fsi->dt_offset;
  for (int i = 0; i < atom->nlocal; i++) {
    const State &s = fix_fsi->state[type[i]];
    if (s.species != FLUID) continue;
    const double next = rho[i] + dt * rate[i], alone = atom->rmass[i] * s.w0;
    if (next < alone) rate[i] = (alone - rho[i]) / dt;    // what go_back() takes
    rho[i] = std::max(next, alone);
  }
}

// With sub-steps: does a layer of these solids weigh less than half of one of the fluid? t = 0: are
// there any?
bool PairFSIFluid::is_light(int t) const
{
  const auto &state = fix_fsi->state;
  double fluid = 0.0, solid = INFINITY;
  for (int k = 1; k <= atom->ntypes && fix_fsi->substeps > 1; k++) {
    const double layer = state[k].rho0 * fix_fsi->dx_of(k);
    if (state[k].species == FLUID) fluid = std::max(fluid, layer);
    if (state[k].species == SOLID && (t == 0 || k == t)) solid = std::min(solid, layer);
  }
  return solid < 0.5 * fluid;
}

// Light solids with sub-steps: use(i, j, x_ij, k) for pairs of a fluid and a solid, whose change of
// velocity w within the step changes the force on the fluid by k x_ij (x_ij.w) (theory.rst)
template <int D, class Use> void PairFSIFluid::for_wet_pairs(Use use) const
{
  static constexpr double HALF = 0.3;    // of the stiffness of a wet area, over rho c^2/dx
  const int *const type = atom->type;
  const auto *const point = reinterpret_cast<const Point<D> *>(points.data());
  for_levels(*fix_fsi, [&](size_t level, const auto &kernel) {
    for (const Row &row : meetings[OF_LEVEL * level + SOLIDS].rows.rows) {
      const int i = row.i, t = type[row.j[0]];
      if (!is_light(t)) continue;
      const State &s = fix_fsi->state[type[i]];
      const double more = shares[level].of_type[t].thin ? fill[i] : 1.0,
                   z = HALF * s.rho0 * s.csq / fix_fsi->levels[level].dx * update->dt * more;
      for (const int *j = row.j; j < row.j + row.n; j++) {
        double x[D];
        difference(point[i].x, point[*j].x, x);
        const double rsq = product(x, x), r = std::sqrt(rsq);
        if (rsq < kernel.cutsq && r > 0.0 && (atom->mask[*j] & fix_fsi->groupbit))
          use(i, *j, x, -2.0 * z * point[i].vol * point[*j].vol * kernel.gradient(r) / r);
      }
    }
  });
}

void PairFSIFluid::integrate_substeps()
{
  if (is_light(0)) fix_fsi->dim == 2 ? find_impedances<2>() : find_impedances<3>();
}

template <int D> void PairFSIFluid::find_impedances()
{
  auto *const z = fix_fsi->impedance, *const w = fix_fsi->swerve;
  for (auto *rows : {z, z + 3, w})
    for (int d = 0; d < 3; d++) rows[d].assign(atom->nlocal + atom->nghost, 0.0);
  for_wet_pairs<D>([&](int, int j, const double(&x)[D], double k) {
    for (int a = 0; a < D; a++)
      for (int b = a; b < D; b++) z[Sym<3>::id(a, b)][j] += k * x[a] * x[b];
  });
  for (int a = 0; a < D; a++)
    for (int b = a; b < D; b++) fix_fsi->add_ghosts(z[Sym<3>::id(a, b)].data());
}

// the reaction: what solids have not got of the impulse, fluids have not given
template <int D> void PairFSIFluid::take_swerve()
{
  std::vector<double> more[D];
  const auto &w = fix_fsi->swerve;
  for (int d = 0; d < D; d++) {
    fix_fsi->send_to_ghosts(fix_fsi->swerve[d].data());
    more[d].assign(w[d].size(), 0.0);
  }
  for_wet_pairs<D>([&](int i, int j, const double(&x)[D], double k) {
    for (int a = 0; a < D; a++)
      for (int b = 0; b < D; b++) {
        more[a][i] += k * x[a] * x[b] * w[b][j];
        more[a][j] -= k * x[a] * x[b] * w[b][j];
      }
  });
  for (auto &of : more) fix_fsi->add_ghosts(of.data());
  double power = 0.0;    // that on solids is counted in their sub-steps
  for (int i = 0; i < atom->nlocal; i++) {
    const bool counts =
        (atom->mask[i] & fix_fsi->groupbit) && fix_fsi->state[atom->type[i]].species == FLUID;
    double f[3] = {};
    for (int d = 0; d < D; d++) {
      atom->f[i][d] += f[d] = more[d][i];
      if (counts)
        power += f[d] *
            (atom->v[i][d] + 0.5 * update->dt * force->ftm2v * atom->f[i][d] / atom->rmass[i]);
    }
    for (auto *measure : force_computes) measure->add_more(i, f);
  }
  fix_fsi->tally(FixFSI::COUPLING, -power);
}

// The ledger's powers have velocities of the start of the step. With those of its middle, which are
// known now, they are second order in time: of what waits for its kick by its force, of what has
// moved since, in sub-steps or with a rigid body, by the way it went.
void PairFSIFluid::react()
{
  if (is_light(0)) fix_fsi->dim == 2 ? take_swerve<2>() : take_swerve<3>();
  if (!fix_fsi->kept || taken.empty()) return;
  fix_fsi->dim == 2 ? correct_powers<2>() : correct_powers<3>();
}

template <int D> void PairFSIFluid::correct_powers()
{
  const int nlocal = atom->nlocal, nall = nlocal + atom->nghost, *const type = atom->type;
  const double dt = update->dt, half = 0.5 * dt * force->ftm2v;
  const auto *const point = reinterpret_cast<const Point<D> *>(points.data());
  const auto change = [&](int i, int d) {
    const bool waits = fix_fsi->state[type[i]].species == FLUID || fix_fsi->substeps == 1;
    if (waits && (atom->mask[i] & fix_fsi->groupbit)) return half * atom->f[i][d] / atom->rmass[i];
    const double way = atom->x[i][d] - point[i].x[d];
    return way == 0.0 ? 0.0 : way / dt - 0.5 * point[i].v[d];
  };
  std::vector<double> one(nall);
  for (const auto term : {FixFSI::COUPLING, FixFSI::ARTIFICIAL, FixFSI::WALLS}) {
    double power = 0.0;
    for (int d = 0; d < D; d++) {
      for (int i = 0; i < nall; i++)
        one[i] = term == FixFSI::COUPLING              ? taken[row_of_points(D) * i + d]
            : term == FixFSI::ARTIFICIAL               ? taken[row_of_points(D) * i + D + d]
            : fix_fsi->state[type[i]].species == RIGID ? forces[row_of_forces(D) * i + d]
                                                       : 0.0;
      fix_fsi->add_ghosts(one.data());
      for (int i = 0; i < nlocal; i++) power += one[i] * change(i, d);
    }
    fix_fsi->tally(term, power);
  }
}

void PairFSIFluid::go_back()
{
  if (!rate) return;
  const double dt = update->dt + fix_fsi->dt_offset;
  for (int i = 0; i < atom->nlocal; i++)
    if (fix_fsi->state[atom->type[i]].species == FLUID) atom->rho[i] -= dt * rate[i];
}

// What keeps fluid out of walls and solids: the energy K d^(D-2) (d-r)^2/2 of a pair nearer than d.
// Of a finer solid the more particles push the finer it is: with K dx^(D-2) (dx_s/dx)^(D-1) for K
// d^(D-2) its face is as stiff, and a pair swings slower than the step of sound allows.
Contact PairFSIFluid::guard_of(int t, double dx) const
{
  const State &s = fix_fsi->state[t];
  if (s.species != SOLID)
    return Contact(fix_fsi->dim,
                   s.guard * ((dx + fix_fsi->dx_of(t)) / (fix_fsi->dx + fix_fsi->dx_of(t))));
  const double ratio = fix_fsi->dx_of(t) / dx;
  Contact guard(fix_fsi->dim, couple == WALL ? solids_guard * 0.5 * (dx + fix_fsi->dx_of(t)) : 0.0);
  guard.scale = fix_fsi->dim == 3 ? dx * ratio * ratio : ratio;
  return guard;
}

void PairFSIFluid::find_guards()
{
  for (size_t l = 0; l < shares.size(); l++) {
    shares[l].guards.clear();
    for (size_t t = 0; t < fix_fsi->state.size(); t++)
      shares[l].guards.push_back(guard_of(t, fix_fsi->levels[l].dx));
  }
}

// rows of two fluid types, side by side
std::vector<RowList *> PairFSIFluid::rows_of_fluids()
{
  const auto &level = fix_fsi->level_of;
  const size_t n = level.size(), nlevels = fix_fsi->levels.size();
  std::vector<RowList *> rows_of(n * n);
  for (size_t a = 0; a < n; a++)
    for (size_t b = 0; b < n; b++)
      rows_of[n * a + b] = &meetings[of_two_levels[nlevels * level[a] + level[b]]].rows;
  return rows_of;
}

// the largest support of a fluid particle and these neighbors
double PairFSIFluid::farthest_of(int i, const int *neighbors, int n) const
{
  const auto &resolution = fix_fsi->resolution;
  const int *const type = atom->type;
  double other = resolution[type[i]].cut;
  for (int jj = 0; jj < n; jj++) {
    const int t = type[neighbors[jj]];
    if (fix_fsi->state[t].species == FLUID) other = std::max(other, resolution[t].cut);
  }
  return 0.5 * (resolution[type[i]].cut + other);
}

// rows of those fluid neighbors of i that thin bodies may hide before lists are built again: marks
// them
void PairFSIFluid::find_hidden(int i, const int *neighbors, int n,
                               const std::vector<int> &fluid_types, std::vector<char> &hides)
{
  Sight &sight = *fix_fsi->sight;
  const double skin = neighbor->skin;
  const int *const type = atom->type;
  const auto &level = fix_fsi->level_of;
  const size_t *const of_levels = &of_hidden[fix_fsi->levels.size() * level[type[i]]];
  sight.look_from(atom->x[i], fix_fsi->has_levels() ? farthest_of(i, neighbors, n) : fix_fsi->cut,
                  skin);
  hides.resize(n);
  for (int jj = 0; jj < n; jj++) {
    const int j = neighbors[jj];
    hides[jj] = fix_fsi->state[type[j]].species == FLUID && sight.may_hide(atom->x[j], skin);
  }
  for (const int t : fluid_types) {
    const char *hidden = hides.data();
    meetings[of_levels[level[t]]].rows.add(i, neighbors, n, false, false, [&](int j) {
      return *hidden++ && type[j] == t;
    });
  }
  beside.push_back(i);
}

static bool all_of_type(int t, const int *type, const int *j, int n)
{
  return std::all_of(j, j + n, [=](int k) {
    return type[k] == t;
  });
}

// the pairs of the neighbor list as rows of a fluid particle and neighbors of one type: those of
// one fluid alone are LAMMPS' own
void PairFSIFluid::find_rows()
{
  const int *const type = atom->type;
  const State *const state = fix_fsi->state.data();
  double **const x = atom->x;
  std::vector<int> fluid_types, other_types;
  for (int t = 1; t <= atom->ntypes; t++)
    if (state[t].species == FLUID)
      fluid_types.push_back(t);
    else if (state[t].species != NONE)
      other_types.push_back(t);
  find_guards();
  for (auto &m : meetings) m.rows.clear();

  // fluid particles and neighbors of other species, whichever of both has the other in its list
  std::vector<std::array<int, 2>> with_others;
  std::vector<char> is_fluid(atom->ntypes + 1, 0);
  for (const int t : fluid_types) is_fluid[t] = 1;

  const size_t ntypes = atom->ntypes + 1;
  std::vector<RowList *> rows_of = rows_of_fluids();

  std::vector<int> unmasked;
  std::vector<char> hides;
  Sight *const sight = fix_fsi->sight.get();
  beside.clear();
  const bool own = atom->ntypes == 1 && fluid_types.size() == 1 && !atom->molecular;
  for (int ii = 0; ii < list->inum; ii++) {
    const int i = list->ilist[ii], *neighbors = list->firstneigh[i];
    const int n = list->numneigh[i];
    if (own && is_fluid[type[i]]) {
      meetings[FLUIDS].rows.rows.push_back({i, n, neighbors});
      continue;
    }
    if (atom->molecular) {
      unmasked.resize(n);
      for (int jj = 0; jj < n; jj++) unmasked[jj] = neighbors[jj] & NEIGHMASK;
      neighbors = unmasked.data();
    }
    if (!is_fluid[type[i]]) {
      for (int jj = 0; jj < n; jj++)
        if (is_fluid[type[neighbors[jj]]]) with_others.push_back({neighbors[jj], i});
      continue;
    }
    const bool looks = sight && sight->near(x[i]);
    if (!looks && !atom->molecular && all_of_type(type[i], type, neighbors, n)) {
      rows_of[(ntypes + 1) * type[i]]->rows.push_back({i, n, neighbors});
      continue;
    }
    if (looks) find_hidden(i, neighbors, n, fluid_types, hides);
    // that of its own type stays if it is empty, for its own images
    RowList **const to = &rows_of[ntypes * type[i]];
    for (const int t : fluid_types) {
      const char *hidden = hides.data();
      to[t]->add(i, neighbors, n, false, t == type[i], [&](int j) {
        if (looks && *hidden++) return false;
        if (type[j] == t) return true;
        if (t == fluid_types[0] && !is_fluid[type[j]]) with_others.push_back({i, j});
        return false;
      });
    }
  }
  for (const size_t k : of_hidden) {
    Meeting &m = meetings[k];
    m.rows.end();
    m.visible.clear();
    for (const Row &row : m.rows.rows) m.visible.resize(m.visible.size() + row.n);
  }
  for (auto &m : meetings)
    if (!own && m.what == FLUIDS) m.rows.end();
  add_pairs_behind_walls(is_fluid, with_others);
  if (!other_types.empty()) find_rows_with_others(with_others, other_types);
}

// The image of a solid's particle that is up to half a spacing behind a wall without end, from
// where on nothing of it counts, is nearer than itself by up to a spacing: these pairs LAMMPS does
// not list. (Lists of all particles that reach further cost 2 % more.)
void PairFSIFluid::add_pairs_behind_walls(const std::vector<char> &is_fluid,
                                          std::vector<std::array<int, 2>> &pairs) const
{
  const Walls &walls = fix_fsi->walls;
  const int *const type = atom->type, nlocal = atom->nlocal, nall = nlocal + atom->nghost;
  const double skin = neighbor->skin, cut = fix_fsi->largest_cut;
  const auto passes = [&](int j) {
    if (fix_fsi->state[type[j]].species != SOLID) return false;
    const double deep = 0.5 * fix_fsi->dx_of(type[j]) + skin;
    return std::any_of(walls.wall.begin(), walls.wall.end(), [&](const Wall &w) {
      return !w.finite && w.distance(atom->x[j]) < skin && w.distance(atom->x[j]) > -deep;
    });
  };
  if (!walls.any() || !has_solids()) return;
  const Cells solids(atom->x, nall, fix_fsi->dim, beyond_lists() + skin, passes);
  for (int i = 0; i < nall; i++)
    if (is_fluid[type[i]] && walls.near(atom->x[i], cut + skin, skin))
      solids.around(atom->x[i], [&](int j, double rsq) {
        const auto &of = fix_fsi->resolution;
        const double reach =
            std::max(of[type[i]].cut, of[type[j]].cut) + fix_fsi->dx_of(type[j]) + skin;
        const bool here = i < nlocal || (!force->newton_pair && j < nlocal);
        if (here && rsq >= neighbor->cutneighsq[type[i]][type[j]] && rsq < reach * reach)
          pairs.push_back({i, j});
      });
}

double PairFSIFluid::beyond_lists() const
{
  double widest = 0.0;
  for (int t = 1; t <= atom->ntypes; t++)
    if (material[t].species == SOLID) widest = std::max(widest, fix_fsi->dx_of(t));
  return fix_fsi->largest_cut + widest;
}

// rows of fluid particles and neighbors of other species, from their pairs
void PairFSIFluid::find_rows_with_others(const std::vector<std::array<int, 2>> &with_others,
                                         const std::vector<int> &other_types)
{
  const int *const type = atom->type, nall = atom->nlocal + atom->nghost;
  const State *const state = fix_fsi->state.data();
  std::vector<int> first(nall + 2, 0), other(with_others.size());
  for (const auto &pair : with_others) first[pair[0] + 2]++;
  for (int i = 0; i < nall; i++) first[i + 2] += first[i + 1];
  for (const auto &pair : with_others) other[first[pair[0] + 1]++] = pair[1];
  for (int i = 0; i < nall; i++) {
    if (first[i] == first[i + 1]) continue;
    Meeting *const of_level = &meetings[OF_LEVEL * fix_fsi->level_of[type[i]]];
    for (const int t : other_types)
      of_level[state[t].species == SOLID ? SOLIDS : WALLS].rows.add(
          i, &other[first[i]], first[i + 1] - first[i], false, false, [=](int j) {
            return type[j] == t;
          });
  }
  for (auto &m : meetings)
    if (m.what == WALLS || m.what == SOLIDS) m.rows.end();
}

// rows of images, one list per reflection: of local fluid particles themselves, and of the
// neighbors that are near its walls, too, both together not farther than the support; segments of
// walls reflect a pair only if the line between them passes
// through. places: where particles are, null: at atom->x
void PairFSIFluid::find_images(const Walls &walls, const double *places)
{
  const int *const wmask = fix_fsi->wmask, *const type = atom->type, nlocal = atom->nlocal;
  const auto *const x = FixFSI::rows(atom->x);
  const double cutsq = fix_fsi->cut * fix_fsi->cut;
  const int n = walls.reflections.size();
  const bool finite = walls.finite();
  const auto position = [&](int i) -> std::array<double, 3> {
    if (!places) return {x[i][0], x[i][1], x[i][2]};
    return fix_fsi->dim == 2 ? reinterpret_cast<const Point<2> *>(places)[i].position(x[i])
                             : reinterpret_cast<const Point<3> *>(places)[i].position(x[i]);
  };
  const auto sees = [&](int i, int j, int k) {
    const auto xi = position(i), xj = position(j);
    double rsq = 0.0;
    for (int d = 0; d < 3; d++) rsq += (xi[d] - xj[d]) * (xi[d] - xj[d]);
    bool found = false;
    walls.images(wmask[i] & wmask[j], rsq, xi.data(), xj.data(), cutsq,
                 [&](const Walls::Reflection &s, double, const double *) {
                   found = found || &s == &walls.reflections[k];
                 });
    return found;
  };
  for (auto &meeting : meetings) {
    if (meeting.what == WALLS) continue;
    auto &visible_images = meeting.visible_images;
    visible_images.resize(n);
    for (auto &parts_of : visible_images) parts_of.clear();
    auto &lists = meeting.images;
    const double within = meeting.reach;
    const int kind = meeting.what;
    const double *part = meeting.visible.data();    // of a pair and its images it is the same
    lists.resize(n);
    for (auto &list_of : lists) list_of.clear();
    for (const Row &row : meeting.rows.rows) {
      const int i = row.i;
      const double *const parts_of_row = part;
      if (kind == HIDDEN) part += row.n;
      if (!wmask[i]) continue;
      const bool of_own_type =
          kind == FLUIDS && i < nlocal && (row.n == 0 || type[row.j[0]] == type[i]);
      for (int k = 0; k < n; k++) {
        const int mask = walls.reflections[k].mask;
        if ((wmask[i] & mask) != mask) continue;
        const Wall &wall = fix_fsi->walls.wall[walls.reflections[k].w[0]];
        const double farthest = within - wall.distance(x[i]);
        if (kind == HIDDEN) {
          const double *of_pair = parts_of_row;
          lists[k].add(i, row.j, row.n, false, false, [&](int j) {
            const double seen = *of_pair++;
            if ((wmask[j] & mask) != mask || (finite && !sees(i, j, k))) return false;
            visible_images[k].push_back(seen);
            return true;
          });
        } else if (finite)
          lists[k].add(i, row.j, row.n, of_own_type && sees(i, i, k), false, [&](int j) {
            return (wmask[j] & mask) == mask && sees(i, j, k);
          });
        else
          lists[k].add(i, row.j, row.n, of_own_type, false, [&](int j) {
            return (wmask[j] & mask) == mask && wall.distance(x[j]) < farthest;
          });
      }
    }
    for (auto &list_of : lists) list_of.end();
  }
}

// calls loop(meeting, number of reflection, mirror) for all rows of images; without extent of walls
// they are the same in all of a step's loops, but that of rates leaves only what is within reach
template <class Loop>
void PairFSIFluid::for_images(const Walls &walls, const double *places, Loop loop)
{
  if (!fix_fsi->wmask || !walls.any()) return;
  if (images_step != update->ntimestep || walls.finite()) find_images(walls, places);
  images_step = update->ntimestep;
  for (size_t k = 0; k < walls.reflections.size(); k++) {
    const Mirror mirror(walls, walls.reflections[k]);
    for (auto &m : meetings)
      if (m.what != WALLS && !m.images[k].rows.empty()) loop(m, k, &mirror);
  }
}

FluidParticles PairFSIFluid::particles_at(const double *points)
{
  members->thin_bodies = {fill, fill_weight};
  members->cut_solids = {parts.data(), part_rates.data()};
  return {points,
          atom->type,
          fix_fsi->state.data(),
          atom->nlocal,
          nullptr,
          false,
          fill ? &members->thin_bodies : nullptr,
          cut ? &members->cut_solids : nullptr,
          force->newton_pair != 0};
}

FluidParticles PairFSIFluid::of_rows(const FluidParticles &particles, const Meeting &meeting,
                                     const std::vector<Row> &list_of,
                                     const std::vector<double> &parts_of)
{
  FluidParticles in = particles;
  in.share = shares[meeting.level].of_type.data();
  in.unequal = shares[meeting.level].unequal;
  in.unlike = meeting.unlike;
  if (meeting.what != HIDDEN) return in;
  members->seen_pairs = {parts_of.data(), list_of.empty() ? nullptr : list_of[0].j};
  in.visible = &members->seen_pairs;
  return in;
}

template <int D, class Complete> FluidParticles PairFSIFluid::gather(double t, Complete complete)
{
  constexpr size_t SIZE = sizeof(Point<D>) / sizeof(double);
  const int nall = atom->nlocal + atom->nghost;
  if (points.size() < nall * SIZE) points.resize(atom->nmax * SIZE);
  auto *const point = reinterpret_cast<Point<D> *>(points.data());
  const auto *const x = FixFSI::rows(atom->x), *const v = FixFSI::rows(atom->v);
  const double *const rho = atom->rho, *const rmass = atom->rmass;
  for (int i = 0; i < nall; i++) {
    Point<D> &p = point[i];
    for (int d = 0; d < D; d++) {
      p.v[d] = v[i][d];
      p.x[d] = x[i][d] + t * p.v[d];
    }
    p.rho = rho[i];
    p.vol = rmass[i] / p.rho;
    complete(i, p);
  }
  return particles_at(points.data());
}

// Positions are those of time n, half a step before atom->x, where the velocities belong: the
// density leapfrogs from n-1/2 to n+1/2, second order in time.
template <int D> void PairFSIFluid::add_density_rate(double dt)
{
  const double dth = 0.5 * dt;
  double **x = atom->x;
  const int *const type = atom->type;
  const Walls walls = fix_fsi->walls.moved(-dth);
  double *const *const by_shifting = velocity_of_shifting();
  if (by_shifting)
    for (int d = 0; d < D; d++) fix_fsi->send_to_ghosts(by_shifting[d]);
  const FluidParticles particles = gather<D>(-dth, [&](int i, Point<D> &p) {
    if (by_shifting)
      for (int d = 0; d < D; d++) p.v[d] += by_shifting[d][i];
    // Diffusion smooths pressures, so both of a pair must have one. What has none, spray and
    // surfaces, has the density that its few neighbors leave: their exchange would empty the spray,
    // beyond zero, and take volume from the rest.
    p.p = p.pv2 = 0.0;
    if (delta == 0.0) return;
    const State &s = fix_fsi->state[type[i]];
    p.p = s.pressure(p.rho) > s.floor ? 1.0 : 0.0;
    p.pv2 = DensityDiffusion::hydrostatic(fix_fsi->body_forces.of_type[type[i]].data(),
                                          p.position(x[i]).data(), s.rho0 * s.inv_csq);
  });
  // the density of walls is that of the pressures in the last step or setup, which a restart does
  // not know
  if (fix_fsi->shifts && has_rows_with_walls()) {
    auto *const point = reinterpret_cast<Point<D> *>(points.data());
    for (int i = 0; i < atom->nlocal + atom->nghost; i++)
      if (fix_fsi->state[type[i]].species == RIGID)
        point[i].vol = atom->rmass[i] * fix_fsi->state[type[i]].inv_rho0;
  }
  if (fix_fsi->kept || fix_fsi->has_levels()) pressure_over_density.resize(atom->nmax);
  if (fix_fsi->kept)
    for (int i = 0; i < atom->nlocal + atom->nghost; i++)
      pressure_over_density[i] = fix_fsi->pressure(i) / atom->rho[i];

  RateLaws laws = {delta, pressure_over_density.data(), 0.0, fills(), 0.0};
  double *const shift = fix_fsi->shifts ? fix_fsi->shift[0] : nullptr;
  PairSums sums;
  const auto loop = [&](const Meeting &m, const std::vector<Row> &which,
                        const std::vector<double> &parts_of, const Mirror *mirror, double reach,
                        std::vector<Row> *found) {
    FluidParticles in = of_rows(particles, m, which, parts_of);
    if (shift && fade) {
      in.fade = fade;
      in.unlike = true;
    }
    laws.wdx = m.wdx;
    laws.reach = reach;
    m.loops->rates(m.kind, which, mirror, in, laws, rate, shift, fix_fsi->kept ? &sums : nullptr,
                   found);
  };
  // of what thin bodies may hide the order says which part belongs to which pair
  for (auto &m : meetings) {
    const bool hidden = m.what == HIDDEN;
    loop(m, sorts || hidden ? m.rows.rows : m.near, m.visible, nullptr, within(m) + margin,
         sorts && !hidden ? &m.near : nullptr);
  }
  for_images(walls, particles.points, [&](Meeting &m, int k, const Mirror *mirror) {
    loop(m, m.images[k].rows, m.visible_images[k], mirror, m.reach,
         m.what == HIDDEN ? nullptr : &near_images);
    if (m.what != HIDDEN) m.images[k].rows.swap(near_images);
  });
  near_known = true;
  const int of_shift = nshift(), last = shift_sums();
  for (int i = 0; shift && i < atom->nlocal + atom->nghost; i++)
    rate[i] += shift[of_shift * i + last];
  fix_fsi->tally(FixFSI::DIFFUSION, sums.diffusion);
  fix_fsi->tally(FixFSI::WALLS, sums.walls);
}

// as the last loop had it
template <int D> double PairFSIFluid::volume_of(int i) const
{
  return reinterpret_cast<const Point<D> *>(points.data())[i].vol;
}

template <int D, bool FILLS> void PairFSIFluid::displacements(double dt)
{
  double *const *const velocity = velocity_of_shifting();
  const int *const type = atom->type;
  double *const *const sums = fix_fsi->shift;
  for (int i = 0; i < atom->nlocal; i++) {
    const State &s = fix_fsi->state[type[i]];
    if (s.species != FLUID) continue;
    // lattices overshoot from 0.51 h on (theory.rst)
    const double most = std::min(shifting * s.c * dt, 0.5 * s.h);
    Shift<D>::template displacement<FILLS>(sums[i], volume_of<D>(i), most * s.h, 0.25 * most);
    if (velocity && dt > 0.0)
      for (int d = 0; d < D; d++) velocity[d][i] = sums[i][d] / dt;
  }
}

// sums of what depends on the distance of a pair, walls' images included: sum(meeting, rows, both,
// mirror, particles), of neighbors only if both
template <class Sum>
void PairFSIFluid::distance_sums(bool others_too, const FluidParticles &particles, Sum sum)
{
  const auto one = [&](const Meeting &m, const RowList &which, const std::vector<double> &parts_of,
                       const Mirror *mirror) {
    const bool both = m.kind == WITH_FLUID || others_too;
    sum(m, which.rows, both, mirror, of_rows(particles, m, which.rows, parts_of));
  };
  for (const auto &m : meetings) one(m, m.rows, m.visible, nullptr);
  for_images(fix_fsi->walls, nullptr, [&](const Meeting &m, int k, const Mirror *mirror) {
    one(m, m.images[k], m.visible_images[k], mirror);
  });
}

void PairFSIFluid::add_number_density(double *psi, bool solids_too)
{
  distance_sums(solids_too, particles_at(nullptr),
                [&](const Meeting &m, const std::vector<Row> &which, bool both,
                    const Mirror *mirror, const FluidParticles &particles) {
                  m.loops->number_density(m.kind, which, both, mirror, particles,
                                          FixFSI::rows(atom->x), psi);
                });
}

void PairFSIFluid::add_position_divergence(double *div)
{
  std::vector<double> volume(atom->nlocal + atom->nghost);
  for (size_t i = 0; i < volume.size(); i++) volume[i] = atom->rmass[i] / atom->rho[i];
  distance_sums(false, particles_at(nullptr),
                [&](const Meeting &m, const std::vector<Row> &which, bool both,
                    const Mirror *mirror, const FluidParticles &particles) {
                  m.loops->position_divergence(which, both, mirror, particles,
                                               FixFSI::rows(atom->x), volume.data(), div);
                });
}

void PairFSIFluid::add_gradient_sum(double *s)
{
  fix_fsi->dim == 2 ? add_gradients<2>(s) : add_gradients<3>(s);
}

// the plain sums of particle shifting, all volumes those of the lattice
template <int D> void PairFSIFluid::add_gradients(double *s)
{
  constexpr int ROW = Shift<D>::row(false);
  const size_t nall = atom->nlocal + atom->nghost;
  const int *const type = atom->type;
  const FluidParticles particles = gather<D>(0.0, [&](int i, Point<D> &p) {
    p.vol = 1.0 / fix_fsi->resolution[type[i]].psi_bulk;
  });
  std::vector<double> sums(ROW * nall, 0.0);
  distance_sums(false, particles,
                [&](const Meeting &m, const std::vector<Row> &which, bool, const Mirror *mirror,
                    const FluidParticles &in) {
                  m.loops->shifts(m.kind, which, mirror, in, m.wdx, sums.data());
                });
  for (size_t i = 0; i < nall; i++)
    for (int d = 0; d < D; d++) s[d * nall + i] += sums[ROW * i + D + d] / -volume_of<D>(i);
}

void PairFSIFluid::add_velocities_at_solids()
{
  const int dim = fix_fsi->dim;
  const auto *const x = FixFSI::rows(atom->x), *const v = FixFSI::rows(atom->v);
  for_levels(*fix_fsi, [&](size_t level, const auto &kernel) {
    for (const Row &row : meetings[OF_LEVEL * level + SOLIDS].rows.rows)
      for (int k = 0; k < row.n; k++) {
        const int i = row.i, j = row.j[k];
        double rsq = 0.0;
        for (int d = 0; d < dim; d++) rsq += (x[i][d] - x[j][d]) * (x[i][d] - x[j][d]);
        if (rsq >= kernel.cutsq) continue;
        const double W = kernel.W(std::sqrt(rsq));
        for (int d = 0; d < dim; d++) beyond[j][d] += W * v[i][d];
        beyond[j][dim] += W;
      }
  });
}

// velocity of solids in viscous forces: where fluid would be inside the solid, that with which the
// face has the solid's, 2 v_s - sum v W/sum W, as for walls of particles
void PairFSIFluid::extrapolate_velocities()
{
  const int dim = fix_fsi->dim;
  for (int i = 0; i < atom->nlocal; i++) {
    if (fix_fsi->state[atom->type[i]].species != SOLID) continue;
    const double *const s = beyond[i], *const v = atom->v[i];
    for (int d = 0; d < dim; d++)
      fix_fsi->wall_velocity[i][d] = s[dim] > 0.0 ? 2.0 * v[d] - s[d] / s[dim] : v[d];
  }
}

void PairFSIFluid::compute(int eflag, int vflag)
{
  FixFSI::check_pre_no(lmp, fix_fsi);
  const Phase phase(fix_fsi->profile, Profile::FLUID_FORCES);
  ev_init(eflag, vflag);
  check_tally();

  for (auto *measure : force_computes) measure->tally(-1.0);
  fix_fsi->dim == 2 ? compute_forces<2>() : compute_forces<3>();
  for (auto *measure : force_computes) measure->tally(1.0);

  if (vflag_fdotr && !fix_fsi->walls.any()) virial_fdotr_compute();
}

// F_ij = -(p_i V_i^2 + p_j V_j^2 + Q_ij) grad_i W_ij + laminar viscosity (paper eq. 14),
// antisymmetric between fluid and solid:
//   couple wall  both pressures are the fluid's: the solid is a moving wall to the fluid and
//                takes the reaction
//   couple full  the whole stress of the solid crosses, as in the paper
template <int D> void PairFSIFluid::compute_forces()
{
  constexpr int ROW = row_of_forces(D);
  const int *const type = atom->type, nall = atom->nlocal + atom->nghost;
  // newton off, or a hybrid style with solids that need it, or images, which are no particles: like
  // LAMMPS' own walls they do not count in the virial, and forces times positions would have them
  const bool tally_pairs = vflag_fdotr ? fix_fsi->walls.any() : evflag != 0;
  const bool own_pressure = fix_fsi->surface_ratio > 0.0 || fix_fsi->wall_stiffness;
  const FluidParticles particles = gather<D>(0.0, [&](int i, Point<D> &p) {
    p.p = own_pressure ? fix_fsi->pressure(i) : fix_fsi->state[type[i]].pressure(p.rho);
    p.pv2 = p.p * p.vol * p.vol;
  });

  if (fix_fsi->kept) taken.assign((size_t) row_of_points(D) * nall, 0.0);
  ForceLaws laws = {alpha,
                    beta,
                    laminar,
                    laminar == CENTRAL_LAMINAR ? fix_fsi->central_length_sq : 0.0,
                    extrapolate ? fix_fsi->body_forces.of_type.data() : nullptr,
                    fix_fsi->density_solid == FixFSI::SUMMATION ? 1.0 : 0.0,
                    nullptr,
                    !sticks_to_solids(),
                    FixFSI::rows(fix_fsi->wall_velocity ? fix_fsi->wall_velocity : atom->v),
                    fix_stress ? fix_stress->stress : nullptr,
                    fix_fsi->body_forces.of_type.data(),
                    fix_fsi->kept ? taken.data() : nullptr};
  PairSums sums, *const of_pairs = fix_fsi->kept || tally_pairs ? &sums : nullptr;
  forces.assign((size_t) ROW * nall, 0.0);
  double guarding[NKINDS] = {};
  const auto loop = [&](const Meeting &m, const std::vector<Row> &which,
                        const std::vector<double> &parts_of, const Mirror *mirror, double *total) {
    const double before = sums.guard;
    laws.guard = shares[m.level].guards.data();
    m.of_forces->forces(m.kind, which, mirror, of_rows(particles, m, which, parts_of), laws,
                        forces.data(), total, of_pairs);
    guarding[m.what] += sums.guard - before;
  };
  for (const auto &m : meetings)
    loop(m, near_known && m.what != HIDDEN ? m.near : m.rows.rows, m.visible, nullptr, nullptr);

  const Walls &walls = fix_fsi->walls;
  for_images(walls, particles.points, [&](const Meeting &m, int reflection, const Mirror *mirror) {
    const auto &s = walls.reflections[reflection];
    double total[D] = {};
    loop(m, m.images[reflection].rows, m.visible_images[reflection], mirror, total);
    for (int d = 0; d < D; d++) {
      int w = s.w[0];
      for (int k = 1; k < s.n; k++)
        if (walls.wall[s.w[k]].axis == d) w = s.w[k];
      fix_fsi->add_wall_force(w, d, total[d]);
    }
  });

  split_forces<D>(particles, laws);
  near_known = false;    // a second force evaluation at other positions must not use these lists

  // LAMMPS sends what ghosts have home even without newton_pair, if newton_bond is on
  auto *const f = FixFSI::rows(atom->f);
  for (int i = 0; i < (force->newton_pair ? nall : atom->nlocal); i++)
    for (int d = 0; d < D; d++) f[i][d] += forces[ROW * i + d];
  fix_fsi->tally(FixFSI::ARTIFICIAL, sums.artificial);
  fix_fsi->tally(FixFSI::LAMINAR, sums.laminar);
  fix_fsi->tally(FixFSI::COUPLING, sums.coupling);
  fix_fsi->tally(FixFSI::WALLS, sums.walls);
  fix_fsi->guarding[0] = guarding[WALLS];
  fix_fsi->guarding[1] = guarding[SOLIDS];
  if (tally_pairs && (vflag_global || vflag_fdotr))
    for (int k = 0; k < 6; k++) virial[k] += sums.virial[k];
}

// for those who ask for them, forces of viscosity alone on solids and walls: the same loops without
// pressures, guard and stress
template <int D> void PairFSIFluid::split_forces(const FluidParticles &particles, ForceLaws laws)
{
  if (std::none_of(force_computes.begin(), force_computes.end(), [](const auto *measure) {
        return measure->split;
      }))
    return;
  constexpr int ROW = row_of_forces(D);
  const int nall = atom->nlocal + atom->nghost;
  auto *const point = reinterpret_cast<Point<D> *>(points.data());
  for (int i = 0; i < nall; i++) point[i].p = point[i].pv2 = 0.0;
  const std::vector<Contact> no_guards(atom->ntypes + 1, Contact(D, 0.0));
  laws.guard = no_guards.data();
  laws.extrapolate = laws.gravity = nullptr;
  laws.taken = nullptr;
  laws.stress = nullptr;
  viscous_forces.assign((size_t) ROW * nall, 0.0);
  for (const auto &m : meetings)
    if (m.what == WALLS || m.what == SOLIDS)
      m.of_forces->forces(m.kind, m.rows.rows, nullptr,
                          of_rows(particles, m, m.rows.rows, m.visible), laws,
                          viscous_forces.data(), nullptr, nullptr);
  for_images(fix_fsi->walls, particles.points, [&](const Meeting &m, int k, const Mirror *mirror) {
    double unused[D] = {};
    if (m.what == SOLIDS)
      m.of_forces->forces(m.kind, m.images[k].rows, mirror,
                          of_rows(particles, m, m.rows.rows, m.visible), laws,
                          viscous_forces.data(), unused, nullptr);
  });
  for (auto *measure : force_computes)
    if (measure->split) measure->tally_viscosity(viscous_forces.data(), ROW);
}

bool PairFSIFluid::has_solids() const
{
  for (const auto &m : material)
    if (m.species == SOLID) return true;
  return false;
}

std::vector<PairFSI::Effect> PairFSIFluid::effects() const
{
  auto list = keywords.effects();
  list.push_back({fmt::format("coupling of fluid and solid: {}{}", coupling_names[couple],
                              extrapolate ? ", extrapolated" : ""),
                  "couple", has_solids()});
  if (shifting > 0.0 && shift_every > 1)
    list.push_back({fmt::format("shifted every {} steps", shift_every), "shift/every", true});
  if (fix_fsi && fix_fsi->sight)
    list.push_back(
        {"line of sight: thin bodies hide fluids from each other", "fix fsi thin", true});
  list.push_back({"no slip at solids", "solid/slip no", sticks_to_solids()});
  return list;
}

double PairFSIFluid::memory_usage()
{
  const size_t numbers = points.capacity() + forces.capacity() + viscous_forces.capacity() +
      pressure_over_density.capacity() + sorted_at.capacity() + parts.capacity() +
      part_rates.capacity();
  double bytes = fields.memory_usage() + (double) numbers * sizeof(double) +
      (double) beside.capacity() * sizeof(beside[0]);
  for (const auto &m : meetings) {
    bytes += m.rows.memory_usage() + (double) m.near.capacity() * sizeof(Row) +
        (double) m.visible.capacity() * sizeof(double);
    for (const auto &list_of : m.images) bytes += list_of.memory_usage();
  }
  return bytes;
}
