#include <rubato/analysis/observed.hpp>
#include <rubato/core/error.hpp>

#include <fmt/format.h>

#include <algorithm>

namespace rubato::analysis {

Observed observed_of(const model::ObservationDescription& description, const Observable& in) {
  const bool has_supports = in.supports_are == Supports::observed && in.supports;
  const auto index_of = [&](const std::string& name) {
    std::vector<std::string> known = in.system.coordinates();
    if (has_supports) known.insert(known.end(), in.supports->names().begin(), in.supports->names().end());
    const auto found = std::find(known.begin(), known.end(), name);
    if (found != known.end()) return static_cast<Index>(found - known.begin());
    if (in.supports && std::count(in.supports->names().begin(), in.supports->names().end(), name) > 0)
      throw InvalidInput(description.where, fmt::format("observe names \"{}\", which moves as its [[displacement]] "
                                                        "says; only transients show it",
                                                        name));
    const bool lacks_spaces = name.find('-') != std::string::npos && nearest_name(name, known).empty();
    throw InvalidInput(description.where,
                       fmt::format("observe names \"{}\", which is no coordinate{}{}", name, suggestion(name, known),
                                   lacks_spaces ? "; a difference is written with spaces, \"a - b\"" : ""));
  };
  const auto turns = [&](Index i) {
    return i < in.system.size() ? in.system.is_rotation(i) : in.supports->is_rotation(i - in.system.size());
  };
  const Index first = index_of(description.first);
  if (description.second.empty()) return {description.first, first, ground, turns(first)};
  const Index second = index_of(description.second);
  if (turns(first) != turns(second))
    throw InvalidInput(
        description.where,
        fmt::format("observe: \"{} - {}\" is the difference of a {} [m] and a rotation [rad]", description.first,
                    description.second, in.system.is_flat() ? "displacement" : "position"));
  return {description.first + " - " + description.second, first, second, turns(first)};
}

std::vector<Observed> every_coordinate(const system::System& system) {
  std::vector<Observed> observed;
  for (Index i = 0; i < system.size(); ++i)
    observed.push_back({system.coordinates()[static_cast<std::size_t>(i)], i, ground, system.is_rotation(i)});
  return observed;
}

std::vector<Observed> observed_or_all(const std::optional<std::vector<model::ObservationDescription>>& wanted,
                                      const Observable& in) {
  std::vector<Observed> observed;
  if (wanted) {
    for (const auto& observation : *wanted) observed.push_back(observed_of(observation, in));
  } else {
    observed = every_coordinate(in.system);
    const bool has_supports = in.supports_are == Supports::observed && in.supports;
    for (Index i = 0; has_supports && i < in.supports->size(); ++i)
      observed.push_back({in.supports->names()[static_cast<std::size_t>(i)], in.system.size() + i, ground,
                          in.supports->is_rotation(i)});
  }
  std::stable_partition(observed.begin(), observed.end(), [](const Observed& one) { return !one.is_rotation; });
  return observed;
}

}  // namespace rubato::analysis
