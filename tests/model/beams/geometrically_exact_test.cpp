#include <rubato/model/beams/geometrically_exact.hpp>

#include <support/mechanism_differences.hpp>

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

}  // namespace
}  // namespace rubato
