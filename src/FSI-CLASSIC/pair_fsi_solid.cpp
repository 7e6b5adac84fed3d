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

#include "pair_fsi_solid.h"

#include "atom.h"
#include "domain.h"
#include "error.h"
#include "fix_fsi.h"
#include "fix_fsi_stress.h"
#include "force.h"
#include "fsi_fields.h"
#include "fsi_find.h"
#include "fsi_images.h"
#include "fsi_kernel.h"
#include "fsi_profile.h"
#include "fsi_refusals.h"
#include "fsi_rows.h"
#include "fsi_solid_rows.h"
#include "neigh_list.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

using namespace LAMMPS_NS;
using namespace FSI;

// Supports of the kernel. What was nearer at the start stays one material: a body may be pressed
// together to half its length.
static constexpr double FAR = 2.0;

struct PairFSISolid::Members {
  Fields fields;
  RowList own, others, own_images[2], other_images[2];
  Images images;
  explicit Members(LAMMPS *lmp) : fields(lmp) {}
};

PairFSISolid::PairFSISolid(LAMMPS *lmp) :
    PairFSI(lmp, "fsi/solid"), members(new Members(lmp)), fix_stress(nullptr),
    fields(members->fields), grad(nullptr), any_gradient(false), packs(have_packs()),
    own(members->own), others(members->others), images(members->images),
    own_images(members->own_images), other_images(members->other_images)
{
  artificial_row("solid");
  keywords.key("artificial/stress")
      .number(epsilon, 0.0, Range::from(0.0))
      .effect("artificial stress {}");
  keywords.key("hourglass")
      .number(xi, 0.0, Range::from(0.0))
      .effect("hourglass control of the solid {}");
  contact_row();
  keywords.key("gradient").choice(gradient, PLAIN, {"plain", "corrected", "quadratic"});
}

PairFSISolid::~PairFSISolid() = default;

State PairFSISolid::make_state(const Material &m) const
{
  const auto *const stress = first_of(fixes_of<FixFSIStress>(lmp));
  State s = solid_state(m, stress && stress->plane_stress);
  s.form = UPDATED_LAGRANGIAN;
  return s;
}

void PairFSISolid::init_style()
{
  PairFSI::init_style();
  check_contact();
  fix_stress = first_of(fixes_of<FixFSIStress>(lmp));
  if (!fix_stress) refuse(error, Refused::STRESS);
  bodies = several_bodies();
}

// that of the article's scheme, unless another is given
double PairFSISolid::artificial_stress() const
{
  return epsilon == 0.0 && disc->article ? 0.3 : epsilon;
}

// of loops pair by pair
template <int D> using Single = ChosenKernelOf<D>;
template <int D> auto PairFSISolid::single() const
{
  return Single<D>(disc->kernel, disc->h);
}

// calls f(are pairs packed, kernel, terms of the gradient) with the types and constants that loops
// are compiled for
template <class F> void PairFSISolid::with_loops(F f) const
{
  const auto with = [&](auto dim) {
    constexpr int D = dim();
    const auto with_terms = [&](auto terms) {
      packs ? f(std::true_type(), PackedKernel<D>(disc->kernel, disc->h), terms)
            : f(std::false_type(), single<D>(), terms);
    };
    if (gradient == PLAIN)
      with_terms(std::integral_constant<int, 0>());
    else if (gradient == CORRECTED_QUADRATIC)
      with_terms(std::integral_constant<int, Gradient<D>::NQUADRATIC>());
    else
      with_terms(std::integral_constant<int, D>());
  };
  disc->dim == 2 ? with(std::integral_constant<int, 2>()) : with(std::integral_constant<int, 3>());
}

template <bool PACKED> using Numbers = std::conditional_t<PACKED, Pack, double>;

int PairFSISolid::terms() const
{
  const int dim = domain->dimension;
  return gradient == PLAIN ? 0 : gradient == CORRECTED_LINEAR ? dim : dim * (dim + 3) / 2;
}

