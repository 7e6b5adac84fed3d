/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.
   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// Moving-least-squares gradients: fields that they must reproduce, and what they say where neighbors do not suffice.

#include "fsi_gradient.h"
#include "fsi_kernel.h"
#include "reference.h"

#include <vector>

using namespace LAMMPS_NS::FSI;

namespace {

constexpr double DX = 0.01, H = 1.5 * DX;

// neighbors of the origin: lattice sites within lo[a] .. hi[a] spacings, shaken by up to jitter spacings
template <int D> struct Neighbors {
  std::vector<double> dX, w;
  Neighbors(const int *lo, const int *hi, double jitter, unsigned seed = 1)
  {
    Random random(seed);
    const Wendland<D> kernel(H);
    for (int i = lo[0]; i <= hi[0]; i++)
      for (int j = lo[1]; j <= hi[1]; j++)
        for (int k = D == 3 ? lo[2] : 0; k <= (D == 3 ? hi[2] : 0); k++) {
          if (i == 0 && j == 0 && k == 0) continue;
          const int site[3] = {i, j, k};
          double x[D], rsq = 0.0;
          for (int a = 0; a < D; a++) {
            x[a] = DX * (site[a] + (hi[a] > lo[a] ? random(-jitter, jitter) : 0.0));
            rsq += x[a] * x[a];
          }
          if (rsq >= kernel.cutsq) continue;
          dX.insert(dX.end(), x, x + D);
          w.push_back(kernel.W(std::sqrt(rsq)) * random(0.5, 2.0));
        }
  }
  int size() const { return w.size(); }
};

// largest error of the gradient of u = a.X + X.B.X/2, in units of the largest derivative over the neighborhood
template <int D> double error_of(const Neighbors<D> &n, const std::vector<double> &G, double curvature)
{
  Random random(99);
  double a[D], B[D][D];
  for (int p = 0; p < D; p++) {
    a[p] = random(-1.0, 1.0);
    for (int q = 0; q <= p; q++) B[p][q] = B[q][p] = random(-1.0, 1.0) * curvature / DX;
  }
  double grad[D] = {};
  for (int j = 0; j < n.size(); j++) {
    const double *x = &n.dX[j * D];
    double u = 0.0;
    for (int p = 0; p < D; p++) {
      u += a[p] * x[p];
      for (int q = 0; q < D; q++) u += 0.5 * x[p] * B[p][q] * x[q];
    }
    for (int p = 0; p < D; p++) grad[p] += u * G[j * D + p];
  }
  double error = 0.0;
  for (int p = 0; p < D; p++) error = std::fmax(error, std::fabs(grad[p] - a[p]));
  return error;
}

template <int D> typename GradientWeights<D>::Order weigh(const Neighbors<D> &n, bool quadratic, std::vector<double> &G)
{
  GradientWeights<D> weights;
  G.assign((size_t) n.size() * D, NAN);
  return weights(n.size(), n.dX.data(), n.w.data(), H, quadratic, G.data());
}

}    // namespace

template <class T> class Weights : public ::testing::Test {};
TYPED_TEST_SUITE(Weights, Dimensions, DimensionName);

/* ---------------------------------------------------------------------- */

// inside and beside a face
TYPED_TEST(Weights, QuadraticFieldsAreExact)
{
  constexpr int D = TypeParam::value;
  const int lows[][3] = {{-3, -3, -3}, {-1, -3, -3}, {-1, -1, -1}};
  const int hi[3] = {3, 3, 3};
  for (const auto &lo : lows)
    for (const double jitter : {0.0, 0.2})
      for (unsigned seed = 1; seed < 20; seed++) {
        const Neighbors<D> n(lo, hi, jitter, seed);
        std::vector<double> G;
        ASSERT_EQ(weigh(n, true, G), GradientWeights<D>::QUADRATIC) << lo[0] << lo[1] << lo[2];
        // sums of up to 100 terms with weights of up to 10/dx of both signs, from a matrix of condition number 1e3
        EXPECT_LT(error_of(n, G, 1.0), 1e-11) << lo[0] << lo[1] << lo[2];
      }
}

