#include <rubato/core/complex.hpp>
#include <rubato/numerics/eigen_unsymmetric.hpp>
#include <rubato/numerics/scaled_residual.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rubato::numerics {
namespace {

constexpr int most_iterations = 12;
constexpr double accurate = 1e-8;    // defect beyond which a mode is iterated
constexpr double settled = 1e-11;    // defect at which that ends
constexpr double acceptable = 1e-4;  // defect of a mode that may be returned
constexpr double same = 1e-8;        // relative distance of eigenvalues that may be one

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

struct Pencil {
  const Matrix &stiffness, &damping, &mass;

  Vector size(Complex s) const {
    return stiffness.diagonal().cwiseAbs() + std::abs(s) * damping.diagonal().cwiseAbs() +
           std::norm(s) * mass.diagonal();
  }
  Eigen::MatrixXcd at(Complex s) const {
    return stiffness.cast<Complex>() + s * damping.cast<Complex>() + s * s * mass.cast<Complex>();
  }
  ScaledResidual residual(const DampedMode& mode) const {
    return {size(mode.eigenvalue), Eigen::VectorXcd(at(mode.eigenvalue) * mode.shape), mode.shape};
  }
  double defect(const DampedMode& mode) const {
    const Complex s = mode.eigenvalue;
    const Eigen::VectorXcd k = stiffness * mode.shape, m = mass * mode.shape;
    const double energy = std::abs(mode.shape.dot(k)) + std::norm(s) * std::abs(mode.shape.dot(m));
    const Vector moduli = mode.shape.cwiseAbs();
    const double noise = 64.0 * static_cast<double>(mass.rows()) * std::numeric_limits<double>::epsilon() *
                         moduli.dot(stiffness.cwiseAbs() * moduli);
    // A motion that nothing resists has no energy to compare with; with damping its double root splits by round-off.
    return energy <= noise ? residual(mode).backward() : residual(mode).of_energy(energy);
  }
};

/// Newton's method for (K + s C + s^2 M) x = 0 with c^H x = 1, from what QR iteration left of a mode that is low beside
/// the highest: in s^2 without damping, where s = 0 would be a double root.
void refine(const Pencil& pencil, bool is_damped, DampedMode& mode) {
  DampedMode best = mode;
  for (int i = 0; i < most_iterations && pencil.defect(best) > settled; ++i) {
    const Complex s = mode.eigenvalue;
    Vector scale = pencil.size(s);
    for (double& one : scale) one = one > 0.0 ? 1.0 / std::sqrt(one) : 1.0;
    const Eigen::MatrixXcd slope =
        is_damped ? Eigen::MatrixXcd(2.0 * s * pencil.mass.cast<Complex>() + pencil.damping.cast<Complex>())
                  : Eigen::MatrixXcd(pencil.mass.cast<Complex>());
    const Eigen::MatrixXcd scaled = scale.asDiagonal() * pencil.at(s) * scale.asDiagonal();
    const Eigen::VectorXcd x = mode.shape, right = scale.asDiagonal() * Eigen::VectorXcd(slope * x);
    const Eigen::VectorXcd y = scale.asDiagonal() * Eigen::PartialPivLU<Eigen::MatrixXcd>(scaled).solve(right);
    const Complex step = x.squaredNorm() / x.dot(y);
    if (!y.allFinite() || !std::isfinite(std::abs(step))) break;
    Complex next = is_damped ? s - step : std::sqrt(s * s - step);
    if (next.imag() < 0.0) next = is_damped ? std::conj(next) : -next;
    mode = mode_of(next, y, pencil.mass);
    if (pencil.defect(mode) < pencil.defect(best)) best = mode;
  }
  mode = best;
}

bool is_same(const DampedMode& a, const DampedMode& b, const Matrix& mass) {
  const Eigen::VectorXcd heavy = mass * b.shape;
  return std::abs(a.eigenvalue - b.eigenvalue) <= same * std::abs(a.eigenvalue) &&
         std::abs(a.shape.dot(heavy)) > 1.0 - 1e-6;
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
  const Pencil pencil{stiffness, damping, mass};
  const bool is_damped = !c.isZero(0.0);
  bool is_refined = false;
  for (DampedMode& mode : result.modes) {
    if (pencil.defect(mode) <= accurate) continue;
    refine(pencil, is_damped, mode);
    is_refined = true;
  }
  for (std::size_t i = 0; i < result.modes.size(); ++i) {
    const DampedMode& mode = result.modes[i];
    result.residual = std::max(result.residual, pencil.residual(mode).backward());
    const double defect = pencil.defect(mode);
    result.defect = std::max(result.defect, defect);
    if (!(defect <= acceptable)) result.has_converged = false;
    // Two that came to one motion: the other one was lost.
    for (std::size_t j = 0; is_refined && j < i; ++j)
      if (is_same(result.modes[j], mode, mass)) result.has_converged = false;
  }
  if (is_refined)
    std::stable_sort(result.modes.begin(), result.modes.end(), [](const DampedMode& a, const DampedMode& b) {
      return a.angular_frequency < b.angular_frequency;
    });
  result.is_refined = is_refined;
  return result;
}

}  // namespace rubato::numerics
