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

#include "fsi_announce.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix.h"
#include "fix_fsi_dt.h"
#include "fsi_cells.h"
#include "fsi_find.h"
#include "fsi_gather.h"
#include "fsi_limits.h"
#include "fsi_part.h"
#include "fsi_scene.h"
#include "fsi_sight.h"
#include "group.h"
#include "modify.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <set>
#include <utility>
#include <vector>

using namespace LAMMPS_NS;
using namespace FSI;

static constexpr double BIG = 1.0e300;
static constexpr double SAME_PLACE = 1.0e-3;    // of the spacing

namespace {

class Adviser : protected Pointers {
 public:
  Adviser(LAMMPS *lmp, const Scene &scene) :
      Pointers(lmp), scene(scene), fluids(facts_of_fluids(lmp)), solids(facts_of_solids(lmp)),
      present(atom->ntypes + 1, 0)
  {
    std::vector<int> mine(present.size(), 0);
    for (int i = 0; i < atom->nlocal; i++)
      if (fluid(i) || moves(i)) mine[atom->type[i]] = 1;    // what is held limits nothing
    MPI_Allreduce(mine.data(), present.data(), (int) mine.size(), MPI_INT, MPI_MAX, world);
  }

  void all() const
  {
    units();
    box();
    const auto ours = [this](int i) {
      return has_material(i);
    };
    const Cells cells(atom->x, atom->nlocal + atom->nghost, scene.dim, 1.25 * coarsest(), ours);
    if (spacing(cells) && solids.style) {
      if (update->ntimestep == 0) contact(solids.contact);
      cut_by_walls();
      yields();
    }
    held();
    excluded();
    if (fluids.style) {
      nothing_acts();
      torn_streams();
      speeds();
      if (scene.has_levels()) levels();
      if (update->ntimestep == 0) {
        seen_through();
        shallow();
      }
    }
    weightless();
    if (fixes_of<FixFSIDt>(lmp).empty()) time_step();
  }

 private:
  const Scene &scene;
  const Facts fluids, solids;    // of their pair styles
  std::vector<int> present;      // types that are fluid or move, on any rank

  double dx(int i) const { return scene.dx_of(atom->type[i]); }
  double coarsest() const
  {
    double most = 0.0;
    for (size_t t = 1; t < scene.resolution.size(); t++) most = std::max(most, scene.dx_of(t));
    return most;
  }
  bool has_material(int i) const { return scene.state[atom->type[i]].species != NONE; }
  bool fluid(int i) const { return scene.state[atom->type[i]].species == FLUID; }
  bool solid(int i) const { return scene.state[atom->type[i]].species == SOLID; }
  bool moves(int i) const { return solid(i) && atom->mask[i] & scene.mover->groupbit; }

  bool weighs(int i) const
  {
    const auto g = scene.body_forces.on(i);
    return g[0] != 0.0 || g[1] != 0.0 || g[2] != 0.0;
  }
  bool goes(int i) const
  {
    const double *const v = atom->v[i];
    return v[0] != 0.0 || v[1] != 0.0 || v[2] != 0.0;
  }

  template <class Is> Found find(Is is) const { return find_particles(atom, world, is); }

  void warn(const std::string &text) const
  {
    if (comm->me == 0) error->warning(FLERR, "Fix fsi: " + text);
  }

  /* a density that no material has in the units of the script, or a solid softer than jelly */

  void units() const
  {
    const bool si = strcmp(update->unit_style, "si") == 0;
    double water = si ? 1000.0 : 0.0;    // 0: units are not those of continua
    for (const char *style : {"cgs", "micro", "nano"})
      if (strcmp(update->unit_style, style) == 0) water = 1.0;
    for (int t = 1; t <= atom->ntypes; t++) {
      if (!present[t] || water == 0.0) continue;
      const State &s = scene.state[t];
      if (s.rho0 < 1.0e-4 * water || s.rho0 > 30.0 * water)
        warn(fmt::format("the density {:g} of type {} is that of no material in units {}, in which "
                         "water has {:g}",
                         s.rho0, t, update->unit_style, water));
      else if (si && s.species == SOLID && longitudinal(s) < 1.0)
        warn(fmt::format(
            "elastic waves in type {} run at {:.2g} m/s only: moduli are in pascal, 1 MPa = 1e6", t,
            longitudinal(s)));
    }
  }

