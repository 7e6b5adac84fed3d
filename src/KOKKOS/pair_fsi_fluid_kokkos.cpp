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

#include "fsi_fluid_kokkos.h"    // first: says what functions for a device are

#include "pair_fsi_fluid_kokkos.h"

#include "atom_kokkos.h"
#include "atom_masks.h"
#include "compute_fsi_force.h"
#include "error.h"
#include "fix_fsi.h"
#include "force.h"
#include "fsi_pair_sets.h"
#include "fsi_profile.h"
#include "neigh_request.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace FSI;

static constexpr uint64_t READ = X_MASK | V_MASK | TYPE_MASK | RMASS_MASK | DPDRHO_MASK;

struct PairFSIFluidKokkos::Members {
  DeviceArray<double> points, rate, pressure_over_density, friction, gravity;
  DeviceArray<int> near_walls;
  DeviceArray<State> state;
  DeviceArray<Wall> walls, dividing;
  DeviceArray<Reflection> reflections;
  DeviceArray<Mirror> mirrors;
  std::vector<Mirror> mirrors_here;
};

PairFSIFluidKokkos::PairFSIFluidKokkos(LAMMPS *lmp) : PairFSIFluid(lmp), kk(new Members)
{
  kokkosable = 1;
  execution_space = Device;
  datamask_read = datamask_modify = EMPTY_MASK;    // compute() says what it takes
  no_virial_fdotr_compute = 1;                     // ghosts have no forces
}

PairFSIFluidKokkos::~PairFSIFluidKokkos() = default;

void PairFSIFluidKokkos::refuse_others() const
{
  const struct {
    bool so;
    const char *what;
  } refused[] = {
      {force->pair != this, "a hybrid pair style"},
      {lmp->atom->style_match("hybrid") != nullptr, "a hybrid atom style"},
      {disc->density_fluid != Discretization::CONTINUITY, "fix fsi fluid summation"},
      {disc->article != 0, "fix fsi scheme article"},
      {disc->has_levels(), "fluids of several spacings"},
      {disc->has_thin(), "fix fsi thin"},
      {shifting > 0.0, "keyword shift"},
      {surfaces != 0, "keyword density/surface"},
      {surface_ratio > 0.0, "keyword surface"},
      {implicit != 0, "keyword laminar/implicit"},
      {eddies > 0.0, "keyword smagorinsky"},
      {!force_computes.empty(), "compute fsi/force"},
  };
  for (const auto &r : refused)
    if (r.so)
      error->all(FLERR, "Pair style fsi/fluid/kk does not support {}: use it without suffix kk",
                 r.what);
  for (int t = 1; t <= atom->ntypes; t++) {
    const Material &m = material[t];
    if (m.species != FLUID)
      error->all(FLERR,
                 "Pair style fsi/fluid/kk supports fluids only, atom type {} is {}: use it without "
                 "suffix kk",
                 t,
                 m.species == SOLID       ? "a solid"
                     : m.species == RIGID ? "a wall"
                                          : "none");
    if (laminar && m.law.varies())
      error->all(FLERR,
                 "Pair style fsi/fluid/kk does not support a viscosity that varies, as that of "
                 "fluid {}: use it without suffix kk",
                 m.name);
  }
}

void PairFSIFluidKokkos::init_style()
{
  PairFSIFluid::init_style();
  pairs.elsewhere = "Pair style fsi/fluid/kk";
  refuse_others();
  if (!step->device)
    error->all(FLERR, "Pair style fsi/fluid/kk requires fix fsi/kk, which suffix kk takes");
  auto *const request = neighbor->find_request(this);
  request->set_kokkos_host(false);
  request->set_kokkos_device(true);
  request->enable_full();
}

AtomArrays PairFSIFluidKokkos::arrays() const
{
  auto *const atomKK = static_cast<AtomKokkos *>(atom);
  return {atomKK->k_x.view_device(), atomKK->k_v.view_device(), atomKK->k_rmass.view_device(),
          atomKK->k_rho.view_device(), atomKK->k_type.view_device()};
}

// the rows and lists of the plain style are not made
void PairFSIFluidKokkos::begin_state(bool)
{
  step->shifts = false;
  if (neighbor->ago == 0) kk->state = {};    // what others have entered since
}

// Positions are those of the middle of the step, walls where they are then
void PairFSIFluidKokkos::find_near_walls()
{
  auto *const atomKK = static_cast<AtomKokkos *>(atom);
  atomKK->sync(Device, X_MASK);
  const auto &walls = step->walls.wall;
  const int nall = atom->nlocal + atom->nghost;
  to_device(walls.data(), walls.size(), kk->dividing);
  to_device(step->walls.reflections.data(), step->walls.reflections.size(), kk->reflections);
  grow(kk->near_walls, nall);
  if (walls.empty()) return;
  const FindNearWalls find = {arrays(),
                              {kk->dividing.data(), static_cast<int>(walls.size())},
                              disc->cut,
                              kk->near_walls.data()};
  Kokkos::parallel_for(Kokkos::RangePolicy<LMPDeviceType>(0, nall), find);
}

