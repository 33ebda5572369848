#pragma once

#include <rubato/results/columns/column_group.hpp>
#include <rubato/system/state_motion.hpp>

#include <vector>

namespace rubato::results {

/// What bushings do to their second parts, by their own axes, which turn with the first: `force_x` [N] and so on, and
/// `moment` [N m], in space `moment_x` and so on.
class BushingForces final : public ColumnGroup {
 public:
  explicit BushingForces(const system::Mechanism& mechanism);

  void add(TableLayout& layout) const override;
  void append(const system::State& state, std::vector<double>& row) override;

 private:
  const system::Mechanism& mechanism_;
  system::StateMotion motion_;
  std::vector<double> values_;  // of each bushing, its components
};

}  // namespace rubato::results
