#pragma once

#include <span>
#include <string>
#include <string_view>

// JSON that may stand inside a <script> element.
namespace rubato::report {

/// `text` in double quotes. Besides what JSON asks for, `<`, `>`, `&` and the line separators U+2028 and U+2029 are
/// written as \uXXXX, so that no text can end or open a <script>; bytes that are not UTF-8 become U+FFFD.
std::string json_string(std::string_view text);

/// `value` with so many significant digits; `null` for NaN and infinities, which JSON lacks.
std::string json_number(double value, int digits = 7);

/// `[a,b,...]`.
std::string json_numbers(std::span<const double> values, int digits = 7);
std::string json_strings(std::span<const std::string> values);

/// `text` with &, <, >, and quotes as entities, for the body of an HTML element or an attribute.
std::string html_text(std::string_view text);

}  // namespace rubato::report
