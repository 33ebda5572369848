#include <rubato/numerics/eigen_graded.hpp>

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace rubato::numerics {
namespace {

constexpr double unit = std::numeric_limits<double>::epsilon();
constexpr double safe_pivot = 64.0;   // in units of round-off: K with a smaller one is as good as singular
constexpr double first_shift = 1e-3;  // of the lowest frequency squared of a coordinate by itself
constexpr int most_shifts = 60;       // each ten times the one before
constexpr int most_sweeps = 40;       // four to ten are usual

// Powers of two next to 1/sqrt(M_ii): scaling by them loses no digit.
Vector scales_of(const Matrix& mass) {
  return mass.diagonal().unaryExpr([](double m) { return std::exp2(-std::round(0.5 * std::log2(m))); });
}

// B with B B^T = K, or nothing where K is not safely positive definite.
std::optional<Matrix> root_of(const Matrix& stiffness) {
  const Eigen::LDLT<Matrix> factor(stiffness);
  const Vector pivots = factor.vectorD();
  const Vector diagonal = factor.transpositionsP() * Vector(stiffness.diagonal());
  const double least = safe_pivot * unit * std::sqrt(static_cast<double>(pivots.size()));
  if (factor.info() != Eigen::Success || !(pivots.array() > least * diagonal.array()).all()) return std::nullopt;
  Matrix root = factor.matrixL();
  root = root * pivots.cwiseSqrt().asDiagonal();
  return Matrix(factor.transpositionsP().transpose() * root);
}

// K + s M with the smallest s that makes it safely positive definite, of a ladder.
std::optional<Matrix> shifted_root(const Matrix& stiffness, const Matrix& mass) {
  if (auto root = root_of(stiffness)) return root;
  const Vector own = stiffness.diagonal().cwiseAbs().cwiseQuotient(mass.diagonal());
  const double highest = own.maxCoeff();
  double shift = highest > 0.0 ? highest : 1.0;
  for (const double square : own)
    if (square > 0.0) shift = std::min(shift, first_shift * square);
  for (int i = 0; i < most_shifts; ++i, shift *= 10.0)
    if (auto root = root_of(stiffness + shift * mass)) return root;
  return std::nullopt;
}

// Turns two columns so that they are orthogonal, and returns whether they were not.
bool orthogonalise(Matrix& columns, Vector& squares, Index p, Index q, double tolerance) {
  const double product = columns.col(p).dot(columns.col(q));
  if (!(std::abs(product) > tolerance * std::sqrt(squares[p]) * std::sqrt(squares[q]))) return false;
  const double cotangent = 0.5 * (squares[q] - squares[p]) / product;
  const double t = std::copysign(1.0, cotangent) / (std::abs(cotangent) + std::hypot(1.0, cotangent));
  const double c = 1.0 / std::hypot(1.0, t), s = c * t;
  double* const a = columns.col(p).data();
  double* const b = columns.col(q).data();
  for (Index i = 0; i < columns.rows(); ++i) {
    const double first = a[i], second = b[i];
    a[i] = c * first - s * second;
    b[i] = s * first + c * second;
  }
  squares[p] = columns.col(p).squaredNorm();
  squares[q] = columns.col(q).squaredNorm();
  return true;
}

// Makes all columns orthogonal; false if they do not come to be.
bool orthogonalise(Matrix& columns) {
  const Index n = columns.cols();
  const double tolerance = unit * std::sqrt(static_cast<double>(n));
  Vector squares = columns.colwise().squaredNorm();
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    bool has_turned = false;
    for (Index p = 0; p + 1 < n; ++p)
      for (Index q = p + 1; q < n; ++q) has_turned = orthogonalise(columns, squares, p, q, tolerance) || has_turned;
    if (!has_turned) return true;
  }
  return false;
}

}  // namespace

std::optional<Matrix> graded_shapes(const Matrix& stiffness, const Matrix& mass) {
  const Index n = mass.rows();
  if (!(mass.diagonal().array() > 0.0).all()) return std::nullopt;
  const Vector scale = scales_of(mass);
  const Matrix m = scale.asDiagonal() * mass * scale.asDiagonal(),
               k = scale.asDiagonal() * stiffness * scale.asDiagonal();
  const Eigen::LLT<Matrix> factor(m);
  if (factor.info() != Eigen::Success) return std::nullopt;
  std::optional<Matrix> columns = shifted_root(k, m);
  if (!columns) return std::nullopt;
  factor.matrixL().solveInPlace(*columns);
  if (!columns->allFinite() || !orthogonalise(*columns)) return std::nullopt;
  const Vector lengths = columns->colwise().norm();
  std::vector<Index> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return lengths[a] < lengths[b]; });
  Matrix shapes(n, n);
  for (Index j = 0; j < n; ++j) {
    const Index from = order[static_cast<std::size_t>(j)];
    shapes.col(j) = columns->col(from) / lengths[from];
  }
  factor.matrixU().solveInPlace(shapes);
  return Matrix(scale.asDiagonal() * shapes);
}

}  // namespace rubato::numerics
