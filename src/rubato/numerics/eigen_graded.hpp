#pragma once

#include <rubato/core/types.hpp>

#include <optional>

namespace rubato::numerics {

/// All shapes of K phi = omega^2 M phi, rising, with phi^T M phi = 1 [n x n], where the entries of K and M span many
/// orders of magnitude: each omega^2 is found to as many digits as K and M determine it once their diagonals are scaled
/// to one, the lowest too, which QR iteration loses in the round-off of the highest. Nothing where M is not positive
/// definite.
///
/// M = L L^T, K + s M = B B^T (Cholesky with diagonal pivoting, so that B is well-conditioned but for the lengths of
/// its columns), and one-sided Jacobi rotations of the columns of L^-1 B (Veselic and Hari, Numer. Math. 56 (1989) 627;
/// Drmac, SIAM J. Numer. Anal. 35 (1998) 1964). s = 0 where K is positive definite; else it lies as little below the
/// spectrum as round-off allows. About ten times the work of the QR iteration.
/// @param stiffness, mass  symmetric [n x n]
std::optional<Matrix> graded_shapes(const Matrix& stiffness, const Matrix& mass);

}  // namespace rubato::numerics
