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

#include "fsi_surface.h"

#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fsi_keywords.h"
#include "math_const.h"
#include "math_extra.h"
#include "region.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>

using namespace LAMMPS_NS;
using namespace FSI;

namespace {
typedef std::array<double, 3> Vector;

Vector operator-(const Vector &a, const Vector &b)
{
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Vector operator+(const Vector &a, const Vector &b)
{
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
Vector operator*(double k, const Vector &a)
{
  return {k * a[0], k * a[1], k * a[2]};
}
double operator*(const Vector &a, const Vector &b)
{
  return MathExtra::dot3(a.data(), b.data());
}
Vector cross(const Vector &a, const Vector &b)
{
  Vector c;
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
  std::vector<Vector> points;
  std::vector<std::array<int, 3>> faces;    // of the points; in 2D of two
  std::vector<Vector> normals, of_points;
  std::vector<double> radii;    // of faces around their first points
  std::map<std::pair<int, int>, Vector> of_edges;
  mutable double size = 0.0;    // of the cells
  mutable std::array<double, 3> low = {};
  mutable std::array<int, 3> count = {};
  mutable std::vector<std::vector<int>> cells;

 public:
  OfSimplices(LAMMPS *lmp, const std::string &label, std::vector<std::array<Vector, 3>> given) :
      error(lmp->error), label(label), dim(lmp->domain->dimension)
  {
    std::map<Vector, int> known;
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
      const Vector &a = points[f[0]], &b = points[f[1]];
      sum += dim == 2 ? 0.5 * (a[0] * b[1] - a[1] * b[0]) : a * cross(b, points[f[2]]) / 6.0;
    }
    return sum;
  }

  double distance(const double *place, double band, double *outward) const override
  {
    if (size < band) sort(band);
    const Vector x = {place[0], place[1], dim == 3 ? place[2] : 0.0};
    double least = size * size;
    Vector nearest = {}, normal = {};
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
    const Vector away = x - nearest;
    const double r = std::sqrt(least), sign = away * normal < 0.0 ? -1.0 : 1.0;
    if (r >= band) return sign * band;
    const Vector out = r > 0.0 ? sign / r * away : 1.0 / std::sqrt(normal * normal) * normal;
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
    const Vector &p = points[open->first.first];
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
      const Vector &a = points[f[0]], &b = points[f[1]];
      Vector n = dim == 2 ? Vector{b[1] - a[1], a[0] - b[0], 0.0} : cross(b - a, points[f[2]] - a);
      const double length = std::sqrt(n * n);
      if (length > 0.0) n = 1.0 / length * n;
      normals.push_back(n);
      double farthest = 0.0;
      for (int k = 1; k < dim; k++)
        farthest = std::max(farthest, (points[f[k]] - a) * (points[f[k]] - a));
      radii.push_back(1.000001 * std::sqrt(farthest));
      for (int k = 0; k < dim; k++) {
        const Vector &p = points[f[k]];
        double angle = 1.0;
        if (dim == 3) {
          const Vector u = points[f[(k + 1) % 3]] - p, v = points[f[(k + 2) % 3]] - p;
          angle = std::atan2(std::sqrt(cross(u, v) * cross(u, v)), u * v);
          auto &edge = of_edges[std::minmax(f[k], f[(k + 1) % 3])];
          edge = edge + n;
        }
        of_points[f[k]] = of_points[f[k]] + angle * n;
      }
    }
  }

  // the nearest point of a face and the normal there, if its squared distance is less
  void take_nearer(int k, const Vector &x, double &least, Vector &at, Vector &normal) const
  {
    const auto &f = faces[k];
    const Vector &a = points[f[0]], &b = points[f[1]];
    const auto take = [&](const Vector &there) {
      const double rsq = (x - there) * (x - there);
      if (rsq >= least) return false;
      least = rsq;
      at = there;
      return true;
    };
    const auto take_of_edge = [&](int p, int q) {
      const Vector along = points[q] - points[p];
      const double t = std::clamp((x - points[p]) * along / (along * along), 0.0, 1.0);
      if (!take(points[p] + t * along)) return;
      normal = t == 0.0 ? of_points[p]
          : t == 1.0    ? of_points[q]
          : dim == 2    ? normals[k]
                        : of_edges.at(std::minmax(p, q));
    };
    if (dim == 2) return take_of_edge(f[0], f[1]);
    const Vector u = b - a, v = points[f[2]] - a, w = x - a;
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
    Vector high = points[0];
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
  bool is_inside(const Vector &x) const
  {
    double sum = 0.0;
    for (const auto &f : faces) {
      const Vector a = points[f[0]] - x, b = points[f[1]] - x;
      if (dim == 2) {
        sum += std::atan2(a[0] * b[1] - a[1] * b[0], a * b);
        continue;
      }
      const Vector c = points[f[2]] - x;
      const double la = std::sqrt(a * a), lb = std::sqrt(b * b), lc = std::sqrt(c * c);
      sum += std::atan2(a * cross(b, c), la * lb * lc + (a * b) * lc + (b * c) * la + (c * a) * lb);
    }
    return sum > MathConst::MY_PI;    // 2 pi in 2D; half of 4 pi in 3D
  }
};
}    // namespace

std::unique_ptr<Surface> FSI::surface_of_region(LAMMPS *lmp, const std::string &id)
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
std::unique_ptr<Surface> FSI::surface_of_stl(LAMMPS *lmp, const std::string &file)
{
  if (lmp->domain->dimension == 2)
    lmp->error->all(FLERR, "Fsi/pack stl is for 3D: in 2D use outline");
  const std::string text = read(lmp, file);
  std::vector<std::array<Vector, 3>> faces;
  uint32_t n = 0;
  if (text.size() >= 84) std::memcpy(&n, &text[80], 4);
  if (text.size() >= 84 && text.size() == 84 + 50 * (size_t) n) {
    for (size_t k = 0; k < n; k++) {
      float of[12];
      std::memcpy(of, &text[84 + 50 * k], sizeof of);
      faces.push_back(
          {Vector{of[3], of[4], of[5]}, {of[6], of[7], of[8]}, {of[9], of[10], of[11]}});
    }
  } else {
    std::vector<Vector> corners;
    std::istringstream in(text);
    for (std::string word; in >> word;) {
      Vector v;
      if (word == "vertex" && in >> v[0] >> v[1] >> v[2]) corners.push_back(v);
    }
    if (corners.empty() || corners.size() % 3)
      lmp->error->all(FLERR, "Fsi/pack file {} is no STL file", file);
    for (size_t k = 0; k < corners.size(); k += 3)
      faces.push_back({corners[k], corners[k + 1], corners[k + 2]});
  }
  return std::make_unique<OfSimplices>(lmp, "file " + file, faces);
}

static bool is_in_loop(const std::vector<Vector> &loop, const Vector &x)
{
  bool in = false;
  for (size_t k = 0; k < loop.size(); k++) {
    const Vector &a = loop[k], &b = loop[(k + 1) % loop.size()];
    if ((a[1] > x[1]) != (b[1] > x[1]) &&
        x[0] < a[0] + (b[0] - a[0]) * (x[1] - a[1]) / (b[1] - a[1]))
      in = !in;
  }
  return in;
}

// lines of two numbers, the corners of an outline; a line without ends it
std::unique_ptr<Surface> FSI::surface_of_outline(LAMMPS *lmp, const std::string &file)
{
  if (lmp->domain->dimension == 3)
    lmp->error->all(FLERR, "Fsi/pack outline is for 2D: in 3D use stl");
  std::vector<std::vector<Vector>> loops(1);
  std::istringstream in(read(lmp, file));
  for (std::string line; std::getline(in, line);) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    Vector v = {};
    if (words >> v[0] >> v[1])
      loops.back().push_back(v);
    else if (!loops.back().empty())
      loops.emplace_back();
  }
  std::vector<std::array<Vector, 3>> faces;
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
      faces.push_back({loop[k], loop[(k + 1) % loop.size()], Vector{}});
  }
  return std::make_unique<OfSimplices>(lmp, "file " + file, faces);
}
