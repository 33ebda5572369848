#pragma once

#include <rubato/numerics/formula_swings.hpp>
#include <rubato/system/locally_nonlinear.hpp>

#include <vector>

namespace rubato::integrate {

/// How large a response the loads of a march promise, in the mass norm [m sqrt(kg)]; 0 without loads. What a law that
/// depends on time does at rest is a load. Each counts with its largest value at the displacement that it would hold on
/// the structure with its sliders stuck, which inertia and damping limit to what happens within the duration T:
///
///   q_j = (K + kT of the sliders + C/T + 2/T^2 M)^-1 w_j,   size^2 = sum of (max |law_j| |q_j|_M r_j)^2
///
/// A load that is faster than the shape q_j, of frequency omega_j, meets inertia: r_j = min(1, (omega_j/Omega)^2) for a
/// harmonic law, else the largest response from rest of an oscillator of that frequency, where it is below the static
/// one.
/// @param duration  of the march from t = 0 [s]
/// @param bounds    how loads swing (StepPlan): where samples of the whole march would pass over it
double size_under_loads(const system::LocallyNonlinear& system, double duration,
                        const std::vector<numerics::StepBound>& bounds = {});

}  // namespace rubato::integrate
