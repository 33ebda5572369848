#pragma once

#include <rubato/core/error.hpp>

#include <functional>
#include <string>
#include <string_view>
#include <vector>

// Tables of fields in text files. Private to io.
namespace rubato::io {

/// Calls with the fields of each row and its place: separated by commas, or by semicolons where the row has one,
/// without quotes and blanks about them. Passes over empty rows and those that begin with `#`.
/// @param text   of the file; a byte-order mark is passed over
/// @param place  the file, for messages
void for_each_csv_row(
    std::string_view text, const std::string& place,
    const std::function<void(const std::vector<std::string_view>& fields, const Location& here)>& take);

/// Throws InvalidInput at `here` for a field that is no finite number; `name` says what it is.
double csv_number(std::string_view field, const std::string& name, const Location& here);

}  // namespace rubato::io
