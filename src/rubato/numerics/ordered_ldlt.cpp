#include <rubato/numerics/ordered_ldlt.hpp>

#include <camd.h>

#include <cmath>
#include <new>

namespace rubato::numerics {

void OrderedLdlt::analyse(const SparseMatrix& matrix, std::span<const Index> last) {
  n_ = matrix.rows();
  k_ = static_cast<Index>(last.size());
  order_.resize(static_cast<std::size_t>(n_));
  position_.resize(static_cast<std::size_t>(n_));
  std::vector<int> constraint(static_cast<std::size_t>(n_), 0);
  for (const Index row : last) constraint[static_cast<std::size_t>(row)] = 1;
  double control[CAMD_CONTROL], info[CAMD_INFO];
  camd_defaults(control);
  const int status = camd_order(static_cast<int>(n_), matrix.outerIndexPtr(), matrix.innerIndexPtr(), order_.data(),
                                control, info, k_ > 0 ? constraint.data() : nullptr);
  if (status != CAMD_OK && status != CAMD_OK_BUT_JUMBLED) throw std::bad_alloc();
  for (std::size_t place = 0; place < order_.size(); ++place)
    position_[static_cast<std::size_t>(order_[place])] = static_cast<int>(place);
  scratch_.resize(n_);
}

bool OrderedLdlt::factorise(const SparseMatrix& matrix) {
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation(n_);
  for (Index i = 0; i < n_; ++i) permutation.indices()[i] = position_[static_cast<std::size_t>(i)];
  SparseMatrix permuted(n_, n_);
  permuted.selfadjointView<Eigen::Lower>() = matrix.selfadjointView<Eigen::Lower>().twistedBy(permutation);
  ldlt_.compute(permuted);
  if (ldlt_.info() != Eigen::Success) return false;
  const auto& lower = ldlt_.matrixL().nestedExpression();
  const Vector diagonal = ldlt_.vectorD();
  if (!(diagonal.minCoeff() > 0.0) || !std::isfinite(diagonal.sum())) return false;
  inverse_diagonal_.resize(static_cast<std::size_t>(n_));
  for (Index i = 0; i < n_; ++i) inverse_diagonal_[static_cast<std::size_t>(i)] = 1.0 / diagonal[i];
  start_.assign(1, 0);
  row_.clear();
  value_.clear();
  for (Index column = 0; column < n_; ++column) {
    for (SparseMatrix::InnerIterator entry(lower, column); entry; ++entry) {
      if (entry.row() <= column) continue;
      row_.push_back(static_cast<int>(entry.row()));
      value_.push_back(entry.value());
    }
    start_.push_back(static_cast<int>(row_.size()));
  }
  return true;
}

void OrderedLdlt::forward(Vector& x) const {
  forward(x, [](Index) {});
}

void OrderedLdlt::backward(Vector& x) const {
  backward(x, [](Index, double) {});
}

void OrderedLdlt::last_solution(const Vector& x, Vector& out) const {
  const Index first = n_ - k_;
  for (Index j = n_ - 1; j >= first; --j) {
    double now = x[j] * inverse_diagonal_[static_cast<std::size_t>(j)];
    for (int p = start_[static_cast<std::size_t>(j)]; p < start_[static_cast<std::size_t>(j) + 1]; ++p)
      now -= value_[static_cast<std::size_t>(p)] * out[row_[static_cast<std::size_t>(p)] - first];
    out[j - first] = now;
  }
}

void OrderedLdlt::subtract_from_last(Vector& r, Vector& x) const {
  const Index first = n_ - k_;
  for (Index j = first; j < n_; ++j) {
    const double now = r[j - first];
    for (int p = start_[static_cast<std::size_t>(j)]; p < start_[static_cast<std::size_t>(j) + 1]; ++p)
      r[row_[static_cast<std::size_t>(p)] - first] -= value_[static_cast<std::size_t>(p)] * now;
    x[j] -= now;
  }
}

Matrix OrderedLdlt::last_inverse() const {
  const Index first = n_ - k_;
  Matrix inverse(k_, k_);
  Vector x = Vector::Zero(n_), column(k_);
  for (Index c = 0; c < k_; ++c) {
    x.tail(k_).setZero();
    x[first + c] = 1.0;
    for (Index j = first + c; j < n_; ++j)
      for (int p = start_[static_cast<std::size_t>(j)]; p < start_[static_cast<std::size_t>(j) + 1]; ++p)
        x[row_[static_cast<std::size_t>(p)]] -= value_[static_cast<std::size_t>(p)] * x[j];
    last_solution(x, column);
    inverse.col(c) = column;
  }
  return inverse;
}

void OrderedLdlt::solve(const Vector& b, Vector& x) const {
  for (Index i = 0; i < n_; ++i) scratch_[position_[static_cast<std::size_t>(i)]] = b[i];
  forward(scratch_);
  backward(scratch_);
  for (Index i = 0; i < n_; ++i) x[i] = scratch_[position_[static_cast<std::size_t>(i)]];
}

}  // namespace rubato::numerics