  static double longitudinal(const State &s) { return std::sqrt(s.wave_speed_sq()); }

  void box() const
  {
    for (int d = 0; d < scene.dim; d++)
      if (domain->periodicity[d] && domain->prd[d] < 2.0 * scene.cut)
        warn(fmt::format("the periodic box is {:g} long in {}, less than twice the kernel's "
                         "support {:g}: particles see the same "
                         "neighbor on both sides",
                         domain->prd[d], "xyz"[d], scene.cut));
  }

  /* the particles' distance is the spacing that they were said to have (returned), and nobody sits
   * on somebody else */

  bool spacing(const Cells &cells) const
  {
    double mine[3] = {0.0, 0.0, 0.0}, sum[3];    // distances, particles that have a neighbor, all
    struct {
      double r;
      tagint a, b;
      int around;    // direction in which they meet around the box, or -1
    } closest = {BIG, 0, 0, -1};
    std::vector<double> of_bodies(atom->nlocal, 0);    // particles of bodies and walls beside
    for (int i = 0; i < atom->nlocal; i++) {
      if (!has_material(i)) continue;
      double nearest = 1.25 * 1.25;    // over the spacing between the two lattices
      int who = -1;
      cells.around(atom->x[i], [&](int j, double rsq) {
        const double apart = 0.5 * (dx(i) + dx(j));
        if (fluid(i) && !fluid(j) && rsq < 1.25 * 1.25 * apart * apart)    // of finer ones more
          of_bodies[i] += std::pow(std::min(1.0, dx(j) / apart), scene.dim);
        if (j == i || rsq >= nearest * apart * apart) return;
        nearest = rsq / (apart * apart);
        who = j;
      });
      mine[2]++;
      if (who < 0) continue;
      const double r = std::sqrt(nearest);
      if (r < SAME_PLACE && (fluid(i) || solid(i)))
        error->one(FLERR,
                   "Fix fsi: atoms {} and {} are at the same place, {:g} {:g} {:g}: were they "
                   "created twice? delete_atoms overlap",
                   atom->tag[i], atom->tag[who], atom->x[i][0], atom->x[i][1], atom->x[i][2]);
      mine[0] += r;
      mine[1]++;
      const bool both_walls = !fluid(i) && !solid(i) && !fluid(who) && !solid(who);
      if (r < closest.r && !both_walls)    // walls may cross
        closest = {r, std::min(atom->tag[i], atom->tag[who]),
                   std::max(atom->tag[i], atom->tag[who]), around_box(who)};
    }
    MPI_Allreduce(mine, sum, 3, MPI_DOUBLE, MPI_SUM, world);
    if (sum[2] < 2.0) return true;
    const double mean = sum[1] > 0.0 ? sum[0] / sum[1] : 0.0;
    if (sum[1] < 0.5 * sum[2]) {
      warn(fmt::format(
          "most particles have no neighbor within {:g}: is {:g} the spacing of the lattice?",
          1.25 * scene.dx, scene.dx));
      return false;
    }
    if (mean < 0.6 || mean > 1.1) {
      warn(fmt::format("nearest neighbors are {:.3g} apart on average, but the spacing is {:g}: is "
                       "that of the lattice?",
                       mean * scene.dx, scene.dx));
      return false;
    }
    const auto inside = find([&](int i) {
      return of_bodies[i] >= (scene.dim == 2 ? 3.5 : 6.5);    // beside a face are 3, 6 at most
    });
    if (inside.count)
      warn(fmt::format("{} fluid particles, the first of them atom {}, are inside a body or wall: "
                       "fsi/displace takes out the fluid in whose place a body is",
                       inside.count, inside.first));
    else if (update->ntimestep == 0) {
      const auto all = of_least(closest.r, closest, world);
      if (all.r < 0.4)
        warn(fmt::format("atoms {} and {} are {:.2g} spacings apart{}", all.a, all.b, all.r,
                         all.around < 0
                             ? std::string(": do bodies or phases overlap? Put them on one "
                                           "lattice, or fsi/displace")
                             : fmt::format(" around the periodic box: make it a whole "
                                           "number of spacings long in {}",
                                           "xyz"[all.around])));
    }
    return true;
  }

  // direction of the periodic face beyond which a particle is; -1: it is in the box
  int around_box(int i) const
  {
    for (int d = 0; d < scene.dim; d++)
      if (domain->periodicity[d] &&
          (atom->x[i][d] < domain->boxlo[d] || atom->x[i][d] >= domain->boxhi[d]))
        return d;
    return -1;
  }

