#include <rubato/analysis/mechanism_failure.hpp>
#include <rubato/system/mechanism_equations.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <string>
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
  return fmt::format("the friction of \"{}\"", model.frictions[i - model.locks.size()].name);
}

}  // namespace

std::string failure_of(const integrate::MarchReport& report, const system::Mechanism& mechanism,
                       const system::State& state, Index chattering, const std::string& advice_on_step) {
  const std::string at =
      report.step.worst >= 0
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
    case integrate::StepOutcome::singular:
      what = "the matrix of the step cannot be factorised";
      remedy = "look for parts that nothing holds, or take smaller steps";
      break;
    case integrate::StepOutcome::too_small:
      what = "the error asked for a step below the smallest";
      remedy = advice_on_step;
      break;
    case integrate::StepOutcome::no_way_on:
      if (chattering >= 0) {
        what = chattering_part(chattering, mechanism) + " changed a hundred times, and nothing moved";
        remedy =
            "look for a law that jumps where the rate of the joint changes its sign (give it a slope there, or take "
            "\"friction\" in its place), and for a load that jumps as the joint begins to move";
        break;
      }
      what = "no velocities and accelerations were found that the joints and locks allow from then on";
      remedy = "look for a drive against a lock, or for locks and drives that contradict each other there";
      break;
    case integrate::StepOutcome::accepted:
      break;
  }
  using integrate::StepOutcome;
  const StepOutcome outcome = report.step.outcome;
  if (outcome == StepOutcome::not_finite || outcome == StepOutcome::singular || outcome == StepOutcome::too_small) {
    const std::string part = non_finite_part_ahead(report, mechanism, state);
    if (!part.empty()) return fmt::format("at t = {} s {} has no finite value from there on", report.failed_at, part);
  }
  if (outcome == StepOutcome::not_converged || outcome == StepOutcome::too_small || outcome == StepOutcome::singular) {
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
