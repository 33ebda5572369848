#pragma once

#include <rubato/model/finite_elements/finite_elements.hpp>

#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

// Private to io.
namespace rubato::io {

/// What a file says of a symmetric matrix: which entries it gives.
enum class Triangle {
  one,        ///< each pair of mirrored entries once, in either triangle
  both,       ///< both of each pair
  undeclared  ///< the one or the other, which the entries tell
};

/// Takes the entries of a matrix as a file gives them, and makes a symmetric matrix of them. Zeros are dropped.
class MatrixEntries {
 public:
  explicit MatrixEntries(std::string place) : place_(std::move(place)) {}

  Triangle triangle = Triangle::undeclared;
  int size = 0;        ///< as the file announces it; else as the entries tell
  int empty_rows = 0;  ///< rows that it may have without an entry on the diagonal: as many as the stiffness matrix has
  int digits = 16;
  std::string remedy = "";  ///< what to do where the matrix is not symmetric

  /// @param row, column  zero-based, not negative
  void add(int row, int column, double value, int line) {
    if (!(value - value == 0.0)) refuse_not_finite(line);
    if (watched_) return look(row, column, line);
    const int larger = row > column ? row : column;
    if (larger >= size_) size_ = larger + 1;
    if (value != 0.0)
      entries_.push_back({row, column, value});
    else
      ++zeros_;
  }
  /// By names of rows.
  void add(const model::RowLabel& row, const model::RowLabel& column, double value, int line) {
    const int i = place_of(row);
    add(i, place_of(column), value, line);
  }
  /// The row of a name, a new one where there is none yet.
  int place_of(const model::RowLabel& label);
  bool has_entries() const { return size_ > 0; }

  /// Makes the matrix, with its rows in the order of their names where they have any.
  /// @param read_again  reads the file once more into these entries, to find the line of a fault
  template <class ReadAgain>
  model::FiniteElementMatrix matrix(const ReadAgain& read_again) {
    model::FiniteElementMatrix matrix;
    Fault fault = fold(matrix);
    if (!fault.message.empty()) {
      watch(fault);
      if (fault.row >= 0) read_again();
      refuse(fault, 0);
    }
    return matrix;
  }

 private:
  struct Entry {
    int row, column;
    double value;
  };
  /// An entry that is wrong, and which of those in its place: 1 the first.
  struct Fault {
    std::string message = "";
    int row = -1, column = -1, count = 1;  ///< row -1: of the whole matrix
    bool either_triangle = false;
  };

  Fault fold(model::FiniteElementMatrix& matrix);
  void sort_by_labels(model::FiniteElementMatrix& matrix);
  std::string name(int row) const;
  void watch(const Fault& fault);
  void look(int row, int column, int line);
  [[noreturn]] void refuse(const Fault& fault, int line) const;
  [[noreturn]] void refuse_not_finite(int line) const;

  std::string place_;
  int size_ = 0;
  std::int64_t zeros_ = 0;
  std::vector<Entry> entries_;
  std::unordered_map<std::uint64_t, int> places_;
  std::vector<model::RowLabel> labels_;
  model::RowLabel last_label_{};
  int last_place_ = -1;
  bool watched_ = false;
  int seen_ = 0;
  Fault watch_;
};

}  // namespace rubato::io