void *PairFSISolid::extract(const char *name, int &dim_of_extract)
{
  dim_of_extract = 0;
  if (strcmp(name, "hourglass") != 0) return PairFSI::extract(name, dim_of_extract);
  if (!has_hourglass())    // what it keeps of particles is not there
    error->all(FLERR, "Pair style fsi/solid hourglass is off: begin with a value > 0 to adapt it");
  return &xi;
}

Facts PairFSISolid::facts() const
{
  Facts facts = PairFSI::facts();
  facts.style = Facts::OF_SOLIDS;
  facts.hourglass = xi > 0.0;
  facts.by_rate = true;
  facts.corrected_gradients = gradient != PLAIN;
  return facts;
}

int PairFSISolid::ngrad() const
{
  const int dim = disc->dim, n = terms();
  return n == 0 ? dim * dim : dim * n + 2 * packed_size(n);
}

void PairFSISolid::set_fields(Discretization &)
{
  check_pairs();
  fields.set("velocity gradient", Fields::STEP, true, grad, fours(ngrad()));
}

void PairFSISolid::add_messages(Message &to_ghosts, Message &back)
{
  const int dim = disc->dim;
  to_ghosts.add(fix_stress->stress, 0, dim == 2 ? 3 : 6, {SOLID});
  to_ghosts.add(grad, dim * dim, dim * terms(), {SOLID});
  back.add(grad, 0, ngrad(), {SOLID});
}

void PairFSISolid::find_idle(const Census &all, const Idle &nothing) const
{
  if (all.solids == 0) nothing("Pair style fsi/solid" + named_effects(), "no particle is a solid");
  if (any_relaxes())
    nothing("Prony series of a material",
            "pair_style fsi/solid is elastic or plastic; pair_style fsi/solid/tl law viscoelastic "
            "relaxes");
}

// Pairs count their own virial where F dot r would depend on the place of the box: forces of
// hourglass control are of no pairs, those of planes from outside.
void PairFSISolid::begin_state(bool)
{
  if (neighbor->ago == 0) find_rows();
  if (has_hourglass() || images.planes.any())
    no_virial_fdotr_compute = force->pair->no_virial_fdotr_compute = 1;
}

// Pairs that share their stress, and those that only push: of different bodies and, with contact of
// a body with itself, those of one that were further apart than that at the start.
void PairFSISolid::find_rows()
{
  const tagint *const molecule = atom->molecule;
  const double far = FAR * disc->cut;
  if (self_contact) fix_stress->enter_start(disc->state, *ghosts);
  const auto joined = [=](int i, int j) {
    return molecule[i] == molecule[j] &&
        !(self_contact && fix_stress->distance_at_start(i, j) >= far);
  };
  own.clear();
  others.clear();
  const bool whole = !bodies && !self_contact && !atom->molecular;
  std::vector<int> unmasked;
  for (int ii = 0; ii < list->inum; ii++) {
    const int i = list->ilist[ii], n = list->numneigh[i], *const neighbors = list->firstneigh[i];
    if (whole) {
      own.rows.push_back({i, n, neighbors});
      continue;
    }
    unmasked.resize(n);
    for (int jj = 0; jj < n; jj++) unmasked[jj] = neighbors[jj] & NEIGHMASK;
    own.add(i, unmasked.data(), n, false, false, [=](int j) {
      return joined(i, j);
    });
    if (bodies || self_contact)
      others.add(i, unmasked.data(), n, false, false, [=](int j) {
        return !joined(i, j);
      });
  }
  find_image_rows();
  if (whole) return;
  own.end();
  others.end();
}

