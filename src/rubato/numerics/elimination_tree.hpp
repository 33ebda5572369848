#pragma once

#include <rubato/core/types.hpp>

#include <cmath>
#include <span>
#include <vector>

namespace rubato::numerics {

/// Which pivots a factorisation without interchanges goes on with.
enum class Pivots {
  positive,  ///< of a positive definite matrix
  nonzero,   ///< of any sign: their signs are those of the eigenvalues (Sylvester)
};

inline bool is_pivot(double value, Pivots pivots) {
  return std::isfinite(value) && (pivots == Pivots::positive ? value > 0.0 : value != 0.0);
}

/// The order in which the rows of a symmetric matrix are eliminated.
struct EliminationOrder {
  std::vector<int> row;    ///< that is eliminated in each place [n]
  std::vector<int> place;  ///< of each row [n]

  EliminationOrder() = default;
  explicit EliminationOrder(std::vector<int> rows);
};

/// Constrained approximate minimum degree (CAMD; Amestoy, Davis and Duff 2004).
/// @param pattern  [n x n], both triangles
/// @param last     rows to eliminate last, without doubles
EliminationOrder minimum_degree(const SparseMatrix& pattern, std::span<const int> last);

/// What the elimination of a sparse symmetric matrix will fill, known from its pattern alone (Liu 1990).
struct EliminationTree {
  std::vector<int> parent;  ///< row of the first entry below the diagonal of each column of L; -1 at a root
  std::vector<int> count;   ///< entries of each column of L, its diagonal among them

  double entries() const;     ///< of L
  double operations() const;  ///< multiplications and additions of a factorisation, two for each pair
};

/// The tree of a matrix under an order of elimination.
/// @param matrix  [n x n], both triangles
EliminationTree elimination_tree(const SparseMatrix& matrix, const EliminationOrder& order);

/// Places of the tree so that each subtree stands together, its root last: the same factor, its like columns side by
/// side. Places from `fixed` on stay where they are.
std::vector<int> postorder(const EliminationTree& tree, Index fixed);

}  // namespace rubato::numerics
