#include <rubato/steady/assembled_stiffness.hpp>
#include <rubato/steady/stuck_offsets.hpp>

#include <Eigen/QR>
#include <Eigen/SparseCholesky>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rubato::steady {
namespace {

constexpr Index largest_full = 300;  // rows of a singular stiffness that is worth a full factorisation

/// The columns of (K + the springs of those that stick)^-1 b [n x those that stick] [m/N]: moved by -D o the structure
/// bears offsets that are larger by o at the same forces of all others. Of least norm where motions remain that nothing
/// holds; empty where such a structure is large.
Matrix ways_of_offsets(const system::LocallyNonlinear& system, const StuckOffsets& offsets) {
  const Index n = system.size(), count = static_cast<Index>(offsets.sliders.size());
  StuckSliders stuck(system.sliders().size(), false);
  Matrix ends = Matrix::Zero(n, count);
  for (Index a = 0; a < count; ++a) {
    const auto i = static_cast<std::size_t>(offsets.sliders[static_cast<std::size_t>(a)]);
    const auto& slider = system.sliders()[i];
    stuck[i] = true;
    if (slider.first != ground) ends(slider.first, a) += 1.0;
    if (slider.second != ground) ends(slider.second, a) -= 1.0;
  }
  const SparseMatrix stiffness = stiffness_with(system, stuck);
  const Eigen::SimplicialLDLT<SparseMatrix> factor(stiffness);
  const double round_off = 4.0 * static_cast<double>(n) * std::numeric_limits<double>::epsilon();
  if (factor.info() == Eigen::Success) {
    const Vector diagonal = factor.permutationP() * Vector(stiffness.diagonal());
    if ((factor.vectorD().array() > round_off * diagonal.array()).all()) {
      const Matrix ways = factor.solve(ends);
      if (ways.allFinite()) return ways;
    }
  }
  if (n > largest_full) return {};
  const Matrix ways = Matrix(stiffness).completeOrthogonalDecomposition().solve(ends);
  return ways.allFinite() ? ways : Matrix();
}

/// x with low <= A (wanted + x) <= high in all rows, x_i > 0 only where the lower bound is reached and x_i < 0 only
/// where the upper one is (C. L. Lawson, R. J. Hanson, Solving Least Squares Problems, 1974, chapter 23). A symmetric
/// and positive semi-definite.
Vector corrections(const Matrix& a, const Vector& wanted, const Vector& low, const Vector& high, const Vector& slack) {
  const Index count = a.rows();
  Vector x = Vector::Zero(count);
  std::vector<Index> active;
  std::vector<bool> is_active(static_cast<std::size_t>(count), false);
  Vector side = Vector::Zero(count);
  for (Index round = 0; round < 10 * count + 10; ++round) {
    const Vector reached = a * (wanted + x);
    Index worst = -1;
    double excess = 1.0;
    for (Index i = 0; i < count; ++i) {
      const double by = std::max(low[i] - reached[i], reached[i] - high[i]) / slack[i];
      if (is_active[static_cast<std::size_t>(i)] || !(by > excess)) continue;
      worst = i;
      excess = by;
    }
    if (worst < 0) break;
    side[worst] = reached[worst] < low[worst] ? 1.0 : -1.0;
    active.push_back(worst);
    is_active[static_cast<std::size_t>(worst)] = true;
    while (!active.empty()) {
      const auto size = static_cast<Index>(active.size());
      Matrix part(size, size);
      Vector goal(size);
      for (Index r = 0; r < size; ++r) {
        const Index i = active[static_cast<std::size_t>(r)];
        goal[r] = (side[i] > 0.0 ? low[i] : high[i]) - a.row(i).dot(wanted);
        for (Index c = 0; c < size; ++c) part(r, c) = a(i, active[static_cast<std::size_t>(c)]);
      }
      const Vector target = part.completeOrthogonalDecomposition().solve(goal);
      // As far along the way as all keep their signs; those that lose them are let go.
      double share = 1.0;
      for (Index r = 0; r < size; ++r) {
        const Index i = active[static_cast<std::size_t>(r)];
        if (side[i] * target[r] <= 0.0) share = std::min(share, x[i] == 0.0 ? 0.0 : x[i] / (x[i] - target[r]));
      }
      bool lets_go = false;
      std::vector<Index> kept;
      for (Index r = 0; r < size; ++r) {
        const Index i = active[static_cast<std::size_t>(r)];
        x[i] += share * (target[r] - x[i]);
        if (side[i] * target[r] <= 0.0 && side[i] * x[i] <= 1e-14 * std::abs(target[r])) {
          x[i] = 0.0;
          is_active[static_cast<std::size_t>(i)] = false;
          lets_go = true;
        } else {
          kept.push_back(i);
        }
      }
      active = kept;
      if (!lets_go) break;
    }
  }
  return x;
}

}  // namespace

void StuckOffsets::add(Index slider, double stiffness, double least, double most, double offset_now,
                       double offset_wanted) {
  sliders.push_back(slider);
  offset.push_back(offset_now);
  wanted.push_back(offset_wanted);
  lowest.push_back(stiffness * least + offset_now);
  highest.push_back(stiffness * most + offset_now);
}

OffsetShift shift_to_wanted_offsets(const system::LocallyNonlinear& system, const Vector& limits,
                                    const StuckOffsets& offsets, double margin) {
  const auto count = static_cast<Index>(offsets.sliders.size());
  const double least_move = 10.0 * margin;  // of the limit
  bool is_elsewhere = false;
  for (std::size_t a = 0; a < offsets.sliders.size(); ++a)
    is_elsewhere =
        is_elsewhere || std::abs(offsets.wanted[a] - offsets.offset[a]) > least_move * limits[offsets.sliders[a]];
  if (!is_elsewhere) return {};
  const Matrix ways = ways_of_offsets(system, offsets);
  if (ways.size() == 0) return {};

  // Offsets and displacements times the square root of the stiffness: I - sqrt(k) C sqrt(k), eigenvalues of 0 to 1.
  Vector root(count), limit(count), wanted(count), low(count), high(count);
  for (Index a = 0; a < count; ++a) {
    const auto k = static_cast<std::size_t>(a);
    limit[a] = limits[offsets.sliders[k]];
    root[a] = std::sqrt(system.sliders()[static_cast<std::size_t>(offsets.sliders[k])].stiffness);
    wanted[a] = (offsets.wanted[k] - offsets.offset[k]) / root[a];
    const double inside = limit[a] * (1.0 - margin);
    low[a] = (-inside - offsets.lowest[k]) / root[a];
    high[a] = (inside - offsets.highest[k]) / root[a];
    if (low[a] > high[a]) low[a] = high[a] = 0.5 * (low[a] + high[a]);
  }
  Matrix force_by_offset = Matrix::Identity(count, count);
  for (Index a = 0; a < count; ++a)
    for (Index b = 0; b < count; ++b)
      force_by_offset(a, b) -=
          root[a] * system.relative_displacement(offsets.sliders[static_cast<std::size_t>(a)], ways.col(b)) * root[b];
  const Vector slack = margin * limit.cwiseQuotient(root);
  const Vector changes = wanted + corrections(force_by_offset, wanted, low, high, slack);

  OffsetShift shift;
  shift.offset = changes.cwiseProduct(root);
  if ((shift.offset.array().abs() <= least_move * limit.array()).all()) return {};
  shift.displacement = -(ways * shift.offset);
  shift.force = root.cwiseProduct(force_by_offset * changes);
  return shift;
}

}  // namespace rubato::steady
