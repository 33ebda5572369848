#include <rubato/io/read_parts.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>
#include <string_view>
#include <unordered_map>

namespace rubato::io {
namespace {

constexpr std::uintmax_t largest_matrix = std::uintmax_t{4} << 30;

/// Lines of a text with their numbers; comments (%) and blank lines are passed over.
class Lines {
 public:
  explicit Lines(std::string_view text) : text_(text) {}

  bool next(std::string_view& line) {
    while (begin_ < text_.size()) {
      const std::size_t end = std::min(text_.find('\n', begin_), text_.size());
      line = text_.substr(begin_, end - begin_);
      begin_ = end + 1;
      ++number_;
      while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.remove_suffix(1);
      if (!line.empty() && (line.front() != '%' || number_ == 1)) return true;
    }
    return false;
  }
  int number() const { return number_; }

 private:
  std::string_view text_;
  std::size_t begin_ = 0;
  int number_ = 0;
};

template <std::size_t N>
bool numbers(std::string_view line, std::array<double, N>& values) {
  const char* place = line.data();
  const char* const end = place + line.size();
  for (double& value : values) {
    while (place != end && (*place == ' ' || *place == '\t' || *place == '+')) ++place;
    const auto [next, fault] = std::from_chars(place, end, value);
    if (fault != std::errc()) return false;
    place = next;
  }
  return std::string_view(place, static_cast<std::size_t>(end - place)).find_first_not_of(" \t") ==
         std::string_view::npos;
}

void require_symmetric(const model::MatrixDescription& matrix, const std::string& place) {
  std::unordered_map<std::uint64_t, double> entries;
  double largest = 0.0;
  const auto key = [](int row, int column) {
    return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(row)) << 32) | static_cast<std::uint32_t>(column);
  };
  for (const auto& entry : matrix.entries) {
    entries[key(entry.row, entry.column)] += entry.value;
    largest = std::max(largest, std::abs(entry.value));
  }
  for (const auto& entry : matrix.entries) {
    const auto mirror = entries.find(key(entry.column, entry.row));
    const double other = mirror == entries.end() ? 0.0 : mirror->second;
    const double own = entries[key(entry.row, entry.column)];
    // What finite-element programs write is symmetric to the digits they print.
    if (std::abs(own - other) <= 1e-9 * largest) continue;
    throw InvalidInput({place, 0, 0}, fmt::format("the matrix is not symmetric: entry ({0}, {1}) is {2}, entry "
                                                  "({1}, {0}) is {3}",
                                                  entry.row + 1, entry.column + 1, own, other));
  }
}

}  // namespace

model::MatrixDescription read_matrix_market(const std::string& file, const StudyFolder& folder, const Location& where) {
  const std::string text = folder.read(file, where, largest_matrix, "the matrix");
  const std::string place = folder.place_of(file);
  refuse_binary(text, place, "a Matrix Market file is text");
  Lines lines(text);
  std::string_view line;
  const auto here = [&] { return Location{place, lines.number(), 0}; };
  const std::string expected =
      "the first line must be \"%%MatrixMarket matrix coordinate real symmetric\" (or general, "
      "integer, array)";
  if (!lines.next(line)) throw InvalidInput({place, 0, 0}, "the file is empty; " + expected);
  std::string header(line);
  std::transform(header.begin(), header.end(), header.begin(), [](unsigned char c) { return std::tolower(c); });
  std::istringstream words(header);
  std::string banner, object, format, field, symmetry;
  words >> banner >> object >> format >> field >> symmetry;
  if (banner != "%%matrixmarket" || object != "matrix" || (format != "coordinate" && format != "array") ||
      (field != "real" && field != "integer" && field != "double") ||
      (symmetry != "general" && symmetry != "symmetric"))
    throw InvalidInput(here(), fmt::format("{}; got \"{}\"", expected, line.substr(0, 80)));

  model::MatrixDescription matrix;
  matrix.file = file;
  matrix.where = where;
  const bool is_symmetric = symmetry == "symmetric", is_array = format == "array";
  if (!lines.next(line)) throw InvalidInput({place, 0, 0}, "the line of sizes is missing");
  double rows = 0.0, columns = 0.0, count = 0.0;
  std::array<double, 2> two;
  std::array<double, 3> three;
  if (is_array ? numbers(line, two) : numbers(line, three)) {
    rows = is_array ? two[0] : three[0];
    columns = is_array ? two[1] : three[1];
    count = is_array ? (is_symmetric ? rows * (rows + 1) / 2 : rows * columns) : three[2];
  }
  if (!(rows >= 1) || !(rows <= 2e9) || rows != std::floor(rows) || !(count >= 0))
    throw InvalidInput(here(), fmt::format("the line of sizes must be {}, got \"{}\"",
                                           is_array ? "ROWS COLUMNS" : "ROWS COLUMNS ENTRIES", line.substr(0, 60)));
  if (rows != columns)
    throw InvalidInput(here(), fmt::format("the matrix must be square, it is {} x {}", rows, columns));
  matrix.size = static_cast<int>(rows);
  double read = 0.0;
  int row = 0, column = 0;
  const auto add = [&](int i, int j, double value) {
    if (value == 0.0) return;
    matrix.entries.push_back({i, j, value});
    if (is_symmetric && i != j) matrix.entries.push_back({j, i, value});
  };
  while (lines.next(line)) {
    double value = 0.0;
    if (is_array) {
      std::array<double, 1> one;
      if (!numbers(line, one))
        throw InvalidInput(here(), fmt::format("expected a number, got \"{}\"", line.substr(0, 60)));
      value = one[0];
    } else {
      if (!numbers(line, three))
        throw InvalidInput(here(), fmt::format("an entry must be ROW COLUMN VALUE, got \"{}\"", line.substr(0, 60)));
      if (!(three[0] >= 1 && three[0] <= rows && three[1] >= 1 && three[1] <= rows))
        throw InvalidInput(
            here(), fmt::format("entry ({}, {}) lies outside the {} x {} matrix", three[0], three[1], rows, columns));
      if (three[0] != std::floor(three[0]) || three[1] != std::floor(three[1]))
        throw InvalidInput(here(), fmt::format("row and column must be whole numbers, got {} {}", three[0], three[1]));
      if (is_symmetric && three[0] < three[1])
        throw InvalidInput(here(),
                           fmt::format("entry ({}, {}) lies above the diagonal; a symmetric file holds the lower "
                                       "triangle, a general one holds both",
                                       three[0], three[1]));
      row = static_cast<int>(three[0]) - 1;
      column = static_cast<int>(three[1]) - 1;
      value = three[2];
    }
    if (!std::isfinite(value)) throw InvalidInput(here(), "an entry is not finite");
    if (++read > count) throw InvalidInput(here(), fmt::format("more than the {} entries announced", count));
    add(row, column, value);
    if (is_array && ++row == matrix.size) row = is_symmetric ? ++column : (++column, 0);
  }
  if (read < count) throw InvalidInput({place, 0, 0}, fmt::format("the file ends after {} of {} entries", read, count));
  require_symmetric(matrix, place);
  return matrix;
}

}  // namespace rubato::io
