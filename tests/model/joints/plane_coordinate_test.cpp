#include <rubato/core/error.hpp>
#include <rubato/model/joints/plane_coordinate.hpp>
#include <rubato/model/joints/plane_spring.hpp>

#include <support/mechanism_differences.hpp>

namespace rubato {
namespace {

using model::PlaneCoordinate;
using testing::free_plane_node;
using testing::RandomMotion;

PlaneCoordinate coordinate(PlaneCoordinate::Kind kind) {
  PlaneCoordinate s;
  s.kind = kind;
  s.along = {{free_plane_node(0), {0.3, -0.4}}, {free_plane_node(1), {-0.2, 0.5}}, {0.6, 0.8}};
  s.zero = 0.25;
  return s;
}

class PlaneCoordinates : public ::testing::TestWithParam<std::tuple<unsigned, PlaneCoordinate::Kind>> {};

TEST_P(PlaneCoordinates, BearLawsWithConsistentTangents) {
  const auto [seed, kind] = GetParam();
  const PlaneCoordinate s = coordinate(kind);
  const RandomMotion at(2, seed);
  const auto spring = model::make_joint_spring("k", s, 3.0, 0.1);
  testing::expect_consistent_tangent(*spring, at, 10.0);
  testing::expect_force_of_energy(*spring, at, 10.0);
  testing::expect_consistent_tangent(*model::make_joint_damper("c", s, 2.0), at, 10.0);
  const std::string name = kind == PlaneCoordinate::Kind::angle ? "angle" : "displacement";
  testing::expect_consistent_tangent(
      *model::make_joint_drive("f", s, "M * sin(" + name + ") - 0.3*rate^3 + t", {{"M", 2.0}}), at, 10.0);
}

TEST_P(PlaneCoordinates, AreHeldByALockWithTheSlopesOfItsConstraint) {
  const auto [seed, kind] = GetParam();
  RandomMotion at(2, seed);
  const auto lock = model::make_lock_joint("l", coordinate(kind), 0.4, 1);
  double g, jacobian[6];
  lock->constraint(at.motion(), &g, jacobian);
  EXPECT_EQ(g, 0.0);
  EXPECT_EQ(jacobian[5], 0.0);
  EXPECT_FALSE(lock->is_active(at.motion()));
  at.phase[1] = 1;
  testing::expect_consistent_joint(*lock, at, 10.0);
}

INSTANTIATE_TEST_SUITE_P(RandomStates, PlaneCoordinates,
                         ::testing::Combine(::testing::Range(1u, 5u),
                                            ::testing::Values(PlaneCoordinate::Kind::angle,
                                                              PlaneCoordinate::Kind::displacement)));

TEST(PlaneCoordinates, PushOnlyInThePhaseOfTheirLock) {
  const PlaneCoordinate s = coordinate(PlaneCoordinate::Kind::angle);
  RandomMotion at(2, 3);
  const auto engaged = model::make_joint_spring("k", s, 3.0, 0.1, {0, true});
  const auto open = model::make_joint_drive("f", s, "2", {}, {0, false});
  double force[6];
  engaged->force(at.motion(), force);
  EXPECT_EQ(force[5], 0.0);
  open->force(at.motion(), force);
  EXPECT_EQ(force[5], -2.0);  // the drive opens the angle: an internal force against it
  EXPECT_EQ(force[2], 2.0);
  at.phase[0] = 1;
  engaged->force(at.motion(), force);
  EXPECT_NE(force[5], 0.0);
  open->force(at.motion(), force);
  EXPECT_EQ(force[5], 0.0);
}

TEST(CoordinateSprings, PullTwoNumbersTogetherOrOneToTheGround) {
  const RandomMotion at(2, 5);
  const model::NodeNumber first{3, 0}, second{8, 5}, still{};
  for (const auto& other : {second, still}) {
    const auto spring = model::make_coordinate_spring("k", first, other, 4.0, 0.2);
    testing::expect_consistent_tangent(*spring, at, 10.0);
    testing::expect_force_of_energy(*spring, at, 10.0);
    testing::expect_consistent_tangent(*model::make_coordinate_damper("c", first, other, 3.0), at, 10.0);
  }
  double force[2];
  model::make_coordinate_spring("k", first, still, 4.0, 0.2)->force(at.motion(), force);
  EXPECT_DOUBLE_EQ(force[0], 4.0 * (at.q[3] - 0.2));
}

TEST(PlaneCoordinates, RefuseAFormulaOfUnknownNames) {
  EXPECT_THROW(model::make_joint_drive("f", coordinate(PlaneCoordinate::Kind::angle), "2 * displacement", {}),
               InvalidInput);
}

}  // namespace
}  // namespace rubato
