#include <rubato/core/error.hpp>

#include "support/ran_study.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

// Runge-Kutta pairs that choose their steps beside laws with a memory.
namespace rubato::analysis {
namespace {

std::string study(const std::string& part, const std::string& method, const std::string& step) {
  return R"(
coordinate = [{ name = "m", mass = 1.0 }]
damper = [{ between = ["m", "ground"], damping = 0.02 }]
force = [{ on = "m", amplitude = 0.3, frequency = 0.135 }]
)" + part +
         R"(
[[analysis]]
name = "run"
type = "transient"
method = ")" +
         method + "\"\nstep = " + step + "\nduration = 40.0\noutput = { interval = 40.0 }\n";
}

const std::string element =
    "bouc_wen = [{ name = \"b\", between = [\"m\", \"ground\"], stiffness = 1.0, post_yield_ratio = 0.1, A = 1.0, "
    "beta = 0.5, gamma = 0.5, n = 1.5 }]\n";

double end_of(const std::string& text) {
  const auto sink = testing::run_study(text);
  return sink.tables.at("run").rows.back()[sink.tables.at("run").column("position", "m")];
}

// Against equal steps, whose error falls with the square of their length.
TEST(PairsWithLaws, KeepTheToleranceOfABoucWenElement) {
  const double coarse = end_of(study(element, "generalized_alpha", "0.002"));
  const double fine = end_of(study(element, "generalized_alpha", "0.001"));
  const double exact = fine + (fine - coarse) / 3.0;
  ASSERT_NEAR(fine, exact, 1e-5);
  for (const char* method : {"dormand_prince", "bogacki_shampine"})
    for (const char* tolerance : {"1e-4", "1e-6"})
      EXPECT_NEAR(end_of(study(element, method, std::string("{ tolerance = ") + tolerance + " }")), exact,
                  20.0 * std::stod(tolerance))
          << method << ", " << tolerance;
}

std::string refusal(const std::string& text) {
  try {
    (void)testing::run_study(text);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "none";
}

TEST(PairsWithLaws, RefuseWhatTheirEstimateDoesNotSee) {
  EXPECT_NE(refusal(study(element, "dormand_prince", "{ tolerance = 1e-4, events = \"pass\" }"))
                .find("pass over the turns of \"b\""),
            std::string::npos);
}

// Where the load reaches zero it has a kink, too: a step that ends at one ends at the other.
TEST(PairsWithLaws, GoOnFromWhereALoadEnds) {
  for (const std::string load : {"max(0, 2 - t)", "min(1, abs(2 - t))", "max(0, cos(0.6*t + 1.067) - 0.239)"})
    for (const std::string method : {"dormand_prince", "bogacki_shampine", "generalized_alpha"}) {
      SCOPED_TRACE(load + method);
      const std::string slider =
          "slider = [{ name = \"s\", between = [\"m\", \"ground\"], stiffness = 0.5, friction_coefficient = 0.3, "
          "normal_load = \"" +
          load + "\" }]\n";
      (void)testing::run_study(study(slider, method, "{ tolerance = 1e-4, events = \"locate\" }"));
    }
}

}  // namespace
}  // namespace rubato::analysis