  /* Bodies that begin within each other's range of contact are pushed apart with its energy at
     once. */

  void contact(double range) const
  {
    static constexpr double LITTLE = 0.02, OVERLAP = 0.8;    // of the range; spacings
    struct {
      double apart;
      tagint a, b;
    } mine = {BIG, 0, 0};
    const Cells cells(atom->x, atom->nlocal + atom->nghost, scene.dim, range * coarsest(),
                      [this](int i) {
                        return solid(i);
                      });
    for (int i = 0; i < atom->nlocal; i++) {
      if (!solid(i)) continue;
      const tagint body = atom->molecule[i];
      cells.around(atom->x[i], [&](int j, double rsq) {
        const double apart = std::sqrt(rsq) / (0.5 * (dx(i) + dx(j)));
        const tagint other = atom->molecule[j];
        if (apart >= std::min(mine.apart, (1.0 - LITTLE) * range) || other == body ||
            !(moves(i) || moves(j)))
          return;
        mine = {apart, std::min(body, other), std::max(body, other)};
      });
    }
    const auto all = of_least(mine.apart, mine, world);
    if (all.apart == BIG) return;
    warn(fmt::format(
        "bodies {} and {} {} {:.2g} spacings apart at the start, and contact reaches {:.3g}: it "
        "pushes at once. Move them apart{}",
        all.a, all.b, all.apart < OVERLAP ? "overlap, with particles" : "begin", all.apart, range,
        all.apart < 1.0 - 1.0e-6
            ? ""
            : fmt::format(", or contact {:.3g}", std::floor(10.0 * all.apart + 1.0e-6) / 10.0)));
  }

  /* Fluids of several spacings: where those that meet differ by much, or see each other through a
     band, pressure is noisy. What bodies and walls may differ by is as in Check. */

  void levels() const
  {
    static constexpr double JUMP = 1.45, COARSEST = 2.0, FINEST = 4.0, ROUND = 1.0 + 1.0e-6;
    const Cells cells(atom->x, atom->nlocal + atom->nghost, scene.dim, scene.cut);
    // does meets(j) hold for any of its neighbors?
    const auto any = [&](int i, auto meets) {
      bool found = false;
      const double own = scene.resolution[atom->type[i]].cut;
      cells.around(atom->x[i], [&](int j, double rsq) {
        const double cut = fluid(j) ? 0.5 * (own + scene.resolution[atom->type[j]].cut) : own;
        found = found || (rsq < cut * cut && meets(j));
      });
      return found;
    };
    const auto bad = find([&](int i) {
      return fluid(i) && any(i, [&](int j) {
               return scene.state[atom->type[j]].species != NONE && !fluid(j) &&
                   (dx(j) > ROUND * COARSEST * dx(i) || ROUND * FINEST * dx(j) < dx(i));
             });
    });
    if (bad.count)
      error->all(FLERR,
                 "Fix fsi: {} fluid particles, the first of them atom {}, meet a body or wall that "
                 "is more than {:g} times coarser or {:g} times finer: put fluid of another "
                 "spacing there",
                 bad.count, bad.first, COARSEST, FINEST);
    if (update->ntimestep > 0) return;
    const auto jumps = find([&](int i) {
      return fluid(i) && any(i, [&](int j) {
               return fluid(j) && dx(i) > JUMP * dx(j);
             });
    });
    if (jumps.count)
      warn(fmt::format("{} fluid particles, the first of them atom {}, meet fluid more than {:g} "
                       "times finer: pressure is noisy there. Put a band of a spacing between "
                       "them, wider than the kernel's support",
                       jumps.count, jumps.first, JUMP));
  }

  /* Fluids that see each other through a body or wall thinner than the kernel's support, less what
     hardly counts, where thin would be accepted; of one type after the other, while those that it
     goes on in count as well (fsi_sight.h). Some of the fluid beside it are enough. */

