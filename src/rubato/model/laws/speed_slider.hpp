#pragma once

#include <rubato/model/laws/law.hpp>
#include <rubato/numerics/formula.hpp>

#include <memory>

namespace rubato::model {

/// A spring kT behind a slip joint whose coefficient of friction depends on the speed.
///
///   stick   f = f0 + kT (u - u0)     while |f| <= max(mu(0), mu(du/dt)) N
///   slip    |f| = mu(du/dt) N        while u - f/kT goes on in the direction of f
///   open    N <= 0: f = 0; it starts anew where it is when the ends meet again
///
/// While it slips mu is that of the rate of the ends, du/dt, not of the joint alone: a joint without a mass under
/// friction that falls with its own speed has no motion that is stable; and as at rest where the ends move against the
/// force. In a step u and N go straight, and the force at the end is the trial force cut off at the limit there; while
/// it slips its slope by the rate is that of mu N. Friction that falls with the speed feeds energy into what rubs.
///
/// Its memory is f [N], and 1 or -1 while it slips forwards or backwards.
/// @param stiffness    kT > 0 [N/m]
/// @param coefficient  mu >= 0, of the rate [m/s], the first of its further values
std::shared_ptr<const Law> make_speed_slider(double stiffness, numerics::Formula coefficient);

}  // namespace rubato::model
