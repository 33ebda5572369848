#pragma once

#include <rubato/integrate/steady/excitation.hpp>

#include <vector>

namespace rubato::integrate {

/// A first guess of the periodic state at t = 0: the response to the fundamental load with each slider replaced by the
/// stiffness and damping that do the same for one harmonic (Masing loops; Griffin 1980), and the linear response to the
/// other harmonics and the static loads added. Offsets of the sliders are zero.
/// @param q, v  [n] [m], [m/s]   @param slider_force  [m] [N]
/// Returns false where the equations have no finite solution: a resonance without damping.
bool equivalent_linear_state(const system::LocallyNonlinear& system, const Excitation& excitation, Vector& q, Vector& v,
                             Vector& slider_force);

/// Whether the loads meet a resonance without damping of the structure without sliders, and give it more than friction
/// can take: of a motion with the shape phi and the amplitude a, pi a |phi^T f| a period against at most
/// 4 a sum_j |b_j^T phi| limit_j, with b_j^T x the displacement of slider j. The motion grows for ever then.
bool is_driven_beyond_friction(const system::LocallyNonlinear& system, const Excitation& excitation);

}  // namespace rubato::integrate