  void seen_through() const
  {
    static constexpr double PART = 0.95, HIDDEN = 0.5;
    static constexpr size_t ENOUGH = 2000;
    if (scene.density_fluid != Scene::CONTINUITY || scene.density_solid != Scene::CONTINUITY ||
        fluids.couples_stress)
      return;
    const auto support = [this](int i, int j) {
      return 0.5 * (scene.resolution[atom->type[i]].cut + scene.resolution[atom->type[j]].cut);
    };
    const double reach = PART * scene.cut;
    const Cells others(atom->x, atom->nlocal + atom->nghost, scene.dim, 0.5 * reach, [this](int i) {
      return fluid(i);
    });
    for (int t = 1; t <= atom->ntypes; t++) {
      const int species = scene.state[t].species;
      if (scene.thin[t] != 0.0 || (species != SOLID && species != RIGID)) continue;
      std::vector<double> types(atom->ntypes + 1, 0.0);
      types[t] = 1.0;
      Sight sight(lmp, scene, types);
      sight.find_bodies();
      std::vector<int> beside;
      for (int i = 0; i < atom->nlocal; i++)
        if (fluid(i) && sight.near(atom->x[i])) beside.push_back(i);
      tagint mine = MAXTAGINT, first;
      for (size_t k = 0; k < beside.size(); k += beside.size() / ENOUGH + 1) {
        const int i = beside[k];
        sight.look_from(atom->x[i], scene.cut);
        others.around(atom->x[i], reach, [&](int j, double rsq) {
          const double cut = support(i, j);
          if (j != i && atom->tag[i] < mine && rsq < PART * cut * PART * cut &&
              sight.may_hide(atom->x[j], 0.0) && sight.visible(atom->x[j], cut) < HIDDEN)
            mine = atom->tag[i];
        });
      }
      MPI_Allreduce(&mine, &first, 1, MPI_LMP_TAGINT, MPI_MIN, world);
      if (first < MAXTAGINT)
        warn(fmt::format("fluid atom {} sees fluid on the other side of a body or wall of type {}, "
                         "which is thinner than the kernel's support {:g}: if pressures on its two "
                         "sides differ, they mix. Then fix {} ... thin {}",
                         first, t, scene.cut, scene.mover->id, t));
    }
  }

  /* fluid, or all elastic bodies, that nobody moves */

  void held() const
  {
    const auto say = [this](const char *all, const Found &found, const char *what) {
      warn(fmt::format(
          "{}{} {}, the first of them atom {}, are not in group {} of fix {}: they stay "
          "where they are",
          all, found.count, what, found.first, group->names[scene.mover->igroup], scene.mover->id));
    };
    const auto fluid_held = find([this](int i) {
      return fluid(i) && !scene.is_moved(i);
    });
    const auto bodies = find([this](int i) {
      return solid(i);
    });
    const auto moving = find([this](int i) {
      return solid(i) && (scene.is_moved(i) || goes(i));
    });
    if (fluid_held.count) say("", fluid_held, "fluid particles");
    if (solids.style && bodies.count && !moving.count)
      say("all ", bodies, "particles of elastic bodies");
  }

  /* neigh_modify exclude takes from sums of fluid what is beside it */

  void excluded() const
  {
    if (neighbor->nex_type + neighbor->nex_group + neighbor->nex_mol == 0) return;
    const auto has = [this](int i, int k, const int *group) {
      return (atom->mask[i] & group[k]) != 0;
    };
    const auto out = find([&](int i) {
      if (!fluid(i)) return false;
      const int t = atom->type[i];
      bool any = false;
      for (int k = 0; k < neighbor->nex_type; k++)
        any = any || t == neighbor->ex1_type[k] || t == neighbor->ex2_type[k];
      for (int k = 0; k < neighbor->nex_group; k++)
        any = any || has(i, k, neighbor->ex1_bit) || has(i, k, neighbor->ex2_bit);
      for (int k = 0; k < neighbor->nex_mol; k++) any = any || has(i, k, neighbor->ex_mol_bit);
      return any;
    });
    if (out.count)
      warn(fmt::format("neigh_modify exclude hides neighbors from {} fluid particles, the first of "
                       "them atom {}: their sums over neighbors are wrong",
                       out.count, out.first));
  }

  /* A body that ends at a mirror wall is free there: mirror walls act on fluid. Not where weight
     acts along the wall's normal (that is a floor, and without weight it may be one), nor where the
     body fills the room between two walls. */

