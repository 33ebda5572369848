#include <rubato/analysis/law_routes.hpp>
#include <rubato/analysis/steady/frequency_response_plan.hpp>
#include <rubato/core/error.hpp>

#include "support/ran_study.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

// Frequency responses of structures with laws other than sliders.
namespace rubato::testing {
namespace {

using namespace analysis;
using steady::SteadyRoute;

FrequencyResponsePlan plan_of(const PreparedStudy& prepared) {
  const auto& analysis = prepared.study.analyses.front();
  return plan_frequency_response(analysis.name, analysis.where,
                                 std::get<model::FrequencyResponseDescription>(analysis.task), prepared.input());
}

std::string study(const std::string& laws, const std::string& analysis) {
  return R"(
[parameters]
Omega = 1.0
N0 = 1.0
[[coordinate]]
name = "mass"
mass = 1.0
[[damper]]
between = ["mass", "ground"]
damping = 0.02
[[force]]
on = "mass"
amplitude = 0.3
angular_frequency = "Omega"
)" + laws +
         R"(
[[analysis]]
name = "frf"
)" + analysis;
}

const std::string foot = R"(
[[bouc_wen]]
name = "foot"
between = ["mass", "ground"]
stiffness = 1.0
post_yield_ratio = 0.1
)";

std::string message_of(const PreparedStudy& prepared) {
  try {
    (void)plan_of(prepared);
  } catch (const InvalidInput& fault) {
    return fault.message();
  }
  return {};
}

TEST(LawResponses, AreBalancedWhereNoSolverIsNamed) {
  const std::string text = study(foot, R"(
type = "frequency_response"
angular_frequency = [0.7, 0.85, 1.0]
)");
  EXPECT_EQ(plan_of(PreparedStudy(text)).route.kind, SteadyRoute::Kind::harmonic_balance);
  const MemorySink run = run_study(text);
  // friction-family reference, section 9, n = 1; the route promises 1e-3.
  const double amplitudes[] = {0.847936441856, 1.3257405138, 0.991463047334},
               works[] = {0.33720943227, 1.12861316178, 0.521487967447};
  for (std::size_t row = 0; row < 3; ++row) {
    EXPECT_NEAR(value_of(run, "frf", "amplitude", "mass", row), amplitudes[row], 1e-3 * amplitudes[row]);
    EXPECT_NEAR(value_of(run, "frf", "dissipated", "foot", row), works[row], 5e-3 * works[row]);
  }
}

TEST(LawResponses, OfPeriodicOrbitsAreRefusedWithWhatTakesThem) {
  const PreparedStudy prepared(study(foot, R"(
type = "frequency_response"
angular_frequency = [0.7, 1.0]
solver = "periodic"
)"));
  EXPECT_EQ(message_of(prepared),
            "analysis \"frf\": the solver periodic does not take the bouc_wen \"foot\"; take solver = "
            "\"harmonic_balance\" or \"time_marching\"");
}

TEST(LawResponses, OfLawsThatDependOnTimeAreRefused) {
  const PreparedStudy prepared(study(R"(
[[nonlinear_spring]]
name = "pulse"
between = ["mass", "ground"]
force = "u*(1 + 0.1*sin(t)) "
)",
                                     R"(
type = "frequency_response"
angular_frequency = [0.7, 1.0]
solver = "time_marching"
)"));
  EXPECT_EQ(message_of(prepared),
            "analysis \"frf\": the nonlinear_spring \"pulse\" depends on t, and a steady response repeats with the "
            "loads; write it without t, or run a transient");
}

TEST(LawResponses, HaveTheSlopesOfTheLawsAtRestInTheirLinearLimits) {
  const MemorySink run = run_study(study(foot, R"(
type = "frequency_response"
angular_frequency = [0.5, 2.0]
)"));
  for (const auto& [row, w] : {std::pair<std::size_t, double>{0, 0.5}, {1, 2.0}}) {
    const double expected = 0.3 / std::hypot(1.0 - w * w, 0.02 * w);  // k = 1 in both limits: there are no sliders
    EXPECT_NEAR(value_of(run, "frf.linear", "free_amplitude", "mass", row), expected, 1e-9);
    EXPECT_NEAR(value_of(run, "frf.linear", "stuck_amplitude", "mass", row), expected, 1e-9);
  }
}

// A slider that a law presses is as stiff as one that a number presses while it sticks.
TEST(LawResponses, StickInOneLimitWherePressedByALaw) {
  const MemorySink run = run_study(study(R"(
[[nonlinear_spring]]
name = "press"
between = ["mass", "ground"]
force = "5.0 + 0*u"
[[nonlinear_spring]]
name = "pull"
between = ["mass", "ground"]
force = "-5.0 + 0*u"
[[slider]]
name = "rub"
between = ["mass", "ground"]
stiffness = 2.0
friction_coefficient = 0.5
normal_load = { law = "press" }
)",
                                         R"(
type = "frequency_response"
angular_frequency = [0.5, 2.0]
solver = "time_marching"
)"));
  for (const auto& [row, w] : {std::pair<std::size_t, double>{0, 0.5}, {1, 2.0}}) {
    EXPECT_NEAR(value_of(run, "frf.linear", "free_amplitude", "mass", row), 0.3 / std::hypot(w * w, 0.02 * w), 1e-9);
    EXPECT_NEAR(value_of(run, "frf.linear", "stuck_amplitude", "mass", row), 0.3 / std::hypot(2.0 - w * w, 0.02 * w),
                1e-9);
  }
}

}  // namespace
}  // namespace rubato::testing
