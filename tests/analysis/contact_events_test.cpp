#include <rubato/analysis/events_table.hpp>
#include <rubato/analysis/run_study.hpp>

#include <support/memory_sink.hpp>
#include <support/prepared_study.hpp>

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <string>
#include <vector>

namespace rubato {
namespace {

struct Told {
  double t;
  std::string part, what;
  double energy_lost;
};

/// The table `events` of a transient with these keys.
std::vector<Told> events_of(const std::string& model, const std::string& keys) {
  const testing::PreparedStudy study(model + "\n[[analysis]]\nname = \"run\"\ntype = \"transient\"\n" + keys);
  testing::MemorySink sink;
  testing::QuietProgress progress;
  const std::atomic<bool> stop{false};
  analysis::RunContext context{sink, progress, stop};
  const auto report = analysis::run_analysis(study.study.analyses.front(), study.input(), context);
  EXPECT_EQ(report.status, analysis::RunStatus::done) << report.message;
  const auto& table = sink.tables.at("run.events");
  std::vector<Told> told;
  for (const auto& row : table.rows)
    told.push_back({row[0], table.layout.blocks[1].categories.at(static_cast<std::size_t>(row[1])),
                    table.layout.blocks[2].categories.at(static_cast<std::size_t>(row[2])), row[3]});
  return told;
}

constexpr const char* rubbing = R"(
[[coordinate]]
name = "mass"
mass = 1.0
[[spring]]
between = ["mass", "ground"]
stiffness = 40.0
[[slider]]
name = "pad"
between = ["mass", "ground"]
stiffness = 60.0
friction_coefficient = 0.5
normal_load = 4.0
[[force]]
on = "mass"
amplitude = 5.0
angular_frequency = 7.0
)";

void expect_the_same(const std::vector<Told>& found, const std::vector<Told>& exact, double early, double late) {
  ASSERT_EQ(found.size(), exact.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].part, exact[i].part);
    EXPECT_EQ(found[i].what, exact[i].what) << i;
    EXPECT_GE(found[i].t, exact[i].t - early) << i;
    EXPECT_LE(found[i].t, exact[i].t + late) << i;
  }
}

// The flow finds each transition as the root of a polynomial, without steps.
TEST(EventsOfASlider, AreThoseOfTheExactFlow) {
  const std::vector<Told> exact = events_of(rubbing, "method = \"exact\"\nduration = 6.0");
  ASSERT_GE(exact.size(), 12u);
  for (std::size_t i = 0; i < exact.size(); ++i) EXPECT_EQ(exact[i].what, i % 2 == 0 ? "slips" : "sticks");
  // Located: as exact as the motion, whose error is that of the tolerance.
  const std::vector<Told> located = events_of(
      rubbing, "method = \"generalized_alpha\"\nstep = { tolerance = 1e-8, events = \"locate\" }\nduration = 6.0");
  expect_the_same(located, exact, 1e-4, 1e-4);
  // A step of a pair ends at a force or velocity of either sign, by round-off, and the next is long.
  const std::vector<Told> by_pair =
      events_of(rubbing, "method = \"dormand_prince\"\nstep = { tolerance = 1e-7 }\nduration = 6.0");
  expect_the_same(by_pair, exact, 1e-4, 1e-4);
  // Equal steps: a slider slips in a step at whose end its force is the limit. So a slip is told at the end of the step
  // in which it begins. It may come to rest in a step that takes it further on the whole, and is told at the end of the
  // next. The motion is early or late by much less than a step.
  const double step = 1e-3;
  const std::vector<Told> equal = events_of(rubbing, "method = \"generalized_alpha\"\nstep = 1e-3\nduration = 6.0");
  expect_the_same(equal, exact, 0.2 * step, 2.2 * step);
  for (std::size_t i = 0; i < exact.size(); i += 2) EXPECT_LE(equal[i].t, exact[i].t + 1.2 * step);
  for (const Told& event : equal) EXPECT_NEAR(event.t / step, std::round(event.t / step), 1e-6);
  const std::vector<Told> passed = events_of(
      rubbing,
      "method = \"generalized_alpha\"\nstep = { tolerance = 1e-6, largest = 1e-3, events = \"pass\" }\nduration = 6.0");
  expect_the_same(passed, exact, 0.2 * step, 2.2 * step);
}

