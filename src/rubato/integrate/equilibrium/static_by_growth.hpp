#pragma once

#include <rubato/integrate/equilibrium/static_equilibrium.hpp>

namespace rubato::integrate {

/// find_equilibrium() of a structure with other laws than sliders and stops: where loads and held displacements lead
/// that grow together from zero. Every contact is a function of its displacement, reached from zero without a turn;
/// Newton's method with their tangents, for all of the loads at once where the tangent stays positive definite on the
/// way, and in shares that are as small as it takes where it does not.
StaticEquilibrium grow_equilibrium(const system::LocallyNonlinear& system, std::span<const model::Held> held);

}  // namespace rubato::integrate
