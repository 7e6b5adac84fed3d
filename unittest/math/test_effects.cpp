/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.
   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// Viscosities, density diffusion, artificial stress: values by hand, signs, and, where the continuum operator is known,
// the lattice sum against it.

#include "exceptions.h"
#include "fsi_pair_laws.h"
#include "fsi_classic_laws.h"
#include "fsi_fluid_loops.h"
#include "fsi_kernel.h"
#include "fsi_pack.h"
#include "reference.h"

using namespace LAMMPS_NS::FSI;

namespace {

// Sums f(x_ij, rsq, gradient factor) over the neighbors of the origin of a fine lattice (h = 3 dx: the sum is then
// within 1e-3 of the integral), times V = dx^d.
constexpr double SPACING = 0.01, H = 3 * SPACING;

template <int D, class F> double lattice_sum(F &&f)
{
  const Quintic<D> kernel(H);
  const int n = 9, nz = D == 3 ? n : 0;
  double sum = 0.0;
  for (int i = -n; i <= n; i++)
    for (int j = -n; j <= n; j++)
      for (int k = -nz; k <= nz; k++) {
        const double x[3] = {-i * SPACING, -j * SPACING, -k * SPACING}, rsq = x[0] * x[0] + x[1] * x[1] + x[2] * x[2];
        if (rsq > 0.0 && rsq < kernel.cutsq) sum += f(x, rsq, kernel.gradient(std::sqrt(rsq)));
      }
  return sum * std::pow(SPACING, D);
}

}    // namespace

template <class T> class Continuum : public ::testing::Test {};
TYPED_TEST_SUITE(Continuum, Dimensions, DimensionName);

/* ---------------------------------------------------------------------- */

// paper eq. 14 and Monaghan (1992) by hand: h = 0.1, x = 0.08, v.x = -0.004 gives mu = -4e-4/(0.0064 + 0.0001)
TEST(ArtificialViscosity, Value)
{
  const double mu = -4e-4 / 0.0065, rho = 1000, c = 20, vv = 1e-4 * 1.2e-4;
  const ArtificialViscosity q(0.3, 0.7, 0.1);
  EXPECT_DOUBLE_EQ(q(-0.004, 0.0064, rho, c, vv), rho * vv * (-0.3 * c * mu + 0.7 * mu * mu));
  // each coefficient by itself
  EXPECT_DOUBLE_EQ(ArtificialViscosity(0.3, 0.0, 0.1)(-0.004, 0.0064, rho, c, vv), -rho * vv * 0.3 * c * mu);
  EXPECT_DOUBLE_EQ(ArtificialViscosity(0.0, 0.7, 0.1)(-0.004, 0.0064, rho, c, vv), rho * vv * 0.7 * mu * mu);
}

TEST(ArtificialViscosity, OnApproachOnly)
{
  const ArtificialViscosity q(0.3, 0.7, 0.1);
  for (double vdotx : {0.0, 1e-300, 0.004, 1e3}) EXPECT_EQ(q(vdotx, 0.0064, 1000.0, 20.0, 1e-8), 0.0);
  // repels on approach: with the kernel's negative gradient factor, F.v = -Q g x.v < 0
  for (double vdotx : {-1e-300, -0.004, -1e3}) EXPECT_GT(q(vdotx, 0.0064, 1000.0, 20.0, 1e-8), 0.0);
  EXPECT_TRUE(std::isfinite(q(-1e-12, 0.0, 1000.0, 20.0, 1e-8)));    // particles in one place
}

// Shear flow v_x = y^2/2, alpha only: all pairs would give the kinematic viscosity alpha c h/8 in 2D, alpha c h/10
// in 3D (Monaghan 2005, without eta), approaching pairs alone give half of it by symmetry.
TYPED_TEST(Continuum, ArtificialViscosityInShear)
{
  constexpr int D = TypeParam::value;
  const double alpha = 0.2, c = 15, rho = 900;
  const ArtificialViscosity q(alpha, 0.0, H);
  const double force = lattice_sum<D>([&](const double *x, double rsq, double g) {
    const double v = -0.5 * x[1] * x[1];    // v_i - v_j, along x
    return -q(v * x[0], rsq, rho, c, 1.0) * g * x[0];
  });
  const double nu = 0.5 * alpha * c * H / (D == 2 ? 8 : 10);
  // eta = 0.01 h^2 takes 1 % (mean r^2 is h^2), the lattice 0.1 %
  EXPECT_NEAR(force / (rho * nu), 1.0, 0.02);
}

/* ---------------------------------------------------------------------- */

