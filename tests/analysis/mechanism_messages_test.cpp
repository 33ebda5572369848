#include <rubato/analysis/failure_text.hpp>
#include <rubato/core/error.hpp>
#include <rubato/integrate/mechanism/mechanism_failure.hpp>
#include <support/laid_studies.hpp>

#include <support/mechanism_study.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace rubato {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::MechanismStudy;
using ::testing::Not;
using testing::replaced;

std::string refusal(const std::string& text) {
  try {
    const MechanismStudy ran(text);
    return "ran: " + ran.report.message;
  } catch (const InvalidInput& fault) {
    return fault.what();
  }
}

/// A cart that runs against a damped stop at 0.1 m with 1 m/s, and comes back.
const std::string cart = R"(
[[body]]
name = "cart"
mass = 1.0
inertia = 1.0
position = [0.0, 0.0]
velocity = [1.0, 0.0]
[[joint]]
name = "rail"
type = "prismatic"
between = ["ground", "cart"]
at = [0.0, 0.0]
axis = [1.0, 0.0]
lock = { at = 0.1, kind = "stop", stiffness = 1000.0, damping = 10.0 }
[[analysis]]
name = "run"
type = "transient"
step = { tolerance = 1e-5 }
duration = 0.4
)";

// Newton's method comes out of the wall by half a millimetre an iteration, and a step leads 40 mm into it.
TEST(MechanismMessages, WarnOfEqualStepsThatBecameShorter) {
  const std::string text = replaced(cart, "lock = { at = 0.1, kind = \"stop\", stiffness = 1000.0, damping = 10.0 }",
                                    "force = \"-1e-3*exp(2000*displacement)\"");
  const MechanismStudy ran(replaced(text, "{ tolerance = 1e-5 }", "0.04"));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  EXPECT_THAT(ran.report.warnings,
              Contains(AllOf(HasSubstr("of the equal steps"), HasSubstr("steps instead of 10; take a shorter step"))));
  EXPECT_LT(ran.last("run", "velocity", "cart.x"), 0.0);
  EXPECT_THAT(MechanismStudy(replaced(text, "{ tolerance = 1e-5 }", "1e-4")).report.warnings, IsEmpty());
}

TEST(MechanismMessages, CallEventsInTheTableAsTheCommandDoes) {
  const MechanismStudy ran(cart);
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const auto& events = ran.table("run.events");
  EXPECT_THAT(events.layout.blocks[2].categories,
              ElementsAre("lets_go", "locks", "slips", "sticks", "opens", "closes"));
  ASSERT_EQ(events.rows.size(), 2u);
  EXPECT_EQ(events.rows[0][2], 1.0);
  EXPECT_EQ(events.rows[1][2], 0.0);
  EXPECT_EQ(events.rows[0].size(), 4u);  // the column `lock` is for joints with several
  ASSERT_EQ(ran.report.findings.size(), 2u);
  EXPECT_THAT(ran.report.findings[0], HasSubstr("\"rail\" locks at t = 0.1 s"));
  EXPECT_THAT(ran.report.findings[0], Not(HasSubstr("J")));  // its spring takes the energy, and gives it back
  EXPECT_THAT(ran.report.findings[1], HasSubstr("J still in its spring, which its damper takes"));
}

TEST(MechanismMessages, TellThatStepsAlwaysEndWhereLocksChange) {
  EXPECT_THAT(
      refusal(replaced(cart, "{ tolerance = 1e-5 }", "{ tolerance = 1e-5, events = \"pass\" }")),
      HasSubstr("events = \"pass\" is for structures: a lock or a joint that sticks changes what the step solves"));
}

// A jack of 1 m whose drive begins at 1.3 m sets the cart to 0.3 m, beyond the stop that was meant to end its way.
TEST(MechanismMessages, WarnOfALockThatIsPassedBeforeTheStart) {
  const std::string jack =
      "[[joint]]\nname = \"jack\"\ntype = \"strut\"\nbetween = [\"ground\", \"cart\"]\nat = [-1.0, 0.0]\nto = [0.0, "
      "0.0]\ndrive = \"1.3 + 0.1*t\"\n[[analysis]]";
  const MechanismStudy ran(replaced(replaced(cart, "velocity = [1.0, 0.0]\n", ""), "[[analysis]]", jack));
  ASSERT_FALSE(ran.report.warnings.empty());
  const auto& warnings = ran.report.warnings;
  EXPECT_TRUE(std::any_of(warnings.begin(), warnings.end(), [](const std::string& warning) {
    return warning.starts_with("\"rail\" starts 0.2 m beyond its lock at 0.1 m, which does not hold it there");
  })) << warnings[0];
  EXPECT_THAT(MechanismStudy(cart).report.warnings, IsEmpty());
}