// Planes of symmetry (fsi_images.h): particles before them have the images of their neighbors, and
// of themselves. Each pair has one row: what i and the image of j do to each other, j and the image
// of i do, too, mirrored.
void PairFSISolid::find_image_rows()
{
  images.find_planes(step->walls, step->wall_forces);
  images.begin(atom->nlocal + atom->nghost);
  if (!images.planes.any()) return;
  if (update->setupflag) check_planes();
  double **x = atom->x;
  const int *const mask = atom->mask, nlocal = atom->nlocal;
  const double most = disc->cut + neighbor->skin;
  std::vector<int> found[2][2];    // of other bodies, by half
  for (auto *rows : {&own_images, &other_images})
    for (RowList &list_ : *rows) list_.clear();
  for (int ii = 0; ii < list->inum; ii++) {
    const int i = list->ilist[ii], near = images.planes.near(x[i], most);
    if (!near || !images.joins(mask, i)) continue;
    for (auto &of : found) of[0].clear(), of[1].clear();
    const auto add = [&](int j, double rsq, bool half) {
      const bool other = atom->molecule[i] != atom->molecule[j];
      images.planes.images(near & images.planes.near(x[j], most), rsq, x[i], x[j], most * most,
                           [&](const Walls::Reflection &s, double, const double *) {
                             const int bits = s.mask | (half ? Images::HALF : 0);
                             found[other][half].push_back(images.find(j, bits));
                           });
    };
    add(i, 0.0, true);
    for (int jj = 0; jj < list->numneigh[i]; jj++) {
      const int j = list->firstneigh[i][jj] & NEIGHMASK;
      double rsq = 0.0;
      for (int d = 0; d < 3; d++) rsq += (x[i][d] - x[j][d]) * (x[i][d] - x[j][d]);
      if (images.joins(mask, j)) add(j, rsq, !force->newton_pair && j >= nlocal);
    }
    const auto all = [](int) {
      return true;
    };
    for (const int half : {0, 1}) {
      own_images[half].add(i, found[0][half].data(), found[0][half].size(), false, false, all);
      other_images[half].add(i, found[1][half].data(), found[1][half].size(), false, false, all);
    }
  }
  for (auto *rows : {&own_images, &other_images})
    for (RowList &list_ : *rows) list_.end();
  images.give_types(atom->type, types_with_images);
}

void PairFSISolid::check_planes() const
{
  if (self_contact) refuse(error, Refused::SELF_SYMMETRY, style);
  for (int i = 0; i < atom->nlocal; i++) {
    if (material[atom->type[i]].species != SOLID || !images.joins(atom->mask, i)) continue;
    for (const Wall &plane : images.planes.wall)
      if (plane.distance(atom->x[i]) < 0.0)
        error->one(FLERR,
                   "Solid atom {} of body {} is behind the plane of symmetry at {} = {}: expected "
                   "half a spacing before it, or more",
                   atom->tag[i], atom->molecule[i], "xyz"[plane.axis], plane.position);
  }
}

// a matrix of D x n, by rows, whose columns change with these signs
template <int D> static void mirror_matrix(const Mirror &m, int n, const double *columns, double *a)
{
  for (int d = 0; d < D; d++)
    for (int k = 0; k < n; k++) a[d * n + k] *= m.sign[d] * columns[k];
}

template <int D> static void mirror_tensor(const Mirror &m, double *s)
{
  for (int a = 0; a < D; a++)
    for (int b = a; b < D; b++) s[Sym<D>::id(a, b)] *= m.sign[a] * m.sign[b];
}

// what the terms of the gradient's basis change by
template <int D, int TERMS> static void mirror_basis(const Mirror &m, double *signs)
{
  if constexpr (TERMS == 0)
    std::copy_n(m.sign, D, signs);
  else
    gradient_basis<D, TERMS>(m.sign, signs);
}

