#include <rubato/integrate/constrained/consistent_start.hpp>
#include <rubato/integrate/mechanism/friction_phases.hpp>
#include <rubato/integrate/mechanism/friction_release.hpp>
#include <rubato/integrate/mechanism/mechanism_timeline.hpp>
#include <rubato/integrate/mechanism/stop_impacts.hpp>
#include <rubato/model/time_kinks.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace rubato::integrate {
namespace {

system::Loads loads_of(const model::Mechanism& model) {
  std::vector<system::LoadTerm> terms;
  for (const auto& force : model.forces) terms.push_back({{force.coordinate}, {1.0}, force.law});
  // Only when they are not smooth is asked: any coordinate serves.
  for (const auto& law : model.following_laws) terms.push_back({{0}, {1.0}, law});
  return system::Loads(std::move(terms));
}

}  // namespace

MechanismTimeline::MechanismTimeline(const system::Mechanism& of, double resolution)
    : MechanismTimeline(std::make_unique<system::MechanismEquations>(of), resolution) {}

MechanismTimeline::MechanismTimeline(std::unique_ptr<system::MechanismEquations> own, double resolution)
    : MechanismTimeline(*own, resolution) {
  own_ = std::move(own);
}

MechanismTimeline::MechanismTimeline(system::MechanismEquations& equations, double resolution, bool watches_laws,
                                     bool watches_contacts)
    : equations_(equations),
      mechanism_(equations.mechanism()),
      resolution_(resolution),
      watches_laws_(watches_laws),
      watches_contacts_(watches_contacts),
      law_guards_(mechanism_.model(), mechanism_.size(), resolution),
      loads_(loads_of(mechanism_.model())),
      left_(mechanism_.size()),
      right_(mechanism_.size()),
      padded_(static_cast<std::size_t>(mechanism_.size()) + 1, 0.0),
      padded_acceleration_(padded_) {
  const system::Mechanism& mechanism = mechanism_;
  equations_.set_duration(1e12 * resolution);
  transitions_.resize(mechanism.model().locks.size() + mechanism.model().frictions.size());
  for (const auto& lock : mechanism.model().locks)
    row_.push_back(lock.is_rigid() ? mechanism.first_row(lock.joint) : -1);
  for (const auto& lock : mechanism.model().locks) {
    const auto& frictions = mechanism.model().frictions;
    const auto is_of_it = [&](const model::JointFriction& friction) { return friction.name == lock.joint_name(); };
    const auto found = std::find_if(frictions.begin(), frictions.end(), is_of_it);
    friction_of_.push_back(found == frictions.end() ? -1 : static_cast<int>(found - frictions.begin()));
  }
}

std::vector<double> MechanismTimeline::breakpoints(double from, double to) const {
  std::vector<double> times = loads_.breakpoints(from, to);
  std::vector<double> switches;
  for (const auto& drive : mechanism_.model().drives) {
    if (const auto* table = std::get_if<model::TableLaw>(&drive.law)) {
      for (const double t : table->times)
        if (t > from && t < to) times.push_back(t);
    } else {
      const std::vector<double> found = model::with_eighths(std::get<numerics::Formula>(drive.law).switches(from, to));
      switches.insert(switches.end(), found.begin(), found.end());
    }
  }
  joint_switches_.clear();
  const auto take_law = [&](const std::vector<double>& found) {
    const std::vector<double> pieces = model::with_eighths(found);
    joint_switches_.insert(joint_switches_.end(), found.begin(), found.end());
    switches.insert(switches.end(), pieces.begin(), pieces.end());
  };
  for (const auto& formula : mechanism_.model().joint_formulas) take_law(formula.switches(from, to));
  for (const auto& law : mechanism_.model().laws) {
    take_law(law.law->breakpoints(from, to));
    if (law.normal.formula) take_law(law.normal.formula->switches(from, to));
  }
  std::sort(joint_switches_.begin(), joint_switches_.end());
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  std::sort(switches.begin(), switches.end());
  numerics::add_switches(switches, from, to, times);
  return times;
}

bool MechanismTimeline::jumps_at(double t) {
  loads_.evaluate(t, left_, model::Side::left);
  loads_.evaluate(t, right_, model::Side::right);
  return !((right_ - left_).norm() <= 1e-12 * (right_.norm() + left_.norm())) || has_drive_jump(t) ||
         is_joint_switch(t);
}

bool MechanismTimeline::is_joint_switch(double t) const {
  const double same_time = 16.0 * std::numeric_limits<double>::epsilon() * std::abs(t);
  const auto found = std::lower_bound(joint_switches_.begin(), joint_switches_.end(), t - same_time);
  return found != joint_switches_.end() && *found <= t + same_time;
}

