#include <rubato/integrate/equilibrium/easiest_motion.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rubato::integrate {
namespace {

// A pivot that is small against the diagonal entry it came from raises the suspicion of a mechanism. A frame that turns
// freely leaves 2e-16 with 60 elements and 4e-10 with 33,000: elimination sums up roundings of ever stiffer elements.
constexpr double small_pivot = 1e-8;
// The motion that goes with it decides: its energy over the sum of the absolute terms of that energy. The same free
// frame has 1e-17 with any number of elements; well supported it has 1e-6 with 60 and 3e-12 with 33,000.
constexpr double no_energy = 16.0 * std::numeric_limits<double>::epsilon();
constexpr double shift = 1e-12;  // of the inverse iteration; larger ones leave bending in the motion of a fine mesh

Vector scale_of(const Vector& diagonal) {
  return diagonal.cwiseAbs().cwiseMax(shift * std::max(diagonal.cwiseAbs().maxCoeff(), 1.0));
}

}  // namespace

bool factorise_resisting(const SparseMatrix& matrix, numerics::Pivots pivots, numerics::OrderedFactor& factor,
                         int& factorisations, std::vector<Index>& moving) {
  const auto eliminate = [&](const SparseMatrix& of, numerics::Pivots allowed) {
    ++factorisations;
    return factor.factorise(of, allowed);
  };
  const bool has_factor = eliminate(matrix, pivots);
  const Vector diagonal = matrix.diagonal();
  if (has_factor && (factor.pivots().array().abs() > small_pivot * diagonal.array().abs()).all()) return true;
  // The motion of least resistance, by inverse iteration with the matrix shifted by a share of its diagonal.
  const Vector scale = scale_of(diagonal);
  SparseMatrix shifted = matrix;
  for (Index i = 0; i < scale.size(); ++i) shifted.coeffRef(i, i) += shift * scale[i];
  Vector motion(scale.size()), next;
  const bool has_shifted = eliminate(shifted, numerics::Pivots::nonzero);
  for (Index i = 0; i < motion.size(); ++i)  // meets every motion, and the same ones on every run
    motion[i] = (1.0 + 0.5 * std::sin(1.0 + 2.7 * static_cast<double>(i))) / std::sqrt(scale[i]);
  for (int iteration = 0; has_shifted && iteration < 4; ++iteration) {
    factor.solve(scale.cwiseProduct(motion), next);
    motion = next / next.cwiseAbs().maxCoeff();
  }
  const double energy = motion.dot(matrix * motion);
  const double terms = motion.cwiseAbs().dot(matrix.cwiseAbs() * motion.cwiseAbs());
  if (has_factor && energy > no_energy * terms && eliminate(matrix, pivots)) return true;
  moving.clear();
  // Metres and radians compare by the energy that moving one coordinate alone would take.
  const Vector share = scale.cwiseSqrt().cwiseProduct(motion.cwiseAbs());
  for (Index i = 0; i < share.size(); ++i)
    if (!(share[i] <= 1e-3 * share.maxCoeff())) moving.push_back(i);
  return false;
}

}  // namespace rubato::integrate
