#pragma once

#include <rubato/core/types.hpp>

#include <cstdint>

namespace rubato::model {

using Axis = Eigen::Vector3d;
/// At most two nodes of six degrees of freedom; lives on the stack.
using LineMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 12, 12>;

/// What a beam or a truss is made of. Local axes: x from the first node to the second, y and z the principal axes of
/// the section.
struct LineProperties {
  enum class Kind { beam, truss };
  Kind kind = Kind::beam;
  bool lumped_mass = false;
  double young = 0.0;                             ///< E [Pa]
  double shear_modulus = 0.0;                     ///< G [Pa]; 0 where nothing needs it
  double density = 0.0;                           ///< [kg/m3]
  double retardation_time = 0.0;                  ///< of a Kelvin-Voigt material: damping = this times stiffness [s]
  double area = 0.0;                              ///< A [m2]
  double inertia_y = 0.0, inertia_z = 0.0;        ///< second moments about y and z [m4]; the plane has z only
  double torsion = 0.0;                           ///< torsion constant J [m4], space only
  double shear_area_y = 0.0, shear_area_z = 0.0;  ///< kappa A for shear along y and z [m2]; 0: Euler-Bernoulli
  /// Bit i: degree of freedom i of a beam, in its local axes and counted as in local_matrices, is not shared with the
  /// node.
  std::uint16_t released = 0;

  bool operator==(const LineProperties&) const = default;
};

/// Ratio of bending to shear flexibility, phi = 12 E I / (kappa A G L^2) [-]; 0 without shear deformation.
double shear_parameter(double young, double inertia, double shear_modulus, double shear_area, double length);

/// Bending in one plane: 4 x 4 matrices over (deflection, rotation) of both ends, rotation = d deflection / dx + shear.
struct Bending {
  Eigen::Matrix4d stiffness, mass;
};

/// Stiffness with the exact static shape functions and the consistent mass that goes with them, translational and (with
/// shear) rotary (Przemieniecki, Theory of Matrix Structural Analysis, 1968, sections 5.6 and 11.3). Euler-Bernoulli
/// where phi = 0 and `rotary_inertia` = 0. With `lumped` the mass is diagonal: half the mass at each end, and for the
/// rotations the diagonal of the translational matrix on the same scale (Hinton, Rock and Zienkiewicz 1976; m L^2 / 78
/// without shear) plus half of the rotary inertia.
/// @param bending_stiffness  E I [N m2]
/// @param phi                shear parameter [-]
/// @param mass_per_length    rho A [kg/m]
/// @param rotary_inertia     rho I, mass moment of inertia per length [kg m]
Bending bending_of(double bending_stiffness, double phi, double mass_per_length, double rotary_inertia, double length,
                   bool lumped);

/// Matrices in the local axes, over the degrees of freedom of both ends:
///
///   beam:  x, y, rz in the plane; x, y, z, rx, ry, rz in space      truss:  x, y; x, y, z
void local_matrices(const LineProperties& properties, int dimension, double length, LineMatrix& stiffness,
                    LineMatrix& mass);

/// Takes degrees of freedom out of the matrices of an element by static condensation: the element follows the others
/// without resistance there. With T the columns of the static shape (-K_rr^-1 K_rs over the identity),
///
///   K <- T^T K T,   M <- T^T M T
///
/// exact for the stiffness; the mass is that of the motion with the static shape, as consistent as the element's own
/// cubic (Guyan 1965; Irons 1965). Rows and columns of what is released become zero, and so does a stiffness that is
/// round-off of the terms that cancel in it.
/// @param released  bit i: row i
/// @return false, with the matrices as they were, where nothing resists a motion of what is released: a mechanism
bool release(std::uint16_t released, LineMatrix& stiffness, LineMatrix& mass);

/// The rows are the local axes in those of the model: x along `along`, z normal to x and `orientation` (of the plane:
/// the third axis). Neither vector needs unit length; they must not be parallel.
Eigen::Matrix3d local_axes(const Axis& along, const Axis& orientation);

/// matrix <- T^T matrix T for the rotation T from the axes of the model into the local ones: blocks of `dimension`
/// translations and, where `rotates`, rotations (one in the plane, three in space).
void turn_into_model_axes(const Eigen::Matrix3d& axes, int dimension, bool has_rotations, LineMatrix& matrix);

}  // namespace rubato::model
