#pragma once

#include <rubato/numerics/eigen_symmetric.hpp>
#include <rubato/steady/harmonic_balance/condensed_structure.hpp>

// The routes of CondensedStructure; nobody else includes this.
namespace rubato::steady {

struct CondensedStructure::Columns {
  const system::LocallyNonlinear& system;
  Vector slider_stiffness;   ///< [m]
  Vector holding_stiffness;  ///< of the springs that may be put into Z [m]
  Matrix sliders, loads;     ///< B [n x m], E [n x e]
  std::vector<SteadyRequest::Observed> observed;
  Index driven() const { return sliders.cols() + loads.cols(); }  ///< columns that carry forces
  Index count() const { return driven() + static_cast<Index>(observed.size()); }
  /// B diag(holding_stiffness) B^T
  SparseMatrix holding_springs() const {
    const SparseMatrix columns = sliders.sparseView();
    return columns * holding_stiffness.asDiagonal() * SparseMatrix(columns.transpose());
  }
  /// P^T x for x [n x any]
  template <class Dense>
  auto project(const Dense& x) const {
    Eigen::Matrix<typename Dense::Scalar, Eigen::Dynamic, Eigen::Dynamic> out(count(), x.cols());
    out.topRows(sliders.cols()) = sliders.transpose() * x;
    out.middleRows(sliders.cols(), loads.cols()) = loads.transpose() * x;
    for (std::size_t i = 0; i < observed.size(); ++i) {
      auto row = out.row(driven() + static_cast<Index>(i));
      row.setZero();
      observed[i].for_each([&](Index coordinate, double weight) { row += weight * x.row(coordinate); });
    }
    return out;
  }
};

struct CondensedStructure::Route {
  virtual ~Route() = default;
  virtual void set_loads() = 0;
  virtual Outcome condense(double w, double held, ComplexMatrix& receptance) = 0;
  virtual void expand(double w, double held, const ComplexVector& column_forces, ComplexVector& position) = 0;
  virtual double highest_frequency() const { return 0.0; }
  /// Entries of its sparse factor a row; 0: it has none.
  virtual double fill() const { return 0.0; }
  /// Whether it knows the structure at a frequency.
  virtual bool reaches(double /*w*/) const { return true; }
};

/// What counts as singular, as a fraction of the terms that cancel: round-off, and where a third of the digits are
/// gone.
inline constexpr double singular = 1e-13, nearly_singular = 1e-5;

/// Real modes Phi^T M Phi = 1 of the structure without sliders; null where they do not diagonalise C.
std::unique_ptr<CondensedStructure::Route> real_modes(const CondensedStructure::Columns& columns);
/// Modes in a basis of vectors V [n x r], by the real modes V y of K and M in it and by V^T C V [r x r]; null where
/// they do not diagonalise C, nor state-space modes do.
std::unique_ptr<CondensedStructure::Route> modes_in_basis(const CondensedStructure::Columns& columns,
                                                          const Matrix& basis, const numerics::SymmetricModes& modes,
                                                          const Matrix& damping);
/// Modes of the state space; null where they are no good basis.
std::unique_ptr<CondensedStructure::Route> complex_modes(const CondensedStructure::Columns& columns);
/// Modes of a large structure in a basis of its answers to the columns, up to 64 times a frequency [rad/s] or as far as
/// few vectors give G within 1e-8.
std::unique_ptr<CondensedStructure::Route> reduced_modes(const CondensedStructure::Columns& columns, double highest);
/// Factorisation of Z, dense or sparse.
std::unique_ptr<CondensedStructure::Route> dense_factorisation(const CondensedStructure::Columns& columns);
std::unique_ptr<CondensedStructure::Route> sparse_factorisation(const CondensedStructure::Columns& columns);

}  // namespace rubato::steady
