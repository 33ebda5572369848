#pragma once

#include <cstddef>
#include <vector>

namespace rubato::model {

/// A force over a joint's coordinate s, interpolated linearly, and its potential.
struct CoordinateTable {
  enum class Beyond { error, zero, hold };  ///< outside the rows: no number, nothing, or the last force

  std::vector<double> at;         ///< s, strictly rising, two or more [rad] or [m]
  std::vector<double> force;      ///< on s [N m] or [N]
  std::vector<double> potential;  ///< -(integral of the force over s), lowest 0, at the rows [J]; see make_table
  Beyond before = Beyond::error, after = Beyond::error;

  struct Value {
    double force = 0.0, slope = 0.0, potential = 0.0;
  };
  Value operator()(double s) const;
};

/// @param at  strictly rising, two or more, as many as forces
CoordinateTable make_table(std::vector<double> at, std::vector<double> force, CoordinateTable::Beyond beyond);

}  // namespace rubato::model
