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

#include "pair_fsi_solid_tl.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix_fsi.h"
#include "fix_fsi_reference.h"
#include "fix_fsi_stress.h"
#include "force.h"
#include "fsi_bond_rows.h"
#include "fsi_changes.h"
#include "fsi_check.h"
#include "fsi_clamps.h"
#include "fsi_damage.h"
#include "fsi_fields.h"
#include "fsi_find.h"
#include "fsi_gather.h"
#include "fsi_images.h"
#include "fsi_law_list.h"
#include "fsi_pair_laws.h"
#include "fsi_profile.h"
#include "fsi_refusals.h"
#include "fsi_self_contact.h"
#include "fsi_tensor.h"
#include "fsi_volumetric.h"
#include "math_extra.h"
#include "memory.h"
#include "modify.h"
#include "neigh_list.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

using namespace LAMMPS_NS;
using namespace FSI;

static constexpr double TOUCHES = 0.96;    // of the square of contact's range: no round-off
static constexpr double SMOOTH = 1.9;      // range from which on faces are no rows of balls

struct PairFSISolidTL::Members {
  SolidLaws laws;
  VolumetricStrain smoothed;
};

PairFSISolidTL::PairFSISolidTL(LAMMPS *lmp) :
    PairFSI(lmp, "fsi/solid/tl"), members(new Members), laws(members->laws),
    smoothed(members->smoothed)
{
  no_virial_fdotr_compute = 1;
  artificial_row("solid");
  keywords.key("hourglass")
      .number(zeta, 0.05, Range::from(0.0))
      .effect("hourglass control of the solid {}");
  keywords.key("law").choice(law, 0, SolidLaws::names());
  keywords.key("plane").choice(plane_stress, 0, {"strain", "stress"});
  keywords.key("gradient").choice(linear, 0, {"quadratic", "linear"});
  keywords.key("volumes").choice(plain, 0, {"corrected", "plain"});
  keywords.key("volumetric").choice(volumetric, AUTO, {"auto", "smoothed", "local"});
  contact_row();
  keywords.key("damage")
      .number(damage, 0.0, Range::from(0.0), "strain")
      .effect("damage at strain {}");

  // bonds find their partners by atom ID. Not later than here: fix balance keeps, from when it is
  // defined, whether there is a map to clear
  if (atom->map_style != Atom::MAP_NONE) return;
  if (!modify->get_fix_by_style("^balance").empty()) refuse(error, Refused::BALANCE);
  if (domain->box_exist) {
    atom->map_init();
    atom->map_set();
  } else
    atom->map_style = Atom::MAP_YES;
}

PairFSISolidTL::~PairFSISolidTL()
{
  memory->destroy(fsolid);    // the reference stays with its atoms, for the next pair_style
}

void PairFSISolidTL::check_settings()
{
  laws.choose(law);
  if (plane_stress && !laws.facts().plane_stress) {
    std::string known;
    for (const LawFacts &l : SolidLaws::all)
      if (l.plane_stress) known += (known.empty() ? "" : " or ") + std::string(l.name);
    refuse(error, Refused::PLANE_LAW, known);
  }
  if (volumetric != SMOOTHED) return;
  if (plane_stress) refuse(error, Refused::SMOOTHED_PLANE);
  if (damage > 0.0) refuse(error, Refused::SMOOTHED_DAMAGE);
}

State PairFSISolidTL::make_state(const Material &m) const
{
  State s = solid_state(m, plane_stress);
  s.form = TOTAL_LAGRANGIAN;
  return s;
}

void PairFSISolidTL::init_style()
{
  PairFSI::init_style();
  auto *const fix_fsi = FixFSI::find(lmp, style)->link(clamps, check);
  check_contact();
  const int dim = disc->dim;
  if (plane_stress && dim == 3) refuse(error, Refused::PLANE_3D);
  const auto pairs = pairs_of<PairFSI>(lmp);
  if (std::any_of(pairs.begin(), pairs.end(), [](const PairFSI *p) {
        return p->facts().style == Facts::OF_SOLIDS;
      }))
    refuse(error, Refused::TWO_SOLIDS);
  refuse_constraints();
  Fix *fix = modify->get_fix_by_id(FixFSIReference::ID);
  if (!fix) fix_fsi->changes.check_file();
  make_laws();
  if (!fix) fix = modify->add_fix(fmt::format("{} all FSI_REFERENCE", FixFSIReference::ID));
  reference = dynamic_cast<FixFSIReference *>(fix);
  reference->quadratic = !linear;
  reference->end_corrected = !plain;
  reference->self.range = self_contact ? contact_range : 0.0;
  reference->self.tears = damage > 0.0;
  reference->self.range_of_images = contact_range;
  follow_law();
  comm_forward = 2 * dim;
  comm_reverse = dim;

  contacts.clear();
  for (const auto &a : disc->resolution)
    for (const auto &b : disc->resolution)
      contacts.emplace_back(dim, spacing_between(a, b), contact_range);

  changes_seen = -1;
}

void PairFSISolidTL::make_laws()
{
  smoothed = VolumetricStrain();
  for (const auto &m : material)
    smoothed.modulus.push_back(is_smoothed(m) ? VolumetricStrain::excess(m) : 0.0);
  const auto none = [](double k) {
    return k == 0.0;
  };
  if (std::all_of(smoothed.modulus.begin(), smoothed.modulus.end(), none)) smoothed.modulus.clear();
  laws.choose(law);
  laws.make(material, smoothed.modulus, plane_stress);
  fix_history = FixFSIHistory::keep(lmp, laws.facts().history, laws.columns(disc->dim));
  fix_stress = laws.facts().by_rate ? first_of(fixes_of<FixFSIStress>(lmp)) : nullptr;
  if (!laws.facts().by_rate) return;
  if (!fix_stress) refuse(error, Refused::LAW_STRESS, laws.facts().name);
  if (fix_stress->plane_stress == plane_stress) return;
  refuse(error, Refused::PLANE_OF_STRESS, laws.facts().name, plane_stress ? "stress" : "strain");
}

