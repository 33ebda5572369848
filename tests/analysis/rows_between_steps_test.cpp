#include <support/mechanism_study.hpp>
#include <support/prepared_study.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <string>

namespace rubato {
namespace {

using testing::MechanismStudy;

double swings(double t) { return std::tanh(std::sin(5.7 * t)); }

const char* const block = "[[body]]\nname = \"block\"\nposition = [0.0, 0.0]\nmass = 2.0\ninertia = 3.0\n";
const char* const load = "[[force]]\non = \"block.x\"\nexpression = \"tanh(sin(5.7*t))\"\n";

/// An analysis `a` whose rows lie between its steps.
std::string rows_every(const std::string& interval, const std::string& steps) {
  return "[[analysis]]\nname = \"a\"\ntype = \"transient\"\nduration = 3.0\n" + steps +
         "\noutput = { interval = " + interval + " }\n";
}

/// The largest difference of a column of `a` from what it should be.
template <class Exact>
double largest_error(const MechanismStudy& ran, const std::string& variable, const std::string& label, Exact exact) {
  EXPECT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const std::size_t rows = ran.table("a").rows.size();
  EXPECT_EQ(rows, 301u);
  double largest = 0.0;
  for (std::size_t row = 0; row < rows; ++row)
    largest = std::max(largest, std::abs(ran.at(row, "a", variable, label) - exact(ran.at(row, "a", "time"))));
  return largest;
}

// 3 * 0.1 is more than 0.3 by round-off, which counted as a time beyond the end where the last step was shorter than
// 1e-8 s: the row was missing.
TEST(RowsBetweenSteps, TellTheEndHoweverShortTheLastStepIs) {
  const MechanismStudy ran(std::string(block) + R"(
[[force]]
on = "block.x"
expression = "t < 0.2999999995 ? 1 : 2"
[[analysis]]
name = "a"
type = "transient"
duration = 0.3
step = { tolerance = 1e-4 }
output = { interval = 0.1 }
)");
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  ASSERT_EQ(ran.table("a").rows.size(), 4u);
  EXPECT_EQ(ran.at(3, "a", "time"), 0.3);
}

// What is held passes the load on as it is. A cubic through the reactions at four ends of steps led across the kink of
// a load where nothing moves, and rows beside it were wrong by percents of the load.
TEST(RowsBetweenSteps, TellReactionsUpToTheKinkOfALoad) {
  const MechanismStudy ran(R"(
[[body]]
name = "block"
position = [0.0, 0.0]
mass = 1.0
inertia = 1.0
[[joint]]
name = "bolt"
type = "rigid"
between = ["ground", "block"]
at = [0.0, 0.0]
[[force]]
on = "block.x"
expression = "abs(t - 0.3333) + 0"
[[analysis]]
name = "held"
type = "transient"
duration = 1.0
step = { tolerance = 1e-4, largest = 0.1 }
output = { interval = 0.01 }
)");
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const auto& rows = ran.table("held").rows;
  ASSERT_EQ(rows.size(), 101u);
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const double t = ran.at(row, "held", "time");
    EXPECT_NEAR(std::abs(ran.at(row, "held", "reaction_x", "bolt")), std::abs(t - 0.3333), 1e-12) << t;
  }
}

// Steps follow the motion, and here nothing moves: they are long, and a cubic through the reactions at their ends erred
// by 2 % of the load.
TEST(RowsBetweenSteps, FollowTheSwingsOfALoadOnABodyThatIsHeld) {
  for (const char* const steps : {"step = { tolerance = 6e-6 }", "step = 0.1"}) {
    const MechanismStudy ran(block + std::string(load) +
                             "[[joint]]\nname = \"bolt\"\ntype = \"rigid\"\nbetween = [\"ground\", \"block\"]\n"
                             "at = [0.0, 0.0]\n" +
                             rows_every("0.01", steps));
    EXPECT_LT(largest_error(ran, "reaction_x", "bolt", [](double t) { return -swings(t); }), 1e-12) << steps;
  }
}

TEST(RowsBetweenSteps, FollowTheSwingsOfALoadOnAJointThatSticks) {
  const MechanismStudy ran(block + std::string(load) +
                           "[[joint]]\nname = \"rail\"\ntype = \"prismatic\"\nbetween = [\"ground\", \"block\"]\n"
                           "at = [0.0, 0.0]\naxis = [1.0, 0.0]\nfriction = { coefficient = 0.5, preload = 10.0 }\n" +
                           rows_every("0.01", "step = 0.1"));
  EXPECT_LT(largest_error(ran, "friction_force", "rail", [](double t) { return -swings(t); }), 1e-12);
}

// The moment of the drive is 3 kg m^2 times the second derivative of the angle that it prescribes; it swings as the
// angle does, between whose values at the ends of steps the body turns by 1e-6 rad.
TEST(RowsBetweenSteps, FollowTheSwingsOfADrive) {
  const MechanismStudy ran(block +
                           std::string("[[joint]]\nname = \"shaft\"\ntype = \"revolute\"\nbetween = [\"ground\", "
                                       "\"block\"]\nat = [0.0, 0.0]\ndrive = \"1e-6*sin(9*t)\"\n") +
                           rows_every("0.01", "step = 0.1"));
  const double size = 3.0 * 1e-6 * 81.0;
  EXPECT_LT(largest_error(ran, "drive_moment", "shaft", [&](double t) { return -size * std::sin(9.0 * t); }),
            1e-9 * size);
}

// The hinge sticks where its angle is zero: the spring of the law gives nothing.
TEST(RowsBetweenSteps, FollowTheSwingsOfTheLawOfAJoint) {
  const MechanismStudy ran(block +
                           std::string("[[joint]]\nname = \"hinge\"\ntype = \"revolute\"\nbetween = [\"ground\", "
                                       "\"block\"]\nat = [0.0, 0.0]\nmoment = \"tanh(sin(5.7*t)) - 10*angle\"\n"
                                       "friction = { coefficient = 0.5, preload = 10.0, radius = 1.0 }\n") +
                           rows_every("0.01", "step = 0.1"));
  EXPECT_LT(largest_error(ran, "friction_moment", "hinge", [](double t) { return -swings(t); }), 1e-12);
}

// A heavy mass goes far on a soft spring: steps follow its way, and the load swings within them. The acceleration is
// that of the load and the spring at the position of the row.
TEST(RowsBetweenSteps, FollowTheSwingsOfALoadOnAMass) {
  for (const char* const steps :
       {"step = { tolerance = 1e-5 }", "step = 0.1", "step = { tolerance = 1e-5 }\nmethod = \"dormand_prince\"",
        "step = 0.2\nmethod = \"rk4\""}) {
    const testing::PreparedStudy study(
        "[[coordinate]]\nname = \"block\"\nmass = 2.0\nposition = 1000.0\nvelocity = 50.0\n"
        "[[spring]]\nbetween = [\"block\", \"ground\"]\nstiffness = 1e-3\n"
        "[[force]]\non = \"block\"\nexpression = \"tanh(sin(5.7*t))\"\n" +
        rows_every("0.01", steps));
    testing::MemorySink sink;
    testing::QuietProgress progress;
    const std::atomic<bool> stop{false};
    analysis::RunContext context{sink, progress, stop};
    const analysis::RunReport report = analysis::run_analysis(study.study.analyses.front(), study.input(), context);
    ASSERT_EQ(report.status, analysis::RunStatus::done) << report.message;
    const auto& table = sink.tables.at("a");
    ASSERT_EQ(table.rows.size(), 301u);
    const std::size_t position = table.column("position", "block"),
                      acceleration = table.column("acceleration", "block");
    for (const auto& row : table.rows)
      ASSERT_NEAR(row[acceleration], (swings(row[0]) - 1e-3 * row[position]) / 2.0, 1e-9)
          << steps << ", t = " << row[0];
  }
}

}  // namespace
}  // namespace rubato
