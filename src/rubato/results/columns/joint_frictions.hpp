#pragma once

#include <rubato/results/columns/column_group.hpp>
#include <rubato/system/mechanism_equations.hpp>

#include <cstddef>
#include <vector>

namespace rubato::results {

/// What the friction of joints does to their second parts, as columns of results: `friction_moment` [N m] of those that
/// turn, then `friction_force` [N] of those that slide, then `friction_force_x`, `_y` and `_z` [N] of planar ones, by
/// the axes of the world. While a joint sticks it is what holds it.
class JointFrictions final : public ColumnGroup {
 public:
  /// @param equations  lent; wherever they are left is well
  explicit JointFrictions(system::MechanismEquations& equations);

  void add(TableLayout& layout) const override;
  void append(const system::State& state, std::vector<double>& row) override;

 private:
  system::MechanismEquations& equations_;
  const system::Mechanism& mechanism_;
  std::vector<std::size_t> turning_, sliding_;  // among the frictions
  std::vector<std::size_t> planar_;             // those that lead
};

}  // namespace rubato::results
