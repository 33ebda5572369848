#include "support/ran_study.hpp"

#include <gtest/gtest.h>

#include <string>

// Sliders that a spring presses whose force passes zero: they open and close again.
namespace rubato::analysis {
namespace {

double end_of(const std::string& method, const std::string& step) {
  const auto sink = testing::run_study(R"toml(
coordinate = [{ name = "x", mass = 1.0 }, { name = "z", mass = 1.0 }]
spring = [{ between = ["x", "ground"], stiffness = 3.5 }, { between = ["z", "ground"], stiffness = 2.0 }]
force = [{ on = "x", expression = "sin(t) + 0.5" }, { on = "z", expression = "cos(2*t)" }]
nonlinear_spring = [{ name = "press", between = ["z", "ground"], force = "3.15*u" }]
slider = [{ name = "rub", between = ["x", "ground"], stiffness = 7.2, friction_coefficient = 0.1, normal_load = { law = "press" } }]
[[analysis]]
name = "run"
type = "transient"
method = ")toml" + method +
                                       "\"\nstep = " + step + "\nduration = 10.0\noutput = { interval = 10.0 }\n");
  return sink.tables.at("run").rows.back()[sink.tables.at("run").column("position", "x")];
}

// z does not know of x: each step has one solution, whatever the kinks that the friction of x meets on the way to it.
TEST(PressedBySprings, OpenAndCloseInStepsOfEveryMethod) {
  const double exact = end_of("rk4", "0.0002");
  for (const char* method : {"generalized_alpha", "hht", "average_acceleration", "central_difference", "exponential"})
    EXPECT_NEAR(end_of(method, "0.002"), exact, 5e-5) << method;
  EXPECT_NEAR(end_of("backward_difference", "0.002"), exact, 4e-3);  // of first order
  EXPECT_NEAR(end_of("generalized_alpha", "{ tolerance = 1e-5 }"), exact, 1e-4);
}

}  // namespace
}  // namespace rubato::analysis
