#pragma once

#include <rubato/steady/assembled_stiffness.hpp>

#include <limits>
#include <memory>
#include <span>

namespace rubato::steady {

/// What solving S x = f has shown.
struct StiffnessSolution {
  /// Backward error, max_i |f - S x|_i / (|K| |x| + omega^2 |M| |x| + omega |C| |x| + |f|)_i [-].
  double residual = 0.0;
  /// What round-off in K, M and C (one unit each) does to x, by one more solve: the error of each entry [n] [m]. At a
  /// resonance without damping it is as large as x itself.
  ComplexVector uncertainty;
  /// Dampers resist x, by more than round-off: at no frequency is it a resonance without damping.
  bool is_damped = false;
};

/// Uncertainty over response from which the response counts as undetermined: round-off of the matrices changes its
/// third digit. Without damping that is a frequency within about 1e-12 of a resonance, relative.
inline constexpr double undetermined = 1e-3;
/// Part of the terms of a sum below which the sum is round-off of them.
inline constexpr double round_off_of_terms = 1e3 * std::numeric_limits<double>::epsilon();
/// To so much of its largest entries a free motion is known: what stands still in it seems to move that far.
inline constexpr double shape_error = 1e-10;

/// S(omega) = K - omega^2 M + i omega C of a structure with some sliders stuck, and its solutions. Dense for small and
/// full matrices; else sparse L D L^T whose pattern is analysed once, with iterative refinement, and sparse LU with
/// pivoting at the frequencies where that does not reach round-off. A workspace: one a thread.
class DynamicStiffness {
 public:
  DynamicStiffness(const system::LocallyNonlinear& system, const StuckSliders& stuck);
  /// With other springs [n x n] in the place of those of stuck sliders.
  /// @param last  rows to be eliminated last (see ComplexLdlt)
  DynamicStiffness(const system::LocallyNonlinear& system, const SparseMatrix& springs, std::span<const int> last = {});
  ~DynamicStiffness();
  DynamicStiffness(DynamicStiffness&&) noexcept;
  DynamicStiffness& operator=(DynamicStiffness&&) noexcept;

  Index size() const;
  /// Factorises S [n x n] at an angular frequency >= 0 [rad/s]; a singular matrix is made regular within round-off.
  /// @param held  part of the springs in S [-]
  void factorise(double angular_frequency, double held = 1.0);
  /// Solves S x = f at the frequency factorised last, and says how far x can be trusted.
  StiffnessSolution solve(const ComplexVector& force, ComplexVector& x);
  /// out = P^T S^-1 P [p x p] for sparse columns P [n x p], without refinement. False, with nothing done, where the
  /// factor at hand cannot condense (a dense one, or one with pivoting).
  bool condense(const SparseMatrix& columns, ComplexMatrix& out);
  /// Motions without resistance at the frequency factorised last: real phi, orthonormal in the units of the diagonal,
  /// with (K - w^2 M) phi = 0 and C phi = 0 but for round-off of the terms of either sum [n x any].
  Matrix free_motions();
  /// Entries of the factor a row; the size where it is dense.
  double fill() const;
  /// Factorisations so far that needed pivoting.
  long pivoted() const;

 private:
  struct Workspace;
  std::unique_ptr<Workspace> work_;
};

}  // namespace rubato::steady
