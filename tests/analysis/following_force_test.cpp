#include <support/laid_studies.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace rubato {
namespace {

using ::testing::HasSubstr;
using testing::in_plane;
using testing::Laid;
using testing::MechanismStudy;
using testing::rocket;

/// In the plane, and in a tilted plane of space.
class FollowingForces : public ::testing::TestWithParam<Laid> {};
INSTANTIATE_TEST_SUITE_P(Laid, FollowingForces, ::testing::Values(in_plane, testing::in_space),
                         [](const auto& info) { return testing::name_of_laid(info); });

// A rocket of 2 kg that spins at 3 rad/s, with a thrust of 5 N along its own x axis: x'' = 2.5 cos(3 t), y'' = 2.5
// sin(3 t).
TEST_P(FollowingForces, TurnWithTheirBody) {
  const MechanismStudy ran(rocket(GetParam(), 3.0));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const double w = 3.0, t = 2.0, a = 2.5;
  const double x = a / (w * w) * (1.0 - std::cos(w * t)), y = a / (w * w) * (w * t - std::sin(w * t));
  const auto& tilted = GetParam().tilted;
  const numerics::Vector3 place =
      GetParam().in_space ? tilted.origin + tilted.direction_of(x, y) : numerics::Vector3(x, y, 0.0);
  // Second order: (w h)^2/12 of a t^2/2, 1e-6 m.
  EXPECT_NEAR(ran.last("run", "position", "rocket.x"), place[0], 2e-6);
  EXPECT_NEAR(ran.last("run", "position", "rocket.y"), place[1], 2e-6);
  if (GetParam().in_space) {
    EXPECT_NEAR(ran.last("run", "position", "rocket.z"), place[2], 2e-6);
  }
  const double kinetic = ran.last("run.energy", "kinetic") - 0.5 * 0.4 * 9.0;
  EXPECT_NEAR(ran.last("run.energy", "load_work"), kinetic, 1e-6);
}

// At rest, at a point 0.2 m off the axis: the moment 1 N m whatever the angle, constant, for which the step is exact.
TEST_P(FollowingForces, TurnABodyByTheirLeverAtAPoint) {
  const MechanismStudy ran(rocket(GetParam(), 0.0, "following = true\nat = " + GetParam().point(0.7, -0.2) + "\n"));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  EXPECT_NEAR(ran.last("run", "angular_velocity", "rocket.rz"), 1.0 / 0.4 * 2.0, 1e-9);
  if (GetParam().in_space) {
    EXPECT_NEAR(ran.last("run", "angular_velocity", "rocket.rx"), 0.0, 1e-9);
  } else {
    EXPECT_NEAR(ran.last("run", "angle", "rocket.rz"), 0.5 * (1.0 / 0.4) * 4.0, 1e-9);
  }
}

TEST_P(FollowingForces, AreAskedForWhereAPointIsGiven) {
  EXPECT_THAT(testing::verdict(rocket(GetParam(), 0.0, "at = " + GetParam().point(0.7, -0.2) + "\n")),
              HasSubstr("\"at\" goes with following = true"));
}

}  // namespace
}  // namespace rubato
