/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.
   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// Hyperelastic laws: stress from energy, limits, objectivity, closed forms; and the contact of bodies.

#include "fsi_pair_laws.h"
#include "fsi_solid_laws.h"
#include "fsi_volumetric.h"
#include "reference.h"

using namespace LAMMPS_NS::FSI;

namespace {

constexpr double E = 2.0, NU = 0.35, K = E / (3 * (1 - 2 * NU)), G = E / (2 * (1 + NU));
constexpr double LAMBDA = E * NU / ((1 + NU) * (1 - 2 * NU));

template <int D> Matrix<D> deformation(Random &random, double size)
{
  return unit<D>() + random_matrix<D>(random, size);
}

template <int D> Matrix<D> stress_of(const PiolaStress<D> &r)
{
  Matrix<D> P;
  for (int k = 0; k < D * D; k++) P.a[k] = r.P[k];
  return P;
}

// calls f(law, name) for each of them
template <class F> void each_law(int dim, F &&f)
{
  f(StVenantKirchhoff(K, G, false), "svk");
  f(NeoHookean(K, G, false), "neohookean");
  if (dim == 2) f(StVenantKirchhoff(K, G, true), "svk, plane stress");
}

}    // namespace

template <class T> class Elastic : public ::testing::Test {};
TYPED_TEST_SUITE(Elastic, Dimensions, DimensionName);

/* ---------------------------------------------------------------------- */

TYPED_TEST(Elastic, StressIsTheDerivativeOfTheEnergy)
{
  constexpr int D = TypeParam::value;
  Random random(1);
  each_law(D, [&](const auto &law, const char *name) {
    for (int n = 0; n < 20; n++) {
      auto F = deformation<D>(random, 0.3);
      const auto P = stress_of<D>(law.template operator()<D>(F.a));
      for (int k = 0; k < D * D; k++) {
        // error of central differences: 1e-10 of a third derivative of up to 1e2, and 1e-16/1e-5 of the energy
        const double step = 1e-5, f = F.a[k];
        F.a[k] = f + step;
        const double up = law.template operator()<D>(F.a).energy;
        F.a[k] = f - step;
        const double down = law.template operator()<D>(F.a).energy;
        F.a[k] = f;
        EXPECT_NEAR(P.a[k], (up - down) / (2 * step), 1e-8) << name;
      }
    }
  });
}

TYPED_TEST(Elastic, LawIsItsLocalPartAndTheSmoothedOne)
{
  constexpr int D = TypeParam::value;
  constexpr double k = 0.7 * LAMBDA, none[6] = {};
  Random random(3);
  const auto check = [&](const auto &whole, const auto &local) {
    using Law = std::decay_t<decltype(whole)>;
    for (int n = 0; n < 20; n++) {
      const auto F = deformation<D>(random, 0.3);
      const auto r = whole.template operator()<D>(F.a, none), part = local.template operator()<D>(F.a, none);
      double dm[D * D];
      const double m = Law::template volumetric_strain<D>(F.a, dm), q = k * Law::volumetric_slope(m);
      // round-off of numbers up to 10
      EXPECT_NEAR(r.energy, part.energy + k * Law::volumetric_energy(m), 1e-13);
      EXPECT_NEAR(r.zz, part.zz + (D == 2 ? q : 0.0), 1e-13);
      for (int c = 0; c < D * D; c++) EXPECT_NEAR(r.P[c], part.P[c] + q * dm[c], 1e-13);
    }
  };
  check(StVenantKirchhoff(K, G, false), StVenantKirchhoff(K - k, G, false));
  check(NeoHookean(K, G, false), NeoHookean(K - k, G, false));
  check(HypoElastic(K, G, false), HypoElastic(K - k, G, false));
}

// A history like that of some steps of any deformation
template <int D> std::vector<double> history_of(const ViscoElastic &law, Random &random)
{
  std::vector<double> history(law.columns(D), 0.0);
  for (int n = 0; n < 5; n++)
    law.advance<D>(deformation<D>(random, 0.3).a, law.factors(0.4), history.data());
  return history;
}

