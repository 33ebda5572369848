#include <rubato/model/joints/joint_friction.hpp>
#include <rubato/model/joints/space_coordinate.hpp>
#include <rubato/model/mechanism.hpp>
#include <rubato/system/mechanism.hpp>

#include <support/space_differences.hpp>

#include <gtest/gtest.h>

#include <numbers>

namespace rubato {
namespace {

using model::SpaceCoordinate;
using Kind = SpaceCoordinate::Kind;
using numerics::Rotation;
using numerics::Vector3;
using testing::SpaceMotion;

SpaceCoordinate coordinate(Kind kind) {
  SpaceCoordinate s;
  s.kind = kind;
  s.first = {testing::free_space_node(0), {0.3, -0.2, 0.4}};
  s.second = {testing::free_space_node(1), {-0.1, 0.5, 0.2}};
  const Vector3 start(0.6, 0.8, 0.0);
  if (kind == Kind::angle)
    s.row = model::TurnAngle{{Vector3::UnitX(), start}, {Vector3::UnitY(), start}};
  else if (kind == Kind::length)
    s.row = model::PointDistance{};
  else
    s.row = model::BodyGap{Vector3(0.0, 0.6, 0.8)};
  s.zero = 0.1;
  return s;
}

TEST(SpaceCoordinates, MakeForcesWithConsistentTangents) {
  const numerics::Parameters none;
  for (const auto kind : {Kind::angle, Kind::displacement, Kind::length}) {
    const SpaceCoordinate s = coordinate(kind);
    const auto spring = model::make_joint_spring("s", s, 3.0, 0.2), damper = model::make_joint_damper("d", s, 0.7);
    const auto drive = model::make_joint_drive("m", s, "2*rate + t", none);
    for (const unsigned seed : {1u, 2u, 3u}) {
      const SpaceMotion at(2, seed, 0.5);
      testing::expect_consistent_tangent(*spring, at, 10.0);
      testing::expect_force_of_energy(*spring, at, 10.0);
      testing::expect_consistent_tangent(*damper, at, 10.0);
      testing::expect_consistent_damping(*damper, at, 10.0);
      testing::expect_consistent_tangent(*drive, at, 10.0);
    }
  }
}

TEST(SpaceCoordinates, AreHeldWithConsistentDerivatives) {
  for (const auto kind : {Kind::angle, Kind::displacement, Kind::length}) {
    const SpaceCoordinate s = coordinate(kind);
    const auto lock = model::make_lock_joint("lock", s, 0.4, 0);
    const model::StickingJoint<SpaceCoordinate> stuck("stuck", s, 0);
    for (const unsigned seed : {1u, 2u, 3u}) {
      const SpaceMotion at(2, seed, 0.5);
      testing::expect_consistent_joint(*lock, at, 10.0);
      testing::expect_consistent_joint(stuck, at, 10.0);
      double g = 0.0, slope[12];
      lock->constraint(at.motion(), &g, slope);
      EXPECT_DOUBLE_EQ(g, s.value(at.q.data()) - 0.4);
      stuck.constraint(at.motion(), &g, slope);
      EXPECT_DOUBLE_EQ(g, s.value(at.q.data()) - 0.2);
    }
  }
}

TEST(SpaceCoordinates, OfACrossAreHeldWithConsistentDerivatives) {
  SpaceCoordinate s = coordinate(Kind::angle);
  const model::SpaceFrame first{s.first}, second{s.second, numerics::Matrix3(Rotation(0.8, 0.36, -0.48, 0.0))};
  for (const model::TurnAngle& angle : model::turns_of_cross(first, second)) {
    s.row = angle;
    const model::StickingJoint<SpaceCoordinate> stuck("stuck", s, 0);
    for (const unsigned seed : {1u, 2u, 3u}) testing::expect_consistent_joint(stuck, SpaceMotion(2, seed, 0.5), 10.0);
  }
}

// Turned in the first part by 0.3 rad about one pin, and on the cross by 0.5 rad about the other.
TEST(SpaceCoordinates, OfACrossAreTheAnglesOfItsPins) {
  const model::SpacePoint first{testing::free_space_node(0), Vector3::Zero()};
  const model::SpacePoint second{testing::free_space_node(1), Vector3::Zero()};
  std::vector<double> q(21, 0.0);  // of the ground and two nodes, quaternions from their fourth on
  const Rotation turned =
      Rotation(Eigen::AngleAxisd(0.3, Vector3::UnitX())) * Rotation(Eigen::AngleAxisd(0.5, Vector3::UnitY()));
  q[10] = 1.0;
  q[17] = turned.w();
  q[18] = turned.x();
  q[19] = turned.y();
  q[20] = turned.z();
  const auto angles = model::turns_of_cross({first}, {second});
  EXPECT_NEAR(model::angle_of(angles[0], model::pair_of(q.data(), first, second)), 0.3, 1e-14);
  EXPECT_NEAR(model::angle_of(angles[1], model::pair_of(q.data(), first, second)), 0.5, 1e-14);
}

/// Along a thread of radius 0.4 m whose helix rises by a third.
SpaceCoordinate path() {
  return model::path_along_thread(coordinate(SpaceCoordinate::Kind::angle), Vector3(0.0, 0.6, 0.8),
                                  2.0 * std::numbers::pi * 0.4 / 3.0, 0.4);
}

TEST(SpaceCoordinates, AreHeldAlongAThreadWithConsistentDerivatives) {
  const model::StickingJoint<SpaceCoordinate> stuck("stuck", path(), 0);
  EXPECT_EQ(stuck.row_names()[0], "friction_moment");
  for (const unsigned seed : {1u, 2u, 3u}) testing::expect_consistent_joint(stuck, SpaceMotion(2, seed, 0.5), 10.0);
}

// The angle where the way is 0.4/3 of it, and still where the point of contact moves across the helix: cos^2 = 9/10.
TEST(SpaceCoordinates, OfAThreadMoveAlongItOnly) {
  const SpaceCoordinate s = path(), angle = coordinate(SpaceCoordinate::Kind::angle),
                        way = coordinate(SpaceCoordinate::Kind::displacement);
  double s_slope[12], angle_slope[12], way_slope[12];
  const SpaceMotion at(2, 5, 0.5);
  s.slope(at.q.data(), s_slope);
  angle.slope(at.q.data(), angle_slope);
  way.slope(at.q.data(), way_slope);
  for (int i = 0; i < 12; ++i)
    EXPECT_NEAR(s_slope[i], 0.9 * angle_slope[i] + 0.9 / (3.0 * 0.4) * way_slope[i], 1e-14) << i;
  EXPECT_DOUBLE_EQ(s.share + s.way_share * 0.4 / 3.0, 1.0);
  EXPECT_NEAR(s.share * 1.0 - s.way_share * 0.4 * 3.0, 0.0, 1e-15);
}

// s'' by differences of s' along a motion with constant accelerations, which err by the square of the step.
TEST(SpaceCoordinates, TellTheirRates) {
  for (const SpaceCoordinate& s :
       {coordinate(Kind::angle), coordinate(Kind::displacement), coordinate(Kind::length), path()}) {
    SpaceMotion at(2, 7, 0.5);
    std::vector<double> acceleration(at.padded.size(), 0.0);
    for (std::size_t i = 1; i < acceleration.size(); ++i) acceleration[i] = 0.1 * double(i) - 0.5;
    const double e = 1e-5;
    const auto moved = [&](double by) {
      SpaceMotion there = at;
      // The increments of a node's rotation belong together.
      for (Index node = 0; node < 2; ++node) {
        Vector3 turn;
        for (Index i = 0; i < 3; ++i) {
          there.move(6 * node + i, by * at.padded[std::size_t(6 * node + i) + 1]);
          turn[i] = by * at.padded[std::size_t(6 * node + 3 + i) + 1];
        }
        double* q = there.q.data() + 7 * (node + 1) + 3;
        const Rotation next = Rotation(q[0], q[1], q[2], q[3]) * numerics::rotation_of(turn);
        q[0] = next.w(), q[1] = next.x(), q[2] = next.y(), q[3] = next.z();
      }
      for (std::size_t i = 1; i < there.padded.size(); ++i) there.padded[i] += by * acceleration[i];
      return there;
    };
    const SpaceMotion more = moved(e), less = moved(-e);
    EXPECT_NEAR(s.rate(at.motion()), (s.value(more.q.data()) - s.value(less.q.data())) / (2.0 * e), 1e-8);
    EXPECT_NEAR(s.second_rate(at.motion(), acceleration.data() + 1),
                (s.rate(more.motion()) - s.rate(less.motion())) / (2.0 * e), 1e-8);
  }
}

TEST(SpaceCoordinates, CountTheTurnsOfAnAngleInTheConfiguration) {
  model::Mechanism wheel(3);
  const Index body = wheel.add_space_node("wheel", Vector3::Zero(), Rotation::Identity());
  wheel.add_space_body(body, 1.0, numerics::Matrix3::Identity());
  const auto numbers = wheel.numbers();
  const auto first = model::frame_at(wheel.space_node(0), numbers.data(), Vector3::Zero(), Vector3::UnitZ());
  const auto second = model::frame_at(wheel.space_node(body), numbers.data(), Vector3::Zero(), Vector3::UnitZ());
  SpaceCoordinate s;
  s.first = first.point;
  s.second = second.point;
  s.row = model::turn_of(first, second);
  s.counter = wheel.add_turn_counter({first.point, second.point, model::turn_of(first, second)});
  const system::Mechanism mechanism(std::move(wheel));
  EXPECT_EQ(mechanism.configuration_size(), 15);
  Vector q = mechanism.start().q, next, dq = Vector::Zero(6);
  dq[5] = 0.9;  // of a turn of 2 pi: seven steps a turn
  for (int i = 1; i <= 100; ++i) {
    mechanism.retract(q, dq, next);
    q = next;
    ASSERT_NEAR(s.value(q.data()), 0.9 * i, 1e-12) << i;
  }
  dq[5] = -3.0;  // back, by nearly half a turn a step
  for (int i = 0; i < 30; ++i) {
    mechanism.retract(q, dq, next);
    q = next;
  }
  EXPECT_NEAR(s.value(q.data()), 0.0, 1e-12);
}

}  // namespace
}  // namespace rubato
