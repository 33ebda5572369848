#include <rubato/integrate/mechanism/mechanism_stop_energy.hpp>

namespace rubato::integrate {

MechanismStopEnergy::MechanismStopEnergy(const system::Mechanism& mechanism)
    : mechanism_(mechanism), motion_(mechanism) {
  const auto& locks = mechanism.model().locks;
  for (std::size_t i = 0; i < locks.size(); ++i)
    if (locks[i].is_stop_part) stops_.push_back(i);
}

std::vector<Account> MechanismStopEnergy::accounts() const {
  return {{Account::Kind::stored, "stop_stored", "elastic energy of the stops"},
          {Account::Kind::dissipated, "stop_dissipated", "dissipated by the stops since the start"}};
}

double MechanismStopEnergy::stored(const model::Motion& motion, const std::vector<int>& phase) const {
  double sum = 0.0;
  for (const std::size_t i : stops_) {
    const model::Lock& stop = mechanism_.model().locks[i];
    const double depth = stop.depth(motion);
    if (phase[i] != model::lock_open && depth > 0.0) sum += 0.5 * stop.stiffness * depth * depth;
  }
  return sum;
}

void MechanismStopEnergy::add_stored(const system::State& state, Entries row) {
  row[0] += stored(motion_.go_to(state, model::Side::right), state.phase);
}

void MechanismStopEnergy::keep(const system::State& after) { last_phase_ = after.phase; }

void MechanismStopEnergy::add_flow(const system::State& before, const system::State& after, Entries row) {
  std::vector<double> depth(stops_.size()), force(stops_.size());
  const model::Motion& start = motion_.go_to(before, model::Side::right);
  for (std::size_t k = 0; k < stops_.size(); ++k) {
    depth[k] = mechanism_.model().locks[stops_[k]].depth(start);
    force[k] = mechanism_.model().locks[stops_[k]].push(start);
  }
  const double then = stored(start, before.phase);
  double dissipated = stored(start, last_phase_) - then;
  const model::Motion& end = motion_.go_to(after, model::Side::left);
  for (std::size_t k = 0; k < stops_.size(); ++k) {
    const model::Lock& stop = mechanism_.model().locks[stops_[k]];
    if (after.phase[stops_[k]] == model::lock_open) continue;
    dissipated += 0.5 * (force[k] + stop.push(end)) * (stop.depth(end) - depth[k]);
  }
  row[1] += dissipated - (stored(end, after.phase) - then);
}

}  // namespace rubato::integrate
