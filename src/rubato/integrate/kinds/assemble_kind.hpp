#pragma once

#include <rubato/integrate/kinds/system_kind.hpp>

#include <memory>

namespace rubato::integrate {

/// The system that a model is at some values of its parameters, with what analyses ask of it. The model decides its
/// kind. Throws InvalidInput.
std::unique_ptr<const SystemKind> assemble_kind(const model::ModelDescription& model,
                                                const numerics::Parameters& parameters);

}  // namespace rubato::integrate
