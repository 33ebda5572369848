#include <rubato/analysis/mechanism_recorder.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace rubato::analysis {
namespace {

results::Block scalar(const std::string& variable, const std::string& unit, const std::string& description) {
  return {variable, unit, description, "", {}};
}

}  // namespace

MechanismRecorder::MechanismRecorder(const std::string& name, const MechanismPlan& plan,
                                     integrate::MechanismBalance& balance, results::Sink& sink)
    : joints_(balance.equations().mechanism()),
      observed_(joints_.with_angles(plan.transient.observed)),
      reactions_(balance.equations().mechanism()),
      frictions_(balance.equations().mechanism()),
      laws_(balance.equations().mechanism()),
      beams_(balance.equations().mechanism(), plan.section_forces, ""),
      balance_(balance) {
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
  joints_.add_displacements(layout);
  reactions_.add(layout);
  frictions_.add(layout);
  laws_.add(layout);
  beams_.add(layout);
  rows_ = sink.open(layout);
  if (!plan.transient.energy) return;
  energy_rows_ =
      sink.open({name,
                 "energy",
                 "time",
                 {time, scalar("kinetic", "J", "kinetic energy"),
                  scalar("strain", "J", "strain energy of beams, springs and elastic locks"),
                  scalar("damper_dissipated", "J", "dissipated by the dampers since the start"),
                  scalar("lock_dissipated", "J", "energy that locks took as they engaged and let go since the start"),
                  scalar("friction_dissipated", "J", "dissipated by the friction of joints since the start"),
                  scalar("load_work", "J", "work of loads, gravity and laws of joints since the start"),
                  scalar("drive_work", "J", "work of the drives that prescribe motions since the start"),
                  scalar("residue", "J", "what the method itself made (+) or lost (-)")},
                 {{"type", "energy"}}});
}

void MechanismRecorder::record(const system::State& state, const MechanismEnergy* energy, bool is_balanced) {
  balanced_ = state;
  if (!is_balanced) balance_.find_shown_acceleration(balanced_);
  joints_.go_to(state);
  joints_.positions(positions_);
  joints_.velocities(velocities_);
  joints_.accelerations(balanced_.acceleration, accelerations_);
  row_.clear();
  row_.push_back(state.t);
  observed_.append({&positions_, &velocities_, &accelerations_}, row_);
  joints_.append_displacements(row_);
  reactions_.append(joints_.motion(), balanced_.multiplier, row_);
  balance_.equations().go_to(balanced_, model::Side::right);
  frictions_.append(balance_.equations(), joints_.motion(), balanced_.multiplier, row_);
  laws_.append(joints_.motion(), row_);
  beams_.append(joints_.motion(), row_);
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
  for (const auto& friction : mechanism.model().frictions) joints.push_back(friction.label());
  const auto rows = sink.open(
      {name,
       "events",
       "time",
       {scalar("time", "s", "when it happened"),
        {"joint", "1", "whose lock or friction", "", {}, joints},
        {"event", "1", "what it did", "", {}, {"lets_go", "locks", "slips", "sticks"}},
        scalar("energy_lost", "J", "energy that a rigid lock took, or that a damped stop still held as it let go")},
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
