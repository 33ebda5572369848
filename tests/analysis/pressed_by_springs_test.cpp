#include "support/ran_study.hpp"

#include <fmt/format.h>
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

// What presses is large beside what the coordinates feel of it: u is rounded by the sum of the forces, and steps end
// there.
TEST(PressedBySprings, EndStepsAtTheRoundingOfLargeForces) {
  const double load[] = {640.981, 878.144, 1115.31};
  const auto end_of = [&](bool is_pressed_by_laws) {
    std::string sliders, laws;
    for (int i = 0; i < 3; ++i) {
      const std::string on = fmt::format("between = [\"x{}\", \"ground\"]", i);
      const std::string number = fmt::format("{}", load[i]);
      sliders += fmt::format("[[slider]]\nname = \"rub{0}\"\n{1}\nstiffness = {2}\nfriction_coefficient = 5e-4\n", i,
                             on, 200 + 130 * i);
      sliders += is_pressed_by_laws ? fmt::format("normal_load = {{ law = \"push{}\" }}\n", i)
                                    : fmt::format("normal_load = {}\n", number);
      for (const std::string sign : {"", "-"})
        laws += fmt::format("[[nonlinear_spring]]\nname = \"{}{}\"\n{}\nforce = \"{}{} + 0*u\"\n",
                            sign.empty() ? "push" : "pull", i, on, sign, number);
    }
    const auto sink = testing::run_study(R"toml(
coordinate = [{ name = "x0", mass = 1.7 }, { name = "x1", mass = 0.9 }, { name = "x2", mass = 2.3 }]
spring = [{ between = ["x0", "ground"], stiffness = 40.0 }, { between = ["x0", "x1"], stiffness = 70.0 }, { between = ["x1", "x2"], stiffness = 20.0 }]
force = [{ on = "x0", expression = "3*sin(5*t)" }]
)toml" + sliders + laws + R"toml(
[[analysis]]
name = "run"
type = "transient"
method = "average_acceleration"
step = 0.02
duration = 10.0
)toml");
    return sink.tables.at("run").rows.back()[sink.tables.at("run").column("position", "x0")];
  };
  EXPECT_NEAR(end_of(true), end_of(false), 1e-9);
}

}  // namespace
}  // namespace rubato::analysis
