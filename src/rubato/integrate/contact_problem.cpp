#include <rubato/integrate/contact_problem.hpp>

#include <limits>

namespace rubato::integrate {
namespace {

// A sticking force may pass its limit, and a slipping one may fall short of it, by round-off only.
constexpr double round_off = 64 * std::numeric_limits<double>::epsilon();

int side_of_limit(double force, double limit) { return force >= limit ? 1 : force <= -limit ? -1 : 0; }

}  // namespace

void ContactProblem::reset(const Matrix& compliance, const std::vector<model::Slider>& sliders) {
  m_ = static_cast<Index>(sliders.size());
  scaled_compliance_ = compliance;
  limit_.resize(m_);
  for (Index i = 0; i < m_; ++i) {
    scaled_compliance_.row(i) *= sliders[static_cast<std::size_t>(i)].stiffness;
    limit_[i] = sliders[static_cast<std::size_t>(i)].limit;
  }
  for (Index i = 0; i < std::min<Index>(m_, 2); ++i) {
    l_[i] = limit_[i];
    for (Index j = 0; j < std::min<Index>(m_, 2); ++j) q_[i][j] = scaled_compliance_(i, j);
  }
  set_.assign(static_cast<std::size_t>(m_), 0);
  next_ = set_;
  factored_set_.assign(static_cast<std::size_t>(m_), 2);  // no such state: forces the first factorisation
  tangent_.resize(m_, m_);
  right_.resize(m_);
  solution_.resize(m_);
  factor_ = Eigen::PartialPivLU<Matrix>(Matrix::Identity(m_, m_));
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
  return solve_many(trial, previous, force);  // within round-off of two sets at once
}

int ContactProblem::state_of(Index i, const double* trial, const double* force) const {
  const double limit = limit_[i];
  double rest = trial[i], size = limit + std::abs(trial[i]);
  for (Index j = 0; j < m_; ++j) {
    const double share = scaled_compliance_(i, j) * force[j];
    rest -= share;
    size += std::abs(share);
  }
  const int state = set_[static_cast<std::size_t>(i)];
  if (state == 0) return std::abs(force[i]) <= limit + round_off * size ? 0 : side_of_limit(force[i], limit);
  return state * rest >= limit - round_off * size ? state : 0;
}

// Rows of sticking sliders: f + Q f = trial; rows of slipping ones: f = +-limit. The size never changes, so neither
// does the memory.
void ContactProblem::force_of_the_set(const double* trial, double* force) {
  if (set_ != factored_set_) {
    for (Index i = 0; i < m_; ++i) {
      if (set_[static_cast<std::size_t>(i)] == 0)
        tangent_.row(i) = scaled_compliance_.row(i);
      else
        tangent_.row(i).setZero();
      tangent_(i, i) += 1.0;
    }
    factor_.compute(tangent_);
    factored_set_ = set_;
  }
  for (Index i = 0; i < m_; ++i) {
    const int state = set_[static_cast<std::size_t>(i)];
    right_[i] = state == 0 ? trial[i] : state * limit_[i];
  }
  solution_ = right_;
  factor_.permutationP().applyThisOnTheLeft(solution_);
  factor_.matrixLU().triangularView<Eigen::UnitLower>().solveInPlace(solution_);
  factor_.matrixLU().triangularView<Eigen::Upper>().solveInPlace(solution_);
  for (Index i = 0; i < m_; ++i) {
    const int state = set_[static_cast<std::size_t>(i)];
    force[i] = state == 0 ? solution_[i] : state * limit_[i];
  }
}

bool ContactProblem::solve_many(const double* trial, const double* previous, double* force) {
  for (Index i = 0; i < m_; ++i) {
    const bool at_limit = std::abs(previous[i]) >= limit_[i];
    set_[static_cast<std::size_t>(i)] = at_limit ? side_of_limit(trial[i], limit_[i]) : 0;
  }
  const int newton_rounds = 12, pivots = 100 + 20 * static_cast<int>(m_);
  for (int round = 0; round < newton_rounds + pivots; ++round) {
    force_of_the_set(trial, force);
    const bool one_at_a_time = round >= newton_rounds;
    bool is_consistent = true;
    for (Index i = 0; i < m_; ++i) {
      next_[static_cast<std::size_t>(i)] = state_of(i, trial, force);
      if (next_[static_cast<std::size_t>(i)] == set_[static_cast<std::size_t>(i)]) continue;
      is_consistent = false;
      worst_ = i;
      if (!one_at_a_time) continue;
      set_[static_cast<std::size_t>(i)] = next_[static_cast<std::size_t>(i)];
      break;
    }
    if (is_consistent) {
      for (Index i = 0; i < m_; ++i) force[i] = std::clamp(force[i], -limit_[i], limit_[i]);
      return true;
    }
    if (!one_at_a_time) std::swap(set_, next_);
  }
  return false;
}

}  // namespace rubato::integrate
