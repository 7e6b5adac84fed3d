/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.
   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// Images against explicitly mirrored points; a segment's crossing rule against a ray followed from bounce to bounce.

#include "fsi_walls.h"
#include "reference.h"

#include <map>

using namespace LAMMPS_NS::FSI;

namespace {

constexpr double BIG = 1.0e300, CUT = 1.0;

struct Point {
  double x[3];
};
struct Image {
  double rsq, dx[3];
};
using Images = std::map<int, Image>;    // by the set of walls, as a bit mask

Wall make_wall(int axis, double side, double position)
{
  return {axis, side, position, {0, 0, 0}, false, false, {-BIG, -BIG, -BIG}, {BIG, BIG, BIG}};
}
Wall segment(Wall w, int axis, double lo, double hi)
{
  w.finite = true;
  w.lo[w.axis] = w.hi[w.axis] = 99.0;    // means nothing: the extent is along the other axes
  w.lo[axis] = lo;
  w.hi[axis] = hi;
  return w;
}
Walls make_walls(std::vector<Wall> list)
{
  Walls w;
  w.wall = std::move(list);
  w.find_reflections();
  return w;
}

double square(const double *a, const double *b)
{
  double s = 0.0;
  for (int d = 0; d < 3; d++) s += (a[d] - b[d]) * (a[d] - b[d]);
  return s;
}

// what the package finds
Images found(const Walls &walls, int mask, const Point &i, const Point &j)
{
  Images all;
  walls.images(mask, square(i.x, j.x), i.x, j.x, CUT * CUT,
               [&](const Walls::Reflection &s, double rsq, const double *dx) {
                 EXPECT_EQ(all.count(s.mask), 0u) << "image given twice";
                 all[s.mask] = {rsq, {dx[0], dx[1], dx[2]}};
               });
  return all;
}

// A ray from i towards the image, mirrored at each plane of the set as it meets it: does it hit all of them inside
// their extent? It must end at j.
bool reaches(const Walls &walls, int mask, const Point &i, const Point &j, const double *image)
{
  double x[3], u[3], left = 1.0;
  for (int d = 0; d < 3; d++) {
    x[d] = i.x[d];
    u[d] = image[d] - i.x[d];
  }
  while (mask) {
    int next = -1;
    double soonest = BIG;
    for (size_t k = 0; k < walls.wall.size(); k++) {
      const auto &w = walls.wall[k];
      if (!(mask & 1 << k)) continue;
      const double t = (w.position - x[w.axis]) / u[w.axis];
      if (t < soonest) {
        soonest = t;
        next = k;
      }
    }
    const auto &w = walls.wall[next];
    for (int d = 0; d < 3; d++) x[d] += soonest * u[d];
    for (int d = 0; d < 3; d++)
      if (d != w.axis && (x[d] < w.lo[d] || x[d] > w.hi[d])) return false;
    u[w.axis] = -u[w.axis];
    left -= soonest;
    mask &= ~(1 << next);
  }
  for (int d = 0; d < 3; d++) EXPECT_NEAR(x[d] + left * u[d], j.x[d], 1e-12);    // the ray itself is right
  return true;
}

// what there must be: every set of walls of different normals, the point mirrored at one after the other
Images mirrored(const Walls &walls, const Point &i, const Point &j)
{
  Images all;
  for (int mask = 1; mask < 1 << walls.wall.size(); mask++) {
    Point m = j;
    int axes = 0;
    bool possible = true;
    for (size_t k = 0; k < walls.wall.size(); k++) {
      if (!(mask & 1 << k)) continue;
      const auto &w = walls.wall[k];
      if (axes & 1 << w.axis) possible = false;
      axes |= 1 << w.axis;
      m.x[w.axis] = 2 * w.position - m.x[w.axis];
    }
    if (!possible || square(i.x, m.x) >= CUT * CUT || !reaches(walls, mask, i, j, m.x)) continue;
    Image &image = all[mask];
    image.rsq = square(i.x, m.x);
    for (int d = 0; d < 3; d++) image.dx[d] = i.x[d] - m.x[d];
  }
  return all;
}

void expect_equal(const Images &a, const Images &b)
{
  ASSERT_EQ(a.size(), b.size());
  for (const auto &[mask, image] : b) {
    ASSERT_EQ(a.count(mask), 1u) << "no image in walls " << mask;
    // sums of a few coordinates of size up to 3: some 1e-15
    EXPECT_NEAR(a.at(mask).rsq, image.rsq, 1e-14);
    for (int d = 0; d < 3; d++) EXPECT_NEAR(a.at(mask).dx[d], image.dx[d], 1e-14);
  }
}

// random pairs in the fluid near the walls: returns how many images of how many walls were seen, [0] for refused ones
struct Count {
  int images[4] = {};
};
Count compare(const Walls &walls, unsigned seed, int dim, int pairs = 4000)
{
  Random random(seed);
  Count count;
  Walls unbounded = walls;
  for (auto &w : unbounded.wall) w = make_wall(w.axis, w.side, w.position);
  for (int trial = 0; trial < pairs; trial++) {
    Point p[2] = {};
    for (auto &q : p)
      for (int d = 0; d < dim; d++) {
        double lo = -BIG, hi = BIG;
        for (const auto &w : walls.wall)
          if (w.axis == d) (w.side > 0 ? lo : hi) = w.position;
        if (hi == BIG) hi = lo == -BIG ? 0.4 : lo + 0.8;
        if (lo == -BIG) lo = hi - 0.8;
        q.x[d] = random(lo, hi);
      }
    if (trial % 4 == 0) p[1] = p[0];    // images of i itself
    const auto truth = mirrored(walls, p[0], p[1]);
    const int mask = walls.near(p[0].x, CUT) & walls.near(p[1].x, CUT);
    const auto ij = found(walls, mask, p[0], p[1]), ji = found(walls, mask, p[1], p[0]);
    expect_equal(ij, truth);
    if (::testing::Test::HasFailure()) return count;    // one is enough to read

    // j sees i's images where i sees j's, at the same distance, mirrored: forces come in pairs
    EXPECT_EQ(ij.size(), ji.size());
    for (const auto &[set, image] : ij) {
      Walls::Reflection reflection = {};
      for (const auto &s : walls.reflections)
        if (s.mask == set) reflection = s;
      count.images[reflection.n]++;
      EXPECT_GE(image.rsq, square(p[0].x, p[1].x) - 1e-15);    // so the pair loop sees the original, too
      if (!ji.count(set)) {
        ADD_FAILURE() << "not symmetric";
        continue;
      }
      double dx[3] = {-image.dx[0], -image.dx[1], -image.dx[2]};
      for (int k = 0; k < reflection.n; k++) dx[walls.wall[reflection.w[k]].axis] *= -1.0;
      EXPECT_NEAR(ji.at(set).rsq, image.rsq, 1e-14);
      for (int d = 0; d < 3; d++) EXPECT_NEAR(ji.at(set).dx[d], dx[d], 1e-14);
    }
    count.images[0] += mirrored(unbounded, p[0], p[1]).size() - truth.size();
  }
  return count;
}

}    // namespace

