#include <rubato/core/error.hpp>
#include <rubato/numerics/formula_functions.hpp>
#include <rubato/numerics/formula_spelling.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace rubato::numerics {

namespace {

using Spellings = std::pair<const char*, const char*>;

bool is_blank(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }
bool is_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }
bool is_continuation(char c) { return (static_cast<unsigned char>(c) & 0xc0U) == 0x80U; }

/// The last character before a place that is no blank; '\0' where there is none.
char before(const std::string& text, std::size_t place) {
  while (place > 0 && is_blank(text[place - 1])) --place;
  return place > 0 ? text[place - 1] : '\0';
}

/// Whether what ends before a place is a number, as that before a unit is.
bool is_after_number(const std::string& text, std::size_t place) {
  while (place > 0 && is_blank(text[place - 1])) --place;
  const std::size_t end = place;
  while (place > 0 && (is_name(text[place - 1]) || text[place - 1] == '.')) --place;
  return place < end && (text[place] == '.' || std::isdigit(static_cast<unsigned char>(text[place])) != 0);
}

template <std::size_t N>
std::string found_in(const std::array<Spellings, N>& spellings, const std::string& word) {
  const auto* found =
      std::find_if(spellings.begin(), spellings.end(), [&](const Spellings& one) { return word == one.first; });
  return found == spellings.end() ? "" : std::string("; ") + found->second;
}

constexpr std::array<Spellings, 5> words_between{{{"and", "write \"a && b\""},
                                                  {"or", "write \"a || b\""},
                                                  {"not", "write \"a == 0\""},
                                                  {"mod", "write \"a - b*rint(a/b - 0.5)\""},
                                                  {"xor", "write \"(a != 0) != (b != 0)\""}}};

constexpr std::array<Spellings, 31> words{
    {{"if", "a choice is written \"condition ? this : else that\""},
     {"pow", "a power is written \"a^b\""},
     {"power", "a power is written \"a^b\""},
     {"e", "Euler's number is \"exp(1)\""},
     {"true", "write \"1\""},
     {"false", "write \"0\""},
     {"floor", "write \"rint(a - 0.5)\""},
     {"ceil", "write \"-rint(-a - 0.5)\""},
     {"int", "the whole number below is \"rint(a - 0.5)\""},
     {"trunc", "the whole number below is \"rint(a - 0.5)\""},
     {"fmod", "write \"a - b*rint(a/b - 0.5)\""},
     {"heaviside", "a step is written \"t > 1\", which is 1 where it is true and 0 elsewhere"},
     {"step", "a step is written \"t > 1\", which is 1 where it is true and 0 elsewhere"},
     {"round", "the nearest whole number is \"rint(a)\""},
     {"sgn", "write \"sign(a)\""},
     {"signum", "write \"sign(a)\""},
     {"fabs", "write \"abs(a)\""},
     {"cbrt", "write \"a^(1/3)\""},
     {"hypot", "write \"sqrt(a^2 + b^2)\""},
     {"arcsin", "write \"asin(a)\""},
     {"arccos", "write \"acos(a)\""},
     {"arctan", "write \"atan(a)\""},
     {"arctan2", "write \"atan2(y, x)\""},
     {"arsinh", "write \"asinh(a)\""},
     {"arcosh", "write \"acosh(a)\""},
     {"artanh", "write \"atanh(a)\""},
     {"tg", "write \"tan(a)\""},
     {"cot", "write \"1/tan(a)\""},
     {"sec", "write \"1/cos(a)\""},
     {"csc", "write \"1/sin(a)\""},
     {"mean", "write \"avg(a, b)\""}}};

constexpr std::array<Spellings, 17> symbols{{{"%", "write \"a - b*rint(a/b - 0.5)\" for a remainder"},
                                             {"&", "write \"a && b\""},
                                             {"|", "write \"a || b\", or \"abs(a)\""},
                                             {"!", "write \"a == 0\" for what is not true"},
                                             {"¬", "write \"a == 0\" for what is not true"},
                                             {"−", "a minus is written \"-\""},
                                             {"–", "a minus is written \"-\""},
                                             {"×", "a product is written with \"*\""},
                                             {"·", "a product is written with \"*\""},
                                             {"÷", "a quotient is written with \"/\""},
                                             {"²", "a power is written \"a^b\""},
                                             {"³", "a power is written \"a^b\""},
                                             {"√", "a root is written \"sqrt(a)\""},
                                             {"π", "write \"pi\""},
                                             {"[", "parentheses are round"},
                                             {"{", "parentheses are round"},
                                             {";", "arguments are parted by \",\""}}};

}  // namespace

std::size_t character_of(const std::string& text, std::size_t place) {
  const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(place, text.size()));
  return 1 + static_cast<std::size_t>(std::count_if(text.begin(), end, [](char c) { return !is_continuation(c); }));
}

std::string symbol_at(const std::string& text, std::size_t place) {
  if (place >= text.size() || is_name(text[place]) || text[place] == '.') return "";
  std::size_t end = place + 1;
  while (end < text.size() && is_continuation(text[end])) ++end;
  return text.substr(place, end - place);
}

std::string symbol_hint(const std::string& symbol) { return found_in(symbols, symbol); }

std::string syntax_hint(const std::string& text, std::size_t place) {
  if (place >= text.size()) return "";
  const char here = text[place], last = place > 0 ? text[place - 1] : '\0';
  if (here == '*' && last == '*') return "; a power is written \"a^b\"";
  if (here == '/' && last == '/') return "; the whole number below a/b is \"rint(a/b - 0.5)\"";
  if (last == '=' && (here == '>' || here == '<')) return std::string("; write \"") + here + "=\"";
  if (last == '<' && here == '>') return "; write \"a != b\"";
  // A value after another.
  const bool begins_value = is_name(here) || here == '.' || here == '(';
  if (begins_value && (before(text, place) == ')' || is_after_number(text, place)))
    return "; a product is written with \"*\"";
  return "";
}

std::string name_hint(const std::string& text, std::size_t place, const std::string& name, bool is_call,
                      std::span<const std::string> known) {
  std::string word = name;
  std::transform(word.begin(), word.end(), word.begin(), [](unsigned char c) { return std::tolower(c); });
  if (const std::string hint = found_in(words_between, word); !hint.empty()) return hint;
  if (is_after_number(text, place)) return "; units are implied (m, kg, s, N, rad): write the number alone";
  if (!nearest_name(name, known).empty()) return suggestion(name, known);
  // "1e400" is taken for a name.
  if (std::isinf(std::strtod(name.c_str(), nullptr)) && std::isdigit(static_cast<unsigned char>(name.front())) != 0)
    return "; as a number it is beyond what can be computed with (1.8e308)";
  if (!is_call && is_function(word)) return "; arguments of a function stand in parentheses: \"" + word + "(a)\"";
  if (word != name && (word == "pi" || (is_call && is_function(word)))) return "; did you mean \"" + word + "\"?";
  const std::string hint = found_in(words, word);
  return hint.empty() ? suggestion(name, known) : hint;
}

}  // namespace rubato::numerics