// Bodies that have strain keep it from one law to the next: rates know nothing of what was before,
// and strains of what has flowed.
void PairFSISolidTL::follow_law()
{
  const std::string now = laws.facts().by_rate ? "rates" : "strains";
  std::string &before = reference->stressed_by;
  if (!before.empty() && before != now && reference->any() && comm->me == 0)
    error->warning(
        FLERR,
        laws.facts().by_rate
            ? "Pair style fsi/solid/tl law {}: the shear stress of its bodies is forgotten"
            : "Pair style fsi/solid/tl law {}: the stress of fix fsi/stress is forgotten",
        laws.facts().name);
  before = now;
}

const double *const *PairFSISolidTL::history() const
{
  return fix_history ? fix_history->of : fix_stress ? fix_stress->stress : nullptr;
}

// With sub-steps forces inside the solid come after all fixes have seen those from outside. What
// adds to these, as fix addforce, is right; what sets or projects the whole force is not.
void PairFSISolidTL::refuse_constraints() const
{
  static const char *const styles[] = {"setforce",        "aveforce", "lineforce",
                                       "planeforce",      "freeze",   "manifoldforce",
                                       "damping/cundall", "shake",    "rattle"};
  if (!step->takes_substeps(lmp)) return;
  int moved = disc->mover->groupbit;    // in sub-steps
  for (const auto &fix : modify->get_fix_by_style("^rigid")) moved |= fix->groupbit;
  for (auto &fix : modify->get_fix_list())
    for (const char *style : styles) {
      const std::string name = style;
      if (fix->style != name && !utils::strmatch(fix->style, "^" + name + "/")) continue;
      const auto held = find_particles(atom, world, [&](int i) {
        return material[atom->type[i]].species == SOLID && atom->mask[i] & moved &&
            atom->mask[i] & fix->groupbit;
      });
      if (held.count)
        refuse(error, Refused::CONSTRAINED, fix->id, fix->style, held.first, disc->mover->id);
    }
}

// A part of an elastic body that another style than fix rigid or rigid/small moves by forces is
// kicked once in a step, by forces that the sub-steps do not see: a beam with a rigid tip gains
// energy. (Fix fsi/move looks for itself; of fix move nobody can see what it leaves free.)
void PairFSISolidTL::refuse_other_parts() const
{
  for (auto &fix : modify->get_fix_list()) {
    if (!fix->time_integrate || clamps->known(fix) || utils::strmatch(fix->style, "^fsi") ||
        utils::strmatch(fix->style, "^move$") || utils::strmatch(fix->style, "noforce$"))
      continue;
    for (const BondRow &row : rows) {
      const auto elastic = [&](int i) {
        return atom->mask[i] & disc->mover->groupbit;
      };
      if (elastic(row.i) && std::any_of(row.partner, row.partner + row.n, [&](int k) {
            const int j = reference->images.original(k);
            return !elastic(j) && atom->mask[j] & fix->groupbit;
          }))
        error->one(
            FLERR,
            "Fix {} (style {}) moves a part of the elastic body of atom {}, which takes "
            "sub-steps: the part would gain energy. Expected fix rigid or rigid/small, which take "
            "them, too, substeps 1 in fix fsi, or fix fsi/move if its motion is known",
            fix->id, fix->style, atom->tag[row.i]);
    }
  }
}

// with sub-steps the forces act inside fix fsi's last half of the step, not here; but in setup
// forces, energy and virial are seen
void PairFSISolidTL::compute(int eflag, int vflag)
{
  FixFSI::check_pre_no(lmp, disc);
  const Phase phase(step->profile, Profile::SOLID_FORCES);
  ev_init(eflag, vflag);
  check_tally();
  warn_of_contact();
  if (step->substeps > 1 && !update->setupflag)
    return reference->images.update(atom->x);    // for fix fsi/watch
  internal_forces();
  add_forces();
}

void PairFSISolidTL::add_forces()
{
  double **f = atom->f;
  for (const int i : reference->solids)
    for (int d = 0; d < disc->dim; d++) f[i][d] += fsolid[i][d];
}

template <class Call> auto PairFSISolidTL::with_law(Call call) const
{
  return laws([&](const auto *law_of) {
    if (disc->dim == 2) return call(law_of, std::integral_constant<int, 2>());
    return call(law_of, std::integral_constant<int, 3>());
  });
}

void PairFSISolidTL::internal_forces()
{
  disc->dim == 2 ? gather_points<2>() : gather_points<3>();
  const double volumetric_energy = smoothed.on() ? smooth_strains(false) : 0.0;
  with_law([&](const auto *law_of, auto dimension) {
    bond_forces<std::decay_t<decltype(*law_of)>, decltype(dimension)::value>(law_of);
  });
  strain_energy += volumetric_energy;
  if (list) disc->dim == 2 ? contact_forces<2>() : contact_forces<3>();
  if (reference->images.planes.any() && fsolid) {
    // in sub-steps, which add up to the force of a step
    const double part = update->setupflag ? 1.0 : 1.0 / step->substeps;
    disc->dim == 2 ? fold_images<2>(part) : fold_images<3>(part);
  }
  if (!reference->self.pairs.empty())
    disc->dim == 2 ? self_contact_forces<2>() : self_contact_forces<3>();
  reference->swaps.reverse<Pair>(step->profile, this);
}

