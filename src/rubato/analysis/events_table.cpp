#include <rubato/analysis/events_table.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace rubato::analysis {
namespace {

using integrate::Change;

results::Block scalar(const std::string& variable, const std::string& unit, const std::string& description) {
  return {variable, unit, description, "", {}};
}

/// What the impact of a rigid lock took, or the spring of a damped stop still held as it let go.
std::string energy_told(const integrate::Event& event) {
  if (!(event.energy_lost > 0.0)) return {};
  if (event.change == Change::locks) return fmt::format(", taking {:.4g} J", event.energy_lost);
  return fmt::format(", with {:.4g} J still in its spring, which its damper takes", event.energy_lost);
}

/// Which lock of its joint a part is, where it has several.
std::string lock_told(const integrate::Events& events, std::size_t part) {
  const int place = events.place_of(part);
  return place > 0 ? fmt::format(", at lock({})", place) : "";
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

void write_events(const std::string& name, const integrate::Events& events, results::Sink& sink) {
  if (events.parts.empty()) return;
  results::TableLayout layout{
      name,
      "events",
      "time",
      {scalar("time", "s", "when it happened"),
       {"joint", "1", "whose lock or friction, or which slider or stop", "", {}, events.parts},
       {"event", "1", "what it did", "", {}, {"lets_go", "locks", "slips", "sticks", "opens", "closes"}},
       scalar("energy_lost", "J", "energy that a rigid lock took, or that a damped stop still held as it let go")},
      {{"type", "events"}}};
  if (events.are_of_contacts) {
    layout.blocks[1].description = "which slider or stop";
    layout.attributes.emplace_back("of", "contacts");
  }
  const bool has_places = !events.places.empty();
  if (has_places)
    layout.blocks.push_back(scalar("lock", "1", "which of the joint's several locks, as the study lists them; else 0"));
  const auto rows = sink.open(layout);
  for (const auto& event : events.all) {
    const std::array<double, 5> row{event.t, static_cast<double>(event.part), static_cast<double>(event.change),
                                    event.energy_lost, static_cast<double>(events.place_of(event.part))};
    rows->append(std::span(row).first(has_places ? 5 : 4));
  }
}

std::string warning_of(const integrate::Events& events) {
  if (events.left_out == 0) return {};
  return fmt::format("of {} events the table has the first {}, up to t = {:.9g} s",
                     events.left_out + static_cast<long>(events.all.size()), events.all.size(), events.all.back().t);
}

void report_events(const integrate::Events& events, double known, std::vector<std::string>& findings) {
  constexpr long most_told = 6;
  std::vector<long> changes(events.parts.size(), 0);
  std::vector<bool> is_of_lock(events.parts.size(), false), only_closes(events.parts.size(), true);
  for (std::size_t i = events.at_start; i < events.all.size(); ++i) {
    const integrate::Event& event = events.all[i];
    const bool is_lock = event.change == Change::locks || event.change == Change::lets_go;
    is_of_lock[event.part] = is_lock;
    const bool is_of_gap = event.change == Change::closes || event.change == Change::opens;
    if (!is_of_gap) only_closes[event.part] = false;
    if (++changes[event.part] <= most_told)
      findings.push_back(fmt::format("\"{}\" {} at t = {} s{}{}", events.parts[event.part],
                                     integrate::name_of(event.change), told_time(event.t, known),
                                     lock_told(events, event.part), is_lock || is_of_gap ? energy_told(event) : ""));
  }
  for (std::size_t i = 0; i < changes.size(); ++i)
    if (changes[i] > most_told)
      findings.push_back(fmt::format("\"{}\" {} {} times in all{}", events.parts[i],
                                     is_of_lock[i]    ? "locks and lets go"
                                     : only_closes[i] ? "closes and opens"
                                                      : "sticks and slips",
                                     changes[i], lock_told(events, i)));
}

}  // namespace rubato::analysis
