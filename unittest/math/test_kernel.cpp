/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.
   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "fsi_kernel.h"

#include "gtest/gtest.h"

#include <cmath>
#include <string>
#include <vector>

using namespace LAMMPS_NS::FSI;

namespace {

constexpr double SPACING = 0.004, H = 1.3 * SPACING;    // not 1: powers of h must show

// paper, eq. 10
double paper_cubic(double s)
{
  if (s < 1) return 2.0 / 3.0 - s * s + s * s * s / 2.0;
  return s < 2 ? std::pow(2 - s, 3) / 6.0 : 0.0;
}
// paper, eq. 11
double paper_quintic(double s)
{
  if (s < 1) return std::pow(3 - s, 5) - 6.0 * std::pow(2 - s, 5) + 15.0 * std::pow(1 - s, 5);
  if (s < 2) return std::pow(3 - s, 5) - 6.0 * std::pow(2 - s, 5);
  return s < 3 ? std::pow(3 - s, 5) : 0.0;
}
// Wendland (1995) C2, support 2h
double wendland(double s)
{
  return s < 2 ? std::pow(1 - s / 2, 4) * (1 + 2 * s) : 0.0;
}

struct Case {
  const char *name;
  int kind, dim;
  double alpha;    // the paper's alpha_0 without 1/h^d; in 3D and for Wendland from the literature
  double (*shape)(double);
  std::vector<double> knots;    // ends of the polynomial pieces; the last is the support
  double curvature;             // second derivative of shape at 0, by hand
  double W(double r, double h) const
  {
    return alpha / std::pow(h, dim) * shape(r / h);
  }
};
void PrintTo(const Case &c, std::ostream *os)
{
  *os << c.name;
}

const Case CASES[] = {
    {"cubic_2D", CUBIC, 2, 15.0 / (7.0 * M_PI), paper_cubic, {0, 1, 2}, -2.0},
    {"cubic_3D", CUBIC, 3, 3.0 / (2.0 * M_PI), paper_cubic, {0, 1, 2}, -2.0},
    {"quintic_2D", QUINTIC, 2, 7.0 / (478.0 * M_PI), paper_quintic, {0, 1, 2, 3}, -120.0},
    {"quintic_3D", QUINTIC, 3, 1.0 / (120.0 * M_PI), paper_quintic, {0, 1, 2, 3}, -120.0},
    {"wendland_2D", WENDLAND, 2, 7.0 / (4.0 * M_PI), wendland, {0, 2}, -5.0},
    {"wendland_3D", WENDLAND, 3, 21.0 / (16.0 * M_PI), wendland, {0, 2}, -5.0},
};

// five-point Gauss-Legendre rule on (a,b), exact up to degree 9
template <class F> double integrate(double a, double b, F &&f)
{
  const double s = std::sqrt(10.0 / 7.0), n1 = std::sqrt(5 - 2 * s) / 3, n2 = std::sqrt(5 + 2 * s) / 3;
  const double w0 = 128.0 / 225, w1 = (322 + 13 * std::sqrt(70.0)) / 900, w2 = (322 - 13 * std::sqrt(70.0)) / 900;
  const double m = 0.5 * (a + b), l = 0.5 * (b - a);
  return l * (w0 * f(m) + w1 * (f(m - l * n1) + f(m + l * n1)) + w2 * (f(m - l * n2) + f(m + l * n2)));
}

class KernelTest : public ::testing::TestWithParam<Case> {
 public:
  template <class F> void with(F &&f)
  {
    with_kernel(GetParam().kind, GetParam().dim, H, f);
  }
};

}    // namespace

TEST_P(KernelTest, CoefficientsAsPrinted)
{
  const auto &c = GetParam();
  with([&](const auto &k) {
    EXPECT_EQ(k.DIM, c.dim);
    EXPECT_EQ(k.h, H);
    EXPECT_NEAR(k.W(0.0), c.W(0.0, H), 1e-14 * c.W(0.0, H));
    // up to 0.005 from the support, where the fifth power of 3 - q loses 5 * 3/0.005 roundings of 1e-16
    for (int n = 0; n < 350; n++) {
      const double r = (0.005 + 0.01 * n) * H, truth = c.W(r, H);
      EXPECT_NEAR(k.W(r), truth, 2e-12 * truth) << "r/h " << r / H;
    }
  });
}

