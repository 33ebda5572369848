#include <rubato/core/error.hpp>
#include <rubato/model/joints/plane_coordinate.hpp>
#include <rubato/model/joints/plane_spring.hpp>

#include <support/mechanism_differences.hpp>

#include <cmath>
#include <string>

namespace rubato {
namespace {

using model::PlaneCoordinate;
using Beyond = model::CoordinateTable::Beyond;
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
  const std::string law = "M * sin(" + std::string(s.name()) + ") - 0.3*rate^3 + t";
  testing::expect_consistent_tangent(*model::make_joint_drive("f", s, law, {{"M", 2.0}}), at, 10.0);
  const auto table =
      model::make_joint_table("t", s, model::make_table({-9.0, 0.0, 9.0}, {3.0, -1.0, 2.0}, Beyond::error));
  testing::expect_consistent_tangent(*table, at, 10.0);
  testing::expect_force_of_energy(*table, at, 10.0);
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
                                                              PlaneCoordinate::Kind::displacement,
                                                              PlaneCoordinate::Kind::length)));

// U = -(integral of F): over (-2, 0) F rises from -4 to 4, over (0, 1) it falls to -4 and has its lowest U in 0.5.
TEST(CoordinateTables, KnowTheirPotential) {
  const model::CoordinateTable table = model::make_table({-2.0, 0.0, 1.0}, {-4.0, 4.0, -4.0}, Beyond::hold);
  EXPECT_EQ(table(0.5).force, 0.0);
  EXPECT_EQ(table(0.5).potential, 0.0);
  EXPECT_EQ(table(0.0).potential, 1.0);
  EXPECT_EQ(table(-1.0).potential, 3.0);
  EXPECT_EQ(table(-2.0).potential, 1.0);
  EXPECT_EQ(table(-1.5).slope, 4.0);
  EXPECT_EQ(table(2.0).force, -4.0);
  EXPECT_EQ(table(2.0).potential, 5.0);
  const model::CoordinateTable ends = model::make_table({-2.0, 0.0, 1.0}, {-4.0, 4.0, -4.0}, Beyond::zero);
  EXPECT_EQ(ends(2.0).force, 0.0);
  EXPECT_EQ(ends(2.0).potential, 1.0);
  EXPECT_EQ(ends(1.0).force, -4.0);
  EXPECT_TRUE(std::isnan(model::make_table({0.0, 1.0}, {0.0, 1.0}, Beyond::error)(1.1).force));
}

TEST(PlaneCoordinates, PushOnlyInThePhaseOfTheirLock) {
  const PlaneCoordinate s = coordinate(PlaneCoordinate::Kind::angle);
  RandomMotion at(2, 3);
  const auto engaged = model::make_joint_spring("k", s, 3.0, 0.1, {0, 1, true});
  const auto open = model::make_joint_drive("f", s, "2", {}, {0, 1, false});
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
