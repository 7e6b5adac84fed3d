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

#include "fsi_commands.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix_fsi.h"
#include "fix_fsi_reference.h"
#include "fsi_cells.h"
#include "fsi_gather.h"
#include "fsi_hub.h"
#include "fsi_keywords.h"
#include "fsi_refine.h"
#include "group.h"
#include "input.h"
#include "math_const.h"
#include "math_extra.h"
#include "modify.h"
#include "platform.h"
#include "region.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <memory>
#include <sstream>

using namespace LAMMPS_NS;
using namespace FSI;

namespace {

// ---- surfaces ----

// The signed distance, negative inside, from a region of LAMMPS, from triangles (STL), from closed
// outlines in the plane (CSV)
class Surface {
 public:
  virtual ~Surface() = default;
  // of a place, and, if it is less than the band, the unit vector away from the nearest point of
  // the surface, out of it; +-band: no point is as near
  virtual double distance(const double *x, double band, double *outward) const = 0;
  // of what it holds, from its faces; < 0: it has none
  virtual double volume() const { return -1.0; }
  virtual std::string name() const = 0;
};

typedef std::array<double, 3> Vec;

Vec operator-(const Vec &a, const Vec &b)
{
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Vec operator+(const Vec &a, const Vec &b)
{
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
Vec operator*(double k, const Vec &a)
{
  return {k * a[0], k * a[1], k * a[2]};
}
double operator*(const Vec &a, const Vec &b)
{
  return MathExtra::dot3(a.data(), b.data());
}
Vec cross(const Vec &a, const Vec &b)
{
  Vec c;
  MathExtra::cross3(a.data(), b.data(), c.data());
  return c;
}

// ---- a region ----

// Of a union the distance from the part that is nearest, of an intersection from that which is
// furthest: LAMMPS' own contacts have no edges between parts, and those of a union from outside are
// what is inside another part (RegUnion::surface_exterior). Only parts move and rotate.
class OfRegion : public Surface {
  Region *const region;
  const bool flat;

 public:
  OfRegion(LAMMPS *lmp, Region *region) : region(region), flat(lmp->domain->dimension == 2)
  {
    refuse_open(lmp, region);
    region->init();
    region->prematch();
  }
  std::string name() const override { return fmt::format("region {}", region->id); }
  double distance(const double *x, double band, double *outward) const override
  {
    return of(region, x, band, outward);
  }

 private:
  static void refuse_open(LAMMPS *lmp, const Region *region)
  {
    if (region->openflag)
      lmp->error->all(FLERR, "Region {} of fsi/pack must be closed: it has open faces", region->id);
    for (int k = 0; region->reglist && k < region->nregion; k++)
      refuse_open(lmp, region->reglist[k]);
  }

  double of(Region *region, const double *x, double band, double *outward) const
  {
    if (!region->reglist) return of_contacts(region, x, band, outward);
    const double unites = std::strcmp(region->style, "union") == 0 ? 1.0 : -1.0,
                 side = region->interior ? 1.0 : -1.0;
    double best = INFINITY, there[3] = {};
    for (int k = 0; k < region->nregion; k++) {
      const double r = unites * of(region->reglist[k], x, band, there);
      if (r >= best) continue;
      best = r;
      for (int d = 0; d < 3; d++) outward[d] = side * there[d];
    }
    return side * unites * best;
  }

  // the contacts of LAMMPS' granular walls, from the side on which the place is
  double of_contacts(Region *region, const double *x, double band, double *outward) const
  {
    const bool matches = region->match(x[0], x[1], x[2]);
    const int interior = region->interior;
    region->interior = matches == (interior != 0);
    const int n = region->surface(x[0], x[1], x[2], band);
    const double sign = matches ? -1.0 : 1.0;
    double nearest = band;
    for (int k = 0; k < n; k++) {
      const auto &c = region->contact[k];
      // in 2D ends along z are no surface
      if (flat && std::fabs(c.delz) > 1.0e-6 * c.r) continue;
      if (c.r >= nearest) continue;
      nearest = c.r;
      // from the nearest point to the place
      const double inv = c.r > 0.0 ? sign / c.r : 0.0;
      outward[0] = inv * c.delx;
      outward[1] = inv * c.dely;
      outward[2] = flat ? 0.0 : inv * c.delz;
    }
    region->interior = interior;
    return sign * nearest;
  }
};

// ---- triangles, or segments of a plane ----

// Its simplices by the cells that they are near; the sign by normals of faces, edges and corners
// (Baerentzen and Aanaes 2005, IEEE Trans. Vis. Comput. Graph. 11, 243), or by the winding number.
class OfSimplices : public Surface {
  Error *const error;
  const std::string label;
  const int dim;
  std::vector<Vec> points;
  std::vector<std::array<int, 3>> faces;    // of the points; in 2D of two
  std::vector<Vec> normals, of_points;
  std::vector<double> radii;    // of faces around their first points
  std::map<std::pair<int, int>, Vec> of_edges;
  mutable double size = 0.0;    // of the cells
  mutable std::array<double, 3> low = {};
  mutable std::array<int, 3> count = {};
  mutable std::vector<std::vector<int>> cells;

 public:
  OfSimplices(LAMMPS *lmp, const std::string &label, std::vector<std::array<Vec, 3>> given) :
      error(lmp->error), label(label), dim(lmp->domain->dimension)
  {
    std::map<Vec, int> known;
    for (const auto &face : given) {
      std::array<int, 3> corners = {};
      for (int k = 0; k < dim; k++) {
        const auto place = known.emplace(face[k], points.size());
        if (place.second) points.push_back(face[k]);
        corners[k] = place.first->second;
      }
      if (corners[0] == corners[1] ||
          (dim == 3 && (corners[1] == corners[2] || corners[2] == corners[0])))
        continue;    // of no extent
      faces.push_back(corners);
    }
    if (faces.empty()) error->all(FLERR, "{} has no surface", label);
    check_closed();
    find_normals();
    if (!(volume() < 0.0)) return;
    for (auto &f : faces) std::swap(f[0], f[1]);
    find_normals();
  }
  std::string name() const override { return label; }

  double volume() const override
  {
    double sum = 0.0;
    for (const auto &f : faces) {
      const Vec &a = points[f[0]], &b = points[f[1]];
      sum += dim == 2 ? 0.5 * (a[0] * b[1] - a[1] * b[0]) : a * cross(b, points[f[2]]) / 6.0;
    }
    return sum;
  }

  double distance(const double *place, double band, double *outward) const override
  {
    if (size < band) sort(band);
    const Vec x = {place[0], place[1], dim == 3 ? place[2] : 0.0};
    double least = size * size;
    Vec nearest = {}, normal = {};
    std::array<int, 3> c;
    for (int d = 0; d < 3; d++) {
      c[d] = d < dim ? (int) std::floor((x[d] - low[d]) / size) : 0;
      if (c[d] < 0 || c[d] >= count[d]) return band;    // what it holds is in the grid
    }
    for (const int k : cells[(c[2] * count[1] + c[1]) * count[0] + c[0]]) {
      const double reach = std::sqrt(least) + radii[k];
      if ((x - points[faces[k][0]]) * (x - points[faces[k][0]]) < reach * reach)
        take_nearer(k, x, least, nearest, normal);
    }
    if (least >= size * size) return is_inside(x) ? -band : band;
    const Vec away = x - nearest;
    const double r = std::sqrt(least), sign = away * normal < 0.0 ? -1.0 : 1.0;
    if (r >= band) return sign * band;
    const Vec out = r > 0.0 ? sign / r * away : 1.0 / std::sqrt(normal * normal) * normal;
    std::copy(out.begin(), out.end(), outward);
    return sign * r;
  }

 private:
  // each edge has two faces that go along it in opposite directions; in 2D each point two segments
  void check_closed() const
  {
    std::map<std::pair<int, int>, int> there;
    for (const auto &f : faces)
      for (int k = 0; k < dim; k++) {
        const int a = f[k], b = dim == 3 ? f[(k + 1) % 3] : 0;
        if (dim == 2)
          there[{a, 0}] += k == 0 ? 1 : -1;
        else
          there[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
      }
    const auto open = std::find_if(there.begin(), there.end(), [](const auto &e) {
      return e.second != 0;
    });
    if (open == there.end()) return;
    const Vec &p = points[open->first.first];
    error->all(FLERR, "{} is not closed, or its faces do not agree on what is outside, at {}",
               label, place_text(p.data()));
  }

  void find_normals()
  {
    normals.clear();
    radii.clear();
    of_edges.clear();
    of_points.assign(points.size(), {0.0, 0.0, 0.0});
    for (const auto &f : faces) {
      const Vec &a = points[f[0]], &b = points[f[1]];
      Vec n = dim == 2 ? Vec{b[1] - a[1], a[0] - b[0], 0.0} : cross(b - a, points[f[2]] - a);
      const double length = std::sqrt(n * n);
      if (length > 0.0) n = 1.0 / length * n;
      normals.push_back(n);
      double farthest = 0.0;
      for (int k = 1; k < dim; k++)
        farthest = std::max(farthest, (points[f[k]] - a) * (points[f[k]] - a));
      radii.push_back(1.000001 * std::sqrt(farthest));
      for (int k = 0; k < dim; k++) {
        const Vec &p = points[f[k]];
        double angle = 1.0;
        if (dim == 3) {
          const Vec u = points[f[(k + 1) % 3]] - p, v = points[f[(k + 2) % 3]] - p;
          angle = std::atan2(std::sqrt(cross(u, v) * cross(u, v)), u * v);
          auto &edge = of_edges[std::minmax(f[k], f[(k + 1) % 3])];
          edge = edge + n;
        }
        of_points[f[k]] = of_points[f[k]] + angle * n;
      }
    }
  }

  // the nearest point of a face and the normal there, if its squared distance is less
  void take_nearer(int k, const Vec &x, double &least, Vec &at, Vec &normal) const
  {
    const auto &f = faces[k];
    const Vec &a = points[f[0]], &b = points[f[1]];
    const auto take = [&](const Vec &there) {
      const double rsq = (x - there) * (x - there);
      if (rsq >= least) return false;
      least = rsq;
      at = there;
      return true;
    };
    const auto take_of_edge = [&](int p, int q) {
      const Vec along = points[q] - points[p];
      const double t = std::clamp((x - points[p]) * along / (along * along), 0.0, 1.0);
      if (!take(points[p] + t * along)) return;
      normal = t == 0.0 ? of_points[p]
          : t == 1.0    ? of_points[q]
          : dim == 2    ? normals[k]
                        : of_edges.at(std::minmax(p, q));
    };
    if (dim == 2) return take_of_edge(f[0], f[1]);
    const Vec u = b - a, v = points[f[2]] - a, w = x - a;
    const double uu = u * u, uv = u * v, vv = v * v, wu = w * u, wv = w * v,
                 det = uu * vv - uv * uv, s = (wu * vv - wv * uv) / det,
                 t = (wv * uu - wu * uv) / det;
    if (det > 0.0 && s >= 0.0 && t >= 0.0 && s + t <= 1.0) {
      if (take(a + (s * u + t * v))) normal = normals[k];
      return;
    }
    for (int e = 0; e < 3; e++) take_of_edge(f[e], f[(e + 1) % 3]);
  }

  // cells as wide as the band, and in each the faces that are as near
  void sort(double band) const
  {
    size = band;
    Vec high = points[0];
    low = points[0];
    for (const auto &p : points)
      for (int d = 0; d < dim; d++) {
        low[d] = std::min(low[d], p[d]);
        high[d] = std::max(high[d], p[d]);
      }
    for (int d = 0; d < 3; d++) {
      low[d] -= d < dim ? band : 0.0;
      count[d] = d < dim ? (int) ((high[d] + band - low[d]) / size) + 1 : 1;
    }
    cells.assign((size_t) count[0] * count[1] * count[2], {});
    for (size_t k = 0; k < faces.size(); k++) {
      std::array<int, 3> from = {}, to = {};
      for (int d = 0; d < dim; d++) {
        double a = points[faces[k][0]][d], b = a;
        for (int m = 1; m < dim; m++) {
          a = std::min(a, points[faces[k][m]][d]);
          b = std::max(b, points[faces[k][m]][d]);
        }
        from[d] = std::max(0, (int) ((a - band - low[d]) / size));
        to[d] = std::min(count[d] - 1, (int) ((b + band - low[d]) / size));
      }
      for (int z = from[2]; z <= to[2]; z++)
        for (int y = from[1]; y <= to[1]; y++)
          for (int i = from[0]; i <= to[0]; i++)
            cells[((size_t) z * count[1] + y) * count[0] + i].push_back(k);
    }
  }

  // sum of the angles under which faces are seen (van Oosterom and Strackee 1983)
  bool is_inside(const Vec &x) const
  {
    double sum = 0.0;
    for (const auto &f : faces) {
      const Vec a = points[f[0]] - x, b = points[f[1]] - x;
      if (dim == 2) {
        sum += std::atan2(a[0] * b[1] - a[1] * b[0], a * b);
        continue;
      }
      const Vec c = points[f[2]] - x;
      const double la = std::sqrt(a * a), lb = std::sqrt(b * b), lc = std::sqrt(c * c);
      sum += std::atan2(a * cross(b, c), la * lb * lc + (a * b) * lc + (b * c) * la + (c * a) * lb);
    }
    return sum > MathConst::MY_PI;    // 2 pi in 2D; half of 4 pi in 3D
  }
};
}    // namespace

static std::unique_ptr<Surface> surface_of_region(LAMMPS *lmp, const std::string &id)
{
  Region *const region = lmp->domain->get_region_by_id(id);
  if (!region) lmp->error->all(FLERR, "Fsi/pack region {} does not exist", id);
  return std::make_unique<OfRegion>(lmp, region);
}

// the whole file, of rank 0 for all
static std::string read(LAMMPS *lmp, const std::string &file)
{
  std::string text;
  bigint n = -1;
  if (lmp->comm->me == 0) {
    std::ifstream in(file, std::ios::binary);
    if (in) {
      text.assign(std::istreambuf_iterator<char>(in), {});
      n = text.size();
    }
  }
  MPI_Bcast(&n, 1, MPI_LMP_BIGINT, 0, lmp->world);
  if (n < 0) lmp->error->all(FLERR, "Fsi/pack cannot open file {}", file);
  if (n > MAXSMALLINT) lmp->error->all(FLERR, "Fsi/pack file {} has more than 2 GB", file);
  text.resize(n);
  MPI_Bcast(&text[0], (int) n, MPI_CHAR, 0, lmp->world);
  return text;
}

// text or binary: 80 bytes, the number of triangles, of each the normal, three corners, two bytes
static std::unique_ptr<Surface> surface_of_stl(LAMMPS *lmp, const std::string &file)
{
  if (lmp->domain->dimension == 2)
    lmp->error->all(FLERR, "Fsi/pack stl is for 3D: in 2D use outline");
  const std::string text = read(lmp, file);
  std::vector<std::array<Vec, 3>> faces;
  uint32_t n = 0;
  if (text.size() >= 84) std::memcpy(&n, &text[80], 4);
  if (text.size() >= 84 && text.size() == 84 + 50 * (size_t) n) {
    for (size_t k = 0; k < n; k++) {
      float of[12];
      std::memcpy(of, &text[84 + 50 * k], sizeof of);
      faces.push_back({Vec{of[3], of[4], of[5]}, {of[6], of[7], of[8]}, {of[9], of[10], of[11]}});
    }
  } else {
    std::vector<Vec> corners;
    std::istringstream in(text);
    for (std::string word; in >> word;) {
      Vec v;
      if (word == "vertex" && in >> v[0] >> v[1] >> v[2]) corners.push_back(v);
    }
    if (corners.empty() || corners.size() % 3)
      lmp->error->all(FLERR, "Fsi/pack file {} is no STL file", file);
    for (size_t k = 0; k < corners.size(); k += 3)
      faces.push_back({corners[k], corners[k + 1], corners[k + 2]});
  }
  return std::make_unique<OfSimplices>(lmp, "file " + file, faces);
}

static bool is_in_loop(const std::vector<Vec> &loop, const Vec &x)
{
  bool in = false;
  for (size_t k = 0; k < loop.size(); k++) {
    const Vec &a = loop[k], &b = loop[(k + 1) % loop.size()];
    if ((a[1] > x[1]) != (b[1] > x[1]) &&
        x[0] < a[0] + (b[0] - a[0]) * (x[1] - a[1]) / (b[1] - a[1]))
      in = !in;
  }
  return in;
}

// lines of two numbers, the corners of an outline; a line without ends it
static std::unique_ptr<Surface> surface_of_outline(LAMMPS *lmp, const std::string &file)
{
  if (lmp->domain->dimension == 3)
    lmp->error->all(FLERR, "Fsi/pack outline is for 2D: in 3D use stl");
  std::vector<std::vector<Vec>> loops(1);
  std::istringstream in(read(lmp, file));
  for (std::string line; std::getline(in, line);) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    Vec v = {};
    if (words >> v[0] >> v[1])
      loops.back().push_back(v);
    else if (!loops.back().empty())
      loops.emplace_back();
  }
  std::vector<std::array<Vec, 3>> faces;
  for (auto &loop : loops) {
    if (loop.size() > 1 && loop.front() == loop.back()) loop.pop_back();
    if (loop.size() < 3) continue;
    double area = 0.0;
    for (size_t k = 0; k < loop.size(); k++) area += cross(loop[k], loop[(k + 1) % loop.size()])[2];
    // a cavity goes round the other way
    const bool cavity = std::count_if(loops.begin(), loops.end(),
                                      [&](const auto &other) {
                                        return &other != &loop && is_in_loop(other, loop[0]);
                                      }) %
        2;
    if ((area < 0.0) != cavity) std::reverse(loop.begin(), loop.end());
    for (size_t k = 0; k < loop.size(); k++)
      faces.push_back({loop[k], loop[(k + 1) % loop.size()], Vec{}});
  }
  return std::make_unique<OfSimplices>(lmp, "file " + file, faces);
}

// ---- packing ----

// Widths in spacings: of the band in which particles move and of its edge; how near a surface the
// particles beside it are. Sweeps from one exchange between ranks to the next.
static constexpr double BAND = 8.0, EDGE = 2.0, BESIDE = 0.5;
static constexpr int ROUND = 20, ROUND_OF_LOOKS = 100;
// As much of a body must be on its lattice
static constexpr double COVERED = 0.98;
// Packed particles have a residue (root of the mean square) of some 0.005, a cut lattice 0.1
static constexpr double LOOSE = 0.05;
// The residue is at rest if it has not fallen to this in so many sweeps; from one word to the next
static constexpr double CALM = 0.99, SECONDS = 5.0;
// a particle that stays and is nearer than this takes the place of one that fills a side
static constexpr double TAKES_PLACE = 0.75;
// two that are nearer go apart to this: kernels do not see to it, their gradient is 0 at 0
static constexpr double APART = 0.6;

// part of a cell that is inside a plane, whose distance from the cell's middle is r
static double part_behind(double r, const double *normal, const double *size, int dim)
{
  double n[3], product = 1.0, half = 0.0, sum = 0.0;
  for (int d = 0; d < dim; d++) {
    n[d] = std::max(std::fabs(normal[d]), 1.0e-3) * size[d];    // the sum divides by all of them
    product *= (d + 1) * n[d];
    half += 0.5 * n[d];
  }
  for (int corner = 0; corner < (1 << dim); corner++) {
    double inside = half - r, sign = 1.0;
    for (int d = 0; d < dim; d++)
      if (corner >> d & 1) {
        inside -= n[d];
        sign = -sign;
      }
    sum += sign * std::pow(std::max(inside, 0.0), dim);
  }
  return std::clamp(sum / product, 0.0, 1.0);
}

namespace {

class Packing : protected Pointers {
  const Discretization *disc = nullptr;
  StepState *step = nullptr;
  Ledger *ledger = nullptr;
  std::unique_ptr<Surface> surface;
  // bits of groups, 0: there is none; still: a part of the body that stays as it is
  int body = 0, fluid = 0, still = 0, filler = 0, gone_at_once = 0, distant = 0;
  double band = 0.0;    // from the surface, in which particles move

  // of a cell, from its own distance, or those of its parts
  double volume_of_cell(const double *middle, const double *sides, double finest) const
  {
    const int dim = domain->dimension;
    double outward[3], square = 0.0, whole = 1.0;
    for (int d = 0; d < dim; d++) {
      square += sides[d] * sides[d];
      whole *= sides[d];
    }
    const double half_diagonal = 0.5 * std::sqrt(square),
                 r = surface->distance(middle, 1.01 * half_diagonal, outward);
    if (r >= half_diagonal) return 0.0;
    if (r <= -half_diagonal) return whole;
    if (half_diagonal <= finest) return whole * part_behind(r, outward, sides, dim);
    const double half[3] = {0.5 * sides[0], 0.5 * sides[1], 0.5 * sides[2]};
    double sum = 0.0;
    for (int part = 0; part < (1 << dim); part++) {
      double x[3] = {middle[0], middle[1], middle[2]};
      for (int d = 0; d < dim; d++) x[d] += (part >> d & 1 ? 0.5 : -0.5) * half[d];
      sum += volume_of_cell(x, half, finest);
    }
    return sum;
  }

  // A lattice in the whole box seldom has whole spacings in it: there the body ends with its cells
  void end_with_cells(double *lo, double *hi) const
  {
    std::vector<double> ends(7, -INFINITY);    // of cells: minus low, high; the widest
    for (int i = 0; i < atom->nlocal; i++) {
      if (!(atom->mask[i] & body)) continue;
      const double dx = disc->dx_of(atom->type[i]);
      for (int d = 0; d < 3; d++) {
        ends[d] = std::max(ends[d], 0.5 * dx - atom->x[i][d]);
        ends[3 + d] = std::max(ends[3 + d], 0.5 * dx + atom->x[i][d]);
      }
      ends[6] = std::max(ends[6], dx);
    }
    ends = over_ranks(ends, MPI_MAX, world);
    for (int d = 0; d < domain->dimension; d++) {
      if (domain->periodicity[d]) continue;
      if (std::fabs(lo[d] + ends[d]) < ends[6]) lo[d] = -ends[d];
      if (std::fabs(hi[d] - ends[3 + d]) < ends[6]) hi[d] = ends[3 + d];
    }
  }

  // in the box and before planes without end, from cells that each rank has of its own
  double volume_inside() const
  {
    const int dim = domain->dimension;
    const double dx = disc->levels.back().dx;
    double lo[3], hi[3], sides[3] = {}, x[3], sum = 0.0;
    std::copy_n(domain->boxlo, 3, lo);
    std::copy_n(domain->boxhi, 3, hi);
    end_with_cells(lo, hi);
    for (const auto &w : step->walls.wall) {
      if (w.finite) continue;
      double &end = w.side > 0.0 ? lo[w.axis] : hi[w.axis];
      end = w.side > 0.0 ? std::max(end, w.position) : std::min(end, w.position);
    }
    x[2] = 0.5 * (lo[2] + hi[2]);
    int from[3] = {}, to[3] = {1, 1, 1};
    // a whole number of cells, some four spacings wide, along each side
    for (int d = 0; d < dim; d++) {
      const int n = std::max(1, (int) std::ceil((hi[d] - lo[d]) / (4.0 * dx)));
      sides[d] = (hi[d] - lo[d]) / n;
      const auto first = [&](double place) {
        return std::clamp((int) std::ceil((place - lo[d]) / sides[d] - 0.5), 0, n);
      };
      from[d] = first(domain->sublo[d]);
      to[d] = first(domain->subhi[d]);
    }
    for (int c = from[2]; c < to[2]; c++)
      for (int b = from[1]; b < to[1]; b++)
        for (int a = from[0]; a < to[0]; a++) {
          const int k[3] = {a, b, c};
          for (int d = 0; d < dim; d++) x[d] = lo[d] + (k[d] + 0.5) * sides[d];
          sum += volume_of_cell(x, sides, 0.25 * dx);
        }
    return sum_of(sum, world);
  }

  double volume_of_still() const
  {
    double sum = 0.0;
    for (int i = 0; i < atom->nlocal; i++)
      if (atom->mask[i] & still) sum += atom->rmass[i] / disc->state[atom->type[i]].rho0;
    return sum_of(sum, world);
  }

  // of the cell of a particle
  double part_inside(int i) const
  {
    const double dx = disc->dx_of(atom->type[i]), sides[3] = {dx, dx, dx};
    return volume_of_cell(atom->x[i], sides, 0.125 * dx) / std::pow(dx, domain->dimension);
  }

  // The n particles of a group that are deepest inside, of equals by place: the same on any ranks
  std::vector<char> deepest(int bit, double n) const
  {
    std::vector<double> key(atom->nlocal, 1.0e9);
    double outward[3];
    for (int i = 0; i < atom->nlocal; i++) {
      if (!(atom->mask[i] & bit) || !step->walls.is_before_planes(atom->x[i])) continue;
      key[i] = std::floor(1.0e6 * surface->distance(atom->x[i], band, outward) / band + 0.5) +
          part_by_place(atom->x[i], domain);
    }
    const double limit = limit_of(key, n, -2.0e6, 2.0e6, world);
    std::vector<char> chosen(atom->nlocal);
    for (int i = 0; i < atom->nlocal; i++) chosen[i] = key[i] < limit;
    return chosen;
  }

  // Which particles are the body and which the fluid; others fill a side that has none meanwhile
  void choose(double volume)
  {
    double in_fluid = 0.0, in_body = 0.0,
           cell = 0.0;    // cells that are inside; of one of the body
    for (int i = 0; i < atom->nlocal; i++) {
      if (atom->mask[i] & fluid) in_fluid += part_inside(i);
      if (!(atom->mask[i] & body)) continue;
      if (step->walls.is_before_planes(atom->x[i])) in_body += part_inside(i);
      cell = std::pow(disc->dx_of(atom->type[i]), domain->dimension);
    }
    in_fluid = sum_of(in_fluid, world);
    in_body = sum_of(in_body, world);
    cell = over_ranks(cell, MPI_MAX, world);
    const double wanted = body && cell > 0.0 ? std::round(volume / cell) : 0.0;
    if (body && (wanted < 1.0 || in_body * cell < COVERED * volume))
      error->all(FLERR,
                 "Fsi/pack: {} holds {:g} particles of the body, its lattice has {:.4g} inside: "
                 "expected one that goes on beyond the surface",
                 surface->name(), wanted, in_body);
    const std::vector<char> none(atom->nlocal, 0);
    const auto inside = body ? deepest(body, wanted) : none,
               displaced = fluid ? deepest(fluid, std::round(in_fluid)) : none;
    // filler: on the outside where there is no fluid, on the inside where there is no body
    for (int i = 0; i < atom->nlocal; i++)
      if (atom->mask[i] & fluid && displaced[i])
        atom->mask[i] ^= fluid | (body ? gone_at_once : filler);
      else if (atom->mask[i] & body && !step->walls.is_before_planes(atom->x[i])) {
        if (part_inside(i) < 0.5) atom->mask[i] ^= body | gone_at_once;
      } else if (atom->mask[i] & body && !inside[i])
        atom->mask[i] ^= body | filler;
    renew_ghosts(lmp);
    // also other bodies, with which what moves would see two where one is
    const Cells staying(atom, disc->dim, disc->dx, [this](int i) {
      return disc->state[atom->type[i]].species != NONE &&
          !(atom->mask[i] & (body | filler | gone_at_once));
    });
    const double reach = band + disc->largest_cut;    // what moves sees no end of it
    double outward[3];
    for (int i = 0; i < atom->nlocal; i++) {
      if (!(atom->mask[i] & filler)) continue;
      bool fills = surface->distance(atom->x[i], reach, outward) < reach;
      const double least = TAKES_PLACE * disc->dx_of(atom->type[i]);
      if (fills)
        staying.around(atom->x[i], [&](int, double rsq) {
          fills = fills && rsq > least * least;
        });
      if (!fills) atom->mask[i] ^= filler | gone_at_once;
    }
  }

  // A particle stays on its side, half a spacing from the surface, in a corner from both faces;
  // returns how far off it is, 0 if it had to be moved
  double keep_off(int i, double side)
  {
    double outward[3], *const x = atom->x[i];
    const double least = BESIDE * disc->dx_of(atom->type[i]);
    for (int k = 0; k < domain->dimension + 1; k++) {
      const double r = surface->distance(atom->x[i], band, outward);
      if (side * r >= least || std::fabs(r) >= band) return k == 0 ? std::fabs(r) : 0.0;
      for (int d = 0; d < domain->dimension; d++) x[d] += (side * least - r) * outward[d];
    }
    return 0.0;
  }

  // all of the body have the same mass, together that of its volume
  void set_masses(double volume)
  {
    const auto in_body = [this](int i) {
      return (atom->mask[i] & body) != 0;
    };
    const bigint n = find_particles(atom, world, [&](int i) {
                       return in_body(i) && step->walls.is_before_planes(atom->x[i]);
                     }).count;
    if (comm->me == 0)
      utils::logmesg(lmp, "  fsi/pack: {} encloses {:.8g}, in {} particles of {:.8g} each\n",
                     surface->name(), volume, n, volume / n);
    for (int i = 0; i < atom->nlocal; i++)
      if (in_body(i)) atom->rmass[i] = disc->state[atom->type[i]].rho0 * volume / n;
  }

  void remove(const std::string &name)
  {
    const int bit = group->bitmask[group->find(name)];
    if (find_particles(atom, world, [&](int i) {
          return (atom->mask[i] & bit) != 0;
        }).count)
      input->one(fmt::format("delete_atoms group {} compress no", name));
    input->one(fmt::format("group {} delete", name));
  }

  // Also finds how far off the surface all that move are
  std::vector<double> part(const std::vector<double> &mobility, const std::vector<double> &side)
  {
    const int *const type = atom->type;
    const Cells all(atom, disc->dim, disc->dx, every);
    std::vector<std::array<double, 3>> shift(atom->nlocal, {0.0, 0.0, 0.0});
    for (int i = 0; i < atom->nlocal; i++) {
      if (mobility[i] <= 0.0) continue;
      all.around(atom->x[i], [&](int j, double rsq) {
        const double least = 0.5 * APART * (disc->dx_of(type[i]) + disc->dx_of(type[j]));
        if (i == j || rsq >= least * least) return;
        // those at one place along an axis
        const double r = std::sqrt(rsq), before = atom->tag[i] < atom->tag[j] ? -1.0 : 1.0;
        const bool same = r < 1.0e-6 * least;
        for (int d = 0; d < domain->dimension; d++)
          shift[i][d] += 0.5 * (least - r) *
              (same ? (d == 0 ? before : 0.0) : (atom->x[i][d] - atom->x[j][d]) / r);
      });
    }
    std::vector<double> off(atom->nlocal, 0.0);
    for (int i = 0; i < atom->nlocal; i++) {
      if (mobility[i] <= 0.0) continue;
      for (int d = 0; d < domain->dimension; d++) atom->x[i][d] += shift[i][d];
      off[i] = keep_off(i, side[i]);
    }
    comm->forward_comm();
    return off;
  }

  // Sweeps until the residue stays as it is, or as many as are given
  void sweep(int steps)
  {
    double residue[2] = {}, before = 1.0e300;    // the largest, and the root of the mean square
    bigint n = 0;
    int done = 0;
    double told = platform::walltime();
    while (done < steps) {
      renew_ghosts(lmp);
      step->gather_walls(lmp);
      std::vector<double> mobility(atom->nlocal, 0.0), side(atom->nlocal, 0.0);
      std::vector<char> judged(atom->nlocal, 0);
      double outward[3];
      for (int i = 0; i < atom->nlocal; i++) {
        int &mask = atom->mask[i];
        if (!(mask & (body | fluid | filler)) || mask & distant ||
            !step->walls.is_before_planes(atom->x[i]))
          continue;
        const double r = surface->distance(atom->x[i], band, outward),
                     dx = disc->dx_of(atom->type[i]);
        if (std::fabs(r) >= band) mask |= distant;    // and stays where it is
        mobility[i] = std::clamp((band - std::fabs(r)) / (EDGE * dx), 0.0, 1.0);
        judged[i] = mobility[i] == 1.0 && !(mask & filler);
        side[i] = mask & body ? -1.0 : mask & fluid ? 1.0 : r < 0.0 ? -1.0 : 1.0;
      }
      const auto off = part(mobility, side);
      constexpr double NEVER = BESIDE + ROUND * Settling::LONGEST;    // there in a round
      Settling settling(lmp, *disc, *step, *ledger, mobility, judged, [&](int i) {
        if (off[i] <= NEVER * disc->dx_of(atom->type[i])) keep_off(i, side[i]);
      });
      settling.run(std::min(ROUND, steps - done));
      done += std::min(ROUND, steps - done);
      const auto &here = settling.residue();
      n = count_of(here.n, world);
      residue[0] = over_ranks(here.largest, MPI_MAX, world);
      residue[1] = n ? std::sqrt(sum_of(here.squares, world) / n) : 0.0;
      if (comm->me == 0 && platform::walltime() - told > SECONDS) {
        told = platform::walltime();
        utils::logmesg(lmp, "  fsi/pack: {} of {} steps, residue {:.3g}, rms {:.3g}\n", done, steps,
                       residue[0], residue[1]);
      }
      if (done % ROUND_OF_LOOKS) continue;
      if (residue[1] > CALM * before) break;
      before = residue[1];
    }
    if (comm->me == 0)
      utils::logmesg(
          lmp,
          "  fsi/pack: {} steps; dx |sum V grad W| of {} particles within {:g} spacings of "
          "the surface: {:.3g} at most, {:.3g} rms\n",
          done, n, BAND - EDGE, residue[0], residue[1]);
    if (comm->me == 0 && residue[1] > LOOSE)
      error->warning(
          FLERR,
          "fsi/pack: the residue stays at {:.2g}: are there particles of another body in "
          "place of what is packed, or too few or too many?",
          residue[1]);
  }

  void refuse_in_two() const
  {
    const auto twice = find_particles(atom, world, [&](int i) {
      const int mask = atom->mask[i];
      return !!(mask & body) + !!(mask & fluid) + !!(mask & still) > 1;
    });
    if (twice.count)
      error->all(
          FLERR,
          "Fsi/pack: {} particles, the first of them atom {}, are in two of the groups body, "
          "fluid and still: expected groups that have none in common",
          twice.count, twice.first);
  }

  // packing would strain them
  void refuse_bonded() const
  {
    const auto *const bonds =
        dynamic_cast<FixFSIReference *>(modify->get_fix_by_id(FixFSIReference::ID));
    if (!bonds) return;
    const auto bonded = find_particles(atom, world, [&](int i) {
      return atom->mask[i] & body && bonds->has(i);
    });
    if (bonded.count)
      error->all(
          FLERR,
          "Fsi/pack: {} particles of the body, the first of them atom {}, have bonds since an "
          "earlier run: expected a body before its first run, if only run 0",
          bonded.count, bonded.first);
  }

 public:
  explicit Packing(LAMMPS *lmp) : Pointers(lmp) {}

  void pack(int narg, char **arg)
  {
    if (domain->box_exist == 0)
      error->all(FLERR, "Fsi/pack command before simulation box is defined");
    std::string names[3], region, stl, outline;
    int steps;
    Keywords keywords(lmp, "fsi/pack");
    keywords.argument("body group-ID").word(names[0], "");
    keywords.argument("fluid group-ID").word(names[1], "");
    keywords.key("region").word(region, "");
    keywords.key("stl").word(stl, "");
    keywords.key("outline").word(outline, "");
    keywords.key("still").word(names[2], "NULL");
    keywords.key("steps").integer(steps, 1000, 0);
    keywords.parse(narg, arg);
    int *const bits[3] = {&body, &fluid, &still};
    for (int k = 0; k < 3; k++)
      if (names[k] != "NULL") *bits[k] = group->bitmask[group_of(lmp, "Fsi/pack", names[k])];
    if (!body && !fluid) error->all(FLERR, "Fsi/pack NULL NULL has nothing to pack");
    if (!region.empty() + !stl.empty() + !outline.empty() != 1)
      error->all(FLERR, "Fsi/pack takes one of region, stl and outline");
    surface = !region.empty() ? surface_of_region(lmp, region)
        : !stl.empty()        ? surface_of_stl(lmp, stl)
                              : surface_of_outline(lmp, outline);
    FixFSI::find(lmp, "Fsi/pack")->link(disc, step, ledger);
    lmp->init();
    refuse_in_two();
    refuse_bonded();
    double finest = INFINITY;    // where levels meet only their events move what is there
    for (int i = 0; i < atom->nlocal; i++)
      if (atom->mask[i] & (fluid ? fluid : body))
        finest = std::min(finest, disc->dx_of(atom->type[i]));
    band = BAND * std::min(over_ranks(finest, MPI_MIN, world), disc->dx);
    renew_ghosts(lmp);
    step->gather_walls(lmp);
    const std::string fills = "FSI_PACK_FILLER", goes = "FSI_PACK_GONE";
    filler = group->bitmask[group->find_or_create(fills.c_str())];
    gone_at_once = group->bitmask[group->find_or_create(goes.c_str())];

    const double sampled = volume_inside(), of_faces = surface->volume();
    if (of_faces >= 0.0 && std::fabs(of_faces - sampled) > 0.01 * std::max(of_faces, sampled))
      error->all(FLERR,
                 "Fsi/pack: {} encloses {:g}, but its faces {:g}: expected a surface that does not "
                 "cross itself, inside the box",
                 surface->name(), sampled, of_faces);
    const double volume = (of_faces >= 0.0 ? of_faces : sampled) - volume_of_still();
    choose(volume);
    remove(goes);
    const std::string away = "FSI_PACK_FAR";
    distant = group->bitmask[group->find_or_create(away.c_str())];
    sweep(steps);
    input->one(fmt::format("group {} delete", away));
    if (body) set_masses(volume);
    remove(fills);
  }
};

}    // namespace

void FSIPack::command(int narg, char **arg)
{
  Packing(lmp).pack(narg, arg);
}
