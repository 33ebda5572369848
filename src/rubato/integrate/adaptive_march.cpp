#include <rubato/integrate/adaptive_march.hpp>
#include <rubato/integrate/structure_timeline.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace rubato::integrate {
namespace {

constexpr double same_step = 1e-9;       // relative
constexpr double least_progress = 1e-6;  // of the wanted step, between a step's start and a transition to locate in it
constexpr int most_event_tries = 60;     // bisection alone resolves 1e-12 of the march with 40

TryOutcome outcome_of(StepOutcome failure) {
  switch (failure) {
    case StepOutcome::not_converged:
    case StepOutcome::overdetermined:
      return TryOutcome::not_converged;
    case StepOutcome::singular:
      return TryOutcome::singular;
    default:
      return TryOutcome::not_finite;
  }
}

class Marcher {
 public:
  Marcher(Stepper& stepper, Estimator& estimator, const StepPlan& plan, Timeline& timeline, system::State& state,
          double end, Observer* observer, TryLog* log)
      : stepper_(stepper),
        estimator_(estimator),
        plan_(plan),
        timeline_(timeline),
        states_{state, state},
        prepared_(state),
        end_(end),
        observer_(observer),
        log_(log),
        breakpoints_(timeline.breakpoints(state.t, end)) {
    breakpoints_.push_back(end);
  }

  AdaptiveReport run() {
    estimator_.start(*base_);
    wanted_ = first_step();
    if (plan_.first > 0.0) wanted_ = plan_.first;
    base_step_ = wanted_;
    while (base_->t < end_ && goes_on_) take_step();
    report_.factorisations = stepper_.factorisations() + estimator_.factorisations();
    return report_;
  }
  const system::State& state() const { return *base_; }

 private:
  /// Where nothing moves and nothing says how long a step may be, a thousandth of the march is a start.
  double first_step() const {
    const double step = estimator_.first_step();
    return std::min(largest_step(), std::isfinite(step) ? step : 1e-3 * (end_ - base_->t));
  }

  /// The longest step that may start now.
  double largest_step() const {
    const auto& bounds = plan_.bounds;
    while (next_bound_ < bounds.size() && bounds[next_bound_].to <= base_->t) ++next_bound_;
    double largest = plan_.largest;
    for (std::size_t i = next_bound_; i < bounds.size() && bounds[i].from < base_->t + largest; ++i)
      largest = std::min(largest, std::max(0.0, bounds[i].from - base_->t) + bounds[i].step);
    return largest;
  }

  struct Length {
    double step, t1;
    double lost;   // what rounding took from t1 [s]
    bool arrives;  // at the next breakpoint
  };

  /// The step to try: not beyond the next breakpoint, and equal parts of the way to one that is not the end.
  Length next_length() const {
    const double next = breakpoints_[next_breakpoint_], rest = next - base_->t;
    double step = std::min(wanted_, largest_step());
    const auto reaches_it = [&] { return step >= rest * (1.0 - same_step); };
    if (!reaches_it() && next_breakpoint_ + 1 < breakpoints_.size()) step = part_of(rest, step);
    const bool arrives = reaches_it();
    if (arrives) step = rest;
    step = known(step);
    if (arrives) return {step, next, 0.0, true};
    return length_of(step);
  }

  /// Equal parts of the way to a breakpoint. Near to it the parts stay what they are, or are divided or joined: rows at
  /// equal distances are then passed with few different lengths, whose matrices the stepper has. A part that was
  /// rejected is divided, however little is wanted of it.
  double part_of(double rest, double wanted) const {
    constexpr double near = 32.0, worth_keeping = 0.8;
    const double parts = part_ > 0.0 ? rest / part_ : HUGE_VAL;
    if (!(parts < near && std::abs(parts - std::round(parts)) < same_step * parts))
      return rest / std::ceil(rest / wanted - same_step);
    // After a rejection the part is what was rejected, and the same again would be rejected for ever.
    const double least = history_.was_rejected ? 1.0 - same_step : worth_keeping;
    if (wanted < least * part_) return part_ / std::ceil(part_ / wanted - same_step);
    const long all = std::lround(parts);
    for (long joined = std::lround(std::floor(wanted / part_)); joined > 1; --joined)
      if (all % joined == 0) return static_cast<double>(joined) * part_;
    return part_;
  }

