#pragma once

#include <rubato/model/doubtful_values.hpp>
#include <rubato/model/finite_elements/finite_elements.hpp>

#include <string>
#include <vector>

namespace rubato::model {

/// What a finite element model is, and what of it is hardly meant.
struct FiniteElementFindings {
  std::vector<std::string> facts;
  std::vector<DoubtfulValue> doubts;
};

/// Mass, centre of gravity and inertia from rigid motions, which nodes are held, whether the mass is lumped, what
/// rigid motions cost away from held nodes (nothing, or, of a structure that turns, spin softening: K u = -Omega^2 M u
/// of translations across the axis), and units that look wrong.
FiniteElementFindings check_finite_elements(const FiniteElements& model);

/// The lowest frequencies of the matrices alone, for people; empty where they were not found.
/// @param most  how many at most
std::string first_frequencies(const FiniteElements& model, Index most);

}  // namespace rubato::model