// Morris et al. (1997), eq. 22: (mu_i + mu_j) x.gradW/r^2 v_ij, times V_i V_j
TEST(LaminarViscosity, Value)
{
  const double length_sq = 0.03;
  const LaminarViscosity<2> plain(0.0), central(length_sq);
  const double x[2] = {0.06, -0.04}, v[2] = {0.3, 0.7}, g = -25.0, vv = 2e-8, mu = 1.5e-3 + 0.5e-3;
  const double rsq = x[0] * x[0] + x[1] * x[1], xgrad = x[0] * (g * x[0]) + x[1] * (g * x[1]);
  const double k = vv * mu * xgrad / rsq;
  double f[2] = {1.0, 2.0};    // is added to
  EXPECT_NEAR(plain(g, mu, vv, x, v, f), -k * (0.3 * 0.3 + 0.7 * 0.7), 1e-14 * std::fabs(k));
  EXPECT_NEAR(f[0] - 1.0, k * v[0], 1e-15);
  EXPECT_NEAR(f[1] - 2.0, k * v[1], 1e-15);
  EXPECT_LT(k, 0.0);    // opposes v_ij
  // 2(d+2) times the mean viscosity, along the line of centers; 0 where v is normal to it
  double c[2] = {0.0, 0.0};
  const double vx = 0.3 * 0.06 - 0.7 * 0.04, kc = vv * 4.0 * mu * vx * g / length_sq;
  EXPECT_NEAR(central(g, mu, vv, x, v, c), -kc * vx, 1e-14 * std::fabs(kc * vx));
  EXPECT_NEAR(c[0], kc * x[0], 1e-14 * std::fabs(kc));
  EXPECT_NEAR(c[1], kc * x[1], 1e-14 * std::fabs(kc));
}

// force per volume = mu laplacian(v), here of v_x = y^2/2
TYPED_TEST(Continuum, LaminarViscosityInShear)
{
  const double mu = 0.7;
  for (bool central : {false, true}) {
    const Quintic<TypeParam::value> kernel(H);
    const LaminarViscosity<TypeParam::value> visc(central ? central_length_sq(kernel, SPACING) : 0.0);
    const double force = lattice_sum<TypeParam::value>([&](const double *x, double, double g) {
      const double v[3] = {-0.5 * x[1] * x[1], 0.0, 0.0};
      double f[3] = {0.0, 0.0, 0.0};
      visc(g, 2 * mu, 1.0, x, v, f);
      return f[0];
    });
    EXPECT_NEAR(force / mu, 1.0, 1e-4);
  }
}

// The central form with few neighbors: the viscosity given where rows slide along each other, whatever
// the kernel, and within some per cent on a lattice at rest, in any direction; with x (x) x/r^2, the
// usual one, 0.83 of it along the rows and 1.17 at 45 degrees (quintic, h = dx).
template <class K> double shear(double hdx, bool diagonal, double slide)
{
  const K kernel(hdx);
  const LaminarViscosity<K::DIM> visc(central_length_sq(kernel, 1.0));
  const int n = 4 * hdx + 1, nz = K::DIM == 3 ? n : 0;
  double f[3] = {};
  for (int i = -n - 1; i <= n; i++)
    for (int j = -n; j <= n; j++)
      for (int k = -nz; k <= nz; k++) {
        const double place = slide * (j + 1.41421 * k), at = i + place - std::floor(place);
        const double x[3] = {-at, -1.0 * j, -1.0 * k};
        // v_i - v_j = -y^2/2 along x, or along the diagonal
        const double y = diagonal ? (j - at) / std::sqrt(2.0) : j, v = -0.5 * y * y;
        const double u[3] = {diagonal ? v / std::sqrt(2.0) : v, diagonal ? v / std::sqrt(2.0) : 0.0, 0.0};
        visc(kernel.gradient(std::sqrt(at * at + j * j + k * k)), 2.0, 1.0, x, u, f);
      }
  return (diagonal ? (f[0] + f[1]) / std::sqrt(2.0) : f[0]) / lattice_number_density(kernel, 1.0);
}

template <class K> void expect_viscosity(double at_rest, std::initializer_list<double> widths)
{
  for (const double hdx : widths) {
    double sliding = 0.0;
    for (int n = 0; n < 100; n++) sliding += shear<K>(hdx, false, 0.6180339887 * n) / 100;
    EXPECT_NEAR(sliding, 1.0, 3e-3) << hdx;    // noise of 100 places of each row
    for (const bool diagonal : {false, true}) EXPECT_NEAR(shear<K>(hdx, diagonal, 0.0), 1.0, at_rest) << hdx;
  }
}

