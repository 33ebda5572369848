#include <support/laid_studies.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>

namespace rubato {
namespace {

using testing::bar_on_pin;
using testing::block_in_guide;
using ::testing::HasSubstr;
using testing::in_plane;
using testing::Laid;
using testing::MechanismStudy;
using testing::replaced;
using testing::transient;
using testing::verdict;

constexpr double gravity = 9.81;

/// In the plane, and in a tilted plane of space.
class JointFriction : public ::testing::TestWithParam<Laid> {};
INSTANTIATE_TEST_SUITE_P(Laid, JointFriction, ::testing::Values(in_plane, testing::in_space),
                         [](const auto& info) { return testing::name_of_laid(info); });

/// On an incline of 0.3 rad.
std::string incline(const Laid& laid, double coefficient, double velocity) {
  return block_in_guide(laid, 0.3,
                        fmt::format("friction = {{ coefficient = {}, normal_load = \"reaction\" }}", coefficient),
                        velocity) +
         laid.gravity() + transient("{ tolerance = 1e-4 }", 1.5);
}

// Accelerations are constant between the events, and the step is exact for them: what is left is Newton's tolerance,
// 1e-10 of the size of the model, and the resolution of events, 1e-12 of the run.
TEST_P(JointFriction, StopsABlockOnAnInclineWhereCoulombSays) {
  const MechanismStudy ran(incline(GetParam(), 0.5, 2.0));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const double slowing = gravity * (std::sin(0.3) + 0.5 * std::cos(0.3));
  const double distance = 2.0 * 2.0 / (2.0 * slowing);
  EXPECT_NEAR(ran.last("run", "displacement", "guide"), distance, 1e-9);
  const auto& events = ran.table("run.events");
  ASSERT_EQ(events.rows.size(), 1u);
  EXPECT_NEAR(events.rows[0][0], 2.0 / slowing, 1e-9);
  EXPECT_EQ(events.layout.blocks[2].categories[static_cast<std::size_t>(events.rows[0][2])], "sticks");
  EXPECT_NEAR(ran.last("run.energy", "friction_dissipated"), 0.5 * 2.0 * gravity * std::cos(0.3) * distance, 1e-8);
  EXPECT_NEAR(ran.last("run.energy", "residue"), 0.0, 1e-8);
  // At rest friction holds what gravity pulls, upwards.
  EXPECT_NEAR(ran.last("run", "friction_force", "guide"), 2.0 * gravity * std::sin(0.3), 1e-9);
}

TEST_P(JointFriction, LetsTheBlockSlideBackOnASteepIncline) {
  const MechanismStudy ran(incline(GetParam(), 0.2, 2.0));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const double slowing = gravity * (std::sin(0.3) + 0.2 * std::cos(0.3));
  const double back = gravity * (std::sin(0.3) - 0.2 * std::cos(0.3));
  const double stop = 2.0 / slowing, rest = 1.5 - stop;
  EXPECT_NEAR(ran.last("run", "displacement", "guide"), 2.0 / slowing - 0.5 * back * rest * rest, 1e-8);
  EXPECT_NEAR(ran.last("run.energy", "residue"), 0.0, 1e-8);
}

TEST_P(JointFriction, HoldsABlockThatStartsAtRestAndLetsASteeperOneGo) {
  const MechanismStudy ran(incline(GetParam(), 0.32, 0.0));  // tan(0.3) = 0.309
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  EXPECT_NEAR(ran.last("run", "displacement", "guide"), 0.0, 1e-12);
  const MechanismStudy slips(incline(GetParam(), 0.3, 0.0));
  const double down = gravity * (std::sin(0.3) - 0.3 * std::cos(0.3));
  EXPECT_NEAR(slips.last("run", "displacement", "guide"), -0.5 * down * 1.5 * 1.5, 1e-8);
}

TEST(JointFrictionInThePlane, LetsGoWhenTheLoadReachesTheLimit) {
  const MechanismStudy ran(block_in_guide(in_plane, 0.0, "friction = { coefficient = 0.5, preload = 2.0 }") +
                           "[[force]]\non = \"block.x\"\nexpression = \"2*t\"\n" +
                           transient("{ tolerance = 1e-4 }", 1.5));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const auto& events = ran.table("run.events");
  ASSERT_EQ(events.rows.size(), 1u);
  EXPECT_NEAR(events.rows[0][0], 0.5, 1e-9);  // 2 t = 0.5*2
  // 2 x'' = 2 (t - 0.5) from there: x = (t - 0.5)^3/6. Steps of the tolerance 1e-4 of a response of 0.17 m.
  EXPECT_NEAR(ran.last("run", "displacement", "guide"), 1.0 / 6.0, 1e-4);
}

// A bar of 0.6 kg m2 about its pin on a spring of 30 N m/rad, with a moment of friction of 0.25*8*0.3 = 0.6 N m: the
// amplitude loses 2*0.6/30 rad each half turn, whose time is pi sqrt(0.6/30), whatever the amplitude.
std::string torsion(const Laid& laid) {
  return bar_on_pin(laid,
                    "angle = 0.25\nstiffness = 30.0\nrest = 0.0\n"
                    "friction = { coefficient = 0.25, preload = 8.0, radius = 0.3 }") +
         transient("{ tolerance = 1e-6 }", 4.0);
}

// A force that exceeds the limit of 5 N by 2 % for 33 ms, or by 0.1 % for 7 ms: while nothing moves steps are of 80 ms.
TEST(JointFrictionInThePlane, LetsGoWhereTheLoadExceedsTheLimitBetweenTwoSteps) {
  for (const double amplitude : {5.1, 5.005})
    for (const char* step : {"{ tolerance = 1e-4 }", "{ tolerance = 1e-4, controller = \"cardona_cassano\" }"}) {
      const MechanismStudy ran(block_in_guide(in_plane, 0.0, "friction = { coefficient = 0.5, preload = 10.0 }") +
                               fmt::format("[[force]]\non = \"block.x\"\nexpression = \"{}*sin(12*t)\"\n", amplitude) +
                               transient(step, 4.0));
      const auto& events = ran.table("run.events");
      ASSERT_EQ(events.rows.size(), 30u) << step;  // 15 half waves, each lets go and holds again
      for (std::size_t i = 0; i < events.rows.size(); i += 2) {
        const double half_waves = static_cast<double>(i / 2) * std::numbers::pi;
        EXPECT_NEAR(events.rows[i][0], (std::asin(5.0 / amplitude) + half_waves) / 12.0, 1e-5);
      }
    }
}

// It comes to rest where the table of a load has a row, give or take the last digits: what lies between is no step.
TEST(JointFrictionInThePlane, StopsWhereALoadHasAKink) {
  const auto file = std::filesystem::path(::testing::TempDir()) / "kink.csv";
  for (const double speed : {0.7, 1.0, 1.3, 1.9, 2.3}) {
    const double stop = speed / 2.5,
                 ways[] = {stop, std::nextafter(stop, 2.0), stop * (1.0 + 1e-14), stop * (1.0 - 1e-14)};
    for (const double kink : ways)
      for (const char* step : {"0.01", "{ tolerance = 1e-5 }"}) {
        std::ofstream(file) << fmt::format("0, 0\n{:.17g}, 0\n{:.17g}, 8\n3, 8\n", kink, kink + 1.0);
        const MechanismStudy ran(
            block_in_guide(in_plane, 0.0, "friction = { coefficient = 0.5, preload = 10.0 }", speed) +
            "[[force]]\non = \"block.x\"\ntable = \"" + file.string() + "\"\n" + transient(step, 2.0));
        ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
        ASSERT_EQ(ran.table("run.events").rows.size(), 2u) << speed;
        EXPECT_NEAR(ran.at(0, "run.events", "time"), stop,
                    1e-7);  // within a millionth of a step it is met a step later
        EXPECT_NEAR(ran.at(1, "run.events", "time"), stop + 0.625, 1e-9);  // 8 N/s reach 5 N
      }
  }
}

TEST_P(JointFriction, TakesTheSameAmplitudeFromEveryHalfSwing) {
  const MechanismStudy ran(torsion(GetParam()));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const auto& events = ran.table("run.events");
  // 0.25, -0.21, ... after each half swing 0.04 less: 0.01 at the sixth, within the band of 0.02 where it stays.
  ASSERT_EQ(events.rows.size(), 1u);
  const double half = std::numbers::pi * std::sqrt(0.6 / 30.0);
  EXPECT_NEAR(events.rows[0][0], 6.0 * half, 2e-5);
  EXPECT_NEAR(ran.last("run", "angle", "pin"), 0.01, 1e-5);
  EXPECT_NEAR(ran.last("run.energy", "friction_dissipated"), 0.5 * 30.0 * (0.25 * 0.25 - 0.01 * 0.01), 1e-5);
  EXPECT_NEAR(ran.last("run.energy", "residue"), 0.0, 1e-4);
}

// m g l (cos(first) - cos(start)) = M (start + first): what the first swing of a pendulum loses, exact for any angle.
TEST_P(JointFriction, StopsAPendulumInTheBandWhereFrictionHoldsIt) {
  const MechanismStudy ran(bar_on_pin(GetParam(),
                                      "angle = \"pi/2\"\n"  // from the vertical
                                      "friction = { coefficient = 0.25, preload = 8.0, radius = 0.3 }") +
                           GetParam().gravity() + transient("{ tolerance = 1e-6 }", 12.0));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const double moment = 2.0 * gravity * 0.5, friction = 0.6, start = std::acos(0.0);
  double first = start;
  for (int i = 0; i < 50; ++i)
    first -= (moment * (std::cos(first) - std::cos(start)) - friction * (start + first)) /
             (-moment * std::sin(first) - friction);
  const auto& table = ran.table("run");
  double lowest = 0.0;
  for (const auto& row : table.rows) lowest = std::min(lowest, row[table.column("angle", "pin")]);
  EXPECT_NEAR(lowest, -first, 1e-4);
  const double last = ran.last("run", "angle", "pin");
  EXPECT_LE(std::abs(moment * std::sin(last)), friction);
  EXPECT_NEAR(ran.last("run", "angular_velocity", "pin"), 0.0, 1e-9);
  EXPECT_NEAR(ran.last("run.energy", "residue"), 0.0, 2e-4 * moment);
}

TEST(JointFrictionInThePlane, IsTheCoefficientTimesTheReactionOfTheSameInstant) {
  std::string text = replaced(torsion(in_plane), "preload = 8.0", "normal_load = \"reaction\"");
  text = replaced(text, "duration = 4", "duration = 1");
  text = replaced(text, "[[analysis]]", in_plane.gravity() + "[[analysis]]");
  const MechanismStudy ran(text);
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const auto& table = ran.table("run");
  std::size_t slides = 0;
  for (const auto& row : table.rows) {
    const double x = row[table.column("reaction_x", "pin")], y = row[table.column("reaction_y", "pin")];
    const double limit = 0.25 * 0.3 * std::hypot(x, y), force = row[table.column("friction_moment", "pin")];
    const double rate = row[table.column("angular_velocity", "pin")];
    if (std::abs(rate) > 1e-6) {
      ++slides;
      EXPECT_NEAR(force, rate > 0.0 ? -limit : limit, 1e-9 * limit);
    } else {
      EXPECT_LE(std::abs(force), limit * (1.0 + 1e-8));
    }
  }
  EXPECT_GT(slides, table.rows.size() / 2);
  EXPECT_NEAR(ran.last("run.energy", "residue"), 0.0, 1e-4);
  EXPECT_GT(ran.last("run.energy", "friction_dissipated"), 0.1);
}

// A bar of J = 0.6 kg m2 that spins freely on a dry pin, whose reaction is m r sqrt(w^4 + a^2): with k = mu R m r/J =
// 0.125 its acceleration is a = -c w^2, c = k/sqrt(1 - k^2), and it turns by ln(1 + c w0 t)/c.
double error_of_a_spun_bar(double step, const std::string& more) {
  const double k = 0.125, c = k / std::sqrt(1.0 - k * k), speed = 6.0, duration = 1.0;
  const std::string bar =
      bar_on_pin(in_plane, "friction = { coefficient = 0.25, normal_load = \"reaction\", radius = 0.3 }");
  const MechanismStudy ran(replaced(bar, "mass = 2.0", "velocity = [0.0, 3.0]\nangular_velocity = 6.0\nmass = 2.0") +
                           more + transient(fmt::format("{}", step), duration) + "project_velocities = true");
  EXPECT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  return ran.last("run", "angle", "pin") - std::log1p(c * speed * duration) / c;
}

TEST(JointFrictionInThePlane, ThatFollowsAReactionIsOfSecondOrderWithProjectedVelocities) {
  const double coarse = error_of_a_spun_bar(0.02, ""), middle = error_of_a_spun_bar(0.01, "");
  const double fine = error_of_a_spun_bar(0.005, "");
  EXPECT_LT(std::abs(coarse), 0.01);
  EXPECT_NEAR(coarse / middle, 4.0, 0.25);  // h^3: a tenth of it beside h^2 in the longest step
  EXPECT_NEAR(middle / fine, 4.0, 0.25);
}

// Between two kinks of a load lies a step of a nanosecond, whose accelerations are made of round-off: it had stopped
// the bar.
TEST(JointFrictionInThePlane, ThatFollowsAReactionGoesThroughAVeryShortStep) {
  const auto file = std::filesystem::path(::testing::TempDir()) / "two_kinks.csv";
  std::ofstream(file) << "0, 0\n0.5023, 0\n0.502300001, 1e-15\n2, 1e-15\n";
  const std::string force = "[[force]]\non = \"bar.rz\"\ntable = \"" + file.string() + "\"\n";
  EXPECT_NEAR(error_of_a_spun_bar(0.005, force), 0.0, 1e-3);
}

// A law that pushes against the motion with more than friction holds at rest: neither sticking nor sliding is left.
TEST(JointFrictionInThePlane, NamesTheJointThatChangesWithoutEnd) {
  for (const char* step : {"{ tolerance = 1e-4 }", "0.01"}) {
    const MechanismStudy ran(
        block_in_guide(in_plane, 0.0,
                       "friction = { coefficient = 0.5, preload = 2.0 }\nforce = \"rate > 0 ? -4 : 4\"") +
        in_plane.gravity() + transient(step, 1.5));
    EXPECT_EQ(ran.report.status, analysis::RunStatus::failed);
    EXPECT_THAT(ran.report.message, HasSubstr("the friction of \"guide\" changed a hundred times, and nothing moved"));
  }
}

TEST(JointFrictionFault, NamesTheKeyAndTheRemedy) {
  const auto says = [](const std::string& piece, const std::string& other, const std::string& expected) {
    EXPECT_THAT(verdict(replaced(torsion(in_plane), piece, other)), HasSubstr(expected));
  };
  says("coefficient = 0.25", "coefficient = -0.25", "friction: coefficient must not be negative, got -0.25");
  says("preload = 8.0", "preload = -8.0", "friction: preload must not be negative");
  says("preload = 8.0, ", "", "needs either \"preload\" [N] or normal_load = \"reaction\"");
  says(", radius = 0.3", "", "lacks the key \"radius\"");
  says("radius = 0.3", "radius = 0.0", "friction: radius must be positive");
  says("angle = 0.25", "drive = \"0.25 + t\"\nangle = 0.25", "has a drive and friction");
}

}  // namespace
}  // namespace rubato