  /// A length to the last bit as it was before: differences of times are not, and the stepper remembers lengths.
  double known(double step) const {
    for (const double length : lengths_)
      if (std::abs(step - length) <= same_step * length) return length;
    return step;
  }

  void remember(double step) {
    auto place = std::find(lengths_.begin(), lengths_.end(), step);
    if (place == lengths_.end()) --place;
    std::rotate(lengths_.begin(), place, place + 1);
    lengths_.front() = step;
  }

  /// Millions of equal steps round the same way: the sum of times is compensated (Kahan 1965).
  Length length_of(double step) const {
    const double exact = step + lost_, t1 = base_->t + exact;
    return {step, t1, exact - (t1 - base_->t), false};
  }

  /// The state with its auxiliary acceleration made for another step; the state itself stays as it is.
  const system::State& prepared(double step) {
    if (step == base_step_ || !plan_.rebuild) return *base_;
    prepared_ = *base_;
    stepper_.step_changes(prepared_, step / base_step_);
    return prepared_;
  }

  void take_step() {
    Length length = next_length();
    if (!(length.t1 > base_->t)) return fail({StepOutcome::too_small, -1}, length.step);
    if (!has_tried(length)) return;
    bool is_event = false;
    if (plan_.locate_events && !has_looked_for_events(length, is_event)) return;
    const double error = std::max(estimator_.error(*from_, *to_, length.step), error_of_laws());
    report_.solves += estimator_.solves_a_try();
    const Decision decision = decide(plan_.controller, {length.step, error, estimator_.exponent()}, history_);
    history_.forgone = decision.forgone;
    note(length.step, error, decision.accepts ? TryOutcome::accepted : TryOutcome::error_too_large);
    if (!decision.accepts) {
      ++report_.rejected;
      history_.was_rejected = true;
      shorten(decision.next, {StepOutcome::too_small, -1});
      if (goes_on_ && stagnates(length.step, error)) begin_anew_here();
      return;
    }
    const bool was_rejected = history_.was_rejected;
    // A step cut short says little about the next, and nothing about what follows a transition.
    const bool was_cut = length.step < wanted_ * (1.0 - same_step);
    if (!was_cut)
      wanted_ = decision.next;
    else if (!is_event)
      wanted_ = std::max(wanted_, decision.next);
    accept(length, error);
    if (crawls(length.step, is_event ? 1.0 : was_rejected ? rejected_weight : smooth_weight))
      return fail({StepOutcome::crawls, -1}, length.step);
    if (is_event && base_->t < end_ && goes_on_) pass_event();
    if (length.arrives && base_->t < end_ && goes_on_) pass_breakpoint();
  }

  /// That of laws which say themselves how long a step may be: what they say holds for the tolerance 1e-3 and looser
  /// ones, below which it falls as errors of second order do.
  double error_of_laws() {
    const double stricter = std::max(1.0, std::sqrt(1e-3 / estimator_.tolerance()));
    return std::pow(stricter * timeline_.unresolved(*from_, *to_), estimator_.exponent());
  }

  /// Whether the error stays while steps are tried that are ever shorter: what it shows is then no error of theirs, but
  /// an acceleration that a much longer step left behind.
  bool stagnates(double step, double error) {
    constexpr double much_shorter = 1e-2, half = 0.5;
    if (!(stagnant_error_ > 0.0) || error < half * stagnant_error_) {
      stagnant_error_ = error;
      stagnant_step_ = step;
    }
    return !has_begun_anew_ && step < much_shorter * stagnant_step_;
  }

  /// From the accelerations of equilibrium at the last accepted state, once a state, with the step from which on the
  /// error stayed: those after it were too short for no reason, down to where they are made of round-off.
  void begin_anew_here() {
    has_begun_anew_ = true;
    if (!timeline_.restart(*base_)) return fail({StepOutcome::no_way_on, -1}, base_step_);
    wanted_ = stagnant_step_;
    stagnant_error_ = 0.0;
    start_anew();
  }

  /// Whether steps have been so short for so long that the run would not end: of a run that takes longer steps at all.
  /// Those without a transition, and even more those without a rejection, get somewhere: a motion that dies away early
  /// in a long run has such steps as long as it lasts.
  /// @param weight  of the step
  bool crawls(double step, double weight) {
    constexpr double share = 1e4;  // of the resolution, 1e-12 of the run
    constexpr double deep = 1e-2;  // at so small a part of that nobody gets anywhere
    const double nothing = share * timeline_.resolution();
    if (step < deep * nothing) weight = 1.0;
    crawling_ = step < nothing && plan_.largest > 100.0 * nothing ? crawling_ + weight : 0.0;
    return crawling_ > 2000.0;
  }
  static constexpr double rejected_weight = 0.02, smooth_weight = 0.002;

