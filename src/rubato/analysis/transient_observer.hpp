#pragma once

#include <rubato/analysis/interpolation.hpp>
#include <rubato/analysis/run_context.hpp>
#include <rubato/analysis/transient_plan.hpp>
#include <rubato/integrate/driver.hpp>

namespace rubato::analysis {

/// What a transient keeps of one kind of system: its ledger of energy, its rows, and what else is told of the run.
class TransientBooks {
 public:
  virtual ~TransientBooks() = default;

  virtual void start(const system::State& state) = 0;
  /// Books an accepted step; every step of the march is given.
  virtual void book(const system::State& before, const system::State& after) = 0;
  /// Writes a row.
  /// @param before  the last state booked; may be `now`
  /// @param is_balanced  acceleration and multipliers of `now` are those to tell: between the ends of a step
  virtual void record(const system::State& before, const system::State& now, bool is_balanced) = 0;
};

/// Books every accepted step, records those that are asked for and states between them, and hears of Ctrl-C.
class TransientObserver final : public integrate::Observer {
 public:
  /// @param interpolation   of the system of the march; of no use where rows are those of steps
  /// @param steps_a_report  of progress
  TransientObserver(const TransientPlan& plan, TransientBooks& books, StepInterpolation interpolation,
                    long steps_a_report, RunContext& context);

  void start(const system::State& state);
  bool accepted(const system::State& before, const system::State& after) override;
  /// The state in which the march ended is worth keeping even between outputs.
  void finish(const system::State& state);

 private:
  /// How many steps there will be is not known of automatic ones.
  double progress(const system::State& state) const { return plan_.automatic ? state.t : static_cast<double>(steps_); }
  void record(const system::State& before, const system::State& now, bool is_balanced = false);
  void record_between(const system::State& before, const system::State& after);
  double next_time() const;

  const TransientPlan& plan_;
  TransientBooks& books_;
  StepInterpolation interpolation_;
  RunContext& context_;
  system::State between_;
  long steps_a_report_, steps_ = 0, next_ = 0;
  bool last_recorded_ = false;
};

}  // namespace rubato::analysis
