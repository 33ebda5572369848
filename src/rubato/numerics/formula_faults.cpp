#include <rubato/core/error.hpp>
#include <rubato/core/excerpt.hpp>
#include <rubato/numerics/formula_faults.hpp>
#include <rubato/numerics/formula_spelling.hpp>

namespace rubato::numerics {
std::string FormulaFaults::beginning() const { return "in the expression \"" + excerpt(text_) + "\": "; }

std::string FormulaFaults::character(std::size_t at) const {
  return " at character " + std::to_string(character_of(text_, at));
}

void FormulaFaults::fail(const std::string& fault, std::size_t at, const std::string& hint) const {
  throw InvalidInput(beginning() + fault + (at >= text_.size() ? " at its end" : character(at)) + hint);
}

void FormulaFaults::unknown_name(const std::string& name, std::size_t at) const {
  const std::size_t next = text_.find_first_not_of(" \t", at + name.size());
  const bool is_call = next != std::string::npos && text_[next] == '(';
  fail("unknown name \"" + excerpt(name) + "\"", at, name_hint(text_, at, name, is_call, known_));
}

void FormulaFaults::unexpected(const std::string& what, std::size_t at) const {
  fail("unexpected " + what, at, syntax_hint(text_, at));
}

void FormulaFaults::unexpected_symbol(std::size_t at) const {
  const std::string symbol = symbol_at(text_, at);
  fail("unexpected \"" + symbol + "\"", at, symbol_hint(symbol));
}

void FormulaFaults::list(std::size_t count) const {
  throw InvalidInput(beginning() + std::to_string(count) +
                     " values with commas between them; give one, with a point for its decimals");
}

void FormulaFaults::assignment(std::size_t at) const {
  throw InvalidInput(beginning() + "\"=\"" + character(at) +
                     " assigns, which a formula cannot; a comparison is written \"==\"");
}

}  // namespace rubato::numerics
