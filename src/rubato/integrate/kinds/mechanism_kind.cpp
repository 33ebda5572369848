#include <rubato/integrate/kinds/mechanism_kind.hpp>
#include <rubato/integrate/kinds/mechanism_start_state.hpp>
#include <rubato/integrate/mechanism/mechanism_equilibrium.hpp>
#include <rubato/integrate/mechanism/mechanism_modes.hpp>

#include <fmt/format.h>

namespace rubato::integrate {

std::vector<model::Held> MechanismKind::held_displacements(const StaticRequest& request) const {
  const auto& wanted = request.description.displacements;
  if (!wanted) return {};
  throw InvalidInput(wanted->empty() ? Location{} : wanted->front().where,
                     request.title + "displacements are held in structures; a mechanism is held by its joints");
}

system::State MechanismKind::static_start(const Location& where, std::vector<std::string>& warnings) const {
  return assembled_start(where, mechanism_, warnings, false);
}

Equilibrium MechanismKind::find_equilibrium(const system::State& start, std::span<const model::Held> /*held*/) const {
  system::MechanismEquations equations(mechanism_);
  MechanismEquilibrium found = integrate::find_equilibrium(equations, start);
  const auto& locks = mechanism_.model().locks;
  Equilibrium result;
  result.state = std::move(found.state);
  result.is_stable = found.is_stable;
  // Signs of pivots say nothing where loads have no potential, and the matrix is not symmetric.
  constexpr Index most = 600;
  if (found.is_found && !equations.matrix().is_symmetric() && mechanism_.size() <= most)
    result.is_stable = modes_about(equations, result.state, 1).is_stable;
  result.iterations = found.iterations;
  result.load_steps = found.load_steps;
  result.reached = found.load;
  result.residual = found.residual;
  result.leaves_out_friction = !mechanism_.model().frictions.empty();
  if (found.worst >= 0) {
    result.worst = mechanism_.coordinates()[static_cast<std::size_t>(found.worst)];
    result.turns_worst = mechanism_.is_rotation(found.worst);
  }
  if (found.unsettled_lock >= 0) {
    result.outcome = EquilibriumOutcome::lock_unsettled;
    result.changing = {locks[static_cast<std::size_t>(found.unsettled_lock)].name};
  } else if (found.is_found) {
    result.outcome = EquilibriumOutcome::found;
    for (std::size_t i = 0; i < locks.size(); ++i)
      if (result.state.phase[i] != model::lock_open) result.holding.push_back(locks[i].name);
  }
  result.statistics = {{"iterations", std::to_string(found.iterations)},
                       {"load_steps", std::to_string(found.load_steps)},
                       {"residual", fmt::format("{:.2e}", found.residual)},
                       {"stable", result.is_stable ? "yes" : "no"}};
  return result;
}

}  // namespace rubato::integrate
