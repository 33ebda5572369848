#include <support/ran_study.hpp>

#include <gtest/gtest.h>

#include <string>

// Static states with the friction that loads leave as they grow, and without.
namespace rubato {
namespace {

using testing::run_study;
using testing::value_of;

/// Two blades and a wedge damper under a centrifugal load of 6 N, its planes inclined by 35 degrees.
const std::string wedge = R"toml(
[parameters]
b = "35*pi/180"
Fc = 6.0
[[coordinate]]
name = "x1"
mass = 1.0
[[coordinate]]
name = "x2"
mass = 1.0
[[coordinate]]
name = "xd"
mass = 0.05
[[coordinate]]
name = "yd"
mass = 0.05
[[spring]]
between = ["x1", "ground"]
stiffness = 60.0
[[spring]]
between = ["x2", "ground"]
stiffness = 66.0
[[contact]]
name = "left"
tangential = { xd = "cos(b)", yd = "sin(b)", x1 = "-cos(b)" }
normal = { xd = "-sin(b)", yd = "cos(b)", x1 = "sin(b)" }
tangential_stiffness = 30.0
normal_stiffness = 45.0
friction_coefficient = 0.35
gap = 0.0
[[contact]]
name = "right"
tangential = { xd = "cos(b)", yd = "-sin(b)", x2 = "-cos(b)" }
normal = { xd = "sin(b)", yd = "cos(b)", x2 = "-sin(b)" }
tangential_stiffness = 30.0
normal_stiffness = 45.0
friction_coefficient = 0.35
gap = 0.0
[[force]]
on = "yd"
amplitude = "Fc"
angular_frequency = 0.0
[[analysis]]
name = "grown"
type = "static"
[[analysis]]
name = "free"
type = "static"
friction = "none"
)toml";

void expect_state(const testing::MemorySink& ran, const std::string& name, const double (&place)[4], double along,
                  double across) {
  SCOPED_TRACE(name);
  const char* const coordinates[] = {"x1", "x2", "xd", "yd"};
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(value_of(ran, name, "position", coordinates[i]), place[i], 2e-11);
  EXPECT_NEAR(value_of(ran, name, "tangential_force", "left"), along, 2e-9);
  EXPECT_NEAR(value_of(ran, name, "tangential_force", "right"), -along, 2e-9);
  EXPECT_NEAR(value_of(ran, name, "normal_force", "left"), across, 2e-9);
}

// By event-driven loading, to ten digits: friction that the growing load leaves carries a third of the blades' way.
TEST(StaticFriction, IsWhatTheGrowingLoadLeavesOrNone) {
  const auto ran = run_study(wedge);
  expect_state(ran, "grown", {-0.014063739232, 0.012785217483, -0.00063926087416, 0.08919663591}, 1.0295088645,
               2.9414538987);
  expect_state(ran, "free", {-0.03501037691, 0.031827615373, -0.0015913807687, 0.12275293946}, 0.0, 3.6623237663);
}

// Each sample of a sweep leaves friction out of its own model.
TEST(StaticFriction, IsLeftOutOfEverySample) {
  const auto ran = run_study(wedge + "sweep = { Fc = [3.0, 6.0] }\n");
  for (std::size_t row = 0; row < 2; ++row)  // linear without friction while both touch
    EXPECT_NEAR(value_of(ran, "free", "position", "yd", row), 0.12275293946 * (row == 0 ? 0.5 : 1.0), 1e-10);
}

// A mass on an inclined slider: with friction the slider carries mu N, without it the spring carries all.
TEST(StaticFriction, IsLeftOutOfSliders) {
  const auto ran = run_study(R"(
[[coordinate]]
name = "mass"
mass = 2.0
[[spring]]
between = ["mass", "ground"]
stiffness = 100.0
[[slider]]
between = ["mass", "ground"]
stiffness = 400.0
friction_coefficient = 0.5
normal_load = 4.0
[[force]]
on = "mass"
amplitude = 10.0
angular_frequency = 0.0
[[analysis]]
name = "grown"
type = "static"
[[analysis]]
name = "free"
type = "static"
friction = "none"
)");
  EXPECT_NEAR(value_of(ran, "grown", "position", "mass"), 0.08, 1e-14);  // it slips at 2 N
  EXPECT_NEAR(value_of(ran, "free", "position", "mass"), 0.1, 1e-14);
}

}  // namespace
}  // namespace rubato
