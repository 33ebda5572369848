#pragma once

#include <rubato/system/loads.hpp>

#include <cmath>
#include <cstddef>
#include <limits>
#include <variant>
#include <vector>

namespace rubato::integrate {

/// The values of the laws of all load terms at both ends of a step. The end of one step is the start of the next:
/// harmonic values are kept, so that a step costs one cosine a term.
class LoadValues {
 public:
  explicit LoadValues(const system::Loads& loads) : loads_(loads), start_(count()), end_(count()) {}

  std::size_t count() const { return loads_.terms().size(); }

  /// Evaluates at t0 from the right and at t1 from the left.
  void evaluate(double t0, double t1) {
    const auto& terms = loads_.terms();
    const bool known = t0 == end_time_;
    for (std::size_t i = 0; i < terms.size(); ++i) {
      const auto* harmonic = std::get_if<model::HarmonicLaw>(&terms[i].law);
      start_[i] = known && harmonic ? end_[i] : model::value(terms[i].law, t0, model::Side::right);
    }
    evaluate_end(t1);
  }
  /// Evaluates at t1 from the left only.
  void evaluate_end(double t1) {
    const auto& terms = loads_.terms();
    for (std::size_t i = 0; i < terms.size(); ++i) {
      const auto* harmonic = std::get_if<model::HarmonicLaw>(&terms[i].law);
      end_[i] = harmonic ? std::cos(harmonic->angular_frequency * t1 + harmonic->phase)
                         : model::value(terms[i].law, t1, model::Side::left);
    }
    end_time_ = t1;
  }

  /// Where a load that is not finite acts, or -1: the solution would blame every coordinate.
  Index fault() const {
    for (std::size_t i = 0; i < count(); ++i)
      if (!std::isfinite(end_[i]) || !std::isfinite(start_[i])) return loads_.terms()[i].rows.front();
    return -1;
  }

  double start(std::size_t i) const { return start_[i]; }
  double end(std::size_t i) const { return end_[i]; }
  const system::Loads& loads() const { return loads_; }

 private:
  system::Loads loads_;  // a copy: formulas are workspaces
  std::vector<double> start_, end_;
  double end_time_ = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace rubato::integrate