void PairFSISolidTL::find_rows()
{
  const int *const type = atom->type, *const mask = atom->mask, groupbit = disc->mover->groupbit;
  changes_seen = reference->changes;
  // of partners, too: a border of ranks may part two materials
  one_material = true;
  if (!reference->solids.empty()) {
    const State &first = disc->state[type[reference->solids[0]]];
    for (const auto *set : {&reference->solids, &reference->ghosts})
      for (const int i : *set) {
        const State &s = disc->state[type[i]];
        one_material = one_material && s.rho0 == first.rho0 && s.c == first.c;
      }
  }
  const Images &images = reference->images;
  if (images.any()) images.give_types(type, types_with_images);
  rows.clear();
  for (const int i : reference->solids) {
    const State &s = disc->state[type[i]];
    if (!reference->bears(i)) continue;    // torn off, crushed
    rows.push_back({i, reference->count(i), reference->partners(i), reference->numbers(i),
                    reference->moments(i), atom->rmass[i] / s.rho0 * reference->weight(i),
                    zeta * material[type[i]].young, disc->h_of(type[i])});
  }
  if (step->substeps > 1 || (update->setupflag && step->takes_substeps(lmp))) refuse_other_parts();
  // forces among what does not are in balance, but for those across planes of symmetry
  const auto moves = [&](const BondRow &row) {
    return mask[row.i] & groupbit || std::any_of(row.partner, row.partner + row.n, [&](int j) {
             const int of = images.original(j);
             return of != j || mask[of] & groupbit;
           });
  };
  nmoving = std::stable_partition(rows.begin(), rows.end(), moves) - rows.begin();
}

void PairFSISolidTL::over_rows(int n, double *to, int, BondSums &sums, const RowLoop &loop)
{
  loop(0, n, to, sums);
}

// points, and forces of zero
template <int D> void PairFSISolidTL::gather_points()
{
  constexpr int NP = row_of_points(D);
  Images &images = reference->images;
  const int size = images.any() ? std::max(atom->nmax, images.end()) : atom->nmax;
  if (size > nmax) {
    nmax = size;
    memory->destroy(fsolid);
    memory->create(fsolid, nmax, row_of_forces(disc->dim), "pair:fsolid");
  }
  const auto *const x = vectors(atom->x), *const v = vectors(atom->v);
  if (points.size() < (size_t) NP * nmax) points.assign((size_t) NP * nmax, 0.0);
  for (const auto *set : {&reference->solids, &reference->ghosts})
    for (const int i : *set)
      for (int d = 0; d < D; d++) {
        points[NP * i + d] = x[i][d];
        points[NP * i + D + d] = v[i][d];
        fsolid[i][d] = 0.0;
      }
  if (images.any()) {
    images.update(atom->x);
    images.for_each([&](int k, int of, const Mirror &m, bool) {
      for (int d = 0; d < D; d++) {
        points[NP * k + d] = m.x[d] + m.sign[d] * points[NP * of + d];
        points[NP * k + D + d] = m.sign[d] * points[NP * of + D + d];
        fsolid[k][d] = 0.0;
      }
    });
  }
  if (changes_seen == reference->changes) return;
  find_rows();
  if (!smoothed.on()) return;
  const int *const type = types();
  const int *const mask = atom->mask, groupbit = disc->mover->groupbit;
  smoothed.find_weights<D>(
      rows, type,
      [=](int i) {
        return mask[i] & groupbit;
      },
      [&](int i, int j) {
        const Material &a = material[type[i]], &b = material[type[j]];
        return a.young == b.young && a.poisson == b.poisson;
      },
      [&](int t) {
        return disc->resolution[t].cut;
      });
}

// nearly incompressible solids (fsi_volumetric.h). Strains of all rows, also of those whose forces
// are not wanted now: that of a held particle may count for one that moves.
bool PairFSISolidTL::is_smoothed(const Material &m) const
{
  if (m.species != SOLID || volumetric == LOCAL || plane_stress || damage > 0.0) return false;
  return volumetric == SMOOTHED || m.poisson > VolumetricStrain::LOCKS_ABOVE + 1.0e-9;
}

double PairFSISolidTL::smooth_strains(bool of_all)
{
  double energy = 0.0;
  const Images &images = reference->images;
  smoothed.resize(nmax);
  sends_strains = true;
  with_law([&](const auto *law_of, auto dimension) {
    using L = std::decay_t<decltype(*law_of)>;
    constexpr int D = decltype(dimension)::value;
    BondSums sums;
    over_rows(rows.size(), nullptr, 0, sums, [&](int first, int last, double *, BondSums &) {
      const auto find = [&](auto number) FSI_INLINE_LAMBDA {
        find_volumetric_strains<decltype(number), L, D>(rows, first, last, atom->type,
                                                        points.data(), smoothed);
      };
      run_widest(find);
    });
    reference->swaps.forward<Pair>(step->profile, this, 1);
    for (const auto *set : {&reference->solids, &reference->ghosts})
      for (const int i : *set) smoothed.force[i] = 0.0;
    images.for_each([&](int k, int of, const Mirror &, bool) {
      smoothed.strain[k] = smoothed.strain[of];
      smoothed.force[k] = 0.0;
    });
    over_rows(rows.size(), smoothed.force.data(), 1, sums,
              [&](int first, int last, double *to, BondSums &of_part) {
                const auto smooth = [&](auto number) FSI_INLINE_LAMBDA {
                  of_part.energy += smooth_volumetric_strains<decltype(number), L>(
                      rows, first, last, of_all, smoothed, to);
                };
                run_widest(smooth);
              });
    energy = sums.energy;
    images.for_each([&](int k, int of, const Mirror &, bool) {
      smoothed.force[of] += smoothed.force[k];
    });
    reference->swaps.reverse<Pair>(step->profile, this, 1);
  });
  sends_strains = false;
  return energy;
}

