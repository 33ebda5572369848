#include <rubato/model/joints/space_joints.hpp>

#include <support/space_differences.hpp>

#include <numbers>

namespace rubato {
namespace {

using model::SpaceFrame;
using model::SpaceJointKind;
using numerics::Matrix3;
using numerics::rotation_of;
using numerics::Vector3;
using testing::free_space_node;
using testing::ground_space_node;
using testing::SpaceMotion;

SpaceFrame frame(int node, const Vector3& offset, const Vector3& turn) {
  return {{free_space_node(node), offset}, rotation_of(turn).toRotationMatrix()};
}

class SpaceJoints : public ::testing::TestWithParam<std::tuple<unsigned, SpaceJointKind>> {};

TEST_P(SpaceJoints, HaveTheSlopesOfTheirConstraints) {
  const auto [seed, kind] = GetParam();
  const auto joint = model::make_space_joint(kind, "j", frame(0, {0.3, -0.2, 0.5}, {0.1, 0.7, -0.4}),
                                             frame(1, {-0.1, 0.4, 0.2}, {-0.3, 0.2, 0.6}));
  testing::expect_consistent_joint(*joint, SpaceMotion(2, seed));
}

/// Both frames stand in one place of the world, however the nodes do: the joint is closed, and stays so where the
/// second node moves as the joint lets it.
TEST_P(SpaceJoints, CloseWhereTheirFramesMeet) {
  const auto [seed, kind] = GetParam();
  SpaceMotion at(2, seed);
  const Vector3 axis = Vector3(1.0, -2.0, 0.5).normalized(), point(0.4, 0.1, -0.3);
  const SpaceFrame first = model::frame_at(free_space_node(0), at.q.data(), point, axis);
  const SpaceFrame second = model::frame_at(free_space_node(1), at.q.data(), point, axis);
  const auto joint = model::make_space_joint(kind, "j", first, second);
  std::vector<double> g(std::size_t(joint->rows())), jacobian(g.size() * 12);
  joint->constraint(at.motion(), g.data(), jacobian.data());
  for (const double gap : g) EXPECT_NEAR(gap, 0.0, 1e-15);

  const bool turns =
      kind == SpaceJointKind::revolute || kind == SpaceJointKind::cylindrical || kind == SpaceJointKind::planar;
  const bool slides = kind == SpaceJointKind::prismatic || kind == SpaceJointKind::cylindrical;
  double* numbers = at.q.data() + 14;
  const Vector3 arm = Vector3(numbers[0], numbers[1], numbers[2]) - point;
  const auto turn = rotation_of((turns ? 0.8 : 0.0) * axis);
  const Vector3 moved = point + turn * arm + (slides ? 0.6 : 0.0) * axis;
  const auto turned = turn * numerics::Rotation(numbers[3], numbers[4], numbers[5], numbers[6]);
  const double now[7] = {moved[0], moved[1], moved[2], turned.w(), turned.x(), turned.y(), turned.z()};
  std::copy(now, now + 7, numbers);
  joint->constraint(at.motion(), g.data(), jacobian.data());
  for (const double gap : g) EXPECT_NEAR(gap, 0.0, 1e-15);
}

INSTANTIATE_TEST_SUITE_P(RandomStates, SpaceJoints,
                         ::testing::Combine(::testing::Range(1u, 4u),
                                            ::testing::Values(SpaceJointKind::rigid, SpaceJointKind::revolute,
                                                              SpaceJointKind::prismatic, SpaceJointKind::cylindrical,
                                                              SpaceJointKind::spherical, SpaceJointKind::universal,
                                                              SpaceJointKind::planar)));

TEST(SpaceJoint, ToTheGroundHoldsAFreeBody) {
  SpaceMotion at(1, 5);
  const auto joint = model::make_space_joint(SpaceJointKind::revolute, "hinge",
                                             {{ground_space_node(), {0.2, 0.0, 0.1}}, Matrix3::Identity()},
                                             frame(0, {-0.1, 0.4, 0.2}, {-0.3, 0.2, 0.6}));
  testing::expect_consistent_joint(*joint, at);
  EXPECT_EQ(joint->row_names(), (std::vector<std::string>{"x", "y", "z", "moment_x", "moment_y"}));
}

TEST(SpaceJoint, OfADistanceHasTheSlopesOfItsConstraint) {
  for (unsigned seed = 1; seed < 4; ++seed)
    testing::expect_consistent_joint(*model::make_space_distance("rod", {free_space_node(0), {0.3, -0.2, 0.5}},
                                                                 {free_space_node(1), {0.1, 0.1, -0.4}}, 0.7),
                                     SpaceMotion(2, seed));
}

TEST(SpaceScrew, HasTheSlopesOfItsConstraint) {
  for (unsigned seed = 1; seed < 4; ++seed)
    testing::expect_consistent_joint(*model::make_space_screw("screw", frame(0, {0.3, -0.2, 0.5}, {0.1, 0.7, -0.4}),
                                                              frame(1, {-0.1, 0.4, 0.2}, {-0.3, 0.2, 0.6}), 0.4),
                                     SpaceMotion(2, seed));
}

TEST(SpaceScrew, GoesAlongByItsLeadATurnForManyTurns) {
  const double lead = 0.05;
  const auto joint = model::make_space_screw("screw", {{ground_space_node(), Vector3::Zero()}, Matrix3::Identity()},
                                             {{free_space_node(0), Vector3::Zero()}, Matrix3::Identity()}, lead);
  SpaceMotion at(1, 1, 0.0);
  for (const double angle : {0.0, 1.0, 3.0, 3.3, 20.0, -47.0}) {
    const auto turn = rotation_of({0.0, 0.0, angle});
    const double now[7] = {0.0, 0.0, lead * angle / (2.0 * std::numbers::pi), turn.w(), 0.0, 0.0, turn.z()};
    std::copy(now, now + 7, at.q.data() + 7);
    double g[5], jacobian[60];
    joint->constraint(at.motion(), g, jacobian);
    for (const double gap : g) EXPECT_NEAR(gap, 0.0, 1e-14) << angle;
  }
}

}  // namespace
}  // namespace rubato
