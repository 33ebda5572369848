#include <rubato/system/mechanism_equations.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace rubato::system {
namespace {

constexpr double share = 1e-10;
constexpr std::size_t most_friction_places = 12;

}  // namespace

MechanismEquations::ElementPlace MechanismEquations::place_of(const std::vector<Index>& places) const {
  ElementPlace result;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i] == ground) continue;
    result.local.push_back(static_cast<int>(i));
    result.place.push_back(places[i]);
  }
  return result;
}

MechanismEquations::MechanismEquations(const Mechanism& mechanism) : mechanism_(mechanism) {
  const auto& model = mechanism.model();
  std::size_t largest = 1, widest = 1;
  for (const auto& element : model.elements) {
    elements_.push_back(element->clone());
    element_places_.push_back(place_of(element->places()));
    largest = std::max(largest, element->places().size());
  }
  Index row = 0;
  std::size_t entries = 0;
  for (const auto& joint : model.joints) {
    joints_.push_back(joint->clone());
    JointPlace place;
    static_cast<ElementPlace&>(place) = place_of(joint->places());
    place.first_row = row;
    place.jacobian_start = entries;
    row += joint->rows();
    entries += static_cast<std::size_t>(joint->rows()) * joint->places().size();
    largest = std::max(largest, joint->places().size());
    widest = std::max(widest, static_cast<std::size_t>(joint->rows()));
    joint_places_.push_back(std::move(place));
    patterns_.push_back(joint->pattern());
  }
  // Friction writes on all places of its joint.
  for (const auto& friction : model.frictions) {
    model::JointPattern& pattern = patterns_[static_cast<std::size_t>(friction.joint)];
    std::fill(pattern.jacobian.begin(), pattern.jacobian.end(), 1);
    std::fill(pattern.curvature.begin(), pattern.curvature.end(), 1);
  }
  list_entries();
  forces_ = model.forces;
  jacobian_.assign(entries, 0.0);
  local_.assign(std::max(largest, widest), 0.0);
  matrix_.assign(largest * largest, 0.0);
  velocity_.assign(static_cast<std::size_t>(mechanism.size()) + 1, 0.0);
  acceleration_ = velocity_;
  const Vector diagonal = mechanism.mass().diagonal();
  for (const double mass : diagonal) inverse_mass_.push_back(1.0 / mass);
  row_seen_.assign(static_cast<std::size_t>(mechanism.constraint_count()), 0.0);
  analyse();
}

void MechanismEquations::list_entries() {
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const JointPlace& place = joint_places_[j];
    const std::size_t k = joints_[j]->places().size();
    for (int r = 0; r < joints_[j]->rows(); ++r)
      for (std::size_t i = 0; i < place.place.size(); ++i) {
        const std::size_t local = static_cast<std::size_t>(r) * k + static_cast<std::size_t>(place.local[i]);
        if (!patterns_[j].jacobian[local]) continue;
        entries_.push_back({static_cast<int>(place.jacobian_start + local), static_cast<int>(place.first_row + r),
                            static_cast<int>(place.place[i]), 0, 0});
      }
  }
}

