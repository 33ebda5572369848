#pragma once

#include <rubato/results/columns/observed_columns.hpp>
#include <rubato/system/locally_nonlinear.hpp>

#include <string>
#include <vector>

namespace rubato::results {

/// Columns of the sliders: those between displacements before those between rotations.
class SliderColumns : public ColumnGroup {
 public:
  explicit SliderColumns(const system::LocallyNonlinear& system);

  /// Adds `force` and `slip`, then `moment` and `slip_angle`.
  void add(TableLayout& layout) const override;
  void append(const system::State& state, std::vector<double>& row) override;

  /// Adds a quantity of the sliders between displacements and of those between rotations.
  void add(const ColumnNames& of_displacements, const ColumnNames& of_rotations, std::vector<Block>& blocks) const;
  /// Adds a quantity with the same unit for all.
  void add(const ColumnNames& names, std::vector<Block>& blocks) const;
  /// The sliders in the order of the columns.
  std::vector<Index> order() const;

 private:
  std::vector<std::string> labels_of(const std::vector<Index>& sliders) const;

  const system::LocallyNonlinear& system_;
  std::vector<Index> of_displacements_, of_rotations_;
};

/// The blocks of some stops: `force` and `penetration`, of those between rotations `moment` and `penetration_angle`.
void add_stop_blocks(const std::vector<std::string>& stops, bool is_rotation, TableLayout& layout);

/// Columns of the stops: `force` and `penetration`, of those between rotations `moment` and `penetration_angle`.
class StopColumns final : public ColumnGroup {
 public:
  explicit StopColumns(const system::LocallyNonlinear& system);

  void add(TableLayout& layout) const override;
  void append(const system::State& state, std::vector<double>& row) override;

 private:
  const system::LocallyNonlinear& system_;
  std::vector<Index> of_displacements_, of_rotations_;
};

}  // namespace rubato::results
