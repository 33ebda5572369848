#pragma once

#include <rubato/results/columns/column_group.hpp>
#include <rubato/results/columns/contact_columns.hpp>
#include <rubato/system/locally_nonlinear.hpp>

#include <array>
#include <string>
#include <vector>

namespace rubato::results {

/// The blocks along the plane of contacts that rub in so many directions: `tangential_force` and `slip`, of rotations
/// `tangential_moment` and `slip_angle`, with _1 and _2 of two directions.
void add_rubbing_blocks(const std::vector<std::string>& contacts, Index directions, bool is_rotation,
                        TableLayout& layout);

/// The blocks across it: `normal_force` and `gap`, of rotations `normal_moment` and `gap_angle`.
void add_pressing_blocks(const std::vector<std::string>& contacts, const std::string& dimension, bool is_rotation,
                         TableLayout& layout);

/// Columns of contacts, laws of several numbers: forces and slips along their plane (with _1 and _2 where there are two
/// directions), the normal force, the gap and, in a motion, what they dissipated. Where all that u joins are rotations
/// the first are moments and angles, and so are the others where d joins rotations only.
class BlockColumns final : public ColumnGroup {
 public:
  /// @param in_motion  whether steps are booked
  BlockColumns(const system::LocallyNonlinear& system, bool in_motion);

  void add(TableLayout& layout) const override;
  /// One block of all contacts.
  void add(const ColumnNames& names, std::vector<Block>& blocks) const;
  bool has_sums() const override { return in_motion_ && system_.block_count() > 0; }
  void book(const system::State& before, const system::State& after) override;
  void append(const system::State& state, std::vector<double>& row) override { append_since(state, state, row); }
  void append_since(const system::State& before, const system::State& state, std::vector<double>& row) override;

 private:
  /// Those of one heading.
  struct Kind {
    bool is_rotation = false;
    std::vector<Index> blocks;
  };
  static Kind& kind_of(std::array<Kind, 2>& kinds, bool is_rotation);
  std::vector<std::string> names_of(const std::vector<Index>& blocks) const;
  Index directions_of(Index block) const;

  const system::LocallyNonlinear& system_;
  bool in_motion_;
  std::array<Kind, 2> rubbing_[model::largest_block];  // by how many directions they rub in
  std::array<Kind, 2> pressing_;
  std::vector<Index> all_;
  Vector dissipated_;  // by each block in the steps that are booked [J]
};

}  // namespace rubato::results
