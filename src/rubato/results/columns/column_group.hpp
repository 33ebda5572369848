#pragma once

#include <rubato/results/sink.hpp>
#include <rubato/system/state.hpp>

#include <memory>
#include <vector>

namespace rubato::results {

/// Some columns of a table of states: names with units, and the values of a row. A workspace.
class ColumnGroup {
 public:
  virtual ~ColumnGroup() = default;

  virtual void add(TableLayout& layout) const = 0;
  /// Appends the values, in the order of `add`.
  /// @param state  with the acceleration and the multipliers that its row shows
  virtual void append(const system::State& state, std::vector<double>& row) = 0;

  /// Whether it shows sums over the steps of a march: then each accepted step is booked.
  virtual bool has_sums() const { return false; }
  virtual void book(const system::State& /*before*/, const system::State& /*after*/) {}
  /// append() of a state in the step after `before`, the last state booked, or of that itself.
  virtual void append_since(const system::State& /*before*/, const system::State& state, std::vector<double>& row) {
    append(state, row);
  }
};

using ColumnGroups = std::vector<std::unique_ptr<ColumnGroup>>;

}  // namespace rubato::results
