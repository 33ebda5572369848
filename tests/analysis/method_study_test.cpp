#include <rubato/analysis/method_study.hpp>
#include <rubato/integrate/kinds/structure_kind.hpp>

#include "support/memory_sink.hpp"
#include "support/models.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace rubato::analysis {
namespace {

struct RecordingProgress final : Progress {
  void begin(const std::string&, double all, const std::string&) override { total = all; }
  void advance(double to) override {
    EXPECT_GE(to, done);
    done = to;
  }
  void end() override { has_ended = true; }
  double total = 0.0, done = 0.0;
  bool has_ended = false;
};

struct Recorded {
  testing::MemorySink sink;
  RunReport report;
  RecordingProgress progress;
};

Recorded run(const system::LocallyNonlinear& system, const model::MethodStudyDescription& study, bool stopped = false) {
  Recorded result;
  const std::atomic<bool> stop{stopped};
  RunContext context{result.sink, result.progress, stop};
  const integrate::StructureKind kind(system);
  result.report = run_method_study("study", plan_method_study("study", {}, study, kind, {}), kind, context);
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
  EXPECT_TRUE(result.progress.has_ended);
}

struct Correct {
  const char* method;
  double first, largest;
  int order;
};

// The second table of the reference page (its section 1), to the digits given there: 6e-7 is half a unit of the seventh
// digit. x(h) is 5e-5, of which round-off of the march is 1e-16: 1e-11 of the first error is allowed, which only RK4's
// feels. x_max = 0.355015365305304 m lies between samples: a search among the samples alone misses it by 2e-6.
TEST(MethodStudy, GivesTheCorrectFiguresOfTheThesisModel) {
  const Correct expected[] = {{"explicit_euler", 1, 2.186460e-2, 1},
                              {"rk3", 8.375339e-8, 2.283112e-7, 3},
                              {"rk4", 1.392559e-10, 2.295383e-10, 4},
                              {"central_difference", 3.377955e-3, 6.846548e-5, 2},
                              {"fox_goodwin", 1.672394e-3, 3.475697e-5, 2},
                              {"linear_acceleration", 3.313838e-5, 4.043069e-5, 2},
                              {"average_acceleration", 1.738643e-3, 7.174694e-5, 2},
                              {"galerkin", 1.283297e-2, 2.711800e-2, 1},
                              {"backward_difference", 1.688530e-2, 2.717203e-2, 1},
                              {"damped_newmark", 2.806942e-3, 2.740421e-3, 1},
                              {"wilson_theta", 3.295211e-5, 1.122193e-4, 2}};
  auto study = study_of(0.01, 50.0);
  study.ladder = {model::Quantity(0.01)};
  const Recorded result = run(testing::single_mass(), study);
  const auto& table = result.sink.tables.at("study");
  const auto& names = table.layout.blocks[0].categories;
  for (const Correct& e : expected) {
    const auto place = std::find(names.begin(), names.end(), e.method);
    ASSERT_NE(place, names.end()) << e.method;
    const auto& row = table.rows.at(static_cast<std::size_t>(place - names.begin()));
    EXPECT_NEAR(row[table.column("first_step_error")], e.first, 6e-7 * e.first + 1e-11) << e.method;
    EXPECT_NEAR(row[table.column("max_error")], e.largest, 6e-7 * e.largest + 1e-13) << e.method;
    EXPECT_EQ(row[table.column("order")], e.order) << e.method;
    // Methods of order 1 are 0.3 % off their limit at these steps, the others less.
    EXPECT_NEAR(row[table.column("observed_order")], e.order, 0.01) << e.method;
  }
  EXPECT_EQ(result.progress.done, result.progress.total);
}

/// What the errors of a study are divided by: the largest difference of a method in the response, over its error.
double reference_size(const system::LocallyNonlinear& system, const model::MethodStudyDescription& study) {
  const Recorded result = run(system, study);
  const auto &errors = result.sink.tables.at("study"), &response = result.sink.tables.at("study.response");
  double largest = 0.0;
  for (const auto& row : response.rows)
    largest = std::max(largest, std::abs(row[response.column("difference", "average_acceleration")]));
  return largest / errors.rows.at(0)[errors.column("max_error")];
}

// Two equal masses between walls and to each other move together with w1 = 1 rad/s and against each other with
// w2 = 40 rad/s; at quarters of the step the fast mode has turned by 5 rad. From x = 0 and velocities v1 + v2, v1 - v2
// the first moves by v1/w1 sin(w1 t) + v2/w2 sin(w2 t), and their distance by 2 v2/w2 sin(w2 t). What is allowed is the
// round-off of four hundred pieces.
TEST(MethodStudy, RelatesErrorsToTheLargestDisplacementWhereModesAreFasterThanTheStep) {
  constexpr double slow = 1.0, fast = 40.0, v1 = 0.7, v2 = 9.0, duration = 20.0;
  const double wall = slow * slow, between = 0.5 * (fast * fast - wall);
  system::LocallyNonlinear::Parts parts;
  parts.mass = testing::sparse(Matrix::Identity(2, 2));
  parts.damping = SparseMatrix(2, 2);
  parts.stiffness = testing::sparse((Matrix(2, 2) << wall + between, -between, -between, wall + between).finished());
  parts.start.q = Vector::Zero(2);
  parts.start.v = (Vector(2) << v1 + v2, v1 - v2).finished();
  parts.coordinates = {"a", "b"};
  const system::LocallyNonlinear system(std::move(parts));
  auto study = study_of(0.5, duration);
  study.methods.resize(1);
  study.methods[0].name = "average_acceleration";
  study.ladder = {model::Quantity(0.5)};

  // Between samples h apart the largest may be higher by (w2 h)^2/8 of the fast part: 8e-12 of it.
  constexpr double h = 2e-7;
  double largest = 0.0;
  for (double coarse = 0.0; coarse < duration; coarse += 1e-3) {
    const auto x = [](double t) { return std::abs(v1 / slow * std::sin(slow * t) + v2 / fast * std::sin(fast * t)); };
    // The slope is at most v1 + v2: from below a thousandth of a second leads no higher.
    if (x(coarse) < largest - 1e-3 * (v1 + v2)) continue;
    for (double t = coarse; t < std::min(coarse + 1e-3, duration); t += h) largest = std::max(largest, x(t));
  }
  EXPECT_NEAR(reference_size(system, study), largest, 1e-11 * largest);

  study.observe = model::ObservationDescription{"a", "b", {}};
  EXPECT_NEAR(reference_size(system, study), 2.0 * v2 / fast, 1e-11);
}

// x'' + x = cos t from rest: x = t/2 sin t. Round-off of some hundred Taylor pieces of numbers of at most 25.
TEST(MethodStudy, KnowsTheResponseAtResonanceWithoutDamping) {
  auto study = study_of(0.05, 50.0);
  study.ladder = {model::Quantity(0.05)};
  const Recorded result = run(testing::single_mass(0.0, 1.0, 0.0), study);
  const auto& table = result.sink.tables.at("study.response");
  const std::size_t exact = table.column("position", "exact");
  ASSERT_EQ(table.rows.size(), 1001u);
  const std::size_t rk4 = table.column("position", "rk4"), difference = table.column("difference", "rk4");
  for (const auto& row : table.rows) {
    EXPECT_NEAR(row[exact], 0.5 * row[0] * std::sin(row[0]), 1e-12) << row[0];
    EXPECT_EQ(row[difference], row[rk4] - row[exact]);
  }
}

TEST(MethodStudy, LowersTheErrorOfRungeKutta4ToRoundOff) {
  const Recorded result = run(testing::single_mass(), study_of(0.01, 50.0));
  const auto& table = result.sink.tables.at("study.ladder");
  const std::size_t rk4 = table.column("max_error", "rk4");
  double least = 1.0;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const double error = table.rows[i][rk4];
    // Until round-off takes over every halving divides the error by 16; 20 % at the coarsest steps.
    if (i > 0 && error > 1e-11) {
      EXPECT_NEAR(table.rows[i - 1][rk4] / error, 16.0, 3.2) << table.rows[i][0];
    }
    least = std::min(least, error);
  }
  EXPECT_LT(least, 1e-13);
  EXPECT_LT(table.rows.back()[0], 1e-4);
}

