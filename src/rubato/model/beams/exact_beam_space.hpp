#pragma once

#include <rubato/model/bodies/element.hpp>
#include <rubato/model/joints/space_point.hpp>

#include <array>
#include <memory>
#include <string>

namespace rubato::model {

/// What a cross-section of a beam in space resists with, in its axes: the first along the beam.
struct SpaceBeamSection {
  numerics::Vector3 force;   ///< E A, G A_y, G A_z [N]
  numerics::Vector3 moment;  ///< G J, E I_y, E I_z [N m2]
};

/// A two-noded beam in space, exact in rotations of any size (Simo and Vu-Quoc 1986) and objective: the relative
/// rotation of its ends is interpolated (Crisfield and Jelenic 1999). With sections R1, R2 at its ends, one integration
/// point and the reference length L:
///
///   psi = log(R1^T R2),   R = R1 exp(psi/2),   Gamma = R^T (x2 - x1)/L,   kappa = psi/L
///   U = L/2 ((Gamma - Gamma0) . C_N (Gamma - Gamma0) + (kappa - kappa0) . C_M (kappa - kappa0))
///
/// The straight rotation field between the ends makes the mean rotation's increment A1 d1 + A2 d2 with
/// A = (I -+ tan(|psi|/4)/|psi| skew(psi))/2. The ends must not turn against each other by pi or more.
/// @param first, second  nodes at their centre lines; the places of local coordinates are x, y, z, rx, ry, rz of each
/// @param q      all numbers of all nodes in the configuration without stress
/// @param axes1, axes2   section axes at the ends in that configuration, columns in the world
std::unique_ptr<Element> make_exact_beam_space(std::string name, const SpaceNode& first, const SpaceNode& second,
                                               const double* q, const numerics::Matrix3& axes1,
                                               const numerics::Matrix3& axes2, const SpaceBeamSection& section);

/// The viscous part of such a beam of a Kelvin-Voigt material, added to the elastic one: Gamma and kappa resist with
/// their stiffness times the retardation time [s] times their rates (Linn, Lang and Tuganov 2013).
std::unique_ptr<Element> make_viscous_beam_space(std::string name, const SpaceNode& first, const SpaceNode& second,
                                                 const double* q, const numerics::Matrix3& axes1,
                                                 const numerics::Matrix3& axes2, const SpaceBeamSection& section,
                                                 double retardation_time);

}  // namespace rubato::model
