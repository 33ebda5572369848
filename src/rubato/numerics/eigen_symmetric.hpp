#pragma once

#include <rubato/core/types.hpp>

#include <optional>

namespace rubato::numerics {

/// The lowest solutions of K phi = omega^2 M phi, and how far they can be trusted.
struct SymmetricModes {
  Vector eigenvalues;     ///< omega^2, rising [k] [rad2/s2]; within `round_off` it is 0
  Vector round_off;       ///< by how much the rounding of the entries of K may have changed omega^2 [k] [rad2/s2]
  Matrix shapes;          ///< phi^T M phi = 1, phi_i^T M phi_j = 0 [n x k]; the largest entry of each is positive
  double residual = 0.0;  ///< largest of K phi - omega^2 M phi, ScaledResidual::backward [-]
  double defect = 0.0;    ///< largest ScaledResidual::of_energy, which has_converged bounds [-]
  /// Eigenvalues that lie below the largest of these and were not found, counted by the inertia of K - s M; -1: the
  /// count failed. Always 0 from the dense solver, which finds all.
  Index missing = 0;
  /// Else the numbers are the best found, or, where the residual is infinite, none: M is singular, or numbers are too
  /// far apart.
  bool has_converged = true;
};

/// The `count` lowest modes, 1 <= count <= n, of symmetric K and positive definite M [n x n].
///
/// Dense (Householder and QR on the Cholesky-reduced problem) for up to 400 coordinates, or where more than a third of
/// the modes is asked for; where residuals show that low modes were lost in the round-off of high ones (a light mass on
/// a stiff spring), again by graded_shapes, up to 1,000 coordinates. Else shift-invert Lanczos with implicit restarts
/// (Spectra; Sorensen 1992) around zero or, where K is singular or indefinite, around a shift below the spectrum of the
/// size of the eigenvalues wanted. A single start vector may see a repeated mode once: the eigenvalues below the
/// highest are counted by the inertia of K - s M (Sylvester's law; Parlett 1998, 3.3), and what is missing is sought
/// beside what was found.
///
/// omega^2 is the Rayleigh quotient, with the products of K as if with twice the digits. What K itself lost when its
/// entries were rounded is beyond recovery: round_off = 2 eps |phi|^T terms |phi|.
/// @param terms  what the entries of K are sums of, in moduli, where that is more than |K| [n x n]; nullptr: |K|
SymmetricModes lowest_modes(const SparseMatrix& stiffness, const SparseMatrix& mass, Index count,
                            const SparseMatrix* terms = nullptr);

/// Whether lowest_modes takes all modes from the dense solver.
bool is_dense_eigenproblem(Index size, Index count);

/// How many eigenvalues of K phi = omega^2 M phi lie below a value, by the inertia of K - value M; nothing where
/// round-off could have turned the sign of a pivot (a value on an eigenvalue).
std::optional<Index> modes_below(const SparseMatrix& stiffness, const SparseMatrix& mass, double value);

/// All modes, by the dense solvers.
SymmetricModes all_modes(const SparseMatrix& stiffness, const SparseMatrix& mass, const SparseMatrix* terms = nullptr);

}  // namespace rubato::numerics
