#include <rubato/io/finite_elements/text_scanner.hpp>

#include <array>

namespace rubato::io {

bool fortran_number(std::string_view text, double& value) {
  text = trimmed_blanks(text);
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  const char* const end = text.data() + text.size();
  const auto [after, fault] = std::from_chars(text.data(), end, value);
  if (fault == std::errc() && after == end) return true;
  // With an exponent of its own: 1.5D+02, 1.5-3.
  std::array<char, 64> spelled{};
  std::size_t length = 0;
  bool has_exponent = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (length + 2 >= spelled.size()) return false;
    const char c = text[i];
    if (c == 'D' || c == 'd' || c == 'E' || c == 'e') {
      if (has_exponent) return false;
      has_exponent = true;
      spelled[length++] = 'e';
    } else if ((c == '+' || c == '-') && i > 0 && spelled[length - 1] != 'e') {
      if (has_exponent) return false;
      has_exponent = true;
      spelled[length++] = 'e';
      spelled[length++] = c;
    } else {
      spelled[length++] = c;
    }
  }
  const char* const last = spelled.data() + length;
  const auto [behind, refusal] = std::from_chars(spelled.data(), last, value);
  return length > 0 && refusal == std::errc() && behind == last;
}

}  // namespace rubato::io
