#include <rubato/io/finite_elements/matrix_entries.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace rubato::io {
namespace {

using model::RowLabel;

// Largest difference of mirrored entries over the geometric mean of their diagonal entries. Programs write what is
// symmetric to the digits that they print; damping by friction, rotors and follower forces differ by far more.
constexpr double same = 1e-8;

/// An entry of the lower triangle, or of the upper one, mirrored.
struct Folded {
  int row;
  bool was_upper;
  double value;
};

std::uint64_t key_of(const RowLabel& label) {
  return static_cast<std::uint64_t>(label.node) * 8 + static_cast<std::uint64_t>(label.direction);
}

/// The entries by their smaller index, rising within it by the larger one; those of one place as the file has them.
class Columns {
 public:
  template <class Entries>
  Columns(const Entries& entries, int n) : begin_(static_cast<std::size_t>(n) + 1, 0), folded_(entries.size()) {
    for (const auto& entry : entries) ++begin_[static_cast<std::size_t>(std::min(entry.row, entry.column)) + 1];
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    for (const auto& entry : entries) {
      const auto [small, large] = std::minmax(entry.row, entry.column);
      folded_[next[static_cast<std::size_t>(small)]++] = {large, entry.row < entry.column, entry.value};
    }
    const auto before = [](const Folded& a, const Folded& b) { return a.row < b.row; };
    for (std::size_t j = 0; j + 1 < begin_.size(); ++j) {
      const auto first = folded_.begin() + static_cast<std::ptrdiff_t>(begin_[j]),
                 last = folded_.begin() + static_cast<std::ptrdiff_t>(begin_[j + 1]);
      if (!std::is_sorted(first, last, before)) std::stable_sort(first, last, before);
    }
  }
  std::size_t begin(int column) const { return begin_[static_cast<std::size_t>(column)]; }
  std::size_t end(int column) const { return begin_[static_cast<std::size_t>(column) + 1]; }
  Folded& operator[](std::size_t i) { return folded_[i]; }

 private:
  std::vector<std::size_t> begin_;
  std::vector<Folded> folded_;
};

/// Both triangles of what is left of the lower one: entries whose row is -1 are passed over.
void unfold(Columns& lower, int n, std::size_t entries, SparseMatrix& matrix) {
  matrix.resize(n, n);
  std::vector<int> count(static_cast<std::size_t>(n), 0);
  for (int j = 0; j < n; ++j)
    for (std::size_t k = lower.begin(j); k < lower.end(j); ++k) {
      if (lower[k].row < 0) continue;
      ++count[static_cast<std::size_t>(j)];
      if (lower[k].row != j) ++count[static_cast<std::size_t>(lower[k].row)];
    }
  matrix.resizeNonZeros(static_cast<Index>(entries));
  int* const outer = matrix.outerIndexPtr();
  outer[0] = 0;
  for (int j = 0; j < n; ++j) outer[j + 1] = outer[j] + count[static_cast<std::size_t>(j)];
  std::vector<int> next(outer, outer + n);
  const auto put = [&](int row, int column, double value) {
    const int place = next[static_cast<std::size_t>(column)]++;
    matrix.innerIndexPtr()[place] = row;
    matrix.valuePtr()[place] = value;
  };
  for (int j = 0; j < n; ++j)
    for (std::size_t k = lower.begin(j); k < lower.end(j); ++k) {
      const Folded& entry = lower[k];
      if (entry.row < 0) continue;
      put(entry.row, j, entry.value);
      if (entry.row != j) put(j, entry.row, entry.value);
    }
}

}  // namespace

int MatrixEntries::place_of(const RowLabel& label) {
  if (last_place_ >= 0 && label == last_label_) return last_place_;
  const auto [found, is_new] = places_.emplace(key_of(label), static_cast<int>(labels_.size()));
  if (is_new) {
    labels_.push_back(label);
    size_ = static_cast<int>(labels_.size());
  }
  last_label_ = label;
  return last_place_ = found->second;
}

/// Rows that files name come in whatever order the files have; by node and direction all files agree.
void MatrixEntries::sort_by_labels(model::FiniteElementMatrix& matrix) {
  std::vector<int> order(labels_.size()), place(labels_.size());
  std::iota(order.begin(), order.end(), 0);
  const auto label = [&](int i) { return labels_[static_cast<std::size_t>(i)]; };
  std::sort(order.begin(), order.end(), [&](int a, int b) { return label(a) < label(b); });
  for (std::size_t i = 0; i < order.size(); ++i) place[static_cast<std::size_t>(order[i])] = static_cast<int>(i);
  for (Entry& entry : entries_) {
    entry.row = place[static_cast<std::size_t>(entry.row)];
    entry.column = place[static_cast<std::size_t>(entry.column)];
  }
  std::sort(labels_.begin(), labels_.end());
  for (std::size_t i = 0; i < labels_.size(); ++i) places_[key_of(labels_[i])] = static_cast<int>(i);
  last_place_ = -1;
  matrix.labels = labels_;
}

