#include <rubato/core/complex.hpp>
#include <rubato/numerics/eigen_quadratic.hpp>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace rubato::numerics {

std::vector<QuadraticMode> quadratic_modes(const Vector& squares, const Matrix& damping) {
  const Index r = squares.size();
  std::vector<Index> stiff;  // coordinates with stiffness, whose w q is a state
  std::vector<QuadraticMode> modes;
  for (Index i = 0; i < r; ++i) {
    if (squares[i] != 0.0)
      stiff.push_back(i);
    else
      modes.push_back({0.0, Eigen::VectorXcd::Unit(r, i)});
  }
  const auto held = static_cast<Index>(stiff.size());
  Matrix first_order = Matrix::Zero(held + r, held + r);
  for (Index a = 0; a < held; ++a) {
    const Index i = stiff[static_cast<std::size_t>(a)];
    const double w = std::sqrt(std::abs(squares[i]));
    first_order(a, held + i) = w;
    first_order(held + i, a) = std::copysign(w, -squares[i]);
  }
  first_order.bottomRightCorner(r, r) = -damping;
  const Eigen::EigenSolver<Matrix> solver(first_order);
  if (solver.info() != Eigen::Success) return {};
  for (Index k = 0; k < held + r; ++k) {
    const Complex s = solver.eigenvalues()[k];
    if (s.imag() < 0.0) continue;
    const Eigen::VectorXcd state = solver.eigenvectors().col(k);
    QuadraticMode mode{s, Eigen::VectorXcd(r)};
    for (Index i = 0; i < r; ++i) mode.shape[i] = s == 0.0 ? Complex(0.0) : state[held + i] / s;
    for (Index a = 0; a < held; ++a) {
      const Index i = stiff[static_cast<std::size_t>(a)];
      mode.shape[i] = state[a] / std::sqrt(std::abs(squares[i]));
    }
    modes.push_back(std::move(mode));
  }
  std::stable_sort(modes.begin(), modes.end(), [](const QuadraticMode& a, const QuadraticMode& b) {
    return std::abs(a.eigenvalue) < std::abs(b.eigenvalue);
  });
  return modes;
}

}  // namespace rubato::numerics
