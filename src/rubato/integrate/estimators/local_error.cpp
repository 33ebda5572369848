#include <rubato/integrate/estimators/error_constants.hpp>
#include <rubato/integrate/estimators/error_scales.hpp>
#include <rubato/integrate/estimators/estimators.hpp>
#include <rubato/integrate/estimators/slow_part.hpp>

#include <cmath>
#include <limits>
#include <numbers>

namespace rubato::integrate {
namespace {

/// J = A1 - A0 is h q''' in the middle of the step; the difference of two of them gives q''''. A restart leaves the
/// auxiliary acceleration where it must settle first, so that the first J after it is good for q''' alone.
class LocalErrorEstimator final : public Estimator {
 public:
  LocalErrorEstimator(const LocalError& kind, const ErrorConstants& constants, std::unique_ptr<ErrorSpace> space,
                      double duration)
      : tolerance_(kind.tolerance),
        c_(constants),
        space_(std::move(space)),
        scales_(*space_, duration, 3),
        duration_(duration),
        slow_(space_->size()),
        swing_(Vector::Zero(space_->size())),
        swing_now_(swing_),
        now_(space_->size()),
        last_(space_->size()) {}

  void start(const system::State& state) override {
    scales_.start(state);
    slow_.forget();
    swing_.setZero();
    elapsed_ = 0.0;
    forget();
  }

  double error(const system::State& from, const system::State& to, double h) override {
    now_.jump = to.auxiliary_acceleration - from.auxiliary_acceleration;
    now_.step = h;
    now_.product = space_->times_mass(now_.jump);
    now_.squared = now_.jump.dot(now_.product);
    now_.fourth = -1.0;
    is_contact_ = space_->touches(from) || space_->touches(to);
    const bool is_round_off = h * h * std::sqrt(now_.squared) < space_->round_off();  // never of structures
    if (c_.order == 1) {
      now_.third = now_.squared / (h * h);
      const double often = scales_.memory_of(now_.jump, now_.squared, h) / h;
      const double error = std::fmax(std::fmax(of_the_step(to, h), of_speed(to, h)) * often, of_swing(to, h));
      return is_round_off ? 0.0 : error;
    }
    slow_.look(now_.jump, h, std::cbrt(2.0 / (strength_ * h * h * scales_.memory())));
    now_.third = space_->squared(slow_.value());
    const double often = scales_.memory_of(slow_.value(), now_.third, h) / h;
    const double once = of_the_step(to, h);
    // What a contact leaves is not a vibration that will be out of phase: its few steps share a part of the tolerance.
    const double event = is_contact_ ? once * steps_of_a_contact : once;
    const double error = std::fmin(once * often, std::fmax(event, of_what_lasts(to, h) * often));
    return is_round_off ? 0.0 : error;
  }

  void accept(const system::State& to) override {
    if (c_.order == 1) {
      scales_.accept(now_.third, now_.fourth, to, now_.step);
      swing_.swap(swing_now_);
      elapsed_ += now_.step;
    } else {
      scales_.accept(now_.third, now_.fourth, to, now_.step);
      slow_.accept();
    }
    std::swap(now_, last_);
    if (known_ < 2) ++known_;
  }

  void forget() override { known_ = 0; }
  double tolerance() const override { return tolerance_; }
  int exponent() const override { return c_.order; }
  double size() const override { return scales_.size(); }

  double first_step() const override {
    const double third = scales_.third_derivative(), omega = scales_.frequency();
    if (!(third > 0.0)) return std::numeric_limits<double>::infinity();
    const double accepted = 0.5 * tolerance_ * scales_.size() / scales_.memory();
    if (c_.order == 1) return accepted * omega / (std::abs(c_.velocity) * third);
    return std::sqrt(accepted / (strength_ * third));
  }

 private:
  /// Of all of q'''.
  double of_the_step(const system::State& to, double h) {
    double dq_squared = now_.squared, dv_squared;
    if (known_ >= 2) {
      // q'''' = (J/h - J_last/h_last) over the distance of the two middles.
      const double distance = 0.5 * (h + last_.step) + c_.shift * (h - last_.step), ratio = 1.0 / last_.step;
      const double both = last_.jump.dot(now_.product);
      const auto squared = [&](double on_now, double on_last) {
        return std::fmax(
            0.0, on_now * on_now * now_.squared + 2.0 * on_now * on_last * both + on_last * on_last * last_.squared);
      };
      now_.fourth = squared(1.0 / (h * distance), -ratio / distance);
      const double next = c_.velocity_next * h * h * h / distance;
      dv_squared = squared(c_.velocity * h + next / h, -next * ratio);
    } else {
      // J alone may stand at a zero of its own.
      dq_squared = std::fmax(dq_squared, h * h * scales_.mean_square());
      // What has begun to touch swings by a frequency that no step has shown yet: J is of the whole step.
      const double swing = is_contact_ ? std::fmax(scales_.frequency(), 1.0 / h) : scales_.frequency();
      const double dv = std::abs(c_.velocity) * h + std::abs(c_.velocity_next) * h * h * swing;
      dv_squared = dv * dv * dq_squared;
    }
    const double dq = c_.displacement * h * h;
    const double change_squared = c_.order == 1 ? 0.0 : h * h * h * h * dq_squared;
    return relative(dq * dq * dq_squared, dv_squared, change_squared, to, is_contact_);
  }