void MechanismEquations::analyse() {
  const Index n = mechanism_.size(), size = n + mechanism_.constraint_count();
  std::vector<numerics::KktFactor::Entry> entries;
  const SparseMatrix& mass = mechanism_.mass();
  for (Index column = 0; column < n; ++column)
    for (SparseMatrix::InnerIterator entry(mass, column); entry; ++entry)
      if (entry.row() >= column) entries.emplace_back(entry.row(), column);
  bool is_symmetric = true;
  const auto couple = [&](const std::vector<Index>& places) {
    for (const Index i : places)
      for (const Index j : places)
        if (i >= j) entries.emplace_back(i, j);
  };
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    couple(element_places_[e].place);
    is_symmetric = is_symmetric && elements_[e]->has_symmetric_tangent();
  }
  const auto is_coupled = [&](std::size_t j, int a, int b) {
    const auto k = static_cast<int>(joints_[j]->places().size());
    const auto& curvature = patterns_[j].curvature;
    return curvature[static_cast<std::size_t>(a * k + b)] || curvature[static_cast<std::size_t>(b * k + a)];
  };
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const JointPlace& place = joint_places_[j];
    for (std::size_t a = 0; a < place.place.size(); ++a)
      for (std::size_t b = 0; b < place.place.size(); ++b)
        if (place.place[a] >= place.place[b] && is_coupled(j, place.local[a], place.local[b]))
          entries.emplace_back(place.place[a], place.place[b]);
    is_symmetric = is_symmetric && joints_[j]->has_symmetric_curvature();
  }
  for (const Entry& entry : entries_) entries.emplace_back(n + entry.row, entry.place);
  for (const auto& friction : mechanism_.model().frictions) is_symmetric = is_symmetric && !friction.follows_reaction();
  factor_.analyse(size, n, entries, is_symmetric);

  for (Index column = 0; column < n; ++column)
    for (SparseMatrix::InnerIterator entry(mass, column); entry; ++entry) {
      mass_slot_.push_back(factor_.slot(entry.row(), column));
      mass_value_.push_back(entry.value());
    }
  const auto find_slots = [&](ElementPlace& place, std::size_t k, const std::vector<char>* pattern) {
    for (std::size_t i = 0; i < place.place.size(); ++i)
      for (std::size_t j = 0; j < place.place.size(); ++j) {
        const int local = place.local[i] * static_cast<int>(k) + place.local[j];
        if (pattern && !(*pattern)[static_cast<std::size_t>(local)]) continue;
        const int slot = factor_.slot(place.place[i], place.place[j]);
        if (slot == factor_.spare_slot()) continue;
        place.matrix.slot.push_back(slot);
        place.matrix.local.push_back(local);
      }
  };
  for (std::size_t e = 0; e < elements_.size(); ++e)
    find_slots(element_places_[e], elements_[e]->places().size(), nullptr);
  for (std::size_t j = 0; j < joints_.size(); ++j)
    find_slots(joint_places_[j], joints_[j]->places().size(), &patterns_[j].curvature);
  for (Entry& entry : entries_) {
    entry.slot = factor_.slot(n + entry.row, entry.place);
    entry.transposed = factor_.slot(entry.place, n + entry.row);
    if (entry.slot == factor_.spare_slot()) std::swap(entry.slot, entry.transposed);
  }
  for (Index row = n; row < size; ++row) row_slot_.push_back(factor_.slot(row, row));
  for (const auto& friction : mechanism_.model().frictions) {
    FrictionPlace place;
    const JointPlace& joint = joint_places_[static_cast<std::size_t>(friction.joint)];
    for (const Index i : joint.place)
      for (int r = 0; r < friction.pressing_rows; ++r)
        place.slot.push_back(factor_.slot(i, n + joint.first_row + friction.first_pressing_row + r));
    friction_places_.push_back(std::move(place));
  }
}

double MechanismEquations::pressing(const model::JointFriction& friction, const Vector& multiplier) const {
  const Index row = mechanism_.first_row(friction.joint) + friction.first_pressing_row;
  if (friction.pressing_rows == 1) return std::abs(reaction(row, multiplier));
  double squared = 0.0;
  for (Index r = 0; r < friction.pressing_rows; ++r) squared += std::pow(reaction(row + r, multiplier), 2);
  return std::sqrt(squared);
}

void MechanismEquations::exceed_multipliers(const Vector& lag, double share) {
  if (!mechanism_.model().frictions.empty()) excess_ = share * lag;
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
  const Eigen::Matrix2d& change = weights.wary ? now.secant : now.slope;
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

bool MechanismEquations::has_sliding_reactions() const {
  const auto& frictions = mechanism_.model().frictions;
  for (std::size_t i = 0; i < frictions.size(); ++i)
    if (frictions[i].follows_reaction() && model::sliding_direction(motion_.rubbing[i]) != 0.0) return true;
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
  double* const values = factor_.values();
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
    for (std::size_t k = 0; k < place.place.size(); ++k)
      for (std::size_t r = 0; r < rows; ++r)
        values[friction_places_[i].slot[k * rows + r]] += direction * friction.coefficient * slope[place.local[k]] *
                                                          reaction(row + static_cast<Index>(r), multiplier) / size;
  }
}

void MechanismEquations::go_to(const State& state, model::Side side) {
  std::copy(state.v.data(), state.v.data() + state.v.size(), velocity_.data() + 1);
  motion_ = {state.t,
             side,
             state.q.data(),
             velocity_.data() + 1,
             state.phase.data(),
             state.rubbing.data(),
             state.stuck_at.data()};
}

void MechanismEquations::scatter(const ElementPlace& place, const double* matrix, double weight) {
  double* const values = factor_.values();
  for (std::size_t i = 0; i < place.matrix.slot.size(); ++i)
    values[place.matrix.slot[i]] += weight * matrix[place.matrix.local[i]];
}

void MechanismEquations::external_force(Vector& out) const {
  out = mechanism_.weight();
  for (const auto& force : forces_) out[force.coordinate] += model::value(force.law, motion_.t, motion_.side);
}

void MechanismEquations::elements_and_loads(Vector& force) {
  external_force(force);
  force = -force;
  add_preload_friction(force);
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const ElementPlace& place = element_places_[e];
    elements_[e]->force(motion_, local_.data());
    for (std::size_t i = 0; i < place.place.size(); ++i)
      force[place.place[i]] += local_[static_cast<std::size_t>(place.local[i])];
  }
}