// images are few: loops over them are pair by pair
template <int D, int TERMS> void PairFSISolid::add_image_gradients(double half)
{
  constexpr int N = GradientSums<D, TERMS>::N, ROW = GradientSums<D, TERMS>::ROW;
  constexpr int COLUMNS = TERMS ? TERMS : D, MOMENTS = packed_size(TERMS);
  image_sums.assign((size_t) ROW * images.end(), 0.0);
  auto *const sums = reinterpret_cast<double(*)[ROW]>(image_sums.data());
  for (const RowList &list_ : own_images)
    gradient_rows<double, Single<D>, TERMS>(list_.rows.data(), list_.rows.size(), single<D>(),
                                            rate_records.data(), half, sums);
  for (int i = 0; i < atom->nlocal + atom->nghost; i++)
    for (int k = 0; k < N; k++) grad[i][k] += sums[i][k];
  images.for_each([&](int k, int of, const Mirror &m, bool counts) {
    if (!counts) return;
    double signs[COLUMNS], *s = sums[k];
    mirror_basis<D, TERMS>(m, signs);
    mirror_matrix<D>(m, COLUMNS, signs, s);
    s += D * COLUMNS;
    for (int of_both = 0; of_both < 2 && TERMS; of_both++)
      for (int a = 0; a < TERMS; a++)
        for (int b = 0; b <= a; b++)
          s[of_both * MOMENTS + packed_size(a) + b] *= signs[a] * signs[b];
    for (int n = 0; n < N; n++) grad[of][n] += sums[k][n];
  });
}

template <int D, int TERMS> void PairFSISolid::add_image_hourglass()
{
  constexpr int ROW = GradientSums<D, TERMS>::ROW;
  const int nall = atom->nlocal + atom->nghost;
  image_sums.assign((size_t) ROW * images.end(), 0.0);
  std::copy_n(grad[0], (size_t) ROW * nall, image_sums.data());
  images.for_each([&](int k, int of, const Mirror &m, bool) {
    std::copy_n(grad[of], D * D, &image_sums[(size_t) ROW * k]);
    mirror_matrix<D>(m, D, m.sign, &image_sums[(size_t) ROW * k]);
  });
  auto *const rate = reinterpret_cast<double(*)[row_of_forces(D)]>(hourglass_rate.data());
  for (const RowList &list_ : own_images)
    hourglass_rows<double, Single<D>, ROW>(list_.rows.data(), list_.rows.size(), single<D>(),
                                           rate_records.data(), image_sums.data(), Hourglass{xi},
                                           rate);
  images.for_each([&](int k, int of, const Mirror &m, bool counts) {
    for (int d = 0; d < D && counts; d++) rate[of][d] += m.sign[d] * rate[k][d];
  });
}

// forces of images are folded when all are there
template <int D, int TERMS, int FLAGS, class Laws>
void PairFSISolid::add_image_forces(Laws laws, const RowList (&lists)[2])
{
  auto *const f = reinterpret_cast<double(*)[row_of_forces(D)]>(forces.data());
  laws.type = types_with_images.data();
  for (const int half : {0, 1}) {
    laws.newton = !half;    // what counts by half, images being no local atoms
    force_rows<double, Single<D>, TERMS, FLAGS>(lists[half].rows.data(), lists[half].rows.size(),
                                                single<D>(), force_records.data(), laws, f);
  }
}

bool PairFSISolid::add_rates(bool advance)
{
  fields.grow();
  any_gradient = advance || terms();
  if (!any_gradient) return false;
  const Phase phase(step->profile, Profile::STRESS);
  const size_t nall = atom->nlocal + atom->nghost;
  if (nall) std::fill_n(grad[0], nall * fours(ngrad()), 0.0);
  velocity_gradient(advance ? update->dt : 0.0);
  return true;
}

void PairFSISolid::advance(bool advance)
{
  if (!any_gradient) return;
  const Phase phase(step->profile, Profile::STRESS);
  const int dim = disc->dim;
  if (terms() == 0)
    dim == 2 ? advance_stress<2, 0>(advance) : advance_stress<3, 0>(advance);
  else if (terms() == dim)
    dim == 2 ? advance_stress<2, 2>(advance) : advance_stress<3, 3>(advance);
  else
    dim == 2 ? advance_stress<2, 5>(advance) : advance_stress<3, 9>(advance);
  if (advance && has_hourglass()) advance_hourglass(update->dt);
}

