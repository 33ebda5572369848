#pragma once

#include <rubato/steady/assembled_stiffness.hpp>
#include <rubato/system/excitation.hpp>
#include <rubato/system/state.hpp>

namespace rubato::steady {

/// The system with its laws in K and C, and without their forces at rest: smooth ones with their slopes at rest, those
/// of friction and contacts as they are in a limit of small motions, where everything that rubs sticks and all that may
/// touch is closed, or nothing rubs and contacts are closed where they are at rest. Its sliders stay.
system::LocallyNonlinear with_linear_laws(const system::LocallyNonlinear& system, bool stuck);

/// The state at phase zero of the linear response that is nearer to the response with friction: with all sliders stuck
/// and without force at rest, where that asks of no slider more than twice its limit, else without sliders. Its slider
/// forces are kT u, cut at the limits; other laws have their slopes at rest, and have then moved there from rest. Where
/// the linear response is not finite (a resonance without damping, a free structure under a static load) the state at
/// rest.
system::State nearer_linear_limit(const system::LocallyNonlinear& system, const system::Excitation& excitation);

/// Natural frequencies of both limits, all sliders removed and stuck and other laws as with_linear_laws() has them, one
/// limit after the other [rad/s]: all of them or, of large models, those up to `highest` where they can be counted.
Vector natural_frequencies(const system::LocallyNonlinear& system, double highest = 0.0);

}  // namespace rubato::steady
