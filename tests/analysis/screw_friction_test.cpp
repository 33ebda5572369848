#include <support/laid_studies.hpp>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

// A nut of mass m, and of moment of inertia J about the axis, on a square thread of lead l and mean diameter d. The
// load F on the nut takes the moments of Budynas and Nisbett (2015), equations 8-1 and 8-2, with mu = f:
//   to raise   F d/2 (l + pi f d)/(pi d - f l) = F d/2 tan(a + b)      tan(a) = l/(pi d), tan(b) = f
//   to lower   F d/2 (pi f d - l)/(pi d + f l) = F d/2 tan(b - a)
// In motion F = m (g + s''), s'' = l/(2 pi) angle'':
//   angle'' = (M - m g d/2 tan(a +- b))/(J + m l/(2 pi) d/2 tan(a +- b))    + while it rises, - while it sinks
// which is constant: the step is exact for it, and what is left is Newton's tolerance, 1e-10 of the size of the model,
// and the resolution of events, 1e-12 of the run.
namespace rubato {
namespace {

using std::numbers::pi;
using ::testing::HasSubstr;
using testing::MechanismStudy;
using testing::replaced;
using testing::verdict;

constexpr double gravity = 9.81, mass = 2.0, inertia = 0.001, diameter = 0.04, weight = mass * gravity;

struct Thread {
  double lead, friction;
  double way() const { return lead / (2.0 * pi); }  // a radian
  double raising() const {
    return weight * diameter / 2.0 * (lead + pi * friction * diameter) / (pi * diameter - friction * lead);
  }
  double lowering() const {
    return weight * diameter / 2.0 * (pi * friction * diameter - lead) / (pi * diameter + friction * lead);
  }
  /// Of the angle, upwards and downwards, under a moment.
  double rising(double moment) const { return (moment - raising()) / (inertia + way() * raising() / gravity); }
  double sinking(double moment) const { return (moment + lowering()) / (inertia - way() * lowering() / gravity); }
};

/// @param spin  at the start [rad/s]
std::string nut(const Thread& thread, double spin, const std::string& moment,
                const std::string& load = "normal_load = \"reaction\"") {
  return fmt::format(R"(
[[body]]
name = "nut"
mass = {}
inertia = [0.002, 0.002, {}]
position = [0.0, 0.0, 0.0]
velocity = [0.0, 0.0, {:.17g}]
angular_velocity = [0.0, 0.0, {}]
[[joint]]
name = "thread"
type = "screw"
between = ["ground", "nut"]
at = [0.0, 0.0, 0.0]
axis = [0.0, 0.0, 1.0]
lead = {}
friction = {{ coefficient = {}, {}, radius = {} }}
[[force]]
on = "nut.rz"
expression = "{}"
[gravity]
acceleration = [0.0, 0.0, -9.81]
[[analysis]]
name = "run"
type = "transient"
step = 0.01
duration = 1.0
)",
                     mass, inertia, spin * thread.way(), spin, thread.lead, thread.friction, load, diameter / 2.0,
                     moment);
}

const Thread locking{0.01, 0.12};  // tan(a) = 0.0796
const Thread steep{0.03, 0.12};    // tan(a) = 0.239

TEST(ScrewFriction, HoldsANutWhoseLeadAngleIsBelowTheAngleOfFriction) {
  const MechanismStudy ran(nut(locking, 0.0, "0"));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  EXPECT_NEAR(ran.last("run", "angle", "thread"), 0.0, 1e-12);
  // What friction does in a radian is what the weight would do.
  EXPECT_NEAR(ran.last("run", "friction_moment", "thread"), weight * locking.way(), 1e-10);
  // The flanks carry W cos(a) across themselves, of which cos(a) is along the axis.
  const double slope = locking.lead / (pi * diameter);
  EXPECT_NEAR(ran.last("run", "reaction_z", "thread"), weight / (1.0 + slope * slope), 1e-8);
}

TEST(ScrewFriction, LetsANutRunDownASteeperThread) {
  for (const Thread& thread : {steep, Thread{locking.lead, 0.079}}) {
    const MechanismStudy ran(nut(thread, 0.0, "0"));
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    const double angle = 0.5 * thread.sinking(0.0);
    EXPECT_LT(angle, -0.05);
    EXPECT_NEAR(ran.last("run", "angle", "thread"), angle, 1e-9 * std::abs(angle));
    EXPECT_NEAR(ran.last("run", "displacement", "thread"), thread.way() * angle, 1e-9 * std::abs(angle));
    EXPECT_NEAR(ran.last("run.energy", "residue"), 0.0, 1e-8);
  }
}

TEST(ScrewFriction, TakesTheMomentsOfAPowerScrewToRaiseAndToLower) {
  for (const double lead : {locking.lead, -locking.lead}) {  // right-handed and left-handed
    const double up = lead > 0.0 ? 1.0 : -1.0;
    const double limits[] = {locking.raising(), locking.lowering()}, signs[] = {up, -up};
    for (int i = 0; i < 2; ++i) {
      std::string text = nut(locking, 0.0, fmt::format("{}*t", signs[i] * 0.2));
      text = replaced(text, "lead = 0.01", fmt::format("lead = {}", lead));
      const MechanismStudy ran(text);
      ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
      ASSERT_EQ(ran.table("run.events").rows.size(), 1u);
      EXPECT_NEAR(ran.at(0, "run.events", "time"), limits[i] / 0.2, 1e-9) << lead << (i == 0 ? " up" : " down");
      EXPECT_GT(ran.last("run", "displacement", "thread") * (i == 0 ? 1.0 : -1.0), 0.0);
    }
  }
}

// More than three turns up, and then the thread holds.
TEST(ScrewFriction, StopsANutThatWasSpunUp) {
  const MechanismStudy ran(nut(locking, 60.0, "0"));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const double slowing = -locking.rising(0.0), stop = 60.0 / slowing, angle = 0.5 * 60.0 * stop;
  EXPECT_GT(angle, 6.0 * pi);
  ASSERT_EQ(ran.table("run.events").rows.size(), 1u);
  EXPECT_NEAR(ran.at(0, "run.events", "time"), stop, 1e-9);
  EXPECT_NEAR(ran.last("run", "angle", "thread"), angle, 1e-8);
  const double kinetic = 0.5 * (inertia + mass * locking.way() * locking.way()) * 3600.0;
  EXPECT_NEAR(ran.last("run.energy", "friction_dissipated"), kinetic - weight * locking.way() * angle, 1e-8);
  EXPECT_NEAR(ran.last("run.energy", "residue"), 0.0, 1e-8);
}

// A preload P along the axis presses the flanks with P/cos(a), and what they rub in a radian is d/(2 cos(a)).
TEST(ScrewFriction, OfAPreloadDoesNotAskForTheLoad) {
  const double slope = steep.lead / (pi * diameter);
  const double moment = 0.12 * 8.0 * diameter / 2.0 * (1.0 + slope * slope);
  const double all = inertia + mass * steep.way() * steep.way();
  const MechanismStudy ran(nut(steep, 10.0, "0", "preload = 8.0"));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const double up = (moment + weight * steep.way()) / all, down = (weight * steep.way() - moment) / all;
  const double top = 10.0 / up, rest = 1.0 - top;
  EXPECT_GT(down, 1.0);
  EXPECT_TRUE(ran.table("run.events").rows.empty());  // it turns back at once
  EXPECT_NEAR(ran.last("run", "angle", "thread"), 0.5 * 10.0 * top - 0.5 * down * rest * rest, 1e-8);
  EXPECT_NEAR(ran.last("run", "friction_moment", "thread"), moment, 1e-9);
}

// A jack: the shaft turns in a bearing, the nut is guided. Both hold the same four motions as the thread, which are
// redundant; what the thread carries is determined. Turned backwards the shaft lifts.
TEST(ScrewFriction, OfAJackIsDeterminedWhereItsGuidesAreNot) {
  const double moment = 0.12;
  const MechanismStudy ran(R"(
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
[[force]]
on = "shaft.rz"
expression = "-0.12"
[gravity]
acceleration = [0.0, 0.0, -9.81]
[[analysis]]
name = "run"
type = "transient"
step = 0.01
duration = 1.0
)");
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const double angle = 0.5 * locking.rising(moment);
  EXPECT_GT(angle, 4.0 * pi);
  EXPECT_NEAR(ran.last("run", "angle", "bearing"), -angle, 1e-8 * angle);
  EXPECT_NEAR(ran.last("run", "displacement", "guide"), locking.way() * angle, 1e-8);
  const double lifted = weight * locking.way() * angle;
  EXPECT_NEAR(ran.last("run.energy", "friction_dissipated"),
              moment * angle - lifted - ran.last("run.energy", "kinetic"), 1e-8);
}

TEST(ScrewFrictionFault, AsksForTheRadiusOfTheThread) {
  const std::string text = nut(locking, 0.0, "0");
  EXPECT_THAT(
      verdict(replaced(text, ", radius = 0.02", "")),
      HasSubstr("joint \"thread\": friction lacks the key \"radius\", of the thread in the middle of its flanks "
                "[m]: the moment is coefficient * load * radius / cos^2 of the lead angle"));
  EXPECT_THAT(verdict(replaced(text, "radius = 0.02", "radius = 0.0")), HasSubstr("friction: radius must be positive"));
}

// Friction of a ball would be a vector of three freedoms.
TEST(ScrewFrictionFault, SaysHowABallIsBuiltOfJointsThatRub) {
  const std::string text = replaced(nut(locking, 0.0, "0"), "lead = 0.01\n", "");
  const auto says = [&](const std::string& of, const std::string& type, const std::string& instead) {
    EXPECT_THAT(
        verdict(replaced(of, "\"screw\"", "\"" + type + "\"")),
        HasSubstr(
            "\"friction\" belongs to a revolute, prismatic, cylindrical, universal, planar, screw or strut joint, and "
            "this one is " +
            type + "; " + instead));
  };
  const std::string row = " in a row, with small bodies between them, each with its own friction";
  const std::string no_axis = replaced(text, "axis = [0.0, 0.0, 1.0]\n", "");
  says(no_axis, "spherical", "take three revolute joints" + row);
  says(no_axis, "rigid", "nothing moves in it that could rub");
}

}  // namespace
}  // namespace rubato
