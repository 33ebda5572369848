#pragma once

#include <rubato/numerics/eigen_symmetric.hpp>

#include <complex>
#include <vector>

namespace rubato::numerics {

/// A free motion q = Re(shape exp(eigenvalue t)) of M q'' + C q' + K q = 0.
struct DampedMode {
  /// s [1/s]. Of a pair the one with positive imaginary part; of an overdamped real mode the slower.
  std::complex<double> eigenvalue;
  double angular_frequency = 0.0;  ///< |s|, of a real mode omega with omega^2 = phi^T K phi [rad/s]
  /// -Re s / |s|; of a real mode phi^T C phi / (2 omega), which may exceed 1. 0 for a motion without stiffness. [-]
  double damping_ratio = 0.0;
  /// phi^H M phi = 1; the entry of the largest modulus is real and positive [n]
  Eigen::VectorXcd shape;
  bool is_complex = false;  ///< C couples it to others: its coordinates do not move in phase
  /// By how much the rounding of the entries of K may have changed angular_frequency^2 [rad2/s2].
  double round_off = 0.0;
};

struct DampedModes {
  std::vector<DampedMode> modes;  ///< by rising angular frequency
  double residual = 0.0;          ///< largest ScaledResidual::backward of s^2 M + s C + K on a mode [-]
  double defect = 0.0;            ///< largest ScaledResidual::of_energy: about the error of a shape [-]
  Index missing = 0;              ///< as in SymmetricModes, of the undamped modes
  bool has_converged = true;      ///< else the best found; no modes, and an infinite defect, where M is singular
  bool is_refined = false;  ///< large model: modes of the projection on the undamped ones, then iterated to round-off
};

/// The `count` lowest modes of a damped structure, symmetric M (positive definite), C and K [n x n].
///
/// In coordinates of the undamped modes (of which equal ones are turned so that C does not couple them) C decides:
/// modes that it does not couple are real, with their own damping ratio; the others are solved together, as the
/// eigenproblem of first order in (omega q, v). Real eigenvalues of coupled modes have no partner and are modes of
/// their own, with ratio 1.
///
/// Up to 400 coupled coordinates all modes take part, and the result is complete. Beyond, the undamped modes up to
/// twice as many as wanted span the motion; where C couples to others, each mode is then iterated on the full matrices
/// (inverse iteration with the quotient x^T (s^2 M + s C + K) x = 0; Parlett and Chen 1990) until s stands, as is each
/// coupled mode that its residual shows to be poor. That two of them are not the same is checked; that none between
/// them is missing is not.
/// @param terms  as of lowest_modes
DampedModes lowest_damped_modes(const SparseMatrix& stiffness, const SparseMatrix& damping, const SparseMatrix& mass,
                                Index count, const SparseMatrix* terms = nullptr);

}  // namespace rubato::numerics
