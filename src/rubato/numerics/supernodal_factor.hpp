#pragma once

#include <rubato/core/types.hpp>
#include <rubato/numerics/elimination_tree.hpp>

#include <vector>

namespace rubato::numerics {

/// L D L^T by blocks, for matrices with much fill-in: lattices, structures in space. Columns with the same rows below
/// them stand together in dense panels, supernodes, so that the work is products of dense matrices (Ng and Peyton
/// 1993); left-looking. Few explicit zeros are taken in where that joins small panels to larger ones (Ashcraft and
/// Grimes 1989).
class SupernodalFactor {
 public:
  /// Finds the panels of a tree in postorder.
  /// @param fixed  place at which a panel begins
  void analyse(const SparseMatrix& matrix, const EliminationTree& tree, const EliminationOrder& order, Index fixed);

  /// @returns false at a pivot that cannot be
  bool factorise(const SparseMatrix& matrix, const EliminationOrder& order, Pivots pivots);

  /// D^-1 by places [n].
  const std::vector<double>& inverse_diagonal() const { return inverse_diagonal_; }

  Index bytes() const;

  /// y <- L^-1 y for the places from `from` on, where a panel begins; complete(j) for each place of a panel right
  /// before it.
  template <class Complete>
  void forward(double* y, Index from, Complete&& complete) const;
  /// y <- L^-T D^-1 y down to place `from`, with take(j, y[j]) for each as soon as its panel is solved.
  template <class Take>
  void backward(double* y, Index from, Take&& take) const;

 private:
  using Panel = Eigen::Map<Matrix>;

  std::size_t count() const { return first_.size() - 1; }
  int columns(std::size_t s) const { return first_[s + 1] - first_[s]; }
  int rows(std::size_t s) const { return static_cast<int>(row_start_[s + 1] - row_start_[s]); }
  const int* rows_of(std::size_t s) const { return row_.data() + row_start_[s]; }
  Panel panel(std::size_t s) { return {value_.data() + value_start_[s], rows(s), columns(s)}; }

  void gather(std::size_t s, const SparseMatrix& matrix, const EliminationOrder& order, const std::vector<int>& local);
  void eliminate(std::size_t s, double* y) const;
  void substitute(std::size_t s, double* y) const;

  Index n_ = 0;
  std::vector<int> first_, owner_;              // place of the first column of each panel; panel of each place
  std::vector<Index> row_start_, value_start_;  // of each panel
  std::vector<int> row_;                        // places of the rows of the panels, their own columns first
  std::vector<double> value_, inverse_diagonal_;
  mutable Vector scratch_;
};

template <class Complete>
void SupernodalFactor::forward(double* y, Index from, Complete&& complete) const {
  if (from >= n_) return;
  for (auto s = static_cast<std::size_t>(owner_[static_cast<std::size_t>(from)]); s < count(); ++s) {
    for (int j = first_[s]; j < first_[s + 1]; ++j) complete(j);
    eliminate(s, y);
  }
}

template <class Take>
void SupernodalFactor::backward(double* y, Index from, Take&& take) const {
  if (from >= n_) return;
  const auto last = static_cast<std::size_t>(owner_[static_cast<std::size_t>(from)]);
  for (std::size_t s = count(); s-- > last;) {
    substitute(s, y);
    for (int j = first_[s + 1] - 1; j >= first_[s]; --j) take(j, y[j]);
  }
}

}  // namespace rubato::numerics
