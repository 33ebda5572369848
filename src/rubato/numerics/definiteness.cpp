#include <rubato/numerics/definiteness.hpp>

#include <cmath>
#include <limits>

namespace rubato::numerics {
namespace {

/// Whether v^T A v is negative beyond the round-off of its terms.
bool goes_downhill(const SparseMatrix& matrix, const Vector& motion) {
  constexpr double round_off = 16.0 * std::numeric_limits<double>::epsilon();
  const double terms = motion.cwiseAbs().dot(matrix.cwiseAbs() * motion.cwiseAbs());
  return motion.dot(matrix * motion) < -round_off * terms;
}

/// From a motion whose sum is almost zero one step of steepest descent leads below zero, unless it is a motion that
/// the matrix does not resist at all.
Vector descended(const SparseMatrix& matrix, const Vector& motion) {
  const Vector residual = matrix * motion, diagonal = matrix.diagonal().cwiseAbs();
  Vector step = residual;
  for (Index i = 0; i < step.size(); ++i)
    if (diagonal[i] > 0.0) step[i] /= diagonal[i];
  const double curvature = step.dot(matrix * step);
  return curvature > 0.0 ? Vector(motion - step.dot(residual) / curvature * step) : step;
}

}  // namespace

bool is_indefinite(const SparseMatrix& matrix, const OrderedFactor& factor) {
  const Vector pivots = factor.pivots();
  for (Index row = 0; row < pivots.size(); ++row) {
    if (!(pivots[row] < 0.0)) continue;
    // L^-T e_j, along which A comes to the pivot d_j.
    Vector eliminated = Vector::Zero(pivots.size()), motion(pivots.size());
    eliminated[factor.permuted(row)] = pivots[row];
    factor.backward(eliminated, [](Index, double) {});
    for (Index i = 0; i < motion.size(); ++i) motion[i] = eliminated[factor.permuted(i)];
    if (goes_downhill(matrix, motion) || goes_downhill(matrix, descended(matrix, motion))) return true;
  }
  return false;
}

bool is_indefinite(const SparseMatrix& matrix) {
  if (matrix.rows() == 0) return false;
  constexpr double shift = 1e-12;  // of the diagonal, where a pivot is zero
  const Vector diagonal = matrix.diagonal();
  const double largest = diagonal.cwiseAbs().maxCoeff();
  SparseMatrix whole = matrix;
  for (Index i = 0; i < diagonal.size(); ++i) whole.coeffRef(i, i) += 0.0;
  whole.makeCompressed();
  OrderedFactor factor;
  factor.analyse(whole);
  if (factor.factorise(whole, Pivots::nonzero)) return is_indefinite(matrix, factor);
  for (Index i = 0; i < diagonal.size(); ++i) {
    const double size = std::abs(diagonal[i]);
    whole.coeffRef(i, i) += shift * (size > 0.0 ? size : largest > 0.0 ? largest : 1.0);
  }
  return factor.factorise(whole, Pivots::nonzero) && is_indefinite(matrix, factor);
}

}  // namespace rubato::numerics
