#pragma once

#include <rubato/numerics/gauss_legendre.hpp>

#include <cmath>

namespace rubato::model {

/// The solution of dy/dx = s - y, y = y0 at x = 0: what a bristle does along a slip in the direction s = 1 or -1, where
/// y is its force over its limit and x the travel over the length in which it yields.
struct Relaxation {
  double y0 = 0.0;  ///< at the start
  double s = 0.0;   ///< to which it comes

  /// y at x >= 0.
  double at(double x) const { return y0 - (s - y0) * std::expm1(-x); }

  /// The integral of y^2 from 0 to x: what is dissipated, over limit times length.
  double square(double x) const {
    const double left = y0 - s;
    constexpr double long_way = 1.0;  // beyond which nothing cancels in closed form
    if (x > long_way) return s * s * x - 2.0 * s * left * std::expm1(-x) - 0.5 * left * left * std::expm1(-2.0 * x);
    static const numerics::GaussLegendre<8> rule;
    double sum = 0.0;
    for (std::size_t i = 0; i < rule.node.size(); ++i) {
      const double y = s + left * std::exp(-rule.node[i] * x);
      sum += rule.weight[i] * y * y;
    }
    return sum * x;
  }
};

}  // namespace rubato::model
