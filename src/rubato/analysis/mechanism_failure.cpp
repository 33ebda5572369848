#include <rubato/analysis/mechanism_failure.hpp>
#include <rubato/system/mechanism_equations.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace rubato::analysis {
namespace {

/// The joints that repeat each other in a state, or all but, and do not in the configuration of the start.
std::vector<std::string> singular_joints(const system::Mechanism& mechanism, const system::State& state) {
  constexpr double left = 1e-6;  // a thousandth of a radian from the configuration itself
  system::MechanismEquations equations(mechanism);
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
std::string non_finite_part_ahead(const integrate::MarchReport& report, const system::Mechanism& mechanism,
                                  const system::State& state) {
  system::MechanismEquations equations(mechanism);
  system::State ahead = state;
  std::string part;
  for (const double steps : {1.0, 2.0, 10.0}) {  // one may end at the very edge of a law
    const double length = steps * report.failed_step;
    ahead.t = report.failed_at + length;
    mechanism.retract(state.q, length * state.v, ahead.q);
    equations.go_to(ahead, model::Side::left);
    part = equations.non_finite_part();
    if (!part.empty()) break;
  }
  return part;
}

/// @param guard  of the timeline: the locks, then the frictions
std::string chattering_part(Index guard, const system::Mechanism& mechanism) {
  const auto& model = mechanism.model();
  const auto i = static_cast<std::size_t>(guard);
  if (i < model.locks.size()) return fmt::format("the lock of \"{}\"", model.locks[i].name);
  return fmt::format("the friction of \"{}\"", model.frictions[i - model.locks.size()].label());
}

std::string described(const integrate::LockEvent& event, const system::Mechanism& mechanism) {
  const auto& model = mechanism.model();
  const bool is_lock = event.friction < 0;
  const std::string name = is_lock ? model.locks[static_cast<std::size_t>(event.lock)].name
                                   : model.frictions[static_cast<std::size_t>(event.friction)].label();
  const char* what = is_lock ? (event.has_engaged ? "locks" : "lets go") : (event.has_engaged ? "sticks" : "slips");
  return fmt::format("\"{}\" ({} at t = {:.9g} s)", name, what, event.t);
}

/// The last joints that changed, each once, the last first; empty: none did.
std::string last_to_change(std::span<const integrate::LockEvent> events, const system::Mechanism& mechanism) {
  constexpr std::size_t most = 3;
  std::vector<const integrate::LockEvent*> last;
  for (auto event = events.rbegin(); event != events.rend() && last.size() < most; ++event) {
    const auto is_same = [&](const integrate::LockEvent* other) {
      return other->lock == event->lock && other->friction == event->friction;
    };
    if (std::none_of(last.begin(), last.end(), is_same)) last.push_back(&*event);
  }
  std::vector<std::string> told;
  for (const auto* event : last) told.push_back(described(*event, mechanism));
  return told.empty() ? "" : fmt::format("; the last to change: {}", fmt::join(told, ", "));
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

std::string failure_of(const integrate::MarchReport& report, const system::Mechanism& mechanism,
                       const system::State& state, const Transitions& transitions, const std::string& advice_on_step) {
  const bool is_coordinate = report.step.outcome != integrate::StepOutcome::overdetermined;
  const std::string at =
      report.step.worst >= 0 && is_coordinate
          ? fmt::format(" (worst at \"{}\")", mechanism.coordinates()[static_cast<std::size_t>(report.step.worst)])
          : "";
  std::string what, remedy;
  switch (report.step.outcome) {
    case integrate::StepOutcome::not_finite:
      what = "a number that is not finite appeared" + at;
      remedy = "look at the loads and laws that act there at that time";
      break;
    case integrate::StepOutcome::not_converged:
      what = "Newton's method found no solution" + at;
      remedy =
          "look for a drive against a lock, for joints that leave no way to go on (a singular configuration), or allow "
          "smaller steps";
      break;
    case integrate::StepOutcome::overdetermined:
      what = fmt::format("the joints and drives cannot all be satisfied: \"{}\" stays apart",
                         mechanism.rows()[static_cast<std::size_t>(report.step.worst)]);
      remedy =
          "look for a drive where other joints leave no motion, and for two drives that ask for different motions; "
          "`rubato check` names joints that repeat each other";
      break;
    case integrate::StepOutcome::singular:
      what = "the matrix of the step cannot be factorised";
      remedy = "look for parts that nothing holds, or take smaller steps";
      break;
    case integrate::StepOutcome::too_small:
      what = "the error asked for a step below the smallest";
      remedy = advice_on_step;
      break;
    case integrate::StepOutcome::crawls:
      what = "it crawled: the last 2,000 steps were shorter than 1e-8 of the run" +
             last_to_change(transitions.all, mechanism);
      remedy = transitions.all.empty()
                   ? "take a larger tolerance, or equal steps"
                   : "look for friction, a drive and a lock that meet on one freedom, give a lock damping, or take a "
                     "larger tolerance or equal steps";
      break;
    case integrate::StepOutcome::no_way_on:
      if (transitions.chattering >= 0) {
        what = chattering_part(transitions.chattering, mechanism) + " changed a hundred times, and nothing moved";
        const bool is_lock = static_cast<std::size_t>(transitions.chattering) < mechanism.model().locks.size();
        const bool has_beams = !mechanism.model().beam_parts.empty();
        remedy = is_lock
                     ? fmt::format(
                           "what is elastic rattles on a rigid stop: give {}the lock a stiffness and damping, or take "
                           "a method that damps more, {{ name = \"generalized_alpha\", rho_inf = 0.3 }}",
                           has_beams ? "the material of the beams a retardation_time [s], " : "")
                     : "look for a law that jumps where the rate of the joint changes its sign (give it a slope there, "
                       "or take \"friction\" in its place), for a load that jumps as the joint begins to move, and for "
                       "more than six dry joints at rest, of which some follow reactions (take a preload for these)";
        break;
      }
      what = "no velocities and accelerations were found that the joints and locks allow from then on";
      remedy = "look for a drive against a lock, or for locks and drives that contradict each other there";
      if (has_followed_reactions(mechanism.model()))
        remedy += "; or the friction of joints that press each other leaves no way: take a preload for some of them";
      break;
    case integrate::StepOutcome::accepted:
      break;
  }
  using integrate::StepOutcome;
  const StepOutcome outcome = report.step.outcome;
  const bool is_stuck = outcome == StepOutcome::too_small || outcome == StepOutcome::crawls;
  if (outcome != StepOutcome::no_way_on || transitions.chattering < 0) {
    const std::string strut = collapsed_strut(mechanism, state);
    if (!strut.empty())
      return fmt::format(
          "at t = {} s the ends of the strut \"{}\" meet: at length 0 its force has no direction; give it a lock "
          "at its shortest length, or ends that pass by each other",
          report.failed_at, strut);
  }
  if (outcome == StepOutcome::not_finite || outcome == StepOutcome::singular || is_stuck) {
    const std::string part = non_finite_part_ahead(report, mechanism, state);
    if (part.find("whose table") != std::string::npos)
      return fmt::format(
          "at t = {:.6g} s {} ends: the joint goes beyond its rows; let the table reach further, or say beyond = "
          "\"hold\" "
          "or \"zero\"",
          report.failed_at, part);
    if (!part.empty())
      return fmt::format("at t = {:.6g} s {} has no finite value from there on", report.failed_at, part);
  }
  if (outcome == StepOutcome::not_converged || outcome == StepOutcome::singular || is_stuck) {
    const std::vector<std::string> joints = singular_joints(mechanism, state);
    if (!joints.empty()) {
      what +=
          fmt::format("; the mechanism is next to a singular configuration, where \"{}\" says what other joints say",
                      fmt::join(joints, "\" and \""));
      remedy = "take a larger tolerance, or equal steps, or a configuration that passes by its side";
    }
  }
  return fmt::format("at t = {} s with the step {} s {}; {}", report.failed_at, report.failed_step, what, remedy);
}

}  // namespace rubato::analysis
