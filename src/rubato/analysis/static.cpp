#include <rubato/analysis/static.hpp>
#include <rubato/analysis/transient_plan.hpp>
#include <rubato/results/columns/contact_columns.hpp>
#include <rubato/results/columns/law_columns.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rubato::analysis {
namespace {

constexpr std::size_t most_names = 6;

std::string list_of(const std::vector<Index>& coordinates, const system::LocallyNonlinear& system) {
  std::string list;
  for (std::size_t i = 0; i < std::min(coordinates.size(), most_names); ++i)
    list += fmt::format("{}\"{}\"", i == 0 ? "" : ", ", system.coordinates()[static_cast<std::size_t>(coordinates[i])]);
  if (coordinates.size() > most_names) list += fmt::format(" and {} more", coordinates.size() - most_names);
  return list;
}

std::string slipping(const StaticEquilibrium& found, const system::LocallyNonlinear& system) {
  std::string list;
  for (std::size_t i = 0; i < system.sliders().size(); ++i) {
    const double u = system.relative_displacement(static_cast<Index>(i), found.state.q);
    if (!(std::abs(system.sliders()[i].stiffness * u) > system.sliders()[i].limit)) continue;
    list += fmt::format("{}\"{}\"", list.empty() ? "" : ", ", system.sliders()[i].name);
  }
  return list;
}

std::vector<model::Held> held_of(const std::string& title, const model::StaticDescription& description,
                                 const system::LocallyNonlinear& system) {
  if (!description.displacements) return system.held_displacements();
  std::vector<std::string> known;
  for (const auto& held : system.held_displacements())
    known.push_back(system.coordinates()[static_cast<std::size_t>(held.coordinate)]);
  std::vector<model::Held> chosen;
  for (const auto& wanted : *description.displacements) {
    const auto found = std::find(known.begin(), known.end(), wanted.first);
    if (found == known.end())
      throw InvalidInput(wanted.where,
                         fmt::format("{}displacements names \"{}\", of which there is no [[displacement]]{}", title,
                                     wanted.first, suggestion(wanted.first, known)));
    chosen.push_back(system.held_displacements()[static_cast<std::size_t>(found - known.begin())]);
  }
  return chosen;
}

}  // namespace

StaticEquilibrium equilibrium_of(const std::string& name, const Location& where,
                                 const model::StaticDescription& description, const system::LocallyNonlinear& system) {
  const std::string title = "analysis \"" + name + "\": ";
  if (description.section_forces.is_wanted())
    throw InvalidInput(description.section_forces.where,
                       title + "section_forces are kept of geometrically exact beams, in mechanisms; leave it out");
  const std::vector<model::Held> held = held_of(title, description, system);
  StaticEquilibrium found = find_equilibrium(system, held);
  switch (found.outcome) {
    case StaticOutcome::found:
      break;
    case StaticOutcome::mechanism:
      throw InvalidInput(where, fmt::format("{}the structure is a mechanism: nothing resists a motion of {}; support "
                                            "it, join it, or hold a displacement",
                                            title, list_of(found.moving, system)));
    case StaticOutcome::gives_way:
      throw InvalidInput(where, fmt::format("{}there is no equilibrium: where {} slip nothing else resists a motion of "
                                            "{}; lower the load, or support it",
                                            title, slipping(found, system), list_of(found.moving, system)));
    case StaticOutcome::gives_way_on_the_way:
      throw InvalidInput(
          where, fmt::format("{}there is no equilibrium that loads grown from zero lead to: at {:.4g} of them nothing "
                             "resists a motion of {}; lower the loads, support it, or let a transient with damping "
                             "find where it goes",
                             title, found.reached, list_of(found.moving, system)));
    case StaticOutcome::not_settled:
      throw InvalidInput(
          where, fmt::format("{}no equilibrium was found: which sliders slip and which stops are closed did not settle",
                             title));
  }
  if (!found.state.q.allFinite())
    throw InvalidInput(where, fmt::format("{}the equilibrium is not finite; look at the loads at t = 0", title));
  return found;
}

RunReport run_static(const std::string& name, const Location& where, const model::StaticDescription& description,
                     const system::LocallyNonlinear& system, RunContext& context) {
  const StaticEquilibrium found = equilibrium_of(name, where, description, system);
  const std::vector<model::Held> held = held_of("", description, system);
  results::ObservedColumns observed(observed_or_all(description.observe, {system, system.supports()}),
                                    {results::ObservedColumns::Quantity::position});
  results::SliderColumns sliders(system);
  results::StopColumns stops(system);
  results::LawColumns laws(system, false);
  results::TableLayout layout{name, "", "state", {{"state", "1", "number of the state", "", {}}}, {{"type", "static"}}};
  observed.add(layout);
  sliders.add(layout);
  stops.add(layout);
  laws.add(layout);
  std::vector<std::string> forces, moments;
  std::vector<double> row{0.0}, last;
  for (std::size_t i = 0; i < held.size(); ++i) {
    const bool is_rotation = system.is_rotation(held[i].coordinate);
    (is_rotation ? moments : forces).push_back(system.coordinates()[static_cast<std::size_t>(held[i].coordinate)]);
    if (is_rotation) last.push_back(found.reaction[static_cast<Index>(i)]);
  }
  if (!forces.empty())
    layout.blocks.push_back({"reaction", "N", "force that holds the displacement", "held_displacement", forces});
  if (!moments.empty())
    layout.blocks.push_back({"reaction_moment", "N m", "moment that holds the rotation", "held_rotation", moments});
  observed.append(found.state, row);
  sliders.append(found.state, row);
  stops.append(found.state, row);
  laws.append(found.state, row);
  for (std::size_t i = 0; i < held.size(); ++i)
    if (!system.is_rotation(held[i].coordinate)) row.push_back(found.reaction[static_cast<Index>(i)]);
  row.insert(row.end(), last.begin(), last.end());
  context.sink.open(layout)->append(row);
  RunReport report;
  report.statistics = {{"factorisations", std::to_string(found.factorisations)}};
  return report;
}

}  // namespace rubato::analysis