// at faces and edges of any direction: all quadratic fields but the squares along normals, which would take weights of 3/2, 2 and 1/2
TYPED_TEST(Weights, AtAFaceAllButTheSquareAlongTheNormal)
{
  constexpr int D = TypeParam::value;
  const int hi[3] = {3, 3, 3};
  const Wendland<D> kernel(H);
  Random random(8);
  for (int turn = 0; turn < 40; turn++) {
    const int faces = 1 + turn % D, lo[3] = {0, faces > 1 ? 0 : -3, faces > 2 ? 0 : -3};
    Neighbors<D> n(lo, hi, 0.0);
    auto R = random_rotation<D>(random);
    if (turn == 0)
      for (int a = 0; a < D; a++)
        for (int b = 0; b < D; b++) R(a, b) = a == b;
    std::vector<double> lattice = n.dX, G;
    for (int j = 0; j < n.size(); j++) {
      double rsq = 0.0;
      for (int a = 0; a < D; a++) {
        n.dX[j * D + a] = 0.0;
        rsq += lattice[j * D + a] * lattice[j * D + a];
        for (int b = 0; b < D; b++) n.dX[j * D + a] += R(a, b) * lattice[j * D + b];
      }
      n.w[j] = kernel.W(std::sqrt(rsq));
    }
    ASSERT_EQ(weigh(n, true, G), GradientWeights<D>::PARTIAL);
    for (int p = 0; p < D; p++)
      for (int q = p; q < D; q++) {
        double grad = 0.0;    // of x_p x_q of the lattice: the largest component, zero where exact
        for (int a = 0; a < D; a++) {
          double g = 0.0;
          for (int j = 0; j < n.size(); j++) g += lattice[j * D + p] * lattice[j * D + q] * G[j * D + a];
          grad = std::fmax(grad, std::fabs(g) / DX);
        }
        // the axes are those of the face to 1e-4 over the difference of the moments along them, a third
        if (p == q && p < faces) EXPECT_GT(grad, 0.5) << turn << " " << p;
        else EXPECT_LT(grad, 2e-3) << turn << " " << p << q;
      }
    double largest = 0.0, component = 0.0;
    for (const double g : G) component = std::fmax(component, std::fabs(g));
    if (faces == 1) EXPECT_LT(component * DX, 0.5) << turn;
    for (int j = 0; j < n.size(); j++) {
      double gsq = 0.0;
      for (int a = 0; a < D; a++) gsq += G[j * D + a] * G[j * D + a];
      largest = std::fmax(largest, std::sqrt(gsq));
    }
    EXPECT_LT(largest * DX, 0.75) << turn;    // a difference of two neighbors has 1, quadratic terms along a normal 2
  }
}

TYPED_TEST(Weights, LinearOrderOnRequest)
{
  constexpr int D = TypeParam::value;
  const int lo[3] = {0, -3, -3}, hi[3] = {3, 3, 3};
  for (unsigned seed = 1; seed < 20; seed++) {
    const Neighbors<D> n(lo, hi, 0.2, seed);
    std::vector<double> G;
    ASSERT_EQ(weigh(n, false, G), GradientWeights<D>::LINEAR);
    EXPECT_LT(error_of(n, G, 0.0), 1e-12);
    // and not more: at a face the gradient is that of a place of the order of dx inside
    EXPECT_GT(error_of(n, G, 1.0), 0.1);
  }
}

// the documented place: 0.6 dx inside the face
TYPED_TEST(Weights, LinearGradientAtAFaceIsThatOfAPlaceInside)
{
  constexpr int D = TypeParam::value;
  const int lo[3] = {0, -3, -3}, hi[3] = {3, 3, 3};
  const Wendland<D> kernel(H);
  Neighbors<D> n(lo, hi, 0.0);
  std::vector<double> G;
  for (int j = 0; j < n.size(); j++) {
    double rsq = 0.0;
    for (int a = 0; a < D; a++) rsq += n.dX[j * D + a] * n.dX[j * D + a];
    n.w[j] = kernel.W(std::sqrt(rsq));
  }
  weigh(n, false, G);
  double place = 0.0;    // gradient of x^2/2 is x
  for (int j = 0; j < n.size(); j++) place += 0.5 * n.dX[j * D] * n.dX[j * D] * G[j * D];
  EXPECT_NEAR(place / DX, 0.65, 0.1);
}

// weights belong to differences: a constant field has none, whatever G; and length scales out
TYPED_TEST(Weights, ScalesWithLength)
{
  constexpr int D = TypeParam::value;
  const int lo[3] = {-1, 0, -3}, hi[3] = {3, 3, 3};
  Neighbors<D> n(lo, hi, 0.2);
  std::vector<double> G, big((size_t) n.size() * D);
  weigh(n, true, G);
  for (double &x : n.dX) x *= 1000.0;
  GradientWeights<D> weights;
  weights(n.size(), n.dX.data(), n.w.data(), 1000.0 * H, true, big.data());
  for (size_t k = 0; k < G.size(); k++) EXPECT_NEAR(1000.0 * big[k], G[k], 1e-9 / DX);
}

/* ---------------------------------------------------------------------- */

TYPED_TEST(Weights, LineOrPlaneIsDeficient)
{
  constexpr int D = TypeParam::value;
  std::vector<double> G;
  for (int flat = 0; flat < D; flat++)
    for (const bool quadratic : {true, false}) {
      int lo[3] = {-3, -3, -3}, hi[3] = {3, 3, 3};
      lo[flat] = hi[flat] = 0;
      EXPECT_EQ(weigh(Neighbors<D>(lo, hi, 0.2), quadratic, G), GradientWeights<D>::DEFICIENT) << flat;
      lo[flat] = 0;
      hi[flat] = 0;
      lo[(flat + 1) % D] = hi[(flat + 1) % D] = 0;
      EXPECT_EQ(weigh(Neighbors<D>(lo, hi, 0.2), quadratic, G), GradientWeights<D>::DEFICIENT) << flat;
    }
  // a plane that no axis lies in
  Neighbors<D> skew((const int[3]){-3, -3, 0}, (const int[3]){3, D == 2 ? 0 : 3, 0}, 0.0);
  Random random(5);
  const auto R = random_rotation<D>(random);
  for (int j = 0; j < skew.size(); j++) {
    double x[D];
    for (int a = 0; a < D; a++) {
      x[a] = 0.0;
      for (int b = 0; b < (D == 2 ? 1 : 2); b++) x[a] += R(a, b) * skew.dX[j * D + b];
    }
    for (int a = 0; a < D; a++) skew.dX[j * D + a] = x[a];
  }
  EXPECT_EQ(weigh(skew, true, G), GradientWeights<D>::DEFICIENT);
}