// lambda = -1/2 +- i sqrt(3)/2: |1 + h lambda|^2 = 1 - h + h^2 is 1 at h = 1. At h = 1.1 it is 1.11, so that 45 steps
// (50 s) grow by 1.11^22 = 10.
TEST(MethodStudy, ShowsExplicitEulerBeyondItsLimit) {
  auto study = study_of(0.01, 50.0);
  study.ladder = {model::Quantity(0.01)};
  const Recorded result = run(testing::single_mass(), study);
  const auto& table = result.sink.tables.at("study.unstable");
  const std::size_t euler = table.column("position", "explicit_euler");
  ASSERT_GT(table.rows.size(), 40u);
  EXPECT_EQ(table.rows[0], (std::vector<double>{0.0, 0.0, 0.0, 0.0}));
  EXPECT_NEAR(table.rows[1][0], 1.1, 1e-6);
  double early = 0.0, late = 0.0;
  for (const auto& row : table.rows) {
    if (row[0] < 8.0) early = std::max(early, std::abs(row[euler]));
    if (row[0] > 42.0) late = std::max(late, std::abs(row[euler]));
  }
  EXPECT_GT(late, 4.0 * early);
}

// The trapezoidal rule turns a mode by 2 atan(omega h / 2) a step and neither damps nor drives it.
TEST(MethodStudy, DrawsThePeriodElongationOfAverageAcceleration) {
  auto study = study_of(0.1, 10.0);
  study.methods.resize(1);
  study.methods[0].name = "average_acceleration";
  study.ladder = {model::Quantity(0.1)};
  const Recorded result = run(testing::single_mass(), study);
  const auto& table = result.sink.tables.at("study.stability");
  ASSERT_EQ(table.rows.size(), 200u);
  for (const auto& row : table.rows) {
    const double x = row[0];  // eigenvalues of a 3 x 3 matrix: round-off, magnified where the pair nearly meets at -1
    EXPECT_NEAR(row[table.column("spectral_radius", "average_acceleration")], 1.0, 1e-10) << x;
    EXPECT_NEAR(row[table.column("period_elongation", "average_acceleration")], x / (2.0 * std::atan(0.5 * x)) - 1.0,
                1e-10)
        << x;
    EXPECT_NEAR(row[table.column("numerical_damping", "average_acceleration")], 0.0, 1e-10) << x;
  }
}