TYPED_TEST(Elastic, StressOfAViscoelasticLawIsTheDerivativeOfItsEnergy)
{
  constexpr int D = TypeParam::value;
  Random random(5);
  const ViscoElastic law(K, G, {{0.3, 0.5}, {0.2, 2.0}});
  for (int n = 0; n < 20; n++) {
    const auto history = history_of<D>(law, random);
    auto F = deformation<D>(random, 0.3);
    const auto P = stress_of<D>(law.operator()<D>(F.a, history.data()));
    for (int k = 0; k < D * D; k++) {
      const double step = 1e-5, f = F.a[k];
      F.a[k] = f + step;
      const double up = law.operator()<D>(F.a, history.data()).energy;
      F.a[k] = f - step;
      const double down = law.operator()<D>(F.a, history.data()).energy;
      F.a[k] = f;
      EXPECT_NEAR(P.a[k], (up - down) / (2 * step), 1e-8);
    }
  }
}

// What energy and stress lose at a constant deformation is what advance() says, exactly.
TYPED_TEST(Elastic, ViscoelasticEnergyThatIsLostIsDissipated)
{
  constexpr int D = TypeParam::value;
  Random random(6);
  const ViscoElastic law(K, G, {{0.3, 0.5}, {0.2, 2.0}});
  std::vector<double> history(law.columns(D), 0.0);
  const auto F = deformation<D>(random, 0.3);
  law.advance<D>(F.a, law.factors(1e-9), history.data());    // the strain, at once
  const double start = law.operator()<D>(F.a, history.data()).energy;
  double lost = 0.0;
  for (int n = 0; n < 50; n++) {
    const double part = law.advance<D>(F.a, law.factors(0.3), history.data());
    EXPECT_GE(part, -1e-15);    // round-off of an energy of 0.1
    lost += part;
  }
  const double end = law.operator()<D>(F.a, history.data()).energy;
  EXPECT_NEAR(start - end, lost, 1e-14);
  EXPECT_GT(lost, 0.1 * start);
}

// Small simple shear that grows at a constant rate, in steps of any length: at time t the stress is
// rate times the integral of G.
TYPED_TEST(Elastic, ViscoelasticStepIsExactForAConstantRate)
{
  constexpr int D = TypeParam::value;
  constexpr double rate = 1e-7, g = 0.4, tau = 0.5;
  const ViscoElastic law(K, G, {{g, tau}});
  std::vector<double> history(law.columns(D), 0.0);
  double t = 0.0;
  for (const double dt : {0.1, 0.7, 3.0, 0.02}) {
    t += dt;
    auto F = unit<D>();
    F.a[1] = rate * t;
    law.advance<D>(F.a, law.factors(dt), history.data());
    const double exact = G * rate * ((1.0 - g) * t + g * tau * (1.0 - std::exp(-t / tau)));
    EXPECT_NEAR(law.operator()<D>(F.a, history.data()).P[1], exact, 1e-6 * exact);    // of the strain
  }
}

TYPED_TEST(Elastic, WeightsOfTheSmoothedStrainKeepLinearFields)
{
  constexpr int D = TypeParam::value, N = 9, NV = 2 * D + 2;
  Random random(4);
  std::vector<double> numbers((size_t) whole_blocks(N) * NV, 0.0);
  int type[N + 1] = {}, partner[whole_blocks(N)] = {};
  for (int j = 0; j < N; j++) {
    partner[j] = j + 1;
    // to one side, as at a face
    for (int a = 0; a < D; a++) numbers[number_of_bond(j, NV) + (D + a) * BOND_BLOCK] = a ? random(-1.0, 1.0) : random(0.0, 1.0);
  }
  const std::vector<BondRow> rows = {{0, N, partner, numbers.data(), nullptr, 2.0, 0.0, 1.0}};
  VolumetricStrain s;
  s.modulus = {3.0};
  s.find_weights<D>(rows, type, [](int) { return true; }, [](int, int j) { return j != 3; }, [](int) { return 2.0; });
  double sum = s.own[0], first[D] = {};
  for (int j = 0; j < N; j++) {
    sum += s.weight[j];
    for (int a = 0; a < D; a++) first[a] += s.weight[j] * numbers[number_of_bond(j, NV) + (D + a) * BOND_BLOCK];
  }
  EXPECT_NEAR(sum, 1.0, 1e-13);
  for (const double x : first) EXPECT_NEAR(x, 0.0, 1e-13);
  EXPECT_EQ(s.weight[2], 0.0);    // of another material
  EXPECT_EQ(s.stiffness[0], 6.0);
}

