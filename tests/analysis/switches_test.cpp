#include <rubato/analysis/run_study.hpp>
#include <rubato/analysis/transient.hpp>

#include "support/mechanism_study.hpp"
#include "support/memory_sink.hpp"
#include "support/prepared_study.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>

// Loads and motions that switch within a formula: no step passes a switch, as none passes a row of a table.
namespace rubato::analysis {
namespace {

constexpr double tolerance = 1e-4;

/// The largest difference between the position of `name` and a function of time, over the rows of the run.
double error_of(const std::string& model, const std::string& name, const std::function<double(double)>& exact) {
  const testing::PreparedStudy prepared(model + R"(
[[analysis]]
name = "run"
type = "transient"
step = { tolerance = 1e-4 }
duration = 50.0
output = { interval = 0.1 }
)");
  const auto& analysis = prepared.study.analyses.front();
  const auto& transient = std::get<model::TransientDescription>(analysis.task);
  const TransientPlan plan =
      plan_transient(analysis.name, analysis.where, transient, *prepared.kind, prepared.parameters);
  testing::MemorySink sink;
  testing::QuietProgress progress;
  const std::atomic<bool> stop{false};
  RunContext context{sink, progress, stop};
  EXPECT_EQ(run_transient(analysis.name, plan, *prepared.kind, context).status, RunStatus::done);
  const auto& table = sink.tables.at("run");
  double error = 0.0;
  for (const auto& row : table.rows)
    error = std::max(error, std::abs(row[table.column("position", name)] - exact(row[0])));
  return error;
}

/// q'' + q = load.
std::string oscillator(const std::string& load, double position = 0.0) {
  return "parameters = { start = 25.0, length = 0.01 }\n"
         "coordinate = [{ name = \"m\", mass = 1.0, position = " +
         std::to_string(position) +
         " }]\nspring = [{ between = [\"m\", \"ground\"], stiffness = 1.0 }]\n"
         "force = [{ on = \"m\", expression = \"" +
         load + "\" }]\n";
}

/// What a load of 1 from the time 0 on leaves, and one of t.
double after_step(double t) { return t > 0.0 ? 1.0 - std::cos(t) : 0.0; }
double after_ramp(double t) { return t > 0.0 ? t - std::sin(t) : 0.0; }

// The motion has the size 1, and the error of an oscillation over a few periods stays below a few tolerances.
TEST(FormulaThatSwitches, ActsHoweverShortItsPulseIs) {
  const auto exact = [](double t) { return 100.0 * (after_step(t - 25.0) - after_step(t - 25.01)); };
  for (const std::string load : {"t > 25 && t < 25.01 ? 100 : 0", "t < 25 ? 0 : (t < 25.01 ? 100 : 0)",
                                 "100*(t >= start)*(t - start < length)", "50*(sign(t - 25) - sign(t - 25.01))"})
    EXPECT_LT(error_of(oscillator(load), "m", exact), 5.0 * tolerance) << load;
}

TEST(FormulaThatSwitches, ActsByItsKinks) {
  const auto exact = [](double t) {
    return 200.0 / 0.005 * (after_ramp(t - 25.0) - 2.0 * after_ramp(t - 25.005) + after_ramp(t - 25.01));
  };
  EXPECT_LT(error_of(oscillator("max(0, 1 - abs(t - 25.005)/0.005)*200"), "m", exact), 5.0 * tolerance);
}

TEST(FormulaThatSwitches, StrikesWhatMovesAlready) {
  const auto exact = [](double t) { return std::cos(t) + 1000.0 * (after_step(t - 25.003) - after_step(t - 25.004)); };
  EXPECT_LT(error_of(oscillator("t > 25.003 && t < 25.004 ? 1000 : 0", 1.0), "m", exact), 2.0 * 5.0 * tolerance);
}

// x'' + 4 x = 4 u with u = A (1 - cos(W s)) for a time 2 pi/W, s after it begins: a particular solution, and what makes
// it start from rest. The motion that it leaves is A W-small, pi A/W * 4 = 1e-4 m.
TEST(FormulaThatSwitches, MovesASupport) {
  const double amplitude = 0.005, fast = 2.0 * std::numbers::pi / 0.01, begin = 5.011;
  const auto during = [&](double s, int order) {
    const double shared = 1.0 / (4.0 - fast * fast);
    return 4.0 * amplitude *
           (order == 0 ? (1.0 - std::cos(2.0 * s)) / 4.0 - shared * (std::cos(fast * s) - std::cos(2.0 * s))
                       : std::sin(2.0 * s) / 2.0 + shared * (fast * std::sin(fast * s) - 2.0 * std::sin(2.0 * s)));
  };
  const auto exact = [&](double t) {
    const double s = t - begin, end = 0.01;
    if (s <= 0.0) return 0.0;
    if (s <= end) return during(s, 0);
    return during(end, 0) * std::cos(2.0 * (s - end)) + during(end, 1) * std::sin(2.0 * (s - end)) / 2.0;
  };
  const std::string model = R"(
coordinate = [{ name = "b", mass = 2.0 }, { name = "m", mass = 1.0 }]
spring = [{ between = ["b", "m"], stiffness = 4.0 }]
[[displacement]]
on = "b"
expression = "t > 5.011 && t < 5.021 ? 0.01*sin(pi*(t - 5.011)/0.01)^2 : 0"
)";
  const double size = 4.0 * amplitude * 0.01 / 2.0;
  EXPECT_LT(error_of(model, "m", exact), 0.01 * size);  // the pulse is passed in eight steps
}

// A bar of 2 kg, its centre 0.5 m from the pin: J = 0.1 + 2*0.25 = 0.6 kg m2.
std::string driven_bar(const std::string& drive) {
  return R"(
[[body]]
name = "bar"
mass = 2.0
inertia = 0.1
position = [0.5, 0.0]
[[joint]]
name = "motor"
type = "revolute"
between = ["ground", "bar"]
at = [0.0, 0.0]
drive = ")" +
         drive + R"("
[[analysis]]
name = "run"
type = "transient"
step = { tolerance = 1e-4 }
duration = 1.5
)";
}