// round-off does not make a line of two directions, along an axis either
TYPED_TEST(Weights, NearlyALineIsDeficient)
{
  constexpr int D = TypeParam::value;
  double A[packed_size(D)] = {}, C[D * D];
  for (int flat = 0; flat < D; flat++) {
    for (int a = 0; a < D; a++) A[packed_size(a) + a] = a == flat ? 1e-12 : 1.0;
    EXPECT_EQ((gradient_coefficients<D, D>(A, C)), Gradient<D>::DEFICIENT) << flat;
  }
}

// the inverse of round moments, and of those of half a disc or ball; nothing across a line or plane, whichever way it lies
TYPED_TEST(Weights, FadedInverse)
{
  constexpr int D = TypeParam::value;
  Random random(7);
  const auto R = random_rotation<D>(random);
  const auto entry = [&R](double across, int a, int b) {
    double sum = 0.0;
    for (int k = 0; k < D; k++) sum += (k ? 2.0 : 2.0 * across) * R(a, k) * R(b, k);
    return sum;
  };
  for (const double across : {1.0, 0.28, 0.06, 0.019, 1e-16, 0.0}) {
    double M[packed_size(D)], C[D * D];
    for (int a = 0, n = 0; a < D; a++)
      for (int b = 0; b <= a; b++) M[n++] = entry(across, a, b);
    faded_inverse<D>(M, C);
    const double part = across > 0.1 ? 1.0 : across == 0.06 ? 0.5 : 0.0;    // half way between 0.02 and 0.1
    for (int a = 0; a < D; a++)
      for (int b = 0; b < D; b++) {
        double expected = 0.0;
        for (int k = 0; k < D; k++) expected += (k ? 0.5 : part ? 0.5 * part / across : 0.0) * R(a, k) * R(b, k);
        EXPECT_NEAR(C[a * D + b], expected, 1e-13 / std::max(across, 0.05)) << across;
      }
  }
  double none[packed_size(D)] = {}, C[D * D];
  faded_inverse<D>(none, C);
  for (const double c : C) EXPECT_EQ(c, 0.0);
}

TYPED_TEST(Weights, TooFewNeighborsAreDeficient)
{
  constexpr int D = TypeParam::value;
  const int lo[3] = {0, 0, 0}, hi[3] = {1, 0, 0};
  std::vector<double> G;
  const Neighbors<D> one(lo, hi, 0.0);
  ASSERT_EQ(one.size(), 1);
  EXPECT_EQ(weigh(one, true, G), GradientWeights<D>::DEFICIENT);
  Neighbors<D> none = one;
  none.dX.clear();
  none.w.clear();
  EXPECT_EQ(weigh(none, true, G), GradientWeights<D>::DEFICIENT);
}

// two layers: nothing tells u = X^2 across from u = X. What remains is exact for linear fields.
TYPED_TEST(Weights, TwoLayers)
{
  constexpr int D = TypeParam::value;
  std::vector<double> G;
  for (int across = 0; across < D; across++)
    for (const double jitter : {0.0, 0.05}) {
      int lo[3] = {-3, -3, -3}, hi[3] = {3, 3, 3};
      lo[across] = 0;
      hi[across] = 1;
      Neighbors<D> n(lo, hi, 0.0);
      Random random(3);
      for (int j = 0; j < n.size(); j++)    // along the layers
        for (int a = 0; a < D; a++)
          if (a != across) n.dX[j * D + a] += DX * random(-jitter, jitter);
      ASSERT_EQ(weigh(n, true, G), GradientWeights<D>::PARTIAL) << across;
      EXPECT_LT(error_of(n, G, 0.0), 1e-11);
    }
}

// D + 1 particles: no quadratic term at all
TYPED_TEST(Weights, SimplexIsLinear)
{
  constexpr int D = TypeParam::value;
  Neighbors<D> n((const int[3]){0, 0, 0}, (const int[3]){1, 1, 1}, 0.0);
  n.dX.assign(D * D, 0.0);
  n.w.assign(D, 1.0);
  for (int a = 0; a < D; a++) n.dX[a * D + a] = DX;
  std::vector<double> G;
  ASSERT_EQ(weigh(n, true, G), GradientWeights<D>::LINEAR);
  EXPECT_LT(error_of(n, G, 0.0), 1e-13);
}