TEST_P(KernelTest, ChosenAtRunTime)
{
  const ChosenKernel chosen(GetParam().kind, GetParam().dim, H);
  EXPECT_EQ(chosen.dim, GetParam().dim);
  EXPECT_EQ(chosen.h, H);
  with([&](const auto &k) {
    EXPECT_EQ(chosen.cut, k.cut);
    EXPECT_EQ(chosen.cutsq, k.cutsq);
    EXPECT_EQ(chosen.hinv, k.hinv);
    for (double r = 0.0; r < 1.1 * k.cut; r += 0.07 * H) {
      EXPECT_EQ(chosen.W(r), k.W(r));
      EXPECT_EQ(chosen.gradient(r), k.gradient(r));
      EXPECT_EQ(chosen.curvature(r), k.curvature(r));
      EXPECT_EQ(chosen.sharper(r, 0.03), k.sharper(r, 0.03));
      EXPECT_EQ(chosen.sharper_gradient(r, 0.03), k.sharper_gradient(r, 0.03));
    }
  });
}

TEST_P(KernelTest, UnitIntegral)
{
  const auto &c = GetParam();
  with([&](const auto &k) {
    double sum = 0.0;
    // each piece times r or r^2 is a polynomial of degree 7 at most, which the rule integrates exactly: 1e-10 is
    // the requirement, round-off would be 1e-15
    for (size_t n = 1; n < c.knots.size(); n++)
      sum += integrate(c.knots[n - 1] * H, c.knots[n] * H,
                       [&](double r) { return k.W(r) * (c.dim == 2 ? 2 * M_PI * r : 4 * M_PI * r * r); });
    EXPECT_NEAR(sum, 1.0, 1e-10);
  });
}

TEST_P(KernelTest, GradientIsDerivative)
{
  const auto &c = GetParam();
  with([&](const auto &k) {
    for (size_t n = 1; n < c.knots.size(); n++) {
      const double lo = c.knots[n - 1] * H, piece = c.knots[n] * H - lo, e = 0.02 * piece;
      for (double s = 0.1; s < 0.95; s += 0.05) {
        // sixth-order central difference that stays inside the piece: exact for its polynomial of degree <= 5, so
        // only round-off is left; 1e-8 is the requirement
        const double r = lo + s * piece;
        const auto d = [&](int m) { return k.W(r + m * e) - k.W(r - m * e); };
        const double derivative = (45.0 * d(1) - 9.0 * d(2) + d(3)) / (60.0 * e);
        EXPECT_LT(derivative, 0.0);
        EXPECT_NEAR(k.gradient(r) * r, derivative, 1e-8 * std::fabs(derivative)) << "r/h " << r / H;
        const auto slope = [&](int m) { return k.gradient(r + m * e) * (r + m * e) - k.gradient(r - m * e) * (r - m * e); };
        EXPECT_NEAR(k.curvature(r), (45.0 * slope(1) - 9.0 * slope(2) + slope(3)) / (60.0 * e), 1e-8 * std::fabs(k.curvature(0.0)))
            << "r/h " << r / H;
      }
    }
  });
}

// of neighbors on a finer lattice
TEST_P(KernelTest, SharperGradientIsDerivative)
{
  const auto &c = GetParam();
  with([&](const auto &k) {
    const double sharp = 0.0185;    // (1 - 0)/24 (dx/h)^2 of h = 1.5 dx
    for (size_t n = 1; n < c.knots.size(); n++) {
      const double lo = c.knots[n - 1] * H, piece = c.knots[n] * H - lo, e = 0.01 * piece;
      for (double s = 0.25; s < 0.9; s += 0.05) {
        // a difference of sixth order of functions with 1/q in them, which is 0.25 at the least
        const double r = lo + s * piece;
        const auto d = [&](int m) { return k.sharper(r + m * e, sharp) - k.sharper(r - m * e, sharp); };
        EXPECT_NEAR(k.sharper_gradient(r, sharp) * r, (45.0 * d(1) - 9.0 * d(2) + d(3)) / (60.0 * e), 1e-7 * std::fabs(k.gradient(0.0) * H));
        EXPECT_EQ(k.sharper_gradient(r, 0.0), k.gradient(r));
      }
    }
    EXPECT_EQ(k.sharper_gradient(2.0 * k.cut, sharp), 0.0);
  });
}