TYPED_TEST(Continuum, CentralViscosityOfFewNeighbors)
{
  constexpr int D = TypeParam::value;
  expect_viscosity<Quintic<D>>(0.005, {1.0, 1.3, 1.5});
  expect_viscosity<Wendland<D>>(0.06, {1.3, 1.5, 2.0});
  expect_viscosity<Cubic<D>>(0.06, {1.2, 1.3, 1.5});
}

/* ---------------------------------------------------------------------- */

TEST(DensityDiffusion, ExchangesMass)
{
  Random random(5);
  for (int trial = 0; trial < 100; trial++) {
    double g[3], x[3], back[3];
    for (int d = 0; d < 3; d++) {
      g[d] = random(-10, 10);
      back[d] = -(x[d] = random(-0.01, 0.01));
    }
    const DensityDiffusion flux(0.1, 0.01, 20);
    const double ri = random(990, 1010), rj = random(990, 1010), w = -random(1e6, 1e7);
    const double ij = flux(ri, rj, flux.hydrostatic(g, x, 2.5), w), ji = flux(rj, ri, flux.hydrostatic(g, back, 2.5), w);
    EXPECT_NE(ij, 0.0);
    EXPECT_DOUBLE_EQ(ij, -ji);    // the same sums with opposite signs, perhaps in another order
  }
}

// rho = rho0 (1 + b.x/c^2) with p = c^2 (rho - rho0) is at rest under the body force b
TEST(DensityDiffusion, NoneInHydrostaticEquilibrium)
{
  Random random(6);
  const double b[3] = {1.5, -9.81, 0.7}, zero[3] = {0, 0, 0}, rho0 = 1000, c = 20;
  const DensityDiffusion flux(0.1, 0.01, c);
  for (int trial = 0; trial < 100; trial++) {
    double xi[3], xj[3], ri = rho0, rj = rho0;
    for (int d = 0; d < 3; d++) {
      xi[d] = random(0, 1);
      xj[d] = random(0, 1);
      ri += rho0 * b[d] * xi[d] / (c * c);
      rj += rho0 * b[d] * xj[d] / (c * c);
    }
    const auto hydro = [&](const double *g) { return flux.hydrostatic(g, xi, rho0 / (c * c)) - flux.hydrostatic(g, xj, rho0 / (c * c)); };
    const double scale = 2 * 0.1 * 0.01 * c * 1e6;
    // round-off of densities of 1000
    EXPECT_NEAR(flux(ri, rj, hydro(b), -1e6) / scale, 0.0, 1e-12);
    EXPECT_NEAR(flux(ri, rj, hydro(zero), -1e6) / scale, rj - ri, 1e-11);
  }
}

// d rho/dt = delta h c laplacian(rho), here of rho = rho0 + x^2 + 2 y^2 (laplacian 6): spreads, does not steepen
TYPED_TEST(Continuum, DensityDiffusionOfParabola)
{
  const double b[3] = {0, -9.81, 0}, delta = 0.1, c = 20, rho0 = 1000;
  const DensityDiffusion flux(delta, H, c);
  const double rate = lattice_sum<TypeParam::value>([&](const double *x, double, double g) {
    return flux(rho0, rho0 + x[0] * x[0] + 2 * x[1] * x[1], flux.hydrostatic(b, x, rho0 / (c * c)), g);
  });
  EXPECT_NEAR(rate / (delta * H * c * 6), 1.0, 0.002);    // no eta here: the lattice only
}

/* ---------------------------------------------------------------------- */

template <class T> class Artificial : public ::testing::Test {};
TYPED_TEST_SUITE(Artificial, Dimensions, DimensionName);

TYPED_TEST(Artificial, StressFollowsPrincipalDirections)
{
  constexpr int D = TypeParam::value;
  Random random(9);
  const ArtificialStress artificial(0.3, 1.0);
  const double s[3] = {2.0, -1.0, -0.5}, expected[3] = {-0.3 * 2.0, 0.0, 0.0};
  for (int trial = 0; trial < 50; trial++) {
    const auto R = random_rotation<D>(random);
    const auto r = artificial(voigt<D>(R * diagonal<D>(s) * R.transposed()));
    EXPECT_LT(difference(full<D>(r), R * diagonal<D>(expected) * R.transposed()), 1e-14);    // eps |s| of Jacobi
  }
}

