#include <rubato/integrate/mechanism/mechanism_balance.hpp>
#include <rubato/integrate/mechanism/mechanism_start.hpp>

namespace rubato::integrate {
namespace {

bool is_zero(const Vector& x) { return (x.array() == 0.0).all(); }

}  // namespace

MechanismBalance::MechanismBalance(const system::Mechanism& mechanism)
    : equations_(mechanism),
      force_(mechanism.size()),
      force_now_(mechanism.size()),
      swing_(mechanism.size()),
      rate_(mechanism.constraint_count()),
      rate_now_(mechanism.constraint_count()),
      swing_of_rate_(mechanism.constraint_count()) {}

void MechanismBalance::find_acceleration(system::State& state, model::Side side) {
  known_ = state;
  if (!integrate::find_acceleration(equations_, state, side)) state = known_;
}

void MechanismBalance::find_shown_acceleration(system::State& state) {
  find_acceleration(state, model::Side::right);
  if (!lets_go(state)) return;
  from_now_on_ = state;
  state = known_;  // as it was given
  if (!integrate::find_acceleration(equations_, state, model::Side::left)) state = from_now_on_;
}

bool MechanismBalance::lets_go(const system::State& state) {
  equations_.go_to(state, model::Side::right);
  constexpr double round_off = 1e-6;
  for (std::size_t i = 0; i < state.rubbing.size(); ++i) {
    if (state.rubbing[i] != model::friction_sticks) continue;
    const double excess = equations_.friction_size(i, state.multiplier) -
                          (1.0 + round_off) * equations_.friction_limit(i, state.multiplier);
    if (excess > equations_.negligible_friction(i)) return true;
  }
  return false;
}

void MechanismBalance::add_swing_of_loads(std::span<const WeighedEnd> ends, system::State& state) {
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

void MechanismBalance::evaluate(double t, model::Side side, system::State& state, Vector& force, Vector& rate) {
  const double now = state.t;
  state.t = t;
  equations_.go_to(state, side);
  equations_.force_of_loads(force);
  equations_.second_rate(rate);
  state.t = now;
}

}  // namespace rubato::integrate
