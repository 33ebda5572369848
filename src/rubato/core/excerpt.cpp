#include <rubato/core/excerpt.hpp>

namespace rubato {

std::string excerpt(std::string_view text) {
  constexpr std::size_t longest = 120, kept = 80;
  if (text.size() <= longest) return std::string(text);
  std::size_t end = kept;
  // Not within a character of several bytes (UTF-8).
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0u) == 0x80u) --end;
  return std::string(text.substr(0, end)) + "... (" + std::to_string(text.size()) + " characters)";
}

}  // namespace rubato
