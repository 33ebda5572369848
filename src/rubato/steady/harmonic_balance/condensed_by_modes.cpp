#include <rubato/steady/harmonic_balance/condensed_structure_routes.hpp>

#include <rubato/numerics/eigen_symmetric.hpp>
#include <rubato/numerics/scaled_residual.hpp>
#include <rubato/steady/trigonometric_series.hpp>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace rubato::steady {
namespace {

using Outcome = CondensedStructure::Outcome;
using Columns = CondensedStructure::Columns;

// What of a direction a column must see to be moved by it: well above the round-off of the modes.
constexpr double seen = 1e-9;

bool sees(const Matrix& seen_by_modes, Index from, Index count, Index mode) {
  for (Index i = from; i < from + count; ++i)
    if (std::abs(seen_by_modes(i, mode)) > seen * seen_by_modes.row(i).cwiseAbs().maxCoeff()) return true;
  return false;
}

/// sum over modes of (P^T phi) (P^T phi)^T / (omega^2 - w^2 + i w c)
class RealModes final : public CondensedStructure::Route {
 public:
  RealModes(const Columns& columns, Matrix shapes, Vector squares, Vector damping)
      : columns_(columns), shapes_(std::move(shapes)), squares_(std::move(squares)), damping_(std::move(damping)) {
    highest_ = squares_.maxCoeff();
    set_loads();
  }

  void set_loads() override { seen_ = columns_.project(shapes_); }

  Outcome condense(double w, double, ComplexMatrix& g) override {
    const Index p = seen_.rows(), driven = columns_.driven(), m = columns_.sliders.cols();
    g.resize(p, driven);
    g.setZero();
    Outcome outcome = Outcome::regular;
    for (Index r = 0; r < squares_.size(); ++r) {
      const double real = squares_[r] - w * w, imaginary = w * damping_[r];
      const double size = real * real + imaginary * imaginary, scale = std::max(squares_[r], w * w);
      if (!(size > nearly_singular * nearly_singular * scale * scale)) {
        const bool is_singular = !(size > singular * singular * scale * scale);
        if (sees(seen_, 0, m, r)) {
          outcome = is_singular ? Outcome::sliders_needed : std::max(outcome, Outcome::near_resonance);
          if (is_singular) return outcome;
        } else if (is_singular) {
          if (sees(seen_, m, columns_.loads.cols(), r)) return Outcome::resonance;
          continue;
        }
      }
      const Complex inverse(real / size, -imaginary / size);
      const double* const shape = seen_.data() + r * p;
      for (Index c = 0; c < driven; ++c) {
        const Complex factor = inverse * shape[c];
        Complex* const out = g.data() + c * p;
        for (Index i = 0; i < p; ++i) out[i] += factor * shape[i];
      }
    }
    return outcome;
  }

  void expand(double w, double, const ComplexVector& forces, ComplexVector& position) override {
    ComplexVector modal = seen_.topRows(columns_.driven()).transpose() * forces;
    for (Index r = 0; r < squares_.size(); ++r) {
      const Complex stiffness(squares_[r] - w * w, w * damping_[r]);
      modal[r] = std::abs(stiffness) > singular * std::max(squares_[r], w * w) ? modal[r] / stiffness : 0.0;
    }
    position = shapes_ * modal;
  }

  double highest_frequency() const override {
    double square = highest_;
    for (Index j = 0; j < columns_.sliders.cols(); ++j)
      square += columns_.slider_stiffness[j] * seen_.row(j).squaredNorm();
    return std::sqrt(square);
  }

 private:
  const Columns& columns_;
  Matrix shapes_;  ///< Phi [n x n]
  Vector squares_, damping_;
  double highest_ = 0.0;
  Matrix seen_;  ///< P^T Phi [p x n]
};

/// sum over state-space modes of (P^T phi) (P^T phi)^T / (i w - lambda), scaled so that [C M; M 0] becomes one.
class ComplexModes final : public CondensedStructure::Route {
 public:
  ComplexModes(const Columns& columns, ComplexMatrix shapes, ComplexVector roots)
      : columns_(columns), shapes_(std::move(shapes)), roots_(std::move(roots)) {
    highest_ = roots_.cwiseAbs().maxCoeff();
    set_loads();
  }

  void set_loads() override { seen_ = columns_.project(shapes_); }

  Outcome condense(double w, double, ComplexMatrix& g) override {
    const Index p = seen_.rows(), driven = columns_.driven();
    g.resize(p, driven);
    g.setZero();
    Outcome outcome = Outcome::regular;
    for (Index r = 0; r < roots_.size(); ++r) {
      const Complex distance = Complex(0.0, w) - roots_[r];
      // Which directions are singular is for the factorisation to say.
      if (!(std::abs(distance) > nearly_singular * std::max(w, std::abs(roots_[r]))) ||
          !(std::abs(distance) > 1e-9 * highest_))
        outcome = Outcome::sliders_needed;
      const Complex inverse = 1.0 / distance;
      const Complex* const shape = seen_.data() + r * p;
      for (Index c = 0; c < driven; ++c) {
        const Complex factor = product(inverse, shape[c]);
        Complex* const out = g.data() + c * p;
        for (Index i = 0; i < p; ++i) out[i] += product(factor, shape[i]);
      }
    }
    return outcome;
  }

  void expand(double w, double, const ComplexVector& forces, ComplexVector& position) override {
    ComplexVector modal = seen_.topRows(columns_.driven()).transpose() * forces;
    for (Index r = 0; r < roots_.size(); ++r) modal[r] /= Complex(0.0, w) - roots_[r];
    position = shapes_ * modal;
  }

