#include <rubato/analysis/automatic_step.hpp>
#include <rubato/analysis/transient.hpp>
#include <rubato/integrate/kinds/structure_kind.hpp>

#include "support/free_vibration.hpp"
#include "support/memory_sink.hpp"
#include "support/models.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <string>

namespace rubato::analysis {
namespace {

using Kind = model::OutputDescription::Kind;

struct Recorded {
  testing::MemorySink sink;
  RunReport report;

  std::vector<double> column(const std::string& variable, const std::string& label = "",
                             const std::string& name = "run") const {
    const auto& table = sink.tables.at(name);
    std::vector<double> values;
    for (const auto& row : table.rows) values.push_back(row[table.column(variable, label)]);
    return values;
  }
  std::string statistic(const std::string& name) const {
    for (const auto& [key, value] : report.statistics)
      if (key == name) return value;
    return "none";
  }
};

Recorded run(const system::LocallyNonlinear& system, const model::TransientDescription& description) {
  Recorded result;
  testing::QuietProgress progress;
  const std::atomic<bool> stop{false};
  RunContext context{result.sink, progress, stop};
  result.report = run_transient("run", plan_transient("run", {}, description, integrate::StructureKind(system), {}),
                                integrate::StructureKind(system), context);
  return result;
}

model::TransientDescription description(double tolerance, double duration, const std::string& method) {
  model::TransientDescription transient;
  transient.method.name = method;
  transient.automatic_step.emplace();
  transient.automatic_step->tolerance = tolerance;
  transient.duration = duration;
  return transient;
}

// A method of first order damps what it looks at: the jump of its inertia forces says nothing of that error, which was
// 15 to 66 percent at any tolerance in a damped frame.
TEST(InertiaJump, IsRefusedForMethodsOfFirstOrder) {
  for (const char* method : {"galerkin", "backward_difference", "damped_newmark"}) {
    auto d = description(1e-3, 1.0, method);
    d.automatic_step->estimator = "inertia_jump";
    d.automatic_step->reference = model::Quantity(0.1);
    try {
      (void)run(testing::single_mass(0.15), d);
      FAIL() << method << " is accepted";
    } catch (const InvalidInput& fault) {
      EXPECT_EQ(fault.message(),
                "analysis \"run\": step: the estimator inertia_jump measures the error of methods of second order, and "
                "this one is of "
                "first; take the estimator local_error");
    }
    d.automatic_step->estimator.clear();
    d.automatic_step->reference.reset();
    d.automatic_step->controller = "cardona_cassano";
    EXPECT_EQ(run(testing::single_mass(0.15), d).report.status, RunStatus::done) << method;
  }
}

TEST(StepTable, HoldsEveryTryAndItsAcceptedStepsFillTheRun) {
  auto d = description(1e-3, 20.0, "generalized_alpha");
  d.automatic_step->controller = "cardona_cassano";
  d.automatic_step->estimator = "inertia_jump";
  d.automatic_step->reference = model::Quantity(0.1);
  const Recorded result = run(testing::single_mass(0.15), d);
  const auto t = result.column("time", "", "run.steps"), h = result.column("step", "", "run.steps"),
             error = result.column("error", "", "run.steps"), accepted = result.column("accepted", "", "run.steps");
  double reached = 0.0;
  long steps = 0;
  for (std::size_t i = 0; i < t.size(); ++i) {
    ASSERT_NEAR(t[i], reached, 1e-12);
    ASSERT_EQ(accepted[i] == 1.0, error[i] <= 1e-3);
    if (accepted[i] == 0.0) continue;
    reached += h[i];
    ++steps;
  }
  EXPECT_NEAR(reached, 20.0, 1e-12);
  EXPECT_EQ(result.statistic("steps"), std::to_string(steps));
  EXPECT_EQ(result.statistic("rejected"), std::to_string(static_cast<long>(t.size()) - steps));
  EXPECT_NE(result.statistic("rejected"), "0");
  EXPECT_EQ(result.statistic("solves"), std::to_string(t.size()));
}

// Values between steps carry an error of the order of the method: five times the tolerance bounds displacement,
// velocity over omega and acceleration over omega^2 (their errors are those of the displacement but for phase), and a
// hundredth of the tolerance makes them a hundred times smaller.
TEST(DenseOutput, IsOfTheOrderOfTheMethodAndDoesNotBendTheSteps) {
  const auto system = testing::oscillator(1000.0);
  const testing::FreeVibration truth(system);
  for (const std::string method : {"generalized_alpha", "average_acceleration", "wilson_theta", "dormand_prince"}) {
    std::map<double, std::vector<double>> errors;
    // Dormand-Prince meets looser ones at its stability limit already.
    const double loose = method == "dormand_prince" ? 1e-4 : 1e-2, tight = 0.01 * loose;
    for (const double tolerance : {loose, tight}) {
      auto d = description(tolerance, 1.0, method);
      const Recorded every = run(system, d);
      d.output.kind = Kind::times;
      for (int i = 1; i <= 97; ++i) d.output.times.emplace_back(0.0103 * i);
      const Recorded between = run(system, d);
      EXPECT_EQ(between.column("time", "", "run.steps"), every.column("time", "", "run.steps"));
      const auto t = between.column("time");
      ASSERT_EQ(t.size(), 97u);
      int order = 0;
      for (const char* variable : {"position", "velocity", "acceleration"}) {
        const auto values = between.column(variable, "x1");
        double largest = 0.0;
        for (std::size_t i = 0; i < t.size(); ++i)
          largest = std::max(largest, std::abs(values[i] - truth.at(t[i], order)[0]));
        largest /= 0.01 * std::pow(1000.0, 0.5 * order++);
        EXPECT_LT(largest, 5.0 * tolerance) << method << " " << variable;
        errors[tolerance].push_back(largest);
      }
    }
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_NEAR(std::log10(errors[loose][i] / errors[tight][i]), 2.0, 0.3) << method;
  }
}

// At the limit itself the velocity of the fastest mode grows with every step: accelerations were 300 and 1800 times the
// largest of the motion, while displacements kept to their tolerance.
TEST(AutomaticStep, LightMassesDoNotTrembleWhereStabilityLimitsTheSteps) {
  system::LocallyNonlinear::Parts parts;
  Matrix mass = Matrix::Identity(2, 2), stiffness(2, 2);
  mass(1, 1) = 0.01;
  stiffness << 1.0 + 1e5, -1e5, -1e5, 1e5;
  parts.mass = testing::sparse(mass);
  parts.damping = testing::sparse(Matrix::Zero(2, 2));
  parts.stiffness = testing::sparse(stiffness);
  parts.loads =
      system::Loads({{{1}, {1.0}, model::TableLaw{{0.0, 7.3, 15.1, 31.7, 60.0}, {0.0, 1.0, -0.5, 0.7, 0.0}}}});
  parts.coordinates = {"a", "b"};
  const system::LocallyNonlinear system(std::move(parts));
  for (const std::string method : {"linear_acceleration", "central_difference"}) {
    const Recorded result = run(system, description(1e-2, 50.0, method));
    ASSERT_EQ(result.report.status, RunStatus::done) << method;
    for (const double a : result.column("acceleration", "b")) ASSERT_LT(std::abs(a), 1.0) << method;
  }
}

TEST(AutomaticStep, SaysWhyARunEndedForWantOfSmallerSteps) {
  auto d = description(1e-6, 20.0, "hht");
  d.automatic_step->smallest = model::Quantity(0.05);
  const Recorded result = run(testing::single_mass(), d);
  EXPECT_EQ(result.report.status, RunStatus::failed);
  EXPECT_NE(result.report.message.find("the error asked for a step below the smallest"), std::string::npos);
  EXPECT_NE(result.report.message.find("the study sets smallest = 0.05 s: make it smaller"), std::string::npos)
      << result.report.message;
  d.automatic_step->largest = model::Quantity(0.05);
  const Recorded cramped = run(testing::single_mass(), d);
  EXPECT_NE(cramped.report.message.find("smallest and largest are both 0.05 s"), std::string::npos)
      << cramped.report.message;
}

// A load that turns infinite: the step is halved until nothing is left to halve, and what was computed is kept.
TEST(AutomaticStep, HalvesBeforeALoadThatIsNotFiniteAndKeepsWhatItHas) {
  system::LocallyNonlinear::Parts parts;
  parts.mass = parts.stiffness = testing::sparse(Matrix::Identity(1, 1));
  parts.damping = SparseMatrix(1, 1);
  parts.loads = system::Loads({{{0}, {1.0}, model::FormulaLaw{numerics::Formula("sqrt(1-t)", {}, true)}}});
  parts.coordinates = {"a"};
  const system::LocallyNonlinear system(std::move(parts));
  const Recorded result = run(system, description(1e-3, 2.0, "generalized_alpha"));
  EXPECT_EQ(result.report.status, RunStatus::failed);
  EXPECT_NE(result.report.message.find("not finite appeared at coordinate \"a\""), std::string::npos);
  EXPECT_NEAR(result.column("time").back(), 1.0, 1e-6);
  EXPECT_GT(std::stol(result.statistic("failed")), 5);
}

/// The largest difference of the positions of a mass with a slider from those of the exact flow, over the largest.
double error_of_pair(const std::string& method, double tolerance, std::optional<bool> locate) {
  const auto system = testing::single_mass(0.15);
  auto d = description(tolerance, 50.0, method);
  d.automatic_step->locate_events = locate;
  d.output.kind = Kind::interval;
  d.output.interval = model::Quantity(0.5);
  auto exact = d;
  exact.method.name = "exact";
  exact.automatic_step.reset();
  const auto x = run(system, d).column("position", "mass"), truth = run(system, exact).column("position", "mass");
  EXPECT_EQ(x.size(), truth.size());
  double error = 0.0, size = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    error = std::max(error, std::abs(x[i] - truth[i]));
    size = std::max(size, std::abs(truth[i]));
  }
  return error / size;
}

// Within a step a transition costs what the order of a pair cannot see: errors of 1e-3 at any tolerance.
TEST(EmbeddedPairs, MeetTheirToleranceWithASliderSinceTheyLocateIt) {
  for (const char* method : {"dormand_prince", "bogacki_shampine"})
    for (const double tolerance : {1e-3, 1e-4, 1e-5})
      EXPECT_LT(error_of_pair(method, tolerance, std::nullopt), 10.0 * tolerance) << method << " at " << tolerance;
  EXPECT_GT(error_of_pair("dormand_prince", 1e-5, false), 10.0 * 1e-5);
}

TEST(FixedController, SaysThatTheToleranceIsNotMet) {
  auto d = description(1e-4, 50.0, "generalized_alpha");
  d.automatic_step->controller = "fixed";
  d.automatic_step->first = model::Quantity(0.1);
  const Recorded coarse = run(testing::single_mass(), d);
  ASSERT_EQ(coarse.report.warnings.size(), 1u);
  EXPECT_NE(coarse.report.warnings[0].find("the tolerance 0.0001 is not met"), std::string::npos);
  d.automatic_step->first = model::Quantity(0.002);
  EXPECT_TRUE(run(testing::single_mass(), d).report.warnings.empty());
  EXPECT_TRUE(run(testing::single_mass(), description(1e-4, 50.0, "generalized_alpha")).report.warnings.empty());
}

}  // namespace
}  // namespace rubato::analysis
