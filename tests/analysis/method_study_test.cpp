#include <rubato/analysis/as_printed.hpp>
#include <rubato/analysis/method_study.hpp>

#include "support/memory_sink.hpp"
#include "support/models.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <string>

namespace rubato::analysis {
namespace {

struct Printed {
  const char* title;
  double first, indicator;
};

// Tables 2.2 to 2.4 of the thesis, typed in from the reference page (its section 1). The indicator is a mean of 30,000
// relative errors, some at samples where |x| is 1e-5 and round-off of x counts 1e-11 of the error: 9 digits are
// derived. The first-step errors of Runge-Kutta are differences of numbers of 5e-5 printed to 15 digits:
// 1e-16/5e-5/3e-5 = 6e-8.
TEST(AsPrinted, GivesEveryFigureOfTheThesis) {
  const Printed expected[] = {{"Explicit Euler", 0.496577062986900, 0.155825462554500},
                              {"Runge-Kutta 3", 3.33618998200748e-05, 0.0950286327386840},
                              {"Runge-Kutta 4", 3.33618998200748e-05, 0.0950278042413737},
                              {"Central difference", 0.337795508343150, 0.0108389543480367},
                              {"Fox-Goodwin", 0.167239420905934, 0.0112241322129539},
                              {"Linear acceleration", 0.00331383811901593, 0.0157695782252880},
                              {"Trapezoid", 0.173864268802085, 0.0221104353803482},
                              {"Linear acceleration II", 0.344411871213617, 0.0287000192395950},
                              {"Constant mean acceleration", 0.685498591503419, 0.0420788539145178},
                              {"Galerkin", 2.90413438661185, 13.2156978423172},
                              {"Backward difference", 3.71445719083257, 13.2064785366307},
                              {"Damped Newmark", 0.280694193836027, 1.32347442541348},
                              {"Wilson-theta", 0.00329521130941751, 0.0641153235971903}};
  const auto rows = tables_as_printed(testing::single_mass(), 0.01);
  ASSERT_EQ(rows.size(), std::size(expected));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i].title, expected[i].title);
    EXPECT_NEAR(rows[i].first_step_error, expected[i].first,
                std::max(1e-9 * expected[i].first, 4e-12 * (i < 3 ? 1 : 100)))
        << rows[i].title;
    EXPECT_NEAR(rows[i].indicator, expected[i].indicator, 1e-9 * expected[i].indicator) << rows[i].title;
  }
}

struct Recorded {
  testing::MemorySink sink;
  RunReport report;
};

Recorded run(const system::LocallyNonlinear& system, const model::MethodStudyDescription& study, bool stopped = false) {
  Recorded result;
  testing::QuietProgress progress;
  const std::atomic<bool> stop{stopped};
  RunContext context{result.sink, progress, stop};
  result.report = run_method_study("study", study, system, {}, context);
  return result;
}

model::MethodStudyDescription study_of(double step, double duration) {
  model::MethodStudyDescription study;
  study.step = step;
  study.duration = duration;
  return study;
}

// Two masses, non-proportional damping, two frequencies: the orders are those of the catalogue.
TEST(MethodStudy, ObservesTheOrderOfEveryMethodOnAModelOfItsOwn) {
  system::LocallyNonlinear::Parts parts;
  Matrix m(2, 2), c(2, 2), k(2, 2);
  m << 2.0, 0.3, 0.3, 1.0;
  c << 0.5, -0.2, -0.2, 0.3;
  k << 5.0, -2.0, -2.0, 3.0;
  parts.mass = testing::sparse(m);
  parts.damping = testing::sparse(c);
  parts.stiffness = testing::sparse(k);
  parts.loads = system::Loads({testing::harmonic(0, 1.0, 1.1), testing::harmonic(1, -2.0, 2.3, 0.4)});
  parts.start.q = Vector::Constant(2, 0.2);
  parts.coordinates = {"a", "b"};
  const system::LocallyNonlinear system(std::move(parts));
  auto study = study_of(0.02, 10.0);
  study.ladder = {model::Quantity(0.02)};
  study.observe = model::ObservationDescription{"a", "b", {}};
  const Recorded result = run(system, study);
  EXPECT_EQ(result.report.status, RunStatus::done);
  const auto& table = result.sink.tables.at("study");
  const std::size_t order = table.column("order"), observed = table.column("observed_order");
  EXPECT_GE(table.rows.size(), 18u);
  for (const auto& row : table.rows) {
    if (!std::isfinite(row[observed])) continue;  // at round-off already
    EXPECT_NEAR(row[observed], row[order], 0.15) << table.layout.blocks[0].categories[static_cast<std::size_t>(row[0])];
  }
}

TEST(MethodStudy, LeavesOutWhatIsUnstableAtTheStepAndSaysSo) {
  const Recorded result = run(testing::single_mass(0.0, 1.5, 0.0), study_of(0.1, 20.0));
  const auto& names = result.sink.tables.at("study").layout.blocks[0].categories;
  EXPECT_EQ(std::count(names.begin(), names.end(), "explicit_euler"), 0);
  ASSERT_FALSE(result.report.statistics.empty());
  EXPECT_EQ(result.report.statistics.back().second, "unstable at this step: explicit_euler, heun, midpoint, ralston");
}

TEST(MethodStudy, StopsWhenAsked) {
  const Recorded result = run(testing::single_mass(), study_of(0.01, 50.0), true);
  EXPECT_EQ(result.report.status, RunStatus::interrupted);
}

TEST(MethodStudy, RefusesAModelWithSliders) {
  try {
    check_method_study("study", {"study.toml", 9, 1}, study_of(0.01, 50.0), testing::single_mass(0.15), {});
    FAIL() << "accepted";
  } catch (const InvalidInput& fault) {
    EXPECT_STREQ(fault.what(),
                 "study.toml:9:1: error: analysis \"study\": a method study needs a linear model with a closed-form "
                 "response, this one has 1 slider(s)");
  }
}

}  // namespace
}  // namespace rubato::analysis
