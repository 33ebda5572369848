#include "support/steady_study.hpp"

#include <gtest/gtest.h>

#include <string>

// Steady responses of structures in which a coordinate moves as a load says.
namespace rubato::testing {
namespace {

// x = z + q with z the motion of the point that is moved: q is what the ground's motion makes, and z adds k z + c z'.
TEST(CoordinateThatMoves, DrivesASteadyResponseAsASpringAndADashpotOnMovingGroundDo) {
  const std::string mass = R"(
[parameters]
Omega = 3.0
N0 = 1.0
[[coordinate]]
name = "base"
mass = 5.0
[[coordinate]]
name = "top"
mass = 2.0
[[spring]]
between = ["base", "top"]
stiffness = 30.0
[[damper]]
between = ["base", "top"]
damping = 0.8
[[slider]]
name = "rub"
between = ["top", "ground"]
stiffness = 20.0
friction_coefficient = 0.4
normal_load = "N0"
)";
  const std::string analyses = response("periodic", "observe = [\"top\"]\n") +
                               response("balance", "observe = [\"top\"]\nsolver = \"harmonic_balance\"\n") +
                               response("marching", "observe = [\"top\"]\nsolver = \"time_marching\"\n");
  const auto moved =
      run_study(mass + "[[displacement]]\non = \"base\"\namplitude = 0.2\nangular_frequency = \"Omega\"\n" +
                "[[force]]\non = \"base\"\nexpression = \"7.0\"\n" + marched + analyses);
  std::string fixed = mass;
  for (const char* joined : {"between = [\"base\", \"top\"]", "between = [\"base\", \"top\"]"})
    fixed.replace(fixed.find(joined), 25, "between = [\"top\", \"ground\"]");
  const std::string top = "[[force]]\non = \"top\"\nangular_frequency = \"Omega\"\n";
  const auto pushed =
      run_study(fixed + top + "amplitude = 6.0\n" + top + "amplitude = \"0.16*Omega\"\nphase = \"pi/2\"\n" + analyses);
  const double amplitude = value_of(pushed, "periodic", "amplitude", "top");
  EXPECT_NEAR(value_of(moved, "periodic", "amplitude", "top"), amplitude, 1e-9 * amplitude);
  EXPECT_NEAR(value_of(moved, "balance", "amplitude", "top"), value_of(pushed, "balance", "amplitude", "top"),
              1e-9 * amplitude);
  EXPECT_NEAR(value_of(moved, "marching", "amplitude", "top"), amplitude, 2e-3 * amplitude);
  EXPECT_NEAR(settled(moved, "top").amplitude, amplitude, 4e-3 * amplitude);
}

}  // namespace
}  // namespace rubato::testing
