#pragma once

#include <rubato/model/finite_elements/reduction.hpp>
#include <rubato/numerics/ordered_factor.hpp>

#include <optional>

// Private to the model floor.
namespace rubato::model {

/// Modes and static shapes of a structure whose interface b stays as it is, and the error of frequencies in such a
/// basis.
///
///   x_i = Psi x_b + X eta,   Psi = -K_ii^-1 K_ib,   X^T M_ii X = 1,   X^T K_ii X = diag(omega^2)
///
/// X are the lowest modes of K_ii, M_ii (Craig and Bampton), or what free modes Phi are beside the statics of the
/// interface, Phi_i - Psi Phi_b: together with Psi they span free modes and attachment vectors K^-1 e_b (Rubin). Shapes
/// K_ii^-1 f_i under given loads may be added.
class ComponentModes {
 public:
  /// @param kept    the interface, rising
  /// @param loads   on all coordinates, whose static shapes are added [n x k]
  ComponentModes(const SparseMatrix& stiffness, const SparseMatrix& mass, std::vector<Index> kept, Matrix loads);

  /// False where the rest moves freely with the interface held, or gives way.
  bool is_held() const { return is_held_; }
  Index rest() const { return static_cast<Index>(rest_.size()); }
  const std::vector<Index>& rest_places() const { return rest_; }
  const Matrix& static_shapes() const { return static_shapes_; }

  /// Finds at least so many modes. Returns false where they were not found.
  bool find(ReductionMethod method, Index count);
  /// Takes the first so many, with the shapes under loads.
  void take(Index count);
  const Matrix& shapes() const { return shapes_; }
  Index statics() const { return statics_; }
  /// omega^2 of the first mode with the interface held that was not taken; 0: none is left.
  double next() const { return next_; }

  /// T^T A T of a matrix of the structure [b + n x b + n].
  Matrix reduced(const SparseMatrix& matrix) const;

  /// The lowest frequencies of the reduced structure with their errors,
  ///
  ///   (lambda - lambda_true) / (2 lambda) = r^T K_ii^-1 r / (2 lambda (1 - lambda / mu)),   r = (K - lambda M) x
  ///
  /// on the rest, with x^T M x = 1 and mu the next of the modes with the interface held, or, of free modes, the
  /// Rayleigh quotient of K_ii^-1 r.
  /// @param stiffness  reduced, perhaps with springs between coordinates of the interface [b + n x b + n]
  /// @param mass       reduced
  std::vector<FrequencyEstimate> estimates(const Matrix& stiffness, const Matrix& mass, Index count) const;

 private:
  void add_loads();
  void make_orthonormal();

  const SparseMatrix &stiffness_, &mass_;
  std::vector<Index> kept_, rest_;
  SparseMatrix k_ii_, k_ib_, m_ii_, m_ib_;
  numerics::OrderedFactor factor_;
  bool is_held_ = false;
  Matrix static_shapes_, load_shapes_;
  ReductionMethod method_ = ReductionMethod::craig_bampton;
  Matrix found_;    // modes found: of the rest, with the interface held; or of free modes beside the statics
  Vector squares_;  // with the interface held
  Matrix shapes_;
  double next_ = 0.0;
  Index statics_ = 0;
};

}  // namespace rubato::model
