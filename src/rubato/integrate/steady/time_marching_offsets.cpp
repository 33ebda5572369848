#include <rubato/integrate/steady/assembled_stiffness.hpp>
#include <rubato/integrate/steady/time_marching_parts.hpp>

#include <Eigen/SparseCholesky>

#include <algorithm>
#include <cmath>
#include <vector>

// The offsets of sliders that never slip, at the end of a march that repeats.
namespace rubato::integrate {
namespace {

/// Moved by -D o the structure bears offsets that are larger by o at the same forces of all others: the columns of D
/// are (K + the springs of those that stick)^-1 b [n x those that stick] [m/N]. Zero where nothing holds the structure.
Matrix ways_of_offsets(const system::LocallyNonlinear& system, const StuckSliders& stuck) {
  const Index n = system.size(), count = std::count(stuck.begin(), stuck.end(), true);
  Matrix ends = Matrix::Zero(n, count);
  Index column = 0;
  for (std::size_t i = 0; i < stuck.size(); ++i) {
    if (!stuck[i]) continue;
    const auto& slider = system.sliders()[i];
    if (slider.first != ground) ends(slider.first, column) += 1.0;
    if (slider.second != ground) ends(slider.second, column) -= 1.0;
    ++column;
  }
  const Eigen::SimplicialLDLT<SparseMatrix> factor(stiffness_with(system, stuck));
  if (factor.info() != Eigen::Success || !(factor.vectorD().array() > 0.0).all()) return Matrix::Zero(n, count);
  const Matrix ways = factor.solve(ends);
  return ways.allFinite() ? ways : Matrix::Zero(n, count);
}

}  // namespace

// Puts the offsets of sliders that never slip to zero, or as near as they do not slip, and the structure to where it
// lies then: beside a slider far stiffer than itself it goes along, and the force hardly changes. Returns whether any
// was not.
bool TimeMarchingSolver::release_offsets(const Engine& engine, Index lane, const Excitation& excitation,
                                         const SteadyResponse& response, LaneArray& states) const {
  constexpr double round_off = 1e-9;  // of the limit
  constexpr int most_sweeps = 100;
  StuckSliders stuck(static_cast<std::size_t>(slider_stiffness_.size()), false);
  std::vector<Index> sliders;
  std::vector<double> offsets;
  bool any_offset = false;
  for (Index i = 0; i < slider_stiffness_.size(); ++i) {
    const double limit = excitation.limits[i], stiffness = slider_stiffness_[i];
    if (limit == 0.0) continue;
    // What slips in a motion that repeats slips to and fro, over more than twice its limit. One that creeps away from
    // its limit in the march is on the way to where it does not slip.
    const auto u = engine.records[static_cast<std::size_t>(lane)].displacement.row(i);
    const bool slips = response.slip_share[i] > 0.0;
    if (slips && stiffness * (u.maxCoeff() - u.minCoeff()) > 2.0 * limit) continue;
    stuck[static_cast<std::size_t>(i)] = true;
    sliders.push_back(i);
    offsets.push_back(slips ? -stiffness * states(engine.map->slip_start() + i, lane) : response.offset[i]);
    any_offset = any_offset || std::abs(offsets.back()) > round_off * limit;
  }
  if (!any_offset) return false;

  const auto count = static_cast<Index>(sliders.size());
  const Matrix ways = ways_of_offsets(system_, stuck);
  Matrix compliance(count, count);  // b_i^T D_j [m/N]
  Vector lowest(count), highest(count), offset(count);
  for (Index a = 0; a < count; ++a) {
    const Index i = sliders[static_cast<std::size_t>(a)];
    const auto u = engine.records[static_cast<std::size_t>(lane)].displacement.row(i);
    offset[a] = offsets[static_cast<std::size_t>(a)];
    lowest[a] = slider_stiffness_[i] * u.minCoeff() + offset[a];
    highest[a] = slider_stiffness_[i] * u.maxCoeff() + offset[a];
    for (Index b = 0; b < count; ++b) compliance(a, b) = system_.relative_displacement(i, ways.col(b));
  }
  Vector changes = Vector::Zero(count);
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    bool moves = false;
    for (Index a = 0; a < count; ++a) {
      const Index i = sliders[static_cast<std::size_t>(a)];
      const double limit = excitation.limits[i], stiffness = slider_stiffness_[i];
      const double force_by_offset = std::max(1.0 - stiffness * compliance(a, a), 1e-9);
      const double least = (-limit - lowest[a]) / force_by_offset, most = (limit - highest[a]) / force_by_offset;
      const double change = least <= most ? std::clamp(-offset[a], least, most) : 0.5 * (least + most);
      if (!(std::abs(change) > round_off * limit)) continue;
      moves = true;
      changes[a] += change;
      offset[a] += change;
      for (Index b = 0; b < count; ++b) {
        const double of_force = (a == b ? change : 0.0) -
                                slider_stiffness_[sliders[static_cast<std::size_t>(b)]] * compliance(b, a) * change;
        lowest[b] += of_force;
        highest[b] += of_force;
      }
    }
    if (!moves) break;
  }
  if (changes.isZero(0.0)) return false;
  engine.map->displace(-(ways * changes), states, lane);
  for (Index a = 0; a < count; ++a) {
    const Index i = sliders[static_cast<std::size_t>(a)];
    states(engine.map->slip_start() + i, lane) -= changes[a] / slider_stiffness_[i];
  }
  return true;
}

}  // namespace rubato::integrate
