#pragma once

#include <rubato/integrate/kinds/march_kind.hpp>
#include <rubato/system/locally_nonlinear.hpp>

namespace rubato::integrate {

/// Marches of structures.
class StructureMarches final : public MarchKind {
 public:
  /// @param system  must outlive this
  explicit StructureMarches(const system::LocallyNonlinear& system) : system_(system) {}

  /// Refuses steps for the method `exact`, and supports that move.
  void check(const TransientRequest& request, const MarchPlan& plan) const override;
  /// Refuses positions that a search for an equilibrium would not keep.
  system::State start(const TransientRequest& request, std::vector<std::string>& warnings) const override;
  /// Refuses a step beyond the stability limit of the model.
  void take_equal_steps(const TransientRequest& request, MarchPlan& plan) const override;
  void plan_events(const std::string& title, const model::StepDescription& description, const MarchPlan& plan,
                   StepPlan& step) const override;
  double largest_step(const std::string& title, const model::StepDescription& description, const MarchPlan& plan,
                      double wanted) const override;
  EstimatorKind default_estimator(const MarchPlan& plan, double tolerance) const override;
  void try_estimator(const MarchPlan& plan, const AutomaticStep& step) const override;
  void check_loads(const TransientRequest& request, const MarchPlan& plan) const override;
  ModelStability stability_of(const Method& method) const override;
  std::unique_ptr<StepMarch> march(const MarchPlan& plan) const override;
  std::unique_ptr<FlowMarch> flow(const MarchPlan& plan) const override;

 private:
  const system::LocallyNonlinear& system_;
};

}  // namespace rubato::integrate
