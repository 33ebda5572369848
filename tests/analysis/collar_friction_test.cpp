#include <support/laid_studies.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

// A collar of mass m and moment of inertia J on a rod of radius r along z: friction mu N = 4 N against the slip
// u = (v, r omega) of their surfaces, the force -4 v/|u| and the moment -4 r (r omega)/|u|.
namespace rubato {
namespace {

using ::testing::HasSubstr;
using testing::MechanismStudy;
using testing::replaced;
using testing::transient;
using testing::verdict;

constexpr double mass = 2.0, radius = 0.05, limit = 4.0;
const std::string steps[] = {"0.01", "{ tolerance = 1e-5 }", "{ tolerance = 1e-5, controller = \"cardona_cassano\" }"};

struct Collar {
  double inertia = mass * radius * radius;  // as sluggish around the rod as along it
  double v = 0.0, spin = 0.0;
  std::string load = "preload = 10.0";
  double mass = rubato::mass;

  std::string text(const std::string& on = "ground") const {
    return fmt::format(R"(
[[body]]
name = "collar"
mass = {}
inertia = [{}, {}, {}]
position = [0.0, 0.0, 0.0]
velocity = [0.0, 0.0, {}]
angular_velocity = [0.0, 0.0, {}]
[[joint]]
name = "rod"
type = "cylindrical"
between = ["{}", "collar"]
at = [0.0, 0.0, 0.0]
axis = [0.0, 0.0, 1.0]
friction = {{ coefficient = 0.4, {}, radius = {} }}
)",
                       mass, 0.7 * inertia, 0.7 * inertia, inertia, v, spin, on, load, radius);
  }
};

std::string force(const std::string& coordinate, const std::string& law) {
  return "[[force]]\non = \"collar." + coordinate + "\"\nexpression = \"" + law + "\"\n";
}

/// |u| in a row.
double slip_in(const MechanismStudy& ran, std::size_t row) {
  return std::hypot(ran.at(row, "run", "velocity", "collar.z"), radius * ran.at(row, "run", "angular_velocity", "rod"));
}

// Where m = J/r^2 the slip keeps its direction and loses 4 N/m a second, whatever that is: steps are exact, and what is
// left is Newton's tolerance, 1e-10 of the size, and the resolution of events, 1e-12 of the run.
TEST(CollarFriction, StopsAHelicalSlipInAStraightLineOnTheRod) {
  for (const std::string load : {"preload = 10.0", "normal_load = \"reaction\""})
    for (const std::string& step : steps) {
      Collar collar{.v = 0.3, .spin = 0.4 / radius, .load = load};
      const MechanismStudy ran(collar.text() + force("x", "6") + force("y", "8") + transient(step, 0.5));
      ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
      const double stop = 0.5 / (limit / mass), way = 0.5 * 0.5 * stop;
      ASSERT_EQ(ran.table("run.events").rows.size(), 1u);
      EXPECT_NEAR(ran.at(0, "run.events", "time"), stop, 1e-8);
      EXPECT_NEAR(ran.last("run", "displacement", "rod"), 0.6 * way, 1e-9);
      EXPECT_NEAR(ran.last("run", "angle", "rod"), 0.8 * way / radius, 1e-8);
      EXPECT_NEAR(ran.at(5, "run", "friction_force", "rod"), -0.6 * limit, 1e-8);
      EXPECT_NEAR(ran.at(5, "run", "friction_moment", "rod"), -0.8 * limit * radius, 1e-8);
      EXPECT_NEAR(ran.last("run.energy", "friction_dissipated"), 0.5 * mass * 0.25, 1e-8);
      EXPECT_NEAR(ran.last("run.energy", "residue"), 0.0, 1e-8);
    }
}

// Of another inertia the direction turns; friction takes 4 N |u| dt, which the trapezoidal rule over the rows takes to
// the square of the step: of 0.7 J to 1e-3.
TEST(CollarFriction, TakesTheLimitTimesTheSlipOfASlipThatTurns) {
  for (const std::string& step : steps) {
    Collar collar{.inertia = 0.02, .v = 0.3, .spin = 8.0};
    const MechanismStudy ran(collar.text() + transient(step, 1.5));
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    const double kinetic = 0.5 * mass * 0.09 + 0.5 * 0.02 * 64.0;
    EXPECT_NEAR(ran.last("run.energy", "friction_dissipated"), kinetic, 1e-5);
    EXPECT_NEAR(ran.last("run.energy", "residue"), 0.0, 1e-5);
    double work = 0.0;
    for (std::size_t i = 1; i < ran.table("run").rows.size(); ++i)
      work += limit * 0.5 * (slip_in(ran, i - 1) + slip_in(ran, i)) *
              (ran.at(i, "run", "time") - ran.at(i - 1, "run", "time"));
    EXPECT_NEAR(work, kinetic, 1e-3);
    EXPECT_EQ(ran.table("run.events").rows.size(), 1u);
    EXPECT_EQ(ran.last("run", "angular_acceleration", "rod"), 0.0);
  }
}

// 2 N along the rod and 0.3 t N m around it: 4 = hypot(2, 6 t) at t = sqrt(12)/6.
TEST(CollarFriction, LetsGoWherePullAndMomentTogetherReachTheLimit) {
  for (const std::string& step : steps) {
    const MechanismStudy ran(Collar{.inertia = 0.02}.text() + force("z", "2") + force("rz", "0.3*t") +
                             transient(step, 1.0));
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    ASSERT_EQ(ran.table("run.events").rows.size(), 1u);
    EXPECT_NEAR(ran.at(0, "run.events", "time"), std::sqrt(12.0) / 6.0, 1e-8);
    EXPECT_NEAR(ran.at(10, "run", "friction_force", "rod"), -2.0, 1e-9);
    EXPECT_NEAR(ran.last("run", "friction_force", "rod"),
                -limit * ran.last("run", "velocity", "collar.z") / slip_in(ran, ran.table("run").rows.size() - 1),
                1e-6);
    EXPECT_NEAR(ran.last("run.energy", "residue"), 0.0, 1e-6);
  }
}

// A rod at 0.3 rad, pressed by the weight across it: m g hypot(sin, k t/(m g)) = 0.4 m g cos. Seen from the rod gravity
// is tilted.
TEST(CollarFriction, OfATiltedRodFollowsTheWeightAcrossIt) {
  const double across = 9.81 * std::cos(0.3), along = 9.81 * std::sin(0.3);
  const MechanismStudy ran(Collar{.load = "normal_load = \"reaction\""}.text() + force("rz", "0.5*t") +
                           fmt::format("[gravity]\nacceleration = [{:.17g}, 0.0, {:.17g}]\n", -across, -along) +
                           transient(steps[1], 1.0));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  ASSERT_EQ(ran.table("run.events").rows.size(), 1u);
  const double around = mass * std::sqrt(0.16 * across * across - along * along);
  EXPECT_NEAR(ran.at(0, "run.events", "time"), around * radius / 0.5, 1e-8);
  EXPECT_LT(ran.last("run", "displacement", "rod"), -1e-3);
}

// Under a constant load a motion from rest is straight: m v = (F - 4 v/|u|) t, and likewise around the rod.
TEST(CollarFriction, GoesStraightFromRestUnderALoadThatJumps) {
  for (const std::string& step : steps) {
    const MechanismStudy ran(Collar{.inertia = 0.02}.text() + force("z", "t < 0.105 ? 2 : 4") +
                             force("rz", "t < 0.105 ? 0.05 : 0.3") + transient(step, 1.0));
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    const double v = ran.last("run", "velocity", "collar.z"), spin = ran.last("run", "angular_velocity", "rod");
    const double slip = std::hypot(v, radius * spin), since = 1.0 - 0.105;
    EXPECT_GT(v, 0.1);
    EXPECT_NEAR(mass * v, (4.0 - limit * v / slip) * since, 1e-8);
    EXPECT_NEAR(0.02 * spin, (0.3 - limit * radius * radius * spin / slip) * since, 1e-8);
    EXPECT_NEAR(ran.last("run", "displacement", "rod"), 0.5 * v * since, 1e-8);
  }
}

// A shaft that turns frees what friction holds on it: a weight F < mu N, kept from turning, creeps down at the v at
// which mu N v/|u| = F. Its time constant is a thirteenth of a second: exp(-26) is left of what it was.
TEST(CollarFriction, LetsAWeightCreepDownATurningShaft) {
  const double spin = 20.0, weight = 2.0;
  const std::string shaft = R"(
[[body]]
name = "shaft"
mass = 1.0
inertia = [0.001, 0.001, 0.001]
position = [0.0, 0.0, 0.0]
angular_velocity = [0.0, 0.0, 20.0]
[[joint]]
name = "motor"
type = "revolute"
between = ["ground", "shaft"]
at = [0.0, 0.0, 0.0]
axis = [0.0, 0.0, 1.0]
drive = "20*t"
[[joint]]
name = "guide"
type = "prismatic"
between = ["ground", "collar"]
at = [0.0, 0.0, 0.0]
axis = [0.0, 0.0, 1.0]
[gravity]
acceleration = [0.0, 0.0, -10.0]
)";
  for (const std::string& step : steps) {
    const MechanismStudy ran(Collar{.inertia = 0.001, .mass = 0.2}.text("shaft") + shaft + transient(step, 2.0));
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    const double creep = spin * radius * weight / std::sqrt(limit * limit - weight * weight);
    EXPECT_NEAR(ran.last("run", "velocity", "collar.z"), -creep, 1e-6 * creep);
    EXPECT_NEAR(ran.last("run", "friction_force", "rod"), weight, 1e-6);
    EXPECT_NEAR(ran.last("run", "friction_moment", "rod"), limit * radius * std::sqrt(0.75), 1e-6);
    EXPECT_NEAR(ran.last("run.energy", "residue"), 0.0, 1e-4);
  }
}

