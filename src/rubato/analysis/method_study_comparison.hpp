#pragma once

#include <rubato/analysis/method_study_plan.hpp>
#include <rubato/integrate/driver.hpp>

#include <atomic>
#include <limits>
#include <vector>

namespace rubato::analysis {

/// The observed displacement of the exact response of a linear model under harmonic loads.
struct ExactResponse {
  std::vector<double> values;  ///< at the multiples of the step, from 0 on
  double largest = 0.0;        ///< |x| over the whole run, also between the samples
};

/// The exact displacement at the multiples of a step, by the event-driven flow (Taylor pieces, exact to round-off
/// whatever the roots of the structure: at resonance, without damping, overdamped). `largest` is an extremum of a
/// piece, however long the step is beside the periods of the structure.
ExactResponse exact_response(const MethodStudyPlan& plan, const integrate::SystemKind& kind, double step);

/// Compares every step of a march with the exact displacement.
class Comparison final : public integrate::Observer {
 public:
  /// @param exact   the exact displacement [m] at the multiples of a sampling step
  /// @param stride  samples a step of the march; negative: steps a sample
  Comparison(const MethodStudyPlan& plan, const std::vector<double>& exact, long stride, const std::atomic<bool>& stop)
      : plan_(plan), exact_(exact), stride_(stride), stop_(stop) {}

  bool accepted(const system::State&, const system::State& after) override {
    ++steps_;
    const double x = plan_.observed.of(after.q);
    if (keep_values) values.push_back(x);
    const bool on_grid = stride_ > 0 ? true : steps_ % -stride_ == 0;
    const auto place = static_cast<std::size_t>(stride_ > 0 ? steps_ * stride_ : steps_ / -stride_);
    if (on_grid && place < exact_.size()) {
      const double error = std::abs(x - exact_[place]);
      if (steps_ == 1 && exact_[place] != 0.0) first_ = error / std::abs(exact_[place]);
      largest_ = std::max(largest_, error);
      sum_ += error;
      ++compared_;
    }
    return !stop_.load(std::memory_order_relaxed);
  }
  double first() const { return first_; }      ///< |x1 - x(h)|/|x(h)|; NaN where x(h) is 0
  double largest() const { return largest_; }  ///< [m]
  double mean() const {                        ///< over the compared samples [m]
    return sum_ / static_cast<double>(std::max(compared_, 1L));
  }

  bool keep_values = false;
  std::vector<double> values;

 private:
  const MethodStudyPlan& plan_;
  const std::vector<double>& exact_;
  long stride_;
  const std::atomic<bool>& stop_;
  long steps_ = 0, compared_ = 0;
  double first_ = std::numeric_limits<double>::quiet_NaN(), largest_ = 0.0, sum_ = 0.0;
};

}  // namespace rubato::analysis
