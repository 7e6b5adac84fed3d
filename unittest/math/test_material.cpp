/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.
   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// Equations of state and elastic moduli.

#include "fsi_material.h"

#include "gtest/gtest.h"

#include <cmath>

using namespace LAMMPS_NS::FSI;

namespace {

State make_state(int tait, double p0 = 0.0)
{
  State s;
  s.tait = tait;
  s.rho0 = 1000.0;
  s.c = 20.0;
  s.csq = 400.0;
  s.p0 = p0;
  return s;
}

class EquationOfState : public ::testing::TestWithParam<int> {};

}    // namespace

// 1e-12 of c^2 rho0 (4e5) is the round-off of rho - rho0 times c^2
TEST_P(EquationOfState, PressureOfDensityAndBack)
{
  for (double p0 : {0.0, 500.0}) {
    const auto s = make_state(GetParam(), p0);
    for (double rho = 900; rho < 1101; rho += 12.5) EXPECT_NEAR(s.density(s.pressure(rho)), rho, 1e-9) << p0;
    for (double p = -2e4; p < 2e5; p += 3100) EXPECT_NEAR(s.pressure(s.density(p)), p, 1e-6) << p0;
    EXPECT_EQ(s.pressure(s.rho0), p0);
    EXPECT_EQ(s.density(p0), s.rho0);
  }
}

TEST_P(EquationOfState, SlopeIsSpeedOfSoundSquared)
{
  const auto s = make_state(GetParam(), 500.0);
  const double d = 0.01;
  // third-derivative term of Tait: c^2 30 (d/rho0)^2/6 = 5e-10 c^2; round-off of p over d: 1e-8 c^2
  EXPECT_NEAR((s.pressure(s.rho0 + d) - s.pressure(s.rho0 - d)) / (2 * d), s.csq, 1e-7 * s.csq);
}

TEST_P(EquationOfState, Floor)
{
  auto s = make_state(GetParam());
  const double tension = s.pressure(990.0);
  EXPECT_LT(tension, -3000.0);    // by default tension is carried
  s.floor = 0.0;
  EXPECT_EQ(s.pressure(990.0), 0.0);
  EXPECT_GT(s.pressure(1010.0), 3000.0);
  s.floor = -1000.0;
  EXPECT_EQ(s.pressure(990.0), -1000.0);
  EXPECT_GT(s.pressure(999.0), -1000.0);
}

INSTANTIATE_TEST_SUITE_P(Material, EquationOfState, ::testing::Values(0, 1),
                         [](const auto &info) { return std::string(info.param ? "Tait" : "linear"); });

// paper eq. 16, and Tait with exponent 7
TEST(Material, PressureByHand)
{
  EXPECT_DOUBLE_EQ(make_state(0, 500.0).pressure(1010.0), 500.0 + 400.0 * 10.0);
  // (1.01^7 - 1) cancels two digits: 1e-13 relative
  const double tait = 500.0 + 1000.0 * 400.0 / 7.0 * (std::pow(1.01, 7) - 1.0);
  EXPECT_NEAR(make_state(1, 500.0).pressure(1010.0), tait, 1e-12 * tait);
  EXPECT_GT(tait, make_state(0, 500.0).pressure(1010.0));    // stiffens
}

// G and K must give back E and nu: E = 9KG/(3K+G), nu = (3K-2G)/(2(3K+G)); a dozen operations: 1e-14
TEST(Material, ElasticModuli)
{
  Material m = {};
  for (double nu : {-0.5, 0.0, 0.3, 0.4, 0.49}) {
    m.young = 1.2e7;
    m.poisson = nu;
    const double G = m.shear_modulus(), K = m.bulk_modulus(), K2 = m.plane_stress_modulus();
    EXPECT_NEAR(9 * K * G / (3 * K + G), m.young, 1e-14 * m.young);
    EXPECT_NEAR((3 * K - 2 * G) / (2 * (3 * K + G)), nu, 1e-14);
    // plane stress: in-plane pressure per in-plane dilatation when sigma_zz = 0, i.e. 9KG/(3K+4G)
    EXPECT_NEAR(K2, 9 * K * G / (3 * K + 4 * G), 1e-14 * K2);
  }
  // the paper's beam: K = 3.25e6, mu = 7.15e5 (rounded there to three digits)
  m.young = 9 * 3.25e6 * 7.15e5 / (3 * 3.25e6 + 7.15e5);
  m.poisson = (3 * 3.25e6 - 2 * 7.15e5) / (2 * (3 * 3.25e6 + 7.15e5));
  EXPECT_NEAR(m.bulk_modulus(), 3.25e6, 1.0);
  EXPECT_NEAR(m.shear_modulus(), 7.15e5, 1.0);
}
