#pragma once

#include <rubato/core/types.hpp>
#include <rubato/numerics/elimination_tree.hpp>

#include <vector>

namespace rubato::numerics {

/// L D L^T column by column, for matrices with little fill-in: chains, frames. Up-looking (Davis 2005).
class SimplicialFactor {
 public:
  void analyse(const EliminationTree& tree);

  /// @returns false at a pivot that cannot be
  bool factorise(const SparseMatrix& matrix, const EliminationOrder& order, Pivots pivots);

  /// D^-1 by places [n].
  const std::vector<double>& inverse_diagonal() const { return inverse_diagonal_; }

  Index bytes() const;

  /// y <- L^-1 y for the places from `from` on; complete(j) right before each.
  template <class Complete>
  void forward(double* y, Index from, Complete&& complete) const;
  /// y <- L^-T D^-1 y down to place `from`, with take(j, y[j]) for each.
  template <class Take>
  void backward(double* y, Index from, Take&& take) const;

 private:
  Index n_ = 0;
  std::vector<int> parent_, start_, row_;  // L without its unit diagonal, by columns
  std::vector<double> value_, inverse_diagonal_;
};

template <class Complete>
void SimplicialFactor::forward(double* y, Index from, Complete&& complete) const {
  const int* const start = start_.data();
  const int* const row = row_.data();
  const double* const value = value_.data();
  for (Index j = from; j < n_; ++j) {
    complete(j);
    const double now = y[j];
    for (int p = start[j]; p < start[j + 1]; ++p) y[row[p]] -= value[p] * now;
  }
}

template <class Take>
void SimplicialFactor::backward(double* y, Index from, Take&& take) const {
  const int* const start = start_.data();
  const int* const row = row_.data();
  const double* const value = value_.data();
  const double* const inverse_diagonal = inverse_diagonal_.data();
  for (Index j = n_ - 1; j >= from; --j) {
    double now = y[j] * inverse_diagonal[j];
    // The nearest row, known last, comes last: the others need not wait for it.
    for (int p = start[j + 1] - 1; p >= start[j]; --p) now -= value[p] * y[row[p]];
    y[j] = now;
    take(j, now);
  }
}

}  // namespace rubato::numerics
