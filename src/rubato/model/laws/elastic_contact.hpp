#pragma once

#include <rubato/model/laws/block_law.hpp>

#include <memory>

namespace rubato::model {

/// Values of a contact with separation.
struct ContactValues {
  Index directions = 1;               ///< in which it rubs: 0, 1 or 2
  double tangential_stiffness = 0.0;  ///< kT > 0 where it rubs [N/m]
  double normal_stiffness = 0.0;      ///< kn > 0 [N/m]
  double friction_coefficient = 0.0;  ///< mu >= 0 [-]
  double gap = 0.0;                   ///< clearance at u = 0; negative: pressed by -kn gap there [m]
  double normal_damping = 0.0;        ///< cn >= 0 while closed [N s/m]
  double sliding_velocity = 0.0;      ///< V: V t is added to the first number along the plane [m/s]
};

/// Elastic Coulomb contact with separation. Of its numbers those along the plane come first, that across it is last and
/// is positive where the ends come nearer:
///
///   N = max(0, kn (n - gap))
///   stick   T = T0 + kT (u - u0), a vector     while |T| < mu N
///   slip    |T| = mu N, against du/dt + what turns T
///   open    T = 0, N = 0; it starts anew where it is when the ends meet again
///
/// In a step u and n go straight, and the force is followed exactly. What is allowed, |T| <= mu N, is a cone, which a
/// straight line leaves once at most; from there on T slips to the end of the step, and turns towards du. With N linear
/// and the angle a between T and du
///
///   tan(a/2) falls by the factor exp(-kT |du| / (mu L)),  L = (N_b - N_a)/ln(N_b/N_a)
///
/// (L is the logarithmic mean, N where it is constant), which is of second order in curved motions; cutting the trial
/// force off at mu N of the end, which is exact along a line, is of first order there. Where the ends meet within the
/// step the springs are stretched from there on only.
/// With a dashpot N = max(0, kn (n - gap) + cn dn/dt) while n > gap: it pushes as soon as the ends meet and never
/// pulls; where it would, the ends are open. In the step in which they meet it pushes with the share of the travel that
/// is beyond the gap, without which such a step may have no solution. Energy that is in kn where N comes to zero the
/// dashpot takes. Its memory is T [N].
std::shared_ptr<const BlockLaw> make_elastic_contact(const ContactValues& values);

}  // namespace rubato::model
