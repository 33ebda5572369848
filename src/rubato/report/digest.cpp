#include <rubato/report/digest.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace rubato::report {

Envelope::Envelope(std::size_t rows, std::size_t buckets)
    : rows_(rows), buckets_(std::min(buckets, rows)), points_(2 * buckets_, std::numeric_limits<double>::quiet_NaN()) {}

void Envelope::add(double value) {
  assert(row_ < rows_);
  const std::size_t bucket = row_ * buckets_ / rows_;
  ++row_;
  if (std::isnan(value)) return;
  double& first = points_[2 * bucket];
  double& second = points_[2 * bucket + 1];
  if (std::isnan(first)) {
    first = second = value;
    return;
  }
  const double low = std::min(first, second), high = std::max(first, second);
  if (value > high) {
    first = low;
    second = value;
  } else if (value < low) {
    first = high;
    second = value;
  }
}

std::vector<std::size_t> Envelope::rows_of_points(std::size_t rows, std::size_t buckets) {
  buckets = std::min(buckets, rows);
  std::vector<std::size_t> out;
  out.reserve(2 * buckets);
  // The first row of bucket k is the least r with floor(r b / n) = k.
  const auto first_row = [&](std::size_t k) { return (k * rows + buckets - 1) / buckets; };
  for (std::size_t k = 0; k < buckets; ++k) {
    out.push_back(first_row(k));
    out.push_back(first_row(k + 1) - 1);
  }
  return out;
}

void KeyNumbers::add(double t, double x) {
  if (std::isnan(t) || std::isnan(x)) return;
  if (!(std::abs(x) <= largest_)) {  // NaN stands for nothing
    largest_ = std::abs(x);
    time_of_largest_ = t;
  }
  if (t >= late_from_) {
    late_minimum_ = std::fmin(late_minimum_, x);
    late_maximum_ = std::fmax(late_maximum_, x);
  }
  if (has_previous_) {
    integral_ += 0.5 * (t - previous_t_) * (x * x + previous_x_ * previous_x_);
    duration_ += t - previous_t_;
  }
  has_previous_ = true;
  previous_t_ = t;
  previous_x_ = x;
}

double KeyNumbers::rms() const { return duration_ > 0.0 ? std::sqrt(integral_ / duration_) : largest_; }

}  // namespace rubato::report
