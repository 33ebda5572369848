#pragma once

#include <rubato/integrate/steady/assembled_stiffness.hpp>

#include <memory>

namespace rubato::integrate {

/// What solving S x = f has shown.
struct StiffnessSolution {
  /// Backward error, max_i |f - S x|_i / (|K| |x| + omega^2 |M| |x| + omega |C| |x| + |f|)_i [-].
  double residual = 0.0;
  /// What round-off in K, M and C (one unit each) does to x, by one more solve: the error of each entry [n] [m]. At a
  /// resonance without damping it is as large as x itself.
  ComplexVector uncertainty;
};

/// S(omega) = K - omega^2 M + i omega C of a structure with some sliders stuck, and its solutions. Dense for small and
/// full matrices; else sparse L D L^T whose pattern is analysed once, with iterative refinement, and sparse LU with
/// pivoting at the frequencies where that does not reach round-off. A workspace: one a thread.
class DynamicStiffness {
 public:
  DynamicStiffness(const system::LocallyNonlinear& system, const StuckSliders& stuck);
  ~DynamicStiffness();
  DynamicStiffness(DynamicStiffness&&) noexcept;
  DynamicStiffness& operator=(DynamicStiffness&&) noexcept;

  Index size() const;
  /// Factorises S [n x n] at an angular frequency >= 0 [rad/s]; a singular matrix is made regular within round-off.
  void factorise(double angular_frequency);
  /// Solves S x = f at the frequency factorised last, and says how far x can be trusted.
  StiffnessSolution solve(const ComplexVector& force, ComplexVector& x);
  /// Entries of the factor a row; the size where it is dense.
  double fill() const;
  /// Factorisations so far that needed pivoting.
  long pivoted() const;

 private:
  struct Workspace;
  std::unique_ptr<Workspace> work_;
};

}  // namespace rubato::integrate
