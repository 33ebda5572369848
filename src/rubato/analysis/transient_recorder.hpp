#pragma once

#include <rubato/analysis/energy_ledger.hpp>
#include <rubato/analysis/observed_blocks.hpp>
#include <rubato/analysis/run_context.hpp>
#include <rubato/analysis/transient_plan.hpp>
#include <rubato/integrate/balance.hpp>

#include <memory>
#include <string>
#include <vector>

namespace rubato::analysis {

/// Turns states into rows: time, position, velocity and acceleration of what is observed, force and slip of every
/// slider, force and penetration of every stop, and the energy ledger in a table of its own.
class TransientRecorder {
 public:
  TransientRecorder(const std::string& name, const TransientPlan& plan, const system::LocallyNonlinear& system,
                    integrate::Balance& balance, results::Sink& sink);

  /// @param energy  null without a ledger
  /// @param is_balanced  the acceleration of the state is that to tell: between the ends of a step
  void record(const system::State& state, const Energy* energy, bool is_balanced = false);
  bool keeps_energy() const { return energy_rows_ != nullptr; }
  long rows() const { return count_; }

 private:
  void add_reactions(results::TableLayout& layout) const;
  void append_supports(const system::State& state);

  const system::LocallyNonlinear& system_;
  ObservedBlocks observed_;
  SliderBlocks sliders_;
  StopBlocks stops_;
  integrate::Balance& balance_;
  system::State shown_;
  Vector q_, v_, a_, reaction_;  // of all coordinates, where supports move
  std::vector<double> row_;
  std::unique_ptr<results::RowWriter> rows_, energy_rows_;
  long count_ = 0;
};

}  // namespace rubato::analysis
