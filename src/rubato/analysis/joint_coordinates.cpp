#include <rubato/analysis/joint_coordinates.hpp>

#include <algorithm>

namespace rubato::analysis {
namespace {

/// s'' of an angle in the plane, which is a difference of coordinates.
double second_rate(const model::PlaneCoordinate& s, const double* acceleration) {
  return acceleration[s.along.second.node.place[2]] - acceleration[s.along.first.node.place[2]];
}

template <class Use>
void for_each_coordinate(const model::Mechanism& model, Use use) {
  for (const auto& joint : model.joint_coordinates) use(joint);
  for (const auto& joint : model.space_coordinates) use(joint);
}

}  // namespace

JointCoordinates::JointCoordinates(const system::Mechanism& mechanism) : mechanism_(mechanism) {
  for_each_coordinate(mechanism.model(),
                      [this](const auto& joint) { (joint.s.is_angle() ? turning_ : sliding_).push_back(joint.name); });
  velocity_.assign(static_cast<std::size_t>(mechanism.size()) + 1, 0.0);
  acceleration_ = velocity_;
}

std::vector<Observed> JointCoordinates::with_angles(std::vector<Observed> observed) const {
  Index place = mechanism_.size();
  for (const std::string& name : turning_) observed.push_back({name, place++, ground, true});
  return observed;
}

void JointCoordinates::add_displacements(results::TableLayout& layout) const {
  if (!sliding_.empty())
    layout.blocks.push_back({"displacement", "m", "displacement of each joint that slides", "sliding_joint", sliding_});
}

void JointCoordinates::go_to(const system::State& state) {
  state_ = &state;
  std::copy(state.v.data(), state.v.data() + state.v.size(), velocity_.data() + 1);
  motion_ = {state.t,
             model::Side::left,
             state.q.data(),
             velocity_.data() + 1,
             state.phase.data(),
             state.rubbing.data(),
             state.stuck_at.data()};
}

void JointCoordinates::positions(Vector& out) {
  mechanism_.coordinate_values(state_->q, values_);
  out.resize(mechanism_.size() + static_cast<Index>(turning_.size()));
  out.head(mechanism_.size()) = values_;
  Index place = mechanism_.size();
  for_each_coordinate(mechanism_.model(), [&](const auto& joint) {
    if (joint.s.is_angle()) out[place++] = joint.s.value(motion_.q);
  });
}

void JointCoordinates::velocities(Vector& out) const {
  out.resize(mechanism_.size() + static_cast<Index>(turning_.size()));
  out.head(mechanism_.size()) = state_->v;
  Index place = mechanism_.size();
  for_each_coordinate(mechanism_.model(), [&](const auto& joint) {
    if (joint.s.is_angle()) out[place++] = joint.s.rate(motion_);
  });
}

void JointCoordinates::accelerations(const Vector& acceleration, Vector& out) {
  out.resize(mechanism_.size() + static_cast<Index>(turning_.size()));
  out.head(mechanism_.size()) = acceleration;
  std::copy(acceleration.data(), acceleration.data() + acceleration.size(), acceleration_.data() + 1);
  const double* const padded = acceleration_.data() + 1;
  Index place = mechanism_.size();
  for (const auto& joint : mechanism_.model().joint_coordinates)
    if (joint.s.is_angle()) out[place++] = second_rate(joint.s, padded);
  for (const auto& joint : mechanism_.model().space_coordinates)
    if (joint.s.is_angle()) out[place++] = joint.s.second_rate(motion_, padded);
}

void JointCoordinates::append_displacements(std::vector<double>& row) const {
  for_each_coordinate(mechanism_.model(), [&](const auto& joint) {
    if (!joint.s.is_angle()) row.push_back(joint.s.value(motion_.q));
  });
}

}  // namespace rubato::analysis
