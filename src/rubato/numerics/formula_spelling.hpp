#pragma once

#include <cstddef>
#include <span>
#include <string>

// Private to the numerics floor: how formulas are written here, for those who know them from elsewhere.
namespace rubato::numerics {

/// The number, from 1, of the character that begins at a byte of the text (UTF-8).
std::size_t character_of(const std::string& text, std::size_t place);

/// The character at a byte of the text that is neither part of a name nor of a number; empty where it is.
std::string symbol_at(const std::string& text, std::size_t place);

/// What to write instead of a symbol that formulas do not know: `; a product is written with "*"`; or nothing.
std::string symbol_hint(const std::string& symbol);

/// What to write where the syntax is wrong at a byte of the text; or nothing.
std::string syntax_hint(const std::string& text, std::size_t place);

/// What to write instead of a name that is not known: how it is called here, or the nearest name.
/// @param place    its first byte
/// @param is_call  whether a parenthesis follows
/// @param known    the names that are
std::string name_hint(const std::string& text, std::size_t place, const std::string& name, bool is_call,
                      std::span<const std::string> known);

}  // namespace rubato::numerics
