#include <support/mechanism_study.hpp>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

// What a mechanism does may not depend on the units in which it is written.
namespace rubato {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using testing::MechanismStudy;

// Lengths of nanometres and times of months: turns by a share of the extent in metres were below round-off, and a body
// that nothing presses then seemed to go away from its equilibrium.
TEST(MechanismUnits, OfNanometresLeaveAnEquilibriumStable) {
  const MechanismStudy ran(R"(
[[body]]
name = "free"
position = [-1e-8, -1e-8, 0.0]
mass = 0.07
inertia = [1e-17, 2e-17, 1.5e-17]
[[body]]
name = "held"
position = [3e-8, 1.6e-8, -1.6e-8]
mass = 0.3
inertia = [6e-17, 6e-17, 5e-17]
[[joint]]
type = "universal"
between = ["ground", "free"]
at = [-1.3e-8, -0.6e-8, 0.4e-8]
axis = [0.0, 1.0, 0.0]
second_axis = [1.0, 0.0, 0.0]
[[joint]]
name = "hinge"
type = "revolute"
between = ["ground", "held"]
at = [1.5e-8, 0.2e-8, -1.5e-8]
axis = [-0.35, -0.8, 0.48]
stiffness = 4.6e-30
rest = 0.4
[[joint]]
name = "jack"
type = "strut"
between = ["held", "ground"]
at = [3e-8, 0.0, -3e-8]
to = [2e-8, -1.2e-8, 0.0]
drive = "3.3823069050575527e-08 + 0*t"
[[force]]
on = "held.x"
expression = "6.6e-23"
[[analysis]]
name = "rest"
type = "static"
)");
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  EXPECT_THAT(ran.report.statistics, Contains(std::pair<std::string, std::string>("stable", "yes")));
  // Nothing moves, and the hinge's spring is as it was written.
  EXPECT_NEAR(ran.last("rest", "angle", "hinge"), 0.0, 1e-12);
  EXPECT_NEAR(ran.last("rest", "law_moment", "hinge"), 4.6e-30 * 0.4, 1e-12 * 4.6e-30);
}

// A body on a plane under gravity across it and along it: of the plane's reaction, which passes by the centre of mass,
// round-off leaves a stiffness, whose modes were shown as motions of their own.
TEST(MechanismUnits, OfHundredsOfMetresLeaveThePlaneWithoutStiffness) {
  const MechanismStudy ran(R"(
[gravity]
acceleration = [696.0541569827, -908.8617893846, 877.7270767835]
[[body]]
name = "body"
position = [-119.6241947029, -222.6776689461, 274.8192390354]
mass = 0.6027010519589
inertia = [7498.296418117, 7310.859623854, 4185.790248872]
rotation = [0.4438163396874, -1.568101828718, -1.86322962218]
[[joint]]
type = "planar"
between = ["ground", "body"]
at = [-8.986759750342, -121.9959326602, 117.0276538549]
axis = [-1.0, 0.0, 0.0]
[[spring]]
between = ["ground", "body.x"]
stiffness = 4.746860464513
[[analysis]]
name = "given"
type = "modes"
about = "given"
)");
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  ASSERT_EQ(ran.table("given").rows.size(), 3u);
  for (std::size_t row = 0; row < 3; ++row) EXPECT_EQ(ran.at(row, "given", "angular_frequency"), 0.0) << row;
}

/// Eigenvalues of a sleeve on a skew axis with a spring and a dashpot to the ground, in seconds.
std::vector<double> of_a_sleeve(double meter) {
  const auto point = [meter](double x, double y, double z) {
    return fmt::format("[{:.17g}, {:.17g}, {:.17g}]", x * meter, y * meter, z * meter);
  };
  const MechanismStudy ran(fmt::format(R"(
[[body]]
name = "sleeve"
position = {}
mass = 1.5
inertia = {}
[[joint]]
type = "cylindrical"
between = ["sleeve", "ground"]
at = {}
axis = [2.5, -0.17, 0.04]
[[joint]]
name = "spring"
type = "strut"
between = ["sleeve", "ground"]
at = {}
to = {}
stiffness = 3.0
[[joint]]
name = "dashpot"
type = "strut"
between = ["sleeve", "ground"]
at = {}
to = {}
damping = 0.2
[[analysis]]
name = "modes"
type = "modes"
)",
                                       point(0.57, 0.49, -0.34), point(0.1 * meter, 0.09 * meter, 0.12 * meter),
                                       point(0.07, 0.45, -0.23), point(0.85, 0.81, -0.19), point(-0.12, 0.1, -0.32),
                                       point(0.7, 0.23, -0.38), point(0.37, 0.27, 0.21)));
  std::vector<double> values;
  for (std::size_t row = 0; row < ran.table("modes").rows.size(); ++row)
    for (const char* part : {"eigenvalue_real", "eigenvalue_imaginary"}) values.push_back(ran.at(row, "modes", part));
  return values;
}

// Constraints leave motions that mix lengths and angles: orthonormal in metres and radians, those of a part of
// nanometres were lost beside its turns, and its modes were wrong without a word.
TEST(MechanismUnits, OfNanometresHaveTheModesOfMetres) {
  const auto large = of_a_sleeve(1.0), small = of_a_sleeve(1e-8);
  ASSERT_EQ(large.size(), 4u);
  ASSERT_EQ(small.size(), large.size());
  for (std::size_t i = 0; i < large.size(); ++i) EXPECT_NEAR(small[i], large[i], 1e-7) << i;
}

}  // namespace
}  // namespace rubato
