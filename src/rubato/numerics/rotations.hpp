#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

// Rotations in space. A rotation vector is axis times angle [rad]; unit quaternions turn the axes of a body into those
// of the world, and increments are in body axes: R exp(increment).
namespace rubato::numerics {

using Rotation = Eigen::Quaterniond;  ///< of unit length
using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;

/// The matrix of v x: skew(v) w = v x w.
Matrix3 skew(const Vector3& v);

/// The rotation by |v| about v; to round-off for every v.
Rotation rotation_of(const Vector3& v);

/// The rotation vector of the shortest turn, |v| <= pi.
Vector3 vector_of(const Rotation& rotation);

/// T in  exp(v + dv) = exp(v) exp(T dv) + O(dv^2):  T = I - (1 - cos a)/a^2 skew(v) + (a - sin a)/a^3 skew(v)^2, a =
/// |v|.
Matrix3 tangent_of(const Vector3& v);

/// The inverse of tangent_of, for |v| < 2 pi:  I + skew(v)/2 + c(a) skew(v)^2,  c = (1 - (a/2) cot(a/2))/a^2.
Matrix3 inverse_tangent_of(const Vector3& v);

/// d(inverse_tangent_of(v)^T m)/dv for a constant m.
Matrix3 slope_of_transposed_inverse_tangent(const Vector3& v, const Vector3& m);

}  // namespace rubato::numerics