  /// One try from base_; a failure shortens the next.
  bool has_tried(const Length& length) {
    from_ = &prepared(length.step);
    const StepReport tried = stepper_.attempt(*from_, length.step, length.t1, *to_);
    report_.solves += 1;
    if (tried.outcome == StepOutcome::accepted) return true;
    note(length.step, std::numeric_limits<double>::quiet_NaN(), outcome_of(tried.outcome));
    ++report_.failed;
    // What is singular at one time only must not be met again by the second half.
    constexpr double half = 0.5, less_than_half = 0.4;
    shorten((tried.outcome == StepOutcome::singular ? less_than_half : half) * length.step, tried);
    return false;
  }

  /// Looks for a transition in the step that was tried, and shortens it to end there. Returns false where a try fails.
  bool has_looked_for_events(Length& length, bool& is_event) {
    // A step of the resolution would be made of round-off.
    const double least = std::max(least_progress * std::min(wanted_, largest_step()), 10.0 * timeline_.resolution());
    Crossing crossing = timeline_.first_crossing(*from_, *to_, least / length.step, Look::between);
    if (crossing.guard >= 0 && crossing.seen < 1.0) {
      // Between the ends, where stiff parts make forces of what interpolation errs by: a step there tells.
      const Length whole = length;
      note(whole.step, std::numeric_limits<double>::quiet_NaN(), TryOutcome::event);
      length = length_of(std::max(crossing.seen * whole.step, std::min(least, 0.5 * whole.step)));
      ++report_.event_tries;
      if (!has_tried(length)) return false;
      crossing = timeline_.first_crossing(*from_, *to_, least / length.step, Look::at_ends);
      if (crossing.guard < 0) {
        note(length.step, std::numeric_limits<double>::quiet_NaN(), TryOutcome::event);
        length = whole;
        if (!has_tried(length)) return false;
        crossing = timeline_.first_crossing(*from_, *to_, least / length.step, Look::at_ends);
      }
    }
    is_event = crossing.guard >= 0;
    return !is_event || has_located(crossing, least, length);
  }

  /// Shortens a step beyond a transition until it ends there.
  /// @param least  transitions before it are passed over [s]
  bool has_located(Crossing crossing, double least, Length& length) {
    const double resolution = timeline_.resolution();
    double low = 0.0, high = length.step;
    double before_last = high, last = high;  // lengths of the bracket
    for (int i = 0; i < most_event_tries; ++i) {
      note(length.step, std::numeric_limits<double>::quiet_NaN(), TryOutcome::event);
      // On the interpolated step first; then Newton's iteration, unless the bracket hardly shrinks.
      double at = crossing.share * length.step;
      if (i > 0) {
        const GuardValue guard = timeline_.guard(crossing.guard, *from_, *to_);
        at = length.step - guard.value / guard.rate;
      }
      const bool is_slow = i > 1 && high - low > 0.5 * before_last;
      if (!(at > low && at < high) || is_slow) at = 0.5 * (low + high);
      at = std::max(at, std::min(least, 0.5 * (low + high)));
      before_last = last;
      last = high - low;
      length = length_of(at);
      if (!(length.t1 > base_->t)) return fail({StepOutcome::too_small, -1}, length.step), false;
      if (!has_tried(length)) return false;
      ++report_.event_tries;
      const Crossing now = timeline_.first_crossing(*from_, *to_, least / at, Look::at_ends);
      if (now.guard >= 0) crossing = now;  // perhaps another, which comes first
      const GuardValue guard = timeline_.guard(crossing.guard, *from_, *to_);
      (now.guard >= 0 ? high : low) = at;
      const bool is_there = std::abs(guard.value) <= resolution * std::abs(guard.rate);
      if (is_there || (now.guard >= 0 && high - low <= resolution)) break;
    }
    // What would be left of the way to a breakpoint is nothing: no step can be made of it.
    const double next = breakpoints_[next_breakpoint_];
    length.arrives = length.t1 == next;
    if (length.arrives || next - length.t1 > resolution) return true;
    length = {next - base_->t, next, 0.0, true};
    return has_tried(length);
  }

