#pragma once

#include <rubato/integrate/equilibrium/static_equilibrium.hpp>

namespace rubato::integrate {

/// find_equilibrium() of a structure with other laws than sliders and stops: where loads and held displacements lead
/// that grow together from zero. Every contact is a function of its displacement, reached from zero without a turn;
/// Newton's method with their tangents, for all of the loads at once where the tangent stays positive definite on the
/// way, and in shares that are as small as it takes where it does not.
/// Blocks that just touch make the problem homogeneous in the loads, and none of their shares is easier. Where Newton's
/// method finds no equilibrium under the smallest share, the gaps are changed, and go back to what they are while the
/// equilibrium is followed; what is accepted is balanced with the gaps as given. Friction may allow several: one of
/// them is found, the same for any size of the loads.
StaticEquilibrium grow_equilibrium(const system::LocallyNonlinear& system, std::span<const model::Held> held);

}  // namespace rubato::integrate
