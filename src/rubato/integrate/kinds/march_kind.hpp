#pragma once

#include <rubato/core/error.hpp>
#include <rubato/integrate/march.hpp>
#include <rubato/integrate/march_plan.hpp>
#include <rubato/integrate/stability.hpp>
#include <rubato/model/description.hpp>

#include <memory>
#include <string>
#include <vector>

namespace rubato::integrate {

/// What a study asks of a transient, and where it says so.
struct TransientRequest {
  const std::string& name;
  const Location& where;
  const model::TransientDescription& description;
  const numerics::Parameters& parameters;

  /// Heads the messages.
  std::string title() const { return "analysis \"" + name + "\": "; }
};

/// What marches of one kind of system have of their own: what may be asked of them, where they start, their steps and
/// their loops.
///
/// These functions throw InvalidInput at the place of what is wrong. A plan is filled from the top: method, flags and
/// duration, then the start, then the steps.
class MarchKind {
 public:
  virtual ~MarchKind() = default;

  /// Refuses methods and keys that do not go with such systems.
  virtual void check(const TransientRequest& request, const MarchPlan& plan) const = 0;

  /// Where a march starts, or the search for the equilibrium from which one does. What that took is told in `warnings`.
  virtual system::State start(const TransientRequest& request, std::vector<std::string>& warnings) const = 0;
  /// The start from an equilibrium.
  virtual system::State set_in_motion(const Location& /*where*/, const system::State& at_rest,
                                      std::vector<std::string>& /*warnings*/) const {
    return at_rest;
  }
  /// Decides what is open at the start of a plan, also of one that will fail.
  virtual void settle_start(const Location& /*where*/, MarchPlan& /*plan*/) const {}

  /// Takes plan.step as that of equal steps.
  virtual void take_equal_steps(const TransientRequest& request, MarchPlan& plan) const = 0;
  /// Of steps that choose themselves: at which events they end, by a plan whose controller is known.
  virtual void plan_events(const std::string& title, const model::StepDescription& description, const MarchPlan& plan,
                           StepPlan& step) const = 0;
  /// The largest of them [s], where `wanted` is what the study says, or what the loads allow.
  virtual double largest_step(const std::string& title, const model::StepDescription& description,
                              const MarchPlan& plan, double wanted) const = 0;
  /// The estimator where the study names none, and the controller is not that of a paper.
  virtual EstimatorKind default_estimator(const MarchPlan& plan, double tolerance) const = 0;
  /// Refuses an estimator that cannot measure what the plan says.
  virtual void try_estimator(const MarchPlan& plan, const AutomaticStep& step) const = 0;
  /// Refuses loads that do not reach over the whole run, and motions that jump; what else can be known only of a whole
  /// plan.
  virtual void check_loads(const TransientRequest& request, const MarchPlan& plan) const = 0;

  /// The largest stable step of a method with equal steps, and what sets it.
  virtual ModelStability stability_of(const Method& method) const = 0;

  /// A march by a method with a step.
  /// @param plan  must outlive it
  virtual std::unique_ptr<StepMarch> march(const MarchPlan& plan) const = 0;
  /// A march by the method `exact`; null where there is none for any such system.
  /// @param plan  must outlive it
  virtual std::unique_ptr<FlowMarch> flow(const MarchPlan& plan) const = 0;
};

}  // namespace rubato::integrate
