#pragma once

#include <rubato/integrate/equilibrium/equilibrium.hpp>
#include <rubato/integrate/mechanism/small_motions.hpp>
#include <rubato/model/description.hpp>

#include <string>
#include <vector>

namespace rubato::integrate {

/// The equilibrium of a mechanism, and what it does beside it.
struct MotionsAboutRest {
  Equilibrium found;
  SmallMotions motions;  ///< empty unless it was found, and is stable
  std::vector<std::string> coordinates;
  std::vector<char> is_rotation;  ///< of each
  bool starts_at_rest = true;     ///< no velocities are given
  std::vector<std::string> told;  ///< what it took to assemble it
};

/// Of a mechanism whose equilibrium is near the configuration given, under its loads at t = 0. Throws InvalidInput
/// where it cannot be built or assembled.
MotionsAboutRest motions_about_rest(const model::ModelDescription& model, const numerics::Parameters& parameters);

}  // namespace rubato::integrate
