#pragma once

#include <rubato/core/types.hpp>
#include <rubato/numerics/simplicial_factor.hpp>
#include <rubato/numerics/supernodal_factor.hpp>

#include <span>
#include <vector>

namespace rubato::numerics {

/// L D L^T of a sparse symmetric matrix, definite enough for no interchanges, whose chosen rows are eliminated last, so
/// that the solution at those rows is known from the forward substitution alone, and may still be changed by forces
/// there before the backward one: S x = b - P z with z a function of x at the chosen rows costs one solve.
///
/// Ordering: constrained approximate minimum degree (CAMD; Amestoy, Davis and Duff 2004). The pattern decides
/// whether columns or panels of columns are eliminated.
class OrderedFactor {
 public:
  /// Orders and analyses a pattern.
  /// @param matrix  [n x n], both triangles
  /// @param last    rows to eliminate last, without doubles [k]
  void analyse(const SparseMatrix& matrix, std::span<const Index> last = {});

  /// Factorises a matrix of the analysed pattern, or of part of it. Returns false at a pivot that cannot be.
  bool factorise(const SparseMatrix& matrix, Pivots pivots = Pivots::positive);

  Index size() const { return n_; }
  Index last_count() const { return k_; }
  bool has_panels() const { return has_panels_; }
  /// Of the factor alone.
  Index bytes() const { return has_panels_ ? panels_.bytes() : columns_.bytes(); }

  /// D, by rows of the matrix [n].
  Vector pivots() const;

  /// Position of a row in the permuted order: the chosen rows are the last k.
  Index permuted(Index row) const { return order_.place[static_cast<std::size_t>(row)]; }
  Index original(Index place) const { return order_.row[static_cast<std::size_t>(place)]; }

  /// x <- L^-1 x of a right-hand side, in the permuted order, that is completed on the way: complete(j) is called, from
  /// the first row to the last, before row j is eliminated and may add to x[j] and to later rows. A substitution waits
  /// for its own last result; work that does not depend on it fills the gaps.
  template <class Complete>
  void forward(Vector& x, Complete&& complete) const;
  /// x <- L^-T D^-1 x, in the permuted order, with take(j, x[j]) for each row soon after it is known, from the last to
  /// the first.
  template <class Take>
  void backward(Vector& x, Take&& take) const;
  /// The solution at the last k rows from a forward-substituted right-hand side: out = (L22^-T D2^-1) x2 [k].
  void last_solution(const Vector& x, Vector& out) const;
  /// x2 <- x2 - L22^-1 r for a force r [k] on the last rows (overwritten): what the forward substitution of b - P r
  /// would have given.
  void subtract_from_last(Vector& r, Vector& x) const;
  /// The inverse of the Schur complement of the last rows, (S^-1)22 [k x k].
  Matrix last_inverse() const;

  /// S x = b in the original order, for callers that need no more; x may be b.
  void solve(const Vector& b, Vector& x) const;

 private:
  template <class Complete>
  void forward_from(Index from, Vector& x, Complete&& complete) const;
  template <class Take>
  void backward_to(Index from, Vector& x, Take&& take) const;

  Index n_ = 0, k_ = 0;
  EliminationOrder order_;
  bool has_panels_ = false;
  SimplicialFactor columns_;
  SupernodalFactor panels_;
  mutable Vector scratch_;
};

template <class Complete>
void OrderedFactor::forward_from(Index from, Vector& x, Complete&& complete) const {
  if (has_panels_)
    panels_.forward(x.data(), from, complete);
  else
    columns_.forward(x.data(), from, complete);
}

template <class Take>
void OrderedFactor::backward_to(Index from, Vector& x, Take&& take) const {
  if (has_panels_)
    panels_.backward(x.data(), from, take);
  else
    columns_.backward(x.data(), from, take);
}

template <class Complete>
void OrderedFactor::forward(Vector& x, Complete&& complete) const {
  forward_from(0, x, complete);
}

template <class Take>
void OrderedFactor::backward(Vector& x, Take&& take) const {
  backward_to(0, x, take);
}

}  // namespace rubato::numerics
