#pragma once

namespace rubato::numerics {

/// A number that changes with time, with its first two derivatives.
struct TimeDerivatives {
  double value = 0.0, rate = 0.0, second_rate = 0.0;
};

}  // namespace rubato::numerics
