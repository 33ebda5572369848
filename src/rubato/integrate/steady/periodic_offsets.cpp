#include <rubato/integrate/steady/periodic_solver.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

// The offsets of sliders that never slip.
namespace rubato::integrate {
namespace {

constexpr double offset_margin = 1e-10;  // by which a slider that never slips stays inside its limit
constexpr double stiffest = 1e-9;        // k/kT beside which a change of the offset is more than round-off

}  // namespace

// Sliders that never slip move towards the offset that is wanted, as far as they do not slip then.
bool PeriodicSolver::must_move_offsets(const Excitation& excitation) {
  bool moves = false;
  offset_shift_.setZero();
  if (half_) {
    centre_.setZero();
    return false;
  }
  for (Index i = 0; i < m_; ++i) {
    const double limit = excitation.limits[i], stiffness = system_.sliders()[static_cast<std::size_t>(i)].stiffness;
    double low = 0.0, high = 0.0;
    orbit_.displacement_range(i, low, high);
    centre_[i] = -0.5 * stiffness * (low + high);
    if (limit == 0.0 || orbit_.slips(i)) continue;
    const double offset = y_[2 * n_ + i] - stiffness * system_.relative_displacement(i, y_.head(n_));
    const double inside = limit * (1.0 - offset_margin);
    const double lowest = -inside - stiffness * low, highest = inside - stiffness * high;
    centre_[i] = offset;
    if (!(lowest < highest)) continue;
    const double shift = std::clamp(wanted_offset_[i], lowest, highest) - offset;
    if (!(std::abs(shift) > 10.0 * offset_margin * limit)) continue;
    moves = true;
    // The structure gives way under a change of the offset, so that more of it is allowed than at rest.
    const bool at_edge = wanted_offset_[i] < lowest || wanted_offset_[i] > highest;
    offset_shift_[i] = at_edge ? shift / force_by_offset(i) : shift;
    if (std::abs(offset_shift_[i]) > std::abs(wanted_offset_[i] - offset))
      offset_shift_[i] = wanted_offset_[i] - offset;
  }
  return moves;
}

// How much the force of a slider that never slips changes with its offset: k/(kT + k) beside a stiffness k.
double PeriodicSolver::force_by_offset(Index slider) {
  offset_probe_.setZero(m_);
  offset_probe_[slider] = 1.0;
  std::swap(offset_probe_, offset_shift_);
  difference_.swap(best_);
  difference_.setZero();
  factorise();
  const bool solved = correct();
  difference_.swap(best_);
  std::swap(offset_probe_, offset_shift_);
  return solved ? std::clamp(correction_[2 * n_ + slider], stiffest, 1.0) : 1.0;
}

}  // namespace rubato::integrate
