#include "support/mechanism_response.hpp"
#include "support/ran_study.hpp"
#include "support/run_mechanism.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

// Frequency responses of mechanisms with contacts about their static equilibrium, against structures and long
// transients.
namespace rubato::testing {
namespace {

// Two planes, of which the second is reached by the motion.
const std::string contacts = R"(
[[contact]]
name = "ramp"
between = ["b", "ground"]
normal_direction = [0.37, 0.93]
normal_stiffness = 8e3
tangential_stiffness = 5e3
friction_coefficient = MU
[[contact]]
name = "ceiling"
between = ["b", "ground"]
normal_direction = [0.0, -1.0]
normal_stiffness = 3e3
tangential_stiffness = 1e3
friction_coefficient = 0.2
gap = 0.001
[[force]]
on = "b.x"
amplitude = 24.0
angular_frequency = "Omega"
[[force]]
on = "b.y"
amplitude = 18.0
angular_frequency = "Omega"
phase = 0.8
)";

const std::string mounted_body = R"(
[parameters]
Omega = 30.0
[gravity]
acceleration = [0.0, -9.81]
[[body]]
name = "b"
mass = 2.0
inertia = 0.05
position = [0.0, 0.0]
[[bushing]]
name = "soft"
between = ["ground", "b"]
at = [0.0, 0.0]
stiffness = [900.0, 250.0, 1.0]
damping = [8.0, 12.0, 0.2]
)";

const std::string mounted_mass = R"(
[parameters]
Omega = 30.0
[[node]]
name = "b"
position = [0.0, 0.0]
[[mass]]
node = "b"
mass = 2.0
[[spring]]
between = ["b.x", "ground"]
stiffness = 900.0
[[spring]]
between = ["b.y", "ground"]
stiffness = 250.0
[[damper]]
between = ["b.x", "ground"]
damping = 8.0
[[damper]]
between = ["b.y", "ground"]
damping = 12.0
[[force]]
on = "b.y"
expression = "-9.81*2"
)";

// The ramp slips at rest with the lower friction and sticks with the higher one; the body hits the ceiling in both.
TEST(MechanismResponses, OfContactsAreThoseOfStructures) {
  const std::string frequencies = "[20.0, 30.0, 45.0]",
                    asked = "solver = \"harmonic_balance\"\ntolerance = 1e-4\nobserve = [\"b.x\", \"b.y\"]";
  for (const char* friction : {"0.3", "0.6"}) {
    const std::string these = replaced(contacts, "MU", friction);
    const auto body =
        run_mechanism_study(mounted_body + these + response_about_rest(frequencies, "about = \"static\"\n" + asked));
    ASSERT_EQ(body.report.status, analysis::RunStatus::done) << body.report.message;
    const MemorySink mass = run_study(mounted_mass + these + response_about_rest(frequencies, asked));
    for (std::size_t row = 0; row < 3; ++row) {
      for (const char* name : {"b.x", "b.y"}) {
        const double wanted = value_of(mass, "frf", "amplitude", name, row);
        EXPECT_NEAR(value_of(body.sink, "frf", "amplitude", name, row), wanted, 1e-8 * wanted) << name;
        EXPECT_NEAR(value_of(body.sink, "frf", "mean", name, row), value_of(mass, "frf", "mean", name, row),
                    1e-8 * wanted)
            << name;
      }
      for (const char* name : {"ramp", "ceiling"}) {
        const double wanted = value_of(mass, "frf", "dissipated", name, row);
        EXPECT_NEAR(value_of(body.sink, "frf", "dissipated", name, row), wanted, 1e-7 * wanted + 1e-12) << name;
      }
    }
    for (const char* name : {"ramp", "ceiling"}) EXPECT_GT(value_of(mass, "frf", "dissipated", name), 1e-3) << name;
  }
}