// the velocity gradient L, and the coefficients of its weights for the forces, from the sums
template <int D, int TERMS> static void fit_gradient(double *L, double inv)
{
  // L = [sum_j w_ij (v_j - v_i)(x)phi_j] C^T
  double C[D * TERMS], force_C[D * TERMS], full[D * D] = {};
  const double *const moments = L + D * TERMS;
  // hardly any neighbors: torn off, no strain, no stress to share
  if (gradient_coefficients<D, TERMS>(moments, C) == Gradient<D>::DEFICIENT)
    std::fill_n(C, D * TERMS, 0.0);
  if (gradient_coefficients<D, TERMS>(moments + packed_size(TERMS), force_C) ==
      Gradient<D>::DEFICIENT)
    std::fill_n(force_C, D * TERMS, 0.0);
  for (int a = 0; a < D; a++)
    for (int b = 0; b < D; b++)
      for (int k = 0; k < TERMS; k++) full[a * D + b] += L[a * TERMS + k] * C[b * TERMS + k];
  for (int k = 0; k < D * D; k++) L[k] = full[k] * inv;
  for (int k = 0; k < D * TERMS; k++) L[D * D + k] = force_C[k] * inv;
}

// velocity gradient L from its sums; stress and, in continuity mode, density from L
template <int D, int TERMS> void PairFSISolid::advance_stress(bool advance)
{
  double *rho = atom->rho;
  const double dt = update->dt + step->dt_offset;
  for (int i = 0; i < atom->nlocal; i++) {
    const State &s = disc->state[atom->type[i]];
    if (s.species != SOLID) continue;
    double *L = grad[i];
    if constexpr (TERMS > 0) fit_gradient<D, TERMS>(L, 1.0 / disc->h);
    if (!advance) continue;
    const double work = fix_stress->advance_stress<D>(i, L, dt, s, ledger->kept);
    if (disc->density_solid == Discretization::CONTINUITY) {
      double div = 0.0;
      for (int a = 0; a < D; a++) div += L[a * D + a];
      // d rho/dt = -rho div v, centered: second order, and positive for any step
      rho[i] *= (1.0 - 0.5 * dt * div) / (1.0 + 0.5 * dt * div);
    }
    if (!ledger->kept) continue;
    // what the strain stores; what the pair forces deliver, with the same stress and velocity, is
    // taken off in force_pairs(): their difference is what the gradient's correction costs
    auto sigma = Sym<D>::load(fix_stress->stress[i]);
    sigma += Sym<D>::identity(-s.pressure(rho[i]));
    double power = 0.0;
    for (int a = 0; a < D; a++)
      for (int b = 0; b < D; b++) power += sigma(a, b) * L[a * D + b];
    ledger->tally(Ledger::GRADIENT, -power * atom->rmass[i] / rho[i]);
    ledger->energy_out[Ledger::INELASTIC] += work * atom->rmass[i] / rho[i];
  }
}

void PairFSISolid::undo_advance()
{
  if (disc->density_solid != Discretization::CONTINUITY) return;
  const double dt = update->dt + step->dt_offset;
  for (int i = 0; i < atom->nlocal; i++) {
    if (disc->state[atom->type[i]].species != SOLID) continue;
    double div = 0.0;
    for (int k = 0; k < disc->dim; k++) div += grad[i][k * (disc->dim + 1)];
    atom->rho[i] *= (1.0 + 0.5 * dt * div) / (1.0 - 0.5 * dt * div);
  }
}

