#pragma once

#include <rubato/results/columns/column_group.hpp>
#include <rubato/system/mechanism_equations.hpp>

#include <string>
#include <vector>

namespace rubato::results {

/// Columns of the contacts of a mechanism, as BlockColumns.
class MechanismContactColumns final : public ColumnGroup {
 public:
  /// @param equations  lent; wherever they are left is well
  /// @param in_motion  whether steps are booked
  MechanismContactColumns(system::MechanismEquations& equations, bool in_motion);

  void add(TableLayout& layout) const override;
  bool has_sums() const override { return in_motion_; }
  void book(const system::State& before, const system::State& after) override;
  void append(const system::State& state, std::vector<double>& row) override { append_since(state, state, row); }
  void append_since(const system::State& before, const system::State& state, std::vector<double>& row) override;

 private:
  std::vector<std::string> names_of(const std::vector<std::size_t>& contacts) const;

  system::MechanismEquations& equations_;
  bool in_motion_;
  std::vector<std::size_t> rubbing_[model::largest_block];  // by how many directions they rub in
  std::vector<std::size_t> all_;
  Vector dissipated_, since_;  // by each contact in the steps that are booked, and in a part of the next [J]
};

}  // namespace rubato::results
