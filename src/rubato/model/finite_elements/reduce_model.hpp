#pragma once

#include <rubato/model/finite_elements/finite_elements.hpp>
#include <rubato/model/finite_elements/reduction.hpp>
#include <rubato/model/model.hpp>

// Private to the model floor.
namespace rubato::model {

/// Replaces the coordinates of a finite element model by its interface and modes of the rest. The interface are the
/// coordinates that sliders, stops, other laws, springs, dampers, loads and displacements of the model name, those
/// that analyses observe, those to keep, and those before the nodes. Modes are called `mode_1`, `mode_2`, ...: a
/// coordinate of 1 m is a motion whose largest entry is 1 m (1 rad).
///
/// Throws InvalidInput where a name to keep is unknown, where the rest is not held by the interface, and where the
/// error cannot be met.
/// @param before  how many coordinates there are besides those of the finite element model
void reduce(Model& model, const FiniteElements& elements, const ReductionDescription& description, Index before);

}  // namespace rubato::model
