#pragma once

#include <rubato/results/columns/column_group.hpp>
#include <rubato/system/state_motion.hpp>

#include <vector>

namespace rubato::results {

/// Columns of the [[stop]]s of a mechanism, as StopColumns.
class MechanismStopColumns final : public ColumnGroup {
 public:
  explicit MechanismStopColumns(const system::Mechanism& mechanism);

  void add(TableLayout& layout) const override;
  void append(const system::State& state, std::vector<double>& row) override;

 private:
  const system::Mechanism& mechanism_;
  system::StateMotion motion_;
  std::vector<std::size_t> sliding_, turning_;  // among the locks
};

}  // namespace rubato::results
