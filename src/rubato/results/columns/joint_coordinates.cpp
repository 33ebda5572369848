#include <rubato/results/columns/joint_coordinates.hpp>

#include <algorithm>
#include <utility>

namespace rubato::results {
namespace {

/// s'' of an angle in the plane, which is a difference of coordinates.
double second_rate(const model::PlaneCoordinate& s, const model::Motion& /*motion*/, const double* acceleration) {
  return acceleration[s.along.second.node.place[2]] - acceleration[s.along.first.node.place[2]];
}

double second_rate(const model::SpaceCoordinate& s, const model::Motion& motion, const double* acceleration) {
  return s.second_rate(motion, acceleration);
}

/// @param use  of each coordinate that is an angle, or of each that is none
template <class Use>
void for_each_coordinate(const model::Mechanism& model, bool is_angle, Use use) {
  for (const auto& joint : model.joint_coordinates)
    if (joint.s.is_angle() == is_angle) use(joint);
  for (const auto& joint : model.space_coordinates)
    if (joint.s.is_angle() == is_angle) use(joint);
}

std::vector<Observed> with_angles(std::vector<Observed> observed, const system::Mechanism& mechanism) {
  Index place = mechanism.size();
  for_each_coordinate(mechanism.model(), true, [&](const auto& joint) {
    observed.push_back({joint.name, place++, ground, true});
  });
  return observed;
}

}  // namespace

JointAngles::JointAngles(const system::Mechanism& mechanism, std::vector<Observed> observed,
                         std::vector<Quantity> quantities)
    : ObservedColumns(with_angles(std::move(observed), mechanism), std::move(quantities)),
      mechanism_(mechanism),
      motion_(mechanism),
      acceleration_(static_cast<std::size_t>(mechanism.size()) + 1, 0.0) {
  for_each_coordinate(mechanism.model(), true, [&](const auto&) { ++turning_; });
}

const Vector& JointAngles::values(Quantity quantity, const system::State& state, Vector& out) {
  const model::Motion& motion = motion_.go_to(state, model::Side::left);
  const Index n = mechanism_.size();
  out.resize(n + turning_);
  Index place = n;
  const auto add_angles = [&](auto value) {
    for_each_coordinate(mechanism_.model(), true, [&](const auto& joint) { out[place++] = value(joint.s); });
  };
  switch (quantity) {
    case Quantity::position:
      mechanism_.coordinate_values(state.q, coordinates_);
      out.head(n) = coordinates_;
      add_angles([&](const auto& s) { return s.value(motion.q); });
      break;
    case Quantity::velocity:
      out.head(n) = state.v;
      add_angles([&](const auto& s) { return s.rate(motion); });
      break;
    case Quantity::acceleration:
      out.head(n) = state.acceleration;
      std::copy(state.acceleration.data(), state.acceleration.data() + n, acceleration_.data() + 1);
      add_angles([&](const auto& s) { return second_rate(s, motion, acceleration_.data() + 1); });
      break;
  }
  return out;
}

void JointDisplacements::add(TableLayout& layout) const {
  std::vector<std::string> names;
  for_each_coordinate(mechanism_.model(), false, [&](const auto& joint) { names.push_back(joint.name); });
  if (!names.empty())
    layout.blocks.push_back({"displacement", "m", "displacement of each joint that slides", "sliding_joint", names});
}

void JointDisplacements::append(const system::State& state, std::vector<double>& row) {
  for_each_coordinate(mechanism_.model(), false,
                      [&](const auto& joint) { row.push_back(joint.s.value(state.q.data())); });
}

}  // namespace rubato::results
