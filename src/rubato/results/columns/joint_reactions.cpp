#include <rubato/results/columns/joint_reactions.hpp>

#include <algorithm>

namespace rubato::results {
namespace {

/// Of a reaction in space.
constexpr std::array<const char*, 6> components{"x", "y", "z", "moment_x", "moment_y", "moment_z"};

bool is_drive(const std::string& row) { return row.starts_with("drive"); }

/// Of a joint that sticks: what friction does is told by JointFrictions, for one that slides has no such row.
bool is_friction(const std::string& row) { return row.starts_with("friction"); }

}  // namespace

JointReactions::JointReactions(const system::Mechanism& mechanism) : mechanism_(mechanism), motion_(mechanism) {
  Index row = 0;
  for (const auto& joint : mechanism.model().joints) {
    first_row_.push_back(row);
    for (const std::string& name : joint->row_names()) {
      const Index place = row++;
      if (is_friction(name)) continue;
      if (mechanism.model().dimension == 3 && !is_drive(name) && !name.starts_with("lock") && !name.starts_with("gear"))
        continue;
      auto found = std::find_if(rows_.begin(), rows_.end(), [&](const Rows& r) { return r.name == name; });
      if (found == rows_.end()) found = rows_.insert(found, Rows{name, {}, {}, name == "tension" ? 1.0 : -1.0});
      if (!found->joints.empty() && found->joints.back() == joint->name()) {  // several locks of one joint
        found->places.back().push_back(place);
        continue;
      }
      found->joints.push_back(joint->name());
      found->places.push_back({place});
    }
  }
}

void JointReactions::add(TableLayout& layout) const {
  if (mechanism_.model().dimension == 3) add_space(layout);
  for (const Rows& reaction : rows_) {
    const std::string unit = reaction.name.ends_with("moment") ? "N m" : "N";
    if (is_drive(reaction.name))
      layout.blocks.push_back({reaction.name, unit, "what each drive gives, + on the second part",
                               reaction.name + "_joint", reaction.joints});
    else
      layout.blocks.push_back(
          {"reaction_" + reaction.name, unit,
           reaction.name == "tension" ? "tension of each link" : "what each joint does to its second part",
           "reaction_" + reaction.name + "_joint", reaction.joints});
  }
}

void JointReactions::add_space(TableLayout& layout) const {
  std::vector<std::string> joints, links;
  for (const auto& reaction : mechanism_.model().reactions)
    (reaction.is_tension ? links : joints).push_back(mechanism_.model().joints[reaction.joint]->name());
  for (std::size_t i = 0; i < components.size() && !joints.empty(); ++i)
    layout.blocks.push_back({std::string("reaction_") + components[i], i < 3 ? "N" : "N m",
                             i < 3
                                 ? "force of each joint on its second part, by the axes of the world"
                                 : "moment of each joint on its second part about its point, by the axes of the world",
                             "reaction_joint", joints});
  if (!links.empty())
    layout.blocks.push_back({"reaction_tension", "N", "tension of each link", "reaction_tension_joint", links});
}

void JointReactions::append(const system::State& state, std::vector<double>& row) {
  if (mechanism_.model().dimension == 3) append_space(motion_.go_to(state, model::Side::left), state.multiplier, row);
  for (const Rows& reaction : rows_)
    for (const auto& places : reaction.places) {
      double sum = state.multiplier[places.front()];
      for (std::size_t i = 1; i < places.size(); ++i) sum += state.multiplier[places[i]];
      row.push_back(reaction.sign * sum);
    }
}

void JointReactions::append_space(const model::Motion& motion, const Vector& multiplier, std::vector<double>& row) {
  std::vector<std::array<double, 6>> wrenches;
  std::vector<double> tensions;
  for (const model::SpaceReaction& reaction : mechanism_.model().reactions) {
    const Index first = first_row_[reaction.joint];
    if (reaction.is_tension)
      tensions.push_back(multiplier[first]);
    else
      wrenches.push_back(wrench(reaction, first, motion, multiplier));
  }
  for (std::size_t i = 0; i < components.size(); ++i)
    for (const auto& one : wrenches) row.push_back(one[i]);
  row.insert(row.end(), tensions.begin(), tensions.end());
}

std::array<double, 6> JointReactions::wrench(const model::SpaceReaction& reaction, Index first_row,
                                             const model::Motion& motion, const Vector& multiplier) {
  constexpr std::size_t width = 12, of_second = 6;
  const auto& joint = *mechanism_.model().joints[reaction.joint];
  const auto rows = static_cast<std::size_t>(joint.rows());
  constraint_.resize(rows);
  jacobian_.resize(width * rows);
  joint.constraint(motion, constraint_.data(), jacobian_.data());
  numerics::Vector3 force = numerics::Vector3::Zero(), moment = force;
  for (std::size_t r = 0; r < rows; ++r) {
    const double value = multiplier[first_row + static_cast<Index>(r)];
    const double* const second = jacobian_.data() + width * r + of_second;
    for (Index i = 0; i < 3; ++i) {
      force[i] -= value * second[i];
      moment[i] -= value * second[i + 3];
    }
  }
  // The rows tell the moment about the node, by its axes.
  const auto turn = reaction.at.node.rotation(motion.q);
  moment = turn * moment - (turn * reaction.at.offset).cross(force);
  return {force[0], force[1], force[2], moment[0], moment[1], moment[2]};
}

}  // namespace rubato::results
