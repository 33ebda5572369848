#include <rubato/integrate/constrained/consistent_start.hpp>
#include <rubato/integrate/constrained/constrained_balance.hpp>

namespace rubato::integrate {
namespace {

bool is_zero(const Vector& x) { return (x.array() == 0.0).all(); }

}  // namespace

ConstrainedBalance::ConstrainedBalance(system::ConstrainedEquations& equations)
    : equations_(equations),
      force_(equations.system().size()),
      force_now_(force_.size()),
      swing_(force_.size()),
      rate_(equations.system().constraint_count()),
      rate_now_(rate_.size()),
      swing_of_rate_(rate_.size()) {}

void ConstrainedBalance::find_acceleration(system::State& state, model::Side side) {
  known_ = state;
  if (!integrate::find_acceleration(equations_, state, side)) state = known_;
}

void ConstrainedBalance::find_shown_acceleration(system::State& state) {
  find_acceleration(state, model::Side::right);
  if (!equations_.lets_go(state)) return;
  from_now_on_ = state;
  state = known_;  // as it was given
  if (!integrate::find_acceleration(equations_, state, model::Side::left)) state = from_now_on_;
}

void ConstrainedBalance::add_swing_of_loads(std::span<const WeighedEnd> ends, system::State& state) {
  evaluate(state.t, model::Side::left, state, force_now_, rate_now_);
  swing_.setZero();
  swing_of_rate_.setZero();
  for (const WeighedEnd& end : ends) {
    evaluate(end.t, end.side, state, force_, rate_);
    swing_ += end.weight * (force_now_ - force_);
    swing_of_rate_ += end.weight * (rate_now_ - rate_);
  }
  if (is_zero(swing_) && is_zero(swing_of_rate_)) return;
  known_ = state;
  if (!integrate::add_acceleration(equations_, state, swing_, swing_of_rate_)) state = known_;
}

void ConstrainedBalance::evaluate(double t, model::Side side, system::State& state, Vector& force, Vector& rate) {
  const double now = state.t;
  state.t = t;
  equations_.go_to(state, side);
  equations_.force_of_loads(force);
  equations_.second_rate(rate);
  state.t = now;
}

}  // namespace rubato::integrate
