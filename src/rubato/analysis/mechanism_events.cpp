#include <rubato/analysis/mechanism_events.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace rubato::analysis {
namespace {

results::Block scalar(const std::string& variable, const std::string& unit, const std::string& description) {
  return {variable, unit, description, "", {}};
}

/// What the impact of a rigid lock took, or the spring of a damped stop still held as it let go.
std::string energy_told(const integrate::LockEvent& event) {
  if (!(event.energy_lost > 0.0)) return {};
  if (event.has_engaged) return fmt::format(", taking {:.4g} J", event.energy_lost);
  return fmt::format(", with {:.4g} J still in its spring, which its damper takes", event.energy_lost);
}

/// A time to one digit more than is known of it. What happens soon has three digits at least.
std::string told_time(double t, double known) {
  const int decimals = std::clamp(1 - static_cast<int>(std::floor(std::log10(known))), 0, 12);
  if (std::abs(t) < 100.0 * std::pow(10.0, -decimals)) return fmt::format("{:.3g}", t);
  std::string text = fmt::format("{:.{}f}", t, decimals);
  if (decimals > 0) text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

}  // namespace

void write_events(const std::string& name, const system::State& start, const std::vector<integrate::LockEvent>& events,
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
  const auto append = [&](const integrate::LockEvent& event) {
    const bool is_friction = event.friction >= 0;
    const double part = is_friction ? static_cast<double>(locks.size()) + event.friction : event.lock;
    const std::array<double, 4> row{event.t, part, (is_friction ? 2.0 : 0.0) + (event.has_engaged ? 1.0 : 0.0),
                                    event.energy_lost};
    rows->append(row);
  };
  for (std::size_t i = 0; i < start.phase.size(); ++i)
    if (start.phase[i] != model::lock_open) append({start.t, static_cast<int>(i)});
  for (const auto& event : events) append(event);
}

void report_events(const std::vector<integrate::LockEvent>& events, const system::Mechanism& mechanism, double known,
                   std::vector<std::string>& findings) {
  constexpr long most_told = 6;
  std::vector<long> changes(mechanism.model().frictions.size(), 0);
  for (const auto& event : events) {
    if (event.friction < 0) {
      findings.push_back(
          fmt::format("\"{}\" {} at t = {} s{}", mechanism.model().locks[static_cast<std::size_t>(event.lock)].name,
                      event.has_engaged ? "locks" : "lets go", told_time(event.t, known), energy_told(event)));
    } else if (++changes[static_cast<std::size_t>(event.friction)] <= most_told) {
      findings.push_back(fmt::format("\"{}\" {} at t = {} s",
                                     mechanism.model().frictions[static_cast<std::size_t>(event.friction)].label(),
                                     event.has_engaged ? "sticks" : "slips", told_time(event.t, known)));
    }
  }
  for (std::size_t i = 0; i < changes.size(); ++i)
    if (changes[i] > most_told)
      findings.push_back(
          fmt::format("\"{}\" sticks and slips {} times in all", mechanism.model().frictions[i].label(), changes[i]));
}

}  // namespace rubato::analysis
