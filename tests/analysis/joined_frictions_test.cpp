#include <support/laid_steps.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

// Several dry joints on one freedom. What each of them carries at rest nothing tells but this: they hold together until
// the pull exceeds the sum of their limits. The rotor, I = 0.1 kg m2, turns in hinges "a" and "b" on one axis, with
// limits of 0.5*20*0.1 = 1 N m and 0.5*60*0.1 = 3 N m.
namespace rubato {
namespace {

using std::numbers::pi;
using testing::Laid;
using testing::MechanismStudy;
using testing::transient;

constexpr double inertia = 0.1, weak = 1.0, strong = 3.0, all = weak + strong;

std::string rotor(const Laid& laid, double spin, const std::string& moment) {
  const std::string turns = laid.in_space ? fmt::format("[0.0, 0.0, {}]", spin) : fmt::format("{}", spin);
  const std::string about = laid.in_space ? "following = true\n" : "";
  std::string text =
      "[[body]]\nname = \"rotor\"\n" + laid.body(inertia, 0.0, 0.0) + "angular_velocity = " + turns + "\n";
  for (const auto& [name, preload] : {std::pair{"a", 20.0}, std::pair{"b", 60.0}})
    text += fmt::format("[[joint]]\nname = \"{}\"\ntype = \"revolute\"\nbetween = [\"ground\", \"rotor\"]\nat = {}\n{}",
                        name, laid.point(0.0, 0.0), laid.hinge_axis()) +
            fmt::format("friction = {{ coefficient = 0.5, preload = {}, radius = 0.1 }}\n", preload);
  return text + "[[force]]\non = \"rotor.rz\"\nexpression = \"" + moment + "\"\n" + about;
}

constexpr int kinds_of_steps = 3;
std::string step_of(int kind) { return testing::step_of_kind(kind, "0.01", "1e-4"); }

class JoinedFrictions : public testing::LaidWithSteps {
 public:
  static std::string run(double duration) { return LaidWithSteps::run(duration, "0.01", "1e-4"); }
};
INSTANTIATE_TEST_SUITE_P(Laid, JoinedFrictions, JoinedFrictions::all_of_them(), JoinedFrictions::name);

/// A run with an event a step does not end, or has tens of thousands of rows.
void expect_few_steps(const MechanismStudy& ran) {
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  EXPECT_LT(ran.table("run").rows.size(), 4000u);
}

// (31 rad/s, 4 N m of friction, 2.5 N m that drive it on): constant accelerations, for which the step is exact. What is
// left is Newton's tolerance, 1e-10 of the size, and the resolution of events, 1e-12 of the run.
TEST_P(JoinedFrictions, StopARotorTogetherAndHoldIt) {
  const double slowing = (all - 2.5) / inertia, stop = 31.0 / slowing, angle = 0.5 * 31.0 * stop;
  const MechanismStudy ran(rotor(laid(), 31.0, "2.5") + run(4.0));
  expect_few_steps(ran);
  ASSERT_EQ(ran.table("run.events").rows.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(ran.at(i, "run.events", "time"), stop, 1e-9);
  EXPECT_NEAR(ran.last("run", "angle", "a"), angle, 1e-8);
  EXPECT_NEAR(ran.last("run", "angle", "b"), angle, 1e-8);
  EXPECT_NEAR(ran.last("run.energy", "friction_dissipated"), all * angle, 1e-7);
  EXPECT_NEAR(ran.last("run.energy", "residue"), 0.0, 1e-7);
  // Half of the pull is more than the weaker of them can hold.
  EXPECT_NEAR(ran.last("run", "friction_moment", "a"), -weak, 1e-9);
  EXPECT_NEAR(ran.last("run", "friction_moment", "b"), weak - 2.5, 1e-9);
}

TEST_P(JoinedFrictions, HoldWhateverIsLessThanTheSumOfTheirLimits) {
  const MechanismStudy ran(rotor(laid(), 0.0, "3.99*sin(4*t)") + run(4.0));
  expect_few_steps(ran);
  EXPECT_TRUE(ran.table("run.events").rows.empty());
  EXPECT_NEAR(ran.last("run", "angle", "a"), 0.0, 1e-12);
  // What follows an event within a millionth of a step, 0.08 s at most, is found a step later: at 16 N m/s.
  const double passed = 2.0 * 1e-6 * 0.08 * 16.0;
  const auto& table = ran.table("run");
  for (const auto& row : table.rows) {
    const double a = row[table.column("friction_moment", "a")], b = row[table.column("friction_moment", "b")];
    EXPECT_NEAR(a + b, -3.99 * std::sin(4.0 * row[0]), 1e-8);
    EXPECT_LE(std::abs(a) - weak, passed);
    EXPECT_LE(std::abs(b) - strong, passed);
  }
}

TEST_P(JoinedFrictions, LetGoTogetherAtTheSumOfTheirLimits) {
  const MechanismStudy ran(rotor(laid(), 0.0, "3*t") + run(2.0));
  expect_few_steps(ran);
  ASSERT_EQ(ran.table("run.events").rows.size(), 2u);
  // The moment is linear in time, as the interpolated guard is: what is left is what the matrix's share E, 1e-10,
  // leaves of multipliers that repeat each other.
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(ran.at(i, "run.events", "time"), all / 3.0, 1e-8);
  const double since = 2.0 - all / 3.0, angle = 3.0 / inertia * since * since * since / 6.0;
  // The equal steps of 0.01 s err by beta h^2 times the acceleration at the end.
  EXPECT_NEAR(ran.last("run", "angle", "a"), angle, 1e-4 * 3.0 / inertia * since);
}

// 5 sin(3 t) exceeds 4 at sin(3 t) = 0.8; it moves until 5/3 (cos(3 t1) - cos(3 t2)) = 4 (t2 - t1).
TEST_P(JoinedFrictions, GoToAndFroUnderALoadThatExceedsTheirSumForAWhile) {
  const double start = std::asin(0.8) / 3.0;
  double stop = start + 0.7;
  for (int i = 0; i < 50; ++i)
    stop -= (5.0 / 3.0 * (std::cos(3.0 * start) - std::cos(3.0 * stop)) - all * (stop - start)) /
            (5.0 * std::sin(3.0 * stop) - all);
  const MechanismStudy ran(rotor(laid(), 0.0, "5*sin(3*t)") + run(4.0));
  expect_few_steps(ran);
  const auto& events = ran.table("run.events");
  ASSERT_EQ(events.rows.size(), 14u);
  // Steps of 0.01 s err by h^2/12 of the load's second derivative, over its excess of 1 at most: 4e-4 s; the others
  // less.
  for (std::size_t i = 0; i < events.rows.size(); ++i) {
    const double half = std::floor(static_cast<double>(i) / 4.0) * pi / 3.0;
    EXPECT_NEAR(events.rows[i][0], half + (i % 4 < 2 ? start : stop), 4e-4) << i;
  }
  EXPECT_NEAR(ran.last("run.energy", "residue"), 0.0, 1e-3 * ran.last("run.energy", "friction_dissipated"));
}

// Two guides side by side: the block of 2 kg slides in both, with limits of 2 N and 5 N.
TEST_P(JoinedFrictions, OfTwoGuidesSideBySideStopABlock) {
  std::string text = testing::block_in_guide(laid(), 0.3, "friction = { coefficient = 0.2, preload = 10.0 }", 2.0);
  text += "[[joint]]\nname = \"other\"\ntype = \"prismatic\"\nbetween = [\"ground\", \"block\"]\nat = " +
          laid().point(-0.1 * std::sin(0.3), 0.1 * std::cos(0.3)) +
          "\naxis = " + laid().direction(std::cos(0.3), std::sin(0.3)) +
          "\nfriction = { coefficient = 0.5, preload = 10.0 }\n";
  const MechanismStudy ran(text + laid().gravity() + run(1.5));
  expect_few_steps(ran);
  const double pull = 2.0 * 9.81 * std::sin(0.3), slowing = (7.0 + pull) / 2.0;  // 5.8 N
  ASSERT_EQ(ran.table("run.events").rows.size(), 2u);
  EXPECT_NEAR(ran.at(0, "run.events", "time"), 2.0 / slowing, 1e-9);
  EXPECT_NEAR(ran.last("run", "displacement", "guide"), 2.0 / slowing, 1e-9);
  EXPECT_NEAR(ran.last("run", "friction_force", "guide") + ran.last("run", "friction_force", "other"), pull, 1e-8);
}

// A jack: a weight W on a nut that is guided, of lead l; its thread rubs with the load that it carries, the bearing of
// its shaft with 0.06 N m. Turned backwards the shaft lifts (screw_friction_test.cpp), against the sum of both.
struct Jack {
  static constexpr double lead = 0.01, diameter = 0.04, friction = 0.12, bearing = 0.06, weight = 2.0 * 9.81;
  static constexpr double lifting =
      weight * diameter / 2.0 * (lead + pi * friction * diameter) / (pi * diameter - friction * lead);
  static constexpr double lowering =
      weight * diameter / 2.0 * (pi * friction * diameter - lead) / (pi * diameter + friction * lead);
  static std::string text(const std::string& moment) {
    return R"(
[[body]]
name = "shaft"
mass = 1.0
inertia = [0.002, 0.002, 0.001]
position = [0.0, 0.0, 0.0]
[[body]]
name = "nut"
mass = 2.0
inertia = [0.002, 0.002, 0.002]
position = [0.0, 0.0, 0.0]
[[joint]]
name = "bearing"
type = "revolute"
between = ["ground", "shaft"]
at = [0.0, 0.0, -0.1]
axis = [0.0, 0.0, 1.0]
friction = { coefficient = 0.1, preload = 20.0, radius = 0.03 }
[[joint]]
name = "guide"
type = "prismatic"
between = ["ground", "nut"]
at = [0.2, 0.0, 0.0]
axis = [0.0, 0.0, 1.0]
[[joint]]
name = "thread"
type = "screw"
between = ["shaft", "nut"]
at = [0.0, 0.0, 0.0]
axis = [0.0, 0.0, 1.0]
lead = 0.01
friction = { coefficient = 0.12, normal_load = "reaction", radius = 0.02 }
[gravity]
acceleration = [0.0, 0.0, -9.81]
[[force]]
on = "shaft.rz"
expression = ")" +
           moment + "\"\n";
  }
};

TEST(JoinedFrictionsOfAJack, HoldItUntilTheMomentExceedsThatOfThreadAndBearing) {
  const double limits[] = {Jack::lifting + Jack::bearing, Jack::lowering + Jack::bearing}, signs[] = {-1.0, 1.0};
  for (int kind = 0; kind < kinds_of_steps; ++kind)
    for (int i = 0; i < 2; ++i) {
      const std::string step = step_of(kind);
      const MechanismStudy ran(Jack::text(fmt::format("{}*t", signs[i] * 0.1)) +
                               transient(step, 1.2 * limits[i] / 0.1));
      expect_few_steps(ran);
      ASSERT_EQ(ran.table("run.events").rows.size(), 2u) << step;
      for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(ran.at(k, "run.events", "time"), limits[i] / 0.1, 1e-7) << step;
      EXPECT_GT(-signs[i] * ran.last("run", "displacement", "guide"), 1e-5);
      EXPECT_NEAR(ran.last("run.energy", "residue"), 0.0, 1e-5);
    }
}

// Lifted by -0.24 N m for 0.1 s; then both slow it down, and hold the weight. The moment of the thread follows its
// load, W (1 + s''/g): angle'' = (M - T - B)/(J + m l/(2 pi) T/W ...), as in screw_friction_test.cpp.
TEST(JoinedFrictionsOfAJack, StopItWhereTheMomentEndsAndHoldTheWeight) {
  constexpr double way = Jack::lead / (2.0 * pi), moment = 0.24;
  const double sees = 0.001 + way * Jack::lifting / 9.81;
  const double rising = (moment - Jack::lifting - Jack::bearing) / sees;
  const double slowing = (Jack::lifting + Jack::bearing) / sees;
  ASSERT_GT(rising, 1.0);
  const double stop = 0.1 * (1.0 + rising / slowing), angle = 0.005 * rising * (1.0 + rising / slowing);
  for (int kind = 0; kind < kinds_of_steps; ++kind) {
    const std::string step = step_of(kind);
    const MechanismStudy ran(Jack::text(fmt::format("t < 0.1 ? -{} : 0", moment)) + transient(step, 0.5));
    expect_few_steps(ran);
    ASSERT_EQ(ran.table("run.events").rows.size(), 2u) << step;
    for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(ran.at(k, "run.events", "time"), stop, 1e-8) << step;
    EXPECT_NEAR(ran.last("run", "angle", "bearing"), -angle, 1e-8 * angle) << step;
    EXPECT_NEAR(ran.last("run", "displacement", "guide"), way * angle, 1e-8) << step;
    EXPECT_NEAR(ran.last("run.energy", "residue"), 0.0, 1e-7) << step;
  }
}

}  // namespace
}  // namespace rubato