// The mean over a cell of side a, by the midpoint rule over 8 parts of a side, is the kernel in its middle, but for terms of order a^4: 16 times
// less for half the side. (The cubic's third derivative jumps, so that it has no such order where a cell crosses a knot: not here.)
TEST_P(KernelTest, MeanOfSharperOverACellIsTheKernel)
{
  const auto &c = GetParam();
  with([&](const auto &k) {
    constexpr int N = 8;
    const double r = (c.knots[0] + 0.5 * (c.knots[1] - c.knots[0])) * H;
    const auto error = [&](double a) {
      double mean = 0.0;
      for (int z = 0; z < (c.dim == 3 ? N : 1); z++)
        for (int y = 0; y < N; y++)
          for (int x = 0; x < N; x++) {
            const auto at = [&](int i) { return a * ((i + 0.5) / N - 0.5); };
            const double d[] = {r + at(x), at(y), c.dim == 3 ? at(z) : 0.0};
            mean += k.sharper(std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]), a * a * (1.0 - 1.0 / (N * N)) / (24.0 * H * H));
          }
      return std::fabs(mean / std::pow(N, c.dim) - k.W(r));
    };
    const double a = 0.3 * H;
    EXPECT_LT(error(a), 3e-3 * k.W(0.0));
    EXPECT_LT(error(0.5 * a), 0.1 * error(a));
  });
}

TEST_P(KernelTest, GradientFiniteAtZero)
{
  const auto &c = GetParam();
  with([&](const auto &k) {
    // (dW/dr)/r tends to the second derivative; one division and one multiplication: 1e-15, and linear in q beside it
    const double limit = c.alpha / std::pow(H, c.dim + 2) * c.curvature;
    EXPECT_NEAR(k.gradient(0.0), limit, 1e-14 * std::fabs(limit));
    EXPECT_NEAR(k.curvature(0.0), limit, 1e-14 * std::fabs(limit));
    EXPECT_NEAR(k.gradient(1e-9 * H), limit, 1e-8 * std::fabs(limit));
  });
}

TEST_P(KernelTest, SupportAndContinuity)
{
  const auto &c = GetParam();
  with([&](const auto &k) {
    const double support = c.knots.back();
    EXPECT_EQ(kernel_support(c.kind), support);
    EXPECT_DOUBLE_EQ(k.cut, support * H);
    EXPECT_DOUBLE_EQ(k.cutsq, support * H * support * H);
    for (double q : {support, support + 1e-12, support + 0.5, 100.0}) {
      EXPECT_EQ(k.w(q), 0.0);
      EXPECT_EQ(k.dwq(q), 0.0);
    }
    EXPECT_GT(k.w(support - 1e-3), 0.0);
    // left and right of a knot one rounding apart: a jump would be of the order of w(0), round-off is 1e-15 of it
    for (size_t n = 1; n < c.knots.size(); n++) {
      const double right = c.knots[n], left = std::nextafter(right, 0.0);
      EXPECT_NEAR(k.w(left), k.w(right), 1e-14 * k.w(0.0)) << "knot " << right;
      EXPECT_NEAR(k.dwq(left), k.dwq(right), 1e-14 * std::fabs(c.curvature)) << "knot " << right;
    }
  });
}

