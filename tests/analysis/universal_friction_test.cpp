#include <support/laid_studies.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

// A rotor on a universal joint at its centre, as sluggish about any axis: its energy is J (a'^2 + b'^2)/2 in the angles
// a and b of the two pins, and each pin rubs by itself.
namespace rubato {
namespace {

using ::testing::HasSubstr;
using testing::MechanismStudy;
using testing::replaced;
using testing::transient;
using testing::verdict;

constexpr double inertia = 0.02, limit = 0.2;  // mu N radius = 0.4 * 10 * 0.05
const std::string steps[] = {"0.005", "{ tolerance = 1e-6 }", "{ tolerance = 1e-6, controller = \"cardona_cassano\" }"};

std::string rotor(double about_first, double about_second, const std::string& load = "preload = 10.0") {
  return fmt::format(R"(
[[body]]
name = "rotor"
mass = 2.0
inertia = [0.02, 0.02, 0.02]
position = [0.0, 0.0, 0.0]
angular_velocity = [{}, {}, 0.0]
[[joint]]
name = "cross"
type = "universal"
between = ["ground", "rotor"]
at = [0.0, 0.0, 0.0]
axis = [1.0, 0.0, 0.0]
second_axis = [0.0, 1.0, 0.0]
friction = {{ coefficient = 0.4, {}, radius = 0.05 }}
)",
                     about_first, about_second, load);
}

std::string moment(const std::string& axis, const std::string& law) {
  return "[[force]]\non = \"rotor." + axis + "\"\nexpression = \"" + law + "\"\n";
}

/// The joint that an event is of.
std::string whose(const MechanismStudy& ran, std::size_t event) {
  const auto& of = ran.table("run.events");
  return of.layout.blocks[1].categories[static_cast<std::size_t>(of.rows.at(event)[1])];
}

/// The angle of the whole rotation.
double turned(const MechanismStudy& ran) {
  return std::hypot(ran.last("run", "angle", "rotor.rx"), ran.last("run", "angle", "rotor.ry"),
                    ran.last("run", "angle", "rotor.rz"));
}

// J a'' = -L until a' = 0, and b likewise, whatever the other does; alone after seven turns. Rotations about two axes
// are not exact: of the square of the step.
TEST(UniversalFriction, SpinsDownAboutEachPinByItself) {
  for (const std::string& step : steps)
    for (const auto& [first, second] : {std::pair{30.0, 0.0}, std::pair{0.0, -30.0}, std::pair{3.0, 2.0}}) {
      const bool both = first != 0.0 && second != 0.0;
      const double last = std::max(std::abs(first), std::abs(second)) * inertia / limit;
      const MechanismStudy ran(rotor(first, second) + transient(step, last + 0.1));
      ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
      ASSERT_EQ(ran.table("run.events").rows.size(), both ? 2u : 1u);
      EXPECT_EQ(whose(ran, 0), first != 0.0 && !both ? "cross.first" : "cross.second");
      if (both) {
        EXPECT_NEAR(ran.at(0, "run.events", "time"), std::abs(second) * inertia / limit, 1e-4);
      }
      EXPECT_NEAR(ran.at(both ? 1 : 0, "run.events", "time"), last, both ? 1e-4 : 1e-8);
      const double a = 0.5 * first * first * inertia / limit, b = 0.5 * second * second * inertia / limit;
      const double cosine = 0.5 * (std::cos(a) + std::cos(b) + std::cos(a) * std::cos(b) - 1.0);
      EXPECT_NEAR(std::cos(turned(ran)), cosine, 1e-4);
      EXPECT_NEAR(ran.last("run.energy", "friction_dissipated"), 0.5 * inertia * (first * first + second * second),
                  1e-5);
      EXPECT_NEAR(ran.last("run.energy", "residue"), 0.0, 1e-5);
      const auto against = [](double rate) { return rate > 0.0 ? -limit : rate < 0.0 ? limit : 0.0; };
      EXPECT_NEAR(ran.at(2, "run", "friction_moment", "cross.first"), against(first), 1e-9);
      EXPECT_NEAR(ran.at(2, "run", "friction_moment", "cross.second"), against(second), 1e-9);
    }
}

// Pressed by the weight of 20 N, mu N radius = 0.4 N m: each pin holds up to that, and the other holds on.
TEST(UniversalFriction, LetsGoOfThePinWhoseMomentReachesTheLimit) {
  const std::string weight = "[gravity]\nacceleration = [0.0, 0.0, -10.0]\n";
  for (const std::string& step : steps)
    for (const std::string axis : {"rx", "ry"}) {
      const std::string other = axis == "rx" ? "ry" : "rx";
      const MechanismStudy ran(rotor(0.0, 0.0, "normal_load = \"reaction\"") + weight + moment(axis, "0.5*t") +
                               moment(other, "0.39") + transient(step, 0.9));
      ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
      ASSERT_EQ(ran.table("run.events").rows.size(), 1u);
      EXPECT_NEAR(ran.at(0, "run.events", "time"), 0.8, 1e-8);
      EXPECT_EQ(whose(ran, 0), axis == "rx" ? "cross.first" : "cross.second");
      EXPECT_NEAR(ran.at(5, "run", "friction_moment", axis == "rx" ? "cross.second" : "cross.first"), -0.39, 1e-9);
      // J w' = 0.5 (t - 0.8)
      EXPECT_NEAR(ran.last("run", "angular_velocity", "rotor." + axis), 0.25 * 0.01 / inertia, 1e-5);
      EXPECT_NEAR(ran.last("run.energy", "residue"), 0.0, 1e-7);
    }
}

// Two shafts at an angle: in a turn each pin goes to and fro by twice that angle, and takes four times it times L.
TEST(UniversalFriction, OfABentShaftTakesEightTimesTheBendTimesTheLimitATurn) {
  const double bend = 0.3, c = std::cos(bend), s = std::sin(bend), turns = 2.0;
  const std::string shafts = fmt::format(R"(
[[body]]
name = "first"
mass = 1.0
inertia = [0.01, 0.01, 0.01]
position = [0.0, 0.0, -1.0]
angular_velocity = [0.0, 0.0, 6.283185307179586]
[[body]]
name = "second"
mass = 1.0
inertia = [0.01, 0.01, 0.001]
position = [0.0, {1}, {0}]
[[joint]]
name = "motor"
type = "revolute"
between = ["ground", "first"]
at = [0.0, 0.0, -1.0]
axis = [0.0, 0.0, 1.0]
drive = "2*pi*t"
[[joint]]
name = "bearing"
type = "revolute"
between = ["ground", "second"]
at = [0.0, {1}, {0}]
axis = [0.0, {1}, {0}]
[[joint]]
name = "cross"
type = "universal"
between = ["first", "second"]
at = [0.0, 0.0, 0.0]
axis = [1.0, 0.0, 0.0]
second_axis = [0.0, {0}, {2}]
friction = {{ coefficient = 0.4, preload = 10.0, radius = 0.05 }}
)",
                                         c, s, -s);
  for (const std::string& step : {std::string("0.002"), steps[1]}) {
    const MechanismStudy ran(shafts + transient(step, turns));
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    EXPECT_NEAR(ran.last("run.energy", "friction_dissipated"), 8.0 * bend * limit * turns, 1e-4);
    EXPECT_NEAR(ran.last("run.energy", "residue"), 0.0, 1e-3);
    EXPECT_NEAR(std::abs(ran.last("run", "friction_moment", "cross.first")), limit, 1e-9);
  }
}

TEST(UniversalFrictionFault, AsksForTheRadiusOfThePins) {
  EXPECT_THAT(verdict(replaced(rotor(1.0, 0.0) + transient("0.01", 1.0), ", radius = 0.05", "")),
              HasSubstr("joint \"cross\": friction lacks the key \"radius\", of the pin [m]"));
}

}  // namespace
}  // namespace rubato