FluidParticles PairFSIFluidKokkos::particles_on_device() const
{
  FluidParticles in;
  in.points = kk->points.data();
  in.type = static_cast<AtomKokkos *>(atom)->k_type.view_device().data();
  in.state = kk->state.data();
  in.nlocal = atom->nlocal;
  in.newton = true;    // no pair is shared with another rank: each has its own side
  return in;
}

void PairFSIFluidKokkos::set_meetings(Meetings &m, const Walls &walls)
{
  auto *const lists = static_cast<NeighListKokkos<LMPDeviceType> *>(list);
  m.ilist = lists->d_ilist;
  m.numneigh = lists->d_numneigh;
  m.neighbors = lists->d_neighbors;
  const int nwalls = walls.wall.size(), n = walls.reflections.size();
  kk->mirrors_here.clear();
  for (const auto &s : walls.reflections) kk->mirrors_here.emplace_back(walls, s);
  to_device(kk->mirrors_here.data(), n, kk->mirrors);
  to_device(walls.wall.data(), nwalls, kk->walls);
  m.images = {nwalls ? kk->near_walls.data() : nullptr,
              {kk->walls.data(), nwalls},
              kk->reflections.data(),
              kk->mirrors.data(),
              n,
              walls.finite(),
              arrays().x,
              {kk->dividing.data(), nwalls},
              disc->cut * disc->cut};
}

template <int D, bool OF_RATES> void PairFSIFluidKokkos::gather(double t)
{
  const int nall = atom->nlocal + atom->nghost;
  auto *const atomKK = static_cast<AtomKokkos *>(atom);
  atomKK->sync(Device, READ);
  grow(kk->points, nall * sizeof(Point<D>) / sizeof(double));
  if (kk->state.extent(0) == 0) to_device(disc->state.data(), disc->state.size(), kk->state);
  const auto &of_type = step->body_forces.of_type;
  to_device(of_type.data()->data(), 3 * of_type.size(), kk->gravity);
  const bool powers = OF_RATES && ledger->kept;
  if (powers) grow(kk->pressure_over_density, nall);
  const Gather<D, OF_RATES> to_points = {arrays(),
                                         reinterpret_cast<Point<D> *>(kk->points.data()),
                                         kk->state.data(),
                                         kk->gravity.data(),
                                         t,
                                         delta,
                                         powers ? kk->pressure_over_density.data() : nullptr};
  Kokkos::parallel_for(Kokkos::RangePolicy<LMPDeviceType>(0, nall), to_points);
}

bool PairFSIFluidKokkos::add_rates(bool advance)
{
  find_near_walls();
  grow(kk->rate, atom->nmax);
  if (!advance) return false;
  const Phase phase(step->profile, Profile::DENSITY);
  with_kernel(disc->kernel, disc->dim, disc->h, [this](const auto &kernel) {
    find_rates(kernel);
  });
  return false;    // ghosts have none
}

template <class K> void PairFSIFluidKokkos::find_rates(const K &kernel)
{
  const double dth = 0.5 * update->dt;
  gather<K::DIM, true>(-dth);
  const auto run = [&](auto loop) {
    set_meetings(loop, step->walls.moved(-dth));
    loop.in = particles_on_device();
    loop.laws.delta = delta;
    loop.laws.pressure_over_density = kk->pressure_over_density.data();
    loop.rate = kk->rate.data();
    return loop;
  };
  const Kokkos::RangePolicy<LMPDeviceType> all(0, list->inum);
  if (!ledger->kept) return Kokkos::parallel_for(all, run(RateLoop<K, false>(kernel)));
  double power = 0.0;
  Kokkos::parallel_reduce(all, run(RateLoop<K, true>(kernel)), power);
  ledger->tally(Ledger::DIFFUSION, power);
}

namespace {
struct Advance {
  AtomArrays atoms;
  const State *state;
  double dt, *rate;
  KOKKOS_FUNCTION void operator()(int i) const
  {
    atoms.rho(i) = next_density(atoms.rho(i), atoms.rmass(i), state[atoms.type(i)].w0, dt, rate[i]);
  }
};
}    // namespace

