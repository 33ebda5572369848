#include <rubato/analysis/run_study.hpp>
#include <rubato/analysis/transient.hpp>

#include "support/mechanism_study.hpp"
#include "support/memory_sink.hpp"
#include "support/prepared_study.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>

// Loads that swing as formulas say: steps that choose themselves see each swing, also where nothing moves yet.
namespace rubato::analysis {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double pi = std::numbers::pi;

struct Ran {
  testing::MemorySink sink;
  RunReport report;
  double steps = 0.0;

  /// The largest difference of a coordinate's position from a function of time, and its largest position.
  std::pair<double, double> compared(const std::string& name, const std::function<double(double)>& exact) const {
    const auto& table = sink.tables.at("run");
    const auto column = static_cast<std::size_t>(table.column("position", name));
    double error = 0.0, size = 0.0;
    for (const auto& row : table.rows) {
      error = std::max(error, std::abs(row[column] - exact(row[0])));
      size = std::max(size, std::abs(exact(row[0])));
    }
    return {error, size};
  }
};

Ran run(const std::string& model, double duration, const std::string& step = "{ tolerance = 1e-3 }") {
  const testing::PreparedStudy prepared(
      model + fmt::format("[[analysis]]\nname = \"run\"\ntype = \"transient\"\nstep = {}\nduration = {}\n"
                          "output = {{ interval = {} }}\n",
                          step, duration, duration / 500.0));
  const auto& analysis = prepared.study.analyses.front();
  const TransientPlan plan =
      plan_transient(analysis.name, analysis.where, std::get<model::TransientDescription>(analysis.task),
                     *prepared.kind, prepared.parameters);
  Ran ran;
  testing::QuietProgress progress;
  const std::atomic<bool> stop{false};
  RunContext context{ran.sink, progress, stop};
  ran.report = run_transient(analysis.name, plan, *prepared.kind, context);
  for (const auto& [key, value] : ran.report.statistics)
    if (key == "steps") ran.steps = std::stod(value);
  return ran;
}

/// 1 kg on k, with what acts on it.
std::string oscillator(double k, const std::string& load) {
  return fmt::format(
      "coordinate = [{{ name = \"m\", mass = 1.0 }}]\n"
      "spring = [{{ between = [\"m\", \"ground\"], stiffness = {} }}]\n{}",
      k, load);
}

/// q'' + w0^2 q = p sin(w t) from rest.
double forced(double p, double w0, double w, double t) {
  return p / (w0 * w0 - w * w) * (std::sin(w * t) - w / w0 * std::sin(w0 * t));
}

// Zeros of the sine at every fiftieth of the run, where steps of that length meet it: nothing moved. Hertz times
// duration: 50, 500, 250, 100.
TEST(FormulaThatSwings, ActsWhereTheLongestStepsMeetItsZeros) {
  const struct { double hertz, duration; } cases[] = {{2.0, 25.0}, {5.0, 100.0}, {250.0, 1.0}, {1.0, 100.0}};
  for (const auto& [hertz, duration] : cases) {
    const double w = 2.0 * pi * hertz;
    const Ran ran = run(oscillator(100.0, fmt::format("force = [{{ on = \"m\", expression = \"1000*sin(2*pi*{}*t)\" "
                                                      "}}]\n",
                                                      hertz)),
                        duration);
    ASSERT_EQ(ran.report.status, RunStatus::done);
    const auto [error, size] = ran.compared("m", [&](double t) { return forced(1000.0, 10.0, w, t); });
    EXPECT_LT(error, 1e-2 * size) << hertz;
  }
}

// The ground moves by a formula, as an acceleration and as a place.
TEST(FormulaThatSwings, ActsAsAMotionOfTheGround) {
  const double w = 2.0 * pi * 5.0;
  const Ran shaken =
      run(oscillator(100.0, "[base_motion]\ndirection = { m = 1.0 }\nexpression = \"20*sin(2*pi*5*t)\"\n"), 100.0);
  const auto [error, size] = shaken.compared("m", [&](double t) { return -forced(20.0, 10.0, w, t); });
  EXPECT_LT(error, 1e-2 * size);
  const Ran moved =
      run("coordinate = [{ name = \"m\", mass = 1.0 }, { name = \"foot\", mass = 1.0 }]\n"
          "spring = [{ between = [\"m\", \"foot\"], stiffness = 100.0 }]\n"
          "displacement = [{ on = \"foot\", expression = \"0.02*sin(2*pi*5*t)\" }]\n",
          100.0);
  ASSERT_EQ(moved.report.status, RunStatus::done);
  const auto [of_moved, size_of_moved] = moved.compared("m", [&](double t) { return forced(2.0, 10.0, w, t); });
  EXPECT_LT(of_moved, 1e-2 * size_of_moved);
}

// A force that the formula of a law brings along with its spring, a multiple of the steps' length apart from zero to
// zero: the same motion as under a [[force]].
TEST(FormulaThatSwings, ActsInALawOfAStructure) {
  const std::string law =
      "nonlinear_spring = [{ between = [\"m\", \"ground\"], force = \"60*u - 1000*sin(2*pi*5*t)\" }]\n";
  const Ran ran = run(oscillator(40.0, law), 100.0);
  ASSERT_EQ(ran.report.status, RunStatus::done);
  const auto [error, size] = ran.compared("m", [&](double t) { return forced(1000.0, 10.0, 10.0 * pi, t); });
  EXPECT_LT(error, 1e-2 * size);
  EXPECT_THAT(run(oscillator(40.0, law), 10.0, "0.1").report.warnings,
              Contains(HasSubstr("swings faster than steps of 0.1 s can follow; take 0.03")));
}

// An impulse of p tau sqrt(pi) at 25 s, of a formula without a switch; few steps for the rest of the run. Pulses below
// a millisecond lay between the samples of the size that loads promise: their first rise was large beside what had
// moved, and the run crawled.
TEST(FormulaThatSwings, ActsHoweverShortItsPulseIs) {
  for (const double tau : {1e-2, 2e-3, 2e-4, 2e-5}) {
    const std::string load = fmt::format("force = [{{ on = \"m\", expression = \"exp(-((t - 25)/{})^2)\" }}]\n", tau);
    const Ran ran = run(oscillator(1.0, load), 50.0);
    ASSERT_EQ(ran.report.status, RunStatus::done);
    const double impulse = tau * std::sqrt(pi);
    const auto [error, size] =
        ran.compared("m", [&](double t) { return t > 25.0 ? impulse * std::sin(t - 25.0) : 0.0; });
    EXPECT_LT(error, 1e-2 * size) << tau;
    EXPECT_LT(ran.steps, 3000.0) << tau;
  }
}

TEST(FormulaThatSwings, IsToldWhereEqualStepsPassOverIt) {
  const std::string sine = "force = [{ on = \"m\", expression = \"1000*sin(2*pi*5*t)\" }]\n";
  EXPECT_THAT(
      run(oscillator(100.0, sine), 10.0, "0.1").report.warnings,
      Contains(HasSubstr("the formula \"1000*sin(2*pi*5*t)\" swings faster than steps of 0.1 s can follow; take "
                         "0.03")));
  EXPECT_THAT(run(oscillator(100.0, sine), 10.0, "0.04").report.warnings, Not(Contains(HasSubstr("swings"))));
  const std::string harmonic = "force = [{ on = \"m\", amplitude = 1.0, frequency = 5.0 }]\n";
  EXPECT_THAT(run(oscillator(100.0, harmonic), 10.0, "0.1").report.warnings,
              Contains(HasSubstr("the harmonic load of 31.4159 rad/s swings faster than steps of 0.1 s can follow")));
  EXPECT_THAT(
      run(oscillator(100.0, sine), 10.0, "{ tolerance = 1e-3, controller = \"fixed\", first = 0.1 }").report.warnings,
      Contains(HasSubstr("swings faster than steps of 0.1 s can follow")));
  const std::string pulse = "force = [{ on = \"m\", expression = \"exp(-((t - 7.5)/0.002)^2)\" }]\n";
  EXPECT_THAT(run(oscillator(100.0, pulse), 10.0, "0.01").report.warnings, Contains(HasSubstr("from t = 7.49")));
}

TEST(FormulaThatSwings, IsToldWhereItCannotBeFollowed) {
  for (const std::string text : {"abs(sin(1e9*t))", "sin(1e9*t)"}) {
    const std::string load = "force = [{ on = \"m\", expression = \"" + text + "\" }]\n";
    EXPECT_THAT(run(oscillator(100.0, load), 10.0).report.warnings,
                Contains(HasSubstr("the formula \"" + text + "\" swings or switches too often")))
        << text;
    EXPECT_THAT(run(oscillator(100.0, load), 1.0, "{ tolerance = 1e-3, largest = 1e-3 }").report.warnings,
                Not(Contains(HasSubstr("swings"))));
  }
}

std::string hinge(const std::string& keys) {
  return "[[body]]\nname = \"arm\"\nmass = 1.0\ninertia = 1.0\nposition = [0.0, 0.0]\n"
         "[[joint]]\nname = \"pin\"\ntype = \"revolute\"\nbetween = [\"ground\", \"arm\"]\nat = [0.0, 0.0]\n" +
         keys +
         "\n[[analysis]]\nname = \"run\"\ntype = \"transient\"\nstep = { tolerance = 1e-3 }\nduration = 25.0\n"
         "output = { interval = 0.25 }\n";
}

// The moment passes what the pin holds, 0.9 N m, in each of the hundred half waves: it slips and holds again.
TEST(FormulaThatSwings, MovesADryHingeInEachHalfWave) {
  const testing::MechanismStudy ran(
      hinge("moment = \"sin(2*pi*2*t)\"\nfriction = { coefficient = 0.1, preload = 90, radius = 0.1 }"));
  ASSERT_EQ(ran.report.status, RunStatus::done) << ran.report.message;
  EXPECT_EQ(ran.table("run.events").rows.size(), 200u);
  EXPECT_NEAR(ran.at(0, "run.events", "time"), std::asin(0.9) / (4.0 * pi), 1e-6);
}

// A motor that turns by a formula, and a moment that is a pulse: both without a switch.
TEST(FormulaThatSwings, DrivesAJoint) {
  const double w = 2.0 * pi * 2.0;
  const testing::MechanismStudy motor(hinge("drive = \"0.1*sin(2*pi*2*t)\""));
  ASSERT_EQ(motor.report.status, RunStatus::done) << motor.report.message;
  EXPECT_LE(std::stod([&] {
              for (const auto& [key, value] : motor.report.statistics)
                if (key == "largest_step") return value;
              return std::string("1");
            }()),
            2.0 * pi / w / 6.0 * 1.01);
  const testing::MechanismStudy struck(hinge("moment = \"100*exp(-((t - 12.3)/0.001)^2)\""));
  ASSERT_EQ(struck.report.status, RunStatus::done) << struck.report.message;
  const double speed = 0.1 * std::sqrt(pi);  // of an inertia of 1 kg m2
  EXPECT_NEAR(struck.last("run", "angular_velocity", "pin"), speed, 1e-2 * speed);
}

// A pulse that is over within a thousandth of the longest step.
TEST(FormulaThatSwings, ActsInALawOfAMechanism) {
  const testing::MechanismStudy ran(
      "nonlinear_spring = [{ name = \"s\", joint = \"pin\", force = \"u - 100*exp(-((t - 12.3)/0.001)^2)\" }]\n" +
      hinge(""));
  ASSERT_EQ(ran.report.status, RunStatus::done) << ran.report.message;
  const double impulse = 0.1 * std::sqrt(pi);  // on 1 kg m2 and 1 N m/rad
  EXPECT_NEAR(ran.last("run", "angle", "pin"), impulse * std::sin(25.0 - 12.3), 1e-2 * impulse);
  EXPECT_NEAR(ran.last("run", "angular_velocity", "pin"), impulse * std::cos(25.0 - 12.3), 1e-2 * impulse);
}

}  // namespace
}  // namespace rubato::analysis
