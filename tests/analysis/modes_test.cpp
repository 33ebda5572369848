#include <rubato/analysis/modes.hpp>
#include <rubato/integrate/kinds/structure_kind.hpp>

#include "support/memory_sink.hpp"
#include "support/models.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <numbers>

namespace rubato::analysis {
namespace {

struct Recorded {
  testing::MemorySink sink;
  RunReport report;
  double at(std::size_t row, const std::string& variable, const std::string& label = "") const {
    const auto& table = sink.tables.at("natural");
    return table.rows.at(row).at(table.column(variable, label));
  }
  std::size_t rows() const { return sink.tables.at("natural").rows.size(); }
};

Recorded run(const system::LocallyNonlinear& system, const model::ModesDescription& description = {},
             bool is_stopped = false) {
  Recorded result;
  testing::QuietProgress progress;
  const std::atomic<bool> stop{is_stopped};
  RunContext context{result.sink, progress, stop};
  const integrate::StructureKind kind(system);
  result.report = run_modes("natural", plan_modes("natural", {}, description, kind, {}), kind, context);
  return result;
}

std::string refusal(const system::LocallyNonlinear& system, const model::ModesDescription& description,
                    const numerics::Parameters& parameters = {}) {
  try {
    (void)plan_modes("natural", {"study.toml", 4, 1}, description, integrate::StructureKind(system), parameters);
  } catch (const InvalidInput& fault) {
    return fault.what();
  }
  return "accepted";
}

// Reference page, section 4, both limits; the damping couples those of full stick by a few percent of ratio, which
// moves frequencies by its square.
TEST(Modes, OfTheUnderplatformDamperAreThoseOfTheThesisInBothLimits) {
  const Recorded result = run(testing::damper_model());
  ASSERT_EQ(result.report.status, RunStatus::done);
  ASSERT_EQ(result.rows(), 10u);
  const double expected[] = {2.985807624388833, 2.985807624388833, 3.162277660168379, 7.488988772200257,
                             7.488988772200257, 2.996205323187844, 3.162277660168379, 5.137956574909118,
                             8.062257748298550, 8.344109053436982};
  for (std::size_t row = 0; row < 10; ++row) {
    EXPECT_EQ(result.at(row, "limit"), row < 5 ? 0.0 : 1.0);
    EXPECT_EQ(result.at(row, "mode"), static_cast<double>(row % 5 + 1));
    EXPECT_NEAR(result.at(row, "angular_frequency"), expected[row], row < 5 ? 4e-15 : 2e-3);
    EXPECT_NEAR(result.at(row, "frequency"), result.at(row, "angular_frequency") / (2.0 * std::numbers::pi), 1e-15);
    if (row < 5) {
      EXPECT_NEAR(result.at(row, "damping_ratio"), 0.02, 2e-15);
      EXPECT_EQ(result.at(row, "shape_imaginary", "blade1"), 0.0);
    }
    const double omega = result.at(row, "angular_frequency"), ratio = result.at(row, "damping_ratio");
    EXPECT_NEAR(result.at(row, "eigenvalue_real"), -ratio * omega, 1e-14);
    EXPECT_NEAR(result.at(row, "eigenvalue_imaginary"), omega * std::sqrt(1.0 - ratio * ratio), 1e-14);
    // phi^H M phi with M = diag(10, 1, 10, 1, 1)
    double modal_mass = 0.0;
    const char* names[] = {"disk1", "blade1", "disk2", "blade2", "damper"};
    for (std::size_t i = 0; i < 5; ++i)
      modal_mass += (i % 2 == 0 && i < 4 ? 10.0 : 1.0) * (std::pow(result.at(row, "shape", names[i]), 2) +
                                                          std::pow(result.at(row, "shape_imaginary", names[i]), 2));
    EXPECT_NEAR(modal_mass, 1.0, 1e-14);
  }
}

// omega_j = 2 sin(j pi / 12) with shapes sin(i j pi / 6) / sqrt 3; no damping, so no imaginary parts; no sliders, so
// one limit.
TEST(Modes, OfAChainOfFiveAreSines) {
  const auto base = testing::chain(5, 0);
  system::LocallyNonlinear::Parts parts;
  parts.mass = base.mass();
  parts.stiffness = base.stiffness();
  parts.damping = SparseMatrix(5, 5);
  parts.coordinates = base.coordinates();
  model::ModesDescription description;
  description.observe = {{"x1", "", {}}, {"x3", "", {}}, {"x3", "x1", {}}};
  const Recorded result = run(system::LocallyNonlinear(std::move(parts)), description);
  ASSERT_EQ(result.rows(), 5u);
  EXPECT_EQ(result.sink.tables.at("natural").layout.row_width(), 10u);
  for (std::size_t j = 1; j <= 5; ++j) {
    const double angle = std::numbers::pi * static_cast<double>(j) / 6.0;
    EXPECT_NEAR(result.at(j - 1, "angular_frequency"), 2.0 * std::sin(0.5 * angle), 2e-15);
    EXPECT_EQ(result.at(j - 1, "damping_ratio"), 0.0);
    // The largest entry, the first of equal ones, is positive: x1 of modes 2, 3 and 4, x3 of 1 and 5.
    const double x1 = std::sin(angle) / std::sqrt(3.0), x3 = std::sin(3.0 * angle) / std::sqrt(3.0);
    EXPECT_NEAR(result.at(j - 1, "shape", "x1"), x1, 1e-15);
    EXPECT_NEAR(result.at(j - 1, "shape", "x3"), x3, 1e-15);
    EXPECT_NEAR(result.at(j - 1, "shape", "x3 - x1"), x3 - x1, 2e-15);
  }
}

TEST(Modes, AreTheLowestTwentyUnlessACountIsGiven) {
  const auto system = testing::chain(30, 2);
  EXPECT_EQ(run(system).rows(), 40u);
  model::ModesDescription three;
  three.count = "2 * k + 1";
  EXPECT_EQ(plan_modes("natural", {}, three, integrate::StructureKind(system), {{"k", 1.0}}).count, 3);
  three.count = 30.0;
  EXPECT_EQ(run(system, three).rows(), 60u);
}

TEST(Modes, RefuseACountThatTheModelDoesNotHave) {
  const auto system = testing::chain(30, 2);
  model::ModesDescription description;
  for (const double count : {0.0, -2.0, 1.5}) {
    description.count = count;
    EXPECT_EQ(refusal(system, description),
              "study.toml:4:1: error: analysis \"natural\": count must be a whole number of at least 1, got " +
                  std::string(count == 0.0  ? "0"
                              : count < 0.0 ? "-2"
                                            : "1.5"));
  }
  description.count = 31.0;
  EXPECT_EQ(refusal(system, description),
            "study.toml:4:1: error: analysis \"natural\": count is 31, but a model of 30 coordinates has 30 modes");
  description.count = 1500.0;
  EXPECT_EQ(
      refusal(testing::chain(4000, 0), description),
      "study.toml:4:1: error: analysis \"natural\": count is 1500; of a model of 4000 coordinates ask for at most "
      "a third of the modes, 1333");
  description.count = std::nullopt;
  description.observe = {{"y3", "", {"study.toml", 7, 12}}};
  EXPECT_EQ(
      refusal(testing::damper_model(), description),
      "study.toml:7:12: error: observe names \"y3\", which is no coordinate; known: disk1, blade1, disk2, blade2, "
      "damper");
}

// 1e300 N/m on 1e-20 kg: omega^2 is beyond the largest of double. The residual of no mode at all is no cause.
TEST(Modes, SayWhyNoneWasFound) {
  system::LocallyNonlinear::Parts parts;
  parts.mass = testing::sparse((Matrix(2, 2) << 1e-20, 0.0, 0.0, 1.0).finished());
  parts.stiffness = testing::sparse((Matrix(2, 2) << 1e300, -1.0, -1.0, 1.0).finished());
  parts.damping = SparseMatrix(2, 2);
  parts.coordinates = {"a", "b"};
  const Recorded result = run(system::LocallyNonlinear(std::move(parts)));
  EXPECT_EQ(result.report.status, RunStatus::failed);
  EXPECT_EQ(result.report.message,
            "of 2 modes of the limit free none was found: some motion has no mass beside that of the others, or a "
            "stiffness over its mass that is beyond the largest number; give it a mass, or take stiffness and masses "
            "that are less far apart");
}

TEST(Modes, StopBetweenTheLimitsWhenAsked) {
  const Recorded result = run(testing::damper_model(), {}, true);
  EXPECT_EQ(result.report.status, RunStatus::interrupted);
  EXPECT_EQ(result.report.message, "interrupted after 0 of 2 limits");
}

}  // namespace
}  // namespace rubato::analysis
