#include <rubato/core/error.hpp>

#include "support/ran_study.hpp"
#include "support/run_mechanism.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <string>

// Harmonic balance of given orders, and the first harmonic by its parts.
namespace rubato::testing {
namespace {

using Complex = std::complex<double>;
using std::numbers::pi;

std::string study(const std::string& part, const std::string& keys) {
  return R"(
[parameters]
Omega = 1.0
[[coordinate]]
name = "m"
mass = 1.5
[[coordinate]]
name = "n"
mass = 0.5
[[spring]]
between = ["m", "ground"]
stiffness = 10.0
[[spring]]
between = ["m", "n"]
stiffness = 12.0
[[damper]]
between = ["m", "ground"]
damping = 0.2
[[force]]
on = "m"
amplitude = 2.0
angular_frequency = "Omega"
phase = 0.3
)" + part +
         R"(
[[analysis]]
name = "frf"
type = "frequency_response"
solver = "harmonic_balance"
angular_frequency = [1.2, 2.2, 2.6, 4.0]
harmonics = [1]
)" + keys;
}

const std::string slider = R"(
[[slider]]
name = "rub"
between = ["m", "ground"]
stiffness = 8.0
friction_coefficient = 0.5
normal_load = 0.2
)";

const std::string contact = R"(
[[contact]]
name = "touch"
tangential = { m = 1.0 }
normal = { n = -1.0 }
tangential_stiffness = 8.0
normal_stiffness = 15.0
friction_coefficient = 0.4
normal_load = 3.0
)";

// The describing function of a Jenkins element (Griffin 1980): kT (theta - sin(2 theta)/2 + i sin^2(theta))/pi with
// cos(theta) = 1 - 2 L/(kT A).
TEST(OrdersOfBalance, OneOrderIsTheDescribingFunction) {
  const double limit = 0.1, stiffness = 8.0;
  const MemorySink sink = run_study(study(slider, "orders = 1\n"));
  const double frequencies[] = {1.2, 2.2, 2.6, 4.0};
  for (std::size_t i = 0; i < 4; ++i) {
    const auto part = [&](const std::string& name) {
      return Complex(value_of(sink, "frf", "first_real", name, i), value_of(sink, "frf", "first_imaginary", name, i));
    };
    const Complex m = part("m"), n = part("n");
    const double w = frequencies[i], most = stiffness * std::abs(m);
    ASSERT_GT(most, limit) << "it is to slip";
    EXPECT_NEAR(value_of(sink, "frf", "amplitude", "m", i), std::abs(m), 1e-12);
    const double theta = std::acos(1.0 - 2.0 * limit / most);
    const Complex equivalent =
        stiffness / pi * Complex(theta - 0.5 * std::sin(2.0 * theta), std::pow(std::sin(theta), 2));
    const Complex rest_m = (22.0 - 1.5 * w * w + Complex(0.0, 0.2 * w)) * m - 12.0 * n + equivalent * m -
                           2.0 * std::exp(Complex(0.0, 0.3));
    const Complex rest_n = (12.0 - 0.5 * w * w) * n - 12.0 * m;
    EXPECT_LT(std::abs(rest_m), 1e-9) << w;
    EXPECT_LT(std::abs(rest_n), 1e-9) << w;
  }
}

// More orders come nearer, and each error that is told is not much below the true one.
TEST(OrdersOfBalance, ErrorsTellWhatOrdersLeftOutWouldDo) {
  for (const std::string& part : {slider, contact}) {
    const MemorySink exact = run_study(study(part, "orders = 60\ntolerance = 1e-6\n"));
    for (const int orders : {3, 9, 21}) {
      const MemorySink sink = run_study(study(part, fmt::format("orders = {}\ntolerance = 1e-4\n", orders)));
      for (std::size_t i = 0; i < 4; ++i) {
        double size = 0.0, away = 0.0;
        for (const char* name : {"m", "n"}) {
          const double wanted = value_of(exact, "frf", "amplitude", name, i);
          size = std::max(size, wanted);
          away = std::max(away, std::abs(value_of(sink, "frf", "amplitude", name, i) - wanted));
        }
        const double told = value_of(sink, "frf", "error", "", i);
        EXPECT_LT(away / size, 1.5 * told + 1e-5) << orders << " row " << i;
        EXPECT_EQ(value_of(sink, "frf", "status", "", i), 0.0) << orders << " row " << i;
        EXPECT_LT(told, orders == 21 ? 0.02 : 2.0) << " row " << i;
      }
    }
  }
}

TEST(OrdersOfBalance, GoWithHarmonicBalanceAlone) {
  const auto message = [](std::string text) {
    try {
      (void)run_study(text);
    } catch (const InvalidInput& fault) {
      return fault.message();
    }
    return std::string("no complaint");
  };
  using ::testing::HasSubstr;
  EXPECT_THAT(message(study(slider, "orders = 0\n")), HasSubstr("orders must be a whole number of at least 1, got 0"));
  EXPECT_THAT(message(study(slider, "orders = 128\n")), HasSubstr("orders reach to 127, got 128"));
  EXPECT_THAT(message(replaced(study(slider, "orders = 3\n"), "harmonics = [1]", "harmonics = [1, 5]")),
              HasSubstr("harmonics names order 5, and orders = 3 leaves it out"));
  EXPECT_THAT(message(replaced(study(slider, "orders = 3\n"), "harmonic_balance", "periodic")),
              HasSubstr("\"orders\" goes with solver = \"harmonic_balance\" only"));
}

}  // namespace
}  // namespace rubato::testing
