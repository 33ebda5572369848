#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace rubato {

/// A place in the user's file; line and column count from 1, 0 means unknown. `file` is empty for values that came from
/// the command line or from C++.
struct Location {
  std::string file;
  int line = 0;
  int column = 0;
};

/// The user gave something that cannot be used: a file, an option, a value. The message names the place, the value
/// found and the remedy. Nothing has been changed when it is thrown.
///
/// what() is `FILE:LINE:COLUMN: error: MESSAGE`, without the parts that are unknown.
class InvalidInput : public std::runtime_error {
 public:
  explicit InvalidInput(const std::string& message) : InvalidInput(Location{}, message) {}
  InvalidInput(const Location& where, const std::string& message);

  const Location& where() const { return where_; }
  const std::string& message() const { return message_; }  ///< without the place

 private:
  Location where_;
  std::string message_;
};

/// The output could not be written (full disk, permissions). The message names the file and the reason.
class OutputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The member of `known` nearest to `name` (edit distance, at most a third of the longer one), or an empty string.
std::string nearest_name(std::string_view name, std::span<const std::string> known);

/// `; did you mean "NEAREST"? (known: a, b, c, ...)`, without the first part where nothing is near; at most eight names
/// are listed. Empty when `known` is empty.
std::string suggestion(std::string_view name, std::span<const std::string> known);

}  // namespace rubato