TEST(Walls, SingleWallOfEachOrientation)
{
  for (int axis = 0; axis < 3; axis++)
    for (double side : {1.0, -1.0})
      EXPECT_GT(compare(make_walls({make_wall(axis, side, 0.1 * (axis + 1))}), 1, 3, 1000).images[1], 100);
}

TEST(Walls, CornersOfABox)
{
  // opposite walls half a cutoff apart, so that each particle sees both: they have no common image
  const auto walls =
      make_walls({make_wall(0, 1, -0.25), make_wall(0, -1, 0.25), make_wall(1, 1, -0.1), make_wall(1, -1, 0.5)});
  EXPECT_EQ(walls.reflections.size(), 4u + 4u);
  const auto count = compare(walls, 2, 2);
  EXPECT_GT(count.images[1], 1000);
  EXPECT_GT(count.images[2], 1000);
}

TEST(Walls, TripleCorner)
{
  const auto walls = make_walls({make_wall(2, 1, -0.1), make_wall(0, -1, 0.2), make_wall(1, 1, 0.0)});
  EXPECT_EQ(walls.reflections.size(), 3u + 3u + 1u);
  const auto count = compare(walls, 3, 3);
  EXPECT_GT(count.images[1], 1000);
  EXPECT_GT(count.images[2], 500);
  EXPECT_GT(count.images[3], 100);
}

