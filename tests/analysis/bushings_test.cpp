#include <support/laid_studies.hpp>

#include <rubato/numerics/rotations.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include <cmath>
#include <numbers>
#include <string>

// Elastic mounts between two bodies, or one and the ground.
namespace rubato {
namespace {

using numerics::Matrix3;
using numerics::Vector3;
using std::numbers::pi;
using ::testing::HasSubstr;
using testing::in_space;
using testing::Laid;
using testing::MechanismStudy;
using testing::transient;
using testing::verdict;

void expect_done(const MechanismStudy& ran) {
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
}

std::string text(const Vector3& v) { return fmt::format("[{:.17g}, {:.17g}, {:.17g}]", v[0], v[1], v[2]); }

// Six modes of a body on a bushing that lies askew beside its centre of mass: with the displacement x + theta x r of
// its point, in the axes of the bushing, those of M and T^T K T.
TEST(BushingsInSpace, CarryABodyWithItsSixModes) {
  const double mass = 3.7;
  const Vector3 inertia(0.4, 0.9, 0.7), at(0.2, -0.3, 0.15), turn(0.6, -0.4, 1.1), body_turn(-0.3, 0.2, 0.8);
  const Eigen::Matrix<double, 6, 1> stiffness =
      (Eigen::Matrix<double, 6, 1>() << 2e3, 5e3, 9e2, 70.0, 40.0, 55.0).finished();
  const MechanismStudy ran(
      fmt::format("[[body]]\nname = \"engine\"\nmass = {}\ninertia = {}\nposition = [1.0, 2.0, 3.0]\nrotation = {}\n"
                  "[[bushing]]\nname = \"mount\"\nbetween = [\"ground\", \"engine\"]\nat = {}\nrotation = {}\n"
                  "stiffness = [2e3, 5e3, 9e2, 70.0, 40.0, 55.0]\n[[analysis]]\nname = \"modes\"\ntype = \"modes\"\n",
                  mass, text(inertia), text(body_turn), text(Vector3(1.0, 2.0, 3.0) + at), text(turn)));
  expect_done(ran);
  const Matrix3 axes = numerics::rotation_of(turn).toRotationMatrix();
  const Matrix3 own = numerics::rotation_of(body_turn).toRotationMatrix();
  Eigen::Matrix<double, 6, 6> t = Eigen::Matrix<double, 6, 6>::Zero(), m = t;
  t.topLeftCorner<3, 3>() = t.bottomRightCorner<3, 3>() = axes.transpose();
  t.topRightCorner<3, 3>() = -axes.transpose() * numerics::skew(at);
  m.topLeftCorner<3, 3>() = mass * Matrix3::Identity();
  m.bottomRightCorner<3, 3>() = own * inertia.asDiagonal() * own.transpose();
  const Eigen::Matrix<double, 6, 6> k = t.transpose() * stiffness.asDiagonal() * t;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> modes(k, m);
  ASSERT_EQ(ran.table("modes").rows.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) {
    const double frequency = std::sqrt(modes.eigenvalues()[static_cast<Eigen::Index>(i)]) / (2.0 * pi);
    EXPECT_NEAR(ran.at(i, "modes", "frequency"), frequency, 1e-9 * frequency) << i;
  }
}

// A force and a moment on the engine: what the mount gives is what they are, and u = F/k along its axes.
TEST(BushingsInSpace, YieldToAForceAlongTheirAxes) {
  const Vector3 turn(0.6, -0.4, 1.1);
  const Matrix3 axes = numerics::rotation_of(turn).toRotationMatrix();
  const Vector3 force(30.0, -50.0, 20.0);
  std::string study = fmt::format(
      "[[body]]\nname = \"engine\"\nmass = 2.0\ninertia = [0.4, 0.9, 0.7]\nposition = [0.0, 0.0, 0.0]\n"
      "[[bushing]]\nname = \"mount\"\nbetween = [\"ground\", \"engine\"]\nat = [0.0, 0.0, 0.0]\nrotation = {}\n"
      "stiffness = [2e3, 5e3, 9e2, 70.0, 40.0, 55.0]\n",
      text(turn));
  for (const char* axis : {"x", "y", "z"})
    study += fmt::format("[[force]]\non = \"engine.{}\"\nexpression = \"{}\"\n", axis, force[axis[0] - 'x']);
  const MechanismStudy ran(study + "[[analysis]]\nname = \"rest\"\ntype = \"static\"\n");
  expect_done(ran);
  const Vector3 own = axes.transpose() * force;
  const Vector3 moved = axes * Vector3(own[0] / 2e3, own[1] / 5e3, own[2] / 9e2);
  for (const std::string axis : {"x", "y", "z"}) {
    const auto i = static_cast<Eigen::Index>(axis[0] - 'x');
    EXPECT_NEAR(ran.at(0, "rest", "position", "engine." + axis), moved[i], 1e-10);
    EXPECT_NEAR(ran.at(0, "rest", "force_" + axis, "mount"), -own[i], 1e-7);
  }
}

// Two bodies on a mount fly and tumble: nothing is lost, and a damper takes what is missing.
TEST(BushingsInSpace, KeepMomentaAndEnergyOfAFreeFlight) {
  const auto flight = [](const std::string& damping) {
    return "[[body]]\nname = \"one\"\nmass = 3.0\ninertia = [0.3, 0.4, 0.5]\nposition = [0.0, 0.0, 0.0]\n"
           "velocity = [0.1, -0.2, 0.05]\nangular_velocity = [1.3, -0.7, 2.5]\n"
           "[[body]]\nname = \"two\"\nmass = 2.0\ninertia = [0.2, 0.25, 0.15]\nposition = [0.8, 0.3, -0.2]\n"
           "velocity = [0.3, 0.4, 0.5]\nangular_velocity = [-1.0, 0.7, 1.5]\n"
           "[[bushing]]\nname = \"mount\"\nbetween = [\"one\", \"two\"]\nat = [0.5, 0.1, 0.0]\n"
           "stiffness = [300.0, 200.0, 250.0, 20.0, 30.0, 25.0]\n" +
           damping + transient("0.0005", 2.0);
  };
  const MechanismStudy free(flight("")), damped(flight("damping = [3.0, 2.0, 1.0, 0.3, 0.2, 0.1]\n"));
  expect_done(free);
  expect_done(damped);
  const double start = free.at(0, "run.energy", "kinetic");
  EXPECT_NEAR(free.last("run.energy", "kinetic") + free.last("run.energy", "strain"), start, 1e-5 * start);
  EXPECT_GT(damped.last("run.energy", "damper_dissipated"), 0.1 * start);
  EXPECT_NEAR(damped.last("run.energy", "residue"), 0.0, 1e-5 * start);
}

class BushingsAcross : public ::testing::TestWithParam<Laid> {};
INSTANTIATE_TEST_SUITE_P(Laid, BushingsAcross, ::testing::Values(testing::in_plane, testing::in_space),
                         testing::name_of_laid<::testing::TestParamInfo<Laid>>);

/// A mount whose x points along (cos 0.4, sin 0.4) of the plane.
std::string mount(const Laid& laid, const std::string& first, const std::string& second, double x, double y,
                  const std::string& stiffness, const std::string& damping) {
  const double c = std::cos(0.4), s = std::sin(0.4);
  const std::string frame =
      laid.in_space ? "rotation = " + laid.tilted.rotation(0.4) : "axis = " + laid.direction(c, s);
  const std::string zeros = laid.in_space ? "0.0, 0.0, 0.0, " : "";
  return "[[bushing]]\nname = \"mount\"\nbetween = [\"" + first + "\", \"" + second + "\"]\nat = " + laid.point(x, y) +
         "\n" + frame + "\nstiffness = [" + stiffness.substr(0, stiffness.rfind(' ')) + " " + zeros +
         stiffness.substr(stiffness.rfind(' ') + 1) + "]\ndamping = [" + damping.substr(0, damping.rfind(' ')) + " " +
         zeros + damping.substr(damping.rfind(' ') + 1) + "]\n";
}

// Along the x of the mount, with damping: s = exp(-d t) (cos w t + d/w sin w t) s0.
TEST_P(BushingsAcross, LetABodySwingAlongTheirAxis) {
  const Laid& laid = GetParam();
  const double c = std::cos(0.4), s = std::sin(0.4), speed = 0.6, mass = 2.0, stiffness = 180.0, damping = 4.0;
  const MechanismStudy ran(
      "[[body]]\nname = \"block\"\n" + laid.body(0.1, 0.0, 0.0) + "velocity = " + laid.direction(speed * c, speed * s) +
      "\n" + mount(laid, "ground", "block", 0.0, 0.0, "180.0, 900.0, 7.0", "4.0, 1.0, 0.2") + transient("0.0005", 0.5));
  expect_done(ran);
  const double decay = damping / (2.0 * mass), frequency = std::sqrt(stiffness / mass - decay * decay), t = 0.5;
  const double way = speed / frequency * std::exp(-decay * t) * std::sin(frequency * t);
  const double rate =
      speed * std::exp(-decay * t) * (std::cos(frequency * t) - decay / frequency * std::sin(frequency * t));
  EXPECT_NEAR(ran.last("run", "force_x", "mount"), -stiffness * way - damping * rate, 1e-3);
  EXPECT_NEAR(ran.last("run", "force_y", "mount"), 0.0, 1e-9);
  EXPECT_NEAR(ran.last("run.energy", "strain"), 0.5 * stiffness * way * way, 1e-4);
}

// On a pin the mount's moment alone acts: that of a spring and a damper of the pin, through large turns.
TEST_P(BushingsAcross, TurnAsTheSpringOfAPin) {
  const Laid& laid = GetParam();
  const MechanismStudy by_mount(testing::bar_on_pin(laid, "rate = 9.0") +
                                mount(laid, "ground", "bar", 0.0, 0.0, "0.0, 0.0, 8.0", "0.0, 0.0, 0.3") +
                                laid.gravity() + transient("0.002", 1.0));
  const MechanismStudy by_spring(testing::bar_on_pin(laid, "rate = 9.0\nstiffness = 8.0\ndamping = 0.3") +
                                 laid.gravity() + transient("0.002", 1.0));
  expect_done(by_mount);
  expect_done(by_spring);
  double most = 0.0;
  for (std::size_t row = 0; row < by_spring.table("run").rows.size(); row += 25) {
    const double angle = by_spring.at(row, "run", "angle", "pin");
    most = std::max(most, std::abs(angle));
    EXPECT_NEAR(by_mount.at(row, "run", "angle", "pin"), angle, 1e-8);
    EXPECT_NEAR(by_mount.at(row, "run", laid.in_space ? "moment_z" : "moment", "mount"),
                by_spring.at(row, "run", "law_moment", "pin"), 1e-6);
  }
  EXPECT_GT(most, 1.5);
}

TEST(BushingFault, NamesWhatItLacks) {
  const auto said = [](const std::string& keys) {
    return verdict(
        "[[body]]\nname = \"block\"\nmass = 1.0\ninertia = 1.0\nposition = [0.0, 0.0]\n[[bushing]]\nname = "
        "\"mount\"\nbetween = [\"ground\", \"block\"]\nat = [0.0, 0.0]\n" +
        keys + transient("0.01", 0.1));
  };
  EXPECT_THAT(
      said("stiffness = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]\n"),
      HasSubstr("bushing \"mount\": stiffness takes three numbers in the plane: along x and y, and about z, got 6"));
  EXPECT_THAT(said("stiffness = [1.0, -2.0, 3.0]\n"), HasSubstr("must not be negative"));
  EXPECT_THAT(said("stiffness = [0.0, 0.0, 0.0]\n"), HasSubstr("does nothing"));
  EXPECT_THAT(said("stiffness = [1.0, 2.0, 3.0]\nrotation = [0.0, 0.0, 1.0]\n"),
              HasSubstr("rotation is for bushings in space"));
  EXPECT_THAT(said("damping = [1.0, 2.0, 3.0]\n"), HasSubstr("stiffness"));
}

// Beyond 3 rad a rotation vector would jump soon: the run ends there, and says so.
TEST(BushingFault, EndsWhereItsPartsHaveTurnedTooFar) {
  const MechanismStudy ran(
      "[[body]]\nname = \"block\"\nmass = 1.0\ninertia = [1.0, 1.0, 1.0]\nposition = [0.0, 0.0, "
      "0.0]\nangular_velocity = [5.0, 0.0, 0.0]\n[[bushing]]\nname = \"mount\"\nbetween = "
      "[\"ground\", \"block\"]\nat = [0.0, 0.0, 0.0]\nstiffness = [1.0, 1.0, 1.0, 0.1, 0.1, 0.1]\n" +
      transient("0.01", 2.0));
  EXPECT_EQ(ran.report.status, analysis::RunStatus::failed);
  EXPECT_THAT(ran.report.message, HasSubstr("\"mount\", whose parts have turned by more than 3 rad"));
}

}  // namespace
}  // namespace rubato