void PairFSISolid::velocity_gradient(double dt)
{
  disc->dim == 2 ? fill_rate_records<2>(0.5 * dt) : fill_rate_records<3>(0.5 * dt);
  if (own.rows.empty() && !images.any()) return;
  with_loops([&](auto packed, const auto &kernel, auto terms) {
    using K = std::decay_t<decltype(kernel)>;
    if (images.any()) add_image_gradients<K::DIM, terms()>(0.5 * dt);
    auto *const sums = reinterpret_cast<double(*)[GradientSums<K::DIM, terms()>::ROW]>(grad[0]);
    run_loop<Numbers<packed()>>([&](auto number) FSI_INLINE_LAMBDA {
      gradient_rows<decltype(number), K, terms()>(own.rows.data(), own.rows.size(), kernel,
                                                  rate_records.data(), 0.5 * dt, sums);
    });
  });
}

template <int D> void PairFSISolid::fill_rate_records(double half)
{
  using At = RateRecord<D>;
  const State *const state = disc->state.data();
  const int nall = atom->nlocal + atom->nghost;
  if (rate_records.size() < (size_t) At::N * images.end())
    rate_records.assign((size_t) At::N * std::max(atom->nmax, images.end()), 0.0);
  for (int i = 0; i < nall; i++) {
    const State &s = state[atom->type[i]];
    if (s.species != SOLID) continue;
    double *const record = &rate_records[(size_t) At::N * i];
    for (int d = 0; d < D; d++) {
      record[At::X + d] = atom->x[i][d] - half * atom->v[i][d];
      record[At::V + d] = atom->v[i][d];
    }
    record[At::VOL] = atom->rmass[i] * s.inv_rho0;
    record[At::SHEAR] = s.shear;
  }
  images.for_each([&](int k, int of, const Mirror &m, bool) {
    double *const record = &rate_records[(size_t) At::N * k];
    std::copy_n(&rate_records[(size_t) At::N * of], (int) At::N, record);
    for (int d = 0; d < D; d++) {
      record[At::X + d] = m.x[d] + m.sign[d] * record[At::X + d];
      record[At::V + d] *= m.sign[d];
    }
  });
}

// hourglass control (fsi_classic_laws.h)
void PairFSISolid::advance_hourglass(double dt)
{
  const int dim = disc->dim;
  Message gradients(lmp, disc->state);
  gradients.add(grad, 0, dim * dim, {SOLID});
  ghosts->send(gradients);
  hourglass_rate.assign((size_t) images.end() * row_of_forces(dim), 0.0);
  if (!own.rows.empty() || images.any())
    with_loops([&](auto packed, const auto &kernel, auto terms) {
      using K = std::decay_t<decltype(kernel)>;
      if (images.any()) add_image_hourglass<K::DIM, terms()>();
      auto *const rate = reinterpret_cast<double(*)[row_of_forces(K::DIM)]>(hourglass_rate.data());
      run_loop<Numbers<packed()>>([&](auto number) FSI_INLINE_LAMBDA {
        hourglass_rows<decltype(number), K, GradientSums<K::DIM, terms()>::ROW>(
            own.rows.data(), own.rows.size(), kernel, rate_records.data(), grad[0], Hourglass{xi},
            rate);
      });
    });
  ghosts->add(hourglass_rate.data(), row_of_forces(dim));
  dim == 2 ? rotate_hourglass<2>(dt) : rotate_hourglass<3>(dt);
}

template <int D> void PairFSISolid::rotate_hourglass(double dt)
{
  for (int i = 0; i < atom->nlocal; i++) {
    if (material[atom->type[i]].species != SOLID) continue;
    double Q[D * D], half_turned[D], turned[D] = {};
    double *const q = fix_stress->hourglass[i],
                  *const rate = &hourglass_rate[(size_t) i * row_of_forces(D)];
    rotation<D>(grad[i], 0.5 * dt, Q);
    for (int a = 0; a < D; a++) {
      half_turned[a] = dt * rate[a];
      for (int b = 0; b < D; b++) half_turned[a] += Q[a * D + b] * q[b];
    }
    for (int a = 0; a < D; a++)
      for (int b = 0; b < D; b++) turned[a] += Q[a * D + b] * half_turned[b];
    std::copy_n(turned, D, q);
  }
}