TYPED_TEST(Artificial, StressNoneInCompression)
{
  constexpr int D = TypeParam::value;
  Random random(10);
  const ArtificialStress artificial(0.3, 1.0);
  for (int trial = 0; trial < 50; trial++) {
    const double s[3] = {-random(0.1, 2), -random(0.1, 2), -random(0.1, 2)};
    const auto R = random_rotation<D>(random);
    const auto r = artificial(voigt<D>(R * diagonal<D>(s) * R.transposed()));
    EXPECT_EQ(difference(full<D>(r), Matrix<D>()), 0.0);
  }
}

// (W/W(dx))^4: 1 one spacing away, decays beyond it, large for a pair that clumps
TYPED_TEST(Artificial, StressWeight)
{
  const Cubic<TypeParam::value> kernel(1.3 * SPACING);
  const ArtificialStress artificial(0.3, kernel.W(SPACING));
  EXPECT_DOUBLE_EQ(artificial.weight(kernel.W(SPACING)), 1.0);
  for (double r : {0.0, 0.5, 0.9, 1.5, 2.0, 2.59, 2.7})
    EXPECT_NEAR(artificial.weight(kernel.W(r * SPACING)), std::pow(kernel.W(r * SPACING) / kernel.W(SPACING), 4),
                1e-14 * artificial.weight(kernel.W(r * SPACING)));    // a few multiplications
  EXPECT_GT(artificial.weight(kernel.W(0.5 * SPACING)), 1.0);
  EXPECT_EQ(artificial.weight(kernel.W(2.7 * SPACING)), 0.0);
}

/* ---------------------------------------------------------------------- */

// Coefficients by hand: Stokes' drag at Re -> 0, 24 (1 + 0.15) at Re = 1 (1^0.687 = 1), at Re = 100 24/100 (1 + 0.15 23.659)
// (100^0.687 = 10^1.374), Newton's 0.44 above Re = 1000; 1 % of it off at most where the two meet, and no jump
TEST(Drag, Sphere)
{
  const double rho = 1000.0, eta = 2e-3, d = 5e-4, pi = 3.14159265358979323846;
  const auto speed = [&](double Re) { return Re * eta / (rho * d); };
  const auto C = [&](double Re) { return drag_of_sphere(rho, eta, d, speed(Re)) / (pi / 8.0 * rho * d * d * speed(Re)); };
  EXPECT_DOUBLE_EQ(drag_of_sphere(rho, eta, d, 0.0), 3.0 * pi * eta * d);
  EXPECT_NEAR(C(1.0), 24.0 * 1.15, 1e-12);
  EXPECT_NEAR(C(100.0), 0.24 * (1.0 + 0.15 * std::pow(10.0, 1.374)), 1e-12);
  EXPECT_NEAR(C(5000.0), 0.44, 1e-12);
  double last = C(900.0);
  for (double Re = 901.0; Re < 1100.0; Re += 1.0) {
    EXPECT_NEAR(C(Re), last, 1e-3);
    last = C(Re);
  }
  EXPECT_DOUBLE_EQ(drag_of_sphere(rho, 0.0, d, 2.0), 0.055 * pi * rho * d * d * 2.0);
}

// -integral of p n dA/V over the wet part of a sphere, by latitudes: p = p0 - g z
TEST(Drag, SphereInSurface)
{
  const double r = 0.3, g = 7.0;
  const int n = 20000;
  for (double p0 = -2.5; p0 < 2.6; p0 += 0.25) {
    double force = 0.0;
    for (int k = 0; k < n; k++) {
      const double z = r * (-1.0 + (2 * k + 1.0) / n);
      force -= std::max(p0 - g * z, 0.0) * z / r * 2.0 * M_PI * r * 2.0 * r / n;
    }
    EXPECT_NEAR(immersed_part(p0, g, r), force / (4.0 / 3.0 * M_PI * r * r * r * g), 1e-6);
  }
  EXPECT_DOUBLE_EQ(immersed_part(0.0, 0.0, r), 1.0);
}

#if FSI_PACKS
// what no loop is there for is an error, not nothing: pairs that a thin body hides, several at a time
TEST(FluidLoops, RefuseWhatTheyHaveNotGot)
{
  const auto loops = make_fluid_loops(WENDLAND, 2, 0.1, true);
  const int j = 1;
  const double part = 1.0;
  FluidParticles in;
  in.visible = {&part, &j};
  double rate[2] = {};
  const auto ask = [&](const std::vector<Row> &rows) {
    loops->rates({WITH_FLUID, rows, nullptr, in}, {}, rate, nullptr, nullptr, nullptr);
  };
  EXPECT_NO_THROW(ask({}));
  EXPECT_THROW(ask({{0, 1, &j}}), LAMMPS_NS::LAMMPSException);
}
#endif
