#include <rubato/analysis/law_routes.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace rubato::analysis {
namespace {

using integrate::NonlinearPart;

struct RouteInfo {
  const char* name;
  const char* title;
};

constexpr std::array<RouteInfo, route_count> routes{
    RouteInfo{"steps", "a transient with steps"},
    RouteInfo{"exact", "the method exact"},
    RouteInfo{"static", "a static analysis"},
    RouteInfo{"modes", "modes"},
    RouteInfo{"periodic", "the solver periodic"},
    RouteInfo{"harmonic_balance", "the solver harmonic_balance"},
    RouteInfo{"time_marching", "the solver time_marching"},
    RouteInfo{"damper_curve", "a damper curve"},
    RouteInfo{"method_study", "a method study"},
};

constexpr const char* balance_or_march = "take solver = \"harmonic_balance\" or \"time_marching\"";
constexpr const char* small_steps = "take \"generalized_alpha\" with step = { tolerance = ... }";
constexpr const char* located = "take \"generalized_alpha\" with step = { tolerance = ..., events = \"locate\" }";
constexpr const char* stiff_friction =
    "before it slips it has no stiffness, about which small motions are: take a [[slider]] with a stiffness between "
    "coordinates of its parts, or a transient";

constexpr Handling takes(const char* how) { return {how, ""}; }
constexpr Handling refuses(const char* instead = "") { return {"", instead}; }

// What an element meets on each route, in the order of Route.
using Row = std::array<Handling, route_count>;
constexpr Row slider{
    takes("yes"),          // steps
    takes("yes"),          // exact
    takes("yes"),          // equilibrium
    takes("stuck, free"),  // modes
    takes("yes"),          // periodic
    takes("closed form"),  // harmonic_balance
    takes("yes"),          // time_marching
    takes("yes"),          // damper_curve
    refuses(),             // method_study
};
constexpr Row stop{
    takes("yes"),               // steps
    refuses(located),           // exact
    takes("yes"),               // equilibrium
    takes("open"),              // modes
    refuses(balance_or_march),  // periodic
    takes("by samples"),        // harmonic_balance
    takes("yes"),               // time_marching
    takes("by samples"),        // damper_curve
    refuses(),                  // method_study
};
constexpr Row law{
    takes("yes"),               // steps
    refuses(small_steps),       // exact
    takes("yes"),               // equilibrium
    takes("slopes at rest"),    // modes
    refuses(balance_or_march),  // periodic
    takes("by samples"),        // harmonic_balance
    takes("yes"),               // time_marching
    takes("by samples"),        // damper_curve
    refuses(),                  // method_study
};
constexpr Row contact{
    takes("yes"),               // steps
    refuses(small_steps),       // exact
    takes("yes"),               // equilibrium
    takes("stuck, free"),       // modes
    refuses(balance_or_march),  // periodic
    takes("by samples"),        // harmonic_balance
    takes("yes"),               // time_marching
    takes("by samples"),        // damper_curve
    refuses(),                  // method_study
};
constexpr Row pressed_slider{
    takes("yes"),               // steps
    refuses(small_steps),       // exact
    takes("yes"),               // equilibrium
    takes("stuck, free"),       // modes
    refuses(balance_or_march),  // periodic
    takes("by samples"),        // harmonic_balance
    takes("yes"),               // time_marching
    takes("by samples"),        // damper_curve
    refuses(),                  // method_study
};
constexpr Row joint_friction{
    takes("yes"),             // steps
    refuses(small_steps),     // exact
    takes("yes"),             // equilibrium
    takes("stuck, free"),     // modes
    refuses(stiff_friction),  // periodic
    refuses(stiff_friction),  // harmonic_balance
    refuses(stiff_friction),  // time_marching
    refuses(stiff_friction),  // damper_curve
    refuses(),                // method_study
};
constexpr Row lock{
    takes("yes"),          // steps
    refuses(small_steps),  // exact
    takes("as it is"),     // equilibrium
    takes("as it is"),     // modes
    takes("as it is"),     // periodic
    takes("as it is"),     // harmonic_balance
    takes("as it is"),     // time_marching
    takes("as it is"),     // damper_curve
    refuses(),             // method_study
};
// In the order of Element.
constexpr std::array<Row, element_count> table{slider, stop, law, contact, pressed_slider, joint_friction, lock};

/// As messages call it.
std::string label_of(const NonlinearPart& part, const std::vector<NonlinearPart>& all) {
  const auto is_alike = [&](const NonlinearPart& other) { return other.family == part.family; };
  switch (part.family) {
    case Element::slider:
      return fmt::format("{} slider(s)", std::count_if(all.begin(), all.end(), is_alike));
    case Element::stop:
    case Element::law:
    case Element::contact:
      return fmt::format("the {} \"{}\"", part.kind, part.name);
    case Element::pressed_slider:
      return fmt::format("the {} \"{}\", whose normal load does not stay the same", part.kind, part.name);
    case Element::joint_friction:
    case Element::lock:
      break;
  }
  return fmt::format("the {} of the joint \"{}\"", part.kind, part.name);
}

}  // namespace

const Handling& handling(Element element, Route route) {
  return table[static_cast<std::size_t>(element)][static_cast<std::size_t>(route)];
}

const char* name_of(Route route) { return routes[static_cast<std::size_t>(route)].name; }
const char* title_of(Route route) { return routes[static_cast<std::size_t>(route)].title; }

std::optional<std::string> refusal(Route route, const integrate::SystemKind& kind) {
  const std::vector<NonlinearPart> parts = kind.nonlinear_parts();
  // About an equilibrium a lock that is a spring is a stop.
  const auto of = [&](const NonlinearPart& part) {
    const bool is_stop = part.is_spring && route == Route::periodic;
    return handling(is_stop ? Element::stop : part.family, route);
  };
  const auto refused =
      std::find_if(parts.begin(), parts.end(), [&](const NonlinearPart& part) { return *of(part).how == '\0'; });
  if (refused == parts.end()) return std::nullopt;
  const std::string label = label_of(*refused, parts);
  if (route == Route::method_study)
    return fmt::format("{} needs a linear model with a closed-form response, this one has {}", title_of(route), label);
  return fmt::format("{} does not take {}; {}", title_of(route), label, of(*refused).instead);
}

std::optional<std::string> refusal_of_steady_response(const integrate::SystemKind& kind) {
  for (const NonlinearPart& part : kind.nonlinear_parts())
    if (*part.why_no_steady_response != '\0')
      return fmt::format("the {} \"{}\" {}", part.kind, part.name, part.why_no_steady_response);
    else if (part.depends_on_time && part.family == NonlinearPart::Family::contact)
      return fmt::format(
          "the contact \"{}\" slides on with its sliding_velocity, which steady responses do not carry yet; leave it "
          "out, or run a transient; modes with contacts = [{{ sliding = {{ {} = 1 }} }}] tell whether it flutters",
          part.name, part.name);
    else if (part.depends_on_time)
      return fmt::format(
          "the {} \"{}\" depends on t, and a steady response repeats with the loads; write it without t, or run a "
          "transient",
          part.kind, part.name);
  return std::nullopt;
}

}  // namespace rubato::analysis
