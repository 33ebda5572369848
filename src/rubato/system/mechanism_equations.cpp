#include <rubato/system/friction_places.hpp>
#include <rubato/system/mechanism_equations.hpp>

#include <algorithm>
#include <cmath>

namespace rubato::system {

void MechanismEquations::go_to(const State& state, model::Side side) {
  std::copy(state.v.data(), state.v.data() + state.v.size(), velocity_.data() + 1);
  motion_ = {state.t,
             side,
             state.q.data(),
             velocity_.data() + 1,
             state.phase.data(),
             state.rubbing.data(),
             state.stuck_at.data(),
             {nullptr, state.memory.data()}};
  if (pressed_by_reactions_.empty()) return;
  take_reactions(state, motion_, reactions_);
  guess_ = state.multiplier.size() == reactions_.size() ? state.multiplier : Vector::Zero(reactions_.size());
}

void MechanismEquations::scatter(const ElementPlace& place, const double* matrix, double weight) {
  double* const values = saddle_.values();
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
  add_pressed_by_reactions(guess_, -1.0, force);
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
  saddle_.begin(weights.mass);
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
  add_pressed_by_reactions(guess_, -1.0, force);
  if (weights.friction) linearise_pressed_by_reactions();
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
  const bool is_symmetric = saddle_.is_symmetric();  // then one of both is the spare place
  double* const values = saddle_.values();
  for (const Entry& entry : entries_) {
    const double value = jacobian_[static_cast<std::size_t>(entry.local)];
    values[entry.slot] += value;
    if (!is_symmetric) values[entry.transposed] += value;
    saddle_.see(entry.row, entry.place, value);
  }
  // An open lock says nothing: multiplier = 0.
  for (std::size_t j = 0; j < joints_.size(); ++j)
    if (!joints_[j]->is_active(motion_)) saddle_.open_rows(joint_places_[j].first_row, joints_[j]->rows());
  saddle_.end(weights.constraint > 0.0 ? weights.constraint : weights.mass);
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
  add_pressed_by_reactions(multiplier, factor, out);
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
  add_force_of(role, out);
}

void MechanismEquations::force_of_loads(Vector& out) {
  external_force(out);
  out = -out;
  add_force_of(model::Element::Role::load, out);
  add_laws_of_time(out);
}

void MechanismEquations::add_force_of(model::Element::Role role, Vector& out) {
  for (std::size_t e = 0; e < elements_.size(); ++e)
    if (elements_[e]->role() == role) add_force_of(e, out);
}

void MechanismEquations::add_force_of(std::size_t element, Vector& out) {
  const ElementPlace& place = element_places_[element];
  elements_[element]->force(motion_, local_.data());
  for (std::size_t i = 0; i < place.place.size(); ++i)
    out[place.place[i]] += local_[static_cast<std::size_t>(place.local[i])];
}

}  // namespace rubato::system
