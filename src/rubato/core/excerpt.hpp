#pragma once

#include <string>
#include <string_view>

namespace rubato {

/// A text of the user's, for a message: as it is, or its beginning and its length where it is longer than 120
/// characters: `1+1+1+... (1048576 characters)`.
std::string excerpt(std::string_view text);

}  // namespace rubato
