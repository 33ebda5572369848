#include <rubato/core/error.hpp>
#include <rubato/integrate/estimators/estimators.hpp>

#include <cmath>
#include <limits>
#include <numbers>

namespace rubato::integrate {
namespace {

/// eps(Omega), the mean of the error over |y0| on one free mode (eq. 13).
double mean_error(double omega_h, const GeneralizedAlpha& p, bool as_printed) {
  const double end = 1.0 - p.alpha_f, square = omega_h * omega_h;
  const double share = as_printed ? 0.5 - p.beta : 0.5;
  return end * omega_h * square * std::sqrt(1.0 + share * share * square) /
         (3.0 * std::numbers::pi * (1.0 + end * p.beta * square));
}

class InertiaJumpEstimator final : public Estimator {
 public:
  InertiaJumpEstimator(const InertiaJump& kind, const GeneralizedAlpha& method, std::unique_ptr<ErrorSpace> space,
                       const system::State& start)
      : kind_(kind), space_(std::move(space)), jump_(space_->size()) {
    constexpr double cut_off = 0.6;  // Omega_K
    const double reference = kind.reference > 0.0 ? kind.reference : space_->displacement(start);
    if (!(reference > 0.0))
      throw InvalidInput(
          "inertia_jump measures by the initial displacements (reference = \"initial\"), and they vanish: give the "
          "reference value as a number, reference = l [m sqrt(kg)], or take the estimator local_error");
    scale_ = 1.0 / (6.0 * mean_error(cut_off, method, kind.as_printed) * reference * kind.tolerance);
  }

  void start(const system::State& state) override {
    const ResponseScales scales = space_->scales(state, state.auxiliary_acceleration, 1.0);
    // da = omega |a| h, or omega^2 |v| h where the start has no acceleration: half the tolerance.
    const double rate = scales.derivative(3);
    first_ = rate > 0.0 ? std::cbrt(0.5 / (scale_ * rate)) : std::numeric_limits<double>::infinity();
  }
  double error(const system::State& from, const system::State& to, double h) override {
    jump_ = to.auxiliary_acceleration - from.auxiliary_acceleration;
    return scale_ * h * h * space_->norm(jump_);
  }
  void accept(const system::State&) override {}
  void forget() override {}
  int exponent() const override { return 3; }
  double first_step() const override { return first_; }

 private:
  InertiaJump kind_;
  std::unique_ptr<ErrorSpace> space_;
  Vector jump_;
  double scale_ = 0.0;  ///< e over TOL is scale h^2 |da|_M
  double first_ = 0.0;
};

}  // namespace

std::unique_ptr<Estimator> make_inertia_jump(const InertiaJump& kind, const GeneralizedAlpha& method,
                                             std::unique_ptr<ErrorSpace> space, const system::State& start) {
  return std::make_unique<InertiaJumpEstimator>(kind, method, std::move(space), start);
}

}  // namespace rubato::integrate
