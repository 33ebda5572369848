#include <rubato/steady/periodic/periodic_solver.hpp>
#include <rubato/steady/stuck_offsets.hpp>

#include <cmath>

// The offsets of sliders that never slip.
namespace rubato::steady {
namespace {

constexpr double margin = 1e-10;  // of the limit, by which a slider that never slips stays inside it
constexpr double walking = 1e-9;  // k times the drift over a period, of the limit, that is none of round-off

}  // namespace

// Puts the offsets of sliders that never slip to those that are wanted, as far as they do not slip then, and the
// structure in y_ to where it lies then. Returns whether any was elsewhere.
bool PeriodicSolver::move_offsets(const system::Excitation& excitation) {
  if (half_) {
    centre_.setZero();
    return false;
  }
  StuckOffsets stuck;
  for (Index i = 0; i < m_; ++i) {
    const double limit = excitation.limits[i], stiffness = system_.sliders()[static_cast<std::size_t>(i)].stiffness;
    double low = 0.0, high = 0.0;
    orbit_.displacement_range(i, low, high);
    centre_[i] = -0.5 * stiffness * (low + high);
    if (limit == 0.0) continue;
    if (orbit_.slips(i)) {
      // What slips in a motion that repeats slips to and fro, over more than twice its limit: the others only touch it.
      const double walk = std::abs(system_.relative_displacement(i, drift_));
      if (stiffness * (high - low) > 2.0 * limit || stiffness * walk > walking * limit) continue;
      orbit_.take_as_stuck(i);
      factors_are_of_orbit_ = false;
    }
    centre_[i] = y_[2 * n_ + i] - stiffness * system_.relative_displacement(i, y_.head(n_));
    stuck.add(i, stiffness, low, high, centre_[i], wanted_offset_[i]);
  }
  const OffsetShift shift = shift_to_wanted_offsets(system_, excitation.limits, stuck, margin);
  if (shift.is_zero()) return false;
  y_.head(n_) += shift.displacement;
  for (std::size_t a = 0; a < stuck.sliders.size(); ++a)
    y_[2 * n_ + stuck.sliders[a]] += shift.force[static_cast<Index>(a)];
  put(Vector(y_), excitation);
  return true;
}

}  // namespace rubato::steady