// 2 rad/s, then none, then 4 rad/s: the drive takes 1.2 J and gives 4.8 J at once, as the table of the same rows does.
TEST(FormulaThatSwitches, DrivesAJointWithAnImpulseAtEachKink) {
  for (const std::string drive : {"t < 0.5 ? 2*t : t < 1 ? 1 : 1 + 4*(t - 1)", "min(2*t, 1) + 4*max(0, t - 1)"}) {
    const testing::MechanismStudy ran(driven_bar(drive));
    ASSERT_EQ(ran.report.status, RunStatus::done) << ran.report.message;
    EXPECT_NEAR(ran.last("run", "angle", "motor"), 3.0, 1e-9);
    EXPECT_NEAR(ran.last("run.energy", "drive_work"), 3.6, 1e-8);
    EXPECT_NEAR(ran.last("run.energy", "kinetic"), 4.8, 1e-8);
    EXPECT_NEAR(ran.last("run.energy", "residue"), 0.0, 1e-8);
  }
}

// The same bar under a moment of 300 N m that lasts 2 ms, from rest and beside a spring that is not yet stretched: it
// leaves with 300*0.002/0.6 = 1 rad/s, 1 ms late.
TEST(FormulaThatSwitches, StrikesAJointHoweverShortItsMoment) {
  for (const std::string law : {"t > 0.5 && t < 0.502 ? 300 : 0", "(t > 0.5 && t < 0.502 ? 300 : 0) - 1e-9*angle"}) {
    const std::string moment = "moment = \"" + law + "\"";
    const testing::MechanismStudy ran(testing::replaced(driven_bar("0"), "drive = \"0\"", moment));
    ASSERT_EQ(ran.report.status, RunStatus::done) << ran.report.message;
    EXPECT_NEAR(ran.last("run", "angle", "motor"), 1.5 - 0.501, tolerance);
    EXPECT_NEAR(ran.last("run.energy", "kinetic"), 0.3, 1e-6);
    EXPECT_NEAR(ran.last("run.energy", "residue"), 0.0, 1e-6);
  }
}

}  // namespace
}  // namespace rubato::analysis
