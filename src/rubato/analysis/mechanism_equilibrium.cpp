#include <rubato/analysis/mechanism_equilibrium.hpp>
#include <rubato/analysis/mechanism_start_state.hpp>
#include <rubato/analysis/observed.hpp>
#include <rubato/integrate/mechanism/mechanism_equilibrium.hpp>
#include <rubato/integrate/mechanism/mechanism_modes.hpp>
#include <rubato/results/columns/beam_section_forces.hpp>
#include <rubato/results/columns/mechanism_columns.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace rubato::analysis {

namespace {

/// Which locks hold in an equilibrium.
std::string held_locks(const system::State& state, const system::Mechanism& mechanism, const char* between) {
  std::vector<std::string> names;
  const auto& locks = mechanism.model().locks;
  for (std::size_t i = 0; i < locks.size(); ++i)
    if (state.phase[i] != model::lock_open) names.push_back(locks[i].name);
  return fmt::format("{}", fmt::join(names, between));
}

}  // namespace

std::string MechanismStatic::complaint(const system::Mechanism& mechanism) const {
  if (unsettled_lock >= 0)
    return fmt::format(
        "no equilibrium was found: whether the lock of \"{}\" holds did not settle; let a transient come to rest there",
        mechanism.model().locks[static_cast<std::size_t>(unsettled_lock)].name);
  if (is_found) return {};
  const std::string left =
      worst < 0 ? std::string()
                : fmt::format(": {:.4g} {} is left on \"{}\"", residual,
                              mechanism.model().is_rotation[static_cast<std::size_t>(worst)] != 0 ? "N m" : "N",
                              mechanism.coordinates()[static_cast<std::size_t>(worst)]);
  return fmt::format(
      "no equilibrium was found in {} iterations{}{}; look for a motion that nothing resists, or begin "
      "nearer to it",
      iterations, left,
      load > 0.0 ? fmt::format(" where the loads, raised by steps, pass {:.4g} of what is given", load) : "");
}

MechanismStatic equilibrium_near(const system::State& start, const system::Mechanism& mechanism) {
  system::MechanismEquations equations(mechanism);
  integrate::MechanismEquilibrium found = integrate::find_equilibrium(equations, start);
  MechanismStatic result;
  result.state = std::move(found.state);
  result.is_found = found.is_found;
  result.is_stable = found.is_stable;
  // Signs of pivots say nothing where loads have no potential, and the matrix is not symmetric.
  constexpr Index most = 600;
  if (found.is_found && !equations.is_symmetric() && mechanism.size() <= most)
    result.is_stable = integrate::modes_about(equations, result.state, 1).is_stable;
  result.iterations = found.iterations;
  result.residual = found.residual;
  result.worst = found.worst;
  result.load_steps = found.load_steps;
  result.load = found.load;
  result.unsettled_lock = found.unsettled_lock;
  return result;
}

void refuse_displacements(const std::string& title, const model::StaticDescription& description) {
  if (!description.displacements) return;
  const Location where = description.displacements->empty() ? Location{} : description.displacements->front().where;
  throw InvalidInput(where, title + "displacements are held in structures; a mechanism is held by its joints");
}

std::vector<std::string> check_mechanism_static(const std::string& name, const Location& where,
                                                const model::StaticDescription& description,
                                                const system::Mechanism& mechanism) {
  refuse_displacements("analysis \"" + name + "\": ", description);
  std::vector<std::string> warnings;
  (void)assembled_start(where, mechanism, warnings, false);
  (void)observed_or_all(description.observe, {mechanism});
  (void)results::BeamSectionForces(mechanism, description.section_forces, "analysis \"" + name + "\": ");
  return warnings;
}

RunReport run_mechanism_static(const std::string& name, const Location& where,
                               const model::StaticDescription& description, const system::Mechanism& mechanism,
                               RunContext& context) {
  refuse_displacements("analysis \"" + name + "\": ", description);
  RunReport report;
  const system::State start = assembled_start(where, mechanism, report.warnings, false);
  const MechanismStatic found = equilibrium_near(start, mechanism);
  report.statistics = {{"iterations", std::to_string(found.iterations)},
                       {"load_steps", std::to_string(found.load_steps)},
                       {"residual", fmt::format("{:.2e}", found.residual)},
                       {"stable", found.is_stable ? "yes" : "no"}};
  report.message = found.complaint(mechanism);
  if (!report.message.empty()) {
    report.status = RunStatus::failed;
    return report;
  }
  system::MechanismEquations equations(mechanism);
  const auto columns = results::columns_of_equilibrium(equations, observed_or_all(description.observe, {mechanism}),
                                                       description.section_forces, "analysis \"" + name + "\": ");
  results::TableLayout layout{name, "", "state", {{"state", "1", "number of the state", "", {}}}, {{"type", "static"}}};
  if (const std::string held = held_locks(found.state, mechanism, "\n"); !held.empty())
    layout.attributes.emplace_back("held_locks", held);
  std::vector<double> row{0.0};
  for (const auto& group : columns) {
    group->add(layout);
    group->append(found.state, row);
  }
  context.sink.open(layout)->append(row);
  if (found.load_steps > 0)
    report.findings.push_back(fmt::format(
        "the loads were raised in {} steps: under all of them at once no equilibrium was found", found.load_steps));
  if (const std::string held = held_locks(found.state, mechanism, "\", \""); !held.empty())
    report.findings.push_back(fmt::format("held by the lock of \"{}\"", held));
  if (!found.is_stable)
    report.findings.push_back("the equilibrium is not stable: a motion that the joints leave goes away from it");
  return report;
}

}  // namespace rubato::analysis
