#include <rubato/system/saddle_matrix.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace rubato::system {
namespace {

constexpr double share = 1e-10;

}  // namespace

void SaddleMatrix::analyse(const SparseMatrix& mass, Index rows, std::vector<Entry> entries, bool is_symmetric) {
  size_ = mass.rows();
  const Vector diagonal = mass.diagonal();
  inverse_mass_.clear();
  for (const double value : diagonal) inverse_mass_.push_back(1.0 / value);
  row_seen_.assign(static_cast<std::size_t>(rows), 0.0);
  std::vector<Entry> all;
  for (Index column = 0; column < size_; ++column)
    for (SparseMatrix::InnerIterator entry(mass, column); entry; ++entry)
      if (entry.row() >= column) all.emplace_back(entry.row(), column);
  all.insert(all.end(), entries.begin(), entries.end());
  factor_.analyse(size_ + rows, size_, all, is_symmetric);

  mass_slot_.clear();
  mass_value_.clear();
  row_slot_.clear();
  for (Index column = 0; column < size_; ++column)
    for (SparseMatrix::InnerIterator entry(mass, column); entry; ++entry) {
      mass_slot_.push_back(factor_.slot(entry.row(), column));
      mass_value_.push_back(entry.value());
    }
  for (Index row = size_; row < size_ + rows; ++row) row_slot_.push_back(factor_.slot(row, row));
}

void SaddleMatrix::begin(double mass) {
  factor_.set_zero();
  ++count_;
  double* const values = factor_.values();
  for (std::size_t i = 0; i < mass_slot_.size(); ++i) values[mass_slot_[i]] += mass * mass_value_[i];
  std::fill(row_seen_.begin(), row_seen_.end(), 0.0);
}

void SaddleMatrix::open_rows(Index first, Index count) {
  const auto from = row_seen_.begin() + first;
  std::fill(from, from + count, 0.0);
}

void SaddleMatrix::end(double weight) {
  const double part = share_of_rows_ = share / weight;
  double* const values = factor_.values();
  for (std::size_t r = 0; r < row_seen_.size(); ++r)
    values[row_slot_[r]] -= row_seen_[r] > 0.0 ? part * row_seen_[r] : 1.0;
}

std::vector<Index> SaddleMatrix::redundant_rows(double left) const {
  std::vector<Index> rows;
  for (std::size_t r = 0; r < row_seen_.size(); ++r) {
    const auto row = static_cast<Index>(r);
    if (row_seen_[r] > 0.0 && std::abs(factor_.pivot(size_ + row)) < left * row_seen_[r]) rows.push_back(row);
  }
  return rows;
}

Index SaddleMatrix::worst_leak(const Vector& correction, double& apart) const {
  Index worst = -1;
  apart = 0.0;
  for (std::size_t r = 0; r < row_seen_.size(); ++r) {
    const double leak = share_of_rows_ * row_seen_[r] * std::abs(correction[static_cast<Index>(r)]);
    if (leak <= apart) continue;
    apart = leak;
    worst = static_cast<Index>(r);
  }
  return worst;
}

double SaddleMatrix::gap_norm(const Vector& constraint) const {
  double squared = 0.0;
  for (std::size_t r = 0; r < row_seen_.size(); ++r) {
    const double gap = constraint[static_cast<Index>(r)];
    if (row_seen_[r] > 0.0) squared += gap * gap / row_seen_[r];
  }
  return std::sqrt(squared);
}

int SaddleMatrix::nearly_redundant_rows() const {
  constexpr double left = 10.0 * share;
  int count = 0;
  for (std::size_t r = 0; r < row_seen_.size(); ++r)
    if (std::abs(factor_.pivot(size_ + static_cast<Index>(r))) < left * row_seen_[r]) ++count;
  return count;
}

}  // namespace rubato::system
