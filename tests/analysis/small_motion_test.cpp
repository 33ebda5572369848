#include <support/mechanism_study.hpp>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace rubato {
namespace {

/// A block of 1 kg on a guide with a spring of 100 N/m, under a force F sin(3.7 t) beside a steady one, from rest.
std::string block(double force, double tolerance, const std::string& more = "", double steady = 0.0) {
  constexpr const char* text = R"toml(
[[body]]
name = "block"
position = [0.0, 0.0]
mass = 1.0
inertia = 1.0
[[joint]]
name = "guide"
type = "prismatic"
between = ["ground", "block"]
at = [0.0, 0.0]
axis = [1.0, 0.0]
stiffness = 100.0
[[force]]
on = "block.x"
expression = "{} + {}*sin(3.7*t)"
[[analysis]]
name = "swing"
type = "transient"
duration = 10.0
step = {{ tolerance = {} }}
{}
output = {{ interval = 0.1 }}
)toml";
  return fmt::format(fmt::runtime(text), steady, force, tolerance, more);
}

/// The largest difference from F/(k - w^2) (sin(w t) - w/10 sin(10 t)), over the largest of that.
double error_of(const testing::MechanismStudy& ran, double force) {
  double error = 0.0, largest = 0.0;
  for (std::size_t row = 0; row < ran.table("swing").rows.size(); ++row) {
    const double t = ran.at(row, "swing", "time");
    const double exact = force / (100.0 - 3.7 * 3.7) * (std::sin(3.7 * t) - 0.37 * std::sin(10.0 * t));
    largest = std::max(largest, std::abs(exact));
    error = std::max(error, std::abs(ran.at(row, "swing", "position", "block.x") -
                                     ran.at(0, "swing", "position", "block.x") - exact));
  }
  return error / largest;
}

// Half a millimetre of a mechanism of a metre: errors were shares of the metre, and half of the swing was wrong.
TEST(SmallMotion, IsMeasuredByItself) {
  for (const double force : {500.0, 5.0, 0.5, 0.05}) {
    const testing::MechanismStudy ran(block(force, 1e-3), 0);
    EXPECT_TRUE(ran.report.warnings.empty()) << force << ' ' << ran.report.warnings.front();
    EXPECT_LT(error_of(ran, force), 1e-2) << force;
  }
}

// A thousandth of that is less than what the error is measured by at least. The tolerance that the warning gives holds.
TEST(SmallMotion, IsToldWhereItIsTiny) {
  constexpr double force = 5e-5;
  const testing::MechanismStudy small(block(force, 1e-3), 0);
  ASSERT_FALSE(small.report.warnings.empty());
  EXPECT_THAT(small.report.warnings.front(), ::testing::HasSubstr("take tolerance = "));
  const std::string& told = small.report.warnings.front();
  const double tolerance = std::stod(told.substr(told.find("take tolerance = ") + 17));
  EXPECT_LT(tolerance, 1e-4);
  const testing::MechanismStudy again(block(force, tolerance), 0);
  EXPECT_TRUE(again.report.warnings.empty()) << again.report.warnings.front();
  EXPECT_LT(error_of(again, force), 1e-2);
}

// It sinks by a metre before the run; the size of the motion is measured from there.
TEST(SmallMotion, IsMeasuredFromARestThatIsFarFromWhereItWasGiven) {
  const testing::MechanismStudy ran(block(0.05, 1e-3, "initial = \"static\"", 100.0), 0);
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  EXPECT_LT(error_of(ran, 0.05), 1e-2);
}

}  // namespace
}  // namespace rubato
