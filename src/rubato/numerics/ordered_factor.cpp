#include <rubato/core/stopping.hpp>
#include <rubato/numerics/ordered_factor.hpp>

#include <limits>
#include <utility>

namespace rubato::numerics {
namespace {

/// Operations for each entry of the factor from which panels pay (CHOLMOD's measure and number; Chen, Davis, Hager and
/// Rajamanickam 2008).
constexpr double worth_of_panels = 40.0;

constexpr auto nothing = [](auto...) {};

}  // namespace

void OrderedFactor::analyse(const SparseMatrix& matrix, std::span<const Index> last) {
  n_ = matrix.rows();
  k_ = static_cast<Index>(last.size());
  order_ = minimum_degree(matrix, std::vector<int>(last.begin(), last.end()));
  EliminationTree tree = elimination_tree(matrix, order_);
  has_panels_ = tree.operations() > worth_of_panels * tree.entries() ||
                tree.entries() > static_cast<double>(std::numeric_limits<int>::max());
  columns_ = {};
  panels_ = {};
  if (has_panels_) {
    std::vector<int> rows;
    rows.reserve(order_.row.size());
    for (const int j : postorder(tree, n_ - k_)) rows.push_back(order_.row[static_cast<std::size_t>(j)]);
    order_ = EliminationOrder(std::move(rows));
    tree = elimination_tree(matrix, order_);
    panels_.analyse(matrix, tree, order_, n_ - k_);
  } else {
    columns_.analyse(tree);
  }
  scratch_.resize(n_);
}

bool OrderedFactor::factorise(const SparseMatrix& matrix, Pivots pivots) {
  stop_if_asked();
  return has_panels_ ? panels_.factorise(matrix, order_, pivots) : columns_.factorise(matrix, order_, pivots);
}

Vector OrderedFactor::pivots() const {
  const std::vector<double>& inverse = has_panels_ ? panels_.inverse_diagonal() : columns_.inverse_diagonal();
  Vector pivots(n_);
  for (Index i = 0; i < n_; ++i)
    pivots[order_.row[static_cast<std::size_t>(i)]] = 1.0 / inverse[static_cast<std::size_t>(i)];
  return pivots;
}

void OrderedFactor::last_solution(const Vector& x, Vector& out) const {
  scratch_.tail(k_) = x.tail(k_);
  backward_to(n_ - k_, scratch_, nothing);
  out = scratch_.tail(k_);
}

void OrderedFactor::subtract_from_last(Vector& r, Vector& x) const {
  scratch_.tail(k_) = r;
  forward_from(n_ - k_, scratch_, nothing);
  r = scratch_.tail(k_);
  x.tail(k_) -= r;
}

Matrix OrderedFactor::last_inverse() const {
  Matrix inverse(k_, k_);
  for (Index c = 0; c < k_; ++c) {
    scratch_.tail(k_).setZero();
    scratch_[n_ - k_ + c] = 1.0;
    forward_from(n_ - k_, scratch_, nothing);
    backward_to(n_ - k_, scratch_, nothing);
    inverse.col(c) = scratch_.tail(k_);
  }
  return inverse;
}

void OrderedFactor::solve(const Vector& b, Vector& x) const {
  stop_if_asked();
  for (Index i = 0; i < n_; ++i) scratch_[order_.place[static_cast<std::size_t>(i)]] = b[i];
  forward(scratch_, nothing);
  backward(scratch_, nothing);
  x.resize(n_);
  for (Index i = 0; i < n_; ++i) x[i] = scratch_[order_.place[static_cast<std::size_t>(i)]];
}

}  // namespace rubato::numerics