TYPED_TEST(Elastic, ReferenceIsFreeOfStressAndEnergy)
{
  constexpr int D = TypeParam::value;
  each_law(D, [&](const auto &law, const char *name) {
    const auto r = law.template operator()<D>(unit<D>().a);
    for (const double p : r.P) EXPECT_EQ(p, 0.0) << name;
    EXPECT_EQ(r.energy, 0.0) << name;
    EXPECT_EQ(r.zz, 0.0) << name;
  });
}

// P = lambda tr(e) I + 2 mu e; plane stress: E/(1 - nu^2) [(1 - nu) e + nu tr(e) I]
TYPED_TEST(Elastic, SmallStrain)
{
  constexpr int D = TypeParam::value;
  Random random(2);
  const auto H = random_matrix<D>(random, 1.0);
  const auto e = 0.5 * (H + H.transposed());
  double tr = 0.0;
  for (int a = 0; a < D; a++) tr += e(a, a);
  const double size = 1e-6;
  each_law(D, [&](const auto &law, const std::string &name) {
    const bool flat = name.find("plane") != std::string::npos;
    const auto expected = flat ? E / (1 - NU * NU) * ((1 - NU) * e + NU * tr * unit<D>()) : LAMBDA * tr * unit<D>() + 2 * G * e;
    const auto r = law.template operator()<D>((unit<D>() + size * H).a);
    EXPECT_LT(difference((1.0 / size) * stress_of<D>(r), expected), 1e-4) << name;    // next order: 1e-6 times 10
    EXPECT_NEAR(r.zz / size, D == 2 && !flat ? LAMBDA * tr : 0.0, 1e-4) << name;
  });
}

TYPED_TEST(Elastic, Objectivity)
{
  constexpr int D = TypeParam::value;
  Random random(3);
  each_law(D, [&](const auto &law, const char *name) {
    for (int n = 0; n < 20; n++) {
      const auto F = deformation<D>(random, 0.3), R = random_rotation<D>(random);
      const auto r = law.template operator()<D>(F.a), turned = law.template operator()<D>((R * F).a);
      EXPECT_LT(difference(stress_of<D>(turned), R * stress_of<D>(r)), 1e-13) << name;
      EXPECT_NEAR(turned.energy, r.energy, 1e-13) << name;
      EXPECT_NEAR(turned.zz, r.zz, 1e-13) << name;
      // isotropy
      EXPECT_LT(difference(stress_of<D>(law.template operator()<D>((F * R).a)), stress_of<D>(r) * R), 1e-13) << name;
      // no moment: P F^T is symmetric
      const auto tau = stress_of<D>(r) * F.transposed();
      EXPECT_LT(difference(tau, tau.transposed()), 1e-14) << name;
    }
  });
}

TYPED_TEST(Elastic, UniaxialStrain)
{
  constexpr int D = TypeParam::value;
  for (const double s : {0.6, 0.9, 1.3, 2.0}) {
    auto F = unit<D>();
    F(0, 0) = s;
    const double e = 0.5 * (s * s - 1), l = std::log(s);
    const auto svk = StVenantKirchhoff(K, G, false).operator()<D>(F.a);
    EXPECT_NEAR(svk.P[0], s * (LAMBDA + 2 * G) * e, 1e-13);
    EXPECT_NEAR(svk.P[D + 1], LAMBDA * e, 1e-13);
    EXPECT_NEAR(svk.energy, 0.5 * (LAMBDA + 2 * G) * e * e, 1e-13);
    EXPECT_NEAR(svk.zz, D == 2 ? LAMBDA * e : 0.0, 1e-13);
    const auto nh = NeoHookean(K, G, false).operator()<D>(F.a);
    EXPECT_NEAR(nh.P[0], G * (s - 1 / s) + LAMBDA * l / s, 1e-13);
    EXPECT_NEAR(nh.P[D + 1], LAMBDA * l, 1e-13);    // det(F) F^-1 = s in the other directions, over s
    EXPECT_NEAR(nh.energy, 0.5 * G * (s * s - 1) - G * l + 0.5 * LAMBDA * l * l, 1e-13);
    EXPECT_NEAR(nh.zz, D == 2 ? LAMBDA * l : 0.0, 1e-13);
    // simple shear leaves the volume
    auto shear = unit<D>();
    shear(0, 1) = s;
    EXPECT_NEAR(NeoHookean(K, G, false).operator()<D>(shear.a).P[1], G * s, 1e-13);
  }
}

