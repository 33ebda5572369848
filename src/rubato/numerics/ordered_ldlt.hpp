#pragma once

#include <rubato/core/types.hpp>

#include <Eigen/SparseCholesky>

#include <span>
#include <vector>

namespace rubato::numerics {

/// L D L^T of a sparse symmetric positive definite matrix whose chosen rows are eliminated last, so that the solution
/// at those rows is known from the forward substitution alone, and may still be changed by forces there before the
/// backward one: S x = b - P z with z a function of x at the chosen rows costs one solve.
///
/// Ordering: constrained approximate minimum degree (CAMD; Amestoy, Davis and Duff 2004).
class OrderedLdlt {
 public:
  /// Orders and analyses a pattern.
  /// @param matrix  [n x n], both triangles
  /// @param last    rows to eliminate last, without doubles [k]
  void analyse(const SparseMatrix& matrix, std::span<const Index> last);

  /// Factorises a matrix of the analysed pattern. Returns false if it is not positive definite.
  bool factorise(const SparseMatrix& matrix);

  Index size() const { return n_; }
  Index last_count() const { return k_; }
  Index factor_entries() const { return static_cast<Index>(value_.size()); }

  /// Position of a row in the permuted order: the chosen rows are the last k.
  Index permuted(Index row) const { return position_[static_cast<std::size_t>(row)]; }
  Index original(Index place) const { return order_[static_cast<std::size_t>(place)]; }

  /// x <- L^-1 x, in the permuted order.
  void forward(Vector& x) const;
  /// The same of a right-hand side that is completed on the way: complete(j) is called right before row j is
  /// eliminated and may add to x[j] and to later rows. A substitution waits for its own last result; work that does not
  /// depend on it fills the gaps.
  template <class Complete>
  void forward(Vector& x, Complete&& complete) const;
  /// x <- L^-T D^-1 x, in the permuted order.
  void backward(Vector& x) const;
  /// The same, with take(j, x[j]) for each row as soon as it is known, from the last to the first.
  template <class Take>
  void backward(Vector& x, Take&& take) const;
  /// The solution at the last k rows from a forward-substituted right-hand side: out = (L22^-T D2^-1) x2 [k].
  void last_solution(const Vector& x, Vector& out) const;
  /// x2 <- x2 - L22^-1 r for a force r [k] on the last rows (overwritten): what the forward substitution of b - P r
  /// would have given.
  void subtract_from_last(Vector& r, Vector& x) const;
  /// The inverse of the Schur complement of the last rows, (S^-1)22 [k x k].
  Matrix last_inverse() const;

  /// S x = b in the original order, for callers that need no more.
  void solve(const Vector& b, Vector& x) const;

 private:
  Index n_ = 0, k_ = 0;
  std::vector<int> order_, position_;
  Eigen::SimplicialLDLT<SparseMatrix, Eigen::Lower, Eigen::NaturalOrdering<int>> ldlt_;
  std::vector<int> start_, row_;  // L without its unit diagonal, by columns
  std::vector<double> value_, inverse_diagonal_;
  mutable Vector scratch_;
};

template <class Complete>
void OrderedLdlt::forward(Vector& x, Complete&& complete) const {
  double* const y = x.data();
  const int* const start = start_.data();
  const int* const row = row_.data();
  const double* const value = value_.data();
  for (Index j = 0; j < n_; ++j) {
    complete(j);
    const double now = y[j];
    for (int p = start[j]; p < start[j + 1]; ++p) y[row[p]] -= value[p] * now;
  }
}

template <class Take>
void OrderedLdlt::backward(Vector& x, Take&& take) const {
  double* const y = x.data();
  const int* const start = start_.data();
  const int* const row = row_.data();
  const double* const value = value_.data();
  const double* const inverse_diagonal = inverse_diagonal_.data();
  for (Index j = n_ - 1; j >= 0; --j) {
    double now = y[j] * inverse_diagonal[j];
    // The nearest row, known last, comes last: the others need not wait for it.
    for (int p = start[j + 1] - 1; p >= start[j]; --p) now -= value[p] * y[row[p]];
    y[j] = now;
    take(j, now);
  }
}

}  // namespace rubato::numerics