// fsi_bond_rows.h
template <class L, int D> void PairFSISolidTL::bond_forces(const L *law_of)
{
  using namespace BondFlag;
  constexpr int ALL = HOURGLASS | VISCOSITY | SUMS;
  const int *const type = types();
  const State *const state = disc->state.data();
  const int nrows = only_moving ? nmoving : (int) rows.size();
  BondSums sums;
  const double *const volumetric_forces = smoothed.on() ? smoothed.force.data() : nullptr;
  const BondArguments in = {points.data(), type, state,        history(), volumetric_forces,
                            alpha,         beta, one_material, nullptr};
  // with sums, or one by one, there is one loop for all effects: those that are off have
  // coefficients of zero
  const bool packs = have_packs() && (one_material || !has_artificial());
  const int named = (zeta > 0.0 ? HOURGLASS : 0) | (has_artificial() ? VISCOSITY : 0);
  const auto part = [&](int first, int last, double *to, BondSums &of_part) {
    BondArguments own = in;
    own.sums = &of_part;
    auto *const f = reinterpret_cast<double(*)[row_of_forces(D)]>(to);
    with_flags<ALL>(ledger->kept || vflag_global || !packs ? ALL : named, [&](auto which) {
      if constexpr (!(which() & SUMS) || which() == ALL) {
        const auto loop = [&](auto number) FSI_INLINE_LAMBDA {
          bond_rows<decltype(number), L, D, which()>(rows.data() + first, last - first, law_of, own,
                                                     f);
        };
        if (packs) return run_loop<Pack>(loop);
        if constexpr (which() == ALL) run_loop<double>(loop);
      }
    });
  };
  over_rows(nrows, fsolid ? fsolid[0] : nullptr, row_of_forces(D), sums, part);
  strain_energy = sums.energy;
  // fragments of a body that damage tears have few bonds, whose F may be anything
  if (sums.inverted >= 0 && damage == 0.0) {
    step->inverted = sums.inverted;
    step->inverted_density = state[type[sums.inverted]].rho0 / volume_ratio(sums.inverted);
  }
  ledger->tally(Ledger::ARTIFICIAL, sums.artificial);
  if (vflag_global)
    for (int k = 0; k < 6; k++) virial[k] += sums.virial[k];
}

// planes of symmetry (fsi_images.h)

// of atoms and images
const int *PairFSISolidTL::types() const
{
  return reference->images.any() ? types_with_images.data() : atom->type;
}

// Also bodies that meet across a plane: i and the image of j, and what this does to j; and those
// that meet their own image, which each particle sees for itself
template <int D> void PairFSISolidTL::fold_images(double part)
{
  const Images &images = reference->images;
  const SelfContact &self = reference->self;
  images.fold<D>(reinterpret_cast<double(*)[row_of_forces(D)]>(fsolid[0]), part);
  const int *const mask = atom->mask;
  const tagint *const molecule = atom->molecule;
  const double most = contact_range * disc->largest_cut;
  for (const auto &[i, j] : self.image_pairs)
    meet_images<D>(i, j, most, false, part, [&, i = i](const Walls::Reflection &s) {
      return !self.goes_on(molecule[i], s.mask);
    });
  for (int ii = 0; list && ii < list->inum; ii++) {
    const int i = list->ilist[ii];
    if (!images.joins(mask, i) || !images.planes.near(atom->x[i], most)) continue;
    for (int jj = 0; jj < list->numneigh[i]; jj++) {
      const int j = list->firstneigh[i][jj] & NEIGHMASK;
      if (molecule[i] == molecule[j] || !images.joins(mask, j)) continue;
      // without newton the other rank does its own
      meet_images<D>(i, j, most, force->newton_pair || j < atom->nlocal, part,
                     [](const Walls::Reflection &) {
                       return true;
                     });
    }
  }
}

// the images that count, of what is so near to planes at most
template <int D, class Counts>
void PairFSISolidTL::meet_images(int i, int j, double most, bool both, double part, Counts counts)
{
  const Walls &planes = reference->images.planes;
  double **x = atom->x, rsq = 0.0;
  const double reachsq = contacts[atom->type[i] * (atom->ntypes + 1) + atom->type[j]].reachsq;
  for (int d = 0; d < D; d++) rsq += (x[i][d] - x[j][d]) * (x[i][d] - x[j][d]);
  if (rsq >= reachsq) return;
  planes.images(planes.near(x[i], most) & planes.near(x[j], most), rsq, x[i], x[j], reachsq,
                [&](const Walls::Reflection &s, double image_rsq, const double *xij) {
                  if (counts(s)) push_image<D>(i, j, s, image_rsq, xij, both, part);
                });
}

template <int D>
void PairFSISolidTL::push_image(int i, int j, const Walls::Reflection &s, double rsq,
                                const double *xij, bool both, double part)
{
  const Images &images = reference->images;
  const Contact &contact = contacts[atom->type[i] * (atom->ntypes + 1) + atom->type[j]];
  const State &si = disc->state[atom->type[i]], &sj = disc->state[atom->type[j]];
  const double Ki = si.csq * si.rho0, Kj = sj.csq * sj.rho0, f = contact(rsq, Ki, Kj);
  const Mirror mirror(images.planes, s);
  for (int d = 0; d < D; d++) {
    fsolid[i][d] += f * xij[d];
    if (both) fsolid[j][d] -= f * mirror.sign[d] * xij[d];
  }
  for (int k = 0; k < s.n; k++) {
    const int d = images.planes.wall[s.w[k]].axis;
    images.forces[s.w[k]][d] -= part * (both ? 2.0 : 1.0) * f * xij[d];
  }
  strain_energy += (both ? 1.0 : 0.5) * contact.energy(rsq, Ki, Kj);
}

