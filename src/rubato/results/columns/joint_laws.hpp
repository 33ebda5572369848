#pragma once

#include <rubato/model/bodies/element.hpp>
#include <rubato/results/columns/column_group.hpp>
#include <rubato/system/state_motion.hpp>

#include <memory>
#include <string>
#include <vector>

namespace rubato::results {

/// What springs, dampers, laws and elastic locks do together on the coordinate of each joint that has any, as columns
/// of results: `law_moment` [N m] of those that turn, then `law_force` [N] of those that slide and of struts; + opens
/// the angle, or moves the second part away.
class JointLaws final : public ColumnGroup {
 public:
  explicit JointLaws(const system::Mechanism& mechanism);

  void add(TableLayout& layout) const override;
  void append(const system::State& state, std::vector<double>& row) override;

 private:
  struct Law {
    std::string name;
    model::FreeCoordinate s;
    std::vector<std::unique_ptr<model::Element>> elements;
  };
  double value(const Law& law, const model::Motion& motion);

  system::StateMotion motion_;
  std::vector<Law> turning_, sliding_;
  std::vector<double> force_, slope_;
};

}  // namespace rubato::results
