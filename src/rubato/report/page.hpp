#pragma once

#include <string>
#include <string_view>

namespace rubato::report {

/// The page as one HTML document that asks for nothing outside itself (its content security policy forbids it).
///
/// @param title  of the document
/// @param data   a JSON object that may stand inside a <script> element (json.hpp)
std::string html_page(std::string_view title, std::string_view data);

/// `code` that may stand inside a <script> element: `</script` in it, which can only be within a string, a regular
/// expression or a comment, becomes `<\/script`, which means the same there.
std::string inline_script(std::string_view code);

}  // namespace rubato::report
