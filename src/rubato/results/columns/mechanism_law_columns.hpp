#pragma once

#include <rubato/results/columns/column_group.hpp>
#include <rubato/system/mechanism_equations.hpp>

#include <vector>

namespace rubato::results {

/// Columns of the laws with a memory of a mechanism, as LawColumns.
class MechanismLawColumns final : public ColumnGroup {
 public:
  /// @param equations  lent; wherever they are left is well
  /// @param in_motion  whether steps are booked
  MechanismLawColumns(system::MechanismEquations& equations, bool in_motion);

  void add(TableLayout& layout) const override;
  bool has_sums() const override { return in_motion_; }
  void book(const system::State& before, const system::State& after) override;
  void append(const system::State& state, std::vector<double>& row) override { append_since(state, state, row); }
  void append_since(const system::State& before, const system::State& state, std::vector<double>& row) override;

 private:
  system::MechanismEquations& equations_;
  bool in_motion_;
  std::vector<std::size_t> sliding_, turning_, rubbing_sliding_, rubbing_turning_;
  Vector dissipated_, since_;  // by each law in the steps that are booked, and in a part of the next [J]
};

}  // namespace rubato::results
