#include <rubato/numerics/eigen_unsymmetric.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rubato::numerics {
namespace {

using Complex = std::complex<double>;

/// Of a real shape with its sign the entry of the largest modulus is positive; of a complex one real and positive.
DampedMode mode_of(Complex s, Eigen::VectorXcd shape, const Matrix& mass) {
  DampedMode mode;
  mode.eigenvalue = s;
  mode.angular_frequency = std::abs(s);
  mode.damping_ratio = s == 0.0 ? 0.0 : -s.real() / std::abs(s);
  Index largest = 0;
  shape.cwiseAbs().maxCoeff(&largest);
  const Eigen::VectorXcd heavy = mass * shape;
  shape *= std::conj(shape[largest]) / std::abs(shape[largest]) / std::sqrt(shape.dot(heavy).real());
  mode.is_complex = shape.imag().cwiseAbs().maxCoeff() > 1e-9 * shape.cwiseAbs().maxCoeff();
  mode.shape = std::move(shape);
  return mode;
}

double residual_of(const DampedMode& mode, const Matrix& stiffness, const Matrix& damping, const Matrix& mass) {
  const Complex s = mode.eigenvalue;
  const Eigen::VectorXcd k = stiffness * mode.shape, c = s * (damping * mode.shape), m = s * s * (mass * mode.shape);
  const double terms = k.cwiseAbs().maxCoeff() + c.cwiseAbs().maxCoeff() + m.cwiseAbs().maxCoeff();
  return terms > 0.0 ? (k + c + m).cwiseAbs().maxCoeff() / terms : 0.0;
}

}  // namespace

DampedModes lowest_unsymmetric_modes(const Matrix& stiffness, const Matrix& damping, const Matrix& mass, Index count) {
  const Index n = mass.rows();
  const Eigen::LLT<Matrix> factor(mass);
  const auto lower = factor.matrixL();
  const auto scaled = [&](const Matrix& matrix) -> Matrix {
    const Matrix left = lower.solve(matrix);
    return lower.solve(left.transpose()).transpose();
  };
  const Matrix k = scaled(stiffness), c = scaled(damping);
  DampedModes result;
  const auto add = [&](Complex s, const Eigen::VectorXcd& x) {
    const Eigen::VectorXcd shape = factor.matrixU().solve(x);
    result.modes.push_back(mode_of(s, shape, mass));
  };
  if (c.isZero(0.0)) {  // s^2 = -square: no more than n values, and sharper ones
    const Eigen::EigenSolver<Matrix> solver(k);
    result.has_converged = solver.info() == Eigen::Success;
    const double round_off =
        16.0 * static_cast<double>(n) * std::numeric_limits<double>::epsilon() * k.cwiseAbs().maxCoeff();
    for (Index i = 0; i < n && result.has_converged; ++i) {
      Complex square = solver.eigenvalues()[i];
      if (std::abs(square.imag()) <= round_off) square = square.real();
      if (std::abs(square) <= round_off) square = 0.0;
      const Complex s = std::sqrt(-square);
      add(s.imag() < 0.0 ? -s : s, solver.eigenvectors().col(i));
      // Two that flutter at one frequency: one grows, and one dies away.
    }
  } else {
    Matrix first_order = Matrix::Zero(2 * n, 2 * n);
    first_order.topRightCorner(n, n).setIdentity();
    first_order.bottomLeftCorner(n, n) = -k;
    first_order.bottomRightCorner(n, n) = -c;
    const Eigen::EigenSolver<Matrix> solver(first_order);
    result.has_converged = solver.info() == Eigen::Success;
    for (Index i = 0; i < 2 * n && result.has_converged; ++i) {
      const Complex s = solver.eigenvalues()[i];
      if (s.imag() >= 0.0) add(s, solver.eigenvectors().col(i).head(n));
    }
  }
  std::stable_sort(result.modes.begin(), result.modes.end(),
                   [](const DampedMode& a, const DampedMode& b) { return a.angular_frequency < b.angular_frequency; });
  if (static_cast<Index>(result.modes.size()) > count) result.modes.resize(static_cast<std::size_t>(count));
  for (const DampedMode& mode : result.modes)
    result.residual = std::max(result.residual, residual_of(mode, stiffness, damping, mass));
  return result;
}

}  // namespace rubato::numerics
