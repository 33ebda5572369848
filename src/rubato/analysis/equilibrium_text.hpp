#pragma once

#include <rubato/integrate/equilibrium/equilibrium.hpp>

#include <string>

namespace rubato::analysis {

/// Why a search came to no equilibrium to go on from, with the names of the user's parts, and what may help; empty
/// where it found one.
std::string complaint(const integrate::Equilibrium& equilibrium);

/// Whether there is none for certain, or it lies in what the user gave; else a search that found none has failed.
bool is_certain(const integrate::Equilibrium& equilibrium);

/// What to tell of displacements that the rounding of the stiffness spoils; empty: nothing.
std::string warning_of_rounding(const integrate::Equilibrium& found);

}  // namespace rubato::analysis
