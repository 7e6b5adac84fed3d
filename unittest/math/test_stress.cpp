/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.
   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// The Jaumann update alone, driven by prescribed velocity gradients. L of time n takes S from n-1/2 to n+1/2.

#include "fsi_solid_laws.h"
#include "reference.h"

using namespace LAMMPS_NS::FSI;

namespace {

constexpr double G = 2.0;

template <int D> Matrix<D> shear_gradient(double rate)
{
  Matrix<D> L;
  L(0, 1) = rate;    // v_x = rate y
  return L;
}

// stress after simple shear gamma, from n steps
template <int D> Matrix<D> sheared(double gamma, int n, const Matrix<D> &R)
{
  const double dt = 0.01;
  const auto L = R * shear_gradient<D>(gamma / (n * dt)) * R.transposed();
  Sym<D> s;
  for (int k = 0; k < n; k++) jaumann_update<D>(s, L.a, dt, G, false);
  return full<D>(s);
}

// closed form (Dienes 1979): the spin is gamma/2 per unit, so the stress oscillates
template <int D> Matrix<D> sheared_exactly(double gamma, const Matrix<D> &R)
{
  Matrix<D> s;
  s(0, 0) = G * (1 - std::cos(gamma));
  s(1, 1) = -s(0, 0);
  s(0, 1) = s(1, 0) = G * std::sin(gamma);
  return R * s * R.transposed();
}

template <int D> double determinant(const Matrix<D> &m)
{
  if constexpr (D == 2)
    return m(0, 0) * m(1, 1) - m(0, 1) * m(1, 0);
  else
    return m(0, 0) * (m(1, 1) * m(2, 2) - m(1, 2) * m(2, 1)) - m(0, 1) * (m(1, 0) * m(2, 2) - m(1, 2) * m(2, 0)) +
        m(0, 2) * (m(1, 0) * m(2, 1) - m(1, 1) * m(2, 0));
}

}    // namespace

template <class T> class Jaumann : public ::testing::Test {
 public:
  static constexpr int D = T::value;
  Random random{1979};
  Matrix<D> random_deviator()
  {
    auto m = random_matrix<D>(random, 1.0);
    m = m + m.transposed();
    double trace = 0.0;
    for (int a = 0; a < D; a++) trace += m(a, a);
    for (int a = 0; a < D; a++) m(a, a) -= trace / D;
    return m;
  }
};
TYPED_TEST_SUITE(Jaumann, Dimensions, DimensionName);

// also in a plane that lies askew: then the axis of the spin is no coordinate axis
TYPED_TEST(Jaumann, SimpleShear)
{
  constexpr int D = TypeParam::value;
  for (int trial = 0; trial < 5; trial++) {
    const auto R = trial ? random_rotation<D>(this->random) : unit<D>();
    // the requirement: 1e-4 of G at shear 4 in 400 steps; the scheme's dgamma^2 gamma/24 gives 2e-5
    for (int k = 1; k <= 4; k++)
      EXPECT_LT(difference(sheared<D>(k, 100 * k, R), sheared_exactly<D>(k, R)), 1e-4 * G) << "shear " << k;
  }
}

TYPED_TEST(Jaumann, SecondOrderInTime)
{
  constexpr int D = TypeParam::value;
  const auto R = unit<D>();
  const auto error = [&](int n) { return difference(sheared<D>(3.0, n, R), sheared_exactly<D>(3.0, R)); };
  // fourth-order terms are below dgamma^2 = 1e-2 of the error at these steps; first order would give 1
  EXPECT_NEAR(std::log2(error(40) / error(80)), 2.0, 0.02);
  EXPECT_NEAR(std::log2(error(80) / error(160)), 2.0, 0.02);
}

// ten turns of a stressed body about a skew axis: nothing but the directions changes
TYPED_TEST(Jaumann, RigidSpinKeepsInvariants)
{
  constexpr int D = TypeParam::value;
  const int turns = 10, per_turn = 360;
  auto L = antisymmetric<D>(random_matrix<D>(this->random, 1.0));
  double rate = 0.0;
  for (double x : L.a) rate += 0.5 * x * x;
  L = (2 * M_PI / std::sqrt(rate)) * L;    // one turn per unit of time

  const auto before = this->random_deviator();
  auto s = voigt<D>(before);
  double farthest = 0.0;
  for (int k = 1; k <= turns * per_turn; k++) {
    jaumann_update<D>(s, L.a, 1.0 / per_turn, G, false);
    const auto now = full<D>(s);
    farthest = std::fmax(farthest, difference(now, before));
    // 3600 rotations of some eps each: 1e-12; 1e-10 is the requirement
    double trace = 0.0;
    for (int a = 0; a < D; a++) trace += now(a, a);
    ASSERT_NEAR(trace, 0.0, 1e-10);
    ASSERT_NEAR(s.squared(), voigt<D>(before).squared(), 1e-10);
    ASSERT_NEAR(determinant<D>(now), determinant<D>(before), 1e-10);
    // the exact place at a time that is no whole turn
    if (k == 100) {
      const auto Q = exponential<D>((100.0 / per_turn) * L);
      EXPECT_LT(difference(now, Q * before * Q.transposed()), 1e-12);
    }
    if (k % per_turn == 0) { EXPECT_LT(difference(now, before), 1e-10) << k / per_turn << " turns"; }
  }
  EXPECT_GT(farthest, 0.5);    // it did turn
}