  void accept(const Length& length, double error) {
    history_ = {error, length.step, false, history_.forgone};
    estimator_.accept(*to_);
    stagnant_error_ = 0.0;
    has_begun_anew_ = false;
    base_step_ = length.step;
    part_ = base_step_;
    remember(base_step_);
    lost_ = length.lost;
    ++report_.march.steps;
    if (!(error <= 1.0)) ++report_.beyond_tolerance;
    report_.largest_error = std::fmax(report_.largest_error, error);
    report_.smallest_step = std::min(report_.smallest_step, length.step);
    report_.largest_step = std::max(report_.largest_step, length.step);
    if (observer_ && !observer_->accepted(*base_, *to_)) {
      goes_on_ = false;
      report_.march.end = MarchEnd::stopped;
    }
    std::swap(base_, to_);
  }

  /// A kink of the loads ends what differences know; a jump starts the march anew, and so does a step between two kinks
  /// that is nothing beside the others: accelerations made over its square are round-off.
  void pass_breakpoint() {
    constexpr double nothing = 1e-4;
    ++next_breakpoint_;
    part_ = 0.0;
    const bool is_short = base_step_ < nothing * std::min(wanted_, largest_step());
    if (!timeline_.jumps_at(base_->t) && !is_short) return estimator_.forget();
    if (!timeline_.restart(*base_)) return fail({StepOutcome::no_way_on, -1}, base_step_);
    start_anew();
  }

  void pass_event() {
    ++report_.events;
    const Passage passage = timeline_.pass(*to_, *base_, stepper_.shift() * base_step_);
    if (passage == Passage::fails) return fail({StepOutcome::no_way_on, -1}, base_step_);
    if (passage == Passage::restarts) return start_anew();
    estimator_.forget();
    history_ = {};
    ++report_.restarts;
  }

  void start_anew() {
    history_ = {};
    estimator_.start(*base_);
    if (std::holds_alternative<FixedStep>(plan_.controller))
      wanted_ = plan_.first > 0.0 ? plan_.first : wanted_;  // a transition that was hard to pass may have cut it
    else
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
    report_.march.failed_at = base_->t;
    report_.march.failed_step = step;
    goes_on_ = false;
  }

  void note(double step, double error, TryOutcome outcome) {
    if (log_) log_->tried({base_->t, step, error, outcome});
  }

  Stepper& stepper_;
  Estimator& estimator_;
  const StepPlan& plan_;
  Timeline& timeline_;
  std::array<system::State, 2> states_;
  system::State* base_ = &states_[0];  // the last accepted state, its auxiliary acceleration made for base_step_
  system::State* to_ = &states_[1];
  system::State prepared_;               // base_ for the step that is tried
  const system::State* from_ = nullptr;  // base_ or prepared_, where the last try started
  double end_;
  Observer* observer_;
  TryLog* log_;
  std::vector<double> breakpoints_;  // and the end
  std::size_t next_breakpoint_ = 0;
  mutable std::size_t next_bound_ = 0;  // the first that does not end before base_->t
  double wanted_ = 0.0, base_step_ = 0.0, lost_ = 0.0;
  double part_ = 0.0;                 // the last step since the last breakpoint
  std::array<double, 16> lengths_{};  // of the last steps, the last first
  ControlHistory history_;
  double crawling_ = 0.0;  // steps in a row, by their weight
  double stagnant_error_ = 0.0,
         stagnant_step_ = 0.0;   // of the first of the rejected tries whose errors do not fall; 0: none
  bool has_begun_anew_ = false;  // since the last accepted step
  bool goes_on_ = true;
  AdaptiveReport report_;
};

}  // namespace

AdaptiveReport march(Stepper& stepper, Estimator& estimator, const StepPlan& plan, Timeline& timeline,
                     system::State& state, double end, Observer* observer, TryLog* log) {
  Marcher marcher(stepper, estimator, plan, timeline, state, end, observer, log);
  AdaptiveReport report = marcher.run();
  state = marcher.state();
  return report;
}

AdaptiveReport march(Stepper& stepper, Estimator& estimator, const StepPlan& plan,
                     const system::LocallyNonlinear& system, system::State& state, double end, Observer* observer,
                     TryLog* log) {
  StructureTimeline timeline(system, relative_resolution * (end - state.t), plan.locate_sliders);
  return march(stepper, estimator, plan, timeline, state, end, observer, log);
}

}  // namespace rubato::integrate
