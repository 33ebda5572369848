#pragma once

#include <rubato/analysis/extremes.hpp>
#include <rubato/analysis/residue_watch.hpp>
#include <rubato/analysis/transient_plan.hpp>
#include <rubato/integrate/balance.hpp>
#include <rubato/integrate/energy_ledger.hpp>
#include <rubato/results/columns/column_group.hpp>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace rubato::analysis {

/// Turns states into rows: time and the columns of some groups, and the energy ledger in a table of its own.
///
/// Accelerations and reactions are those of equilibrium at the positions and velocities of the row: the multipliers of
/// a step carry what the constraints do to velocities that have drifted, over the length of that step.
class TransientRecorder {
 public:
  /// @param balance  of the march; lent
  /// @param ledger   null: no table of energy; lent
  TransientRecorder(const std::string& name, const TransientPlan& plan, results::ColumnGroups groups,
                    integrate::Balance& balance, integrate::EnergyLedger* ledger, results::Sink& sink);

  /// Adds an accepted step to the ledger, and to the columns that show sums.
  void book(const system::State& before, const system::State& after);
  /// Writes a row.
  /// @param before  the last state booked; may be `now`
  /// @param is_balanced  acceleration and multipliers of `now` are those to show: between the ends of a step
  void record(const system::State& before, const system::State& now, bool is_balanced = false);
  /// Takes a state at the end of a step into the extremes, and shows it to the table `every_step` where the plan has
  /// it.
  void show_step(const system::State& state);
  /// Writes the extremes of all columns over what was shown and recorded.
  void write_extremes(results::Sink& sink) const { analysis::write_extremes(layout_, extremes_, sink); }
  long rows() const { return count_; }
  /// Null: there is no ledger.
  const ResidueWatch* residue() const { return residue_ ? &*residue_ : nullptr; }

 private:
  results::ColumnGroups groups_;
  std::vector<results::ColumnGroup*> summing_;
  integrate::Balance& balance_;
  integrate::EnergyLedger* ledger_;
  std::optional<ResidueWatch> residue_;
  system::State shown_;
  results::TableLayout layout_;
  Extremes extremes_;
  std::vector<double> row_;
  std::unique_ptr<results::RowWriter> rows_, energy_rows_, step_rows_;
  long count_ = 0, booked_ = 0;
};

}  // namespace rubato::analysis
