#include <rubato/integrate/mechanism/mechanism_events.hpp>
#include <rubato/integrate/mechanism/mechanism_failure.hpp>
#include <rubato/system/mechanism_equations.hpp>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace rubato::integrate {
namespace {

/// The joints that repeat each other in a state, or all but, and do not in the configuration of the start.
std::vector<std::string> singular_joints(system::MechanismEquations& equations, const system::State& state) {
  const system::Mechanism& mechanism = equations.mechanism();
  constexpr double left = 1e-6;  // a thousandth of a radian from the configuration itself
  Vector force(mechanism.size()), constraint(mechanism.constraint_count());
  const auto rows_in = [&](const system::State& where) {
    equations.go_to(where, model::Side::left);
    equations.linearise({}, where.multiplier, force, constraint);
    return equations.factorise() ? equations.redundant_rows(left) : std::vector<Index>{};
  };
  system::State start = mechanism.start();
  start.phase = state.phase;
  start.rubbing = state.rubbing;
  start.stuck_at = state.stuck_at;
  const std::vector<Index> usual = rows_in(start);
  std::vector<std::string> joints;
  for (const Index row : rows_in(state)) {
    if (std::find(usual.begin(), usual.end(), row) != usual.end()) continue;
    std::string joint = mechanism.rows()[static_cast<std::size_t>(row)];
    joint.resize(joint.rfind('.'));
    if (joints.empty() || joints.back() != joint) joints.push_back(std::move(joint));
  }
  return joints;
}

/// What is no number a step ahead, in the motion that the last state has; empty: nothing.
std::string non_finite_part_ahead(const MarchReport& report, system::MechanismEquations& equations,
                                  const system::State& state) {
  system::State ahead = state;
  std::string part;
  for (const double steps : {1.0, 2.0, 10.0}) {  // one may end at the very edge of a law
    const double length = steps * report.failed_step;
    ahead.t = report.failed_at + length;
    equations.mechanism().retract(state.q, length * state.v, ahead.q);
    equations.go_to(ahead, model::Side::left);
    part = equations.non_finite_part();
    if (!part.empty()) break;
  }
  return part;
}

/// The last parts that changed, each once, the last first.
Events last_of(const Events& events) {
  constexpr std::size_t most = 3;
  Events last;
  last.parts = events.parts;
  for (auto event = events.all.rbegin(); event != events.all.rend() && last.all.size() < most; ++event) {
    const auto is_same = [&](const Event& other) { return other.part == event->part; };
    if (std::none_of(last.all.begin(), last.all.end(), is_same)) last.all.push_back(*event);
  }
  return last;
}

bool has_followed_reactions(const model::Mechanism& model) {
  return std::any_of(model.frictions.begin(), model.frictions.end(),
                     [](const model::JointFriction& friction) { return friction.follows_reaction(); });
}

/// A strut whose ends have all but met, where its direction is lost; empty: none.
std::string collapsed_strut(const system::Mechanism& mechanism, const system::State& state) {
  constexpr double share = 1e-3;  // of its length at the start
  const auto find = [&](const auto& coordinates) -> std::string {
    for (const auto& coordinate : coordinates)
      if (std::string_view(coordinate.s.name()) == "length" &&
          coordinate.s.value(state.q.data()) < share * coordinate.s.value(mechanism.start().q.data()))
        return coordinate.name;
    return {};
  };
  const std::string in_plane = find(mechanism.model().joint_coordinates);
  return in_plane.empty() ? find(mechanism.model().space_coordinates) : in_plane;
}

}  // namespace

MarchFailure failure_of(const MarchReport& report, system::MechanismEquations& equations, const system::State& state,
                        const Transitions& transitions) {
  const system::Mechanism& mechanism = equations.mechanism();
  constexpr double least_tolerance = 1e-9;  // see the known issues
  const StepOutcome outcome = report.step.outcome;
  MarchFailure failure;
  failure.outcome = outcome;
  failure.t = report.failed_at;
  failure.step = report.failed_step;
  failure.least_tolerance = least_tolerance;
  if (report.step.worst >= 0) {
    const auto& names = outcome == StepOutcome::overdetermined ? mechanism.rows() : mechanism.coordinates();
    failure.worst = names[static_cast<std::size_t>(report.step.worst)];
  }
  failure.last_changes = last_of(events_of(transitions.all, mechanism));
  const auto& locks = mechanism.model().locks;
  if (outcome == StepOutcome::no_way_on && transitions.chattering >= 0) {
    failure.chattering = failure.last_changes.parts[static_cast<std::size_t>(transitions.chattering)];
    failure.is_lock_chattering = static_cast<std::size_t>(transitions.chattering) < locks.size();
  } else {
    failure.collapsed_strut = collapsed_strut(mechanism, state);
  }
  failure.has_beams = !mechanism.model().beam_parts.empty();
  failure.has_followed_reactions = has_followed_reactions(mechanism.model());
  const bool is_stuck = outcome == StepOutcome::too_small || outcome == StepOutcome::crawls;
  if (outcome == StepOutcome::not_finite || outcome == StepOutcome::singular || is_stuck)
    failure.non_finite_part = non_finite_part_ahead(report, equations, state);
  if (outcome == StepOutcome::not_converged || outcome == StepOutcome::singular || is_stuck)
    failure.repeating_joints = singular_joints(equations, state);
  return failure;
}

}  // namespace rubato::integrate
