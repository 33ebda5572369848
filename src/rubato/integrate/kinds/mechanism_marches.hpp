#pragma once

#include <rubato/integrate/kinds/march_kind.hpp>
#include <rubato/system/mechanism.hpp>

namespace rubato::integrate {

/// Marches of mechanisms. Locks are located with equal steps too.
class MechanismMarches final : public MarchKind {
 public:
  /// @param mechanism  must outlive this
  explicit MechanismMarches(const system::Mechanism& mechanism) : mechanism_(mechanism) {}

  /// Refuses a method that constraints do not go with.
  void check(const TransientRequest& request, const MarchPlan& plan) const override;
  /// Assembles the mechanism, and names the joints and by how much they are apart where that fails.
  system::State start(const TransientRequest& request, std::vector<std::string>& warnings) const override;
  system::State set_in_motion(const Location& where, const system::State& at_rest,
                              std::vector<std::string>& warnings) const override;
  /// Decides which joints stick.
  void settle_start(const Location& where, MarchPlan& plan) const override;
  void take_equal_steps(const TransientRequest& request, MarchPlan& plan) const override;
  void plan_events(const std::string& title, const model::StepDescription& description, const MarchPlan& plan,
                   StepPlan& step) const override;
  double largest_step(const std::string&, const model::StepDescription&, const MarchPlan&,
                      double wanted) const override {
    return wanted;
  }
  EstimatorKind default_estimator(const MarchPlan&, double tolerance) const override { return LocalError{tolerance}; }
  void try_estimator(const MarchPlan& plan, const AutomaticStep& step) const override;
  void check_loads(const TransientRequest& request, const MarchPlan& plan) const override;
  /// Methods that check() lets pass are stable with every step.
  ModelStability stability_of(const Method& method) const override;
  std::unique_ptr<StepMarch> march(const MarchPlan& plan) const override;
  std::unique_ptr<FlowMarch> flow(const MarchPlan&) const override { return nullptr; }

 private:
  const system::Mechanism& mechanism_;
};

}  // namespace rubato::integrate