TEST(Walls, ClosedBoxHasAllCorners)
{
  std::vector<Wall> six;
  for (int axis = 0; axis < 3; axis++)
    for (double side : {1.0, -1.0}) six.push_back(make_wall(axis, side, -0.3 * side));
  const auto walls = make_walls(six);
  EXPECT_EQ(walls.reflections.size(), 6u + 12u + 8u);    // faces, edges, corners
  EXPECT_GT(compare(walls, 4, 3, 1000).images[3], 100);
}

TEST(Walls, FiniteSegments)
{
  auto count = compare(make_walls({segment(make_wall(0, 1, 0.0), 1, -0.1, 0.2)}), 5, 2);
  EXPECT_GT(count.images[1], 100);
  EXPECT_GT(count.images[0], 100);    // images that an unbounded wall would have given

  count = compare(make_walls({segment(make_wall(1, -1, 0.0), 0, -0.1, 0.2),
                              segment(make_wall(0, 1, -0.2), 1, -0.3, -0.1), make_wall(2, 1, 0.1)}),
                  6, 3);
  EXPECT_GT(count.images[1], 100);
  EXPECT_GT(count.images[0], 100);

  // extents along both axes of the plane
  count = compare(make_walls({segment(segment(make_wall(2, -1, 0.3), 0, -0.2, 0.1), 1, 0.0, 0.4)}), 7, 3);
  EXPECT_GT(count.images[1], 50);
  EXPECT_GT(count.images[0], 100);
}

// at a corner the unfolded line meets the second wall behind the first one: its extent counts where the ray really hits
TEST(Walls, FiniteCorners)
{
  auto count = compare(
      make_walls({segment(make_wall(0, 1, 0.0), 1, 0.0, 0.2), segment(make_wall(1, 1, 0.0), 0, 0.0, 0.2)}), 8, 2);
  EXPECT_GT(count.images[2], 100);
  EXPECT_GT(count.images[0], 100);
  count =
      compare(make_walls({segment(make_wall(0, -1, 0.0), 1, -0.2, -0.1), segment(make_wall(1, -1, 0.0), 2, 0.0, 0.2),
                          segment(segment(make_wall(2, 1, 0.0), 0, -0.3, 0.0), 1, -0.4, 0.0)}),
              9, 3, 20000);
  EXPECT_GT(count.images[2], 100);
  EXPECT_GT(count.images[3], 20);
  EXPECT_GT(count.images[0], 100);
  // an unbounded wall before the segment in the list must not stand for both
  count = compare(make_walls({make_wall(0, 1, 0.0), segment(make_wall(1, 1, 0.0), 0, 0.0, 0.15)}), 10, 2);
  EXPECT_GT(count.images[2], 100);
  EXPECT_GT(count.images[0], 100);
}

