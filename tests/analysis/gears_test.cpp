#include <support/laid_studies.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

// Ratios between the coordinates of joints.
namespace rubato {
namespace {

using std::numbers::pi;
using ::testing::HasSubstr;
using testing::in_plane;
using testing::Laid;
using testing::MechanismStudy;
using testing::transient;
using testing::verdict;

class Gears : public ::testing::TestWithParam<Laid> {};
INSTANTIATE_TEST_SUITE_P(Laid, Gears, ::testing::Values(testing::in_plane, testing::in_space),
                         testing::name_of_laid<::testing::TestParamInfo<Laid>>);

void expect_done(const MechanismStudy& ran) {
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
}

/// A wheel of 2 kg on a shaft through its centre.
std::string wheel(const Laid& laid, const std::string& name, double inertia, double x, const std::string& keys,
                  const std::string& on = "ground") {
  return "[[body]]\nname = \"" + name + "\"\n" + laid.body(inertia, x, 0.0) + "[[joint]]\nname = \"" + name +
         "_shaft\"\ntype = \"revolute\"\nbetween = [\"" + on + "\", \"" + name + "\"]\nat = " + laid.point(x, 0.0) +
         "\n" + laid.hinge_axis() + keys + "\n";
}

std::string gear(const std::string& first, const std::string& second, double ratio, const std::string& name = "teeth") {
  return fmt::format("[[gear]]\nname = \"{}\"\njoints = [\"{}\", \"{}\"]\nratio = {}\n", name, first, second, ratio);
}

const double ratio = -2.3, small = 0.13, large = 1.7;

std::string pair(const Laid& laid, const std::string& keys, const std::string& other_keys = "") {
  return wheel(laid, "small", small, 0.0, keys) + wheel(laid, "large", large, 0.8, other_keys) +
         gear("small_shaft", "large_shaft", ratio);
}

// The moment on the small wheel turns the inertia J1 + J2/r^2, through many turns. The teeth take what the small wheel
// does not need.
TEST_P(Gears, ReduceTheInertiaOfAFlywheel) {
  for (const char* step : {"0.01", "{ tolerance = 1e-4 }"}) {
    const MechanismStudy ran(pair(GetParam(), "moment = \"4\"\nangle = 0.3") + transient(step, 6.0));
    expect_done(ran);
    EXPECT_TRUE(ran.report.warnings.empty());
    const double acceleration = 4.0 / (small + large / (ratio * ratio));
    const double angle = 0.5 * acceleration * 36.0;
    EXPECT_NEAR(ran.last("run", "angle", "small_shaft"), 0.3 + angle, 1e-7 * angle);
    EXPECT_NEAR(ran.last("run", "angle", "large_shaft"), angle / ratio, 1e-7 * angle);
    EXPECT_NEAR(ran.last("run", "reaction_gear_moment", "teeth"), small * acceleration - 4.0, 1e-7);
    EXPECT_NEAR(ran.last("run.energy", "kinetic"), 4.0 * angle, 1e-6 * angle);
  }
}

TEST_P(Gears, PassMomentsOnInStaticsAndModes) {
  const std::string study = pair(GetParam(), "moment = \"4\"", "stiffness = 30.0") +
                            "[[analysis]]\nname = \"rest\"\ntype = \"static\"\n" +
                            "[[analysis]]\nname = \"modes\"\ntype = \"modes\"\n";
  const MechanismStudy rest(study), modes(study, 1);
  expect_done(rest);
  expect_done(modes);
  EXPECT_NEAR(rest.at(0, "rest", "angle", "large_shaft"), ratio * 4.0 / 30.0, 1e-9);
  EXPECT_NEAR(rest.at(0, "rest", "angle", "small_shaft"), ratio * ratio * 4.0 / 30.0, 1e-9);
  EXPECT_NEAR(rest.at(0, "rest", "reaction_gear_moment", "teeth"), -4.0, 1e-9);
  EXPECT_NEAR(modes.at(0, "modes", "frequency"), std::sqrt(30.0 / (ratio * ratio * small + large)) / (2.0 * pi), 1e-9);
}

// A rack of 2 kg that a pinion of 0.25 m drives down its guide.
TEST_P(Gears, MoveARackByAPinion) {
  const Laid& laid = GetParam();
  const double radius = 0.25;
  const MechanismStudy ran(testing::block_in_guide(laid, 0.3, "displacement = 0.1") +
                           wheel(laid, "pinion", 0.05, 3.0, "angle = -0.2") + gear("guide", "pinion_shaft", radius) +
                           laid.gravity() + transient("0.01", 2.0));
  expect_done(ran);
  const double acceleration = -2.0 * 9.81 * std::sin(0.3) / (2.0 + 0.05 / (radius * radius));
  EXPECT_NEAR(ran.last("run", "displacement", "guide"), 0.1 + 2.0 * acceleration, 1e-7);
  EXPECT_NEAR(ran.last("run", "angle", "pinion_shaft"), -0.2 + 2.0 * acceleration / radius, 1e-6);
  EXPECT_NEAR(ran.last("run", "reaction_gear_force", "teeth"), 2.0 * acceleration + 2.0 * 9.81 * std::sin(0.3), 1e-7);
}

// A planet that rolls about a sun which stands: its spin is (1 + rs/rp) times that of the carrier.
TEST_P(Gears, RollAPlanetAboutItsSun) {
  const Laid& laid = GetParam();
  const double teeth = 3.0;  // rs/rp
  const MechanismStudy ran(wheel(laid, "carrier", 0.4, 0.0, "moment = \"2.5\"") +
                           wheel(laid, "planet", 0.2, 0.7, "", "carrier") +
                           gear("planet_shaft", "carrier_shaft", teeth) + transient("0.002", 3.0));
  expect_done(ran);
  const double inertia = 0.4 + 2.0 * 0.49 + 0.2 * (1.0 + teeth) * (1.0 + teeth);
  const double angle = 0.5 * 2.5 / inertia * 9.0;
  EXPECT_NEAR(ran.last("run", "angle", "carrier_shaft"), angle, 2e-6 * angle);
  EXPECT_NEAR(ran.last("run", "angle", "planet_shaft"), teeth * angle, 2e-6 * teeth * angle);
}

TEST_P(Gears, FollowADrive) {
  const MechanismStudy ran(pair(GetParam(), "", "drive = \"0.5*t^2\"") + transient("0.01", 2.0));
  expect_done(ran);
  EXPECT_NEAR(ran.last("run", "angle", "small_shaft"), ratio * 2.0, 1e-9);
  EXPECT_NEAR(ran.last("run", "drive_moment", "large_shaft"), large + ratio * ratio * small, 1e-8);
}

TEST_P(Gears, StopTogether) {
  const MechanismStudy ran(pair(GetParam(), "rate = 3.0", "lock = { at = -0.5, kind = \"stop\" }") +
                           transient("0.01", 1.0));
  expect_done(ran);
  EXPECT_TRUE(ran.report.warnings.empty());
  const double inertia = small + large / (ratio * ratio);
  EXPECT_NEAR(ran.at(0, "run.events", "time"), 0.5 * -ratio / 3.0, 1e-9);
  EXPECT_NEAR(ran.at(0, "run.events", "energy_lost"), 0.5 * inertia * 9.0, 1e-9);
}

TEST(GearFault, NamesWhatItCannotJoin) {
  const auto said = [](const std::string& more, const std::string& keys = "", const std::string& other = "") {
    return verdict(pair(in_plane, keys, other) + more + transient("0.01", 0.1));
  };
  EXPECT_THAT(said("", "drive = \"t\"", "drive = \"-t\""),
              HasSubstr("gear \"teeth\" joins two joints that are driven, \"small_shaft\" and \"large_shaft\""));
  EXPECT_THAT(
      said("", "drive = \"t\"", "lock = { at = 1.0, kind = \"stop\" }"),
      HasSubstr("gear \"teeth\" joins \"small_shaft\", which is driven, with \"large_shaft\", which has a lock"));
  EXPECT_THAT(said(gear("small_shaft", "largeshaft", 2.0, "more")),
              HasSubstr("gear \"more\" joins \"largeshaft\", which is no joint; did you mean \"large_shaft\"?"));
  EXPECT_THAT(said(gear("small_shaft", "small_shaft", 2.0, "more")), HasSubstr("with itself"));
  EXPECT_THAT(said(gear("small_shaft", "large_shaft", 0.0, "more")), HasSubstr("a ratio of 0"));
  EXPECT_THAT(said(gear("small_shaft", "large_shaft", 1.0)), HasSubstr("has the name of a joint or another gear"));
}

TEST(GearFault, TellsAGearThatSaysWhatAnotherSays) {
  const MechanismStudy ran(pair(in_plane, "moment = \"1\"") + gear("large_shaft", "small_shaft", 1.0 / ratio, "twin") +
                           transient("0.01", 0.1));
  expect_done(ran);
  ASSERT_EQ(ran.report.warnings.size(), 1u);
  EXPECT_THAT(ran.report.warnings.front(), HasSubstr("gear_moment\" repeats what other joints say"));
}

}  // namespace
}  // namespace rubato
