#pragma once

#include <rubato/numerics/ordered_factor.hpp>

namespace rubato::numerics {

/// Whether v^T A v < 0 for some v, beyond the round-off of that sum. Pivots tell how many eigenvalues are negative
/// (Sylvester's law of inertia), and the motion of a negative one is held against the matrix itself, for elimination
/// may turn the sign of a pivot that is almost zero.
/// @param matrix  A, symmetric, both triangles [n x n]
/// @param factor  of A
bool is_indefinite(const SparseMatrix& matrix, const OrderedFactor& factor);

/// The same of a matrix that is not factorised yet; it may be singular.
bool is_indefinite(const SparseMatrix& matrix);

}  // namespace rubato::numerics
