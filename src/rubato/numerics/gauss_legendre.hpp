#pragma once

#include <array>
#include <cmath>
#include <numbers>

namespace rubato::numerics {

/// Nodes and weights of Gauss-Legendre quadrature on [0, 1]: exact for polynomials of degree 2 points - 1.
template <int points>
struct GaussLegendre {
  std::array<double, points> node, weight;

  /// By Newton on the Legendre polynomial.
  GaussLegendre() {
    for (int i = 0; i < points; ++i) {
      double x = std::cos(std::numbers::pi * (i + 0.75) / (points + 0.5)), slope = 0.0;
      for (int k = 0; k < 20; ++k) {
        double p0 = 1.0, p1 = x;
        for (int j = 2; j <= points; ++j) {
          const double p2 = ((2.0 * j - 1.0) * x * p1 - (j - 1.0) * p0) / j;
          p0 = p1;
          p1 = p2;
        }
        slope = points * (x * p1 - p0) / (x * x - 1.0);
        x -= p1 / slope;
      }
      node[static_cast<std::size_t>(i)] = 0.5 * (1.0 + x);
      weight[static_cast<std::size_t>(i)] = 1.0 / ((1.0 - x * x) * slope * slope);
    }
  }
};

}  // namespace rubato::numerics