bool MechanismTimeline::has_drive_jump(double t) const {
  for (const auto& drive : mechanism_.model().drives) {
    const double before = model::derivatives(drive.law, t, model::Side::left).rate;
    const double after = model::derivatives(drive.law, t, model::Side::right).rate;
    if (!(std::abs(after - before) <= 1e-12 * (std::abs(after) + std::abs(before)))) return true;
  }
  return false;
}

bool MechanismTimeline::project(system::State& state, double& energy_lost) {
  std::fill(state.rubbing.begin(), state.rubbing.end(), model::friction_free);
  const ConsistentStart projected = make_consistent_pressing(equations_, state, model::Side::right);
  if (!projected.is_consistent) return false;
  for (std::size_t i = 0; i < row_.size(); ++i)
    if (projected.state.phase[i] != state.phase[i]) events_.push_back({state.t, static_cast<int>(i), false, 0.0});
  energy_lost = projected.energy_lost;
  impulsive_work_ += projected.drive_work;
  state = projected.state;
  return true;
}

bool MechanismTimeline::restart(system::State& state) {
  const std::vector<int> old = state.rubbing;
  double energy_lost = 0.0;
  bool goes_on = false;
  if (has_drive_jump(state.t))
    goes_on = project(state, energy_lost) && find_phases_of_new_velocities(equations_, state, ahead());
  else
    goes_on = find_friction_phases(equations_, state, std::vector<char>(old.size(), 0), ahead());
  note_standing_drives(state.t);
  note_friction(old, state);
  if (!goes_on || !release(state)) return false;
  close_gaps(equations_, state, model::Side::right);
  return true;
}

void MechanismTimeline::count_transition(std::size_t guard, const system::State& state) {
  constexpr int most = 100;
  constexpr double window = 1e9;  // over the resolution, 1e-12 of the run
  const auto& model = mechanism_.model();
  const model::FreeCoordinate& s = guard < row_.size() ? model.locks[guard].s : model.frictions[guard - row_.size()].s;
  const double value = s.value(state.q.data());
  Transitions& past = transitions_[guard];
  if (!(std::abs(value - past.at) <= no_way(s, state) && state.t - past.since <= window * resolution_))
    past = {state.t, value, 0};
  if (++past.count > most) chattering_ = static_cast<Index>(guard);
}

double MechanismTimeline::no_way(const model::FreeCoordinate& s, const system::State& state) const {
  constexpr double still = 1e-9;  // ten times what Newton's method leaves of positions
  return still * (s.is_angle() ? 1.0 : 1.0 + state.q.cwiseAbs().maxCoeff());
}

const MechanismTimeline::Balanced& MechanismTimeline::balanced(const system::State& state) {
  for (std::size_t k = 0; k < balance_count_; ++k) {
    if (balances_[k].of != &state || balances_[k].state.t != state.t) continue;
    equations_.go_to(balances_[k].state, model::Side::left);
    return balances_[k];
  }
  Balanced& next = balances_[balance_count_ < balances_.size() ? balance_count_++ : balances_.size() - 1];
  next.of = &state;
  next.state = state;
  next.is_found = find_acceleration(equations_, next.state, model::Side::left);
  return next;
}

void MechanismTimeline::forget_balances() { balance_count_ = 0; }

model::Motion MechanismTimeline::motion_of(const system::State& state) {
  std::copy(state.v.data(), state.v.data() + state.v.size(), padded_.data() + 1);
  std::copy(state.acceleration.data(), state.acceleration.data() + state.acceleration.size(),
            padded_acceleration_.data() + 1);
  return {state.t,
          model::Side::left,
          state.q.data(),
          padded_.data() + 1,
          state.phase.data(),
          state.rubbing.data(),
          state.stuck_at.data()};
}

bool MechanismTimeline::release(system::State& state) {
  const auto& model = mechanism_.model();
  for (std::size_t i = 0; i < row_.size(); ++i) {
    if (row_[i] < 0 || !is_watched(i, state) || state.phase[i] != model::lock_engaged) continue;
    if (!(model.locks[i].sign * state.multiplier[row_[i]] < 0.0)) continue;
    state.phase[i] = model::lock_open;
    events_.push_back({state.t, static_cast<int>(i), false, 0.0});
    const std::vector<int> old = state.rubbing;
    if (!find_friction_phases(equations_, state, std::vector<char>(old.size(), 0), ahead())) return false;
    note_friction(old, state);
  }
  return true;
}

