#pragma once

#include <string>
#include <string_view>

namespace rubato::io {

/// Throws InvalidInput, with line and column, for a key or header of more than 32 parts with dots between them: toml++
/// makes a table of each, and their destructors call one another. (How deep lists and inline tables nest toml++ bounds
/// itself.) Strings and comments are passed over; whether the text is TOML is not asked.
/// @param name  of the file, for the message
void require_moderate_keys(std::string_view text, const std::string& name);

}  // namespace rubato::io