/// A bar whose place does not go with its hinge.
std::string misplaced(const std::string& more) {
  return R"(
[[body]]
name = "bar"
mass = 1.0
inertia = 1.0
position = [0.0, 0.0]
[[body]]
name = "other"
mass = 1.0
inertia = 1.0
position = [3.0, 0.0]
[[joint]]
name = "A"
type = "distance"
between = ["ground", "bar"]
at = [0.0, -1.0]
to = [0.0, 0.0]
length = 1.01
)" + more +
         R"(
[[analysis]]
name = "run"
type = "transient"
step = 0.01
duration = 0.02
)";
}

TEST(MechanismMessages, TellLengthsInMetres) {
  const MechanismStudy ran(misplaced(""));
  ASSERT_FALSE(ran.report.warnings.empty());
  EXPECT_THAT(ran.report.warnings[0], HasSubstr("they were moved, \"bar.y\" most, by 0.01 m"));
  // Two links of other lengths between the same points.
  const std::string twice =
      "[[joint]]\nname = \"B\"\ntype = \"distance\"\nbetween = [\"ground\", \"bar\"]\nat = [0.0, -1.0]\nto = [0.0, "
      "0.0]\nlength = 1.2\n";
  EXPECT_THAT(refusal(misplaced(twice)), ::testing::ContainsRegex("stays apart by 0\\.[0-9]+ m"));
}

// Nothing holds the bob: there is no equilibrium under its weight. The analysis fails; that others run is the
// command's.
TEST(MechanismMessages, FailOneAnalysisWhoseStaticStartIsNotFound) {
  const std::string falling = R"(
[[body]]
name = "bob"
mass = 1.0
inertia = 1.0
position = [0.0, 0.0]
[[joint]]
name = "rail"
type = "prismatic"
between = ["ground", "bob"]
at = [0.0, 0.0]
axis = [0.0, 1.0]
[gravity]
acceleration = [0.0, -9.81]
[[analysis]]
name = "run"
)";
  for (const std::string task : {"type = \"transient\"\ninitial = \"static\"\nstep = 0.01\nduration = 1.0\n",
                                 "type = \"modes\"\nabout = \"static\"\n"}) {
    const MechanismStudy ran(falling + task);
    EXPECT_EQ(ran.report.status, analysis::RunStatus::failed) << task;
    EXPECT_THAT(ran.report.message, HasSubstr("no equilibrium was found")) << task;
    EXPECT_EQ(ran.sink.tables.count("run"), 0u) << task;
  }
}

TEST(MechanismMessages, AskWhetherDegreesWereMeantByARestOfNinety) {
  const std::string hinge = R"(
[[body]]
name = "bar"
mass = 1.0
inertia = 1.0
position = [0.5, 0.0]
[[joint]]
name = "hinge"
type = "revolute"
between = ["ground", "bar"]
at = [0.0, 0.0]
stiffness = 10.0
rest = 90
[[analysis]]
name = "modes"
type = "modes"
about = "static"
)";
  EXPECT_THAT(refusal(hinge),
              HasSubstr("joint \"hinge\": rest is 90 rad, more than a turn; if degrees are meant, write "
                        "\"90 * pi/180\", if turns, \"28.6479 * pi\""));
  // A spring wound by three turns.
  EXPECT_EQ(refusal(replaced(hinge, "rest = 90", "rest = \"6*pi\"")), "ran: ");
}

/// A strut that a drive shortens from 1 m by 1 m/s.
std::string shortened(const std::string& step, double duration, const std::string& drive = "1 - t") {
  return R"(
[[body]]
name = "bob"
mass = 1.0
inertia = 1.0
position = [1.0, 0.0]
[[joint]]
name = "rail"
type = "prismatic"
between = ["ground", "bob"]
at = [1.0, 0.0]
axis = [1.0, 0.0]
[[joint]]
name = "jack"
type = "strut"
between = ["ground", "bob"]
at = [0.0, 0.0]
to = [1.0, 0.0]
drive = ")" +
         drive + R"("
[[analysis]]
name = "run"
type = "transient"
step = )" +
         step + "\nduration = " + std::to_string(duration) + "\n";
}

