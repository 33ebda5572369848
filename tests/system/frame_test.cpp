#include <rubato/model/model.hpp>
#include <rubato/system/assemble.hpp>

#include "support/frame.hpp"

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include <cmath>
#include <cstdio>

namespace rubato::system {
namespace {

Vector frequencies(const LocallyNonlinear& system) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> modes{Matrix(system.stiffness()), Matrix(system.mass())};
  return modes.eigenvalues().cwiseSqrt();
}

std::string seven_digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6E", value);
  return text;
}

// Cardona and Cassano (1991), Table I: seven digits.
TEST(PortalFrame, HasTheFrequenciesOfTableIToAllPrintedDigits) {
  const char* printed[] = {"5.542866E+01", "2.693958E+02", "3.832101E+02", "8.230052E+02",
                           "9.948448E+02", "1.786312E+03", "2.140908E+03", "2.655421E+03",
                           "2.793058E+03", "3.541398E+03", "4.415571E+03", "5.987948E+03",
                           "8.182647E+03", "9.428862E+03", "1.456397E+04", "1.662069E+04"};
  const Vector found = frequencies(assemble(model::build(testing::portal_frame(), {})));
  ASSERT_EQ(found.size(), 16);
  for (Index i = 0; i < 16; ++i) EXPECT_EQ(seven_digits(found[i]), printed[i]) << "mode " << i + 1;
}

// Reference page, section 3: computed there independently. The eigenvalues of a pencil are known to its condition
// number (9e4 here, in the square of the frequency) times round-off.
TEST(PortalFrame, HasTheFrequenciesOfTheIndependentReplication) {
  const Vector found = frequencies(assemble(model::build(testing::portal_frame(), {})));
  EXPECT_NEAR(found[0], 55.428662217, 1e-8);
  EXPECT_NEAR(found[15], 16620.686882, 1e-6);
}

TEST(PortalFrame, NamesItsDegreesOfFreedomAndTheirUnits) {
  const LocallyNonlinear system = assemble(model::build(testing::portal_frame(), {}));
  ASSERT_EQ(system.size(), 16);
  EXPECT_EQ(system.coordinates()[0], "1.y");
  EXPECT_EQ(system.coordinates()[15], "6.rz");
  EXPECT_FALSE(system.is_rotation(0));
  EXPECT_TRUE(system.is_rotation(15));
}

/// A cantilever of 2 m along x.
LocallyNonlinear cantilever(int elements, bool lumped_mass) {
  model::ModelDescription description;
  auto& structure = description.structure;
  structure.nodes = {{"foot", {0.0, 0.0}, {}}, {"tip", {2.0, 0.0}, {}}};
  structure.materials = {{"steel", 2.1e11, 0.3, {}, 7850.0, {}}};
  structure.sections = {{"bar", 1e-2, {1e-6}, {}, {}, {}}};
  model::BeamDescription beam;
  beam.nodes = {"foot", "tip"};
  beam.section = "bar";
  beam.material = "steel";
  beam.elements = elements;
  beam.lumped_mass = lumped_mass;
  beam.formulation = model::BeamDescription::Formulation::euler_bernoulli;
  structure.beams = {beam};
  model::SupportDescription foot;
  foot.node = "foot";
  foot.fix = {"x", "y", "rz"};
  structure.supports = {foot};
  return assemble(model::build(description, {}));
}

// omega = (beta L)^2 sqrt(E I/(rho A L^4)), cos(beta L) cosh(beta L) = -1. Cubic elements with consistent mass miss
// omega^2 by (beta h)^4/720 at leading order, from above; halving h divides that by 16.
TEST(Cantilever, HasTheFrequenciesOfEulerAndBernoulli) {
  const double scale = std::sqrt(2.1e11 * 1e-6 / (7850.0 * 1e-2 * 16.0));
  const double roots[] = {1.875104068711961, 4.694091132974175, 7.854757438237613};
  const Vector coarse = frequencies(cantilever(8, false)), fine = frequencies(cantilever(16, false));
  for (int i = 0; i < 3; ++i) {
    const double exact = roots[i] * roots[i] * scale, bound = std::pow(roots[i] / 8.0, 4) / 1440.0;
    EXPECT_GT(coarse[i], exact);
    EXPECT_NEAR(coarse[i] / exact - 1.0, bound, 0.15 * bound);
    EXPECT_NEAR((coarse[i] - exact) / (fine[i] - exact), 16.0, 1.0);
  }
}

// Lumped masses: second order in the length of an element.
TEST(Cantilever, HasTheFirstFrequencyWithLumpedMassesToSecondOrder) {
  const double exact = std::pow(1.875104068711961, 2) * std::sqrt(2.1e11 * 1e-6 / (7850.0 * 1e-2 * 16.0));
  const double coarse = frequencies(cantilever(8, true))[0] - exact,
               fine = frequencies(cantilever(16, true))[0] - exact;
  EXPECT_NEAR(coarse / fine, 4.0, 0.2);
}

// Reference page, section 3: "Euler-Bernoulli misses by 5e-3".
TEST(PortalFrame, MissesTableIWithoutShear) {
  model::ModelDescription description = testing::portal_frame();
  for (auto& beam : description.structure.beams)
    beam.formulation = model::BeamDescription::Formulation::euler_bernoulli;
  const Vector found = frequencies(assemble(model::build(description, {})));
  double largest = 0.0;
  const Vector exact = frequencies(assemble(model::build(testing::portal_frame(), {})));
  for (Index i = 0; i < 8; ++i) largest = std::max(largest, std::abs(found[i] / exact[i] - 1.0));
  EXPECT_GT(largest, 2e-3);
  EXPECT_LT(largest, 5e-2);
}

}  // namespace
}  // namespace rubato::system
