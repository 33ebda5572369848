#include <rubato/analysis/automatic_step.hpp>
#include <rubato/analysis/failure_text.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <variant>

namespace rubato::analysis {
namespace {

using integrate::MarchFailure;
using integrate::StepOutcome;

struct Told {
  std::string what, remedy;
};

/// "; the last to change: "hinge" (locks at t = 1 s)", or nothing
std::string last_changes(const integrate::Events& changes) {
  std::vector<std::string> told;
  for (const auto& event : changes.all)
    told.push_back(fmt::format("\"{}\" ({} at t = {:.9g} s)", changes.parts[event.part],
                               integrate::name_of(event.change), event.t));
  return told.empty() ? "" : fmt::format("; the last to change: {}", fmt::join(told, ", "));
}

Told chattering(const MarchFailure& failure) {
  Told told;
  told.what = fmt::format("the {} of \"{}\" changed a hundred times, and nothing moved",
                          failure.is_lock_chattering ? "lock" : "friction", failure.chattering);
  told.remedy =
      failure.is_lock_chattering
          ? fmt::format(
                "what is elastic rattles on a rigid stop: give {}the lock a stiffness and damping, or take a method "
                "that damps more, {{ name = \"generalized_alpha\", rho_inf = 0.3 }}",
                failure.has_beams ? "the material of the beams a retardation_time [s], " : "")
          : "look for a law that jumps where the rate of the joint changes its sign (give it a slope there, or take "
            "\"friction\" in its place), for a load that jumps as the joint begins to move, and for more than six dry "
            "joints at rest, of which some follow reactions (take a preload for these)";
  return told;
}

Told no_way_on(const MarchFailure& failure) {
  if (!failure.chattering.empty()) return chattering(failure);
  Told told{"no velocities and accelerations were found that the joints and locks allow from then on",
            "look for a drive against a lock, or for locks and drives that contradict each other there"};
  if (failure.has_followed_reactions)
    told.remedy += "; or the friction of joints that press each other leaves no way: take a preload for some of them";
  return told;
}

/// The one place that words what became of a step. Structures settle contacts, mechanisms solve by Newton's method.
Told told_of(const MarchFailure& failure, const std::string& advice) {
  const bool is_structure = !failure.contacts.empty();
  const std::string at = failure.worst.empty() ? ""
                         : is_structure        ? fmt::format(" at coordinate \"{}\"", failure.worst)
                                               : fmt::format(" (worst at \"{}\")", failure.worst);
  switch (failure.outcome) {
    case StepOutcome::not_finite:
      return {"a number that is not finite appeared" + at,
              is_structure ? "look at the loads at that time, and whether the response grew before it (a smaller step, "
                             "or an unconditionally stable method)"
                           : "look at the loads and laws that act there at that time"};
    case StepOutcome::not_converged:
      if (is_structure)
        return {fmt::format("the {} found no consistent state (worst: \"{}\")", failure.contacts, failure.worst),
                "take a smaller step"};
      return {"Newton's method found no solution" + at,
              "look for a drive against a lock, for joints that leave no way to go on (a singular configuration), or "
              "allow smaller steps"};
    case StepOutcome::overdetermined:
      return {fmt::format("the joints and drives cannot all be satisfied: \"{}\" stays apart", failure.worst),
              "look for a drive where other joints leave no motion, and for two drives that ask for different motions; "
              "`rubato check` names joints that repeat each other"};
    case StepOutcome::singular:
      if (is_structure)
        return {"the effective matrix of the step cannot be factorised",
                "look for a negative stiffness or damping, or take a smaller step"};
      return {"the matrix of the step cannot be factorised",
              "look for parts that nothing holds, or take smaller steps"};
    case StepOutcome::too_small:
      return {"the error asked for a step below the smallest", advice};
    case StepOutcome::crawls:
      if (is_structure)
        return {"the run crawled: the last 2,000 steps were shorter than 1e-8 of the run",
                "look for a contact far stiffer than the rest (a smaller stiffness) and for contacts that change "
                "without end (a damper beside them, a slope in place of a jump), take a larger tolerance, a shorter "
                "run, or a fixed step"};
      return {
          "it crawled: the last 2,000 steps were shorter than 1e-8 of the run" + last_changes(failure.last_changes),
          failure.last_changes.all.empty()
              ? "take a larger tolerance, or equal steps"
              : "look for friction, a drive and a lock that meet on one freedom, give a lock damping, or take a larger "
                "tolerance or equal steps"};
    case StepOutcome::no_way_on:
      return no_way_on(failure);
    case StepOutcome::accepted:
      break;
  }
  return {};
}

/// What explains all of it where it is known; empty: nothing does.
std::string explanation(const MarchFailure& failure) {
  if (!failure.collapsed_strut.empty())
    return fmt::format(
        "at t = {} s the ends of the strut \"{}\" meet: at length 0 its force has no direction; give it a lock at its "
        "shortest length, or ends that pass by each other",
        failure.t, failure.collapsed_strut);
  if (failure.non_finite_part.empty()) return {};
  if (failure.non_finite_part.find("whose table") != std::string::npos)
    return fmt::format(
        "at t = {:.6g} s {} ends: the joint goes beyond its rows; let the table reach further, or say beyond = "
        "\"hold\" or \"zero\"",
        failure.t, failure.non_finite_part);
  return fmt::format("at t = {:.6g} s {} has no finite value from there on", failure.t, failure.non_finite_part);
}

}  // namespace

std::string advice_on_step(const MarchFailure& failure, const integrate::MarchPlan& plan) {
  if (!plan.automatic) return "take a smaller step";
  const AutomaticStep& step = *plan.automatic;
  const bool is_fixed = std::holds_alternative<integrate::FixedStep>(step.plan.controller);
  if (!is_fixed && step.tolerance < failure.least_tolerance)
    return fmt::format(
        "the tolerance {:.3g} is below {:.3g}, where the error of a step is what Newton's method leaves: take a larger "
        "one",
        step.tolerance, failure.least_tolerance);
  return advice_on_smallest(step.plan, plan.duration);
}

std::string text_of(const MarchFailure& failure, const std::string& advice_on_step) {
  if (const std::string known = explanation(failure); !known.empty()) return known;
  Told told = told_of(failure, advice_on_step);
  if (!failure.repeating_joints.empty()) {
    told.what +=
        fmt::format("; the mechanism is next to a singular configuration, where \"{}\" says what other joints say",
                    fmt::join(failure.repeating_joints, "\" and \""));
    told.remedy = "take a larger tolerance, or equal steps, or a configuration that passes by its side";
  }
  const bool is_structure = !failure.contacts.empty();
  return fmt::format("at t = {} s with the step {} s {}; {}",
                     is_structure ? fmt::format("{:.9g}", failure.t) : fmt::format("{}", failure.t),
                     is_structure ? fmt::format("{:.6g}", failure.step) : fmt::format("{}", failure.step), told.what,
                     told.remedy);
}

}  // namespace rubato::analysis