void PairFSISolid::add_number_density(double *psi, bool all_bodies)
{
  images.update(atom->x);
  double **x = atom->x;
  double **const at = images.positions(atom->x);
  with_kernel(disc->kernel, disc->dim, disc->h, [&](const auto &kernel) {
    const auto add = [&](const RowList &pairs, bool both) {
      for (const Row &row : pairs.rows)
        for (int k = 0; k < row.n; k++) {
          const int i = row.i, j = row.j[k];
          double rsq = 0.0;
          for (int d = 0; d < 3; d++) rsq += (x[i][d] - at[j][d]) * (x[i][d] - at[j][d]);
          if (rsq >= kernel.cutsq) continue;
          const double w = kernel.W(std::sqrt(rsq));
          psi[i] += w;
          if (both) psi[images.original(j)] += w;
        }
    };
    add(own, true);
    if (all_bodies) add(others, true);
    for (auto *lists : {&own_images, &other_images})
      for (const int half : {0, 1})
        if (images.any() && (lists == &own_images || all_bodies)) add((*lists)[half], !half);
  });
}

void PairFSISolid::compute(int eflag, int vflag)
{
  FixFSI::check_pre_no(lmp, disc);
  const Phase phase(step->profile, Profile::SOLID_FORCES);
  ev_init(eflag, vflag);
  check_tally();
  with_loops([&](auto packed, const auto &kernel, auto terms) {
    pair_forces<packed(), terms()>(kernel);
  });
  if (has_hourglass()) {
    double **f = atom->f;
    for (int i = 0; i < atom->nlocal; i++) {
      if (material[atom->type[i]].species != SOLID) continue;
      const double *q = fix_stress->hourglass[i];
      for (int d = 0; d < disc->dim; d++) f[i][d] += q[d];
    }
  }
  if (vflag_fdotr) virial_fdotr_compute();
}

template <int D, int TERMS> void PairFSISolid::fill_force_records()
{
  using At = ForceRecord<D, TERMS>;
  const State *const state = disc->state.data();
  const int nall = atom->nlocal + atom->nghost;
  const ArtificialStress artificial(artificial_stress(), disc->wdx);
  if (force_records.size() < (size_t) At::N * images.end())
    force_records.assign((size_t) At::N * std::max(atom->nmax, images.end()), 0.0);
  for (int i = 0; i < nall; i++) {
    const State &s = state[atom->type[i]];
    if (s.species != SOLID) continue;
    double *const record = &force_records[(size_t) At::N * i];
    const double vol = atom->rmass[i] / atom->rho[i];
    for (int d = 0; d < D; d++) {
      record[At::X + d] = atom->x[i][d];
      record[At::V + d] = atom->v[i][d];
    }
    record[At::VOL] = vol;
    record[At::RHO] = atom->rho[i];
    record[At::SOUND] = s.c;
    auto stress = Sym<D>::load(fix_stress->stress[i]);
    stress += Sym<D>::identity(-pressure_of(i, atom, *disc, *step));
    stress *= vol;
    if (TERMS) {
      stress.store(record + At::STRESS);
      record[At::VOL0] = atom->rmass[i] * s.inv_rho0;
      std::copy_n(grad[i] + D * D, D * TERMS, record + At::FIT);
    }
    stress *= vol;
    if (!TERMS) stress.store(record + At::STRESS);
    if (artificial_stress() > 0.0) artificial(stress).store(record + At::ARTIFICIAL);
  }
  images.for_each([&](int k, int of, const Mirror &m, bool) {
    double *const record = &force_records[(size_t) At::N * k], signs[TERMS ? TERMS : D];
    std::copy_n(&force_records[(size_t) At::N * of], (int) At::N, record);
    for (int d = 0; d < D; d++) {
      record[At::X + d] = m.x[d] + m.sign[d] * record[At::X + d];
      record[At::V + d] *= m.sign[d];
    }
    mirror_tensor<D>(m, record + At::STRESS);
    mirror_tensor<D>(m, record + At::ARTIFICIAL);
    mirror_basis<D, TERMS>(m, signs);
    mirror_matrix<D>(m, TERMS, signs, record + At::FIT);
  });
}