MatrixEntries::Fault MatrixEntries::fold(model::FiniteElementMatrix& matrix) {
  if (entries_.empty()) return {"the file has no entries but zeros"};
  int n = std::max(size, size_);
  if (size == 0 && labels_.empty()) n = std::max(n, empty_rows);
  if (n > empty_rows && static_cast<std::size_t>(n) > entries_.size())
    return {fmt::format("a matrix of {} rows has only {} entries that are not zero; each row needs one on the diagonal",
                        n, entries_.size())};
  if (!labels_.empty()) sort_by_labels(matrix);
  matrix.zeros = zeros_;
  matrix.given = zeros_ + static_cast<std::int64_t>(entries_.size());
  Columns lower(entries_, n);
  entries_ = {};
  Vector diagonal = Vector::Zero(n);
  std::size_t pairs = 0;
  for (int j = 0; j < n; ++j)
    for (std::size_t k = lower.begin(j); k < lower.end(j);) {
      std::size_t end = k + 1;
      while (end < lower.end(j) && lower[end].row == lower[k].row) ++end;
      const Folded entry = lower[k];
      const std::size_t times = end - k;
      const int row = entry.was_upper ? j : entry.row, column = entry.was_upper ? entry.row : j;
      const bool is_pair = times == 2 && entry.row != j && lower[k + 1].was_upper != entry.was_upper;
      if (times > 1 && (!is_pair || triangle == Triangle::one)) {
        const bool is_mirror = lower[k + 1].was_upper != entry.was_upper;
        return {fmt::format("entry ({}, {}) is given twice{}", name(row), name(column),
                            is_mirror && triangle == Triangle::one
                                ? ", once in each triangle; a symmetric file holds one of them"
                                : ""),
                row, column, 2, triangle == Triangle::one};
      }
      if (is_pair) ++pairs;
      if (entry.row == j) diagonal[j] = entry.value;
      k = end;
    }
  const bool takes_both = triangle == Triangle::both || pairs > 0;
  std::size_t kept = 0;
  for (int j = 0; j < n; ++j)
    for (std::size_t k = lower.begin(j); k < lower.end(j); ++k) {
      Folded& entry = lower[k];
      if (entry.row == j) {
        ++kept;
        continue;
      }
      const double scale = std::sqrt(std::abs(diagonal[j] * diagonal[entry.row]));
      const int row = entry.was_upper ? j : entry.row, column = entry.was_upper ? entry.row : j;
      const bool is_pair = k + 1 < lower.end(j) && lower[k + 1].row == entry.row;
      if (is_pair) {
        Folded& mirror = lower[k + 1];
        const double difference = std::abs(entry.value - mirror.value);
        if (difference > same * (scale + std::abs(entry.value)))
          return {fmt::format("the matrix is not symmetric: entry ({0}, {1}) is {2}, and entry ({1}, {0}) is {3}{4}",
                              name(row), name(column), entry.value, mirror.value, remedy),
                  column, row, 1};
        if (scale > 0.0) matrix.asymmetry = std::max(matrix.asymmetry, difference / scale);
        entry.value = 0.5 * (entry.value + mirror.value);
        mirror.row = -1;
        ++k;
      } else if (takes_both) {
        if (std::abs(entry.value) > same * scale)
          return {fmt::format(
                      "the matrix is not symmetric: entry ({0}, {1}) is {2}, and entry ({1}, {0}) is not there{3}{4}",
                      name(row), name(column), entry.value,
                      pairs > 0 ? "; elsewhere the file gives both triangles" : "", remedy),
                  row, column, 1};
        if (scale > 0.0) matrix.asymmetry = std::max(matrix.asymmetry, std::abs(entry.value) / scale);
        entry.value *= 0.5;
      }
      kept += 2;
    }
  if (kept > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    return {fmt::format("the matrix has {} entries in both triangles, more than the {} that are taken", kept,
                        std::numeric_limits<int>::max())};
  unfold(lower, n, kept, matrix.values);
  matrix.digits = digits;
  return {};
}

std::string MatrixEntries::name(int row) const {
  const auto place = static_cast<std::size_t>(row);
  return place < labels_.size() ? model::name_of(labels_[place]) : std::to_string(row + 1);
}

void MatrixEntries::watch(const Fault& fault) {
  watched_ = true;
  seen_ = 0;
  watch_ = fault;
}

void MatrixEntries::look(int row, int column, int line) {
  const bool is_it = row == watch_.row && column == watch_.column;
  const bool is_mirror = watch_.either_triangle && row == watch_.column && column == watch_.row;
  if ((is_it || is_mirror) && ++seen_ == watch_.count) refuse(watch_, line);
}

void MatrixEntries::refuse(const Fault& fault, int line) const { throw InvalidInput({place_, line, 0}, fault.message); }

void MatrixEntries::refuse_not_finite(int line) const {
  throw InvalidInput({place_, line, 0},
                     "an entry is no finite number; was the matrix written by a solution that failed?");
}

}  // namespace rubato::io