// one step of any size is exact for rigid rotation
TYPED_TEST(Jaumann, OneLargeStep)
{
  constexpr int D = TypeParam::value;
  for (int trial = 0; trial < 50; trial++) {
    const auto before = this->random_deviator();
    const auto L = antisymmetric<D>(random_matrix<D>(this->random, 2.0));
    auto s = voigt<D>(before);
    jaumann_update<D>(s, L.a, 0.7, G, false);
    const auto Q = exponential<D>(0.7 * L);
    EXPECT_LT(difference(full<D>(s), Q * before * Q.transposed()), 2e-14);    // series and nine terms of size 2
  }
}

// without spin the update is linear elasticity; 200 additions of round-off: 1e-13
TYPED_TEST(Jaumann, UniaxialStrain)
{
  constexpr int D = TypeParam::value;
  const int n = 200;
  const double strain = 0.1, dt = 0.01;
  for (int axis = 0; axis < D; axis++) {
    Matrix<D> L;
    L(axis, axis) = strain / (n * dt);
    Sym<D> s;
    for (int k = 0; k < n; k++) jaumann_update<D>(s, L.a, dt, G, false);
    const auto now = full<D>(s);
    for (int a = 0; a < D; a++)
      for (int b = 0; b < D; b++)
        EXPECT_NEAR(now(a, b), a != b ? 0.0 : (a == axis ? 4.0 : -2.0) / 3.0 * G * strain, 1e-13) << a << b;
  }
}

// Objectivity: the same straining seen from a turning frame gives the turned stress. With L of the middle of the step
// the update is exact here, whatever the step; the strain must be turned by half of it.
TYPED_TEST(Jaumann, ObjectiveUnderSuperposedSpin)
{
  constexpr int D = TypeParam::value;
  const int n = 40;
  const double dt = 0.05;
  auto e = random_matrix<D>(this->random, 0.3);
  e = e + e.transposed();
  const auto W = antisymmetric<D>(random_matrix<D>(this->random, 2.0));
  Sym<D> s, turned;
  for (int k = 0; k < n; k++) {
    const auto R = exponential<D>((k + 0.5) * dt * W);
    const auto L = R * e * R.transposed() + W;
    jaumann_update<D>(s, e.a, dt, G, false);
    jaumann_update<D>(turned, L.a, dt, G, false);
  }
  const auto R = exponential<D>(n * dt * W);
  EXPECT_LT(difference(full<D>(turned), R * full<D>(s) * R.transposed()), 1e-12);    // n steps and the series
  EXPECT_GT(difference(full<D>(turned), full<D>(s)), 0.1);
}

// Plane strain is 3D with nothing happening along z; S_zz is minus the trace of the in-plane part
TEST(JaumannPlane, StrainEqualsThreeDimensions)
{
  Random random(7);
  Sym<2> plane;
  Sym<3> space;
  for (int k = 0; k < 200; k++) {
    const auto L = random_matrix<2>(random, 1.0);
    const double L3[9] = {L(0, 0), L(0, 1), 0, L(1, 0), L(1, 1), 0, 0, 0, 0};
    jaumann_update<2>(plane, L.a, 0.01, G, false);
    jaumann_update<3>(space, L3, 0.01, G, false);
  }
  // 200 steps of round-off
  EXPECT_NEAR(plane.c[0], space.c[0], 1e-13);
  EXPECT_NEAR(plane.c[1], space.c[1], 1e-13);
  EXPECT_NEAR(plane.c[2], space.c[3], 1e-13);
  EXPECT_NEAR(plane.trace(), -space.c[2], 1e-13);
  EXPECT_GT(std::fabs(space.c[2]), 1e-3);
}

TEST(JaumannPlane, StressKeepsNoTrace)
{
  Random random(8);
  Sym<2> s;
  for (int k = 0; k < 200; k++) {
    jaumann_update<2>(s, random_matrix<2>(random, 1.0).a, 0.01, G, true);
    ASSERT_NEAR(s.trace(), 0.0, 1e-14);
  }
}

// Hooke's law in uniaxial strain rate: stiffnesses of elasticity theory from E and nu
TEST(JaumannPlane, Stiffness)
{
  const double E = 3.0, nu = 0.3, shear = 0.5 * E / (1 + nu), strain = 1e-3;
  const double L[4] = {1.0, 0.0, 0.0, 0.0};
  Sym<2> s;
  jaumann_update<2>(s, L, strain, shear, false);
  const double K = E / (3 * (1 - 2 * nu));
  // plane strain: sigma_xx = E (1-nu)/((1+nu)(1-2nu)) e, sigma_yy = E nu/((1+nu)(1-2nu)) e; products of O(1e-3): 1e-17
  EXPECT_NEAR(K * strain + s.c[0], E * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) * strain, 1e-16);
  EXPECT_NEAR(K * strain + s.c[1], E * nu / ((1 + nu) * (1 - 2 * nu)) * strain, 1e-16);
  // plane stress: E/(1-nu^2) e and E nu/(1-nu^2) e, with the in-plane bulk modulus E/(2(1-nu))
  s = Sym<2>();
  jaumann_update<2>(s, L, strain, shear, true);
  const double K2 = E / (2 * (1 - nu));
  EXPECT_NEAR(K2 * strain + s.c[0], E / (1 - nu * nu) * strain, 1e-16);
  EXPECT_NEAR(K2 * strain + s.c[1], E * nu / (1 - nu * nu) * strain, 1e-16);
}
