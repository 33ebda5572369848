#pragma once

#include <rubato/model/laws/law.hpp>

#include <memory>

namespace rubato::model {

/// A spring kT in series with a Coulomb slip joint, |f| <= mu N, where N >= 0 is the normal force: a Jenkins element.
/// It takes a normal force; where that is not positive its ends are apart, its force is zero, and it starts anew where
/// it is when they meet again.
///
///   df/dt = kT du/dt while |f| < mu N;   |f| = mu N while it slips, by du/dt - (df/dt)/kT;   f = 0 where N <= 0
///
/// In a step u and what presses go from one end to the other in straight lines, and the force is followed exactly: the
/// forces that are allowed are then a convex part of the (f, time) plane, which a straight line leaves once at most and
/// along whose border slip goes on to the end, so that the return map, the trial force cut off at mu N of the end, is
/// the exact answer; where the ends meet within the step the spring is stretched from there on only.
/// Its memory is f [N].
/// @param stiffness             kT > 0 [N/m]
/// @param friction_coefficient  mu >= 0 [-]
std::shared_ptr<const Law> make_jenkins(double stiffness, double friction_coefficient);

/// A one-sided spring, f = max(0, k (u - gap)), as a law: what a stop without a damper is.
/// @param stiffness  k > 0 [N/m]
/// @param gap        [m]
std::shared_ptr<const Law> make_one_sided_spring(double stiffness, double gap);

}  // namespace rubato::model
