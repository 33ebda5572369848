#pragma once

#include <rubato/analysis/transient_kind.hpp>
#include <rubato/integrate/kinds/mechanism_kind.hpp>
#include <rubato/system/mechanism.hpp>

namespace rubato::analysis {

/// Transients of mechanisms. Locks are located with equal steps too.
class MechanismTransient final : public TransientKind {
 public:
  /// @param mechanism  must outlive this
  explicit MechanismTransient(const system::Mechanism& mechanism) : mechanism_(mechanism) {}

  Observable observable() const override { return {mechanism_}; }
  double reference() const override { return mechanism_.reference(); }
  /// Refuses a method that constraints do not go with, and section forces of beams that are not there.
  void check(const TransientRequest& request, const TransientPlan& plan) const override;
  /// Assembles the mechanism, and names the joints and by how much they are apart where that fails.
  void find_start(const TransientRequest& request, TransientPlan& plan) const override;
  LoadSwings swings(double duration) const override { return {integrate::MechanismKind(mechanism_), duration}; }
  void take_equal_steps(const TransientRequest& request, TransientPlan& plan) const override;
  void plan_events(const std::string& title, const model::StepDescription& description, const TransientPlan& plan,
                   integrate::StepPlan& step) const override;
  double largest_step(const std::string&, const model::StepDescription&, const TransientPlan&,
                      double wanted) const override {
    return wanted;
  }
  integrate::EstimatorKind default_estimator(const TransientPlan&, double tolerance) const override {
    return integrate::LocalError{tolerance};
  }
  void try_estimator(const TransientPlan& plan, const AutomaticStep& step) const override;
  void check_loads(const TransientRequest& request, const TransientPlan& plan) const override;
  double expected_columns(const TransientPlan& plan) const override {
    return 10.0 + 3.0 * static_cast<double>(plan.observed.size());
  }
  std::unique_ptr<TransientMarch> march(const TransientPlan& plan) const override;

 private:
  const system::Mechanism& mechanism_;
};

}  // namespace rubato::analysis
