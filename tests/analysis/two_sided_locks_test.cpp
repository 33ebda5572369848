#include <support/laid_studies.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

// Joints with several locks, and joints that start on one. The block of block_in_guide() has 2 kg.
namespace rubato {
namespace {

using std::numbers::pi;
using testing::block_in_guide;
using ::testing::HasSubstr;
using testing::Laid;
using testing::MechanismStudy;
using testing::transient;
using testing::verdict;

constexpr double mass = 2.0;

class TwoSidedLocks : public ::testing::TestWithParam<Laid> {};
INSTANTIATE_TEST_SUITE_P(Laid, TwoSidedLocks, ::testing::Values(testing::in_plane, testing::in_space),
                         testing::name_of_laid<::testing::TestParamInfo<Laid>>);

class StartOnALock : public ::testing::TestWithParam<Laid> {};
INSTANTIATE_TEST_SUITE_P(Laid, StartOnALock, ::testing::Values(testing::in_plane, testing::in_space),
                         testing::name_of_laid<::testing::TestParamInfo<Laid>>);

/// A force on the block along a guide that does not rise, as a law of t.
std::string along(const Laid& laid, const std::string& keys, const std::string& force, double speed = 0.0) {
  return block_in_guide(laid, 0.0, keys + "\nforce = \"" + force + "\"", speed);
}

void expect_done(const MechanismStudy& ran) {
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
}

// Between undamped stops the block keeps its energy: it crosses 0.65 m at its speed, and each stop holds it for half a
// period of sqrt(2/8e4) s. Steps of 0.1 ms err by (h/tau)^2/12 of that half period: 3e-6 of it, and four are passed.
TEST_P(TwoSidedLocks, ThrowABlockToAndFroWithItsEnergy) {
  const double speed = 1.5, up = 0.4, down = -0.25, stiffness = 8e4;
  const MechanismStudy ran(block_in_guide(GetParam(), 0.3,
                                          "lock = [{ at = -0.25, kind = \"stop\", stiffness = 8e4 }, "
                                          "{ at = 0.4, kind = \"stop\", stiffness = 8e4 }]",
                                          speed) +
                           transient("0.0001", 1.6));
  expect_done(ran);
  const double touches = pi / std::sqrt(stiffness / mass), crosses = (up - down) / speed;
  const auto& events = ran.table("run.events");
  ASSERT_EQ(events.rows.size(), 6u);
  double t = up / speed;
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(ran.at(i, "run.events", "time"), t, 2e-6) << i;
    t += i % 2 == 0 ? touches : crosses;
    EXPECT_EQ(ran.at(i, "run.events", "lock"), i % 4 < 2 ? 2.0 : 1.0) << i;  // up first: the second of the two
  }
  EXPECT_NEAR(ran.last("run.energy", "kinetic"), 0.5 * mass * speed * speed, 1e-5);
  const double least = -down + speed / std::sqrt(stiffness / mass);
  double lowest = 0.0;
  for (std::size_t row = 0; row < ran.table("run").rows.size(); ++row)
    lowest = std::min(lowest, ran.at(row, "run", "displacement", "guide"));
  EXPECT_NEAR(lowest, -least, 1e-5);
}

// A block that goes to and fro for ten seconds changes each lock more than six times.
TEST_P(TwoSidedLocks, AreToldByTheirPlaceAndNotWithoutEnd) {
  const MechanismStudy ran(block_in_guide(GetParam(), 0.3,
                                          "lock = [{ at = -0.25, kind = \"stop\", stiffness = 8e4 }, "
                                          "{ at = 0.4, kind = \"stop\", stiffness = 8e4 }]",
                                          1.5) +
                           transient("0.001", 10.0));
  expect_done(ran);
  const auto of = [&](const char* words) {
    return std::count_if(ran.report.findings.begin(), ran.report.findings.end(),
                         [&](const std::string& finding) { return finding.find(words) != std::string::npos; });
  };
  EXPECT_EQ(of(" s, at lock(1)"), 6);
  EXPECT_EQ(of(" s, at lock(2)"), 6);
  const auto rows = ran.table("run.events").rows.size();
  EXPECT_GT(rows, 24u);
  long told = 0;
  for (const int lock : {1, 2}) {
    long changes = 0;
    for (std::size_t i = 0; i < rows; ++i) changes += ran.at(i, "run.events", "lock") == lock ? 1 : 0;
    EXPECT_EQ(of(("\"guide\" locks and lets go " + std::to_string(changes) + " times in all, at lock(" +
                  std::to_string(lock) + ")")
                     .c_str()),
              1);
    told += changes;
  }
  EXPECT_EQ(told, static_cast<long>(rows));
}

// Pushed by 6 N against one rigid stop, from 1 s on against the other: each takes what the force gave on the way.
TEST_P(TwoSidedLocks, HoldABlockAtEitherRigidStop) {
  for (const char* step : {"0.003", "{ tolerance = 1e-4 }"}) {
    const MechanismStudy ran(
        along(GetParam(), "lock = [{ at = 0.4, kind = \"stop\" }, { at = -0.25, kind = \"stop\" }]", "t < 1 ? 6 : -6") +
        transient(step, 3.0));
    expect_done(ran);
    ASSERT_EQ(ran.table("run.events").rows.size(), 3u);
    EXPECT_NEAR(ran.at(0, "run.events", "time"), std::sqrt(2.0 * 0.4 * mass / 6.0), 1e-7);
    EXPECT_NEAR(ran.at(0, "run.events", "energy_lost"), 6.0 * 0.4, 1e-6);
    EXPECT_NEAR(ran.at(1, "run.events", "time"), 1.0, 1e-9);
    EXPECT_NEAR(ran.at(2, "run.events", "time"), 1.0 + std::sqrt(2.0 * 0.65 * mass / 6.0), 1e-7);
    EXPECT_NEAR(ran.at(2, "run.events", "energy_lost"), 6.0 * 0.65, 1e-6);
    EXPECT_NEAR(ran.last("run", "displacement", "guide"), -0.25, 1e-10);
    EXPECT_NEAR(ran.last("run", "reaction_lock_force", "guide"), 6.0, 1e-8);
    EXPECT_NEAR(ran.last("run.energy", "lock_dissipated"), 6.0 * (0.4 + 0.65), 1e-6);
  }
}

TEST_P(TwoSidedLocks, TakeLessFromABlockThatRubs) {
  const MechanismStudy ran(along(GetParam(),
                                 "friction = { coefficient = 0.3, preload = 7.0 }\n"
                                 "lock = [{ at = 0.4, kind = \"stop\" }, { at = -0.25, kind = \"stop\" }]",
                                 "t < 1 ? 6 : -6") +
                           transient("0.003", 3.0));
  expect_done(ran);
  EXPECT_NEAR(ran.last("run.energy", "lock_dissipated"), (6.0 - 2.1) * (0.4 + 0.65), 1e-5);
  EXPECT_NEAR(ran.last("run.energy", "friction_dissipated"), 2.1 * (0.4 + 0.65), 1e-5);
  EXPECT_NEAR(ran.last("run", "displacement", "guide"), -0.25, 1e-9);
}

// A soft stop before a rigid one: 0.05 m later the block is stopped for good, and the spring throws it back. Of
// (v^2 - k d^2/m) m/2 at the rigid stop nothing is left, and of k d^2/2 the block goes off with all.
TEST_P(TwoSidedLocks, MeetARigidStopBehindASoftOne) {
  const MechanismStudy ran(block_in_guide(GetParam(), 0.0,
                                          "lock = [{ at = 0.35, kind = \"stop\" }, "
                                          "{ at = 0.3, kind = \"stop\", stiffness = 500.0 }]",
                                          1.5) +
                           transient("0.0002", 1.0));
  expect_done(ran);
  const double stored = 0.5 * 500.0 * 0.05 * 0.05, given = 0.5 * mass * 1.5 * 1.5;
  EXPECT_NEAR(ran.last("run.energy", "lock_dissipated"), given - stored, 1e-5);
  EXPECT_NEAR(ran.last("run.energy", "kinetic"), stored, 1e-5);
  EXPECT_LT(ran.last("run", "displacement", "guide"), 0.3);
}

// Whichever latch is met first ends the force; nothing presses on it then.
TEST_P(TwoSidedLocks, EndTheForceAtEitherLatch) {
  for (const double force : {5.0, -5.0}) {
    const double at = force > 0.0 ? 0.3 : -0.2;
    const MechanismStudy ran(along(GetParam(),
                                   "lock = [{ at = 0.3, kind = \"latch\" }, { at = -0.2, kind = \"latch\" }]",
                                   std::to_string(force)) +
                             transient("0.002", 1.0));
    expect_done(ran);
    ASSERT_EQ(ran.table("run.events").rows.size(), 1u);
    EXPECT_NEAR(ran.last("run", "displacement", "guide"), at, 1e-10);
    EXPECT_NEAR(ran.last("run", "reaction_lock_force", "guide"), 0.0, 1e-9);
    EXPECT_NEAR(ran.last("run.energy", "lock_dissipated"), force * at, 1e-7);
  }
}

TEST_P(TwoSidedLocks, HoldABlockInStaticsAndItsModes) {
  const std::string locks =
      "lock = [{ at = -0.5, kind = \"stop\", stiffness = 3e3 }, { at = 0.2, kind = \"stop\", stiffness = 1e3 }]";
  const std::string analyses = GetParam().gravity() +
                               "[[analysis]]\nname = \"rest\"\ntype = \"static\"\n"
                               "[[analysis]]\nname = \"modes\"\ntype = \"modes\"\nabout = \"static\"\n";
  for (const double rise : {0.3, -0.3}) {
    const double at = rise > 0.0 ? -0.5 : 0.2, stiffness = rise > 0.0 ? 3e3 : 1e3;
    const double weight = mass * 9.81 * std::sin(rise);
    const MechanismStudy ran(block_in_guide(GetParam(), rise, locks) + analyses);
    expect_done(ran);
    EXPECT_NEAR(ran.at(0, "rest", "displacement", "guide"), at - weight / stiffness, 1e-9);
    const MechanismStudy modes(block_in_guide(GetParam(), rise, locks) + analyses, 1);
    expect_done(modes);
    EXPECT_NEAR(modes.at(0, "modes", "frequency"), std::sqrt(stiffness / mass) / (2.0 * pi), 1e-7);
  }
}

const std::string stop_above = "lock = { at = 0.0, kind = \"stop\", side = \"above\" }";

// It weighs on the stop on which it starts, until 30 N lift it at 0.5 s.
TEST_P(StartOnALock, HoldsWhatWeighsOnIt) {
  for (const char* step : {"0.002", "{ tolerance = 1e-5 }"}) {
    const MechanismStudy ran(block_in_guide(GetParam(), 0.3, stop_above + "\nforce = \"t < 0.5 ? 1 : 30\"") +
                             GetParam().gravity() + transient(step, 1.0));
    expect_done(ran);
    EXPECT_TRUE(ran.report.warnings.empty());
    const double weight = mass * 9.81 * std::sin(0.3);
    EXPECT_NEAR(ran.at(0, "run", "reaction_lock_force", "guide"), weight - 1.0, 1e-9);
    ASSERT_EQ(ran.table("run.events").rows.size(), 2u);
    EXPECT_EQ(ran.at(0, "run.events", "time"), 0.0);
    EXPECT_NEAR(ran.at(1, "run.events", "time"), 0.5, 1e-9);
    EXPECT_NEAR(ran.last("run", "displacement", "guide"), 0.5 * (30.0 - weight) / mass * 0.25, 1e-6);
  }
}

TEST_P(StartOnALock, LetsGoWhatLeavesIt) {
  const double speed = 1.2, down = 9.81 * std::sin(0.3);
  const MechanismStudy thrown(block_in_guide(GetParam(), 0.3, stop_above, speed) + GetParam().gravity() +
                              transient("0.002", 1.2));
  expect_done(thrown);
  EXPECT_TRUE(thrown.report.warnings.empty());
  ASSERT_EQ(thrown.table("run.events").rows.size(), 1u);
  EXPECT_NEAR(thrown.at(0, "run.events", "time"), 2.0 * speed / down, 1e-8);
  EXPECT_NEAR(thrown.at(0, "run.events", "energy_lost"), 0.5 * mass * speed * speed, 1e-8);
  // At rest, and pulled away.
  const MechanismStudy pulled(along(GetParam(), stop_above, "4") + transient("0.002", 1.0));
  expect_done(pulled);
  EXPECT_TRUE(pulled.table("run.events").rows.empty());
  EXPECT_NEAR(pulled.last("run", "displacement", "guide"), 0.5 * 4.0 / mass, 1e-9);
}

TEST_P(StartOnALock, TakesTheVelocitiesThatLeadAgainstIt) {
  const MechanismStudy ran(block_in_guide(GetParam(), 0.3, stop_above, -1.2) + GetParam().gravity() +
                           transient("0.002", 0.5));
  expect_done(ran);
  ASSERT_EQ(ran.report.warnings.size(), 1u);
  EXPECT_THAT(ran.report.warnings.front(), HasSubstr("which took 1.44 J"));
  EXPECT_NEAR(ran.last("run", "displacement", "guide"), 0.0, 1e-10);
}

// Put down on an elastic stop at rest the block swings about the place where it is at rest: s = -sag (1 - cos). A step
// h errs by (w h)^2/12 of the phase w t: 3e-5.
TEST_P(StartOnALock, IsPressedInFromThereWhereItIsElastic) {
  const double stiffness = 700.0, weight = mass * 9.81 * std::sin(0.3), sag = weight / stiffness;
  const MechanismStudy ran(
      block_in_guide(GetParam(), 0.3, "lock = { at = 0.0, kind = \"stop\", side = \"above\", stiffness = 700.0 }") +
      GetParam().gravity() + transient("0.0005", 0.2));
  expect_done(ran);
  const double t = 0.2, frequency = std::sqrt(stiffness / mass);
  EXPECT_NEAR(ran.last("run", "displacement", "guide"), -sag * (1.0 - std::cos(frequency * t)), 5e-5 * sag);
}

// Touched without a force it changes nothing until a force presses, and again where one pulls.
TEST_P(StartOnALock, WaitsForAForce) {
  for (const char* kind : {"kind = \"stop\"", "kind = \"stop\", stiffness = 1e5, damping = 200.0"}) {
    const std::string lock = std::string("lock = { at = 0.0, side = \"above\", ") + kind + " }";
    const MechanismStudy pressed(along(GetParam(), lock, "t < 0.5 ? 0 : -4") + transient("0.004", 1.0));
    expect_done(pressed);
    const double depth = std::string(kind).find("1e5") == std::string::npos ? 0.0 : 4.0 / 1e5;
    EXPECT_NEAR(pressed.last("run", "displacement", "guide"), -depth, 1e-8);
    const MechanismStudy pulled(along(GetParam(), lock, "t < 0.5 ? 0 : 4") + transient("0.004", 1.0));
    expect_done(pulled);
    EXPECT_NEAR(pulled.last("run", "displacement", "guide"), 0.25, 1e-6);
  }
}

TEST_P(StartOnALock, IsLatchedThereByALatch) {
  const MechanismStudy ran(along(GetParam(), "lock = { at = 0.0, kind = \"latch\", side = \"below\" }", "3") +
                           transient("0.01", 0.5));
  expect_done(ran);
  EXPECT_NEAR(ran.last("run", "displacement", "guide"), 0.0, 1e-12);
  ASSERT_EQ(ran.table("run.events").rows.size(), 1u);
  EXPECT_EQ(ran.at(0, "run.events", "time"), 0.0);
}

// A seesaw on two props, both of which it touches: the weight 0.1 m from the middle is shared 0.6 to 0.4 where both
// press; a load beyond a prop lifts it off the other.
TEST(StartOnLocks, OpensThePropThatWouldPull) {
  const auto seesaw = [](double load) {
    std::string text = "[[body]]\nname = \"bar\"\nmass = 2.0\ninertia = 0.5\nposition = [0.1, 0.0]\n";
    for (const char* side : {"-0.5", "0.5"})
      text += std::string("[[joint]]\nname = \"prop") + side +
              "\"\ntype = \"strut\"\nbetween = [\"ground\", \"bar\"]\nat = [" + side + ", -1.0]\nto = [" + side +
              ", 0.0]\nlock = { at = 1.0, kind = \"stop\", side = \"above\" }\n";
    return text +
           "[[joint]]\nname = \"rail\"\ntype = \"strut\"\nbetween = [\"ground\", \"bar\"]\nat = [-9.0, 0.0]\nto = "
           "[0.1, 0.0]\nstiffness = 1.0\n[[force]]\non = \"bar.rz\"\nexpression = \"" +
           std::to_string(load) + "\"\n[gravity]\nacceleration = [0.0, -9.81]\n" +
           "[[analysis]]\nname = \"run\"\ntype = \"transient\"\nstep = 0.0005\nduration = 0.1\n";
  };
  const double weight = 2.0 * 9.81;
  const MechanismStudy both(seesaw(0.0));
  expect_done(both);
  EXPECT_NEAR(both.at(0, "run", "reaction_lock_force", "prop-0.5"), 0.4 * weight, 1e-8);
  EXPECT_NEAR(both.at(0, "run", "reaction_lock_force", "prop0.5"), 0.6 * weight, 1e-8);
  // -30 N m turns the bar about the right prop: (0.5 + 2 0.4^2) a = 30 - weight 0.4 in the other sense.
  const MechanismStudy tips(seesaw(-30.0));
  expect_done(tips);
  EXPECT_NEAR(tips.at(0, "run", "reaction_lock_force", "prop-0.5"), 0.0, 1e-9);
  EXPECT_NEAR(tips.at(0, "run", "angular_acceleration", "bar.rz"), -(30.0 - 0.4 * weight) / (0.5 + 2.0 * 0.16), 1e-8);
}

TEST(TwoSidedLockFault, NamesLocksThatLeaveNoRoom) {
  const auto said = [](const std::string& lock, const std::string& more = "") {
    return verdict(block_in_guide(testing::in_plane, 0.3, "lock = " + lock + "\n" + more) + transient("0.01", 0.1));
  };
  EXPECT_THAT(
      said("[{ at = 0.0, kind = \"stop\", side = \"above\" }, { at = 0.0, kind = \"stop\", side = \"below\" }]"),
      HasSubstr("joint \"guide\": the lock at 0, of which the values above are free, and the lock at 0, of which "
                "those below are, leave no room between them; take a rigid joint"));
  EXPECT_THAT(said("[{ at = 0.1, kind = \"stop\" }, { at = 0.2, kind = \"stop\" }]"),
              HasSubstr("joint \"guide\": its lock at 0.2 is never reached, since that at 0.1 is rigid"));
  EXPECT_THAT(said("[{ at = 0.1, kind = \"stop\" }, { at = 0.1, kind = \"latch\" }]"),
              HasSubstr("two locks at 0.1 are met from the same side"));
  EXPECT_THAT(
      said("{ at = 0.1, kind = \"stop\", side = \"above\" }"),
      HasSubstr("joint \"guide\": lock: the joint starts at 0, beyond its lock at 0.1, of which the values above "
                "are free"));
  EXPECT_THAT(said("[{ at = 0.1, kind = \"stop\" }, { at = 0.0, kind = \"stop\" }]"),
              HasSubstr("joint \"guide\": lock(2): the joint starts at its lock, 0; say which values are free"));
  EXPECT_THAT(said("[]"), HasSubstr("lock"));
  EXPECT_THAT(said("[{ at = 0.1, kind = \"stop\" }]", "drive = \"0.1*sin(t)\""), HasSubstr("a drive and a lock"));
  EXPECT_THAT(said("[{ at = 0.1, kind = \"stop\", stifness = 3 }]"), HasSubstr("joint \"guide\": lock(1) has no key"));
}

}  // namespace
}  // namespace rubato
