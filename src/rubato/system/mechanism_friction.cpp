#include <rubato/system/friction_places.hpp>
#include <rubato/system/mechanism_equations.hpp>

#include <algorithm>
#include <cmath>

// What friction in joints adds to the equations of a mechanism.
namespace rubato::system {

double MechanismEquations::pressing(const model::JointFriction& friction, const Vector& multiplier) const {
  const Index row = mechanism_.first_row(friction.joint) + friction.first_pressing_row;
  if (friction.pressing_rows == 1) return std::abs(reaction(row, multiplier));
  double squared = 0.0;
  for (Index r = 0; r < friction.pressing_rows; ++r) squared += std::pow(reaction(row + r, multiplier), 2);
  return std::sqrt(squared);
}

void MechanismEquations::set_reaction_lag(const Vector& lag, double share) {
  if (!mechanism_.model().frictions.empty() || !pressed_by_reactions_.empty()) excess_ = share * lag;
}

void MechanismEquations::set_duration(double duration) {
  constexpr double nothing = 1e-10;
  const Vector& q = mechanism_.start().q;
  const double size = mechanism_.extent(q);
  negligible_.clear();
  negligible_rate_.clear();
  const auto& frictions = mechanism_.model().frictions;
  for (std::size_t i = 0; i < frictions.size(); ++i) {
    double slope[most_friction_places], mobility = 0.0;
    frictions[i].s.slope(q.data(), slope);
    const JointPlace& place = joint_places_[static_cast<std::size_t>(frictions[i].joint)];
    for (std::size_t k = 0; k < place.place.size(); ++k)
      mobility += slope[place.local[k]] * slope[place.local[k]] * saddle_.inverse_mass(place.place[k]);
    const double way = nothing * (frictions[i].s.is_angle() ? 1.0 : size);
    negligible_rate_.push_back(way / duration);
    negligible_.push_back(mobility > 0.0 ? 2.0 * way / (duration * duration * mobility) : 0.0);
  }
}

double MechanismEquations::friction_limit(std::size_t i, const Vector& multiplier) const {
  const auto& friction = mechanism_.model().frictions[i];
  return friction.coefficient *
         (friction.preload + (friction.follows_reaction() ? pressing(friction, multiplier) : 0.0));
}

double MechanismEquations::friction_force(std::size_t i, const Vector& multiplier) const {
  const auto& friction = mechanism_.model().frictions[i];
  if (motion_.rubbing[i] == model::friction_sticks) return -multiplier[mechanism_.first_row(friction.sticking_joint)];
  return -direction(i) * friction_limit(i, multiplier);
}

double MechanismEquations::friction_size(std::size_t i, const Vector& multiplier) const {
  const auto& friction = mechanism_.model().frictions[i];
  const double force = friction_force(i, multiplier);
  if (friction.partner < 0) return std::abs(force);
  const auto other = static_cast<std::size_t>(friction.partner);
  return std::hypot(force, friction_force(other, multiplier) * friction.arm / mechanism_.model().frictions[other].arm);
}

bool MechanismEquations::is_led(std::size_t i) const {
  const int partner = mechanism_.model().frictions[i].partner;
  return partner >= 0 && static_cast<std::size_t>(partner) < i;
}

Eigen::Vector2d MechanismEquations::slip_velocity(std::size_t i) const {
  const auto& first = mechanism_.model().frictions[i];
  const auto& second = mechanism_.model().frictions[static_cast<std::size_t>(first.partner)];
  return {first.arm * first.s.rate(motion_), second.arm * second.s.rate(motion_)};
}

Eigen::Vector2d MechanismEquations::slip_acceleration(std::size_t i, const Vector& acceleration) {
  std::copy(acceleration.data(), acceleration.data() + acceleration.size(), acceleration_.data() + 1);
  const auto& first = mechanism_.model().frictions[i];
  const auto& second = mechanism_.model().frictions[static_cast<std::size_t>(first.partner)];
  return {first.arm * first.s.second_rate(motion_, acceleration_.data() + 1),
          second.arm * second.s.second_rate(motion_, acceleration_.data() + 1)};
}

void MechanismEquations::set_slip_floors(const State& from, double h, State& to) {
  const auto& frictions = mechanism_.model().frictions;
  for (std::size_t i = 0; i < frictions.size(); ++i) {
    if (frictions[i].partner < 0 || is_led(i) || from.rubbing[i] != model::friction_slides_up) continue;
    const Index first = static_cast<Index>(i), second = frictions[i].partner;
    Eigen::Vector2d floor(from.stuck_at[first], from.stuck_at[second]);
    if (floor.norm() > 0.5 * model::slip_floor_at_rest) {  // the next step starts in motion
      floor *= 0.25;
    } else {
      go_to(from, model::Side::right);
      const Eigen::Vector2d u = slip_velocity(i);
      const Eigen::Vector2d change = h * slip_acceleration(i, from.acceleration);
      const Eigen::Vector2d way = u.norm() > 0.0 ? u : change;
      floor = model::slip_floor_share * std::max(u.norm(), change.norm()) * way.normalized();
    }
    to.stuck_at[first] = floor[0];
    to.stuck_at[second] = floor[1];
  }
}

MechanismEquations::Slip MechanismEquations::slip(std::size_t i) const {
  const int partner = mechanism_.model().frictions[i].partner;
  const Eigen::Vector2d floor(motion_.stuck_at[i], motion_.stuck_at[partner]);
  const double least = floor.norm();
  const Eigen::Vector2d along = floor / least;
  if (motion_.rubbing[i] != model::friction_slides_up) return {along, Eigen::Matrix2d::Zero(), Eigen::Matrix2d::Zero()};
  const Eigen::Vector2d u = slip_velocity(i);
  const double forward = along.dot(u);
  const bool is_slow = !(forward > least);
  const Eigen::Vector2d counted = is_slow ? Eigen::Vector2d(u + (least - forward) * along) : u;
  const double size = counted.norm();
  Slip slip;
  slip.direction = counted / size;
  slip.slope = (Eigen::Matrix2d::Identity() - slip.direction * slip.direction.transpose()) / size;
  slip.secant = Eigen::Matrix2d::Identity() / size;
  if (is_slow) {
    slip.slope -= (slip.slope * along) * along.transpose();
    slip.secant -= along * along.transpose() / size;
  }
  return slip;
}

double MechanismEquations::direction(std::size_t i) const {
  const double by_phase = model::sliding_direction(motion_.rubbing[i]);
  if (by_phase == 0.0 || mechanism_.model().frictions[i].partner < 0) return by_phase;
  return is_led(i) ? slip(static_cast<std::size_t>(mechanism_.model().frictions[i].partner)).direction[1]
                   : slip(i).direction[0];
}

void MechanismEquations::linearise_slip(std::size_t leader, const Weights& weights, const Vector& multiplier) {
  const auto& frictions = mechanism_.model().frictions;
  const std::size_t both[] = {leader, static_cast<std::size_t>(frictions[leader].partner)};
  const Slip now = slip(leader);
  const Eigen::Matrix2d& change = weights.secants ? now.secant : now.slope;
  const JointPlace& place = joint_places_[static_cast<std::size_t>(frictions[leader].joint)];
  const std::size_t k = most_friction_places;
  double slope[2][most_friction_places];
  for (std::size_t a = 0; a < 2; ++a) frictions[both[a]].s.slope(motion_.q, slope[a]);
  std::fill(matrix_.begin(), matrix_.end(), 0.0);
  for (std::size_t a = 0; a < 2; ++a)
    for (std::size_t b = 0; b < 2; ++b) {
      const double factor = friction_limit(both[a], multiplier) * frictions[both[b]].arm *
                            change(static_cast<Index>(a), static_cast<Index>(b));
      for (std::size_t i = 0; i < k; ++i)
        for (std::size_t j = 0; j < k; ++j) matrix_[i * k + j] += factor * slope[a][i] * slope[b][j];
    }
  scatter(place, matrix_.data(), weights.damping);
}

double MechanismEquations::friction_rate(std::size_t i) const {
  return mechanism_.model().frictions[i].s.rate(motion_);
}

double MechanismEquations::friction_acceleration(std::size_t i, const Vector& acceleration) {
  std::copy(acceleration.data(), acceleration.data() + acceleration.size(), acceleration_.data() + 1);
  return mechanism_.model().frictions[i].s.second_rate(motion_, acceleration_.data() + 1);
}

bool MechanismEquations::has_sliding_reactions() const {
  const auto& frictions = mechanism_.model().frictions;
  for (std::size_t i = 0; i < frictions.size(); ++i)
    if (frictions[i].follows_reaction() && model::sliding_direction(motion_.rubbing[i]) != 0.0) return true;
  return !pressed_by_reactions_.empty();  // by other multipliers another branch may be theirs
}

bool MechanismEquations::lets_go(const State& state) {
  go_to(state, model::Side::right);
  constexpr double round_off = 1e-6;
  for (std::size_t i = 0; i < state.rubbing.size(); ++i) {
    if (state.rubbing[i] != model::friction_sticks) continue;
    const double excess = friction_size(i, state.multiplier) - (1.0 + round_off) * friction_limit(i, state.multiplier);
    if (excess > negligible_friction(i)) return true;
  }
  return false;
}

void MechanismEquations::add_preload_friction(Vector& force) const {
  const auto& frictions = mechanism_.model().frictions;
  for (std::size_t i = 0; i < frictions.size(); ++i) {
    const double applied = direction(i) * frictions[i].coefficient * frictions[i].preload;
    if (applied == 0.0) continue;
    double slope[most_friction_places];
    frictions[i].s.slope(motion_.q, slope);
    const JointPlace& place = joint_places_[static_cast<std::size_t>(frictions[i].joint)];
    for (std::size_t k = 0; k < place.place.size(); ++k) force[place.place[k]] += applied * slope[place.local[k]];
  }
}

void MechanismEquations::linearise_friction(const Weights& weights, const Vector& multiplier) {
  const auto& frictions = mechanism_.model().frictions;
  double* const values = saddle_.values();
  for (std::size_t i = 0; i < frictions.size(); ++i) {
    const auto& friction = frictions[i];
    if (model::sliding_direction(motion_.rubbing[i]) == 0.0) continue;
    const double direction = this->direction(i);
    if (weights.damping != 0.0 && friction.partner >= 0 && !is_led(i)) linearise_slip(i, weights, multiplier);
    const JointPlace& place = joint_places_[static_cast<std::size_t>(friction.joint)];
    if (weights.stiffness != 0.0) {
      friction.s.curvature(motion_.q, direction * friction_limit(i, multiplier), matrix_.data());
      scatter(place, matrix_.data(), weights.stiffness);
    }
    const double size = friction.follows_reaction() ? pressing(friction, multiplier) : 0.0;
    if (size == 0.0) continue;
    double slope[most_friction_places];
    friction.s.slope(motion_.q, slope);
    const Index row = mechanism_.first_row(friction.joint) + friction.first_pressing_row;
    const std::size_t rows = static_cast<std::size_t>(friction.pressing_rows);
    for (std::size_t r = 0; r < rows; ++r) {
      const double part = reaction(row + static_cast<Index>(r), multiplier) / size;  // of one row 1 or -1, exactly
      for (std::size_t k = 0; k < place.place.size(); ++k)
        values[friction_places_[i].slot[k * rows + r]] +=
            direction * friction.coefficient * slope[place.local[k]] * part;
    }
  }
}

}  // namespace rubato::system
