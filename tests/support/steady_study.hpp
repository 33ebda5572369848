#pragma once

#include "support/ran_study.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

// Steady responses of a study beside a transient that settles to them. Omega is a parameter.
namespace rubato::testing {

/// 30 periods of 400 steps.
inline const std::string marched = R"(
[[analysis]]
name = "march"
type = "transient"
step = "2*pi/Omega/400"
duration = "60*pi/Omega"
)";

/// A frequency response at one point.
inline std::string response(const std::string& name, const std::string& rest) {
  return "[[analysis]]\nname = \"" + name + "\"\ntype = \"frequency_response\"\nangular_frequency = [3.0]\n" + rest;
}

struct Swing {
  double amplitude, mean;
};

/// Of the last period of `marched`.
inline Swing settled(const MemorySink& sink, const std::string& observed) {
  const auto& table = sink.tables.at("march");
  const std::size_t column = table.column("position", observed), last = table.rows.size() - 1;
  double low = HUGE_VAL, high = -HUGE_VAL, sum = 0.0;
  for (std::size_t i = last - 399; i <= last; ++i) {
    low = std::min(low, table.rows[i][column]);
    high = std::max(high, table.rows[i][column]);
    sum += table.rows[i][column];
  }
  return {0.5 * (high - low), sum / 400.0};
}

}  // namespace rubato::testing
