#pragma once

#include <rubato/core/types.hpp>
#include <rubato/steady/trigonometric_series.hpp>

#include <unsupported/Eigen/FFT>

#include <vector>

namespace rubato::steady {

/// Equal angles over a period, the ways between values at them and Fourier series, and the orders that are wanted.
class SampleAngles {
 public:
  /// @param count  a power of two, more than twice the highest order
  void prepare(int count, const Orders& orders);
  int count() const { return static_cast<int>(circle_.size()); }
  const Orders& orders() const { return orders_; }
  Complex unit_vector(long i) const { return circle_[static_cast<std::size_t>(i % count())]; }
  /// Values of sum over the orders of Re(c_k exp(i k theta)).
  void synthesise(const Orders& orders, const ComplexVector& coefficients, Vector& values);
  /// 2/N sum over the values of x exp(-i k theta), for k from 0 to N/2.
  const std::vector<Complex>& analyse(const double* values);

 private:
  Orders orders_;
  std::vector<Complex> circle_;  ///< exp(i theta)
  Eigen::FFT<double> transform_;
  std::vector<Complex> spectrum_, values_;
  std::vector<double> samples_;
};

/// How the memory of laws is made to repeat: by itself first, then by Newton's method on it, which also closes loops
/// that hardly forget.
struct Closing {
  static constexpr double difference = 1.5e-8;    ///< of a scale: the square root of round-off
  static constexpr double closed = 1e-14;         ///< of the memory's largest numbers
  static constexpr double nearly_closed = 1e-10;  ///< what round-off may leave where a law forgets slowly
  static constexpr int plain_periods = 2;         ///< before Newton's method: laws that forget are closed then
  static constexpr int most_periods = 60;
  /// 1 - the slope of a memory by itself a period ago, below which it keeps what it was: slopes of many steps by
  /// differences are no better known.
  static constexpr double forgets = 1e-9, forgets_by_differences = 1e-5;

  /// (1 - A)^+ x: what a memory keeps for ever is left as it is.
  static Matrix solve(const Matrix& by_start, const Matrix& x, double least);
  /// Goes round from a memory until it repeats. Writes the memories at the start of each period that was marched.
  /// @param march   (start, end): a period   @param length  the largest numbers of the memory in it
  /// @param carry   (start): the slopes of the memory at the end of a period by that at its start
  /// @return whether it repeats
  template <class March, class Carry>
  static bool close(Vector start, const Vector& length, double least_forgotten, March&& march, Carry&& carry,
                    std::vector<Vector>& started);
};

template <class March, class Carry>
bool Closing::close(Vector start, const Vector& length, double least_forgotten, March&& march, Carry&& carry,
                    std::vector<Vector>& started) {
  started.clear();
  Vector end(start.size()), proposal;
  double last = HUGE_VAL;
  for (int period = 0;; ++period) {
    started.push_back(start);
    march(start, end);
    double error = 0.0;
    for (Index i = 0; i < start.size(); ++i)
      if (end[i] != start[i]) error = std::max(error, std::abs(end[i] - start[i]) / length[i]);
    const bool has_closed = error <= nearly_closed;
    if (error <= closed || !(error < HUGE_VAL) || period >= most_periods) return has_closed;
    if (has_closed && !(error < 0.5 * last)) return true;  // round-off
    const bool leaps = period >= plain_periods && error < last;
    last = error;
    if (leaps) {
      proposal = start + solve(carry(start), end - start, least_forgotten);
      if (proposal.allFinite()) {
        start = proposal;
        continue;
      }
    }
    start = end;
  }
}

}  // namespace rubato::steady
