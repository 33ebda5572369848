#pragma once

#include <rubato/core/error.hpp>

#include <charconv>
#include <cmath>
#include <cstring>
#include <string>
#include <string_view>

// Private to io.
namespace rubato::io {

/// The lines of a text with their numbers, without what ends them.
class LineScanner {
 public:
  LineScanner(std::string_view text, std::string place) : text_(text), place_(std::move(place)) {}

  bool next(std::string_view& line) {
    if (begin_ >= text_.size()) return false;
    const char* const first = text_.data() + begin_;
    const auto* const end = static_cast<const char*>(std::memchr(first, '\n', text_.size() - begin_));
    std::size_t length = end ? static_cast<std::size_t>(end - first) : text_.size() - begin_;
    begin_ += length + 1;
    ++number_;
    if (length > 0 && first[length - 1] == '\r') --length;
    line = std::string_view(first, length);
    return true;
  }
  int number() const { return number_; }
  const std::string& place() const { return place_; }
  Location here() const { return {place_, number_, 0}; }
  /// Whether the last line that was returned has no end: a file that was cut off.
  bool ends_within_a_line() const { return begin_ > text_.size(); }

 private:
  std::string_view text_;
  std::string place_;
  std::size_t begin_ = 0;
  int number_ = 0;
};

inline bool is_blank(char c) { return c == ' ' || c == '\t'; }

inline std::string_view trimmed_blanks(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

/// Takes numbers off the front of a line.
class NumberScanner {
 public:
  explicit NumberScanner(std::string_view line) : place_(line.data()), end_(line.data() + line.size()) {}

  template <class Number>
  bool next(Number& value) {
    skip_blanks();
    if (place_ != end_ && *place_ == '+') ++place_;
    const auto [after, fault] = std::from_chars(place_, end_, value);
    if (fault != std::errc()) return false;
    place_ = after;
    return true;
  }
  /// Passes over blanks, one comma and blanks.
  void skip_comma() {
    skip_blanks();
    if (place_ != end_ && *place_ == ',') ++place_;
  }
  /// Whether a blank, a comma or the end follows: what was read was a whole word.
  bool is_at_gap() const { return place_ == end_ || is_blank(*place_) || *place_ == ','; }
  bool is_at_end() {
    skip_blanks();
    return place_ == end_;
  }

 private:
  void skip_blanks() {
    while (place_ != end_ && is_blank(*place_)) ++place_;
  }
  const char* place_;
  const char* end_;
};

/// A number as Fortran writes it: exponents with E, D or a sign alone (1.5-3). Nothing but blanks may stand about it.
bool fortran_number(std::string_view text, double& value);

}  // namespace rubato::io
