#include <rubato/analysis/transient.hpp>
#include <rubato/integrate/kinds/structure_kind.hpp>
#include <rubato/system/assemble.hpp>

#include "support/memory_sink.hpp"
#include "support/models.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <string>

namespace rubato::analysis {
namespace {

using Kind = model::OutputDescription::Kind;

struct Recorded {
  testing::MemorySink sink;
  RunReport report;

  const testing::MemorySink::Table& table(const std::string& name = "run") const { return sink.tables.at(name); }
  std::vector<double> column(const std::string& variable, const std::string& label = "",
                             const std::string& name = "run") const {
    std::vector<double> values;
    const std::size_t place = table(name).column(variable, label);
    for (const auto& row : table(name).rows) values.push_back(row[place]);
    return values;
  }
};

model::TransientDescription description(const std::string& method, double step, double duration) {
  model::TransientDescription d;
  d.method.name = method;
  d.step = model::Quantity(step);
  d.duration = duration;
  return d;
}

Recorded run(const system::LocallyNonlinear& system, const model::TransientDescription& d) {
  Recorded result;
  testing::QuietProgress progress;
  const std::atomic<bool> stop{false};
  RunContext context{result.sink, progress, stop};
  result.report = run_transient("run", plan_transient("run", {}, d, integrate::StructureKind(system), {}),
                                integrate::StructureKind(system), context);
  return result;
}

// With average acceleration dq = h (v0 + v1)/2, so that every term of the balance is booked with the motion that the
// method made: what is left is the round-off of 6000 steps with energies of some 100 J.
TEST(EnergyLedger, ClosesToRoundOffWithAverageAccelerationUnderLoadsDampersAndSliders) {
  const auto system = testing::damper_model(10.0, 7.7, -8.0);
  const Recorded result = run(system, description("average_acceleration", 0.01, 60.0));
  ASSERT_EQ(result.report.status, RunStatus::done);
  const auto residue = result.column("residue", "", "run.energy");
  const auto work = result.column("load_work", "", "run.energy");
  const auto slip = result.column("slider_dissipated", "", "run.energy");
  ASSERT_EQ(residue.size(), 6001u);
  EXPECT_GT(work.back(), 100.0);
  EXPECT_GT(slip.back(), 10.0);
  for (const double r : residue) ASSERT_NEAR(r, 0.0, 1e-11 * work.back());
}

// A method with numerical damping loses energy, and the ledger says so.
TEST(EnergyLedger, ShowsWhatDampedNewmarkLoses) {
  const Recorded result = run(testing::damper_model(10.0, 7.7, -8.0), description("damped_newmark", 0.01, 60.0));
  const auto residue = result.column("residue", "", "run.energy");
  EXPECT_LT(residue.back(), -1.0);
}

TEST(Transient, RecordsTheReturnMapAndTheSlip) {
  const auto system = testing::single_mass(0.15);
  const Recorded result = run(system, description("generalized_alpha", 0.01, 20.0));
  const auto force = result.column("force", "contact"), slip = result.column("slip", "contact");
  const auto x = result.column("position", "mass");
  double largest = 0.0;
  for (std::size_t i = 0; i < force.size(); ++i) {
    largest = std::max(largest, std::abs(force[i]));
    ASSERT_NEAR(slip[i], x[i] - force[i], 1e-15);  // kT = 1
  }
  EXPECT_EQ(largest, 0.15);  // on the limit, not near it
}

TEST(Transient, ReportsTheAccelerationOfEquilibrium) {
  const Recorded result = run(testing::single_mass(), description("generalized_alpha", 0.05, 5.0));
  const auto t = result.column("time"), x = result.column("position", "mass"), v = result.column("velocity", "mass"),
             a = result.column("acceleration", "mass");
  for (std::size_t i = 0; i < t.size(); ++i) ASSERT_NEAR(a[i] + v[i] + x[i], std::cos(2.0 * t[i]), 1e-14);
}

// Values between steps: the quintic's error, h^6 max|q^(6)|/46080 < 1e-9 at h = 0.05, vanishes beside that of the
// method; samples of a run whose steps fall on the same times differ only by it.
TEST(Transient, InterpolatesBetweenStepsAboveTheOrderOfTheMethod) {
  const auto system = testing::single_mass();
  auto d = description("rk4", 0.05, 10.0);
  d.output.kind = Kind::interval;
  d.output.interval = 0.0125;
  const Recorded between = run(system, d);
  const Recorded fine = run(system, description("rk4", 0.0125, 10.0));
  const auto a = between.column("position", "mass"), b = fine.column("position", "mass");
  const auto va = between.column("velocity", "mass"), vb = fine.column("velocity", "mass");
  const auto t = between.column("time");
  ASSERT_EQ(a.size(), 801u);
  ASSERT_EQ(b.size(), a.size());
  EXPECT_DOUBLE_EQ(t[3], 0.0375);
  // rk4 at h = 0.05: 2e-10 (5/1)^4 = 1.4e-7 of 0.36 m.
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_NEAR(a[i], b[i], 2e-7) << i;
    ASSERT_NEAR(va[i], vb[i], 5e-7) << i;
  }
}

// The exponential step is exact at its ends, so that samples between them err by the interpolation alone: by h^4 in
// displacement, velocity and acceleration. The first two steps have fewer ends to go through.
TEST(Transient, InterpolatesMotionAndAccelerationWithFourthOrder) {
  const auto system = testing::single_mass();
  const auto error_at = [&](double h) {
    auto d = description("exponential", h, 10.0);
    d.output.kind = Kind::interval;
    d.output.interval = h / 4.0;
    const Recorded between = run(system, d), exact = run(system, description("exponential", h / 4.0, 10.0));
    std::array<double, 3> errors{};
    for (std::size_t k = 0; k < 3; ++k) {
      const char* quantity = std::array{"position", "velocity", "acceleration"}[k];
      const auto a = between.column(quantity, "mass"), b = exact.column(quantity, "mass");
      EXPECT_EQ(a.size(), b.size());
      for (std::size_t i = 8; i < a.size(); ++i) errors[k] = std::max(errors[k], std::abs(a[i] - b[i]));
    }
    return errors;
  };
  const auto coarse = error_at(0.1), fine = error_at(0.05);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(std::log2(coarse[k] / fine[k]), 4.0, 0.3) << k;
}

// A fast mode that the step passes over (omega h = 50) alternates from step to step. Between steps it may be anything
// of its size; a polynomial through velocities would make it ten times larger.
TEST(Transient, KeepsFastModesWithinTheirSizeBetweenSteps) {
  model::ModelDescription description_of;
  description_of.coordinates = {{"slow", 1.0, 1.0, 0.0, {}}, {"fast", 1.0, 1e-3, 0.0, {}}};
  model::SpringDescription soft, stiff;
  soft.between = {"slow", "ground"};
  soft.stiffness = 1.0;
  stiff.between = {"fast", "ground"};
  stiff.stiffness = 1e6;
  description_of.springs = {soft, stiff};
  const auto system = system::assemble(model::build(description_of, {}));
  auto d = description("average_acceleration", 0.05, 2.0);
  d.output.kind = Kind::interval;
  d.output.interval = 0.01;
  const Recorded result = run(system, d);
  for (const double q : result.column("position", "fast")) ASSERT_LE(std::abs(q), 1.7e-3);
  for (const double v : result.column("velocity", "fast")) ASSERT_LE(std::abs(v), 1.7);
  for (const double a : result.column("acceleration", "fast")) ASSERT_LE(std::abs(a), 1.7e3);
  // 0.5 J swing in the fast mode; 1.7 is squared.
  for (const double r : result.column("residue", "", "run.energy")) ASSERT_LE(std::abs(r), 3.0 * 0.5);
}

TEST(Transient, WritesTheRequestedTimesOnly) {
  auto d = description("average_acceleration", 0.01, 3.0);
  d.output.kind = Kind::times;
  d.output.times = {model::Quantity(0.5), model::Quantity(1.0), model::Quantity(2.9999)};
  const Recorded result = run(testing::single_mass(), d);
  EXPECT_EQ(result.column("time"), (std::vector<double>{0.5, 1.0, 2.9999}));
}

TEST(Transient, WritesEveryNthStepAndTheLast) {
  auto d = description("average_acceleration", 0.1, 1.0);
  d.output.kind = Kind::every;
  d.output.every = 4;
  const Recorded result = run(testing::single_mass(), d);
  const auto t = result.column("time");
  ASSERT_EQ(t.size(), 4u);  // 0, 0.4, 0.8 and the end
  EXPECT_NEAR(t[1], 0.4, 1e-15);
  EXPECT_EQ(t[3], 1.0);
}

TEST(Transient, KeepsADifferenceOfCoordinates) {
  auto d = description("average_acceleration", 0.01, 2.0);
  d.observe =
      std::vector<model::ObservationDescription>{{"blade1", "", {}}, {"damper", "", {}}, {"blade1", "damper", {}}};
  const Recorded result = run(testing::damper_model(10.0, 7.7, -8.0), d);
  const auto a = result.column("position", "blade1"), b = result.column("position", "damper"),
             c = result.column("position", "blade1 - damper");
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_EQ(c[i], a[i] - b[i]);
}

TEST(Transient, StopsWhenAskedAndKeepsWhatItHas) {
  Recorded result;
  testing::QuietProgress progress;
  const std::atomic<bool> stop{true};
  RunContext context{result.sink, progress, stop};
  const auto system = testing::single_mass();
  result.report = run_transient(
      "run", plan_transient("run", {}, description("rk4", 0.01, 1.0), integrate::StructureKind(system), {}),
      integrate::StructureKind(system), context);
  EXPECT_EQ(result.report.status, RunStatus::interrupted);
  EXPECT_EQ(result.report.message, "interrupted at t = 0.01 s of 1 s");
  EXPECT_EQ(result.table().rows.size(), 2u);
}

TEST(Transient, SaysWhenWhereAndWhatToTryWhenALoadIsNotFinite) {
  system::LocallyNonlinear::Parts parts;
  parts.mass = parts.damping = parts.stiffness = testing::sparse(Matrix::Identity(2, 2));
  parts.loads = system::Loads({{{1}, {1.0}, model::FormulaLaw{numerics::Formula("1/(t-1)", {}, true)}}});
  parts.coordinates = {"a", "b"};
  const system::LocallyNonlinear system(std::move(parts));
  const Recorded result = run(system, description("generalized_alpha", 0.125, 2.0));
  EXPECT_EQ(result.report.status, RunStatus::failed);
  EXPECT_EQ(
      result.report.message,
      "at t = 0.875 s with the step 0.125 s a number that is not finite appeared at coordinate \"b\"; look at the "
      "loads at that time, and whether the response grew before it (a smaller step, or an unconditionally stable "
      "method)");
  EXPECT_EQ(result.table().rows.size(), 8u);  // what was computed is kept
}

std::string refusal(const system::LocallyNonlinear& system, const model::TransientDescription& d) {
  try {
    plan_transient("run", {"study.toml", 7, 1}, d, integrate::StructureKind(system), {});
  } catch (const InvalidInput& fault) {
    return fault.what();
  }
  return "accepted";
}

// Explicit Euler on m = c = k = 1: |1 + h lambda| = 1 at h = -2 Re(lambda)/|lambda|^2 = 1 (reference page, section 2).
TEST(Transient, RefusesAStepBeyondTheStabilityLimitOfTheModel) {
  const auto system = testing::single_mass();
  EXPECT_EQ(
      refusal(system, description("explicit_euler", 1.01, 50.0)),
      "study.toml:7:1: error: the step 1.01 s is beyond the stability limit of explicit_euler, 1 s, which mode 1 of "
      "the model with all sliders stuck (1 rad/s, damping ratio 0.5, largest at \"mass\") sets; take a smaller "
      "step, an unconditionally stable method such as \"generalized_alpha\", or set allow_unstable = true");
  EXPECT_EQ(refusal(system, description("explicit_euler", 0.99, 50.0)), "accepted");
  auto forced = description("explicit_euler", 1.01, 50.0);
  forced.allow_unstable = true;
  EXPECT_EQ(refusal(system, forced), "accepted");
}

// The limit is that of the modes with all sliders stuck, 8.3441 rad/s for the damper model: 2/8.3441 = 0.23969 s.
TEST(Transient, CountsTheSlidersAsStuckInTheStabilityLimit) {
  const auto system = testing::damper_model();
  EXPECT_EQ(refusal(system, description("central_difference", 0.2390, 10.0)), "accepted");
  EXPECT_NE(refusal(system, description("central_difference", 0.2405, 10.0)).find("mode 5 of the model"),
            std::string::npos);
}

/// 2 kg that fly at a stop of 800 N/m, 50 mm away, with 0.8 m/s.
system::LocallyNonlinear flying_mass(double damping) {
  system::LocallyNonlinear::Parts parts;
  parts.mass = testing::sparse(2.0 * Matrix::Identity(1, 1));
  parts.damping = parts.stiffness = SparseMatrix(1, 1);
  parts.stops = {{"wall", 0, ground, 0.05, 800.0, damping}};
  parts.start.q = Vector::Zero(1);
  parts.start.v = Vector::Constant(1, 0.8);
  parts.coordinates = {"mass"};
  return system::LocallyNonlinear(std::move(parts));
}

model::TransientDescription located(const std::string& method, double tolerance, double duration) {
  model::TransientDescription d = description(method, 1.0, duration);
  d.step.reset();
  model::StepDescription step;
  step.tolerance = tolerance;
  step.locate_events = true;
  d.automatic_step = step;
  return d;
}

// In contact average acceleration keeps the energy of the linear spring; located ends leave nothing between the
// branches. What the damped stop takes is the loss of kinetic energy, all of it before the mass is free again.
TEST(EnergyLedger, BooksWhatStopsStoreAndDissipate) {
  const Recorded elastic = run(flying_mass(0.0), located("average_acceleration", 1e-5, 0.25));
  ASSERT_EQ(elastic.report.status, RunStatus::done);
  const double energy = 0.5 * 2.0 * 0.8 * 0.8;
  const auto stored = elastic.column("stop_stored", "", "run.energy");
  EXPECT_NEAR(*std::max_element(stored.begin(), stored.end()), energy, 1e-3 * energy);
  for (const double r : elastic.column("residue", "", "run.energy")) ASSERT_NEAR(r, 0.0, 1e-9 * energy);
  for (const double d : elastic.column("stop_dissipated", "", "run.energy")) ASSERT_NEAR(d, 0.0, 1e-9 * energy);

  const Recorded damped = run(flying_mass(12.0), located("average_acceleration", 1e-5, 0.25));
  const auto lost = damped.column("stop_dissipated", "", "run.energy");
  const auto kinetic = damped.column("kinetic", "", "run.energy");
  EXPECT_LT(kinetic.back(), 0.7 * energy);
  EXPECT_NEAR(lost.back(), energy - kinetic.back(), 1e-9 * energy);
  for (std::size_t i = 1; i < lost.size(); ++i) ASSERT_GE(lost[i], lost[i - 1] - 1e-6 * energy);
  for (const double r : damped.column("residue", "", "run.energy")) ASSERT_NEAR(r, 0.0, 1e-9 * energy);
}

TEST(Transient, WritesForceAndPenetrationOfStops) {
  const Recorded result = run(flying_mass(0.0), located("generalized_alpha", 1e-4, 0.25));
  const auto force = result.column("force", "wall"), depth = result.column("penetration", "wall");
  ASSERT_EQ(force.size(), depth.size());
  EXPECT_GT(*std::max_element(depth.begin(), depth.end()), 0.039);  // v0/omega = 0.04 m
  for (std::size_t i = 0; i < force.size(); ++i) {
    ASSERT_NEAR(force[i], 800.0 * depth[i], 1e-9);
    ASSERT_GE(force[i], 0.0);
  }
  const auto& statistics = result.report.statistics;
  const auto events =
      std::find_if(statistics.begin(), statistics.end(), [](const auto& s) { return s.first == "events"; });
  ASSERT_NE(events, statistics.end());
  EXPECT_EQ(events->second, "2");
}

TEST(Transient, WarnsOfAJumpOfALoadWithinAnEqualStep) {
  system::LocallyNonlinear::Parts parts;
  parts.mass = parts.stiffness = testing::sparse(Matrix::Identity(1, 1));
  parts.damping = SparseMatrix(1, 1);
  parts.loads =
      system::Loads({system::LoadTerm{{0}, {1.0}, model::TableLaw{{0.0, 0.53, 0.53, 2.0}, {1.0, 1.0, 0.0, 0.0}}}});
  parts.coordinates = {"mass"};
  const system::LocallyNonlinear system(std::move(parts));
  EXPECT_TRUE(run(system, description("generalized_alpha", 0.01, 2.0)).report.warnings.empty());
  const auto warnings = run(system, description("generalized_alpha", 0.1, 2.0)).report.warnings;
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("t = 0.53 s"), std::string::npos) << warnings[0];
}

}  // namespace
}  // namespace rubato::analysis
