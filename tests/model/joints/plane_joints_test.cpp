#include <rubato/model/joints/plane_joints.hpp>

#include <support/mechanism_differences.hpp>

namespace rubato {
namespace {

using testing::free_plane_node;
using testing::RandomMotion;

// Offsets of a point on either node, drawn with the configuration.
std::array<model::PlanePoint, 2> points(unsigned seed) {
  std::mt19937 random(seed + 1000);
  std::uniform_real_distribution<double> draw(-1.0, 1.0);
  return {model::PlanePoint{free_plane_node(0), {draw(random), draw(random)}},
          model::PlanePoint{free_plane_node(1), {draw(random), draw(random)}}};
}

class PlaneJoints : public ::testing::TestWithParam<unsigned> {};

TEST_P(PlaneJoints, HaveTheSlopesAndCurvaturesOfTheirConstraints) {
  const auto [first, second] = points(GetParam());
  const RandomMotion at(2, GetParam(), 2.0);
  testing::expect_consistent_joint(*model::make_plane_revolute("r", first, second), at, 10.0);
  testing::expect_consistent_joint(*model::make_plane_rigid("w", first, second, 0.4), at, 10.0);
  testing::expect_consistent_joint(*model::make_plane_prismatic("p", first, second, {0.6, 0.8}, 0.1), at, 10.0);
  testing::expect_consistent_joint(*model::make_plane_prismatic("s", first, second, {0.6, 0.8}, 0.1, false), at, 10.0);
  testing::expect_consistent_joint(*model::make_plane_distance("d", first, second, 1.3), at, 10.0);
}

TEST_P(PlaneJoints, AreThoseOfAFixedPointWhereTheFirstNodeIsTheGround) {
  auto [first, second] = points(GetParam());
  first.node = testing::ground_plane_node();
  const RandomMotion at(2, GetParam(), 2.0);
  testing::expect_consistent_joint(*model::make_plane_revolute("r", first, second), at, 10.0);
  testing::expect_consistent_joint(*model::make_plane_prismatic("p", first, second, {1.0, 0.0}, 0.0), at, 10.0);
  testing::expect_consistent_joint(*model::make_plane_distance("d", first, second, 0.7), at, 10.0);
}

INSTANTIATE_TEST_SUITE_P(RandomStates, PlaneJoints, ::testing::Range(1u, 6u));

TEST(PlaneJoints, ArePreservedByARigidMotionOfBothNodes) {
  const auto [first, second] = points(7);
  RandomMotion at(2, 7);
  const auto prismatic = model::make_plane_prismatic("p", first, second, {0.6, 0.8}, 0.2);
  double before[2], after[2], jacobian[12];
  prismatic->constraint(at.motion(), before, jacobian);
  const double c = std::cos(1.1), s = std::sin(1.1);
  for (std::size_t i = 3; i < 9; i += 3) {
    const double x = at.q[i], y = at.q[i + 1];
    at.q[i] = c * x - s * y + 3.0;
    at.q[i + 1] = s * x + c * y - 2.0;
    at.q[i + 2] += 1.1;
  }
  prismatic->constraint(at.motion(), after, jacobian);
  EXPECT_NEAR(before[0], after[0], 1e-14);
  EXPECT_NEAR(before[1], after[1], 1e-14);
}

}  // namespace
}  // namespace rubato