// A wheel rolls on a plank that swings below it. Nothing but the friction turns the wheel.
const std::string wheel_on_a_plank = R"(
[parameters]
Omega = 1.0
[gravity]
acceleration = [0.5, -9.81]
[[body]]
name = "plank"
mass = 4.0
inertia = 0.3
position = [0.0, 0.0]
[[body]]
name = "wheel"
mass = 3.0
inertia = 0.02
position = [0.3, 0.1]
[[joint]]
name = "hinge"
type = "revolute"
between = ["ground", "plank"]
at = [-0.4, -0.2]
stiffness = 900.0
damping = 30.0
rest = 0.05
[[joint]]
name = "rod"
type = "strut"
between = ["plank", "wheel"]
at = [-0.2, 0.3]
to = [0.3, 0.1]
stiffness = 400.0
damping = 30.0
[[contact]]
name = "tread"
between = ["wheel", "plank"]
radius = 0.08
normal_direction = [0.05, 1.0]
normal_stiffness = 2e4
tangential_stiffness = 8e3
friction_coefficient = MU
[[force]]
on = "wheel.x"
amplitude = 1.0
angular_frequency = "Omega"
[[force]]
on = "plank.rz"
amplitude = 0.4
angular_frequency = "Omega"
phase = 0.8
)";

/// @param marched  its transient   @param named  amplitudes of the response, and whose
void expect_march(const std::string& study, double omega, const std::string& marched,
                  const std::vector<std::string>& solvers, double tolerance,
                  const std::vector<std::pair<std::string, std::string>>& named) {
  const auto long_run = run_mechanism_study(replaced(study, "Omega = 1.0", fmt::format("Omega = {}", omega)) + marched);
  for (const std::string& solver : solvers) {
    const auto ran = run_mechanism_study(
        study + response_about_rest(fmt::format("[{}]", omega), "about = \"static\"\nsolver = " + solver));
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    for (const auto& [amplitude, name] : named) {
      const double wanted = last_amplitude(long_run.sink, amplitude == "amplitude" ? "position" : "angle", name);
      EXPECT_NEAR(value_of(ran.sink, "frf", amplitude, name), wanted, tolerance * wanted)
          << name << " at " << omega << " by " << solver;
    }
  }
}

// What is not linear in the joints grows with the turns, some 1e-2 rad.
TEST(MechanismResponses, OfAWheelThatRollsOnAPlankAreThoseOfALongMarch) {
  const std::string rolling = replaced(wheel_on_a_plank, "MU", "0.4");
  for (const double omega : {8.0, 15.0})
    expect_march(rolling, omega, march(omega, 40, "1e-6"), {"\"harmonic_balance\"", "\"time_marching\""}, 2e-3,
                 {{"amplitude", "wheel.x"}, {"angle_amplitude", "wheel.rz"}, {"angle_amplitude", "plank.rz"}});
}

// All of its feet slip, in two directions.
TEST(MechanismResponses, OfABlockOnFourFeetAreThoseOfALongMarch) {
  std::string study = R"(
[parameters]
Omega = 1.0
[gravity]
acceleration = [1.5, 0.5, -9.0]
[[body]]
name = "block"
position = [0.0, 0.0, 0.1]
mass = 2.0
inertia = [0.02, 0.03, 0.04]
[[bushing]]
name = "mount"
between = ["ground", "block"]
at = [0.0, 0.0, 0.1]
stiffness = [800.0, 600.0, 0.0, 0.0, 0.0, 20.0]
damping = [20.0, 20.0, 20.0, 0.3, 0.3, 0.3]
[[force]]
on = "block.x"
amplitude = 5.0
angular_frequency = "Omega"
[[force]]
on = "block.y"
amplitude = 5.0
angular_frequency = "Omega"
phase = 1.0
[[force]]
on = "block.rz"
amplitude = 0.25
angular_frequency = "Omega"
)";
  int name = 0;
  for (const char* at : {"0.2, 0.1", "-0.2, 0.1", "0.2, -0.1", "-0.2, -0.1"})
    study += fmt::format(R"(
[[contact]]
name = "foot{}"
between = ["block", "ground"]
at = [{}, 0.0]
normal_direction = [0.0, 0.0, 1.0]
normal_stiffness = 1e4
tangential_stiffness = 5e3
friction_coefficient = 0.6
normal_load = 4.5
)",
                         ++name, at);
  expect_march(study, 60.0, march(60.0, 24, "1e-5"), {"\"harmonic_balance\"\ntolerance = 1e-3"}, 1.5e-2,
               {{"amplitude", "block.x"}, {"amplitude", "block.y"}, {"angle_amplitude", "block.rz"}});
}

}  // namespace
}  // namespace rubato::testing