// by hand: from (0.1,0.2) to the double image (-0.3,-0.1) of (0.3,0.1). The line passes x = 0 at y = 0.125 and y = 0 at
// x = -1/6, which the wall x = 0 folds to +1/6.
TEST(Walls, FoldingByHand)
{
  const Point i = {{0.1, 0.2, 0}}, j = {{0.3, 0.1, 0}};
  const auto has_double = [&](double floor_from, double floor_to, double side_to) {
    const auto walls = make_walls(
        {segment(make_wall(1, 1, 0.0), 0, floor_from, floor_to), segment(make_wall(0, 1, 0.0), 1, 0.0, side_to)});
    const auto ij = found(walls, 3, i, j), ji = found(walls, 3, j, i);
    EXPECT_EQ(ij.count(3), ji.count(3));
    if (ij.count(3)) { EXPECT_NEAR(ij.at(3).rsq, 0.25, 1e-15); }    // (0.4, 0.3)
    return ij.count(3) == 1;
  };
  EXPECT_TRUE(has_double(0.0, 1.0, 1.0));
  EXPECT_TRUE(has_double(0.16, 0.17, 0.13));
  EXPECT_FALSE(has_double(0.17, 1.0, 1.0));
  EXPECT_FALSE(has_double(0.0, 0.16, 1.0));
  EXPECT_FALSE(has_double(-0.2, -0.1, 1.0));    // where the unfolded line passes
  EXPECT_FALSE(has_double(0.0, 1.0, 0.12));
}

// both particles on the plane: the crossing point is half-way, not 0/0
TEST(Walls, ParticlesOnThePlane)
{
  const auto walls = make_walls({segment(make_wall(1, 1, 0.5), 0, 0.0, 1.0)});
  const Point i = {{0.2, 0.5, 0}}, j = {{0.6, 0.5, 0}};
  const auto images = found(walls, 1, i, j);
  ASSERT_EQ(images.size(), 1u);
  EXPECT_NEAR(images.at(1).rsq, 0.16, 1e-15);
  EXPECT_EQ(found(make_walls({segment(make_wall(1, 1, 0.5), 0, 0.5, 1.0)}), 1, i, j).size(), 0u);
}

// only walls in the mask count, and the cutoff is strict
TEST(Walls, MaskAndCutoff)
{
  const auto walls = make_walls({make_wall(0, 1, 0.0), make_wall(1, 1, 0.0)});
  const Point i = {{0.1, 0.1, 0}};
  EXPECT_EQ(found(walls, 0, i, i).size(), 0u);
  EXPECT_EQ(found(walls, 1, i, i).size(), 1u);
  EXPECT_EQ(found(walls, 2, i, i).count(2), 1u);
  EXPECT_EQ(found(walls, 3, i, i).size(), 3u);
  const Point at = {{0.5, 0.0, 0}};    // its image is exactly one cutoff away
  EXPECT_EQ(found(walls, 1, at, at).size(), 0u);
}

TEST(Walls, Near)
{
  auto walls = make_walls({make_wall(0, 1, 1.0), make_wall(0, -1, 3.0), segment(make_wall(1, 1, 0.0), 0, 1.5, 2.0)});
  EXPECT_TRUE(walls.any());
  EXPECT_FALSE(Walls().any());
  const auto near = [&](double x, double y) {
    const Point p = {{x, y, 0}};
    return walls.near(p.x, 0.5);
  };
  EXPECT_EQ(near(1.0, 1.0), 1);      // on the plane
  EXPECT_EQ(near(0.999, 1.0), 0);    // behind it
  EXPECT_EQ(near(1.499, 1.0), 1);
  EXPECT_EQ(near(1.5, 1.0), 0);    // at the cutoff no more
  EXPECT_EQ(near(2.5, 1.0), 0);
  EXPECT_EQ(near(2.501, 1.0), 2);
  EXPECT_EQ(near(1.75, 0.1), 4);
  EXPECT_EQ(near(1.75, -0.1), 0);
  EXPECT_EQ(near(1.01, 0.1), 1 | 4);    // beyond the segment by less than the cutoff: a neighbor may see across it
  EXPECT_EQ(near(2.499, 0.1), 4);
  EXPECT_EQ(near(2.51, 0.1), 2);
  // the last bit of the mask; an int has no more
  static_assert(Walls::MAXWALL == 31, "one bit per wall");
  std::vector<Wall> many(Walls::MAXWALL, make_wall(0, 1, 0.0));
  for (int k = 0; k < Walls::MAXWALL; k++) many[k].position = k;
  walls = make_walls(many);
  EXPECT_EQ(near(Walls::MAXWALL - 1 + 0.25, 0.0), 1 << (Walls::MAXWALL - 1));
}

