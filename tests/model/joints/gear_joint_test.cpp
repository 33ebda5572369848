#include <rubato/model/joints/gear_joint.hpp>
#include <rubato/model/joints/space_coordinate.hpp>

#include <support/space_differences.hpp>

#include <gtest/gtest.h>

namespace rubato {
namespace {

using model::SpaceCoordinate;
using numerics::Vector3;
using testing::SpaceMotion;

SpaceCoordinate between(Index first, Index second, const model::SpaceRow& row, bool is_angle) {
  SpaceCoordinate s;
  s.kind = is_angle ? SpaceCoordinate::Kind::angle : SpaceCoordinate::Kind::displacement;
  s.first = {testing::free_space_node(first), {0.3, -0.2, 0.4}};
  s.second = {testing::free_space_node(second), {-0.1, 0.5, 0.2}};
  s.row = row;
  return s;
}

// Of two joints that share a part, and of two that do not.
TEST(Gears, JoinCoordinatesWithConsistentDerivatives) {
  const Vector3 start(0.6, 0.8, 0.0);
  const model::TurnAngle angle{{Vector3::UnitX(), start}, {Vector3::UnitY(), start}};
  for (const Index third : {Index{1}, Index{2}}) {
    const auto gear = model::make_gear("gear", between(0, 1, angle, true),
                                       between(third, 3, model::BodyGap{Vector3(0.0, 0.6, 0.8)}, false), -0.7, 0.2);
    EXPECT_EQ(gear->row_names().front(), "gear_moment");
    for (const unsigned seed : {1u, 2u, 3u}) testing::expect_consistent_joint(*gear, SpaceMotion(4, seed, 0.5), 10.0);
  }
}

}  // namespace
}  // namespace rubato
