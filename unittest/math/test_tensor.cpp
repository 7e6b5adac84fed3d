/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.
   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "fsi_classic_laws.h"
#include "reference.h"

using namespace LAMMPS_NS::FSI;

template <class T> class Tensor : public ::testing::Test {
 public:
  static constexpr int D = T::value;
  Random random{20250204};
  Matrix<D> random_symmetric()
  {
    const auto m = random_matrix<D>(random, 1.0);
    return m + m.transposed();
  }
};
TYPED_TEST_SUITE(Tensor, Dimensions, DimensionName);

// the order is part of the file formats: dumps, restart files, LAMMPS' own Voigt convention
TYPED_TEST(Tensor, VoigtOrder)
{
  constexpr int D = TypeParam::value;
  Sym<D> t;
  for (int k = 0; k < t.N; k++) t.c[k] = k + 1.0;
  const double in_2d[4] = {1, 3, 3, 2}, in_3d[9] = {1, 4, 5, 4, 2, 6, 5, 6, 3};
  for (int a = 0; a < D; a++)
    for (int b = 0; b < D; b++) {
      EXPECT_EQ(t(a, b), (D == 2 ? in_2d : in_3d)[a * D + b]) << a << b;
      Sym<D> one;
      one(a, b) = 7.0;
      EXPECT_EQ(full<D>(one)(b, a), 7.0) << a << b;
    }
  double stored[6] = {};
  t.store(stored);
  const auto back = Sym<D>::load(stored);
  for (int k = 0; k < t.N; k++) EXPECT_EQ(back.c[k], k + 1.0);
}

TYPED_TEST(Tensor, SumScaleIdentity)
{
  constexpr int D = TypeParam::value;
  const auto p = this->random_symmetric(), q = this->random_symmetric();
  auto t = voigt<D>(p);
  t *= 3.0;
  t += voigt<D>(q);
  EXPECT_LT(difference(full<D>(t), 3.0 * p + q), 1e-15);
  EXPECT_EQ(difference(full<D>(Sym<D>::identity(2.5)), 2.5 * unit<D>()), 0.0);
  EXPECT_EQ(difference(full<D>(Sym<D>()), Matrix<D>()), 0.0);
}

TYPED_TEST(Tensor, DotTraceSquaredSymmetric)
{
  constexpr int D = TypeParam::value;
  for (int trial = 0; trial < 100; trial++) {
    const auto m = this->random_symmetric();
    const auto t = voigt<D>(m);
    double x[D], out[D], trace = 0.0, squared = 0.0;
    for (double &c : x) c = this->random(-1.0, 1.0);
    dot<D>(t, x, out);
    for (int a = 0; a < D; a++) {
      double truth = 0.0;
      for (int b = 0; b < D; b++) {
        truth += m(a, b) * x[b];
        squared += m(a, b) * m(a, b);
      }
      trace += m(a, a);
      EXPECT_NEAR(out[a], truth, 1e-15);    // at most three terms of size 2
    }
    EXPECT_NEAR(t.trace(), trace, 1e-15);
    EXPECT_NEAR(t.squared(), squared, 1e-14);    // nine terms of up to 4
    const auto L = random_matrix<D>(this->random, 1.0);
    EXPECT_LT(difference(full<D>(symmetric<D>(L.a)), 0.5 * (L + L.transposed())), 1e-15);
  }
}

TYPED_TEST(Tensor, RotationIsExponentialOfSpin)
{
  constexpr int D = TypeParam::value;
  for (int trial = 0; trial < 500; trial++) {
    const auto L = random_matrix<D>(this->random, 1.0);
    const double dt = this->random(-2.0, 2.0);
    Matrix<D> Q;
    rotation<D>(L.a, dt, Q.a);
    // the series sums terms of up to 4 in size: 1e-14
    EXPECT_LT(difference(Q, exponential<D>(dt * antisymmetric<D>(L))), 1e-14);
    // three products of entries with an error of about two roundings (2e-16) each: 1.3e-15 in 2e5 trials
    EXPECT_LT(difference(Q * Q.transposed(), unit<D>()), 2e-15);
  }
}

// a fluid turning counter-clockwise about z, v = (-y, x, 0), turns tensors counter-clockwise
TYPED_TEST(Tensor, RotationSense)
{
  constexpr int D = TypeParam::value;
  Matrix<D> L, Q;
  L(0, 1) = -1.0;
  L(1, 0) = 1.0;
  rotation<D>(L.a, M_PI / 2, Q.a);
  EXPECT_NEAR(Q(1, 0), 1.0, 1e-15);    // x axis to y axis
  EXPECT_NEAR(Q(0, 1), -1.0, 1e-15);
  EXPECT_NEAR(Q(0, 0), 0.0, 1e-15);
}

