#include <rubato/core/error.hpp>
#include <rubato/io/toml_limits.hpp>

#include <fmt/format.h>

#include <algorithm>

namespace rubato::io {
namespace {

constexpr int most_parts = 32;  // of a key; no key of a study has more than three

/// Where a string ends that begins at `begin` with a quote: behind its closing quotes, or, where they are missing, at
/// the end of the line or of the text.
std::size_t end_of_string(std::string_view text, std::size_t begin) {
  const char quote = text[begin];
  const bool has_escapes = quote == '"';
  const bool is_long = text.substr(begin, 3) == std::string(3, quote);
  std::size_t at = begin + (is_long ? 3 : 1);
  for (; at < text.size(); ++at) {
    if (has_escapes && text[at] == '\\') {
      ++at;
      continue;
    }
    if (!is_long && (text[at] == quote || text[at] == '\n')) return text[at] == quote ? at + 1 : at;
    if (is_long && text.substr(at, 3) == std::string(3, quote)) {
      at += 3;
      for (int more = 0; more < 2 && at < text.size() && text[at] == quote; ++more) ++at;  // part of the string
      return at;
    }
  }
  return text.size();
}

}  // namespace

void require_moderate_keys(std::string_view text, const std::string& name) {
  int line = 1, dots = 0;
  std::size_t line_begin = 0, key_begin = 0;
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    if (c == '"' || c == '\'') {
      const std::size_t end = end_of_string(text, at);
      for (; at < end; ++at)
        if (text[at] == '\n') {
          ++line;
          line_begin = at + 1;
        }
      continue;
    }
    if (c == '#') {
      at = std::min(text.find('\n', at), text.size());
      continue;
    }
    if (c == '.' && ++dots >= most_parts)
      throw InvalidInput({name, line, static_cast<int>(key_begin - line_begin) + 1},
                         fmt::format("a key of more than {} parts with dots between them; no key of a study has more "
                                     "than three",
                                     most_parts));
    if (std::string_view("\n=,[]{}").find(c) != std::string_view::npos) {
      dots = 0;
      key_begin = at + 1;
    }
    ++at;
    if (c != '\n') continue;
    ++line;
    line_begin = key_begin = at;
  }
}

}  // namespace rubato::io
