#pragma once

#include <rubato/analysis/interpolation.hpp>
#include <rubato/analysis/run_context.hpp>
#include <rubato/analysis/transient_recorder.hpp>
#include <rubato/integrate/driver.hpp>

namespace rubato::analysis {

/// Books every accepted step, records those that are asked for and states between them, and hears of Ctrl-C.
class TransientObserver final : public integrate::Observer {
 public:
  /// @param ledger          null: none is kept
  /// @param interpolation   of the system of the march; of no use where rows are those of steps
  /// @param steps_a_report  of progress
  /// @param listener        hears of every accepted step too; null: nobody does
  TransientObserver(const TransientPlan& plan, TransientRecorder& recorder, integrate::EnergyLedger* ledger,
                    StepInterpolation interpolation, long steps_a_report, RunContext& context,
                    integrate::Observer* listener = nullptr);

  void start(const system::State& state);
  bool accepted(const system::State& before, const system::State& after) override;
  /// The state in which the march ended is worth keeping even between outputs.
  void finish(const system::State& state);

 private:
  /// How many steps there will be is not known of automatic ones.
  double progress(const system::State& state) const {
    return plan_.march.automatic ? state.t : static_cast<double>(steps_);
  }
  void record(const system::State& before, const system::State& now, bool is_balanced = false);
  void record_between(const system::State& before, const system::State& after);
  double next_time() const;

  const TransientPlan& plan_;
  TransientRecorder& recorder_;
  integrate::EnergyLedger* ledger_;
  StepInterpolation interpolation_;
  RunContext& context_;
  integrate::Observer* listener_;
  system::State between_;
  long steps_a_report_, steps_ = 0, next_ = 0;
  bool last_recorded_ = false;
};

}  // namespace rubato::analysis
