#pragma once

#include <rubato/integrate/driver.hpp>
#include <rubato/integrate/exact/exact_flow.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace rubato::testing {

/// The largest error of q in the mass norm over the largest |q|_M, at the accepted steps of a march, against the exact
/// flow from the same start. Call finish() after the march.
class ExactErrors final : public integrate::Observer {
 public:
  ExactErrors(const system::LocallyNonlinear& system, system::State start)
      : system_(system), flow_(system), state_(std::move(start)) {}

  bool accepted(const system::State&, const system::State& after) override {
    times_.push_back(after.t);
    marched_.push_back(after.q);
    if (times_.size() == chunk) finish();
    return true;
  }
  void finish() {
    if (times_.empty()) return;
    Visitor visitor(*this);
    sound_ &= flow_.advance(state_, times_.back(), times_, visitor).end == integrate::ExactEnd::reached;
    sound_ &= visitor.next == times_.size();
    times_.clear();
    marched_.clear();
  }
  /// NaN where the exact flow itself failed.
  double relative() const { return sound_ ? largest_ / size_ : std::nan(""); }

 private:
  static constexpr std::size_t chunk = 1024;

  struct Visitor final : integrate::ExactVisitor {
    explicit Visitor(ExactErrors& all) : errors(all) {}
    bool sample(const system::State& exact, const integrate::ExactWork&) override {
      errors.compare(errors.marched_[next++], exact.q);
      return true;
    }
    bool transition(const system::State&, const integrate::Transition&, const integrate::ExactWork&) override {
      return true;
    }
    ExactErrors& errors;
    std::size_t next = 0;
  };

  void compare(const Vector& marched, const Vector& exact) {
    const Vector error = marched - exact;
    largest_ = std::max(largest_, std::sqrt(error.dot(system_.mass() * error)));
    size_ = std::max(size_, std::sqrt(exact.dot(system_.mass() * exact)));
  }

  const system::LocallyNonlinear& system_;
  integrate::ExactFlow flow_;
  system::State state_;
  std::vector<double> times_;
  std::vector<Vector> marched_;
  double largest_ = 0.0, size_ = 0.0;
  bool sound_ = true;
};

}  // namespace rubato::testing
