#include <rubato/analysis/mechanism_recorder.hpp>
#include <rubato/integrate/mechanism/mechanism_start.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace rubato::analysis {
namespace {

using Kind = model::PlaneCoordinate::Kind;

results::Block scalar(const std::string& variable, const std::string& unit, const std::string& description) {
  return {variable, unit, description, "", {}};
}

/// Angles of joints stand beside the rotations of nodes, after all coordinates.
std::vector<Observed> with_angles(std::vector<Observed> observed, const system::Mechanism& mechanism) {
  Index place = mechanism.size();
  for (const auto& joint : mechanism.model().joint_coordinates)
    if (joint.s.kind == Kind::angle) observed.push_back({joint.name, place++, ground, true});
  return observed;
}

std::vector<std::string> sliding_joints(const system::Mechanism& mechanism) {
  std::vector<std::string> names;
  for (const auto& joint : mechanism.model().joint_coordinates)
    if (joint.s.kind == Kind::displacement) names.push_back(joint.name);
  return names;
}

/// The frictions of angles, or of displacements.
std::vector<std::size_t> frictions_of(const system::Mechanism& mechanism, bool is_angle) {
  std::vector<std::size_t> all;
  const auto& frictions = mechanism.model().frictions;
  for (std::size_t i = 0; i < frictions.size(); ++i)
    if ((frictions[i].s.kind == Kind::angle) == is_angle) all.push_back(i);
  return all;
}

/// Extends a vector of coordinates by the differences that the angles of joints are.
void add_angles(const system::Mechanism& mechanism, const Vector& of_coordinates, Vector& out) {
  out.head(of_coordinates.size()) = of_coordinates;
  Index place = of_coordinates.size();
  for (const auto& joint : mechanism.model().joint_coordinates) {
    if (joint.s.kind != Kind::angle) continue;
    const auto turn = [&](const model::PlaneNode& node) {
      return node.place[2] == ground ? 0.0 : of_coordinates[node.place[2]];
    };
    out[place++] = turn(joint.s.along.second.node) - turn(joint.s.along.first.node);
  }
}

}  // namespace

MechanismRecorder::MechanismRecorder(const std::string& name, const MechanismPlan& plan,
                                     const system::Mechanism& mechanism, results::Sink& sink)
    : mechanism_(mechanism), observed_(with_angles(plan.transient.observed, mechanism)), equations_(mechanism) {
  using Quantity = ObservedBlocks::Quantity;
  const results::Block time = scalar("time", "s", "time");
  results::TableLayout layout{name,
                              "",
                              "time",
                              {time},
                              {{"type", "transient"},
                               {"method", plan.transient.method.name},
                               {"step", plan.transient.automatic ? summary(*plan.transient.automatic)
                                                                 : fmt::format("{} s", plan.transient.step)},
                               {"duration", fmt::format("{} s", plan.transient.duration)}}};
  observed_.add(layout, {Quantity::position, Quantity::velocity, Quantity::acceleration});
  add_joints(layout);
  rows_ = sink.open(layout);
  if (!plan.transient.energy) return;
  energy_rows_ = sink.open({name,
                            "energy",
                            "time",
                            {time, scalar("kinetic", "J", "kinetic energy"),
                             scalar("strain", "J", "strain energy of beams, springs and elastic locks"),
                             scalar("damper_dissipated", "J", "dissipated by the dampers since the start"),
                             scalar("lock_dissipated", "J", "kinetic energy that rigid locks took since the start"),
                             scalar("friction_dissipated", "J", "dissipated by the friction of joints since the start"),
                             scalar("load_work", "J", "work of loads, gravity and laws of joints since the start"),
                             scalar("drive_work", "J", "work of the drives that prescribe motions since the start"),
                             scalar("residue", "J", "what the method itself made (+) or lost (-)")},
                            {{"type", "energy"}}});
}

