#pragma once

#include <rubato/system/locally_nonlinear.hpp>

#include <span>
#include <vector>

namespace rubato::integrate {

enum class StaticOutcome {
  found,
  mechanism,             ///< with all sliders stuck some motion meets no resistance
  gives_way,             ///< the sliders that slip leave a motion without resistance: no equilibrium
  gives_way_on_the_way,  ///< loads that grow from zero lead no further than a share of them (with other laws)
  not_settled            ///< the set of slipping sliders and closed stops did not settle
};

/// A state of equilibrium, and what was found on the way to it.
struct StaticEquilibrium {
  StaticOutcome outcome = StaticOutcome::not_settled;
  system::State state;        ///< t = 0, velocities of the system's start
  Vector reaction;            ///< on the held displacements, in their order [N] or [N m]
  std::vector<Index> moving;  ///< coordinates that move where the outcome is mechanism or gives_way
  double reached = 1.0;       ///< share of the loads up to which there is an equilibrium
  int factorisations = 0;
  double rounding = 0.0;  ///< rounding_of_stiffness() [-]
  bool is_stable = true;  ///< the tangent is not indefinite
};

/// The state in which
///
///   K q + B fc = f(0-) + held forces,   fc = clamp(kT u, -limit, +limit),   u = B^T q,   q_p = held displacement
///
/// and the stops push with fs = max(0, k (u - gap)). The sliders are loaded from zero in one go: their state is the
/// minimum of a convex energy, and so is q, unique where the stiffness with the sticking sliders is positive definite;
/// where it is indefinite the state is no minimum, and not stable.
/// Newton's iteration on the set of sticking sliders and closed stops, with a search along the energy; two refinements
/// of the last solution. Loads are taken just before t = 0: a table that jumps there is released.
/// Where there are other laws, see grow_equilibrium().
/// @param held  coordinates with their values, each once
StaticEquilibrium find_equilibrium(const system::LocallyNonlinear& system, std::span<const model::Held> held);

}  // namespace rubato::integrate