void MechanismEquations::constraints(Vector& constraint) {
  for (std::size_t j = 0; j < joints_.size(); ++j)
    joints_[j]->constraint(motion_, constraint.data() + joint_places_[j].first_row,
                           jacobian_.data() + joint_places_[j].jacobian_start);
}

void MechanismEquations::residual(Vector& force, Vector& constraint) {
  elements_and_loads(force);
  constraints(constraint);
}

void MechanismEquations::linearise(const Weights& weights, const Vector& multiplier, Vector& force,
                                   Vector& constraint) {
  factor_.set_zero();
  ++factorisations_;
  double* const values = factor_.values();
  for (std::size_t i = 0; i < mass_slot_.size(); ++i) values[mass_slot_[i]] += weights.mass * mass_value_[i];
  external_force(force);
  force = -force;
  if (weights.friction) {
    add_preload_friction(force);
    linearise_friction(weights, multiplier);
  }
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const ElementPlace& place = element_places_[e];
    elements_[e]->tangent(motion_, weights.stiffness, weights.damping, local_.data(), matrix_.data());
    for (std::size_t i = 0; i < place.place.size(); ++i)
      force[place.place[i]] += local_[static_cast<std::size_t>(place.local[i])];
    scatter(place, matrix_.data(), 1.0);
  }
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const JointPlace& place = joint_places_[j];
    double* const g = constraint.data() + place.first_row;
    double* const jacobian = jacobian_.data() + place.jacobian_start;
    if (weights.stiffness != 0.0) {
      joints_[j]->linearise(motion_, multiplier.data() + place.first_row, g, jacobian, matrix_.data());
      scatter(place, matrix_.data(), weights.stiffness);
    } else {
      joints_[j]->constraint(motion_, g, jacobian);
    }
  }
  std::fill(row_seen_.begin(), row_seen_.end(), 0.0);
  const bool is_symmetric = factor_.is_symmetric();  // then one of both is the spare place
  for (const Entry& entry : entries_) {
    const double value = jacobian_[static_cast<std::size_t>(entry.local)];
    values[entry.slot] += value;
    if (!is_symmetric) values[entry.transposed] += value;
    row_seen_[static_cast<std::size_t>(entry.row)] +=
        value * value * inverse_mass_[static_cast<std::size_t>(entry.place)];
  }
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    if (joints_[j]->is_active(motion_)) continue;
    const auto first = row_seen_.begin() + joint_places_[j].first_row;
    std::fill(first, first + joints_[j]->rows(), 0.0);
  }
  // An open lock says nothing: multiplier = 0.
  const double part = share / (weights.constraint > 0.0 ? weights.constraint : weights.mass);
  for (std::size_t r = 0; r < row_seen_.size(); ++r)
    values[row_slot_[r]] -= row_seen_[r] > 0.0 ? part * row_seen_[r] : 1.0;
}

void MechanismEquations::scale_loads(double factor, const Weights& weights, Vector& force) {
  const double change = factor - 1.0;
  if (change == 0.0) return;
  force -= change * mechanism_.weight();
  for (const auto& load : forces_) force[load.coordinate] -= change * model::value(load.law, motion_.t, motion_.side);
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    if (elements_[e]->role() != model::Element::Role::load) continue;
    const ElementPlace& place = element_places_[e];
    elements_[e]->tangent(motion_, weights.stiffness, weights.damping, local_.data(), matrix_.data());
    for (std::size_t i = 0; i < place.place.size(); ++i)
      force[place.place[i]] += change * local_[static_cast<std::size_t>(place.local[i])];
    scatter(place, matrix_.data(), change);
  }
}

std::vector<Index> MechanismEquations::redundant_rows(double left) const {
  std::vector<Index> rows;
  for (std::size_t r = 0; r < row_seen_.size(); ++r) {
    const auto row = static_cast<Index>(r);
    if (row_seen_[r] > 0.0 && std::abs(factor_.pivot(mechanism_.size() + row)) < left * row_seen_[r])
      rows.push_back(row);
  }
  return rows;
}

int MechanismEquations::hardly_held_rows() const {
  constexpr double left = 10.0 * share;
  int count = 0;
  for (std::size_t r = 0; r < row_seen_.size(); ++r)
    if (std::abs(factor_.pivot(mechanism_.size() + static_cast<Index>(r))) < left * row_seen_[r]) ++count;
  return count;
}

