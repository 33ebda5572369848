#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace rubato::numerics {

/// What is wrong with the text of a formula, as InvalidInput: the text, the fault, its place and what to write instead.
class FormulaFaults {
 public:
  /// @param text   must outlive this
  /// @param known  the names that the formula may use
  FormulaFaults(const std::string& text, std::vector<std::string> known) : text_(text), known_(std::move(known)) {}

  /// @param at  a place in the text, from 0
  [[noreturn]] void fail(const std::string& fault, std::size_t at, const std::string& hint = "") const;
  [[noreturn]] void unknown_name(const std::string& name, std::size_t at) const;
  /// Something stands where nothing of its kind can.
  /// @param what  such as `operator "*"`
  [[noreturn]] void unexpected(const std::string& what, std::size_t at) const;
  /// A character that formulas do not know.
  [[noreturn]] void unexpected_symbol(std::size_t at) const;
  [[noreturn]] void list(std::size_t count) const;
  [[noreturn]] void assignment(std::size_t at) const;

 private:
  std::string beginning() const;
  std::string character(std::size_t at) const;

  const std::string& text_;
  std::vector<std::string> known_;
};

}  // namespace rubato::numerics
