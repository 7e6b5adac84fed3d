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

constexpr double SPACING = 0.004;    // not 1: powers of dx must show

struct Case {
  const char *name;
  int kind, dim;
  double ratio, stretch, shear;
};
void PrintTo(const Case &c, std::ostream *os)
{
  *os << c.name;
}

// psi of lattices strained by 0.05, by a program of its own; wendland_140_3D and the quintics but for h = dx from another
const Case CASES[] = {
    {"wendland_130", WENDLAND, 2, 1.30, 0.427, 0.004},     {"wendland_150", WENDLAND, 2, 1.50, 0.092, -0.011},
    {"wendland_154", WENDLAND, 2, 1.54, -0.010, -0.007},   {"wendland_160", WENDLAND, 2, 1.60, -0.094, -0.005},
    {"wendland_170", WENDLAND, 2, 1.70, -0.009, 0.004},    {"cubic_130", CUBIC, 2, 1.30, 0.128, 0.071},
    {"cubic_134", CUBIC, 2, 1.34, 0.005, 0.055},           {"cubic_150", CUBIC, 2, 1.50, -0.512, 0.016},
    {"quintic_100", QUINTIC, 2, 1.00, 0.003, -0.004},      {"wendland_130_3D", WENDLAND, 3, 1.30, 0.246, -0.017},
    {"wendland_150_3D", WENDLAND, 3, 1.50, 0.143, -0.008}, {"wendland_156_3D", WENDLAND, 3, 1.56, 0.012, -0.010},
    {"wendland_160_3D", WENDLAND, 3, 1.60, -0.058, -0.005}, {"wendland_170_3D", WENDLAND, 3, 1.70, -0.060, 0.004},
    {"wendland_180_3D", WENDLAND, 3, 1.80, 0.028, 0.000},  {"cubic_130_3D", CUBIC, 3, 1.30, 0.366, 0.059},
    {"quintic_100_3D", QUINTIC, 3, 1.00, 0.004, 0.002},    {"quintic_94", QUINTIC, 2, 0.94, 0.010, 0.003},
    {"quintic_94_3D", QUINTIC, 3, 0.94, 0.021, 0.004},     {"quintic_104_3D", QUINTIC, 3, 1.04, -0.003, -0.002},
    {"wendland_140_3D", WENDLAND, 3, 1.40, 0.338, 0.010},
};

class Lattice : public ::testing::TestWithParam<Case> {
 public:
  template <class F> void with(F &&f) { with_kernel(GetParam().kind, GetParam().dim, GetParam().ratio * SPACING, f); }

  // sum of W over a lattice whose points a function has moved, seen from the point at the origin, which it leaves there
  template <class K, class F> static double psi(const K &kernel, F &&move)
  {
    const int n = 8, nz = K::DIM == 3 ? n : 0;
    double sum = 0.0;
    for (int k = -nz; k <= nz; k++)
      for (int j = -n; j <= n; j++)
        for (int i = -n; i <= n; i++) {
          double x[3] = {i * SPACING, j * SPACING, k * SPACING};
          move(x);
          sum += kernel.W(std::sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]));
        }
    return sum;
  }

  // second derivative of psi/psi(0) with respect to the size of a deformation
  template <class K, class F> static double second(const K &kernel, F &&move)
  {
    const double e = 1e-3;
    const auto at = [&](double s) { return psi(kernel, [&](double *x) { move(x, s); }); };
    return (at(e) - 2.0 * at(0.0) + at(-e)) / (e * e * at(0.0));
  }
};

}    // namespace

// differences over 1e-3: kinks of W'' leave up to 2e-3, powers of e 1e-5
TEST_P(Lattice, SecondDerivativeOfNumberDensity)
{
  const auto &c = GetParam();
  with([&](const auto &k) {
    const auto s = lattice_stiffness(k, SPACING);
    const auto stretch = [](double *x, double e) {
      x[0] *= std::exp(e);
      x[1] *= std::exp(-e);
    };
    const auto shear = [](double *x, double e) { x[0] += e * x[1]; };
    const auto other_shear = [](double *x, double e) { x[1] += e * x[0]; };
    const double by_differences = second(k, stretch);
    EXPECT_NEAR(s.stretch, by_differences, 2e-3);
    EXPECT_NEAR(s.shear, second(k, shear), 2e-3);
    EXPECT_NEAR(s.shear, second(k, other_shear), 2e-3);
    // along one axis and back along two: no third number in 3D
    if (c.dim == 3)
      EXPECT_NEAR(0.75 * s.stretch, second(k, [](double *x, double e) {
                    x[0] *= std::exp(e);
                    x[1] *= std::exp(-0.5 * e);
                    x[2] *= std::exp(-0.5 * e);
                  }), 2e-3);
    // the printed digits; strains of 0.05 have 4 % of the next power
    EXPECT_NEAR(s.stretch, c.stretch, 0.002 + 0.04 * std::fabs(c.stretch));
    EXPECT_NEAR(s.shear, c.shear, 0.002 + 0.04 * std::fabs(c.shear));
  });
}

INSTANTIATE_TEST_SUITE_P(Kernels, Lattice, ::testing::ValuesIn(CASES), [](const auto &info) { return std::string(info.param.name); });
