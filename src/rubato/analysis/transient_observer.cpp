#include <rubato/analysis/transient_observer.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace rubato::analysis {

using Kind = model::OutputDescription::Kind;

TransientObserver::TransientObserver(const TransientPlan& plan, TransientRecorder& recorder,
                                     integrate::EnergyLedger* ledger, StepInterpolation interpolation,
                                     long steps_a_report, RunContext& context, integrate::Observer* listener)
    : plan_(plan),
      recorder_(recorder),
      ledger_(ledger),
      interpolation_(std::move(interpolation)),
      context_(context),
      listener_(listener),
      steps_a_report_(steps_a_report) {}

void TransientObserver::start(const system::State& state) {
  if (ledger_) ledger_->start(state);
  recorder_.show_step(state);
  // Requested times may begin later than the run.
  if (plan_.output == Kind::times && (plan_.times.empty() || plan_.times.front() > state.t)) return;
  record(state, state);
  ++next_;
}

bool TransientObserver::accepted(const system::State& before, const system::State& after) {
  ++steps_;
  last_recorded_ = false;
  if (plan_.output == Kind::interval || plan_.output == Kind::times) record_between(before, after);
  recorder_.book(before, after);
  const bool goes_on = !listener_ || listener_->accepted(before, after);
  const bool is_row = plan_.output == Kind::every_step || (plan_.output == Kind::every && steps_ % plan_.every == 0);
  if (is_row) record(after, after);
  if (!is_row || plan_.shows_every_step) recorder_.show_step(after);
  if (steps_ % steps_a_report_ == 0) context_.progress.advance(progress(after));
  return goes_on && !context_.stop.load(std::memory_order_relaxed);
}

void TransientObserver::finish(const system::State& state) {
  if (plan_.output == Kind::every && !last_recorded_ && steps_ > 0) record(state, state);
  context_.progress.advance(progress(state));
}

void TransientObserver::record(const system::State& before, const system::State& now, bool is_balanced) {
  recorder_.record(before, now, is_balanced);
  last_recorded_ = true;
}

double TransientObserver::next_time() const {
  if (plan_.output == Kind::interval) return static_cast<double>(next_) * plan_.interval;
  return next_ < static_cast<long>(plan_.times.size()) ? plan_.times[static_cast<std::size_t>(next_)] : HUGE_VAL;
}

void TransientObserver::record_between(const system::State& before, const system::State& after) {
  // Also of multiples of an interval that are the end of the run, however short its last step.
  const double round_off = std::max(1e-9 * (after.t - before.t), 1e-12 * plan_.march.duration);
  interpolation_.take(before, after);
  for (double t = next_time(); t <= after.t + round_off; t = next_time()) {
    ++next_;
    if (t >= after.t - round_off) {
      record(before, after);
      continue;
    }
    interpolation_.at(t, between_);
    record(before, between_, true);
  }
}

}  // namespace rubato::analysis