// small angles take a branch of their own in 3D: continuous, exact, and no division by zero
TYPED_TEST(Tensor, RotationBySmallAngles)
{
  constexpr int D = TypeParam::value;
  const auto L = antisymmetric<D>(random_matrix<D>(this->random, 1.0));
  for (double dt : {0.0, 1e-300, 1e-12, 1e-6, 3e-5, 9.9e-5, 1e-4, 1.01e-4, 2e-4, 1e-3, 1e-2}) {
    Matrix<D> Q;
    rotation<D>(L.a, dt, Q.a);
    EXPECT_LT(difference(Q, exponential<D>(dt * L)), 3e-16) << dt;    // entries near 1: one rounding each
  }
}

TYPED_TEST(Tensor, RotationsCompose)
{
  constexpr int D = TypeParam::value;
  const auto L = random_matrix<D>(this->random, 1.0);
  const int n = 1000;
  Matrix<D> one, small, all = unit<D>();
  rotation<D>(L.a, 2.0, one.a);
  rotation<D>(L.a, 2.0 / n, small.a);
  for (int k = 0; k < n; k++) all = small * all;
  EXPECT_LT(difference(all, one), 2e-13);    // n roundings of 2e-16, all of one sign
}

TYPED_TEST(Tensor, Rotate)
{
  constexpr int D = TypeParam::value;
  for (int trial = 0; trial < 100; trial++) {
    const auto m = this->random_symmetric();
    const auto Q = random_rotation<D>(this->random);
    const auto t = rotate<D>(voigt<D>(m), Q.a);
    EXPECT_LT(difference(full<D>(t), Q * m * Q.transposed()), 5e-15);    // nine terms of size up to 2
  }
}

/* ---------------------------------------------------------------------- */

// R diag(s) R^T and its tensile part by construction
template <int D> void check_tensile(Random &random, const double *s)
{
  double positive[3];
  for (int k = 0; k < D; k++) positive[k] = s[k] > 0.0 ? s[k] : 0.0;
  for (int trial = 0; trial < 50; trial++) {
    const auto R = trial ? random_rotation<D>(random) : unit<D>();
    const auto part = tensile_part<D>(voigt<D>(R * diagonal<D>(s) * R.transposed()));
    // Jacobi rotations and the 2D closed form are good to some eps |s|, |s| <= 3
    EXPECT_LT(difference(full<D>(part), R * diagonal<D>(positive) * R.transposed()), 1e-14);
  }
}

TYPED_TEST(Tensor, TensilePartOfMixedStress)
{
  for (int trial = 0; trial < 100; trial++) {
    double s[3];
    for (double &x : s) x = this->random(-2.0, 2.0);
    s[0] = std::fabs(s[0]);
    s[1] = -std::fabs(s[1]);
    check_tensile<TypeParam::value>(this->random, s);
  }
}

TYPED_TEST(Tensor, TensilePartOfDegenerateStress)
{
  const double states[][3] = {{1, 1, 1},  {-1, -1, -1}, {0, 0, 0},          {1, 1, -2},          {-1, -1, 2},
                              {1, -1, 0}, {2, 0, 0},    {-2, 0, 0},         {0, 0, 3},           {1, -1, -1},
                              {1, -1, 1}, {0, 1, 1},    {1, 1 + 1e-13, -1}, {-1, -1 - 1e-13, 1}, {1e-14, -1, 1}};
  for (const auto &s : states) check_tensile<TypeParam::value>(this->random, s);
}

TYPED_TEST(Tensor, TensilePartAllOrNothing)
{
  constexpr int D = TypeParam::value;
  for (int trial = 0; trial < 100; trial++) {
    double s[3], minus[3];
    for (int k = 0; k < 3; k++) minus[k] = -(s[k] = this->random(0.01, 2.0));
    const auto R = random_rotation<D>(this->random);
    const auto tension = R * diagonal<D>(s) * R.transposed(), compression = R * diagonal<D>(minus) * R.transposed();
    EXPECT_LT(difference(full<D>(tensile_part<D>(voigt<D>(tension))), tension), 5e-15);
    EXPECT_EQ(difference(full<D>(tensile_part<D>(voigt<D>(compression))), Matrix<D>()), 0.0);    // exactly none
  }
}

// a large hydrostatic part must not swamp the direction
TYPED_TEST(Tensor, TensilePartScales)
{
  constexpr int D = TypeParam::value;
  const double s[3] = {1.0e6, -2.0e6, -1.5e6}, positive[3] = {1.0e6, 0.0, 0.0};
  const auto R = random_rotation<D>(this->random);
  const auto part = tensile_part<D>(voigt<D>(R * diagonal<D>(s) * R.transposed()));
  EXPECT_LT(difference(full<D>(part), R * diagonal<D>(positive) * R.transposed()), 1e-14 * 1e6);
}
