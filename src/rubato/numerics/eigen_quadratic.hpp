#pragma once

#include <rubato/core/types.hpp>

#include <complex>
#include <vector>

namespace rubato::numerics {

struct QuadraticMode {
  std::complex<double> eigenvalue;  ///< s; of a conjugate pair the one with positive imaginary part [1/s]
  Eigen::VectorXcd shape;           ///< [r]
};

/// The solutions of (s^2 + s C + diag(omega^2)) x = 0 with full symmetric C, in modal coordinates: the eigenvalues of
///
///   d/dt (w q, v) = [0, w; -sign(omega^2) w, -C] (w q, v),   w = sqrt |omega^2|
///
/// whose norm is the highest frequency instead of its square. A coordinate without stiffness gives s = 0 and takes one
/// row less. By rising |s|, conjugate pairs once; empty if the iteration did not converge.
/// @param squares  omega^2 [r] [rad2/s2]   @param damping  C [r x r] [1/s]
std::vector<QuadraticMode> quadratic_modes(const Vector& squares, const Matrix& damping);

}  // namespace rubato::numerics
