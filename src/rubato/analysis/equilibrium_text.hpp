#pragma once

#include <rubato/integrate/equilibrium/equilibrium.hpp>

#include <string>

namespace rubato::analysis {

/// Why a search came to no equilibrium to go on from, with the names of the user's parts, and what may help; empty
/// where it found one.
std::string complaint(const integrate::Equilibrium& equilibrium);

}  // namespace rubato::analysis