// of one body, with or without sums of powers
template <bool PACKED, int TERMS, class K>
void PairFSISolid::own_forces(const K &kernel, const PairLaws &laws, bool sums)
{
  using namespace SolidFlag;
  constexpr int D = K::DIM, ALL = VISCOSITY | STRESS | SUMS;
  auto *const of_rows = reinterpret_cast<double(*)[row_of_forces(D)]>(forces.data());
  // pairs one by one with all effects, packs with viscosity: what is off has coefficients of zero
  const int named = (artificial_stress() > 0.0 ? STRESS : 0) | (sums ? SUMS : 0) | VISCOSITY;
  if (images.any()) add_image_forces<D, TERMS, ALL>(laws, own_images);
  with_flags<ALL>(PACKED ? named : ALL, [&](auto flags) {
    if constexpr (PACKED ? flags() & VISCOSITY : flags() == ALL) {
      run_loop<Numbers<PACKED>>([&](auto number) FSI_INLINE_LAMBDA {
        force_rows<decltype(number), K, TERMS, flags()>(own.rows.data(), own.rows.size(), kernel,
                                                        force_records.data(), laws, of_rows);
      });
    }
  });
}

template <bool PACKED, int TERMS, class K> void PairFSISolid::pair_forces(const K &kernel)
{
  constexpr int D = K::DIM, ROW = row_of_forces(D),
                BETWEEN = SolidFlag::CONTACT | SolidFlag::VISCOSITY | SolidFlag::SUMS;
  const int nall = atom->nlocal + atom->nghost;
  const bool newton = force->newton_pair, tally_pairs = evflag && !vflag_fdotr;    // newton off
  fill_force_records<D, TERMS>();
  forces.assign((size_t) ROW * images.end(), 0.0);
  auto *const of_rows = reinterpret_cast<double(*)[ROW]>(forces.data());
  SolidSums sums;
  const PairLaws laws = {ArtificialViscosity(alpha, beta, disc->h),
                         ArtificialStress(artificial_stress(), disc->wdx),
                         Contact(D, disc->dx, contact_range),
                         atom->type,
                         disc->state.data(),
                         atom->nlocal,
                         newton,
                         &sums};
  own_forces<PACKED, TERMS>(kernel, laws, ledger->kept || tally_pairs);
  if (!others.rows.empty())
    force_rows<double, Single<D>, TERMS, BETWEEN>(others.rows.data(), others.rows.size(),
                                                  single<D>(), force_records.data(), laws, of_rows);
  if (images.any()) {
    add_image_forces<D, TERMS, BETWEEN>(laws, other_images);
    images.fold<D>(of_rows, 1.0);
  }

  double **const f = atom->f;
  for (int i = 0; i < (newton ? nall : atom->nlocal); i++)
    for (int d = 0; d < D; d++) f[i][d] += of_rows[i][d];
  ledger->tally(Ledger::STRESS, sums.stress);
  ledger->tally(Ledger::GRADIENT, sums.gradient);
  ledger->tally(Ledger::ARTIFICIAL, sums.viscosity);
  if (tally_pairs && vflag_global)
    for (int k = 0; k < 6; k++) virial[k] += sums.virial[k];
}

std::vector<PairFSI::Effect> PairFSISolid::effects() const
{
  static const char *const orders[] = {"plain", "exact for linear fields",
                                       "exact for quadratic fields"};
  auto list = keywords.effects();
  list.insert(
      list.begin(),
      {fmt::format("updated-Lagrangian solid, gradients {}", orders[gradient]), "gradient", true});
  return list;
}

double PairFSISolid::memory_usage()
{
  return fields.memory_usage() + own.memory_usage() + others.memory_usage() +
      bytes_of(rate_records, force_records, forces, hourglass_rate);
}
