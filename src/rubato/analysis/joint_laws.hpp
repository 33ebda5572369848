#pragma once

#include <rubato/model/bodies/element.hpp>
#include <rubato/results/sink.hpp>
#include <rubato/system/mechanism.hpp>

#include <memory>
#include <string>
#include <vector>

namespace rubato::analysis {

/// What springs, dampers, laws and elastic locks do together on the coordinate of each joint that has any, as columns
/// of results: `law_moment` [N m] of those that turn, then `law_force` [N] of those that slide and of struts; + opens
/// the angle, or moves the second part away.
class JointLaws {
 public:
  explicit JointLaws(const system::Mechanism& mechanism);

  void add(results::TableLayout& layout) const;
  /// Appends the values, in the order of `add`.
  void append(const model::Motion& motion, std::vector<double>& row);

 private:
  struct Law {
    std::string name;
    model::FreeCoordinate s;
    std::vector<std::unique_ptr<model::Element>> elements;
  };
  double value(const Law& law, const model::Motion& motion);

  std::vector<Law> turning_, sliding_;
  std::vector<double> force_, slope_;
};

}  // namespace rubato::analysis