// A mass that a constant force P drives from rest against a spring k without damping: it meets the stop at
// sqrt(2 gap m / P), and leaves it when (P/k)(1 - cos a) + (v/w) sin a = 0, a = 2 (pi - atan(v w / (P/m))).
constexpr const char* falling = R"(
[[coordinate]]
name = "mass"
mass = 2.0
[[stop]]
name = "floor"
between = ["mass", "ground"]
gap = 0.3
stiffness = 5000.0
[[force]]
on = "mass"
expression = "12.0"
)";

TEST(EventsOfAStop, AreThoseOfABouncingMass) {
  const double acceleration = 6.0, omega = 50.0;
  const double meets = std::sqrt(2.0 * 0.3 / acceleration), speed = acceleration * meets;
  const double contact = 2.0 * (std::numbers::pi - std::atan(speed * omega / acceleration)) / omega;
  const std::vector<Told> told =
      events_of(falling, "method = \"generalized_alpha\"\nstep = { tolerance = 1e-8 }\nduration = 0.8");
  ASSERT_EQ(told.size(), 2u);
  EXPECT_EQ(told[0].part, "floor");
  EXPECT_EQ(told[0].what, "closes");
  EXPECT_NEAR(told[0].t, meets, 1e-6);
  EXPECT_EQ(told[1].what, "opens");
  EXPECT_NEAR(told[1].t, meets + contact, 1e-5);
  const double step = 1e-4;
  const std::vector<Told> equal = events_of(falling, "method = \"generalized_alpha\"\nstep = 1e-4\nduration = 0.8");
  ASSERT_EQ(equal.size(), 2u);
  EXPECT_NEAR(equal[0].t, meets + 0.5 * step, 0.6 * step);
  EXPECT_NEAR(equal[1].t, meets + contact + 0.5 * step, 0.6 * step);
}

TEST(EventsOfAStop, BeginWithThatOnWhichAMassRests) {
  const std::vector<Told> told =
      events_of(falling, "method = \"generalized_alpha\"\nstep = 1e-3\ninitial = \"static\"\nduration = 0.05");
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told[0].what, "closes");
  EXPECT_EQ(told[0].t, 0.0);
}

// A run of a million cycles must fill neither memory nor a disk.
TEST(Events, AreKeptUpToANumberAndCountedBeyond) {
  integrate::Events events;
  events.parts = {"pad"};
  for (int i = 0; i < 100'003; ++i) events.add({0.5 * i, 0, integrate::Change::slips});
  EXPECT_EQ(events.all.size(), 100'000u);
  EXPECT_EQ(analysis::warning_of(events), "of 100003 events the table has the first 100000, up to t = 49999.5 s");
}

// Turned round by its loads, and pressed by little for a while: N is the small difference of the preload and of what
// lifts, so that mu N by the displacement and |T| differ by round-off. It slides for good.
TEST(EventsOfAContact, AreNotMadeByTheRoundOffOfWhatPresses) {
  const std::string model = R"(
[[coordinate]]
name = "x"
mass = 1.0
[[coordinate]]
name = "y"
mass = 1.0
[[coordinate]]
name = "z"
mass = 1.0
[[spring]]
between = ["x", "ground"]
stiffness = 10.0
[[spring]]
between = ["y", "ground"]
stiffness = 10.0
[[spring]]
between = ["z", "ground"]
stiffness = 100.0
[[contact]]
name = "pad"
tangential = [{ x = 1.0 }, { y = 1.0 }]
normal = { z = 1.0 }
tangential_stiffness = 100.0
normal_stiffness = 100.0
friction_coefficient = 0.3
normal_load = 1.0
[[force]]
on = "x"
amplitude = 3.0
angular_frequency = 2.0
[[force]]
on = "y"
amplitude = 3.0
angular_frequency = 2.0
phase = -1.5707963267948966
[[force]]
on = "z"
amplitude = 0.5
angular_frequency = 5.0
)";
  for (const char* keys :
       {"step = 0.001", "step = { tolerance = 1e-4 }", "method = \"average_acceleration\"\nstep = 0.001"}) {
    const std::vector<Told> told = events_of(model, std::string(keys) + "\nduration = 15.0");
    ASSERT_EQ(told.size(), 1U) << keys;
    EXPECT_EQ(told.front().what, "slips");
    EXPECT_NEAR(told.front().t, 0.0445, 1e-3);
  }
}

}  // namespace
}  // namespace rubato
