#pragma once

#include <rubato/core/types.hpp>

#include <cmath>

namespace rubato::numerics {

/// A sum of products that keeps what rounding loses: as if computed with twice the digits and rounded once (Ogita, Rump
/// and Oishi, SIAM J. Sci. Comput. 26 (2005) 1955, Dot2).
class Compensated {
 public:
  void add_product(double a, double b) {
    const double product = a * b;
    add(product);
    lost_ += std::fma(a, b, -product);
  }
  void add(double value) {
    const double sum = sum_ + value, part = sum - sum_;
    lost_ += (sum_ - (sum - part)) + (value - part);
    sum_ = sum;
  }
  double value() const { return sum_ + lost_; }
  double sum() const { return sum_; }    ///< `value` in two parts
  double lost() const { return lost_; }  ///< what `sum` lost

 private:
  double sum_ = 0.0, lost_ = 0.0;
};

}  // namespace rubato::numerics
