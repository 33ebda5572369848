#include <rubato/steady/assembled_stiffness.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <initializer_list>

namespace rubato::steady {
namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;

SparseMatrix joint_pattern(std::initializer_list<const SparseMatrix*> matrices) {
  Triplets entries;
  const Index n = (*matrices.begin())->rows();
  for (const SparseMatrix* matrix : matrices)
    for (Index column = 0; column < matrix->outerSize(); ++column)
      for (SparseMatrix::InnerIterator entry(*matrix, column); entry; ++entry) {
        entries.emplace_back(entry.row(), column, 0.0);
        entries.emplace_back(column, entry.row(), 0.0);
      }
  for (Index i = 0; i < n; ++i) entries.emplace_back(i, i, 0.0);
  SparseMatrix pattern(n, n);
  pattern.setFromTriplets(entries.begin(), entries.end());
  return pattern;
}

// Adds explicit zeros so that the matrix has every entry of the pattern, in its order.
SparseMatrix on_pattern(const SparseMatrix& matrix, const SparseMatrix& pattern) {
  SparseMatrix result = pattern;
  for (Index column = 0; column < matrix.outerSize(); ++column)
    for (SparseMatrix::InnerIterator entry(matrix, column); entry; ++entry)
      result.coeffRef(entry.row(), column) += entry.value();
  return result;
}

}  // namespace

SparseMatrix springs_of(const system::LocallyNonlinear& system, const StuckSliders& stuck) {
  assert(static_cast<Index>(stuck.size()) == system.slider_count());
  Triplets entries;
  for (std::size_t i = 0; i < stuck.size(); ++i) {
    if (!stuck[i]) continue;
    const auto& slider = system.sliders()[i];
    if (slider.first != ground) entries.emplace_back(slider.first, slider.first, slider.stiffness);
    if (slider.second != ground) entries.emplace_back(slider.second, slider.second, slider.stiffness);
    if (slider.first == ground || slider.second == ground) continue;
    entries.emplace_back(slider.first, slider.second, -slider.stiffness);
    entries.emplace_back(slider.second, slider.first, -slider.stiffness);
  }
  SparseMatrix springs(system.size(), system.size());
  springs.setFromTriplets(entries.begin(), entries.end());
  return springs;
}

SparseMatrix stiffness_with(const system::LocallyNonlinear& system, const StuckSliders& stuck) {
  return SparseMatrix(system.stiffness() + springs_of(system, stuck));
}

AssembledStiffness::AssembledStiffness(const system::LocallyNonlinear& system, const SparseMatrix& springs) {
  const SparseMatrix pattern = joint_pattern({&system.stiffness(), &springs, &system.mass(), &system.damping()});
  stiffness_ = on_pattern(system.stiffness(), pattern);
  springs_ = on_pattern(springs, pattern);
  mass_ = on_pattern(system.mass(), pattern);
  damping_ = on_pattern(system.damping(), pattern);
  matrix_ = pattern.cast<Complex>();
  for (Index column = 0; column < pattern.cols(); ++column)
    for (Index p = pattern.outerIndexPtr()[column]; p < pattern.outerIndexPtr()[column + 1]; ++p)
      if (pattern.innerIndexPtr()[p] == column) diagonal_.push_back(p);
  scale_.resize(pattern.rows());
}

void AssembledStiffness::assemble(double angular_frequency, double held) {
  const double w = frequency_ = angular_frequency;
  held_ = held;
  const double *const k = stiffness_.valuePtr(), *const s = springs_.valuePtr();
  const double *const m = mass_.valuePtr(), *const c = damping_.valuePtr();
  Complex* const z = matrix_.valuePtr();
  for (Index p = 0; p < matrix_.nonZeros(); ++p) z[p] = {k[p] + held * s[p] - w * w * m[p], w * c[p]};
  for (Index i = 0; i < scale_.size(); ++i) {
    const Index p = diagonal_[static_cast<std::size_t>(i)];
    scale_[i] = std::abs(k[p] + held * s[p]) + w * w * std::abs(m[p]) + w * std::abs(c[p]);
  }
}

void AssembledStiffness::assemble_sizes(SparseMatrix& sizes) const {
  if (sizes.nonZeros() != stiffness_.nonZeros()) sizes = stiffness_;
  const double *const k = stiffness_.valuePtr(), *const s = springs_.valuePtr();
  const double *const m = mass_.valuePtr(), *const c = damping_.valuePtr();
  for (Index p = 0; p < sizes.nonZeros(); ++p)
    sizes.valuePtr()[p] =
        std::abs(k[p] + held_ * s[p]) + frequency_ * frequency_ * std::abs(m[p]) + frequency_ * std::abs(c[p]);
}

}  // namespace rubato::steady