// Bodies whose faces are rows of balls have touched: what slides is held by them.
void PairFSISolidTL::warn_of_contact()
{
  static constexpr int EVERY = 20;    // steps between two looks
  if (contact_warned || !list || contact_range > SMOOTH || update->ntimestep % EVERY) return;
  const auto least = of_least(touch[1] ? double(touch[0]) : HUGE_VAL, touch, world);
  contact_warned = least[1] != 0;
  if (contact_warned && comm->me == 0)
    error->warning(
        FLERR,
        "Pair style fsi/solid/tl: bodies {} and {} touch. With contact {:g} faces are as "
        "bumpy as rows of balls, which hold a body that slides by up to half of its "
        "load: take contact 2.5 for those, and begin as many spacings apart",
        least[0], least[1], contact_range);
}

// particles of different bodies (fsi_pair_laws.h)
template <int D> void PairFSISolidTL::contact_forces()
{
  const bool looks = !contact_warned && contact_range <= SMOOTH;
  double **x = atom->x;
  const int *const type = atom->type;
  const tagint *const molecule = atom->molecule;
  const int ntypes = atom->ntypes, nlocal = atom->nlocal;
  const bool newton = force->newton_pair;
  for (int ii = 0; ii < list->inum; ii++) {
    const int i = list->ilist[ii];
    for (int jj = 0; jj < list->numneigh[i]; jj++) {
      const int j = list->firstneigh[i][jj] & NEIGHMASK;
      if (molecule[i] == molecule[j]) continue;
      double xij[D], rsq = 0.0;
      for (int d = 0; d < D; d++) {
        xij[d] = x[i][d] - x[j][d];
        rsq += xij[d] * xij[d];
      }
      const Contact &contact = contacts[type[i] * (ntypes + 1) + type[j]];
      if (rsq >= contact.reachsq) continue;
      if (looks && rsq < TOUCHES * contact.reachsq &&
          ((atom->mask[i] | atom->mask[j]) & disc->mover->groupbit))
        touch = {std::min(molecule[i], molecule[j]), std::max(molecule[i], molecule[j])};
      // without newton the other rank does its own particle
      push<D>(i, j, xij, rsq, contact, newton || j < nlocal ? 1.0 : 0.0);
    }
  }
}

// A pair of a body without a bond is seen from both sides, each of which counts half.
template <int D> void PairFSISolidTL::self_contact_forces()
{
  double **x = atom->x;
  const int *const type = atom->type;
  for (const auto &pair : reference->self.pairs) {
    double xij[D], rsq = 0.0;
    for (int d = 0; d < D; d++) {
      xij[d] = x[pair.i][d] - x[pair.j][d];
      rsq += xij[d] * xij[d];
    }
    if (rsq >= pair.reach * pair.reach || (pair.torn && reference->bonded(pair.i, pair.j)))
      continue;
    push<D>(pair.i, pair.j, xij, rsq,
            contacts[type[pair.i] * (atom->ntypes + 1) + type[pair.j]].within(pair.reach), 0.5);
  }
}

// share: of the force, which both get; 0: all of it, but for i alone, and half of energy and virial
template <int D>
void PairFSISolidTL::push(int i, int j, const double *xij, double rsq, const Contact &contact,
                          double share)
{
  const State &si = disc->state[atom->type[i]], &sj = disc->state[atom->type[j]];
  const double Ki = si.csq * si.rho0, Kj = sj.csq * sj.rho0, part = share > 0.0 ? share : 0.5;
  const double f = contact(rsq, Ki, Kj), of_i = share > 0.0 ? share * f : f;
  for (int d = 0; d < D; d++) {
    fsolid[i][d] += of_i * xij[d];
    if (share > 0.0) fsolid[j][d] -= of_i * xij[d];
  }
  if (vflag_global)
    add_virial<D>(
        [&](int a, int b) {
          return part * f * xij[a] * xij[b];
        },
        virial);
  strain_energy += part * contact.energy(rsq, Ki, Kj);
}

template <int D> void PairFSISolidTL::deformation(int i, double *F) const
{
  double **x = reference->images.positions(atom->x), u[D];
  BondRow row = {};
  row.numbers = reference->numbers(i);
  std::fill_n(F, D * D, 0.0);
  for (int k = 0; k < reference->count(i); k++) {
    const double *const xj = x[reference->partners(i)[k]];
    for (int a = 0; a < D; a++) u[a] = xj[a] - x[i][a];
    deform<double, D>(row, k, u, F);
  }
}

// dt: of this step or sub-step; since: the middle of the last one
void PairFSISolidTL::advance_stress(double dt, double since)
{
  if (!history()) return;
  const Phase phase(step->profile, Profile::STRESS);
  with_law([&](const auto *law_of, auto dimension) {
    using L = std::decay_t<decltype(*law_of)>;
    constexpr int D = decltype(dimension)::value;
    if constexpr (L::BY_RATE)
      advance_rates<D>(dt, since);
    else if constexpr (!L::HISTORY.empty())
      advance_history<L, D>(law_of, since);
  });
}

