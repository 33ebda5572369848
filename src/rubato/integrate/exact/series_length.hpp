#pragma once

#include <rubato/core/types.hpp>

#include <array>
#include <cmath>

namespace rubato::integrate {

/// How many terms of the series of exp(x) are needed, for 0 <= x: those down to a neglected size x^k/k!.
class SeriesLength {
 public:
  static constexpr int most_terms = 32;

  /// @param neglected  > 0
  explicit SeriesLength(double neglected) {
    for (std::size_t k = 0; k < reach_.size(); ++k) {
      const auto order = static_cast<double>(k + 1);
      reach_[k] = std::exp((std::log(neglected) + std::lgamma(order + 1.0)) / order);
    }
  }

  /// At most `most`, from which it is searched downwards.
  Index terms(double x, Index most) const {
    while (most > 1 && reach_[static_cast<std::size_t>(most - 2)] >= x) --most;
    return most;
  }

 private:
  std::array<double, most_terms - 1> reach_;  // the largest x for 1, 2, ... terms
};

}  // namespace rubato::integrate
