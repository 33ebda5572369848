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
};

using ColumnGroups = std::vector<std::unique_ptr<ColumnGroup>>;

}  // namespace rubato::results
