#pragma once

#include <fmt/format.h>

#include <string>

namespace rubato::testing {

/// A study of a steel strip of 1 m along x, clamped at the origin, in the plane or in space, without analyses.
/// @param beam, material  further keys of each
inline std::string strip(const std::string& beam, const std::string& material, bool in_space = false) {
  return fmt::format(R"(
[[node]]
name = "a"
position = [0.0, 0.0{0}]
[[node]]
name = "b"
position = [1.0, 0.0{0}]
[[support]]
node = "a"
fix = [{1}]
[[material]]
name = "steel"
young = 2.1e11
poisson = 0.3
density = 7800.0
{2}
[[section]]
name = "strip"
area = 1e-4
inertia = {3}
shear_factor = 0.83
[[beam]]
name = "arm"
nodes = ["a", "b"]
section = "strip"
material = "steel"
{4}
)",
                     in_space ? ", 0.0" : "", in_space ? R"("x", "y", "z", "rx", "ry", "rz")" : R"("x", "y", "rz")",
                     material, in_space ? "[8e-10, 9e-10]\ntorsion = 1.4e-9" : "8e-10", beam);
}

}  // namespace rubato::testing
