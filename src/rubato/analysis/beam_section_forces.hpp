#pragma once

#include <rubato/model/description.hpp>
#include <rubato/results/sink.hpp>
#include <rubato/system/mechanism.hpp>

#include <memory>
#include <string>
#include <vector>

namespace rubato::analysis {

/// What the sections in the middles of the elements of some beams carry, as columns of results, a block a component:
/// see model::BeamForces.
class BeamSectionForces {
 public:
  /// Throws InvalidInput for a beam that is not there.
  /// @param title  of the analysis, for the error
  BeamSectionForces(const system::Mechanism& mechanism, const model::SectionForcesDescription& wanted,
                    const std::string& title);

  void add(results::TableLayout& layout) const;
  /// Appends the values, in the order of `add`.
  void append(const model::Motion& motion, std::vector<double>& row);

 private:
  struct Part {
    std::string name;
    std::vector<const model::BeamForces*> forces;
  };
  void take(const system::Mechanism& mechanism, const std::string& beam);

  bool in_plane_;
  std::vector<std::unique_ptr<model::Element>> elements_;  // that the parts look at
  std::vector<Part> parts_;
  std::vector<double> values_;  // by parts
};

}  // namespace rubato::analysis
