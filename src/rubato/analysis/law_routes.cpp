#include <rubato/analysis/law_routes.hpp>

#include <fmt/format.h>

#include <array>
#include <cstddef>

namespace rubato::analysis {
namespace {

struct RouteInfo {
  const char* name;
  const char* title;
};

constexpr std::array<RouteInfo, route_count> routes{{{"steps", "a transient with steps"},
                                                     {"exact", "the method exact"},
                                                     {"static", "a static analysis"},
                                                     {"modes", "modes"},
                                                     {"periodic", "the solver periodic"},
                                                     {"harmonic_balance", "the solver harmonic_balance"},
                                                     {"time_marching", "the solver time_marching"},
                                                     {"damper_curve", "a damper curve"},
                                                     {"method_study", "a method study"}}};

constexpr const char* a_march = "take solver = \"time_marching\"";
constexpr const char* balance_or_march = "take solver = \"harmonic_balance\" or \"time_marching\"";
constexpr const char* small_steps = "take \"generalized_alpha\" with step = { tolerance = ... }";
constexpr const char* located = "take \"generalized_alpha\" with step = { tolerance = ..., events = \"locate\" }";
constexpr const char* marched_sweep = "take a frequency_response with solver = \"time_marching\" and a sweep";
constexpr const char* balanced_sweep = "take a frequency_response with solver = \"harmonic_balance\" and a sweep";
constexpr const char* transient = "take a transient";

// By Element, then by Route.
constexpr std::array<std::array<Handling, route_count>, element_count> table{{{{{"yes", ""},
                                                                                {"yes", ""},
                                                                                {"yes", ""},
                                                                                {"stuck, free", ""},
                                                                                {"yes", ""},
                                                                                {"closed form", ""},
                                                                                {"yes", ""},
                                                                                {"yes", ""},
                                                                                {"", ""}}},
                                                                              {{{"yes", ""},
                                                                                {"", located},
                                                                                {"yes", ""},
                                                                                {"open", ""},
                                                                                {"", a_march},
                                                                                {"", a_march},
                                                                                {"yes", ""},
                                                                                {"", marched_sweep},
                                                                                {"", ""}}},
                                                                              {{{"yes", ""},
                                                                                {"", small_steps},
                                                                                {"yes", ""},
                                                                                {"slopes at rest", ""},
                                                                                {"", balance_or_march},
                                                                                {"by samples", ""},
                                                                                {"yes", ""},
                                                                                {"", balanced_sweep},
                                                                                {"", ""}}},
                                                                              {{{"yes", ""},
                                                                                {"", small_steps},
                                                                                {"yes", ""},
                                                                                {"stuck, free", ""},
                                                                                {"", transient},
                                                                                {"", transient},
                                                                                {"", transient},
                                                                                {"", transient},
                                                                                {"", ""}}},
                                                                              {{{"yes", ""},
                                                                                {"", small_steps},
                                                                                {"as it is", ""},
                                                                                {"as it is", ""},
                                                                                {"", transient},
                                                                                {"", transient},
                                                                                {"", transient},
                                                                                {"", transient},
                                                                                {"", ""}}}}};

/// The first element of a structure that a route refuses, as messages call it.
struct Refused {
  Element element;
  std::string name;
};
std::optional<Refused> refused_by(Route route, const system::LocallyNonlinear& system) {
  const auto refuses = [&](Element element) { return *handling(element, route).how == '\0'; };
  if (system.slider_count() > 0 && refuses(Element::slider))
    return Refused{Element::slider, fmt::format("{} slider(s)", system.slider_count())};
  if (system.stop_count() > 0 && refuses(Element::stop))
    return Refused{Element::stop, fmt::format("the stop \"{}\"", system.stops().front().name)};
  if (system.law_count() > 0 && refuses(Element::law))
    return Refused{Element::law, fmt::format("the {} \"{}\"", system.laws().front().kind, system.laws().front().name)};
  return std::nullopt;
}

}  // namespace

const Handling& handling(Element element, Route route) {
  return table[static_cast<std::size_t>(element)][static_cast<std::size_t>(route)];
}

const char* name_of(Route route) { return routes[static_cast<std::size_t>(route)].name; }
const char* title_of(Route route) { return routes[static_cast<std::size_t>(route)].title; }

std::optional<std::string> refusal(Route route, const system::LocallyNonlinear& system) {
  const auto refused = refused_by(route, system);
  if (!refused) return std::nullopt;
  if (route == Route::method_study)
    return fmt::format("{} needs a linear model with a closed-form response, this one has {}", title_of(route),
                       refused->name);
  return fmt::format("{} knows sliders, and the model has {}; {}", title_of(route), refused->name,
                     handling(refused->element, route).instead);
}

std::optional<std::string> refusal_of_time(const system::LocallyNonlinear& system) {
  for (const model::LawBetween& law : system.laws())
    if (law.law->depends_on_time())
      return fmt::format(
          "the {} \"{}\" depends on t, and a steady response repeats with the loads; write it without t, or run a "
          "transient",
          law.kind, law.name);
  return std::nullopt;
}

}  // namespace rubato::analysis
