#include <rubato/model/beams/geometrically_exact.hpp>

#include <support/mechanism_differences.hpp>

#include <array>
#include <cmath>
#include <memory>

namespace rubato {
namespace {

using testing::free_plane_node;
using testing::RandomMotion;

const model::PlaneSection section{7.0, 3.0, 2.0};

std::unique_ptr<model::Element> beam() {
  return model::make_plane_beam("b", free_plane_node(0), free_plane_node(1), {0.0, 0.0, 0.2}, {1.5, 0.8, -0.1},
                                section);
}

class PlaneBeams : public ::testing::TestWithParam<unsigned> {};

TEST_P(PlaneBeams, HaveForcesOfAnEnergyAndAConsistentTangent) {
  const auto element = beam();
  const RandomMotion at(2, GetParam(), 2.0);
  testing::expect_force_of_energy(*element, at, 100.0);
  testing::expect_consistent_tangent(*element, at, 100.0);
}

INSTANTIATE_TEST_SUITE_P(RandomStates, PlaneBeams, ::testing::Range(1u, 8u));

TEST(PlaneBeams, FeelNothingOfARigidMotion) {
  const auto element = beam();
  RandomMotion at(2, 1);
  const double turn = 40.0, c = std::cos(turn), s = std::sin(turn);
  const double start[2][3] = {{0.0, 0.0, 0.2}, {1.5, 0.8, -0.1}};
  for (std::size_t i = 0; i < 2; ++i) {
    at.q[3 + 3 * i] = c * start[i][0] - s * start[i][1] + 5.0;
    at.q[4 + 3 * i] = s * start[i][0] + c * start[i][1] - 7.0;
    at.q[5 + 3 * i] = start[i][2] + turn;
  }
  double force[6];
  element->force(at.motion(), force);
  for (const double value : force) EXPECT_NEAR(value, 0.0, 1e-13);  // strains round at 1e-15
}

TEST(PlaneBeams, BendUnderAPureMomentIntoAnArcOfTheirCurvature) {
  // With no force at its ends an element turns by moment L/(E I) and its chord keeps its length along the mean angle.
  const auto element =
      model::make_plane_beam("b", free_plane_node(0), free_plane_node(1), {0.0, 0.0, 0.0}, {1.2, 0.0, 0.0}, section);
  RandomMotion at(2, 1);
  const double moment = 1.5, turn = moment * 1.2 / section.bending;
  const double q[6] = {0.0, 0.0, 0.0, 1.2 * std::cos(0.5 * turn), 1.2 * std::sin(0.5 * turn), turn};
  std::copy(q, q + 6, at.q.begin() + 3);
  double force[6];
  element->force(at.motion(), force);
  const double expected[6] = {0.0, 0.0, -moment, 0.0, 0.0, moment};
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(force[i], expected[i], 1e-14);
}

std::unique_ptr<model::Element> viscous_beam() {
  return model::make_viscous_plane_beam("b", free_plane_node(0), free_plane_node(1), {0.0, 0.0, 0.2}, {1.5, 0.8, -0.1},
                                        section, 0.3);
}

TEST_P(PlaneBeams, OfAViscousMaterialHaveAConsistentTangentAndTakeThePowerOfTheirStrainRates) {
  const auto viscous = viscous_beam();
  const RandomMotion at(2, GetParam(), 2.0);
  testing::expect_consistent_tangent(*viscous, at, 100.0);
  EXPECT_EQ(viscous->role(), model::Element::Role::damper);
  // tau times twice the energy of the strain rates, which differences of positions along v give.
  const auto strain = [&](double s) {
    const auto at_node = [&](std::size_t i) { return at.q[3 + i] + s * at.padded[1 + i]; };
    const double dx = at_node(3) - at_node(0), dy = at_node(4) - at_node(1), length = std::hypot(1.5, 0.8);
    const double mean = std::atan2(0.8, 1.5) - 0.05 + 0.5 * (at_node(2) + at_node(5));
    return std::array<double, 3>{(std::cos(mean) * dx + std::sin(mean) * dy) / length,
                                 (std::cos(mean) * dy - std::sin(mean) * dx) / length,
                                 (at_node(5) - at_node(2)) / length};
  };
  const auto more = strain(1e-5), less = strain(-1e-5);
  const double stiffness[3] = {section.axial, section.shear, section.bending};
  double expected = 0.0, power = 0.0, force[6];
  for (std::size_t i = 0; i < 3; ++i)
    expected += 0.3 * std::hypot(1.5, 0.8) * stiffness[i] * std::pow((more[i] - less[i]) / 2e-5, 2);
  viscous->force(at.motion(), force);
  for (std::size_t i = 0; i < 6; ++i) power += force[i] * at.padded[1 + i];
  EXPECT_NEAR(power, expected, 1e-8 * expected);  // of the differences
}

TEST(PlaneBeams, OfAViscousMaterialTurnAndTravelFreely) {
  const auto viscous = viscous_beam();
  RandomMotion at(2, 5, 2.0);
  const double spin = 3.0;
  for (std::size_t node = 0; node < 2; ++node) {
    at.padded[1 + 3 * node] = 5.0 - spin * at.q[4 + 3 * node];
    at.padded[2 + 3 * node] = 7.0 + spin * at.q[3 + 3 * node];
    at.padded[3 + 3 * node] = spin;
  }
  double force[6];
  viscous->force(at.motion(), force);
  for (const double value : force) EXPECT_NEAR(value, 0.0, 1e-13);
}

}  // namespace
}  // namespace rubato
