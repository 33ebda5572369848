#include <rubato/integrate/contact_problem.hpp>

#include <limits>

namespace rubato::integrate {
namespace {

// A sticking force may pass its limit, and a slipping one may fall short of it, by round-off only.
constexpr double round_off = 64 * std::numeric_limits<double>::epsilon();

int side_of_limit(double force, double limit) { return force >= limit ? 1 : force <= -limit ? -1 : 0; }

}  // namespace

void ContactProblem::reset(const Matrix& compliance, const std::vector<model::Slider>& sliders) {
  reset(compliance, compliance, sliders, {});
}

void ContactProblem::reset(const Matrix& compliance, const Matrix& velocity_compliance,
                           const std::vector<model::Slider>& sliders, const std::vector<model::Stop>& stops,
                           Index laws) {
  sliders_ = static_cast<Index>(sliders.size());
  boxes_ = sliders_ + static_cast<Index>(stops.size());
  m_ = boxes_ + laws;
  scaled_compliance_ = compliance;
  limit_.setZero(m_);
  for (Index i = 0; i < sliders_; ++i) {
    scaled_compliance_.row(i) *= sliders[static_cast<std::size_t>(i)].stiffness;
    limit_[i] = sliders[static_cast<std::size_t>(i)].limit;
  }
  touching_scale_.setOnes(m_);
  if (m_ > sliders_) compliance_ = compliance;
  if (laws > 0) velocity_compliance_ = velocity_compliance;
  for (Index i = sliders_; i < boxes_; ++i) {
    const auto& stop = stops[static_cast<std::size_t>(i - sliders_)];
    scaled_compliance_.row(i) = stop.stiffness * compliance.row(i) + stop.damping * velocity_compliance.row(i);
    if (compliance(i, i) > 0.0) touching_scale_[i] = 1.0 / compliance(i, i);
  }
  for (Index i = 0; i < std::min<Index>(m_, 2); ++i) {
    l_[i] = limit_[i];
    for (Index j = 0; j < std::min<Index>(m_, 2); ++j) q_[i][j] = scaled_compliance_(i, j);
  }
  set_.assign(static_cast<std::size_t>(m_), 0);
  next_ = set_;
  factored_set_.assign(static_cast<std::size_t>(m_), 3);  // no such state: forces the first factorisation
  tangent_.resize(m_, m_);
  right_.resize(m_);
  row_swaps_.resize(m_);
}

void ContactProblem::set_slopes(Index contact, double k, double c) {
  for (Index j = 0; j < m_; ++j)
    scaled_compliance_(contact, j) = k * compliance_(contact, j) + c * velocity_compliance_(contact, j);
  factored_set_[0] = 3;  // no such state: forces a factorisation
}

void ContactProblem::add_slopes(Index contact, Index other, double k, double c) {
  for (Index j = 0; j < m_; ++j)
    scaled_compliance_(contact, j) += k * compliance_(other, j) + c * velocity_compliance_(other, j);
}

// Rows that always have their equation: f + Q f = trial.
bool ContactProblem::solve_laws(const double* trial, double* force) {
  const auto& q = scaled_compliance_;
  if (m_ == 1) {
    force[0] = trial[0] / (1.0 + q(0, 0));
  } else if (m_ == 2) {
    const double a = 1.0 + q(0, 0), b = q(0, 1), c = q(1, 0), d = 1.0 + q(1, 1), determinant = a * d - b * c;
    force[0] = (d * trial[0] - b * trial[1]) / determinant;
    force[1] = (a * trial[1] - c * trial[0]) / determinant;
  } else {
    force_of_the_set(trial, force, nullptr);
  }
  return true;
}

// Each slider in one of three states: at most nine sets, visited by the same iteration as many sliders.
bool ContactProblem::solve_two(const double* trial, const double* previous, double* force) {
  const double a = 1.0 + q_[0][0], b = q_[0][1], c = q_[1][0], d = 1.0 + q_[1][1];
  const double inverse_determinant = 1.0 / (a * d - b * c);
  // Both sticking is by far the commonest set, and is certain when it is consistent.
  const double f0 = (d * trial[0] - b * trial[1]) * inverse_determinant;
  const double f1 = (a * trial[1] - c * trial[0]) * inverse_determinant;
  if (std::abs(f0) <= l_[0] && std::abs(f1) <= l_[1]) {
    force[0] = f0;
    force[1] = f1;
    return true;
  }
  // One slips, and then the other follows from one equation; both slip otherwise. Every set is tried: nothing can
  // cycle.
  for (const int s : {1, -1}) {
    const double slipping = s * l_[0];
    const double other = std::clamp((trial[1] - c * slipping) / d, -l_[1], l_[1]);
    if (s * (trial[0] - q_[0][0] * slipping - b * other) >= l_[0] * (1.0 - round_off)) {
      force[0] = slipping;
      force[1] = other;
      return true;
    }
  }
  for (const int s : {1, -1}) {
    const double slipping = s * l_[1];
    const double other = std::clamp((trial[0] - b * slipping) / a, -l_[0], l_[0]);
    if (s * (trial[1] - q_[1][1] * slipping - c * other) >= l_[1] * (1.0 - round_off)) {
      force[0] = other;
      force[1] = slipping;
      return true;
    }
  }
  return solve_many(trial, previous, force, nullptr);  // within round-off of two sets at once
}

// A force above zero only lowers the penetration: where there is none without it the stop is open.
bool ContactProblem::solve_stop(const double* trial, double* force, const double* penetration) const {
  if (!(std::isfinite(trial[0]) && std::isfinite(penetration[0]))) return false;
  force[0] = 0.0;
  if (!(trial[0] > 0.0 && penetration[0] > 0.0)) return true;
  const double compliance = compliance_(0, 0);
  force[0] = trial[0] / (1.0 + scaled_compliance_(0, 0));
  if (compliance * force[0] > penetration[0]) force[0] = penetration[0] / compliance;
  return true;
}

int ContactProblem::stop_state(Index i, double rest, double size, const double* force,
                               const double* penetration) const {
  const double tolerance = round_off * size, scale = touching_scale_[i];
  double depth = penetration[i], depth_size = std::abs(depth);  // u - gap with all forces
  for (Index j = 0; j < m_; ++j) {
    const double share = compliance_(i, j) * force[j];
    depth -= share;
    depth_size += std::abs(share);
  }
  const bool is_closed = depth > round_off * depth_size, is_open = depth < -round_off * depth_size;
  switch (set_[static_cast<std::size_t>(i)]) {
    case 0:
      if (force[i] < -tolerance) return 1;
      return is_open ? 2 : 0;
    case 1:
      return is_closed && rest > tolerance ? 0 : 1;
    default:
      if (force[i] < -round_off * (std::abs(force[i]) + scale * depth_size)) return 1;
      return force[i] > rest + tolerance ? 0 : 2;
  }
}

int ContactProblem::state_of(Index i, const double* trial, const double* force, const double* penetration) const {
  if (i >= boxes_) return 0;
  const double limit = limit_[i];
  double rest = trial[i], size = limit + std::abs(trial[i]);
  for (Index j = 0; j < m_; ++j) {
    const double share = scaled_compliance_(i, j) * force[j];
    rest -= share;
    size += std::abs(share);
  }
  if (i >= sliders_) return stop_state(i, rest, size, force, penetration);
  const int state = set_[static_cast<std::size_t>(i)];
  if (state == 0) return std::abs(force[i]) <= limit + round_off * size ? 0 : side_of_limit(force[i], limit);
  return state * rest >= limit - round_off * size ? state : 0;
}

// Rows of sticking sliders and pushing stops: f + Q f = trial; of slipping and open ones: f = +-limit; of touching
// ones: W f = penetration. The size never changes, so neither does the memory.
void ContactProblem::force_of_the_set(const double* trial, double* force, const double* penetration) {
  if (set_ != factored_set_) {
    for (Index i = 0; i < m_; ++i) {
      const int state = set_[static_cast<std::size_t>(i)];
      if (state == 0)
        tangent_.row(i) = scaled_compliance_.row(i);
      else if (state == 2)
        tangent_.row(i) = touching_scale_[i] * compliance_.row(i);
      else
        tangent_.row(i).setZero();
      if (state != 2) tangent_(i, i) += 1.0;
    }
    // What PartialPivLU calls, without the permutation that it allocates.
    int transpositions = 0;
    Eigen::internal::partial_lu_inplace(tangent_, row_swaps_, transpositions);
    factored_set_ = set_;
  }
  for (Index i = 0; i < m_; ++i) {
    const int state = set_[static_cast<std::size_t>(i)];
    right_[i] = state == 0 ? trial[i] : state == 2 ? touching_scale_[i] * penetration[i] : state * limit_[i];
  }
  for (Index i = 0; i < m_; ++i) std::swap(right_[i], right_[row_swaps_.coeff(i)]);
  tangent_.triangularView<Eigen::UnitLower>().solveInPlace(right_);
  tangent_.triangularView<Eigen::Upper>().solveInPlace(right_);
  for (Index i = 0; i < m_; ++i) {
    const int state = set_[static_cast<std::size_t>(i)];
    force[i] = state == 0 || state == 2 ? right_[i] : state * limit_[i];
  }
}

bool ContactProblem::solve_many(const double* trial, const double* previous, double* force, const double* penetration) {
  for (Index i = boxes_; i < m_; ++i) set_[static_cast<std::size_t>(i)] = 0;
  for (Index i = sliders_; i < boxes_; ++i)
    set_[static_cast<std::size_t>(i)] = previous[i] > 0.0 || (trial[i] > 0.0 && penetration[i] > 0.0) ? 0 : 1;
  for (Index i = 0; i < sliders_; ++i) {
    const bool at_limit = std::abs(previous[i]) >= limit_[i];
    set_[static_cast<std::size_t>(i)] = at_limit ? side_of_limit(trial[i], limit_[i]) : 0;
  }
  const int newton_rounds = 12, pivots = 100 + 20 * static_cast<int>(m_);
  for (int round = 0; round < newton_rounds + pivots; ++round) {
    force_of_the_set(trial, force, penetration);
    const bool one_at_a_time = round >= newton_rounds;
    bool is_consistent = true;
    for (Index i = 0; i < m_; ++i) {
      next_[static_cast<std::size_t>(i)] = state_of(i, trial, force, penetration);
      if (next_[static_cast<std::size_t>(i)] == set_[static_cast<std::size_t>(i)]) continue;
      is_consistent = false;
      worst_ = i;
      if (!one_at_a_time) continue;
      set_[static_cast<std::size_t>(i)] = next_[static_cast<std::size_t>(i)];
      break;
    }
    if (is_consistent) {
      for (Index i = 0; i < sliders_; ++i) force[i] = std::clamp(force[i], -limit_[i], limit_[i]);
      for (Index i = sliders_; i < boxes_; ++i) force[i] = std::max(force[i], 0.0);
      return true;
    }
    if (!one_at_a_time) std::swap(set_, next_);
  }
  return false;
}

}  // namespace rubato::integrate
