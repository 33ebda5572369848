#include <rubato/numerics/eigen_symmetric.hpp>
#include <rubato/steady/linear/modal_stiffness.hpp>

#include <Eigen/LU>
#include <Eigen/SparseCholesky>

#include <cmath>

namespace rubato::steady {
namespace {

constexpr Index most_modes = 400;
constexpr Index most_residual_vectors = 200;
constexpr double reach = 2.0;          // modes up to so many times the highest frequency
constexpr double least_pivot = 1e-11;  // relative: K with a smaller one is as good as singular
constexpr double shift_share = 0.01;   // of the highest frequency squared: s where K is singular
constexpr int most_attempts = 6;
constexpr double dependent = 1e-8;  // of a vector left outside the basis: its round-off

}  // namespace

struct ModalStiffness::Workspace {
  Workspace(const system::LocallyNonlinear& system, const StuckSliders& stuck, double limit, double accepted)
      : stiffness(stiffness_with(system, stuck)),
        mass(system.mass()),
        damping(system.damping()),
        highest(limit),
        tolerance(accepted) {
    const double square = reach * reach * limit * limit;
    const auto needed = numerics::modes_below(stiffness, mass, square);
    if (!needed || *needed > most_modes || 3 * *needed > mass.rows()) return;
    shapes.resize(mass.rows(), 0);
    if (*needed > 0) {
      numerics::SymmetricModes modes = numerics::lowest_modes(stiffness, mass, *needed);
      if (!modes.has_converged || modes.missing != 0) return;
      shapes = std::move(modes.shapes);
      squares = std::move(modes.eigenvalues);
    }
    ratios = (shapes.transpose() * (damping * shapes)).diagonal();
    factor.compute(stiffness);
    if (!is_safely_positive(stiffness)) {
      shift = shift_share * limit * limit;
      const SparseMatrix shifted = stiffness + shift * mass;
      factor.compute(shifted);
      if (!is_safely_positive(shifted)) return;
    }
    basis.resize(mass.rows(), 0);
    for (Index j = 0; j < shapes.cols(); ++j) add(shapes.col(j));
    modes_in_basis = basis.cols();
    is_usable = true;
  }

  bool is_safely_positive(const SparseMatrix& matrix) const {
    if (factor.info() != Eigen::Success) return false;
    const Vector size = factor.permutationP() * Vector(matrix.diagonal());
    return (factor.vectorD().array() > least_pivot * size.array()).all();
  }

  // Joins a vector to the basis, orthonormal in M, unless it is in its span.
  void add(Vector v) {
    double size = std::sqrt(v.dot(mass * v));
    if (!(size > 0.0) || !std::isfinite(size)) return;
    v /= size;
    for (int pass = 0; pass < 2; ++pass) {  // twice is enough (Kahan)
      const Vector heavy = mass * v;
      v -= basis * (basis.transpose() * heavy);
      size = std::sqrt(v.dot(mass * v));
      if (!(size > dependent)) return;
      v /= size;
    }
    const Index p = basis.cols();
    basis.conservativeResize(Eigen::NoChange, p + 1);
    basis.col(p) = v;
    const auto extend = [&](Matrix& reduced, const SparseMatrix& full) {
      const Vector column = basis.transpose() * (full * v);
      reduced.conservativeResize(p + 1, p + 1);
      reduced.col(p) = column;
      reduced.row(p) = column.transpose();
    };
    extend(reduced_stiffness, stiffness);
    extend(reduced_mass, mass);
    extend(reduced_damping, damping);
  }

  void keep_only_modes() {
    basis.conservativeResize(Eigen::NoChange, modes_in_basis);
    for (Matrix* reduced : {&reduced_stiffness, &reduced_mass, &reduced_damping})
      reduced->conservativeResize(modes_in_basis, modes_in_basis);
  }

