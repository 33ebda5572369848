#include <rubato/integrate/mechanism/stop_impacts.hpp>

#include <cmath>
#include <vector>

namespace rubato::integrate {
namespace {

constexpr double nothing = 1e-9;  // of the terms of a sum that may cancel, of the largest impulse

class PressingStops {
 public:
  PressingStops(const system::Mechanism& mechanism, const system::State& given) : mechanism_(mechanism), given_(given) {
    const auto& locks = mechanism.model().locks;
    for (std::size_t i = 0; i < locks.size(); ++i)
      if (given.phase[i] == model::lock_engaged && !locks[i].is_latch && locks[i].is_rigid()) stops_.push_back(i);
  }

  const std::vector<std::size_t>& all() const { return stops_; }

  /// The engaged stop whose impulse pulls most; -1: none pulls.
  int pulling(const ConsistentStart& projected) const {
    const double most = projected.impulse.size() > 0 ? projected.impulse.cwiseAbs().maxCoeff() : 0.0;
    double strongest = -nothing * most;
    int found = -1;
    for (const std::size_t i : stops_) {
      const model::Lock& lock = mechanism_.model().locks[i];
      const double press = lock.sign * projected.impulse[mechanism_.first_row(lock.joint)];
      if (projected.state.phase[i] != model::lock_engaged || !(press < strongest)) continue;
      strongest = press;
      found = static_cast<int>(i);
    }
    return found;
  }

  /// The open stop that is met fastest, beside what round-off leaves of its rate; -1: none is met.
  int met(const system::State& state) const {
    double fastest = 1.0;
    int found = -1;
    for (const std::size_t i : stops_) {
      const double rate = share_of_unknown(i, state);
      if (state.phase[i] != model::lock_open || !(rate > fastest)) continue;
      fastest = rate;
      found = static_cast<int>(i);
    }
    return found;
  }

  bool is_left(std::size_t stop, const system::State& state) const { return share_of_unknown(stop, state) < -1.0; }

 private:
  /// The rate toward a stop over what round-off may leave of it.
  double share_of_unknown(std::size_t stop, const system::State& state) const {
    const model::Lock& lock = mechanism_.model().locks[stop];
    const std::vector<Index> places = lock.s.places();
    std::vector<double> slope(model::FreeCoordinate::most_places);
    lock.s.slope(state.q.data(), slope.data());
    double rate = 0.0, unknown = 0.0;
    for (std::size_t k = 0; k < places.size(); ++k) {
      if (places[k] < 0) continue;
      rate += lock.sign * slope[k] * state.v[places[k]];
      unknown += nothing * std::abs(slope[k]) * (std::abs(state.v[places[k]]) + std::abs(given_.v[places[k]]));
    }
    return unknown > 0.0 ? rate / unknown : 0.0;
  }

  const system::Mechanism& mechanism_;
  const system::State& given_;
  std::vector<std::size_t> stops_;
};

}  // namespace

ConsistentStart make_consistent_pressing(system::MechanismEquations& equations, const system::State& given,
                                         model::Side side) {
  const PressingStops stops(equations.mechanism(), given);
  ConsistentStart result = make_consistent(equations, given, side);
  if (stops.all().empty() || (result.is_consistent && stops.pulling(result) < 0)) return result;
  // From open stops: the joints and drives alone always leave velocities.
  system::State phases = given;
  for (const std::size_t i : stops.all()) phases.phase[i] = model::lock_open;
  const std::size_t most_changes = 20 * stops.all().size();
  bool is_solved = false;
  for (std::size_t change = 0; change <= most_changes && !is_solved; ++change) {
    result = make_consistent(equations, phases, side);
    if (!result.is_consistent) return result;
    const int pulling = stops.pulling(result), met = pulling < 0 ? stops.met(result.state) : -1;
    if (pulling >= 0)
      phases.phase[static_cast<std::size_t>(pulling)] = model::lock_open;
    else if (met >= 0)
      phases.phase[static_cast<std::size_t>(met)] = model::lock_engaged;
    else
      is_solved = true;
  }
  if (!is_solved) {
    result.is_consistent = false;
    return result;
  }
  system::State engaged = result.state;
  for (const std::size_t i : stops.all())
    engaged.phase[i] = stops.is_left(i, result.state) ? model::lock_open : model::lock_engaged;
  if (engaged.phase == result.state.phase) return result;
  ConsistentStart all = make_consistent(equations, engaged, side);  // what it changes is round-off
  result.state = std::move(all.state);
  result.redundant = std::move(all.redundant);
  result.energy_lost += all.energy_lost;
  result.drive_work += all.drive_work;
  result.is_consistent = all.is_consistent;
  return result;
}

}  // namespace rubato::integrate
