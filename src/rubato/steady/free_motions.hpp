#pragma once

#include <rubato/system/locally_nonlinear.hpp>

namespace rubato::steady {

/// Those of some motions that a linear map sends to zero, in an orthonormal basis of their coefficients [n x any].
/// @param map      [any x r]
/// @param motions  [n x r]
Matrix kernel_of(const Matrix& map, const Matrix& motions);

/// The motions of a structure that floats: no spring, no dashpot, no slider and no stop resists them,
/// phi^T M phi = 1 [n x any].
/// @param rigid  motions that no spring resists, phi^T M phi = 1 [n x r]
Matrix free_motions(const system::LocallyNonlinear& system, const Matrix& rigid);

/// The rigid motions that no slider and no stop sees, whether dashpots resist them or not: the place along them is of
/// no consequence, and a static load may carry the structure off along them.
Matrix unseen_motions(const system::LocallyNonlinear& system, const Matrix& rigid);

/// The same for a structure whose rigid motions are not known yet. None for more than 300 coordinates.
Matrix unseen_motions(const system::LocallyNonlinear& system);

/// free_motions(), for a structure whose rigid motions are not known yet. None for more than 300 coordinates.
Matrix free_motions(const system::LocallyNonlinear& system);

}  // namespace rubato::steady