void MechanismRecorder::add_joints(results::TableLayout& layout) {
  const auto names = sliding_joints(mechanism_);
  if (!names.empty())
    layout.blocks.push_back({"displacement", "m", "displacement of each prismatic joint", "sliding_joint", names});
  Index row = 0;
  for (const auto& joint : mechanism_.model().joints)
    for (const std::string& name : joint->row_names()) {
      if (name.starts_with("friction")) {  // of one that sticks; what slides has no row
        ++row;
        continue;
      }
      auto found =
          std::find_if(reactions_.begin(), reactions_.end(), [&](const Reaction& r) { return r.name == name; });
      if (found == reactions_.end()) found = reactions_.insert(found, Reaction{name, {}, {}, -1.0});
      found->joints.push_back(joint->name());
      found->rows.push_back(row++);
    }
  for (Reaction& reaction : reactions_) {
    const bool is_tension = reaction.name == "tension", is_drive = reaction.name.starts_with("drive");
    const bool is_moment = reaction.name.ends_with("moment");
    if (is_tension) reaction.sign = 1.0;
    if (is_drive) {
      layout.blocks.push_back({reaction.name, is_moment ? "N m" : "N", "what each drive gives, + on the second part",
                               reaction.name + "_joint", reaction.joints});
      continue;
    }
    layout.blocks.push_back({"reaction_" + reaction.name, is_moment ? "N m" : "N",
                             is_tension ? "tension of each link" : "what each joint does to its second part",
                             "reaction_" + reaction.name + "_joint", reaction.joints});
  }
  for (const bool is_angle : {true, false}) {
    std::vector<std::string> joints;
    for (const std::size_t i : frictions_of(mechanism_, is_angle))
      joints.push_back(mechanism_.model().frictions[i].name);
    const std::string variable = is_angle ? "friction_moment" : "friction_force";
    if (!joints.empty())
      layout.blocks.push_back({variable, is_angle ? "N m" : "N", "what friction does to the second part of each joint",
                               variable + "_joint", joints});
  }
}

void MechanismRecorder::record(const system::State& state, const MechanismEnergy* energy, bool is_balanced) {
  balanced_ = state;
  if (!is_balanced && !integrate::find_acceleration(equations_, balanced_, model::Side::right)) balanced_ = state;
  mechanism_.coordinate_values(state.q, values_);
  const auto& joints = mechanism_.model().joint_coordinates;
  for (Vector* all : {&positions_, &velocities_, &accelerations_})
    all->resize(mechanism_.size() + static_cast<Index>(joints.size()));
  add_angles(mechanism_, values_, positions_);
  add_angles(mechanism_, state.v, velocities_);
  add_angles(mechanism_, balanced_.acceleration, accelerations_);
  Index place = mechanism_.size();
  for (const auto& joint : joints)
    if (joint.s.kind == Kind::angle) positions_[place++] = joint.s.value(state.q.data());
  row_.clear();
  row_.push_back(state.t);
  observed_.append({&positions_, &velocities_, &accelerations_}, row_);
  for (const auto& joint : joints)
    if (joint.s.kind == Kind::displacement) row_.push_back(joint.s.value(state.q.data()));
  for (const Reaction& reaction : reactions_)
    for (const Index row : reaction.rows) row_.push_back(reaction.sign * balanced_.multiplier[row]);
  equations_.go_to(balanced_, model::Side::right);
  for (const bool is_angle : {true, false})
    for (const std::size_t i : frictions_of(mechanism_, is_angle))
      row_.push_back(equations_.friction_force(i, balanced_.multiplier));
  rows_->append(row_);
  ++count_;
  if (!energy_rows_ || !energy) return;
  const std::array<double, 9> ledger{state.t,
                                     energy->kinetic,
                                     energy->strain,
                                     energy->damper_dissipated,
                                     energy->lock_dissipated,
                                     energy->friction_dissipated,
                                     energy->load_work,
                                     energy->drive_work,
                                     energy->residue()};
  energy_rows_->append(ledger);
}

void write_events(const std::string& name, const std::vector<integrate::LockEvent>& events,
                  const system::Mechanism& mechanism, results::Sink& sink) {
  const auto& locks = mechanism.model().locks;
  if (locks.empty() && mechanism.model().frictions.empty()) return;
  std::vector<std::string> joints;
  for (const auto& lock : locks) joints.push_back(lock.name);
  for (const auto& friction : mechanism.model().frictions) joints.push_back(friction.name);
  const auto rows = sink.open({name,
                               "events",
                               "time",
                               {scalar("time", "s", "when it happened"),
                                {"joint", "1", "whose lock or friction", "", {}, joints},
                                {"event", "1", "what it did", "", {}, {"released", "engaged", "slips", "sticks"}},
                                scalar("energy_lost", "J", "kinetic energy that the lock took")},
                               {{"type", "events"}}});
  for (const auto& event : events) {
    const bool is_friction = event.friction >= 0;
    const double part = is_friction ? static_cast<double>(locks.size()) + event.friction : event.lock;
    const std::array<double, 4> row{event.t, part, (is_friction ? 2.0 : 0.0) + (event.has_engaged ? 1.0 : 0.0),
                                    event.energy_lost};
    rows->append(row);
  }
}

}  // namespace rubato::analysis
