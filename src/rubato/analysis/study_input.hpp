#pragma once

#include <rubato/integrate/kinds/system_kind.hpp>
#include <rubato/model/description.hpp>

namespace rubato::analysis {

class StudyTransients;

/// What an analysis works on: the model at the values of its parameters, and what it was made of, so that an analysis
/// may make it again at other values.
struct StudyInput {
  const model::StudyDescription& study;
  const numerics::Parameters& overrides;   ///< values that replace those of the study (--set)
  const numerics::Parameters& parameters;  ///< all values, in the order of the study
  const integrate::SystemKind& kind;       ///< the system at these values
  StudyTransients* transients = nullptr;   ///< at these values; null: each analysis plans those that it needs

  /// Of analyses that only structures have.
  const auto& structure() const { return *kind.structure(); }
};

}  // namespace rubato::analysis
