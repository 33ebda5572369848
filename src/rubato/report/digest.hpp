#pragma once

#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

// What a report of constant size keeps of a signal of any length.
namespace rubato::report {

/// The extremes of a signal in buckets of consecutive rows, so that a plot of any length shows every peak.
///
/// Row r of n goes to bucket floor(r b / n) of b. A bucket gives two points, its extremes in the order in which they
/// came; NaN rows are passed over, and a bucket of nothing else gives NaN twice.
class Envelope {
 public:
  /// @param rows     how many will be added   @param buckets  how many of them to form; at most `rows` are
  Envelope(std::size_t rows, std::size_t buckets);

  /// The next row.
  void add(double value);

  /// [2 x buckets]: first and second extreme of each bucket.
  const std::vector<double>& points() const { return points_; }

  /// The first and the last row of each bucket, [2 x buckets]: where points() stand.
  static std::vector<std::size_t> rows_of_points(std::size_t rows, std::size_t buckets);

 private:
  std::size_t rows_, buckets_, row_ = 0;
  std::vector<double> points_;
};

/// Key numbers of a signal x(t), trapezoidal between rows, NaN passed over.
///
///   largest = max |x|,   rms = sqrt(integral x^2 dt / duration),
///   late_amplitude = (max x - min x)/2 over the last tenth of the duration
///
/// The root mean square weighs by time, since automatic steps crowd where the motion is fast.
class KeyNumbers {
 public:
  /// @param begin, end  first and last t
  KeyNumbers(double begin, double end) : late_from_(end - 0.1 * (end - begin)) {}

  void add(double t, double x);

  double largest() const { return largest_; }
  double rms() const;                                                              ///< |x| where there is one row only
  double late_amplitude() const { return 0.5 * (late_maximum_ - late_minimum_); }  ///< NaN where nothing is late
  double time_of_largest() const { return time_of_largest_; }                      ///< the first such t
  double last() const { return has_previous_ ? previous_x_ : NAN; }                ///< the last x

 private:
  double late_from_;
  bool has_previous_ = false;
  double previous_t_ = 0.0, previous_x_ = 0.0, integral_ = 0.0, duration_ = 0.0;
  double largest_ = NAN, time_of_largest_ = NAN, late_minimum_ = NAN, late_maximum_ = NAN;  // until a row comes
};

}  // namespace rubato::report