  /// Of the slow part of q''', which is what the scales are told of.
  double of_what_lasts(const system::State& to, double h) {
    const double h3 = h * h * h;
    double third = now_.third, fourth;
    if (known_ >= 2) {
      now_.fourth = fourth = space_->squared(slow_.rate());
    } else {
      third = std::fmax(third, scales_.mean_square());
      fourth = third * std::pow(scales_.frequency(), 2);
    }
    const double dq = c_.displacement * h3, dv = c_.velocity_next * h3;
    return relative(dq * dq * third, dv * dv * fourth, h3 * h3 * third, to, false);
  }

  /// Over the tolerance. An error of velocity c h^3 q'''' is one of displacement c h^3 q''' at most, summed over the
  /// march (docs/theory/automatic-steps.md): the frequency by which it is divided may be that of a motion that has
  /// died.
  /// @param change_squared  |h^3 q'''|_M^2
  double relative(double dq_squared, double dv_squared, double change_squared, const system::State& to,
                  bool is_contact) const {
    const double least = 0.5 * strength_ * strength_ * change_squared;
    return std::fmax(scales_.relative(dq_squared, dv_squared, to, is_contact),
                     scales_.relative(least, 0.0, to, false)) /
           tolerance_;
  }

  /// Of a method of first order on what turns freely: dv = velocity h^2 q''' brakes it (q''' of a body that turns at
  /// Omega is -Omega^2 v), and what is lost of the speed lasts. Over a march of length T the place falls behind by T/2
  /// times the loss of all steps, where a vibration would by 1/omega times it.
  double of_speed(const system::State& to, double h) {
    if (!space_->turns_freely()) return 0.0;
    const double along = std::abs(now_.product.dot(to.v)), speed = space_->norm(to.v);
    if (!(speed > 0.0)) return 0.0;
    const double loss = std::abs(c_.velocity) * h * along / speed, behind = 0.5 * duration_ * loss;
    return scales_.relative(behind * behind, 0.0, to, false) / tolerance_;
  }

  /// Of a method of first order, without a frequency: the velocities velocity h^2 q''' that a march loses leave what
  /// the accelerations velocity h w less would, w = q'' less its mean since the start. A free motion w exp(-t/T) whose
  /// errors are forgotten over T errs by T/(2 e) times them at most (docs/theory/automatic-steps.md).
  double of_swing(const system::State& to, double h) {
    constexpr double share = 0.5 / std::numbers::e;
    swing_now_ = (elapsed_ / (elapsed_ + h)) * (swing_ + now_.jump);
    const double squared = space_->squared(swing_now_), time = scales_.decay_of(swing_now_, squared, h);
    const double most = share * c_.velocity * h * time;
    return scales_.relative(most * most * squared, 0.0, to, false) / tolerance_;
  }

  struct Difference {
    explicit Difference(Index n) : jump(n), product(n) {}
    Vector jump, product;  // J and M J
    double step = 0.0, squared = 0.0, third = 0.0, fourth = -1.0;
  };

  static constexpr double steps_of_a_contact = 16.0;

  double tolerance_;
  bool is_contact_ = false;
  ErrorConstants c_;
  double strength_ = std::hypot(c_.displacement, c_.velocity_next);
  std::unique_ptr<ErrorSpace> space_;
  ErrorScales scales_;
  double duration_;
  SlowPart slow_;
  Vector swing_, swing_now_;  // q'' less its mean, of the last accepted step and of the try
  double elapsed_ = 0.0;      // since the start
  Difference now_, last_;
  int known_ = 0;  // accepted steps since the start or the last kink, up to two
};

}  // namespace

std::unique_ptr<Estimator> make_local_error(const LocalError& kind, const ErrorConstants& constants,
                                            std::unique_ptr<ErrorSpace> space, double duration) {
  return std::make_unique<LocalErrorEstimator>(kind, constants, std::move(space), duration);
}

}  // namespace rubato::integrate
