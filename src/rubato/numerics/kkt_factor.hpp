#pragma once

#include <rubato/core/types.hpp>

#include <span>
#include <utility>
#include <vector>

namespace rubato::numerics {

/// Triangular factors of a matrix of symmetric pattern in an order that is fixed once, without pivoting:
///
///   [S  G^T]
///   [G  -E ]    S [n x n], G [c x n], E [c x c] diagonal
///
/// Each row of G is eliminated after all the unknowns that it joins, so that its pivot is -(E + G S^-1 G^T) of what is
/// left, away from zero where the row says something of its own. With S positive definite and E > 0 the matrix is
/// quasi-definite, and its factors exist in every order (Vanderbei 1995). Values of S may be unsymmetric. The pattern
/// is that of the factors: callers write their entries straight into it.
///
/// Otherwise ordered by approximate minimum degree (Amestoy, Davis and Duff 2004): cost proportional to the length of
/// a chain.
class KktFactor {
 public:
  using Entry = std::pair<Index, Index>;

  /// Orders and analyses a pattern; values are zero then.
  /// @param size          n + c
  /// @param first_row     n: the rows from here on are those of G
  /// @param entries       places of either triangle that may be occupied; diagonals are implied
  /// @param is_symmetric  values are symmetric: only one triangle is kept
  void analyse(Index size, Index first_row, std::span<const Entry> entries, bool is_symmetric);

  Index size() const { return size_; }
  bool is_symmetric() const { return is_symmetric_; }
  /// Where the entry (i, j) lies among the values; a place that takes anything for the half that a symmetric matrix
  /// does not keep. The entry must belong to the pattern.
  int slot(Index i, Index j) const;
  /// The place that takes anything.
  int spare_slot() const { return static_cast<int>(value_.size()) - 1; }

  double* values() { return value_.data(); }
  std::size_t value_count() const { return value_.size(); }
  void set_zero();

  /// Turns the values into factors. Returns false if a pivot is zero or not finite.
  bool factorise();
  /// How many pivots of the last factors are negative: of a symmetric matrix, its negative eigenvalues (Sylvester).
  Index negative_pivots() const;
  /// x <- A^-1 x
  void solve(double* x) const { solve(x, x + first_row_); }
  /// The same in two parts.
  /// @param rest  the unknowns from first_row on
  void solve(double* x, double* rest) const;

  /// What an unknown was divided by; after factorise().
  double pivot(Index i) const { return 1.0 / value_[static_cast<std::size_t>(position_[static_cast<std::size_t>(i)])]; }

  Index factor_entries() const { return static_cast<Index>(row_.size()); }

 private:
  void order(Index first_row, std::span<const Entry> entries);
  void find_factors(std::span<const Entry> entries);
  bool factorise_symmetric();
  bool factorise_both();
  /// @param stride  1: L alone; 2: L and U in turn
  template <int stride>
  void substitute(double* y) const;

  Index size_ = 0, first_row_ = 0;
  bool is_symmetric_ = true;
  std::vector<int> position_;     // of an unknown in the order [size]
  std::vector<int> start_, row_;  // pattern of L below its diagonal, by columns, in the order
  std::vector<int> target_;       // where the product of two entries of a column goes, pair by pair
  /// Diagonal [size]; L [entries], or unless symmetric L and U by rows in turn [2 entries]; a spare place.
  std::vector<double> value_;
  mutable std::vector<double> x_;
};

}  // namespace rubato::numerics
