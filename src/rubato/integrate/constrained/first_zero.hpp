#pragma once

namespace rubato::integrate {

/// Where a cubic first becomes negative, and where it is most so, of eight parts of the interval.
struct FirstZero {
  double at = 2.0;    ///< 2: nowhere
  double seen = 1.0;  ///< 1 where the cubic is negative at the end
};

/// Of the cubic through values and slopes at both ends of [0, 1], from `least` on.
FirstZero first_zero(double least, double y0, double slope0, double y1, double slope1);

}  // namespace rubato::integrate
