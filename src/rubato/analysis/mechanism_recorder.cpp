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
                             scalar("load_work", "J", "work of loads, gravity and drives since the start"),
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
      auto found =
          std::find_if(reactions_.begin(), reactions_.end(), [&](const Reaction& r) { return r.name == name; });
      if (found == reactions_.end()) found = reactions_.insert(found, Reaction{name, {}, {}, -1.0});
      found->joints.push_back(joint->name());
      found->rows.push_back(row++);
    }
  for (Reaction& reaction : reactions_) {
    const bool is_tension = reaction.name == "tension", is_moment = reaction.name == "moment";
    if (is_tension) reaction.sign = 1.0;
    layout.blocks.push_back({"reaction_" + reaction.name, is_moment ? "N m" : "N",
                             is_tension ? "tension of each link" : "what each joint does to its second part",
                             "reaction_" + reaction.name + "_joint", reaction.joints});
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
  rows_->append(row_);
  ++count_;
  if (!energy_rows_ || !energy) return;
  const std::array<double, 7> ledger{
      state.t,           energy->kinetic,  energy->strain, energy->damper_dissipated, energy->lock_dissipated,
      energy->load_work, energy->residue()};
  energy_rows_->append(ledger);
}

void write_events(const std::string& name, const std::vector<integrate::LockEvent>& events,
                  const system::Mechanism& mechanism, results::Sink& sink) {
  if (mechanism.model().locks.empty()) return;
  std::vector<std::string> joints;
  for (const auto& lock : mechanism.model().locks) joints.push_back(lock.name);
  const auto rows = sink.open({name,
                               "events",
                               "time",
                               {scalar("time", "s", "when it happened"),
                                {"joint", "1", "whose lock", "", {}, joints},
                                {"event", "1", "what it did", "", {}, {"released", "engaged"}},
                                scalar("energy_lost", "J", "kinetic energy that the lock took")},
                               {{"type", "events"}}});
  for (const auto& event : events) {
    const std::array<double, 4> row{event.t, static_cast<double>(event.lock), event.has_engaged ? 1.0 : 0.0,
                                    event.energy_lost};
    rows->append(row);
  }
}

}  // namespace rubato::analysis
