#include <rubato/analysis/steady/frequency_response_plan.hpp>
#include <rubato/core/error.hpp>

#include "support/prepared_study.hpp"
#include "support/ran_study.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

// Frequency responses of studies with stops and contacts, alone and beside sliders and laws.
namespace rubato::testing {
namespace {

using namespace analysis;

FrequencyResponsePlan plan_of(const PreparedStudy& prepared) {
  const auto& analysis = prepared.study.analyses.front();
  return plan_frequency_response(analysis.name, analysis.where,
                                 std::get<model::FrequencyResponseDescription>(analysis.task), prepared.input());
}

const std::string bumper_text =
    "[parameters]\nOmega = 1.0\n"
    "[[coordinate]]\nname = \"mass\"\nmass = 1.0\n"
    "[[spring]]\nbetween = [\"mass\", \"ground\"]\nstiffness = 1.0\n"
    "[[damper]]\nbetween = [\"mass\", \"ground\"]\ndamping = 0.1\n"
    "[[stop]]\nname = \"bumper\"\nbetween = [\"mass\", \"ground\"]\ngap = 0.0\nstiffness = 3.0\n"
    "[[force]]\non = \"mass\"\namplitude = 1.0\nangular_frequency = \"Omega\"\n"
    "[[analysis]]\nname = \"frf\"\ntype = \"frequency_response\"\nangular_frequency = [0.9, 1.2, 1.5]\n";

// Half peak to peak of x'' + 0.1 x' + x + 3 max(0, x) = cos(Omega t) after 100 periods, by Kutta's method.
double bilinear_amplitude(double omega) {
  const auto rate = [omega](double t, double x, double v) {
    return std::cos(omega * t) - 0.1 * v - x - 3.0 * std::max(0.0, x);
  };
  const int steps = 2000, periods = 100;
  const double h = 2.0 * std::numbers::pi / omega / steps;
  double x = 0.0, v = 0.0, low = HUGE_VAL, high = -HUGE_VAL;
  for (int i = 0; i < periods * steps; ++i) {
    const double t = h * i;
    const double k1 = v, l1 = rate(t, x, v);
    const double k2 = v + 0.5 * h * l1, l2 = rate(t + 0.5 * h, x + 0.5 * h * k1, k2);
    const double k3 = v + 0.5 * h * l2, l3 = rate(t + 0.5 * h, x + 0.5 * h * k2, k3);
    const double k4 = v + h * l3, l4 = rate(t + h, x + h * k3, k4);
    x += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    v += h / 6.0 * (l1 + 2.0 * l2 + 2.0 * l3 + l4);
    if (i < (periods - 1) * steps) continue;
    low = std::min(low, x);
    high = std::max(high, x);
  }
  return 0.5 * (high - low);
}

// A bilinear oscillator with k = 1 outward and 4 inward. Transients have decayed to exp(-0.05 t) < 1e-9; both routes
// state an error of 1e-3 of the amplitude.
TEST(ContactResponses, OfAStopAloneAreMarchedOrBalanced) {
  for (const char* solver : {"time_marching", "harmonic_balance"}) {
    SCOPED_TRACE(solver);
    const MemorySink run = run_study(bumper_text + "solver = \"" + solver + "\"\n");
    const double frequencies[] = {0.9, 1.2, 1.5};
    for (std::size_t row = 0; row < 3; ++row) {
      const double expected = bilinear_amplitude(frequencies[row]);
      EXPECT_NEAR(value_of(run, "frf", "amplitude", "mass", row), expected, 2e-3 * expected) << frequencies[row];
    }
  }
}

TEST(ContactResponses, ByThePeriodicSolverRefusesStopsAndSaysWhatTakesThem) {
  const PreparedStudy prepared(bumper_text + "solver = \"periodic\"\n");
  try {
    (void)plan_of(prepared);
    FAIL();
  } catch (const InvalidInput& fault) {
    EXPECT_EQ(fault.message(),
              "analysis \"frf\": the solver periodic does not take the stop \"bumper\"; take solver = "
              "\"harmonic_balance\" or \"time_marching\"");
  }
}

// A slider, a stop, a law with a memory and a contact on two coordinates: each finds its own force among the others.
TEST(ContactResponses, OfAllKindsOfContactsAtOnceAgreeByBothRoutes) {
  const std::string text = R"(
[parameters]
w = 1.0
[[coordinate]]
name = "x"
mass = 1.0
[[coordinate]]
name = "z"
mass = 1.0
[[spring]]
between = ["x", "ground"]
stiffness = 1.0
[[spring]]
between = ["z", "ground"]
stiffness = 1.0
[[damper]]
between = ["x", "ground"]
damping = 0.04
[[damper]]
between = ["z", "ground"]
damping = 0.06
[[contact]]
name = "rubs"
tangential = { x = 1.0 }
normal = { z = 1.0 }
tangential_stiffness = 1.0
normal_stiffness = 2.0
friction_coefficient = 0.4
[[slider]]
name = "slides"
between = ["x", "ground"]
stiffness = 0.5
friction_coefficient = 0.2
normal_load = 1.0
[[stop]]
name = "bumps"
between = ["x", "ground"]
gap = 1.0
stiffness = 0.7
[[bouc_wen]]
name = "yields"
between = ["z", "ground"]
stiffness = 0.3
beta = 2.0
gamma = 1.0
[[force]]
on = "x"
amplitude = 0.8
angular_frequency = "w"
[[force]]
on = "z"
expression = "1.5"
[[force]]
on = "z"
amplitude = 0.9
angular_frequency = "w"
phase = "pi/3"
)";
  const std::string response =
      "type = \"frequency_response\"\nexcitation = \"w\"\nangular_frequency = [0.9, 1.2, 1.5]\n";
  const MemorySink run =
      run_study(text + "[[analysis]]\nname = \"balanced\"\nsolver = \"harmonic_balance\"\n" + response +
                "[[analysis]]\nname = \"marched\"\nsolver = \"time_marching\"\n" + response);
  for (std::size_t row = 0; row < 3; ++row) {
    SCOPED_TRACE(row);
    const auto of = [&](const char* table, const char* variable, const char* label) {
      return value_of(run, table, variable, label, row);
    };
    const double largest = std::max(of("marched", "amplitude", "x"), of("marched", "amplitude", "z"));
    for (const char* name : {"x", "z"}) {
      EXPECT_NEAR(of("balanced", "amplitude", name), of("marched", "amplitude", name), 2e-3 * largest) << name;
      EXPECT_NEAR(of("balanced", "mean", name), of("marched", "mean", name), 2e-3 * largest) << name;
    }
    for (const char* name : {"rubs", "slides", "yields"})
      EXPECT_NEAR(of("balanced", "dissipated", name), of("marched", "dissipated", name),
                  5e-3 * of("marched", "dissipated", "rubs"))
          << name;
  }
}

}  // namespace
}  // namespace rubato::testing