  void cut_by_walls() const
  {
    static constexpr double NEAR = 0.75;
    const auto &walls = scene.walls.wall;
    std::vector<std::set<tagint>> ends(walls.size()), through(walls.size());    // bodies
    for (int i = 0; i < atom->nlocal; i++) {
      if (!moves(i) || !weighs(i)) continue;
      const auto g = scene.body_forces.on(i);
      for (size_t k = 0; k < walls.size(); k++) {
        const double apart = walls[k].distance(atom->x[i]) / dx(i);
        if (walls[k].noslip || atom->mask[i] & walls[k].joins || apart >= NEAR ||
            g[walls[k].axis] != 0.0 || !walls[k].spans(atom->x[i], 0.0))
          continue;
        (apart > 0.0 ? ends : through)[k].insert(atom->molecule[i]);
      }
    }
    for (size_t k = 0; k < walls.size(); k++) {
      ends[k] = gather(ends[k], world);
      for (const tagint body : gather(through[k], world)) ends[k].erase(body);
    }
    for (size_t k = 0; k < walls.size(); k++)
      for (const tagint body : ends[k]) {
        bool both = false;
        for (size_t n = 0; n < walls.size(); n++)
          both |= walls[n].axis == walls[k].axis && walls[n].side != walls[k].side &&
              ends[n].count(body);
        if (both) continue;
        return warn(fmt::format(
            "body {} ends at the mirror wall at {} = {:g}, and its face there is free, since these "
            "walls act on fluid alone: a body cut by a plane of symmetry needs symmetry yes, or "
            "must be held there",
            body, "xyz"[walls[k].axis], walls[k].position));
      }
  }

  /* In water on a mirror wall the lowest row is pressed against its own image, which does not push
     it any more; where few rows are above it, water that rests on the guard loses volume. */

  void shallow() const
  {
    static constexpr double BESIDE = 1.0;    // spacings
    for (const auto &w : scene.walls.wall) {
      const int rows = w.hydrostatic ? 4 : 8;    // that rest
      double mine[2] = {-BIG, -BIG}, all[2];     // top, minus bottom
      for (int i = 0; i < atom->nlocal; i++) {
        const double s = w.distance(atom->x[i]) / dx(i);
        if (!fluid(i) || w.side * scene.body_forces.on(i)[w.axis] >= 0.0 ||
            !w.spans(atom->x[i], 0.0))
          continue;
        mine[0] = std::max(mine[0], s);
        mine[1] = std::max(mine[1], -s);
      }
      MPI_Allreduce(mine, all, 2, MPI_DOUBLE, MPI_MAX, world);
      if (-all[1] < BESIDE && all[0] + all[1] + 1.5 < rows)
        warn(fmt::format("fluid is {:.2g} spacings deep on the mirror wall at {} = {:g}: under its "
                         "weight less than {} rows sink there, by 4 to 48 % in 30 s. {}build the "
                         "wall of particles",
                         all[0] + all[1] + 1.0, "xyz"[w.axis], w.position, rows,
                         w.hydrostatic ? "Better " : "Give it hydrostatic yes, or "));
    }
  }

  /* what weighs nothing while other particles do */

  void weightless() const
  {
    int rigid = 0;
    for (const auto &fix : modify->get_fix_by_style("^rigid")) rigid |= fix->groupbit;
    const auto falls = [&](int i) {
      return fluid(i) ? scene.is_moved(i) : solid(i) ? moves(i) : (atom->mask[i] & rigid) != 0;
    };
    if (!find([&](int i) {
           return falls(i) && weighs(i);
         }).count)
      return;
    const std::pair<Species, const char *> kinds[] = {
        {FLUID, "fluids"}, {SOLID, "elastic bodies"}, {RIGID, "rigid bodies"}};
    for (const auto &[species, what] : kinds) {
      const auto found = find([&, kind = species](int i) {
        return falls(i) && scene.state[atom->type[i]].species == kind && !weighs(i);
      });
      if (found.count)
        warn(fmt::format("{} moving particles of {}, the first of them atom {}, are in the group "
                         "of no fix gravity, while others are: they weigh nothing",
                         found.count, what, found.first));
    }
  }

  /* A scene in which everything is at rest and stays so: no velocity, no force, and no fix but
   * those that only watch. */

