#include <rubato/integrate/estimators/slow_part.hpp>

#include <cmath>

namespace rubato::integrate {

SlowPart::SlowPart(Index n)
    : first_(Vector::Zero(n)), second_(first_), third_(first_), value_(first_), rate_(first_), x_(first_) {}

void SlowPart::look(const Vector& change, double h, double cut) {
  x_ = change / h;
  h_ = h;
  if (is_new_) {
    value_ = x_;
    rate_.setZero();
    return;
  }
  const double share = share_ = std::fmax(cut * h / (1.0 + cut * h), h / (elapsed_ + h));
  for (Index i = 0; i < x_.size(); ++i) {
    const double first = first_[i] + share * (x_[i] - first_[i]);
    const double second = second_[i] + share * (first - second_[i]);
    const double third = third_[i] + share * (second - third_[i]);
    value_[i] = third;
    rate_[i] = cut * (second - third);
  }
}

void SlowPart::accept() {
  if (is_new_) {
    first_ = second_ = third_ = x_;
    is_new_ = false;
    elapsed_ = h_;
    return;
  }
  for (Index i = 0; i < x_.size(); ++i) {
    first_[i] += share_ * (x_[i] - first_[i]);
    second_[i] += share_ * (first_[i] - second_[i]);
    third_[i] = value_[i];
  }
  elapsed_ += h_;
}

}  // namespace rubato::integrate
