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

#include "fsi_refine.h"

#include "atom.h"
#include "domain.h"
#include "error.h"
#include "fsi_hub.h"
#include "fsi_keywords.h"
#include "group.h"
#include "lammps.h"
#include "region.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace FSI;

static constexpr double ROUND_OFF = 1.0e-12;    // of differences of distances

Zones::Zones(LAMMPS *lmp, const std::string &label) :
    Pointers(lmp), label(label), body_bit(0), nested(false), can_move(false), ahead(0.0),
    directions(split_directions(domain->dimension))
{
}

static bool is_union(const Region *region)
{
  return strcmp(region->style, "union") == 0;
}

void Zones::read_regions(const std::vector<std::string> &words)
{
  region_ids = words;
  for (const auto &name : region_ids)
    if (!domain->get_region_by_id(name))
      error->all(FLERR, "Region {} of fix fsi/refine does not exist", name);
}

void Zones::read_distances(const std::vector<std::string> &words)
{
  if (words.empty()) utils::missing_cmd_args(FLERR, "fix fsi/refine distance", error);
  body_id = words[0];
  find_body();
  for (size_t k = 1; k < words.size(); k++) {
    distances.push_back(numeric(lmp, label + " distance", words[k], Range::above(0.0)));
    if (k > 1 && distances[k - 1] >= distances[k - 2])
      error->all(FLERR, "{} distance: {} after {}, expected less: the finer levels are nearer",
                 label, distances[k - 1], distances[k - 2]);
  }
}

// A group may be deleted, and another take its bit
void Zones::find_body()
{
  if (body_id.empty()) return;
  const int of_body = group->find(body_id);
  if (of_body < 0) error->all(FLERR, "Group {} of fix fsi/refine distance does not exist", body_id);
  body_bit = group->bitmask[of_body];
}

void Zones::check_number(size_t types)
{
  if (!region_ids.empty() && !distances.empty())
    error->all(FLERR, "{} takes region or distance, not both", label);
  nested = types == 0;
  if (nested && region_ids.size() + distances.size() != 1)
    error->all(FLERR,
               "{} finest has {} {}: expected one, for the finest level: those of the others "
               "follow from it",
               label, region_ids.size() + distances.size(),
               distances.empty() ? "regions" : "distances");
  // of an intersection LAMMPS finds no distance
  for (const auto &name : region_ids) {
    const Region *const region = nested ? domain->get_region_by_id(name) : nullptr;
    if (region && region->nregion > 1 && !(is_union(region) && region->interior))
      error->all(FLERR, "{} finest: region {} is of style {}: expected one shape or a union", label,
                 name, region->style);
  }
  if (nested) return;
  if (region_ids.size() + distances.size() != types - 1)
    error->all(FLERR,
               "{} has {} types and {} {}: expected one for each type but the first, that of "
               "larger spacing first",
               label, types, region_ids.size() + distances.size(),
               distances.empty() ? "regions" : "distances");
}

// each by the least that there has to be between two
void Zones::find_wider(const Discretization &disc, const std::vector<int> &types)
{
  wider.assign(types.size() - 1, 0.0);
  for (size_t k = nested ? wider.size() - 1 : 0; k > 0; k--)
    wider[k - 1] = wider[k] + disc.resolution[types[k - 1]].cut + disc.dx_of(types[k]);
}

// Between the zone of level k + 1 and the end of that of level k: one level is all that a particle
// sees beside its own
void Zones::init(const Discretization &disc, const std::vector<int> &types)
{
  find_body();
  find_wider(disc, types);
  regions.clear();
  can_move = !distances.empty();
  for (const auto &name : region_ids) {
    regions.push_back(domain->get_region_by_id(name));
    if (!regions.back()) error->all(FLERR, "Region {} of fix fsi/refine does not exist", name);
    can_move = can_move || regions.back()->dynamic_check();
  }
  for (size_t k = 1; k < distances.size(); k++) {
    const double shell = distances[k - 1] - distances[k],
                 least = disc.resolution[types[k - 1]].cut + disc.dx_of(types[k]);
    if (shell < (1.0 - ROUND_OFF) * least)
      error->all(FLERR,
                 "{} distance: from {} to {} there is {:g} for atom type {}: expected at least "
                 "{:g}, the kernel's support of type {} and a spacing of type {}",
                 label, distances[k], distances[k - 1], shell, types[k], least, types[k - 1],
                 types[k]);
  }
}

std::string Zones::names(int k) const
{
  return regions.empty() || nested ? ""
                                   : fmt::format(" ({} and {})", region_ids[k - 1], region_ids[k]);
}

void Zones::find(const Discretization &disc, double beyond, double time)
{
  ahead = time;
  for (auto *region : regions) region->prematch();
  if (!body_bit) return;
  const auto body = everywhere(lmp, distances[0] + wider[0] + beyond, [this](int i) {
    return (atom->mask[i] & body_bit) != 0;
  });
  if (body.empty())
    error->all(FLERR, "{} distance: there are no atoms in group {}", label, body_id);
  away.assign(atom->nlocal, Cells::LARGE);
  for (int i = 0; i < atom->nlocal; i++)
    if (disc.state[atom->type[i]].species == FLUID) away[i] = std::sqrt(body.nearest(atom->x[i]));
}

// does a region that x is not in begin within this distance?
static bool is_near(Region *region, const double *x, double distance)
{
  if (is_union(region))
    return std::any_of(region->reglist, region->reglist + region->nregion, [&](Region *part) {
      return is_near(part, x, distance);
    });
  region->interior ^= 1;
  const int n = region->surface(x[0], x[1], x[2], distance);
  region->interior ^= 1;
  return n > 0;
}

// A zone grown by a distance: is any place as far away, in a number of directions, inside?
bool Zones::has(int k, int i, double grown) const
{
  const int given = nested ? 0 : k - 1;
  if (regions.empty()) return away[i] < distances[given] + wider[k - 1] + grown;
  Region *const region = regions[given];
  double x[3] = {atom->x[i][0], atom->x[i][1], atom->x[i][2]};
  if (region->dynamic_check()) {
    for (int d = 0; d < 3; d++) x[d] += ahead * atom->v[i][d];
    domain->remap(x);
  }
  if (region->match(x[0], x[1], x[2])) return true;
  if (nested) return is_near(region, x, wider[k - 1] + grown);
  if (grown == 0.0) return false;
  const auto matches = [&](const std::array<double, 3> &e, double to) {
    double at[3] = {x[0] + to * e[0], x[1] + to * e[1], x[2] + to * e[2]};
    domain->remap(at);
    return region->match(at[0], at[1], at[2]) != 0;
  };
  for (const auto &e : directions)
    if (matches(e, grown) || matches(e, -grown)) return true;
  return false;
}