  void nothing_acts() const
  {
    static constexpr double LITTLE = 1.0e-9;    // of what sound would do in a spacing
    static const char *const watching[] = {"fsi/dt",       "fsi/watch", "fsi/report", "fsi/stress",
                                           "fsi/spectrum", "fsi/wall/", "gravity",    "ave/",
                                           "print",        "halt",      "vector",     "balance",
                                           "store/",       "STORE/",    "FSI_"};
    for (const auto &fix : modify->get_fix_list())
      if (fix != scene.mover &&
          std::none_of(std::begin(watching), std::end(watching), [&](const char *s) {
            return strncmp(fix->style, s, strlen(s)) == 0;
          }))
        return;
    const auto found = find([&](int i) {
      if (goes(i)) return true;
      if (!scene.is_moved(i)) return false;
      const double *const f = atom->f[i];
      const double most =
          LITTLE * atom->rmass[i] * scene.state[atom->type[i]].wave_speed_sq() / dx(i);
      return weighs(i) || std::fabs(f[0]) + std::fabs(f[1]) + std::fabs(f[2]) > most;
    });
    bool moving = false;
    for (const auto &w : scene.walls.wall)
      moving = moving || w.velocity[0] != 0.0 || w.velocity[1] != 0.0 || w.velocity[2] != 0.0;
    if (!found.count && !moving)
      warn("nothing moves this scene: no gravity, no velocity, no moving wall, no force at the "
           "start. Is fix gravity missing?");
  }

  /* Flow behind a body draws. Where no weight keeps the pressure above 0, water that cannot bear
   * tension opens holes there, and with shifting loses particles. */

  void torn_streams() const
  {
    bool any = false;
    for (const auto *p : scene.parts)
      any = any || p->rank() == Part::STREAMS || p->rank() == Part::OPEN_ENDS;
    if (!any) return;
    const auto found = find([&](int i) {
      return fluid(i) && scene.is_moved(i) && scene.state[atom->type[i]].floor == 0.0 && !weighs(i);
    });
    if (found.count)
      warn("a stream without tension opens holes where its pressure falls to 0, as behind a body: "
           "unless it is a jet in air, give pair_style fsi/fluid background of about rho U^2, U "
           "being its largest speed, and tension yes");
  }

  /* law svk and neohookean know no yield stress, and fix fsi/stress only where it is told to */

  void yields() const
  {
    for (const auto *part : scene.parts)
      for (const auto &effect : part->effects())
        if (effect.keyword == "fix fsi/stress plastic" && effect.on && solids.by_rate) return;
    for (int t = 1; t <= atom->ntypes; t++)
      if (present[t] && scene.state[t].species == SOLID && scene.state[t].yield > 0.0)
        warn(fmt::format("the material of type {} has a yield stress, but stays elastic: it acts "
                         "with law hypo of pair_style fsi/solid/tl, or with "
                         "pair_style fsi/solid, and fix fsi/stress ... plastic",
                         t));
  }

  /* of the fluid along a direction, from face to face */

  double extent(const std::array<double, 3> &e) const
  {
    double mine[2] = {-BIG, -BIG}, ends[2];
    for (int i = 0; i < atom->nlocal; i++) {
      if (!fluid(i)) continue;
      double s = 0.0;
      for (int d = 0; d < scene.dim; d++) s += e[d] * atom->x[i][d];
      mine[0] = std::max(mine[0], s);
      mine[1] = std::max(mine[1], -s);
    }
    MPI_Allreduce(mine, ends, 2, MPI_DOUBLE, MPI_MAX, world);
    return ends[0] + ends[1] + scene.dx;
  }

  /* speed of sound against what the fluid has, or gets by falling through its own height */