// Whatever happened before, what sticks lets go where the load reaches the limit, and sticks below it.
TEST(CollarFriction, SticksAndSlipsUnderALoadThatTurnsRound) {
  for (const std::string& step : steps) {
    const MechanismStudy ran(Collar{.inertia = 0.02}.text() + force("z", "4.5*sin(5*t)") + force("rz", "0.2*sin(7*t)") +
                             transient(step, 3.0));
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    const auto& events = ran.table("run.events");
    ASSERT_GE(events.rows.size(), 5u);
    for (const auto& event : events.rows) {
      const double t = event[0], load = std::hypot(4.5 * std::sin(5.0 * t), 0.2 / radius * std::sin(7.0 * t));
      if (events.layout.blocks[2].categories[static_cast<std::size_t>(event[2])] == "slips")
        EXPECT_NEAR(load, limit, 1e-5) << t;
      else
        EXPECT_LT(load, limit) << t;
    }
    EXPECT_NEAR(ran.last("run.energy", "residue"), 0.0, 1e-3 * ran.last("run.energy", "friction_dissipated"));
    EXPECT_LT(ran.table("run").rows.size(), 20000u);
  }
}

// Kept from turning by a guide that rubs too, with 3 N: both hold together up to 7 N.
TEST(CollarFriction, HoldsTogetherWithAGuideBesideIt) {
  const std::string guide =
      "[[joint]]\nname = \"guide\"\ntype = \"prismatic\"\nbetween = [\"ground\", \"collar\"]\nat = [0.0, 0.0, 0.0]\n"
      "axis = [0.0, 0.0, 1.0]\nfriction = { coefficient = 0.3, preload = 10.0 }\n";
  for (const std::string& step : steps) {
    const MechanismStudy ran(Collar{}.text() + guide + force("z", "10*sin(4*t)") + transient(step, 0.7));
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    ASSERT_EQ(ran.table("run.events").rows.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(ran.at(i, "run.events", "time"), std::asin(0.7) / 4.0, 1e-6);
    EXPECT_GT(ran.last("run", "displacement", "rod"), 0.01);
    EXPECT_NEAR(ran.last("run", "friction_force", "rod"), -limit, 1e-8);
    EXPECT_NEAR(ran.last("run", "friction_force", "guide"), -3.0, 1e-8);
  }
}

TEST(CollarFrictionFault, AsksForTheRadiusOfThePin) {
  EXPECT_THAT(verdict(replaced(Collar{}.text() + transient("0.01", 1.0), ", radius = 0.05", "")),
              HasSubstr("joint \"rod\": friction lacks the key \"radius\", of the pin [m]"));
}

}  // namespace
}  // namespace rubato
