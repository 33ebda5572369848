#pragma once

#include <rubato/core/types.hpp>
#include <rubato/numerics/elimination_tree.hpp>

#include <Eigen/SparseCore>

#include <complex>
#include <span>
#include <vector>

namespace rubato::numerics {

using SparseComplexMatrix = Eigen::SparseMatrix<std::complex<double>>;  ///< by columns, int indices

/// L D L^T of a sparse complex symmetric (not Hermitian) matrix, without pivoting: the dynamic stiffness
/// K - omega^2 M + i omega C of a structure, whose pattern is analysed once for all frequencies.
///
/// Without pivoting a substructure in resonance may leave a pivot that is round-off; it is replaced by `tiny` of its
/// scale, so that the factor always exists, and the caller checks the residual of what it solves.
///
/// Row by row, after Davis, "Algorithm 849: a concise sparse Cholesky factorization package", 2005; ordered by
/// constrained approximate minimum degree (CAMD).
class ComplexLdlt {
 public:
  /// Orders and analyses a symmetric pattern [n x n].
  /// @param last  rows to be eliminated last, each once: columns with entries in these alone are cheap to condense
  void analyse(const SparseMatrix& pattern, std::span<const int> last = {});

  /// Factorises a matrix of the analysed pattern (both triangles).
  /// @param scale  size of the terms that each diagonal entry is the sum of [n]
  /// @returns how many pivots were replaced
  Index factorise(const SparseComplexMatrix& matrix, const Vector& scale);

  Index size() const { return n_; }
  Index factor_entries() const { return static_cast<Index>(row_.size()); }

  /// x <- S^-1 x for each column [n x k].
  void solve(Eigen::Ref<Eigen::MatrixXcd> x) const;

  /// out = C^T S^-1 C [k x k] for sparse columns C [n x k]: Y^T D^-1 Y with Y = L^-1 C, over the rows that each column
  /// reaches in the elimination tree. Nothing is substituted backwards.
  void condense(const SparseMatrix& columns, Eigen::MatrixXcd& out);

 private:
  /// The rows of L^-1 c that are not zero, rising.
  void reach(const SparseMatrix& columns, Index column, std::vector<int>& rows);

  Index n_ = 0;
  EliminationOrder order_;
  std::vector<int> parent_;
  std::vector<int> start_, row_, filled_;  // L without its unit diagonal, by columns
  std::vector<std::complex<double>> value_, inverse_pivot_, work_;
  std::vector<int> mark_, path_;
};

}  // namespace rubato::numerics
