#include <rubato/integrate/mechanism/mechanism_events.hpp>

#include <algorithm>

namespace rubato::integrate {
namespace {

/// Which of the several locks of its joint each lock is, from 1, as the study lists them; none where no joint has
/// several.
std::vector<int> places_of(const std::vector<model::Lock>& locks) {
  std::vector<int> places(locks.size(), 0);
  bool has_several = false;
  for (std::size_t i = 0; i < locks.size(); ++i) {
    const auto is_of_joint = [&](const model::Lock& other) { return other.name == locks[i].name; };
    if (std::count_if(locks.begin(), locks.end(), is_of_joint) < 2) continue;
    places[i] =
        1 + static_cast<int>(std::count_if(locks.begin(), locks.begin() + static_cast<std::ptrdiff_t>(i), is_of_joint));
    has_several = true;
  }
  return has_several ? places : std::vector<int>{};
}

}  // namespace

namespace {

Change change_of(const model::Lock& lock, bool has_engaged) {
  if (lock.is_stop_part) return has_engaged ? Change::closes : Change::opens;
  return has_engaged ? Change::locks : Change::lets_go;
}

}  // namespace

Events events_of(std::span<const LockEvent> events, const system::Mechanism& mechanism, const system::State* start) {
  const auto& locks = mechanism.model().locks;
  Events result;
  for (const auto& lock : locks) result.parts.push_back(lock.name);
  result.places = places_of(locks);
  for (const auto& friction : mechanism.model().frictions) result.parts.push_back(friction.label());
  if (!result.places.empty()) result.places.resize(result.parts.size(), 0);
  for (std::size_t i = 0; start && i < locks.size(); ++i)
    if (start->phase[i] != model::lock_open) result.add({start->t, i, change_of(locks[i], true)});
  result.at_start = result.all.size();
  for (const LockEvent& event : events) {
    const bool is_lock = event.friction < 0;
    const auto part =
        is_lock ? static_cast<std::size_t>(event.lock) : locks.size() + static_cast<std::size_t>(event.friction);
    const Change change =
        is_lock ? change_of(locks[part], event.has_engaged) : (event.has_engaged ? Change::sticks : Change::slips);
    result.add({event.t, part, change, event.energy_lost});
  }
  return result;
}

}  // namespace rubato::integrate