TEST(MechanismMessages, NameTheStrutWhoseEndsMeet) {
  for (const std::string step : {"0.01", "{ tolerance = 1e-5 }"}) {
    const MechanismStudy ran(shortened(step, 2.0));
    EXPECT_EQ(ran.report.status, analysis::RunStatus::failed) << step;
    EXPECT_THAT(ran.report.message, HasSubstr("the ends of the strut \"jack\" meet: at length 0")) << step;
  }
}

// A kink of the drive where the ends meet: no velocities go on from there.
TEST(MechanismMessages, NameTheStrutWhoseEndsMeetWhereItsDriveTurns) {
  const MechanismStudy ran(replaced(shortened("0.01", 2.0), "1 - t", "abs(1 - t)"));
  EXPECT_EQ(ran.report.status, analysis::RunStatus::failed);
  EXPECT_THAT(ran.report.message, HasSubstr("at t = 1 s the ends of the strut \"jack\" meet: at length 0"));
}

TEST(MechanismMessages, TellThatAToleranceLiesBelowWhatNewtonsMethodLeaves) {
  const MechanismStudy ran(shortened("{ tolerance = 1e-13 }", 0.1, "1 - t - 0.1*sin(9*t)"));
  EXPECT_EQ(ran.report.status, analysis::RunStatus::failed);
  EXPECT_THAT(ran.report.message, HasSubstr("the tolerance 1e-13 is below 1e-09, where the error of a step is what "
                                            "Newton's method leaves: take a larger one"));
}

TEST(MechanismMessages, NameTheJointsThatChangedLastInARunThatCrawls) {
  model::Mechanism m(2);
  const Index bar = m.add_node("bar", {0.0, 0.0, 0.0});
  m.add_mass(bar, 1.0, 1.0);
  for (const char* name : {"nut", "bearing"}) {
    model::Lock lock;
    lock.name = name;
    m.locks.push_back(lock);
  }
  const system::Mechanism mechanism(std::move(m));
  system::MechanismEquations equations(mechanism);
  integrate::MarchReport report;
  report.step.outcome = integrate::StepOutcome::crawls;
  report.failed_at = 2.0;
  report.failed_step = 1e-9;
  const std::vector<integrate::LockEvent> events{
      {0.5, 0, true, 0.0, -1}, {1.0, 1, true, 0.0, -1}, {1.5, 0, false, 0.0, -1}};
  const std::string told =
      analysis::text_of(integrate::failure_of(report, equations, mechanism.start(), {-1, events}), "");
  EXPECT_THAT(told, HasSubstr("crawled: the last 2,000 steps were shorter than 1e-8 of the run; the last to change: "
                              "\"nut\" (lets go at t = 1.5 s), \"bearing\" (locks at t = 1 s);"));
  EXPECT_THAT(analysis::text_of(integrate::failure_of(report, equations, mechanism.start(), {}), ""),
              Not(HasSubstr("change")));
}

// Numbers whose squares no double holds: an inertia in the unit of another planet.
TEST(MechanismMessages, NameMassesAndPlacesThatCannotBeComputedWith) {
  EXPECT_THAT(
      refusal(replaced(cart, "inertia = 1.0", "inertia = 1e300")),
      HasSubstr("the numbers of the model are too large or too small to compute with: masses and inertias reach "
                "from 1 kg at \"cart.x\" to 1e+300 kg m2 at \"cart.rz\", places to 0 m; look at their units"));
  EXPECT_THAT(refusal(replaced(cart, "mass = 1.0", "mass = 1e-300")), HasSubstr("from 1e-300 kg at \"cart.x\""));
  EXPECT_THAT(refusal(replaced(cart, "at = [0.0, 0.0]", "at = [1e300, 0.0]")), Not(HasSubstr("\"\"")));
}

