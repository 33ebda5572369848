#include <rubato/integrate/adaptive_march.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace rubato::integrate {
namespace {

constexpr double same_step = 1e-9;  // relative: differences of times are not steps to the last bit

TryOutcome outcome_of(StepOutcome failure) {
  switch (failure) {
    case StepOutcome::not_converged:
      return TryOutcome::not_converged;
    case StepOutcome::singular:
      return TryOutcome::singular;
    default:
      return TryOutcome::not_finite;
  }
}

class Marcher {
 public:
  Marcher(Stepper& stepper, Estimator& estimator, const StepPlan& plan, const system::LocallyNonlinear& system,
          system::State& state, double end, Observer* observer, TryLog* log)
      : stepper_(stepper),
        estimator_(estimator),
        plan_(plan),
        system_(system),
        base_(state),
        prepared_(state),
        to_(state),
        end_(end),
        observer_(observer),
        log_(log),
        loads_(system.loads()),
        left_(system.size()),
        right_(system.size()),
        stops_(loads_.breakpoints(state.t, end)) {
    stops_.push_back(end);
  }

  AdaptiveReport run() {
    estimator_.start(base_);
    wanted_ = first_step();
    if (plan_.first > 0.0) wanted_ = plan_.first;
    base_step_ = wanted_;
    while (base_.t < end_ && goes_on_) take_step();
    report_.factorisations = stepper_.factorisations() + estimator_.factorisations();
    return report_;
  }
  const system::State& state() const { return base_; }

 private:
  /// Where nothing moves and nothing says how long a step may be, a thousandth of the march is a start.
  double first_step() const {
    const double step = estimator_.first_step();
    return std::min(plan_.largest, std::isfinite(step) ? step : 1e-3 * (end_ - base_.t));
  }

  struct Length {
    double step, t1;
    double lost;   // what rounding took from t1 [s]
    bool arrives;  // at the next stop
  };

  /// The step to try: not beyond the next stop, and equal parts of the way to one that is not the end.
  Length next_length() const {
    const double stop = stops_[next_stop_], rest = stop - base_.t;
    double step = std::min(wanted_, plan_.largest);
    const bool arrives = step >= rest * (1.0 - same_step);
    if (arrives)
      step = rest;
    else if (next_stop_ + 1 < stops_.size())
      step = rest / std::ceil(rest / step - same_step);
    if (std::abs(step - base_step_) <= same_step * base_step_) step = base_step_;
    if (arrives) return {step, stop, 0.0, true};
    // Millions of equal steps round the same way: the sum of times is compensated (Kahan 1965).
    const double exact = step + lost_, t1 = base_.t + exact;
    return {step, t1, exact - (t1 - base_.t), false};
  }

  /// The state with its auxiliary acceleration made for another step; the state itself stays as it is.
  const system::State& prepared(double step) {
    if (step == base_step_ || !plan_.rebuild) return base_;
    prepared_ = base_;
    stepper_.step_changes(prepared_, step / base_step_);
    return prepared_;
  }

  void take_step() {
    const Length length = next_length();
    if (!(length.t1 > base_.t)) return fail({StepOutcome::too_small, -1}, length.step);
    const system::State& from = prepared(length.step);
    const StepReport tried = stepper_.attempt(from, length.step, length.t1, to_);
    report_.solves += 1;
    if (tried.outcome != StepOutcome::accepted) {
      note(length.step, std::numeric_limits<double>::quiet_NaN(), outcome_of(tried.outcome));
      ++report_.failed;
      return shorten(0.5 * length.step, tried);
    }
    const double error = estimator_.error(from, to_, length.step);
    report_.solves += estimator_.solves_a_try();
    const Decision decision = decide(plan_.controller, {length.step, error, estimator_.exponent()}, history_);
    history_.forgone = decision.forgone;
    note(length.step, error, decision.accepts ? TryOutcome::accepted : TryOutcome::error_too_large);
    if (!decision.accepts) {
      ++report_.rejected;
      history_.was_rejected = true;
      return shorten(decision.next, {StepOutcome::too_small, -1});
    }
    // A step cut short says little about the next.
    const bool was_cut = length.step < wanted_ * (1.0 - same_step);
    wanted_ = was_cut ? std::max(wanted_, decision.next) : decision.next;
    accept(length, error);
  }

  void accept(const Length& length, double error) {
    history_ = {error, length.step, false, history_.forgone};
    estimator_.accept(to_);
    base_step_ = length.step;
    lost_ = length.lost;
    ++report_.march.steps;
    report_.smallest_step = std::min(report_.smallest_step, length.step);
    report_.largest_step = std::max(report_.largest_step, length.step);
    if (observer_ && !observer_->accepted(base_, to_)) {
      goes_on_ = false;
      report_.march.end = MarchEnd::stopped;
    }
    std::swap(base_, to_);
    if (length.arrives && base_.t < end_ && goes_on_) pass_stop();
  }

  /// A kink of the loads ends what differences know; a jump starts the march anew.
  void pass_stop() {
    ++next_stop_;
    estimator_.forget();
    loads_.evaluate(base_.t, left_, model::Side::left);
    loads_.evaluate(base_.t, right_, model::Side::right);
    if ((right_ - left_).norm() <= 1e-12 * (right_.norm() + left_.norm())) return;
    base_ = consistent_start(system_, std::move(base_));
    history_ = {};
    estimator_.start(base_);
    wanted_ = std::min(wanted_, first_step());
    ++report_.restarts;
  }

  void shorten(double step, const StepReport& reason) {
    if (!(step >= plan_.smallest)) return fail(reason, step);
    wanted_ = step;
  }

  void fail(const StepReport& reason, double step) {
    report_.march.end = MarchEnd::failed;
    report_.march.step = reason;
    report_.march.failed_at = base_.t;
    report_.march.failed_step = step;
    goes_on_ = false;
  }

  void note(double step, double error, TryOutcome outcome) {
    if (log_) log_->tried({base_.t, step, error, outcome});
  }

  Stepper& stepper_;
  Estimator& estimator_;
  const StepPlan& plan_;
  const system::LocallyNonlinear& system_;
  system::State base_;      // the last accepted state, its auxiliary acceleration made for base_step_
  system::State prepared_;  // the same for the step that is tried
  system::State to_;
  double end_;
  Observer* observer_;
  TryLog* log_;
  system::Loads loads_;
  Vector left_, right_;
  std::vector<double> stops_;  // rows of tables, and the end
  std::size_t next_stop_ = 0;
  double wanted_ = 0.0, base_step_ = 0.0, lost_ = 0.0;
  ControlHistory history_;
  bool goes_on_ = true;
  AdaptiveReport report_;
};

}  // namespace

AdaptiveReport march(Stepper& stepper, Estimator& estimator, const StepPlan& plan,
                     const system::LocallyNonlinear& system, system::State& state, double end, Observer* observer,
                     TryLog* log) {
  Marcher marcher(stepper, estimator, plan, system, state, end, observer, log);
  const AdaptiveReport report = marcher.run();
  state = marcher.state();
  return report;
}

}  // namespace rubato::integrate