TEST(Elastic, PlaneStrainIsTheSolidHeldThick)
{
  Random random(4);
  each_law(3, [&](const auto &law, const char *name) {
    const auto F = deformation<2>(random, 0.3);
    const double thick[9] = {F(0, 0), F(0, 1), 0, F(1, 0), F(1, 1), 0, 0, 0, 1};
    const auto flat = law.template operator()<2>(F.a);
    const auto full = law.template operator()<3>(thick);
    EXPECT_NEAR(flat.P[0], full.P[0], 1e-14) << name;
    EXPECT_NEAR(flat.P[1], full.P[1], 1e-14) << name;
    EXPECT_NEAR(flat.P[2], full.P[3], 1e-14) << name;
    EXPECT_NEAR(flat.P[3], full.P[4], 1e-14) << name;
    EXPECT_NEAR(flat.zz, full.P[8], 1e-14) << name;
    EXPECT_NEAR(flat.energy, full.energy, 1e-14) << name;
  });
}

// uniaxial stress, small: Young's modulus itself, and the lateral contraction nu
TEST(Elastic, PlaneStressModulus)
{
  const StVenantKirchhoff law(K, G, true);
  const double e = 1e-7;
  const double F[4] = {1 + e, 0, 0, 1 - NU * e};
  const auto r = law.operator()<2>(F);
  EXPECT_NEAR(r.P[0] / e, E, 1e-5);
  EXPECT_NEAR(r.P[3] / e, 0.0, 1e-5);
  EXPECT_EQ(r.zz, 0.0);
}

TYPED_TEST(Elastic, CofactorAndDeterminant)
{
  constexpr int D = TypeParam::value;
  Random random(5);
  for (int n = 0; n < 10; n++) {
    const auto F = random_matrix<D>(random, 1.0);
    Matrix<D> C;
    cofactor<D>(F.a, C.a);
    EXPECT_LT(difference(C.transposed() * F, LAMMPS_NS::FSI::determinant<D>(F.a) * unit<D>()), 1e-14);
  }
}

/* ---------------------------------------------------------------------- */

TYPED_TEST(Elastic, ContactForceIsMinusTheDerivativeOfItsEnergy)
{
  constexpr int D = TypeParam::value;
  const double dx = 0.02, k1 = 3.0, k2 = 5.0;
  const Contact contact(D, dx);
  for (const double r : {0.05, 0.3, 0.7, 0.99}) {
    const double x = r * dx, step = 1e-6 * dx, force = contact(x * x, k1, k2) * x;
    const double up = contact.energy((x + step) * (x + step), k1, k2), down = contact.energy((x - step) * (x - step), k1, k2);
    EXPECT_GT(force, 0.0);    // away from j
    EXPECT_NEAR(force, -(up - down) / (2 * step), 1e-8 * k1 * std::pow(dx, D - 1));
    // pushed in by e dx: a layer of particles dx apart pushes back with the modulus times e
    const double mean = 2 * k1 * k2 / (k1 + k2);
    EXPECT_NEAR(force / std::pow(dx, D - 1), mean * (1 - r), 1e-13 * mean);
    EXPECT_NEAR(contact.energy(x * x, k1, k2), 0.5 * mean * std::pow(dx, D) * (1 - r) * (1 - r), 1e-13 * mean * std::pow(dx, D));
    EXPECT_EQ(contact(x * x, k1, k2), contact(x * x, k2, k1));
  }
}

TYPED_TEST(Elastic, ContactEndsAtTheSpacing)
{
  const double dx = 0.02;
  const Contact contact(TypeParam::value, dx);
  for (const double r : {1.0, 1.0001, 3.0}) {
    EXPECT_EQ(contact(r * r * dx * dx, 3.0, 5.0), 0.0);
    EXPECT_EQ(contact.energy(r * r * dx * dx, 3.0, 5.0), 0.0);
  }
  EXPECT_TRUE(std::isfinite(contact(0.0, 3.0, 5.0)));    // particles in one place
}