void PairFSIFluidKokkos::advance(bool advance)
{
  if (!advance) return;
  const Phase phase(step->profile, Profile::DENSITY);
  auto *const atomKK = static_cast<AtomKokkos *>(atom);
  atomKK->sync(Device, DPDRHO_MASK | RMASS_MASK | TYPE_MASK);
  const Advance next = {arrays(), kk->state.data(), update->dt + step->dt_offset, kk->rate.data()};
  Kokkos::parallel_for(Kokkos::RangePolicy<LMPDeviceType>(0, atom->nlocal), next);
  atomKK->modified(Device, DPDRHO_MASK);
}

void PairFSIFluidKokkos::compute(int eflag, int vflag)
{
  FixFSI::check_pre_no(lmp, disc);
  const Phase phase(step->profile, Profile::FLUID_FORCES);
  ev_init(eflag, vflag, 0);
  check_tally();
  with_kernel(disc->kernel, disc->dim, disc->h, [this](const auto &kernel) {
    find_forces(kernel, evflag != 0);
  });
}

template <class K> void PairFSIFluidKokkos::find_forces(const K &kernel, bool tally)
{
  gather<K::DIM, false>(0.0);
  const int nwalls = step->walls.wall.size();
  std::vector<double> sums(ForceLoop<K, true>::NPOWERS + 3 * nwalls, 0.0);
  if (ledger->kept || tally)
    run_forces<K, true>(kernel, sums.data(), sums.size());
  else
    run_forces<K, false>(kernel, sums.data(), nwalls ? sums.size() : 0);
  using Of = ForceLoop<K, true>;
  for (int w = 0; w < nwalls; w++)
    for (int d = 0; d < 3; d++) step->add_wall_force(w, d, sums[Of::NPOWERS + 3 * w + d]);
  ledger->tally(Ledger::ARTIFICIAL, sums[Of::ARTIFICIAL]);
  ledger->tally(Ledger::LAMINAR, sums[Of::LAMINAR]);
  ledger->tally(Ledger::WALLS, sums[Of::WALLS]);
  if (tally && vflag_global)
    for (int k = 0; k < 6; k++) virial[k] += sums[Of::VIRIAL + k];
}

// nsums: 0 if there are none
template <class K, bool SUMS>
void PairFSIFluidKokkos::run_forces(const K &kernel, double *sums, int nsums)
{
  auto *const atomKK = static_cast<AtomKokkos *>(atom);
  ForceLoop<K, SUMS> loop(kernel);
  set_meetings(loop, step->walls);
  loop.in = particles_on_device();
  loop.laws = laws_of_forces();
  if (ledger->kept) grow(kk->friction, K::DIM * atom->nlocal);
  loop.friction = ledger->kept ? kk->friction.data() : nullptr;
  // pointers to the host's arrays, of what is not here or is elsewhere
  loop.laws.gravity = reinterpret_cast<const std::array<double, 3> *>(kk->gravity.data());
  loop.laws.extrapolate = nullptr;
  loop.laws.wall_velocity = nullptr;
  loop.laws.viscosity = nullptr;
  loop.laws.stress = nullptr;
  loop.laws.taken = nullptr;
  loop.value_count = nsums;
  atomKK->sync(Device, F_MASK);
  loop.f = atomKK->k_f.view_device();
  const Kokkos::RangePolicy<LMPDeviceType> all(0, list->inum);
  if (nsums)
    Kokkos::parallel_reduce(all, loop, HostArray<double>(sums, nsums));
  else
    Kokkos::parallel_for(all, loop);
  atomKK->modified(Device, F_MASK);
}

// the ledger's corrections are found on the host, from what forces have read and left
void PairFSIFluidKokkos::react()
{
  if (!ledger->kept) return;
  step->device->to_host();
  const int dim = disc->dim, nlocal = atom->nlocal, nall = nlocal + atom->nghost;
  const size_t row = dim == 2 ? sizeof(Point<2>) : sizeof(Point<3>);
  const int width = dim == 2 ? row_of_points(2) : row_of_points(3);
  points.resize(atom->nmax * row / sizeof(double));
  to_host(kk->points, nall * row / sizeof(double), points.data());
  std::vector<double> friction(dim * nlocal);
  to_host(kk->friction, friction.size(), friction.data());
  taken.assign((size_t) width * nall, 0.0);
  for (int i = 0; i < nlocal; i++) std::copy_n(&friction[dim * i], dim, &taken[width * i + dim]);
  PairFSIFluid::react();
}

void PairFSIFluidKokkos::undo_advance()
{
  to_host(kk->rate, atom->nlocal, rate);
  PairFSIFluid::undo_advance();
}

double PairFSIFluidKokkos::memory_usage()
{
  const size_t numbers = kk->points.extent(0) + kk->rate.extent(0) +
      kk->pressure_over_density.extent(0) + kk->friction.extent(0);
  return PairFSIFluid::memory_usage() + (double) numbers * sizeof(double) +
      (double) kk->near_walls.extent(0) * sizeof(int);
}