  ComplexVector in_basis(const Matrix& columns, const ComplexVector& y) const {
    ComplexVector x(columns.rows());
    x.real() = columns * y.real();
    x.imag() = columns * y.imag();
    return x;
  }
  ComplexVector onto(const Matrix& columns, const ComplexVector& x) const {
    ComplexVector y(columns.cols());
    y.real() = columns.transpose() * x.real();
    y.imag() = columns.transpose() * x.imag();
    return y;
  }

  ComplexVector project_and_solve(double omega, const ComplexVector& force) const {
    const ComplexMatrix s = assembled_stiffness(reduced_stiffness, reduced_mass, reduced_damping, omega);
    return in_basis(basis, Eigen::PartialPivLU<ComplexMatrix>(s).solve(onto(basis, force)));
  }

  // What the modes and the static stiffness answer to a residual.
  ComplexVector correction(double omega, const ComplexVector& residual) const {
    ComplexVector y = onto(shapes, residual);
    for (Index j = 0; j < y.size(); ++j)
      y[j] *= 1.0 / Complex(squares[j] - omega * omega, omega * ratios[j]) - 1.0 / (squares[j] + shift);
    ComplexVector z = in_basis(shapes, y);
    z.real() += factor.solve(residual.real());
    z.imag() += factor.solve(residual.imag());
    return z;
  }

  SparseMatrix stiffness, mass, damping;
  double highest, tolerance, shift = 0.0;
  bool is_usable = false;
  Matrix shapes;
  Vector squares, ratios;
  Eigen::SimplicialLDLT<SparseMatrix> factor;
  Matrix basis, reduced_stiffness, reduced_mass, reduced_damping;
  Index modes_in_basis = 0;
};

ModalStiffness::ModalStiffness(const system::LocallyNonlinear& system, const StuckSliders& stuck, double highest,
                               double tolerance)
    : work_(std::make_unique<Workspace>(system, stuck, highest, tolerance)) {}
ModalStiffness::~ModalStiffness() = default;
ModalStiffness::ModalStiffness(ModalStiffness&&) noexcept = default;
ModalStiffness& ModalStiffness::operator=(ModalStiffness&&) noexcept = default;

bool ModalStiffness::is_usable() const { return work_->is_usable; }
Index ModalStiffness::mode_count() const { return work_->shapes.cols(); }
void ModalStiffness::forget() { work_->keep_only_modes(); }

Index ModalStiffness::basis_size() const { return work_->basis.cols(); }

std::optional<StiffnessSolution> ModalStiffness::solve(double angular_frequency, const ComplexVector& force,
                                                       ComplexVector& x) {
  Workspace& w = *work_;
  const double omega = angular_frequency;
  if (!w.is_usable || !(omega <= w.highest)) return std::nullopt;
  if (force.cwiseAbs().maxCoeff() == 0.0) {
    x = ComplexVector::Zero(force.size());
    return StiffnessSolution{0.0, x};
  }
  for (int attempt = 0; attempt < most_attempts; ++attempt) {
    if (w.basis.cols() > 0)
      x = w.project_and_solve(omega, force);
    else
      x = ComplexVector::Zero(force.size());
    const ComplexVector residual =
        force - w.stiffness * x + omega * omega * (w.mass * x) - Complex(0.0, omega) * (w.damping * x);
    ComplexVector z = w.correction(omega, residual);
    if (!z.allFinite() || !x.allFinite()) return std::nullopt;
    const double size = x.cwiseAbs().maxCoeff();
    if (z.cwiseAbs().maxCoeff() <= w.tolerance * size) {
      const double scale = (w.stiffness.cwiseAbs() * x.cwiseAbs()).maxCoeff() + force.cwiseAbs().maxCoeff();
      return StiffnessSolution{residual.cwiseAbs().maxCoeff() / scale, std::move(z)};
    }
    if (w.basis.cols() - w.shapes.cols() >= most_residual_vectors) return std::nullopt;
    w.add(z.real());
    w.add(z.imag());
  }
  return std::nullopt;
}

}  // namespace rubato::steady
