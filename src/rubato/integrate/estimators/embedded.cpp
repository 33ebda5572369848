#include <rubato/core/error.hpp>
#include <rubato/integrate/estimators/error_scales.hpp>
#include <rubato/integrate/estimators/estimators.hpp>
#include <rubato/integrate/methods/steppers.hpp>

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace rubato::integrate {
namespace {

/// What both have in common: the difference (dq, dv) of two solutions, and the scales of the motion from the changes of
/// displacement and velocity over the steps.
class EmbeddedEstimator : public Estimator {
 public:
  /// @param decay  of a peak of the error over the phase omega t: an error that follows one derivative of the motion
  ///               alone passes through zero, and a step that grows there is rejected soon after; infinity: no peaks
  EmbeddedEstimator(double tolerance, double decay, const system::LocallyNonlinear& system, double duration,
                    const std::vector<numerics::StepBound>& bounds)
      : tolerance_(tolerance),
        space_(make_error_space(system, duration, bounds)),
        scales_(*space_, duration, 1),
        decay_(decay),
        dq_(system.size()),
        dv_(system.size()),
        change_(system.size()) {}

  void start(const system::State& state) override {
    scales_.start(state);
    forget();
  }

  double error(const system::State& from, const system::State& to, double h) override {
    h_ = h;
    change_ = to.q - from.q;
    rate_ = space_->squared(change_) / (h * h);
    change_ = to.v - from.v;
    changed_ = space_->squared(change_);
    memory_ = scales_.memory_of(change_, changed_, h);
    differ(from, to, h);
    const double now =
        scales_.relative(space_->squared(dq_), space_->squared(dv_), to, space_->touches(from) || space_->touches(to)) *
        factor(h, memory_) / tolerance_;
    const double power = std::pow(h, exponent());
    density_now_ = std::fmax(now / power, density_ * std::exp(-decay_ * scales_.frequency() * h));
    return std::isfinite(now) ? density_now_ * power : now;
  }
  void accept(const system::State& to) override {
    density_ = density_now_;
    scales_.accept(rate_, changed_ / (h_ * h_), to, h_);
  }
  void forget() override { density_ = 0.0; }

 protected:
  virtual void differ(const system::State& from, const system::State& to, double h) = 0;
  /// What turns the difference into the error.
  /// @param memory  over which errors add up [s]
  virtual double factor(double h, double memory) const = 0;

  double tolerance_;
  std::unique_ptr<ErrorSpace> space_;
  ErrorScales scales_;

 private:
  double decay_;
  double density_ = 0.0, density_now_ = 0.0;  // error over h^exponent

 protected:
  Vector dq_, dv_;

 private:
  Vector change_;  // of the velocity
  double h_ = 0.0, rate_ = 0.0, changed_ = 0.0, memory_ = 0.0;
};

/// Coefficients of z^k in the polynomial that a tableau makes of y' = z y/h with given weights.
std::vector<double> stability_polynomial(const numerics::ButcherTableau& t, const std::array<double, 7>& weights) {
  const auto stages = static_cast<std::size_t>(t.stages);
  std::vector<double> power(stages, 1.0), coefficients{1.0};
  for (std::size_t k = 0; k < stages; ++k) {
    double sum = 0.0;
    for (std::size_t i = 0; i < stages; ++i) sum += weights[i] * power[i];
    coefficients.push_back(sum);
    std::vector<double> next(stages, 0.0);
    for (std::size_t i = 0; i < stages; ++i)
      for (std::size_t j = 0; j < i; ++j) next[i] += t.a[i][j] * power[j];
    power = next;
  }
  coefficients.push_back(0.0);
  return coefficients;
}

/// Per step, since the march carries on with the better solution, of order p: on a linear mode its global error is
/// omega T C (omega h)^p with C z^(p + 1) its local error, and the difference is D (omega h)^p. So the difference times
/// omega T C/D is that global error.
class PairEstimator final : public EmbeddedEstimator {
 public:
  PairEstimator(double tolerance, const numerics::ButcherTableau& pair, const system::LocallyNonlinear& system,
                const Stepper& stepper, double duration, const std::vector<numerics::StepBound>& bounds)
      : EmbeddedEstimator(tolerance, std::numeric_limits<double>::infinity(), system, duration, bounds),
        order_(pair.embedded_order + 1),
        stepper_(stepper) {
    const auto better = stability_polynomial(pair, pair.b), other = stability_polynomial(pair, pair.embedded);
    const auto p = static_cast<std::size_t>(pair.order), difference = static_cast<std::size_t>(order_);
    difference_ = std::abs(better[difference] - other[difference]);
    calibration_ = std::abs(better[p + 1] - 1.0 / std::tgamma(static_cast<double>(p) + 2.0)) / difference_;
  }

  int exponent() const override { return order_; }
  double first_step() const override {
    if (!(scales_.third_derivative() > 0.0)) return std::numeric_limits<double>::infinity();
    return std::pow(0.5 * tolerance_ / (factor(0.0, scales_.memory()) * difference_), 1.0 / order_) /
           scales_.frequency();
  }

 private:
  void differ(const system::State&, const system::State&, double) override {
    (void)stepper_.embedded_difference(dq_, dv_);
  }
  double factor(double, double memory) const override {
    return std::fmax(1.0, calibration_ * scales_.frequency() * memory);
  }

  int order_;
  const Stepper& stepper_;
  double difference_ = 0.0, calibration_ = 0.0;  // D and C/D
};

/// Wilson-theta carries A = q'' + theta (theta - 1)/2 h^2 q'''', so that its velocity errs by (1/12 + theta (theta -
/// 1)/2) h^3 q'''' a step. From the same state linear acceleration, which meets equilibrium at the end of the step,
/// differs by theta (theta - 1)/4 h^3 q''''. Where a step ends as a stop closes, their difference is no such error: the
/// force at t + theta h is of a contact that the step has not met, and its error passes for a small one (a hard stop
/// with 0.3 of critical damping threw a mass back with 0.13 m/s instead of 0.36 at any tolerance) or for one that no
/// shortening lowers. So it is refused there.
class WilsonEstimator final : public EmbeddedEstimator {
 public:
  WilsonEstimator(double tolerance, double theta, const system::LocallyNonlinear& system, double duration,
                  const std::vector<numerics::StepBound>& bounds)
      : EmbeddedEstimator(tolerance, 0.5, system, duration, bounds),
        linear_(make_alpha_stepper(GeneralizedAlpha{0.0, 0.0, 1.0 / 6.0, 0.5}, system)),
        other_(system.start()),
        carried_(error_constants(WilsonTheta{theta}).velocity_next),
        calibration_(carried_ / (0.25 * theta * (theta - 1.0))) {}

  int exponent() const override { return 2; }
  int solves_a_try() const override { return 1; }
  int factorisations() const override { return linear_->factorisations(); }
  double first_step() const override {
    const double third = scales_.third_derivative();
    if (!(third > 0.0)) return std::numeric_limits<double>::infinity();
    return std::sqrt(0.5 * tolerance_ * scales_.size() / (scales_.memory() * carried_ * third));
  }

 private:
  void differ(const system::State& from, const system::State& to, double h) override {
    const StepReport report = linear_->attempt(from, h, to.t, other_);
    if (report.outcome != StepOutcome::accepted) {  // what cannot be compared is not accepted
      dq_.setConstant(std::numeric_limits<double>::infinity());
      return;
    }
    dq_ = to.q - other_.q;
    dv_ = to.v - other_.v;
  }
  double factor(double h, double memory) const override { return calibration_ * memory / h; }

  std::unique_ptr<Stepper> linear_;
  system::State other_;
  double carried_, calibration_;
};

}  // namespace

bool can_embed(const Method& method) {
  const auto* pair = std::get_if<RungeKutta>(&method.formula);
  return (pair && pair->tableau.embedded_order > 0) || std::holds_alternative<WilsonTheta>(method.formula);
}

std::unique_ptr<Estimator> make_embedded(const Embedded& kind, const Method& method,
                                         const system::LocallyNonlinear& system, Stepper& stepper, double duration,
                                         const std::vector<numerics::StepBound>& bounds) {
  const auto* wilson = std::get_if<WilsonTheta>(&method.formula);
  if (wilson && (system.stop_count() > 0 || system.block_count() > 0))
    throw InvalidInput(
        "the estimator embedded of wilson_theta compares two solutions of which one looks beyond the end of a step, at "
        "stops and contacts that the motion has not met; take the estimator local_error");
  if (wilson) return std::make_unique<WilsonEstimator>(kind.tolerance, wilson->theta, system, duration, bounds);
  if (!can_embed(method))
    throw InvalidInput(fmt::format(
        "the estimator embedded compares two solutions of a step, and {} has one; take {}", method.name,
        std::holds_alternative<RungeKutta>(method.formula)         ? "the method bogacki_shampine or dormand_prince"
        : std::holds_alternative<GeneralizedAlpha>(method.formula) ? "the estimator local_error"
                                                                   : "a fixed step, or the method generalized_alpha"));
  const auto& pair = std::get<RungeKutta>(method.formula).tableau;
  return std::make_unique<PairEstimator>(kind.tolerance, pair, system, stepper, duration, bounds);
}

}  // namespace rubato::integrate
