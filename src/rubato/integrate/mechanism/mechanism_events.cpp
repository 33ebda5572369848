#include <rubato/integrate/mechanism/mechanism_events.hpp>

namespace rubato::integrate {

Events events_of(std::span<const LockEvent> events, const system::Mechanism& mechanism, const system::State* start) {
  const auto& locks = mechanism.model().locks;
  Events result;
  for (const auto& lock : locks) result.parts.push_back(lock.name);
  for (const auto& friction : mechanism.model().frictions) result.parts.push_back(friction.label());
  for (std::size_t i = 0; start && i < locks.size(); ++i)
    if (start->phase[i] != model::lock_open) result.add({start->t, i, Change::locks});
  result.at_start = result.all.size();
  for (const LockEvent& event : events) {
    const bool is_lock = event.friction < 0;
    const auto part =
        is_lock ? static_cast<std::size_t>(event.lock) : locks.size() + static_cast<std::size_t>(event.friction);
    const Change change = is_lock ? (event.has_engaged ? Change::locks : Change::lets_go)
                                  : (event.has_engaged ? Change::sticks : Change::slips);
    result.add({event.t, part, change, event.energy_lost});
  }
  return result;
}

}  // namespace rubato::integrate
