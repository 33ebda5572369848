#pragma once

#include <rubato/model/finite_elements/finite_elements.hpp>

#include <string_view>

// Private to io.
namespace rubato::io {

/// What the rows of matrices are, by what the file looks like: CalculiX's `.dof` (line k is NODE.DIRECTION of row k);
/// a table whose first line names the columns `row`, `node`, `direction` and perhaps `x`, `y`, `z`; or the mapping that
/// Ansys writes beside a Harwell-Boeing file. Throws InvalidInput, with the line.
model::RowTable read_rows(std::string_view text, const std::string& place);

}  // namespace rubato::io