bool MechanismTimeline::is_watched(std::size_t lock, const system::State& state) const {
  if (lock < row_.size() && friction_of_[lock] >= 0 && state.phase[lock] == model::lock_open &&
      model::is_at_rest(state.rubbing[static_cast<std::size_t>(friction_of_[lock])]))
    return false;  // what sticks at its stop lies beyond it by round-off, and comes no nearer
  if (lock >= row_.size()) {
    const std::size_t friction = lock - row_.size();
    if (is_at_limit(state.rubbing[friction]) || equations_.is_led(friction)) return false;
    return state.rubbing[friction] != model::friction_free || !is_locked(mechanism_.model(), state, friction);
  }
  return !(mechanism_.model().locks[lock].is_latch && state.phase[lock] == model::lock_engaged);
}

bool MechanismTimeline::has_rate(std::size_t i, const system::State& from) const {
  if (i >= row_.size()) return model::sliding_direction(from.rubbing[i - row_.size()]) != 0.0;
  return row_[i] < 0 || from.phase[i] == model::lock_open;
}

GuardValue MechanismTimeline::guard_at(std::size_t i, const system::State& state, const Vector& floors) {
  if (i >= row_.size()) return friction_guard(i - row_.size(), state, floors);
  const model::Lock& lock = mechanism_.model().locks[i];
  const model::Motion motion = motion_of(state);
  const double s = lock.s.value(state.q.data()), rate = lock.s.rate(motion);
  if (state.phase[i] == model::lock_open) return {lock.sign * (lock.at - s), -lock.sign * rate};
  if (row_[i] >= 0) {
    const Balanced& now = balanced(state);
    return {lock.sign * (now.is_found ? now.state : state).multiplier[row_[i]], 0.0};
  }
  const double second_rate = lock.s.second_rate(motion, padded_acceleration_.data() + 1);
  return {lock.sign * (lock.stiffness * (s - lock.at) + lock.damping * rate),
          lock.sign * (lock.stiffness * rate + lock.damping * second_rate)};
}

GuardValue MechanismTimeline::guard(Index guard, const system::State& from, const system::State& to) {
  const auto i = static_cast<std::size_t>(guard);
  if (i >= transitions_.size()) {
    const auto law = guard - static_cast<Index>(transitions_.size());
    const auto laws = static_cast<Index>(mechanism_.model().laws.size());
    return law < laws ? law_guards_.guard(law, from, to) : law_guards_.touch(law - laws, from, to);
  }
  forget_balances();
  GuardValue value = guard_at(i, to, to.stuck_at);
  if (!has_rate(i, from)) value.rate = (value.value - guard_at(i, from, to.stuck_at).value) / (to.t - from.t);
  return value;
}

Passage MechanismTimeline::pass(const system::State& before, system::State& state, double shift) {
  const std::vector<int> old = state.rubbing;
  const Rubbing rubbing = rubbing_after(before, state);
  bool jumps = rubbing.has_changed || (watches_contacts_ && law_guards_.hits_a_dashpot(before, state));
  bool has_impact = false;
  for (std::size_t i = 0; i < row_.size(); ++i) {
    if (!is_watched(i, before) || state.phase[i] != before.phase[i]) continue;  // an impact before may have opened it
    GuardValue now = guard(static_cast<Index>(i), before, state);
    if (!(now.value <= resolution_ * std::abs(now.rate) && now.rate <= 0.0)) continue;
    count_transition(i, state);
    const bool engages = state.phase[i] == model::lock_open;
    state.phase[i] = engages ? model::lock_engaged : model::lock_open;
    events_.push_back({state.t, static_cast<int>(i), engages, 0.0});
    const model::Lock& lock = mechanism_.model().locks[i];
    jumps = jumps || lock.is_rigid() || lock.is_latch || lock.damping > 0.0;
    if (!engages && !lock.is_rigid() && lock.damping > 0.0) {
      const double depth = lock.s.value(state.q.data()) - lock.at;
      events_.back().energy_lost = 0.5 * lock.stiffness * depth * depth;
    }
    if (!engages || !lock.is_rigid()) continue;
    const std::size_t event = events_.size() - 1;
    double energy_lost = 0.0;
    if (!project(state, energy_lost)) return Passage::fails;
    events_[event].energy_lost = energy_lost;
    has_impact = true;
  }
  const bool is_settled = has_impact
                              ? find_phases_of_new_velocities(equations_, state, ahead())
                              : find_friction_phases(equations_, state, rubbing.candidates, ahead(), rubbing.at_limit);
  note_standing_drives(state.t);
  note_friction(old, state);
  if (!is_settled || !release(state) || chattering_ >= 0) return Passage::fails;
  close_gaps(equations_, state, model::Side::right);
  shift_acceleration(equations_, state, shift);
  return jumps ? Passage::restarts : Passage::continues;
}

}  // namespace rubato::integrate
