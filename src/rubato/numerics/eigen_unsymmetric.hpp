#pragma once

#include <rubato/numerics/eigen_damped.hpp>

namespace rubato::numerics {

/// The `count` lowest modes of M q'' + C q' + K q = 0 with symmetric M (positive definite) and any C and K, as loads
/// make them that have no potential (Ziegler 1952): by rising |s|, of a pair the one with positive imaginary part.
/// Modes that grow are among them, with a negative damping ratio. Dense: for up to some hundred coordinates.
/// @param stiffness, damping, mass  [n x n]
DampedModes lowest_unsymmetric_modes(const Matrix& stiffness, const Matrix& damping, const Matrix& mass, Index count);

}  // namespace rubato::numerics