template <class L, int D> void PairFSISolidTL::advance_history(const L *law_of, double dt)
{
  std::vector<decltype(law_of->factors(dt))> factors;    // per type
  for (int t = 0; t <= atom->ntypes; t++) factors.push_back(law_of[t].factors(dt));
  gather_points<D>();
  BondSums sums;    // energy: dissipated
  over_rows(rows.size(), nullptr, 0, sums, [&](int first, int last, double *, BondSums &of_part) {
    double dissipated = 0.0;
    const auto loop = [&](auto number) FSI_INLINE_LAMBDA {
      for (int r = first; r < last; r++) {
        const BondRow &row = rows[r];
        const int t = atom->type[row.i];
        double F[D * D];
        deform_row<decltype(number), D, false>(row, points.data(), F);
        dissipated +=
            row.volume * law_of[t].template advance<D>(F, factors[t], fix_history->of[row.i]);
      }
    };
    run_widest(loop);
    of_part.energy += dissipated;
  });
  if (ledger->kept) ledger->energy_out[Ledger::INELASTIC] += sums.energy;
}

// L = F' F^-1 at the time of the velocities, half a step before the positions
template <int D> void PairFSISolidTL::advance_rates(double dt, double since)
{
  gather_points<D>();
  const auto loop = [&](auto number) FSI_INLINE_LAMBDA {
    for (const BondRow &row : rows) {
      const int i = row.i;
      double F[D * D], Fdot[D * D], C[D * D], L[D * D] = {};
      deform_row<decltype(number), D, true>(row, points.data(), F, Fdot);
      for (int k = 0; k < D * D; k++) F[k] -= 0.5 * dt * Fdot[k];
      cofactor<D>(F, C);
      const double inv = 1.0 / determinant<D>(F);
      for (int a = 0; a < D; a++)
        for (int c = 0; c < D; c++)
          for (int k = 0; k < D; k++) L[a * D + c] += Fdot[a * D + k] * C[c * D + k] * inv;
      const State &s = disc->state[atom->type[i]];
      const double work = fix_stress->advance_stress<D>(i, L, since, s, ledger->kept);
      if (ledger->kept)
        ledger->energy_out[Ledger::INELASTIC] += work * row.volume * determinant<D>(F);
    }
  };
  run_widest(loop);
}

void PairFSISolidTL::break_bonds()
{
  if (damage <= 0.0) return;
  const Phase phase(step->profile, Profile::STRESS);
  // a fragment with few bonds may be turned inside out, where no law holds
  reference->damage.break_bonds(
      1.0 + damage,
      [this](int i) {
        return std::max(0.0, stored(i));
      },
      [this](int i) {
        return disc->dim == 2 ? spare<2>(i) : spare<3>(i);
      });
}

// How far the partners of i can move, relative to it, before det F is below CRUSHED. With
// |dF| <= d = motion sum |G|: |d det F| <= (|F| + d)^D - |F|^D, the terms of order 1 to D in d.
template <int D> double PairFSISolidTL::spare(int i) const
{
  double F[D * D], norm = 0.0, gradients = 0.0;
  deformation<D>(i, F);
  for (const double value : F) norm += value * value;
  norm = std::sqrt(norm);
  for (int k = 0; k < reference->count(i); k++) {
    const double *const G = reference->bond(i, k);
    double sum = 0.0;
    for (int a = 0; a < D; a++) sum += G[a * BOND_BLOCK] * G[a * BOND_BLOCK];
    gradients += std::sqrt(sum);
  }
  const double left = determinant<D>(F) - CRUSHED,
               power = D == 2 ? norm * norm : norm * norm * norm;
  if (left <= 0.0) return 0.0;
  const double most = D == 2 ? std::sqrt(power + left) : std::cbrt(power + left);
  return (most - norm) / gradients;
}

// elastic energy per reference volume
double PairFSISolidTL::stored(int i) const
{
  if (!reference->bears(i)) return 0.0;
  return with_law([&](const auto *law_of, auto dimension) {
    constexpr int D = decltype(dimension)::value;
    double F[D * D];
    deformation<D>(i, F);
    const double *const own = history() ? history()[i] : nullptr;
    return law_of[atom->type[i]].template operator()<D>(F, own).energy;
  });
}

int PairFSISolidTL::bonds(int i) const
{
  return reference->count(i);
}

double PairFSISolidTL::volume_ratio(int i) const
{
  if (!reference->bears(i)) return 1.0;
  double F[9];
  if (disc->dim == 2) {
    deformation<2>(i, F);
    return determinant<2>(F);
  }
  deformation<3>(i, F);
  return determinant<3>(F);
}

// Cauchy stress: P F^T/J
void PairFSISolidTL::begin_stress()
{
  forward_positions();    // ghosts still stand where they were in the middle of the step
  reference->images.update(atom->x);
  if (!smoothed.on()) return;
  disc->dim == 2 ? gather_points<2>() : gather_points<3>();
  smooth_strains(true);
}

// that of the smoothed strain at i itself: right for linear ones, to the face
template <class L, int D>
void PairFSISolidTL::add_smoothed(int i, const double *F, PiolaStress<D> &piola) const
{
  double dm[D * D];
  L::template volumetric_strain<D>(F, dm);
  const double p = smoothed.modulus[atom->type[i]] * L::volumetric_slope(smoothed.mean[i]);
  for (int k = 0; k < D * D; k++) piola.P[k] += p * dm[k];
  piola.zz += p;
}

