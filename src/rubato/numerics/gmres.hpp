#pragma once

#include <rubato/core/types.hpp>

#include <algorithm>
#include <cmath>

namespace rubato::numerics {

/// Solves A x = b from products with A alone (Saad and Schultz 1986, algorithm 4: generalised minimal residual, without
/// restart). Holds its workspace.
class Gmres {
 public:
  /// @param multiply   (const Vector& x, Vector& y): y <- A x [n]
  /// @param tolerance  of the residual, relative to b [-]
  /// @param most       products
  /// @param x          written where it converged
  /// @returns how many products it took, or -1 where `most` were not enough
  template <class Multiply>
  int solve(const Vector& b, double tolerance, int most, Multiply&& multiply, Vector& x) {
    const double size = b.norm();
    if (!std::isfinite(size)) return -1;
    if (size == 0.0) {
      x = b;
      return 0;
    }
    basis_.resize(b.size(), most + 1);
    triangle_.setZero(most + 1, most);
    cosine_.resize(most);
    sine_.resize(most);
    right_.setZero(most + 1);
    right_[0] = size;
    basis_.col(0) = b / size;
    for (int k = 0; k < most; ++k) {
      direction_ = basis_.col(k);
      multiply(direction_, product_);
      for (int i = 0; i <= k; ++i) {
        triangle_(i, k) = basis_.col(i).dot(product_);
        product_ -= triangle_(i, k) * basis_.col(i);
      }
      const double rest = product_.norm();
      if (!std::isfinite(rest)) return -1;
      basis_.col(k + 1) = rest > 0.0 ? Vector(product_ / rest) : product_;
      // Rotations keep the columns triangular; the last entry of the right-hand side is the residual.
      for (int i = 0; i < k; ++i) {
        const double upper = triangle_(i, k), lower = triangle_(i + 1, k);
        triangle_(i, k) = cosine_[i] * upper + sine_[i] * lower;
        triangle_(i + 1, k) = cosine_[i] * lower - sine_[i] * upper;
      }
      const double length = std::hypot(triangle_(k, k), rest);
      if (!(length > 0.0)) return -1;
      cosine_[k] = triangle_(k, k) / length;
      sine_[k] = rest / length;
      triangle_(k, k) = length;
      right_[k + 1] = -sine_[k] * right_[k];
      right_[k] *= cosine_[k];
      if (std::abs(right_[k + 1]) > tolerance * size) continue;
      x = basis_.leftCols(k + 1) *
          triangle_.topLeftCorner(k + 1, k + 1).triangularView<Eigen::Upper>().solve(right_.head(k + 1));
      return k + 1;
    }
    return -1;
  }

 private:
  Matrix basis_, triangle_;
  Vector cosine_, sine_, right_, direction_, product_;
};

}  // namespace rubato::numerics