void MechanismEquations::add_constraint_force(const Vector& multiplier, double factor, Vector& out) const {
  for (const Entry& entry : entries_)
    out[entry.place] += factor * multiplier[entry.row] * jacobian_[static_cast<std::size_t>(entry.local)];
  const auto& frictions = mechanism_.model().frictions;
  for (std::size_t i = 0; i < frictions.size(); ++i) {
    if (model::sliding_direction(motion_.rubbing[i]) == 0.0 || !frictions[i].follows_reaction()) continue;
    const double applied = factor * direction(i) * frictions[i].coefficient * pressing(frictions[i], multiplier);
    double slope[most_friction_places];
    frictions[i].s.slope(motion_.q, slope);
    const JointPlace& place = joint_places_[static_cast<std::size_t>(frictions[i].joint)];
    for (std::size_t k = 0; k < place.place.size(); ++k) out[place.place[k]] += applied * slope[place.local[k]];
  }
}

void MechanismEquations::constraint_rate(const Vector& v, Vector& out) {
  for (std::size_t j = 0; j < joints_.size(); ++j) joints_[j]->rate(motion_, out.data() + joint_places_[j].first_row);
  for (const Entry& entry : entries_)
    out[entry.row] += v[entry.place] * jacobian_[static_cast<std::size_t>(entry.local)];
}

void MechanismEquations::second_rate(Vector& out) {
  for (std::size_t j = 0; j < joints_.size(); ++j)
    joints_[j]->second_rate(motion_, out.data() + joint_places_[j].first_row);
}

void MechanismEquations::solve(Vector& x, Vector& y) { factor_.solve(x.data(), y.data()); }

MechanismEquations::Linearised MechanismEquations::linearised(const Vector& multiplier) {
  std::vector<Eigen::Triplet<double>> damping, stiffness, jacobian;
  const auto add = [&](const ElementPlace& place, std::size_t k, std::vector<Eigen::Triplet<double>>& entries) {
    for (std::size_t i = 0; i < place.place.size(); ++i)
      for (std::size_t j = 0; j < place.place.size(); ++j)
        entries.emplace_back(
            place.place[i], place.place[j],
            matrix_[static_cast<std::size_t>(place.local[i]) * k + static_cast<std::size_t>(place.local[j])]);
  };
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const std::size_t k = elements_[e]->places().size();
    elements_[e]->tangent(motion_, 1.0, 0.0, local_.data(), matrix_.data());
    add(element_places_[e], k, stiffness);
    elements_[e]->tangent(motion_, 0.0, 1.0, local_.data(), matrix_.data());
    add(element_places_[e], k, damping);
  }
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const JointPlace& place = joint_places_[j];
    const std::size_t k = joints_[j]->places().size();
    double* const rows = jacobian_.data() + place.jacobian_start;
    joints_[j]->constraint(motion_, local_.data(), rows);
    joints_[j]->curvature(motion_, multiplier.data() + place.first_row, matrix_.data());
    add(place, k, stiffness);
    for (int r = 0; r < joints_[j]->rows(); ++r)
      for (std::size_t i = 0; i < place.place.size(); ++i)
        jacobian.emplace_back(place.first_row + r, place.place[i],
                              rows[static_cast<std::size_t>(r) * k + static_cast<std::size_t>(place.local[i])]);
  }
  const Index n = mechanism_.size();
  Linearised result{SparseMatrix(n, n), SparseMatrix(n, n), SparseMatrix(mechanism_.constraint_count(), n)};
  result.damping.setFromTriplets(damping.begin(), damping.end());
  result.stiffness.setFromTriplets(stiffness.begin(), stiffness.end());
  result.jacobian.setFromTriplets(jacobian.begin(), jacobian.end());
  return result;
}

std::string MechanismEquations::non_finite_part() {
  for (const auto& force : forces_)
    if (!std::isfinite(model::value(force.law, motion_.t, motion_.side)))
      return "the force on \"" + mechanism_.coordinates()[static_cast<std::size_t>(force.coordinate)] + "\"";
  for (const auto& element : elements_) {
    element->force(motion_, local_.data());
    for (std::size_t i = 0; i < element->places().size(); ++i)
      if (!std::isfinite(local_[i])) return "the law of \"" + element->name() + "\"" + element->domain();
    element->tangent(motion_, 1.0, 1.0, local_.data(), matrix_.data());
    for (std::size_t i = 0; i < element->places().size() * element->places().size(); ++i)
      if (!std::isfinite(matrix_[i])) return "the slope of the law of \"" + element->name() + "\"";
  }
  return {};
}

double MechanismEquations::stored_energy() const {
  double energy = 0.0;
  for (const auto& element : elements_) energy += element->stored_energy(motion_);
  return energy;
}

void MechanismEquations::force_of(model::Element::Role role, Vector& out) {
  out.setZero();
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    if (elements_[e]->role() != role) continue;
    const ElementPlace& place = element_places_[e];
    elements_[e]->force(motion_, local_.data());
    for (std::size_t i = 0; i < place.place.size(); ++i)
      out[place.place[i]] += local_[static_cast<std::size_t>(place.local[i])];
  }
}

}  // namespace rubato::system
