#pragma once

#include <rubato/model/description.hpp>
#include <rubato/system/locally_nonlinear.hpp>

namespace rubato::system {
class Mechanism;
}

namespace rubato::analysis {

/// What an analysis works on: the model at the values of its parameters, and what it was made of, so that an analysis
/// may make it again at other values.
struct StudyInput {
  const model::StudyDescription& study;
  const numerics::Parameters& overrides;   ///< values that replace those of the study (--set)
  const numerics::Parameters& parameters;  ///< all values, in the order of the study
  const system::LocallyNonlinear& system;  ///< at these values; empty where the model is a mechanism
  const system::Mechanism* mechanism = nullptr;
};

}  // namespace rubato::analysis
