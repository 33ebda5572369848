#pragma once

#include <rubato/core/error.hpp>
#include <rubato/numerics/formula.hpp>

#include <string>
#include <vector>

namespace rubato::integrate {

/// Throws InvalidInput for rows that do not reach from 0 to the end of a run, where nothing is said of what is beyond.
/// @param source    the file; empty: it has no name
/// @param remedies  what `beyond` may be
void require_rows_to_reach(const std::vector<double>& times, const std::string& source, double end,
                           const std::string& remedies, const Location& where);

/// Throws InvalidInput for a prescribed motion that jumps in a run.
/// @param what  "the displacement"
void refuse_jump(const std::string& what, const numerics::Formula& motion, double end, const Location& where);

}  // namespace rubato::integrate
