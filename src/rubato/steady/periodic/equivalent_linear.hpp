#pragma once

#include <rubato/system/excitation.hpp>

#include <vector>

namespace rubato::steady {

/// A first guess of the periodic state at t = 0: the response to the fundamental load with each slider replaced by the
/// stiffness and damping that do the same for one harmonic (Masing loops; Griffin 1980), and the linear response to the
/// other harmonics and the static loads added. Offsets of the sliders are zero.
/// @param q, v  [n] [m], [m/s]   @param slider_force  [m] [N]
/// Returns false where the equations have no finite solution: a resonance without damping.
bool equivalent_linear_state(const system::LocallyNonlinear& system, const system::Excitation& excitation, Vector& q,
                             Vector& v, Vector& slider_force);

}  // namespace rubato::steady
