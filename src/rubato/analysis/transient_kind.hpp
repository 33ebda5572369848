#pragma once

#include <rubato/analysis/load_swings.hpp>
#include <rubato/analysis/run_context.hpp>
#include <rubato/analysis/transient_plan.hpp>
#include <rubato/integrate/balance.hpp>
#include <rubato/integrate/driver.hpp>
#include <rubato/integrate/energy_ledger.hpp>
#include <rubato/integrate/events.hpp>
#include <rubato/integrate/kinds/system_kind.hpp>
#include <rubato/integrate/march_failure.hpp>
#include <rubato/results/columns/column_group.hpp>
#include <rubato/system/system.hpp>

#include <memory>
#include <string>
#include <vector>

namespace rubato::analysis {

/// A planned transient of one kind of system, ready to go.
class TransientMarch {
 public:
  virtual ~TransientMarch() = default;

  virtual const system::State& state() const = 0;
  /// Lent, as long as this is there.
  virtual integrate::Balance& balance() = 0;
  virtual std::vector<std::unique_ptr<integrate::EnergyPart>> energy_parts() = 0;
  virtual results::ColumnGroups columns() = 0;
  /// Times at which steps end since a load, a drive or a law may have a kink there, rising [s].
  virtual std::vector<double> kinks() const { return {}; }
  /// Hears of every accepted step; null: nobody does.
  virtual integrate::Observer* listener() { return nullptr; }
  /// After which progress is told.
  virtual long steps_a_report() const = 0;

  /// Why the march cannot begin; accepted: it can.
  virtual integrate::StepReport start_fault() const { return {}; }
  /// Goes on to `end` [s]; observer and log may be null.
  virtual integrate::AdaptiveReport go_to(double end, integrate::Observer* observer, integrate::TryLog* log) = 0;
  /// Why it ended before its time.
  virtual integrate::MarchFailure failure(const integrate::MarchReport& report) = 0;
  /// What its parts did so far.
  virtual integrate::Events events() const = 0;
  /// Tells what else there is of a march that ended.
  virtual void conclude(const integrate::AdaptiveReport& report, RunReport& run) const = 0;
};

/// What transients of one kind of system have of their own. plan_transient() and run() do the rest.
///
/// These functions throw InvalidInput at the place of what is wrong.
class TransientKind {
 public:
  virtual ~TransientKind() = default;

  /// The system, with supports that move.
  virtual Observable observable() const = 0;
  /// Characteristic size of the model for error measures [m sqrt(kg)]; 0: it has none.
  virtual double reference() const = 0;
  /// Refuses methods and keys that do not go with such systems.
  virtual void check(const TransientRequest& request, const TransientPlan& plan) const = 0;
  /// Sets the start of a plan, what it took among the warnings, and the failure where there is none.
  virtual void find_start(const TransientRequest& request, TransientPlan& plan) const = 0;

  virtual LoadSwings swings(double duration) const = 0;
  /// Takes plan.step as that of equal steps.
  virtual void take_equal_steps(const TransientRequest& request, TransientPlan& plan) const = 0;
  /// Of steps that choose themselves: at which events they end, by a plan whose controller is known.
  virtual void plan_events(const std::string& title, const model::StepDescription& description,
                           const TransientPlan& plan, integrate::StepPlan& step) const = 0;
  /// The largest of them [s], where `wanted` is what the study says, or what the loads allow.
  virtual double largest_step(const std::string& title, const model::StepDescription& description,
                              const TransientPlan& plan, double wanted) const = 0;
  /// The estimator where the study names none, and the controller is not that of a paper.
  virtual integrate::EstimatorKind default_estimator(const TransientPlan& plan, double tolerance) const = 0;
  /// Refuses an estimator that cannot measure what the plan says.
  virtual void try_estimator(const TransientPlan& plan, const AutomaticStep& step) const = 0;

  /// Refuses loads that do not reach over the whole run, and motions that jump; what else can be known only of a whole
  /// plan.
  virtual void check_loads(const TransientRequest& request, const TransientPlan& plan) const = 0;
  /// How many columns a row will have, roughly.
  virtual double expected_columns(const TransientPlan& plan) const = 0;

  /// @param plan  must outlive the march
  virtual std::unique_ptr<TransientMarch> march(const TransientPlan& plan) const = 0;
  /// Marches a planned transient and streams its rows; memory does not grow with the duration. Methods that do not
  /// march have a way of their own.
  virtual RunReport run(const std::string& name, const TransientPlan& plan, RunContext& context) const;
};

/// Transients of a system, which must outlive them.
std::unique_ptr<TransientKind> transient_kind(const integrate::SystemKind& kind);

}  // namespace rubato::analysis