TEST_P(KernelTest, LatticeNumberDensity)
{
  const auto &c = GetParam();
  for (double ratio : {1.0, 1.2, 1.3, 1.5, 2.0}) {
    const double h = ratio * SPACING;
    double sum = 0.0;
    const int n = 8, nz = c.dim == 3 ? n : 0;
    for (int x = -n; x <= n; x++)
      for (int y = -n; y <= n; y++)
        for (int z = -nz; z <= nz; z++) sum += c.W(SPACING * std::sqrt(double(x * x + y * y + z * z)), h);
    with_kernel(c.kind, c.dim, h, [&](const auto &k) {
      // the same sum over up to 1000 terms in another order: round-off 1e-13
      EXPECT_NEAR(lattice_number_density(k, SPACING), sum, 1e-12 * sum) << "h/dx " << ratio;
      // quadrature of a unit integral: smooth splines within 0.4 %, Wendland's peak within 4 %
      EXPECT_NEAR(sum * std::pow(SPACING, c.dim), 1.0, c.kind == WENDLAND ? 0.04 : 0.004) << "h/dx " << ratio;
    });
  }
}

INSTANTIATE_TEST_SUITE_P(Kernels, KernelTest, ::testing::ValuesIn(CASES),
                         [](const auto &info) { return std::string(info.param.name); });

/* ---------------------------------------------------------------------- */

// the table of the design notes: psi/psi_bulk of a square lattice by layer from a flat free edge, and at a corner
struct Edge {
  const char *name;
  int kind;
  double ratio;
  int neighbors;
  double layer[3], corner;
};
void PrintTo(const Edge &e, std::ostream *os)
{
  *os << e.name;
}

class FreeEdge : public ::testing::TestWithParam<Edge> {};

TEST_P(FreeEdge, NumberDensity)
{
  const auto &e = GetParam();
  with_kernel(e.kind, 2, e.ratio * SPACING, [&](const auto &k) {
    // sum over the lattice points x >= -left, y >= -below of the particle at the origin
    int count = 0;
    const auto sum = [&](int left, int below) {
      double psi = 0.0;
      count = -1;    // itself
      for (int x = -left; x <= 9; x++)
        for (int y = -below; y <= 9; y++) {
          const double r = SPACING * std::sqrt(double(x * x + y * y));
          psi += k.W(r);
          if (r < k.cut * (1 - 1e-12)) count++;
        }
      return psi;
    };
    const double bulk = lattice_number_density(k, SPACING);
    EXPECT_NEAR(sum(9, 9), bulk, 1e-12 * bulk);
    EXPECT_EQ(count, e.neighbors);
    // three printed digits
    for (int n = 0; n < 3; n++) EXPECT_NEAR(sum(n, 9) / bulk, e.layer[n], 0.0005) << "layer " << n + 1;
    EXPECT_NEAR(sum(0, 0) / bulk, e.corner, 0.0005);
  });
}

INSTANTIATE_TEST_SUITE_P(Kernels, FreeEdge,
                         ::testing::Values(Edge{"cubic_12", CUBIC, 1.2, 20, {.785, .997, 1.}, .614},
                                           Edge{"cubic_13", CUBIC, 1.3, 20, {.763, .990, 1.}, .581},
                                           Edge{"cubic_15", CUBIC, 1.5, 24, {.728, .972, 1.}, .528},
                                           Edge{"quintic_10", QUINTIC, 1.0, 24, {.780, .993, 1.}, .607},
                                           Edge{"quintic_13", QUINTIC, 1.3, 44, {.715, .960, .999}, .511},
                                           Edge{"quintic_15", QUINTIC, 1.5, 68, {.686, .931, .995}, .471},
                                           Edge{"wendland_13", WENDLAND, 1.3, 20, {.786, .995, 1.}, .617},
                                           Edge{"wendland_20", WENDLAND, 2.0, 44, {.686, .927, .995}, .471}),
                         [](const auto &info) { return std::string(info.param.name); });

// a mass of rho0 dx^d instead of rho0/psi_bulk would be wrong by this much (0.34 % for cubic 1.5)
TEST(NumberDensity, BiasOfNaiveMass)
{
  const Cubic<2> k(1.5 * SPACING);
  EXPECT_NEAR(lattice_number_density(k, SPACING) * SPACING * SPACING - 1.0, 0.0034, 0.00005);
}