model::MethodDescription newmark(double beta, double gamma) {
  model::MethodDescription method;
  method.name = "newmark";
  method.parameters = {{"beta", beta}, {"gamma", gamma}};
  return method;
}

// The order is 1 whenever gamma is not 1/2, whatever the name.
TEST(MethodStudy, ComparesAMethodWithItself) {
  auto study = study_of(0.01, 10.0);
  study.methods = {newmark(0.25, 0.5), newmark(0.3025, 0.6)};
  study.ladder = {model::Quantity(0.01)};
  const Recorded result = run(testing::single_mass(), study);
  const auto& table = result.sink.tables.at("study");
  EXPECT_EQ(table.layout.blocks[0].categories,
            (std::vector<std::string>{"newmark(beta=0.25;gamma=0.5)", "newmark(beta=0.3025;gamma=0.6)"}));
  ASSERT_EQ(table.rows.size(), 2u);
  EXPECT_EQ(table.rows[0][table.column("order")], 2.0);
  EXPECT_EQ(table.rows[1][table.column("order")], 1.0);
}

// A structure at rest without load: there is nothing to relate an error to, and nothing infinite comes of it.
TEST(MethodStudy, WritesNothingInfiniteWhereNothingMoves) {
  system::LocallyNonlinear::Parts parts;
  parts.mass = parts.stiffness = testing::sparse(Matrix::Identity(1, 1));
  parts.damping = testing::sparse(0.1 * Matrix::Identity(1, 1));
  parts.coordinates = {"mass"};
  const Recorded result = run(system::LocallyNonlinear(std::move(parts)), study_of(0.05, 5.0));
  EXPECT_EQ(result.report.status, RunStatus::done);
  for (const auto& [name, table] : result.sink.tables)
    for (const auto& row : table.rows)
      for (const double value : row) EXPECT_FALSE(std::isinf(value)) << name;
  for (const auto& row : result.sink.tables.at("study").rows) {
    EXPECT_TRUE(std::isnan(row[result.sink.tables.at("study").column("first_step_error")]));
    EXPECT_EQ(row[result.sink.tables.at("study").column("max_error")], 0.0);
  }
}