  double highest_frequency() const override {
    double square = highest_ * highest_;
    const Matrix inverse_mass = Matrix(columns_.system.mass()).inverse();
    for (Index j = 0; j < columns_.sliders.cols(); ++j)
      square += columns_.slider_stiffness[j] * columns_.sliders.col(j).dot(inverse_mass * columns_.sliders.col(j));
    return std::sqrt(square);
  }

 private:
  const Columns& columns_;
  ComplexMatrix shapes_;  ///< the upper half of the state-space modes [n x 2n]
  ComplexVector roots_;
  double highest_ = 0.0;
  ComplexMatrix seen_;
};

}  // namespace

std::unique_ptr<CondensedStructure::Route> real_modes(const Columns& columns) {
  const numerics::SymmetricModes modes = numerics::all_modes(columns.system.stiffness(), columns.system.mass());
  if (!modes.has_converged) return nullptr;
  const Matrix& shapes = modes.shapes;
  const Matrix modal = shapes.transpose() * (columns.system.damping() * shapes);
  const Vector damping = modal.diagonal();
  const Matrix rest = modal - Matrix(damping.asDiagonal());
  // What is left out beside the diagonal is a change of C by this part of it, of the order of round-off.
  if (!(rest.cwiseAbs().maxCoeff() <= 1e-12 * damping.cwiseAbs().maxCoeff())) return nullptr;
  return std::make_unique<RealModes>(columns, shapes, modes.eigenvalues, damping);
}

namespace {

/// @param basis  vectors that the matrices are of [n x r]; null: the coordinates
std::unique_ptr<CondensedStructure::Route> complex_modes_of(const Columns& columns, const Matrix& mass,
                                                            const Matrix& damping, const Matrix& stiffness,
                                                            const Matrix* basis) {
  const Index n = mass.rows();
  Matrix state = Matrix::Zero(2 * n, 2 * n);
  const Eigen::PartialPivLU<Matrix> inverse(mass);
  state.topRightCorner(n, n).setIdentity();
  state.bottomLeftCorner(n, n) = -inverse.solve(stiffness);
  state.bottomRightCorner(n, n) = -inverse.solve(damping);
  const Eigen::EigenSolver<Matrix> modes(state);
  if (modes.info() != Eigen::Success) return nullptr;
  const ComplexVector roots = modes.eigenvalues();
  const ComplexMatrix vectors = modes.eigenvectors();
  // The left vectors are the rows of the inverse: no assumption on repeated roots.
  const Eigen::PartialPivLU<ComplexMatrix> left(vectors);
  if (!(left.rcond() > 1e-7)) return nullptr;
  ComplexMatrix input = ComplexMatrix::Zero(2 * n, n);
  input.bottomRows(n) = inverse.solve(Matrix::Identity(n, n)).cast<Complex>();
  const ComplexMatrix shares = left.solve(input);  // [2n x n]: of a force, into each mode
  ComplexMatrix shapes = vectors.topRows(n);
  // The iteration loses low roots in the round-off of high ones, where masses or stiffnesses are far apart.
  constexpr double acceptable = 1e-6;
  for (Index r = 0; r < 2 * n; ++r) {
    const Complex s = roots[r];
    const ComplexVector x = shapes.col(r), force = stiffness * x + s * (damping * x) + s * s * (mass * x);
    const Vector size =
        stiffness.diagonal().cwiseAbs() + std::abs(s) * damping.diagonal().cwiseAbs() + std::norm(s) * mass.diagonal();
    const double energy = std::abs(x.dot(stiffness * x)) + std::norm(s) * std::abs(x.dot(mass * x));
    if (!(numerics::ScaledResidual(size, force, x).of_energy(energy) <= acceptable)) return nullptr;
  }
  // Symmetric matrices make each share a multiple of the shape itself: fold its root into the shape.
  for (Index r = 0; r < 2 * n; ++r) {
    Index largest = 0;
    if (!(shapes.col(r).cwiseAbs().maxCoeff(&largest) > 0.0)) return nullptr;
    const Complex scale = shares(r, largest) / shapes(largest, r);
    if (!((shares.row(r).transpose() - scale * shapes.col(r)).cwiseAbs().maxCoeff() <=
          1e-11 * shares.row(r).cwiseAbs().maxCoeff()))
      return nullptr;
    shapes.col(r) *= std::sqrt(scale);
  }
  if (basis) shapes = (*basis * shapes).eval();
  return std::make_unique<ComplexModes>(columns, shapes, roots);
}

}  // namespace

std::unique_ptr<CondensedStructure::Route> complex_modes(const Columns& columns) {
  return complex_modes_of(columns, columns.system.mass(), columns.system.damping(), columns.system.stiffness(),
                          nullptr);
}

std::unique_ptr<CondensedStructure::Route> modes_in_basis(const Columns& columns, const Matrix& basis,
                                                          const numerics::SymmetricModes& modes,
                                                          const Matrix& reduced_damping) {
  const Matrix shapes = basis * modes.shapes;
  const Matrix modal = modes.shapes.transpose() * reduced_damping * modes.shapes;
  const Vector damping = modal.diagonal();
  const Matrix rest = modal - Matrix(damping.asDiagonal());
  const Vector size = damping.cwiseAbs().cwiseSqrt();
  // Beside the diagonal is the round-off of the basis: what it does to a response is as its square.
  const double round_off = 1e-12 * damping.cwiseAbs().maxCoeff();
  if ((rest.cwiseAbs().array() <= 1e-6 * (size * size.transpose()).array() + round_off).all())
    return std::make_unique<RealModes>(columns, shapes, modes.eigenvalues, damping);
  return complex_modes_of(columns, Matrix::Identity(size.size(), size.size()), modal, modes.eigenvalues.asDiagonal(),
                          &shapes);
}

}  // namespace rubato::steady
