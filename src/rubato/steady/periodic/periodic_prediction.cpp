#include <rubato/steady/periodic/equivalent_linear.hpp>
#include <rubato/steady/periodic/periodic_solver.hpp>

#include <algorithm>
#include <cmath>

// Where a point of a frequency response starts: what PeriodicSolver remembers of the points before.
namespace rubato::steady {
namespace {

constexpr std::size_t most_known = 24, most_interpolated = 6;

}  // namespace

void PeriodicSolver::guess(const system::Excitation& excitation) {
  if (equivalent_linear_state(system_, excitation, start_.q, start_.v, start_.slider_force))
    y_ << start_.q, start_.v, start_.slider_force;
  else
    y_.setZero();
}

// Newton's interpolation through the points next to the frequency, the nearest first. Its terms are added while they
// fall: across a kink of the response, and far from what is known, that is soon no longer so.
void PeriodicSolver::predict(const system::Excitation& excitation) {
  if (known_.empty()) return guess(excitation);
  const double w = excitation.angular_frequency;
  const auto distance = [w](const Known& known) { return std::abs(known.angular_frequency - w); };
  const std::size_t used = std::min(known_.size(), most_interpolated);
  std::partial_sort(known_.begin(), known_.begin() + static_cast<std::ptrdiff_t>(used), known_.end(),
                    [&](const Known& a, const Known& b) { return distance(a) < distance(b); });
  differences_.resize(most_interpolated - 1);
  y_ = known_[0].y;
  double last = scaled_size(y_, w), factor = 1.0;
  for (std::size_t order = 1; order < used; ++order) {
    // Divided differences of this order, in the place of those before.
    for (std::size_t i = 0; i + order < used; ++i) {
      Vector& difference = differences_[i];
      difference = ((order == 1 ? known_[i].y : difference) - (order == 1 ? known_[i + 1].y : differences_[i + 1])) /
                   (known_[i].angular_frequency - known_[i + order].angular_frequency);
    }
    factor *= w - known_[order - 1].angular_frequency;
    const double size = std::abs(factor) * scaled_size(differences_[0], w);
    if (!(size < last)) break;
    y_ += factor * differences_[0];
    last = size;
  }
  y_.tail(m_) = y_.tail(m_).cwiseMax(-excitation.limits).cwiseMin(excitation.limits);
  // A slider that slips at t = 0 goes on to slip there.
  for (Index i = 0; i < m_; ++i) {
    const double force = known_[0].y[2 * n_ + i];
    if (std::abs(force) >= known_[0].limits[i]) y_[2 * n_ + i] = std::copysign(excitation.limits[i], force);
  }
}

double PeriodicSolver::scaled_size(const Vector& y, double omega) const {
  return std::sqrt(y.head(n_).squaredNorm() + y.segment(n_, n_).squaredNorm() / (omega * omega));
}

// The oldest goes where there are too many, and those of the same frequency.
void PeriodicSolver::remember(const system::Excitation& excitation) {
  const double w = excitation.angular_frequency;
  auto place = std::find_if(known_.begin(), known_.end(),
                            [w](const Known& known) { return std::abs(known.angular_frequency - w) <= 1e-9 * w; });
  if (place == known_.end() && known_.size() < most_known) place = known_.emplace(place);
  if (place == known_.end())
    place = std::min_element(known_.begin(), known_.end(),
                             [](const Known& a, const Known& b) { return a.serial < b.serial; });
  place->angular_frequency = w;
  place->serial = ++serial_;
  place->limits = excitation.limits;
  place->y = y_;
}

// Points of other loads or limits do not lie on one curve with the next: the nearest of them is all they are good for.
void PeriodicSolver::forget_others(const system::Excitation& excitation) {
  const auto same_load = [](const system::LoadHarmonic& a, const system::LoadHarmonic& b) {
    return a.order == b.order && a.amplitude == b.amplitude;
  };
  if (known_.size() < 2) return;
  if (excitation.limits == last_.limits && excitation.constant == last_.constant &&
      std::equal(excitation.harmonics.begin(), excitation.harmonics.end(), last_.harmonics.begin(),
                 last_.harmonics.end(), same_load))
    return;
  std::swap(known_[0], *std::min_element(known_.begin(), known_.end(), [&](const Known& a, const Known& b) {
              return std::abs(a.angular_frequency - excitation.angular_frequency) <
                     std::abs(b.angular_frequency - excitation.angular_frequency);
            }));
  known_.resize(1);
}

}  // namespace rubato::steady
