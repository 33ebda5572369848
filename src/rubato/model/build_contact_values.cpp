#include <rubato/model/build_contact_values.hpp>
#include <rubato/model/friction_coefficient.hpp>

#include <fmt/format.h>

#include <Eigen/Geometry>

#include <cmath>
#include <utility>

namespace rubato::model {

ContactReading::ContactReading(const ContactDescription& description, const numerics::Parameters& parameters,
                               int dimension)
    : d_(description),
      parameters_(parameters),
      dimension_(dimension),
      part_(fmt::format("contact \"{}\"", description.name)) {}

double ContactReading::number(const Quantity& quantity, const std::string& key) const {
  return evaluate(quantity, parameters_, part_ + ": " + key);
}
double ContactReading::positive(const Quantity& quantity, const std::string& key) const {
  const double value = number(quantity, key);
  if (!(value > 0.0))
    throw InvalidInput(quantity.where, fmt::format("{}: {} must be positive, got {}", part_, key, value));
  return value;
}

ContactValues ContactReading::values(Index directions) const {
  ContactValues values;
  values.directions = directions;
  values.normal_stiffness = positive(d_.normal_stiffness, "normal_stiffness");
  if (directions > 0) {
    values.tangential_stiffness = positive(*d_.tangential_stiffness, "tangential_stiffness");
    if (depends_on_rate(*d_.friction_coefficient))
      throw InvalidInput(d_.friction_coefficient->where,
                         fmt::format("{}: friction_coefficient depends on the rate, which contacts do not take; take a "
                                     "[[slider]] along the plane whose normal_load is a [[stop]] across it",
                                     part_));
    values.friction_coefficient =
        at_least_zero(*d_.friction_coefficient, parameters_, part_ + ": friction_coefficient");
  }
  if (d_.gap) values.gap = number(*d_.gap, "gap");
  if (d_.normal_damping)
    values.normal_damping = at_least_zero(*d_.normal_damping, parameters_, part_ + ": normal_damping");
  if (d_.sliding_velocity) {
    values.sliding_velocity = number(*d_.sliding_velocity, "sliding_velocity");
    if (!std::isfinite(values.sliding_velocity))
      throw InvalidInput(d_.sliding_velocity->where,
                         fmt::format("{}: sliding_velocity must be a number, got {}", part_, values.sliding_velocity));
  }
  if (d_.normal_load)
    values.gap = -at_least_zero(*d_.normal_load, parameters_, part_ + ": normal_load", "; give it a gap instead") /
                 values.normal_stiffness;
  return values;
}

Axis ContactReading::direction(const std::vector<Quantity>& given, const char* key, const Location& where) const {
  const auto wanted = static_cast<std::size_t>(dimension_);
  if (given.size() != wanted)
    throw InvalidInput(where, fmt::format("{}: {} takes {} numbers, as the positions of nodes do, got {}", part_, key,
                                          wanted, given.size()));
  Axis axis = Axis::Zero();
  for (std::size_t i = 0; i < wanted; ++i) axis[static_cast<Index>(i)] = number(given[i], key);
  const double length = axis.norm();
  if (!(length > 0.0)) throw InvalidInput(where, fmt::format("{}: its {} has no length", part_, key));
  return axis / length;
}

std::vector<Axis> ContactReading::along(const Axis& n) const {
  constexpr double least = 1e-6;
  if (dimension_ == 2) {
    if (!d_.tangential_direction.empty())
      throw InvalidInput(d_.tangential_direction_where,
                         fmt::format("{}: in the plane there is one direction across the normal, which need not be "
                                     "told; leave tangential_direction out",
                                     part_));
    return {Axis(-n[1], n[0], 0.0)};
  }
  Axis t = Axis::Zero();
  if (d_.tangential_direction.empty()) {
    Index least_along = 0;
    n.cwiseAbs().minCoeff(&least_along);
    t[least_along] = 1.0;
  } else {
    t = direction(d_.tangential_direction, "tangential_direction", d_.tangential_direction_where);
    if (std::abs(t.dot(n)) > least)
      throw InvalidInput(d_.tangential_direction_where,
                         fmt::format("{}: tangential_direction is not at a right angle to normal_direction (the "
                                     "cosine between them is {:.3g})",
                                     part_, t.dot(n)));
  }
  t = (t - t.dot(n) * n).normalized();
  return {t, n.cross(t)};
}

Axis ContactReading::normal() const {
  return direction(d_.normal_direction, "normal_direction", d_.normal_direction_where);
}

}  // namespace rubato::model
