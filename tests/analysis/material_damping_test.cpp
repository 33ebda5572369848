#include <rubato/core/error.hpp>

#include <support/mechanism_study.hpp>
#include <support/prepared_study.hpp>
#include <support/steel_strip.hpp>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <atomic>
#include <string>

// Materials whose stress follows their strain rate too (Kelvin and Voigt), in structures and in mechanisms.
namespace rubato {
namespace {

using testing::MechanismStudy;
using testing::strip;

const std::string modes = R"(
[[analysis]]
name = "modes"
type = "modes"
)";

void expect_ratios_of_retardation(const testing::MemorySink::Table& table, double time) {
  ASSERT_GE(table.rows.size(), 6u);
  for (const auto& row : table.rows) {
    const double expected = 0.5 * time * row[table.column("angular_frequency")];
    EXPECT_NEAR(row[table.column("damping_ratio")], expected, 1e-6 * expected);
  }
}

testing::MemorySink run_structure(const std::string& text) {
  const testing::PreparedStudy prepared(text);
  testing::MemorySink sink;
  testing::QuietProgress progress;
  const std::atomic<bool> stop{false};
  analysis::RunContext context{sink, progress, stop};
  const auto report = analysis::run_analysis(prepared.study.analyses.front(), prepared.input(), context);
  EXPECT_EQ(report.status, analysis::RunStatus::done) << report.message;
  return sink;
}

TEST(MaterialDamping, GivesModesTheRatioOfHalfTheirFrequency) {
  const std::string material = "retardation_time = 1e-6";
  for (const bool in_space : {false, true}) {
    const auto structure = run_structure(strip("elements = 4", material, in_space) + modes);
    expect_ratios_of_retardation(structure.tables.at("modes"), 1e-6);
    const MechanismStudy mechanism(strip("formulation = \"geometrically_exact\"", material, in_space) + modes);
    ASSERT_EQ(mechanism.report.status, analysis::RunStatus::done) << mechanism.report.message;
    expect_ratios_of_retardation(mechanism.table("modes"), 1e-6);
  }
}

// tau = 0.02 s takes 0.53 of the first bending mode, 8.3 Hz, to which all others die at once.
TEST(MaterialDamping, TakesTheEnergyOfABeamLetGo) {
  for (const bool in_space : {false, true}) {
    const MechanismStudy ran(
        strip("formulation = \"geometrically_exact\"\nelements = 3", "retardation_time = 0.02", in_space) +
        R"(
[[force]]
on = "b.y"
expression = "t < 0.2 ? 100 : 0"
[[analysis]]
name = "run"
type = "transient"
duration = 0.6
step = { tolerance = 1e-5 }
)");
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    const double work = ran.last("run.energy", "load_work"), taken = ran.last("run.energy", "damper_dissipated");
    EXPECT_GT(work, 1.0);
    EXPECT_NEAR(taken, work, 1e-3 * work);
    EXPECT_NEAR(ran.last("run.energy", "residue"), 0.0, 1e-3 * work);
  }
}

/// A steel arm of 0.8 m on a hub that a motor of 2 N m turns onto a rigid stop at 1 rad.
MechanismStudy arm_on_a_stop(const std::string& material, const std::string& friction, double duration) {
  return MechanismStudy(fmt::format(R"(
[[material]]
name = "steel"
young = 206e9
poisson = 0.3
density = 7800
{}
[[section]]
name = "flat"
area = "0.03*0.006"
inertia = ["0.006*0.03^3/12", "0.03*0.006^3/12"]
torsion = "0.03*0.006^3/3"
shear_factor = "5/6"
[[node]]
name = "root"
position = [0.1, 0.0, 0.0]
[[node]]
name = "tip"
position = [0.9, 0.0, 0.0]
[[mass]]
node = "tip"
mass = 0.5
[[beam]]
name = "arm"
nodes = ["root", "tip"]
section = "flat"
material = "steel"
formulation = "geometrically_exact"
orientation = [0.0, 1.0, 0.0]
[[body]]
name = "hub"
mass = 1.0
shape = {{ kind = "cylinder", radius = 0.1, length = 0.05 }}
position = [0.0, 0.0, 0.0]
[[joint]]
name = "shaft"
type = "revolute"
between = ["ground", "hub"]
at = [0.0, 0.0, 0.0]
axis = [0.0, 0.0, 1.0]
moment = "t > 0.1 ? 2.0 : 0"
lock = {{ at = 1.0, kind = "stop" }}
{}
[[joint]]
name = "clamp"
type = "rigid"
between = ["hub", "root"]
at = [0.1, 0.0, 0.0]
[gravity]
acceleration = [0.0, 0.0, -9.81]
[[analysis]]
name = "swing"
type = "transient"
initial = "static"
step = {{ tolerance = 1e-4 }}
output = {{ interval = 0.01 }}
duration = {}
)",
                                    material, friction, duration));
}

void expect_to_close(const MechanismStudy& ran) {
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  EXPECT_GT(ran.last("swing.energy", "lock_dissipated"), 0.0);
  constexpr double put_in = 2.0;  // by the motor on its way to the stop [J]
  EXPECT_NEAR(ran.last("swing.energy", "residue"), 0.0, 2e-3 * put_in);
}

// 1.3 % of the first mode are 5,000 % of the fastest: what the impact leaves there is gone in 1e-8 s, and must not hold
// the step down longer.
TEST(MaterialDamping, LetsAnArmPassItsStop) { expect_to_close(arm_on_a_stop("retardation_time = 1e-3", "", 3.0)); }

// The middle of a step, where friction that holds is looked at, must not see forces of interpolated vibrations.
TEST(MaterialDamping, LetsAHubHoldByFriction) {
  expect_to_close(arm_on_a_stop("retardation_time = 1e-4",
                                R"(friction = { coefficient = 0.1, normal_load = "reaction", radius = 0.02 })", 1.7));
}

TEST(MaterialDamping, IsRefusedWhereItWouldMakeEnergy) {
  try {
    (void)testing::PreparedStudy(strip("elements = 4", "retardation_time = -1e-6") + modes);
    ADD_FAILURE() << "not refused";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("material \"steel\": retardation_time"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace rubato
