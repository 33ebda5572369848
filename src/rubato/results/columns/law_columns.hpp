#pragma once

#include <rubato/results/columns/observed_columns.hpp>
#include <rubato/system/locally_nonlinear.hpp>

#include <string>
#include <vector>

namespace rubato::results {

/// The blocks of some laws: `force` and `displacement`, of those on angles `moment` and `angle`, and `dissipated`.
void add_law_blocks(const std::vector<std::string>& laws, bool is_rotation, bool has_dissipated, TableLayout& layout);

/// Of laws of friction `slip` and `normal_force`, of those on angles `slip_angle` and `normal_force`, for those that
/// there are.
void add_friction_blocks(const std::vector<std::string>& laws, bool is_rotation, TableLayout& layout);

/// Columns of the laws beside sliders and stops: `force` and `displacement`, of those between rotations `moment` and
/// `angle`; in a motion `dissipated` since its start as well; of laws of friction `slip` (or `slip_angle`) and
/// `normal_force` behind them.
class LawColumns final : public ColumnGroup {
 public:
  /// @param in_motion  whether steps are booked
  LawColumns(const system::LocallyNonlinear& system, bool in_motion);

  void add(TableLayout& layout) const override;
  bool has_sums() const override { return in_motion_ && system_.law_count() > 0; }
  void book(const system::State& before, const system::State& after) override;
  void append(const system::State& state, std::vector<double>& row) override { append_since(state, state, row); }
  void append_since(const system::State& before, const system::State& state, std::vector<double>& row) override;

  /// Adds one quantity with the same unit for all.
  void add(const ColumnNames& names, std::vector<Block>& blocks) const;
  /// The laws in the order of the columns.
  std::vector<Index> order() const;

 private:
  std::vector<std::string> names_of(const std::vector<Index>& laws) const;

  const system::LocallyNonlinear& system_;
  bool in_motion_;
  std::vector<Index> of_displacements_, of_rotations_, friction_of_displacements_, friction_of_rotations_;
  Vector dissipated_;  // by each law in the steps that are booked [J]
};

}  // namespace rubato::results
