#pragma once

#include "support/memory_sink.hpp"
#include "support/ran_study.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace rubato::testing {

/// A response of the model before it.
inline std::string response_about_rest(const std::string& frequencies, const std::string& more = "about = \"static\"") {
  return R"(
[[analysis]]
name = "frf"
type = "frequency_response"
angular_frequency = )" +
         frequencies + "\n" + more + "\n";
}

/// A bob on a rod that swings under its weight.
inline const std::string swinging_bob = R"(
[parameters]
Omega = 1.0
F = 0.05
[gravity]
acceleration = [0.0, -9.81]
[[body]]
name = "bob"
mass = 1.5
inertia = 0.02
position = [0.0, -0.8]
[[joint]]
name = "pivot"
type = "revolute"
between = ["ground", "bob"]
at = [0.0, 0.0]
damping = 0.35
[[force]]
on = "bob.x"
amplitude = "F"
angular_frequency = "Omega"
)";

/// Two bodies on rails, and the same as masses.
inline const std::string two_carriages = R"(
[parameters]
Omega = 1.0
[[body]]
name = "a"
mass = 2.0
inertia = 0.1
position = [0.0, 0.0]
[[body]]
name = "b"
mass = 1.0
inertia = 0.1
position = [1.0, 0.0]
[[joint]]
name = "rail_a"
type = "prismatic"
between = ["ground", "a"]
at = [0.0, 0.0]
axis = [1.0, 0.0]
stiffness = 40.0
damping = 0.3
[[joint]]
name = "rail_b"
type = "prismatic"
between = ["ground", "b"]
at = [1.0, 0.0]
axis = [1.0, 0.0]
[[spring]]
between = ["a.x", "b.x"]
stiffness = 25.0
[[damper]]
between = ["a.x", "b.x"]
damping = 0.2
[[force]]
on = "b.x"
amplitude = 3.0
angular_frequency = "Omega"
phase = 0.4
)";

inline const std::string two_masses = R"(
[parameters]
Omega = 1.0
[[coordinate]]
name = "a.x"
mass = 2.0
[[coordinate]]
name = "b.x"
mass = 1.0
[[spring]]
between = ["a.x", "ground"]
stiffness = 40.0
[[damper]]
between = ["a.x", "ground"]
damping = 0.3
[[spring]]
between = ["a.x", "b.x"]
stiffness = 25.0
[[damper]]
between = ["a.x", "b.x"]
damping = 0.2
[[force]]
on = "b.x"
amplitude = 3.0
angular_frequency = "Omega"
phase = 0.4
)";

/// Responses of both, but for what sliders and laws tell.
inline void expect_same(const MemorySink& one, const MemorySink& other, std::size_t rows, double tolerance) {
  for (std::size_t row = 0; row < rows; ++row)
    for (const char* label : {"a.x", "b.x"})
      for (const char* variable :
           {"amplitude", "velocity_amplitude", "acceleration_amplitude", "phase", "viscous_work", "input_work"}) {
        const std::string of = std::string(variable).find("work") == std::string::npos ? label : "";
        const double wanted = value_of(other, "frf", variable, of, row);
        EXPECT_NEAR(value_of(one, "frf", variable, of, row), wanted, tolerance * (1.0 + std::abs(wanted)))
            << variable << " of " << label << " at row " << row;
      }
}

/// A march of the same model that is long enough to forget its start.
inline std::string march(double omega, int periods, const std::string& tolerance = "1e-7") {
  const double period = 2.0 * std::numbers::pi / omega;
  return fmt::format(R"(
[[analysis]]
name = "march"
type = "transient"
initial = "static"
duration = {:.17g}
step = {{ tolerance = {} }}
output = {{ interval = {:.17g} }}
)",
                     period * periods, tolerance, period / 256.0);
}

/// Half of the peak to peak of a column over the last period of a march of 256 rows a period.
inline double last_amplitude(const MemorySink& sink, const std::string& variable, const std::string& label) {
  const auto& table = sink.tables.at("march");
  const std::size_t column = table.column(variable, label), rows = table.rows.size();
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (std::size_t row = rows - 257; row < rows; ++row) {
    low = std::min(low, table.rows[row][column]);
    high = std::max(high, table.rows[row][column]);
  }
  return 0.5 * (high - low);
}

}  // namespace rubato::testing
