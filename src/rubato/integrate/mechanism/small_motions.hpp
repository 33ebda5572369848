#pragma once

#include <rubato/core/types.hpp>
#include <rubato/system/assembled_model.hpp>
#include <rubato/system/locally_nonlinear.hpp>

#include <string>
#include <vector>

namespace rubato::system {
class MechanismEquations;
}  // namespace rubato::system

namespace rubato::integrate {

/// A mechanism that moves a little about an equilibrium: a structure in the motions z [r] that its joints leave,
///
///   M z'' + C z' + K z + B f(B^T z) = N^T load,   dq = N z
///
/// with the geometric stiffness of what it carries there in K, and the laws f as they are, beside their rest, those of
/// contacts too: open, pressed, stuck, or at the limit of their friction. A stop that is a spring is such a law; one
/// that damps too is, while it holds, a spring and a damper, and other locks that hold are constraints. What it
/// observes are shares of z, from where it rests.
struct SmallMotions {
  /// A lock, and when the motion comes to it or leaves it.
  struct Watched {
    std::string name;   ///< of its joint
    double room = 0.0;  ///< how far s may go towards the lock, or away from it where it holds [m] or [rad]
    double sign = 1.0;  ///< of that way in s
    bool is_held = false, is_angle = false;
    bool is_damped_spring = false;  ///< without its damping it would be a law
    Vector share;                   ///< ds/dz [r]
  };

  system::LocallyNonlinear::Parts parts;  ///< without loads
  Matrix basis;                           ///< N [n x r]
  Matrix shares;  ///< of z in what results call the coordinates: of a rotation in space a rotation vector [n x r]
  Vector place;   ///< these coordinates at rest [n]
  std::vector<Watched> locks;
  /// Stops without stiffness that hold: taken for joints, though they only press.
  std::vector<std::string> rigid_stops;
  /// What a skew part of K is beyond round-off, over K: loads that follow their body have no potential [-]; 0: nothing.
  double skew = 0.0;
};

/// Linearises a mechanism about an equilibrium. K and C are made symmetric: `skew` says what that takes away. Throws
/// InvalidInput for a law whose slope is not finite there. Friction of joints is left out.
/// @param rest  an equilibrium at rest, with its multipliers, locks and the memory of the laws
SmallMotions small_motions(system::MechanismEquations& equations, const system::State& rest);

/// The structure, whose parts are taken, under loads on z.
system::AssembledModel under_loads(SmallMotions& motions, std::vector<system::ModelLoad> loads);

}  // namespace rubato::integrate