std::string refusal(const system::LocallyNonlinear& system, const model::MethodStudyDescription& study) {
  try {
    (void)plan_method_study("study", {}, study, integrate::StructureKind(system), {});
  } catch (const InvalidInput& fault) {
    return fault.message();
  }
  return "accepted";
}

TEST(MethodStudy, RefusesWhatItCannotCompare) {
  const auto system = testing::single_mass();
  auto study = study_of(0.01, 50.0);
  study.methods.resize(1);
  study.methods[0].name = "exact";
  EXPECT_EQ(refusal(system, study),
            "analysis \"study\": the method exact takes no step; it is what the others are compared with");
  study.methods = {newmark(0.25, 0.5), newmark(0.25, 0.5)};
  EXPECT_EQ(refusal(system, study), "analysis \"study\": the method newmark(beta=0.25;gamma=0.5) is listed twice");

  // Central difference: omega h <= 2, which damping does not change.
  study = study_of(2.5, 50.0);
  study.methods.resize(1);
  study.methods[0].name = "central_difference";
  EXPECT_EQ(refusal(system, study),
            "analysis \"study\": central_difference is stable up to the step 2 s on this model, the study takes 2.5 s");
  study.methods[0].name = "heun";
  EXPECT_EQ(refusal(testing::single_mass(0.0, 2.0, 0.0), study),
            "analysis \"study\": heun has no stable step on this model");

  study = study_of(0.01, 50.0);
  study.observe = model::ObservationDescription{"mas", "", {}};
  EXPECT_EQ(refusal(system, study),
            "observe names \"mas\", which is no coordinate; did you mean \"mass\"? (known: mass)");
}

TEST(MethodStudy, RefusesStepsAndDurationsThatAreNone) {
  const auto system = testing::single_mass();
  EXPECT_EQ(refusal(system, study_of(0.0, 50.0)), "analysis \"study\": step must be positive, got 0");
  EXPECT_EQ(refusal(system, study_of(0.01, -1.0)), "analysis \"study\": duration must be positive, got -1");
  EXPECT_EQ(refusal(system, study_of(0.3, 1.0)),
            "analysis \"study\": the duration 1 s must be a multiple of the step 0.3 s");
  EXPECT_NE(refusal(system, study_of(std::numeric_limits<double>::quiet_NaN(), 50.0)), "accepted");
  auto study = study_of(0.01, 50.0);
  study.ladder = {model::Quantity(0.01), model::Quantity(60.0)};
  EXPECT_EQ(refusal(system, study),
            "analysis \"study\": ladder: 60 s makes 0.8333333333333334 steps; take from 1 to 1e7");
}

TEST(MethodStudy, RefusesALoadWithoutAClosedForm) {
  system::LocallyNonlinear::Parts parts;
  parts.mass = parts.stiffness = parts.damping = testing::sparse(Matrix::Identity(1, 1));
  parts.coordinates = {"mass"};
  model::TableLaw table;
  table.times = {0.0, 100.0};
  table.values = {0.0, 1.0};
  parts.loads = system::Loads({{{0}, {1.0}, table}});
  EXPECT_EQ(refusal(system::LocallyNonlinear(std::move(parts)), study_of(0.01, 50.0)),
            "analysis \"study\": a method study needs harmonic loads, whose response has a closed form");
}

TEST(MethodStudy, RefusesAModelWithSliders) {
  try {
    const auto system = testing::single_mass(0.15);
    (void)plan_method_study("study", {"study.toml", 9, 1}, study_of(0.01, 50.0), integrate::StructureKind(system), {});
    FAIL() << "accepted";
  } catch (const InvalidInput& fault) {
    EXPECT_STREQ(fault.what(),
                 "study.toml:9:1: error: analysis \"study\": a method study needs a linear model with a closed-form "
                 "response, this one has 1 slider(s)");
  }
}

}  // namespace
}  // namespace rubato::analysis
