#pragma once

#include <rubato/analysis/transient_kind.hpp>
#include <rubato/integrate/kinds/structure_kind.hpp>
#include <rubato/system/locally_nonlinear.hpp>

namespace rubato::analysis {

/// Transients of structures.
class StructureTransient final : public TransientKind {
 public:
  /// @param system  must outlive this
  explicit StructureTransient(const system::LocallyNonlinear& system) : system_(system) {}

  Observable observable() const override { return {system_, system_.supports(), Supports::observed}; }
  double reference() const override { return system_.reference(); }
  void check(const TransientRequest& request, const TransientPlan& plan) const override;
  void find_start(const TransientRequest& request, TransientPlan& plan) const override;
  LoadSwings swings(double duration) const override { return {integrate::StructureKind(system_), duration}; }
  /// Refuses a step beyond the stability limit of the model.
  void take_equal_steps(const TransientRequest& request, TransientPlan& plan) const override;
  void plan_events(const std::string& title, const model::StepDescription& description, const TransientPlan& plan,
                   integrate::StepPlan& step) const override;
  double largest_step(const std::string& title, const model::StepDescription& description, const TransientPlan& plan,
                      double wanted) const override;
  integrate::EstimatorKind default_estimator(const TransientPlan& plan, double tolerance) const override;
  void try_estimator(const TransientPlan& plan, const AutomaticStep& step) const override;
  void check_loads(const TransientRequest& request, const TransientPlan& plan) const override;
  double expected_columns(const TransientPlan& plan) const override;
  std::unique_ptr<TransientMarch> march(const TransientPlan& plan) const override;
  /// The event-driven flow, for the method `exact`.
  RunReport run(const std::string& name, const TransientPlan& plan, RunContext& context) const override;

 private:
  const system::LocallyNonlinear& system_;
};

}  // namespace rubato::analysis
