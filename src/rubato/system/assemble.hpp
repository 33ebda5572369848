#pragma once

#include <rubato/model/model.hpp>
#include <rubato/system/locally_nonlinear.hpp>

namespace rubato::system {

/// The equations of a model: the one place that knows both. Modal damping takes the modes of the model without sliders,
/// and makes C full: up to 2,000 coordinates. Throws InvalidInput for a model whose mass matrix is not positive
/// definite, naming a coordinate, and for modal damping whose list does not fit the number of modes.
LocallyNonlinear assemble(const model::Model& model);

}  // namespace rubato::system