PairFSISolidTL::Stress PairFSISolidTL::stress(int i) const
{
  static constexpr int voigt[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
  Stress s = {};
  s.J = 1.0;
  if (!reference->bears(i)) return s;
  with_law([&](const auto *law_of, auto dimension) {
    using L = std::decay_t<decltype(*law_of)>;
    constexpr int D = decltype(dimension)::value;
    double F[D * D];
    deformation<D>(i, F);
    const double *const own = history() ? history()[i] : nullptr;
    PiolaStress<D> piola = law_of[atom->type[i]].template operator()<D>(F, own);
    s.J = determinant<D>(F);
    if (smoothed.on()) add_smoothed<L, D>(i, F, piola);
    for (int a = 0; a < D; a++)
      for (int c = a; c < D; c++) {
        double sum = 0.0;
        for (int k = 0; k < D; k++) sum += piola.P[a * D + k] * F[c * D + k];
        s.sigma[voigt[a][c]] = sum / s.J;
      }
    if (D == 2) s.sigma[2] = piola.zz / s.J;
  });
  return s;
}

// of a message: solids among the atoms listed, or n from first on
template <class Visit>
void PairFSISolidTL::for_solids(int n, const int *listed, int first, Visit visit) const
{
  for (int k = 0; k < n; k++) {
    const int i = listed ? listed[k] : first + k;
    if (material[atom->type[i]].species == SOLID) visit(i);
  }
}

// Ghosts: positions (and velocities) out, forces back; of solids only. Fix adapt may give viscosity
// to a style that began without.
void PairFSISolidTL::forward_positions()
{
  sends_velocities = has_artificial() || laws.facts().by_rate;
  reference->swaps.forward<Pair>(step->profile, this, sends_velocities ? comm_forward : disc->dim);
}

int PairFSISolidTL::pack_forward_comm(int n, int *listed, double *buf, int pbc_flag, int *pbc)
{
  const int dim = disc->dim;
  const double shift[3] = {pbc_flag ? pbc[0] * domain->xprd : 0.0,
                           pbc_flag ? pbc[1] * domain->yprd : 0.0,
                           pbc_flag ? pbc[2] * domain->zprd : 0.0};
  double *const begin = buf;
  for_solids(n, listed, 0, [&](int i) {
    if (sends_strains) return void(*buf++ = smoothed.strain[i]);
    for (int d = 0; d < dim; d++) *buf++ = atom->x[i][d] + shift[d];
    if (sends_velocities) buf = std::copy_n(atom->v[i], dim, buf);
  });
  return buf - begin;
}

void PairFSISolidTL::unpack_forward_comm(int n, int first, double *buf)
{
  const int dim = disc->dim;
  for_solids(n, nullptr, first, [&](int i) {
    if (sends_strains) return void(smoothed.strain[i] = *buf++);
    for (int d = 0; d < dim; d++) atom->x[i][d] = *buf++;
    for (int d = 0; sends_velocities && d < dim; d++) atom->v[i][d] = *buf++;
  });
}

int PairFSISolidTL::pack_reverse_comm(int n, int first, double *buf)
{
  double *const begin = buf;
  for_solids(n, nullptr, first, [&](int i) {
    if (sends_strains) return void(*buf++ = smoothed.force[i]);
    buf = std::copy_n(fsolid[i], comm_reverse, buf);
  });
  return buf - begin;
}

void PairFSISolidTL::unpack_reverse_comm(int n, int *listed, double *buf)
{
  for_solids(n, listed, 0, [&](int i) {
    if (sends_strains) return void(smoothed.force[i] += *buf++);
    for (int d = 0; d < comm_reverse; d++) fsolid[i][d] += *buf++;
  });
}

// Fluid resists a change w of the velocity of solids within the step by -Z w, here implicit. It has
// the reaction afterwards (theory.rst).
class PairFSISolidTL::Wet {
  struct Particle {
    int i;
    double implicit[3][3], v[3], w[3];    // (1 + t Z/m)^-1, velocity at the start
  };
  std::vector<Particle> all;

 public:
  double taken = 0.0;    // energy
  Wet(const StepState &step, const Atom *atom, const std::vector<int> &moving, double t)
  {
    if (step.impedance[0].empty()) return;
    for (const int i : moving) {
      Particle p = {i, {}, {atom->v[i][0], atom->v[i][1], atom->v[i][2]}, {}};
      double m[3][3];
      for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
          m[a][b] = (a == b) + t / atom->rmass[i] * step.impedance[Sym<3>::id(a, b)][i];
      if (m[0][0] + m[1][1] + m[2][2] == 3.0) continue;    // dry
      MathExtra::invert3(m, p.implicit);
      all.push_back(p);
    }
  }
  void kick(StepState &step, const Atom *atom)
  {
    for (Particle &p : all) {
      double *const v = atom->v[p.i], free[3], w[3];
      MathExtra::sub3(v, p.v, free);
      MathExtra::matvec(p.implicit, free, w);
      for (int d = 0; d < 3; d++) {
        taken += atom->rmass[p.i] * (free[d] - w[d]) * (p.v[d] + 0.5 * (p.w[d] + w[d]));
        step.swerve[d][p.i] += w[d] / step.substeps;
        p.w[d] = w[d];
        v[d] = p.v[d] + w[d];
      }
    }
  }
};

// Solids in sub-steps: what moves, what is held, and what of this another fix moves, since bodies
// would be shaken in the rhythm of the steps else.
class PairFSISolidTL::Moved : protected Pointers {
  const int dim;
  Profile *const profile;
  std::vector<int> held;
  std::vector<std::pair<int, std::array<double, 3>>> carried;    // where they are in the middle

 public:
  std::vector<int> moving;
  Moved(LAMMPS *lmp, const Discretization &disc, const StepState &step, const Clamps &clamps,
        const std::vector<int> &solids) :
      Pointers(lmp),
      dim(disc.dim), profile(step.profile)
  {
    double **x = atom->x;
    for (const int i : solids)
      if (atom->mask[i] & disc.mover->groupbit)
        moving.push_back(i);
      else if (!clamps.has(i)) {
        if (profile) held.push_back(i);
        if (MathExtra::lensq3(atom->v[i]) > 0.0)
          carried.push_back({i, {x[i][0], x[i][1], x[i][2]}});
      }
  }
  void drift(double t) const
  {
    double **x = atom->x, **v = atom->v;
    for (const int i : moving)
      for (int d = 0; d < dim; d++) x[i][d] += t * v[i][d];
  }
  void carry(double t) const
  {
    for (const auto &[i, middle] : carried)
      for (int d = 0; d < dim; d++) atom->x[i][d] = middle[d] + t * atom->v[i][d];
  }
  void kick(double dt, const double *const *inside) const
  {
    double **v = atom->v, **f = atom->f;
    for (const int i : moving) {
      const double dtfm = dt * force->ftm2v / atom->rmass[i];
      for (int d = 0; d < dim; d++) v[i][d] += dtfm * (f[i][d] + inside[i][d]);
    }
  }
  void hold(double t, const double *const *inside) const
  {
    for (const int i : held)
      for (int d = 0; d < dim; d++) profile->impulse_held[d] += t * inside[i][d];
  }
};

// Stiff solids: from the state at the start of the step on, position Verlet with a step that
// many times shorter. What acts on them from outside (f: fluid, gravity, ...), taken at the
// middle of the step, is held: what the fluid has lost in momentum, the solid gains, to
// round-off.
void PairFSISolidTL::integrate_substeps()
{
  const Phase phase(step->profile, Profile::SOLID_FORCES);
  const int substeps = step->substeps;
  const double dt = update->dt / substeps, dth = 0.5 * dt, back = -0.5 * update->dt;
  const bool clamped = clamps->any_elastic();
  const std::vector<int> &solids = reference->solids;
  if (clamped) clamps->begin_substeps(solids);
  const Moved all(lmp, *disc, *step, *clamps, solids);
  Wet wet(*step, atom, all.moving, dt * force->ftm2v);
  ledger->set_tally(dt);
  check->before_substeps(solids);
  only_moving = !ledger->kept;
  all.drift(back);
  for (int n = 0; n < substeps; n++) {
    if (n + 1 == substeps) only_moving = false;
    all.drift(dth);
    all.carry(back + n * dt + dth);
    if (clamped) clamps->drift(dth);
    forward_positions();
    advance_stress(dt, n ? dt : dt + step->substep_offset);
    std::fill_n(virial, 6, 0.0);
    internal_forces();
    all.kick(dt, fsolid);
    wet.kick(*step, atom);
    all.hold(dt, fsolid);
    all.drift(dth);
    if (!clamped) continue;
    clamps->kick(dt, fsolid);
    clamps->drift(dth);
  }
  all.carry(0.0);
  check->after_substeps();
  all.hold(-update->dt, fsolid);    // that of the last one is in f from here on
  if (clamped) clamps->average(substeps, fsolid);
  // what is seen from outside: the whole force and its virial, which a hybrid style has summed up
  // already
  if (force->pair != this)
    for (int k = 0; k < 6; k++) force->pair->virial[k] += virial[k];
  add_forces();
  if (ledger->kept) ledger->energy_out[Ledger::COUPLING] += wet.taken / force->ftm2v;
  if (clamped) clamps->finish();
}

void PairFSISolidTL::advance(bool advance)
{
  if (!advance) return;
  break_bonds();
  if (step->substeps == 1) advance_stress(update->dt, update->dt + step->substep_offset);
}

Facts PairFSISolidTL::facts() const
{
  Facts facts = PairFSI::facts();
  facts.style = Facts::OF_TOTAL_LAGRANGIAN_SOLIDS;
  facts.keeps_solids = reference != nullptr;
  facts.by_rate = laws.facts().by_rate;
  return facts;
}

void PairFSISolidTL::find_idle(const Census &all, const Idle &nothing) const
{
  if (all.solids == 0)
    nothing("Pair style fsi/solid/tl" + named_effects(), "no particle is a solid");
  else if (volumetric == SMOOTHED && !smoothed.on())
    nothing("Pair style fsi/solid/tl volumetric smoothed",
            fmt::format("no Poisson's ratio is above {}", VolumetricStrain::LOCAL));
  const bool relaxes = any_relaxes();
  if (relaxes != !laws.facts().history.empty())
    nothing(relaxes ? "Prony series of a material" : "Pair style fsi/solid/tl law viscoelastic",
            relaxes ? "pair_style fsi/solid/tl has another law" : "no material has a Prony series");
}

std::vector<PairFSI::Effect> PairFSISolidTL::effects() const
{
  auto list = keywords.effects();
  list.insert(list.begin(),
              {fmt::format("total-Lagrangian solid, {}, gradients exact for {} fields",
                           laws.facts().title, linear ? "linear" : "quadratic"),
               fmt::format("law {}", laws.facts().name), true});
  if (smoothed.on())
    list.push_back(
        {"smoothed volumetric strain of nearly incompressible solids", "volumetric", true});
  if (disc && clamps->any_elastic())
    list.push_back({"sub-steps of rigid parts of solids, with fix rigid", "substeps", true});
  return list;
}

double PairFSISolidTL::memory_usage()
{
  return (double) nmax * row_of_forces(domain->dimension) * sizeof(double) +
      bytes_of(points, rows) + smoothed.memory_usage();
}