TEST(MechanismMessages, TellModesOfWhatIsHeldAndHowFastItWouldMove) {
  const std::string modes = replaced(cart.substr(0, cart.find("lock = ")), "velocity = [1.0, 0.0]\n", "") +
                            "KEYS\n[[analysis]]\nname = \"modes\"\ntype = \"modes\"\n";
  // 3 N on 1 kg.
  const MechanismStudy pushed(replaced(modes, "KEYS", "stiffness = 1.0\nforce = \"3\""));
  EXPECT_THAT(pushed.report.warnings, Contains(HasSubstr("\"cart.x\" accelerates by 3 m/s2")));
  EXPECT_THAT(pushed.report.findings, IsEmpty());
  const MechanismStudy driven(replaced(modes, "KEYS", "drive = \"t\""));
  EXPECT_THAT(driven.report.findings, Contains(HasSubstr("the drive of \"rail\" is held still")));
}

// Weight on a dry guide, which would hold it: statics do not know.
TEST(MechanismMessages, TellThatEquilibriaLeaveOutFriction) {
  const std::string told = "equilibria leave out the friction of joints, which this model has";
  const std::string weight = "[gravity]\nacceleration = [-9.81, 0.0]\n";
  const std::string dry =
      testing::block_in_guide(testing::in_plane, 0.0, "friction = { coefficient = 1, preload = 50 }");
  for (const std::string task : {"type = \"static\"\n", "type = \"modes\"\nabout = \"static\"\n",
                                 "type = \"transient\"\ninitial = \"static\"\nstep = 0.01\nduration = 1.0\n"}) {
    const std::string analysis = "[[analysis]]\nname = \"run\"\n" + task;
    EXPECT_THAT(testing::verdict(dry + weight + analysis), HasSubstr(told)) << task;
    EXPECT_THAT(testing::verdict(testing::block_in_guide(testing::in_plane, 0.0, "") + weight + analysis),
                AllOf(HasSubstr("no equilibrium was found"), Not(HasSubstr(told))))
        << task;
  }
}

TEST(MechanismMessages, WarnOfLoadsThatSwingTooOftenToBeFollowed) {
  const auto warnings = [](int hertz, const std::string& step) {
    return MechanismStudy(
               testing::block_in_guide(testing::in_plane, 0.0, "friction = { coefficient = 1, preload = 50 }") +
               "[[force]]\non = \"block.x\"\nexpression = \"sin(2*pi*" + std::to_string(hertz) + "*t)\"\n" +
               testing::transient(step, 1.0))
        .report.warnings;
  };
  const std::string step = "{ tolerance = 1e-2 }";
  EXPECT_THAT(warnings(200, step), IsEmpty());
  EXPECT_THAT(warnings(1000000, step),
              Contains(HasSubstr("the formula \"sin(2*pi*1000000*t)\" swings or switches too often for all of it to be "
                                 "found: steps may pass what it does; give step = { largest = ... }")));
  EXPECT_THAT(warnings(3000, "{ tolerance = 1e-2, largest = 1e-3 }"), IsEmpty());
  EXPECT_THAT(warnings(200, "0.01"), Contains(HasSubstr("the formula \"sin(2*pi*200*t)\" swings faster than steps of "
                                                        "0.01 s can follow; take 0.000")));
  EXPECT_THAT(warnings(200, "0.0008"), IsEmpty());
}

// Parts of structures that a mechanism would pass over.
TEST(MechanismMessages, RefuseWhatMechanismsHaveNot) {
  const std::string block = testing::block_in_guide(testing::in_plane, 0.0, "") + testing::transient("0.01", 0.1);
  EXPECT_THAT(testing::verdict(block + "[[mass]]\nnode = \"block\"\nmass = 1.0\n"),
              HasSubstr("a [[mass]] acts on nodes, and the study has none; add [[node]] or [nodes]; a body has its own "
                        "mass: add to that, and to its inertia"));
  EXPECT_THAT(testing::verdict(block + "[[support]]\nnode = \"block\"\nfix = [\"x\"]\n"),
              HasSubstr("hold a body by a joint to \"ground\", of type \"rigid\" if it is fixed"));
  EXPECT_THAT(
      testing::verdict("[[coordinate]]\nname = \"m\"\nmass = 1.0\n[[beam]]\nnodes = [\"a\", \"b\"]\nsection = \"x\"\n"
                       "material = \"y\"\n" +
                       testing::transient("0.01", 0.1)),
      HasSubstr("a [[beam]] acts on nodes, and the study has none"));
}

}  // namespace
}  // namespace rubato
