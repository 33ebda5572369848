#pragma once

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

}  // namespace rubato::testing
