#pragma once

#include <rubato/model/description.hpp>
#include <rubato/results/columns/column_group.hpp>
#include <rubato/system/state_motion.hpp>

#include <memory>
#include <string>
#include <vector>

namespace rubato::results {

/// What the sections in the middles of the elements of some beams carry, as columns of results, a block a component:
/// see model::BeamForces.
class BeamSectionForces final : public ColumnGroup {
 public:
  /// Throws InvalidInput for a beam that is not there.
  /// @param title  of the analysis, for the error
  BeamSectionForces(const system::Mechanism& mechanism, const model::SectionForcesDescription& wanted,
                    const std::string& title);

  void add(TableLayout& layout) const override;
  void append(const system::State& state, std::vector<double>& row) override;

 private:
  struct Part {
    std::string name;
    std::vector<const model::BeamForces*> forces;
  };
  void take(const system::Mechanism& mechanism, const std::string& beam);

  system::StateMotion motion_;
  bool in_plane_;
  std::vector<std::unique_ptr<model::Element>> elements_;  // that the parts look at
  std::vector<Part> parts_;
  std::vector<double> values_;  // by parts
};

}  // namespace rubato::results