  void speeds() const
  {
    std::vector<int> types;    // of fluids
    for (int t = 1; t <= atom->ntypes; t++)
      if (present[t] && scene.state[t].species == FLUID) types.push_back(t);
    if (types.empty()) return;
    std::array<double, 3> down = scene.body_forces.of_type[types[0]];
    double g = 0.0, mine = 0.0, fastest, width = BIG;
    for (int d = 0; d < scene.dim; d++) g += down[d] * down[d];
    g = std::sqrt(g);
    for (double &c : down) c /= g > 0.0 ? g : 1.0;
    for (int d = 0; d < scene.dim; d++)
      if (down[d] != 0.0 && domain->periodicity[d]) g = 0.0;    // drives a flow in a channel
    for (int i = 0; i < atom->nlocal; i++) {
      const double *const v = atom->v[i];
      if (fluid(i)) mine = std::max(mine, std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]));
    }
    MPI_Allreduce(&mine, &fastest, 1, MPI_DOUBLE, MPI_MAX, world);
    const double height = g > 0.0 ? extent(down) : 0.0, falls = std::sqrt(2.0 * g * height),
                 expected = std::max(fastest, falls);
    for (int d = 0; d < scene.dim; d++) {
      std::array<double, 3> axis = {};
      axis[d] = 1.0;
      width = std::min(width, extent(axis));
    }
    // of what swings by so little the frequency decides
    static constexpr double LINEAR = 1.0e5;
    const bool swings = g == 0.0 && find([this](int i) {
                                      return moves(i);
                                    }).count > 0;
    bool said = expected == 0.0;
    for (const int t : types) {
      const double c = scene.state[t].c;
      if (!said && c > 50.0 * expected && !(swings && c > LINEAR * expected))
        warn(fmt::format("the speed of sound {:g} of the fluid is {:.2g} times the speed {:.3g} "
                         "that there is or falling gives: 10 times is enough. If the fluid should "
                         "be faster: velocity ... units box (its default are lattice units per "
                         "time)",
                         c, c / expected, expected));
      else if (!said && c < (7.0 - 1.0e-3) * expected)
        warn(fmt::format("the speed of sound {:g} of the fluid is {:.1f} times {}, {:.3g}: it "
                         "should be 7 to 10 times the fastest flow, sound {:.3g}",
                         c, c / expected,
                         fastest > falls
                             ? std::string("its speed at the start")
                             : fmt::format("sqrt(2gH) of its height H = {:.3g}", height),
                         expected, 10.0 * expected));
      said = said || c > 50.0 * expected || c < (7.0 - 1.0e-3) * expected;
      viscosity(t, expected, width);
    }
  }

  /* what artificial viscosity is worth: half of alpha h c/2(d+2), since it acts on approach only
   * (doc/src/theory.rst) */

  void viscosity(int type, double speed, double length) const
  {
    const State &s = scene.state[type];
    const double alpha = fluids.alpha, nu = 0.25 * alpha * scene.h * s.c / (scene.dim + 2);
    if (alpha == 0.0) return;
    std::string text = fmt::format("  artificial viscosity, alpha {:g}, of type {} acts like a "
                                   "kinematic viscosity of about {:.2g}",
                                   alpha, type, nu);
    if (speed > 0.0)
      text += fmt::format(
          ": Reynolds number {:.2g} with speed {:.3g} and the fluid's least width {:.3g}",
          speed * length / nu, speed, length);
    if (comm->me == 0) utils::logmesg(lmp, text + "\n");
    const double own = s.viscosity / s.rho0;
    if (fluids.laminar && own > 0.0 && nu > own)
      warn(fmt::format("artificial viscosity of type {} is worth {:.2g}, {:.2g} times its laminar "
                       "viscosity {:.2g}: take alpha {:.1g} or less, "
                       "or a finer spacing",
                       type, nu, nu / own, own, 0.1 * alpha * own / nu));
  }

  void time_step() const
  {
    // where runs begin to fail (doc/notes/fluid.md, Courant number), over the limit that fix fsi/dt
    // keeps
    static constexpr struct {
      int cause;
      double fails;
    } causes[] = {{Limits::SOUND, 2.0}, {Limits::ELASTIC, 1.6}, {Limits::LAMINAR, 2.0}};
    Limits limits(lmp);
    limits.find(scene, scene.mover->groupbit, scene.substeps > 1);
    limits.reduce();
    double good = Limits::UNLIMITED, most = good;
    const char *what = "";
    for (const auto &c : causes) {
      const double limit = std::min(limits.step[c.cause], scene.substeps * limits.sub[c.cause]);
      good = std::min(good, limit);
      if (c.fails * limit < most) {
        most = c.fails * limit;
        what = Limits::names[c.cause];
      }
    }
    if (good == Limits::UNLIMITED) return;
    if (update->dt > most)
      warn(fmt::format(
          "the time step {:g} is too long for {}, {:.3g} at most: timestep {:.3g}, or fix fsi/dt",
          update->dt, what, most, good));
    else if (update->dt < 0.02 * good)
      warn(fmt::format("the time step {:g}{} is {:.2g} times shorter than it has to be: timestep "
                       "{:.3g}, or fix fsi/dt",
                       update->dt, update->dt_default ? ", LAMMPS' default," : "",
                       good / update->dt, good));
  }
};

}    // namespace

void FSI::advise(LAMMPS *lmp, const Scene &scene)
{
  Adviser(lmp, scene).all();
}