TEST(Walls, Moved)
{
  auto wall = make_wall(1, 1, 0.5);
  wall.velocity[0] = 3.0;    // along itself: the plane stays
  wall.velocity[1] = -2.0;
  const auto walls = make_walls({wall}), later = walls.moved(0.1);
  EXPECT_DOUBLE_EQ(later.wall[0].position, 0.3);
  EXPECT_EQ(walls.wall[0].position, 0.5);
  EXPECT_EQ(later.reflections.size(), 1u);
}

// image velocity = rate of change of the image's place while wall and particle move
TEST(Walls, SlipVelocity)
{
  Random random(11);
  auto walls = make_walls({make_wall(0, 1, 0.1), make_wall(1, -1, 0.4), make_wall(2, 1, -0.3)});
  for (auto &w : walls.wall) {
    for (double &v : w.velocity) v = random(-1.0, 1.0);
    w.noslip = true;    // counts for viscous forces only
  }
  const double v[3] = {0.3, -0.8, 0.5}, dt = 0.125;
  const auto later = walls.moved(dt);
  for (const auto &s : walls.reflections) {
    double image[3];
    Mirror(walls, s).reflect_velocity(v, image);
    for (int d = 0; d < 3; d++) {
      const double x0 = 0.2, x1 = x0 + dt * v[d];
      double m0 = x0, m1 = x1;
      for (size_t k = 0; k < walls.wall.size(); k++)
        if ((s.mask & 1 << k) && walls.wall[k].axis == d) {
          m0 = 2 * walls.wall[k].position - m0;
          m1 = 2 * later.wall[k].position - m1;
        }
      EXPECT_NEAR(image[d], (m1 - m0) / dt, 1e-14);    // linear in time; differences of O(1) over 0.125
    }
  }
}

// velocity of an image in viscous forces
void rub(const Mirror &mirror, const double *v, double *image)
{
  for (int d = 0; d < 3; d++) image[d] = mirror.rubbing_v[d] + mirror.rubbing_sign[d] * v[d];
}

// no slip: half-way between particle and image the fluid has the wall's velocity
TEST(Walls, NoSlipVelocity)
{
  auto wall = make_wall(1, 1, 0.0);
  wall.noslip = true;
  const double v[3] = {0.3, -0.8, 0.5}, moving[3] = {1.0, 0.25, -2.0};
  for (double scale : {0.0, 1.0}) {
    for (int d = 0; d < 3; d++) wall.velocity[d] = scale * moving[d];
    const auto walls = make_walls({wall});
    double image[3];
    rub(Mirror(walls, walls.reflections[0]), v, image);
    for (int d = 0; d < 3; d++) EXPECT_DOUBLE_EQ(0.5 * (image[d] + v[d]), wall.velocity[d]);
  }
  // a free-slip wall does not turn the velocity along it, for viscous forces neither
  wall.noslip = false;
  const auto walls = make_walls({wall});
  double image[3];
  rub(Mirror(walls, walls.reflections[0]), v, image);
  EXPECT_DOUBLE_EQ(image[0], v[0]);
  EXPECT_DOUBLE_EQ(image[1], 2 * wall.velocity[1] - v[1]);
  EXPECT_DOUBLE_EQ(image[2], v[2]);
}

// corner of a no-slip floor and a free-slip side, both at rest: turned around once, then mirrored at the side
TEST(Walls, MixedCornerVelocity)
{
  auto floor = make_wall(1, 1, 0.0), side = make_wall(0, 1, 0.0);
  floor.noslip = true;
  const auto walls = make_walls({floor, side});
  const double v[3] = {0.3, -0.8, 0.5}, truth[3] = {0.3, 0.8, -0.5};
  double image[3];
  for (const auto &s : walls.reflections)
    if (s.n == 2) rub(Mirror(walls, s), v, image);
  for (int d = 0; d < 3; d++) EXPECT_DOUBLE_EQ(image[d], truth[d]);
}
