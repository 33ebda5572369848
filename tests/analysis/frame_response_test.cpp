#include <rubato/analysis/run_study.hpp>
#include <rubato/integrate/kinds/structure_kind.hpp>
#include <rubato/io/read_study.hpp>
#include <rubato/model/model.hpp>
#include <rubato/system/assemble.hpp>

#include "support/memory_sink.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

namespace rubato::analysis {
namespace {

// A cantilever of 2 m, E I = 2.1e5 N m2, under a moment at its tip; a hinge with friction and a slider hang on it.
const std::string cantilever = R"(
[parameters]
Omega = 1.0
[[node]]
name = "foot"
position = [0.0, 0.0]
[[node]]
name = "tip"
position = [2.0, 0.0]
[[material]]
name = "steel"
young = 2.1e11
poisson = 0.3
density = 7850.0
[[section]]
name = "bar"
area = 1e-2
inertia = 1e-6
[[beam]]
nodes = ["foot", "tip"]
section = "bar"
material = "steel"
formulation = "euler_bernoulli"
[[support]]
node = "foot"
fix = ["x", "y", "rz"]
[damping]
modal_ratio = 0.02
[[slider]]
name = "hinge"
between = ["tip.rz", "ground"]
stiffness = 1e3
friction_coefficient = 1.0
normal_load = 1e-3
[[slider]]
name = "rub"
between = ["tip.y", "ground"]
stiffness = 1e3
friction_coefficient = 1.0
normal_load = 1e-3
[[force]]
on = "tip.rz"
amplitude = 100.0
angular_frequency = "Omega"
[[analysis]]
name = "frf"
type = "frequency_response"
angular_frequency = [1.0, 2.0]
observe = ["tip.rz", "tip.y"]
waveforms = { at = [1.0] }
)";

// The rotation is M L/(E I), the deflection M L^2/(2 E I), but for inertia, (1/45)^2 of them or less below the first
// frequency of 45 rad/s, and for the friction, 2e-5 of the moment.
TEST(ResponseOfAFrame, HasRotationsInRadiansAndSlidersBetweenThemInTheirUnits) {
  const auto study = io::read_study_text(cantilever, "study.toml");
  const numerics::Parameters overrides, parameters = model::evaluate_parameters(study.parameters, overrides);
  const auto system = system::assemble(model::build(study.model, parameters));
  const integrate::StructureKind kind(system);
  const StudyInput input{study, overrides, parameters, kind};
  testing::MemorySink sink;
  testing::QuietProgress progress;
  const std::atomic<bool> stop{false};
  RunContext context{sink, progress, stop};
  ASSERT_EQ(run_analysis(study.analyses.front(), input, context).status, RunStatus::done);

  const auto& table = sink.tables.at("frf");
  const auto unit = [](const testing::MemorySink::Table& of, const std::string& variable) -> std::string {
    for (const auto& block : of.layout.blocks)
      if (block.variable == variable) return block.unit;
    return "none";
  };
  EXPECT_EQ(unit(table, "amplitude"), "m");
  EXPECT_EQ(unit(table, "angle_amplitude"), "rad");
  EXPECT_EQ(unit(table, "angular_velocity_amplitude"), "rad/s");
  EXPECT_EQ(unit(table, "angular_acceleration_amplitude"), "rad/s2");
  EXPECT_EQ(unit(table, "offset"), "N");
  EXPECT_EQ(unit(table, "moment_offset"), "N m");
  const auto& row = table.rows.front();
  ASSERT_EQ(row.size(), table.layout.row_width());
  const double rotation = 100.0 * 2.0 / 2.1e5, deflection = 100.0 * 4.0 / (2.0 * 2.1e5);
  EXPECT_NEAR(row[table.column("angle_amplitude", "tip.rz")], rotation, 6e-4 * rotation);
  EXPECT_NEAR(row[table.column("angular_velocity_amplitude", "tip.rz")], rotation, 6e-4 * rotation);
  EXPECT_NEAR(row[table.column("amplitude", "tip.y")], deflection, 6e-4 * deflection);
  EXPECT_NEAR(row[table.column("phase", "tip.rz")], 0.0, 1e-3);
  // Full slip over twice the amplitude and back, less the elastic part: 4 mu N (A - mu N/kT).
  EXPECT_NEAR(row[table.column("dissipated", "rub")], 4e-3 * (deflection - 1e-6), 2e-3 * 4e-3 * deflection);

  const auto& waves = sink.tables.at("frf.waveforms");
  EXPECT_EQ(unit(waves, "angle"), "rad");
  EXPECT_EQ(unit(waves, "moment"), "N m");
  EXPECT_EQ(unit(waves, "relative_angle"), "rad");
  double largest_angle = 0.0, largest_force = 0.0;
  for (const auto& sample : waves.rows) {
    largest_angle = std::max(largest_angle, std::abs(sample[waves.column("relative_angle", "hinge")]));
    largest_force = std::max(largest_force, std::abs(sample[waves.column("force", "rub")]));
    EXPECT_EQ(sample[waves.column("relative_angle", "hinge")], sample[waves.column("angle", "tip.rz")]);
  }
  EXPECT_NEAR(largest_angle, rotation, 2e-3 * rotation);
  EXPECT_LE(largest_force, 1e-3 * (1.0 + 1e-12));
}

}  // namespace
}  // namespace rubato::analysis
