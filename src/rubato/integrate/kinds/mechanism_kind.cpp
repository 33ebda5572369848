#include <rubato/integrate/constrained/consistent_start.hpp>
#include <rubato/integrate/kinds/mechanism_kind.hpp>
#include <rubato/integrate/kinds/mechanism_start_state.hpp>
#include <rubato/integrate/mechanism/mechanism_equilibrium.hpp>
#include <rubato/integrate/mechanism/mechanism_modes.hpp>
#include <rubato/model/laws/only_transient.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rubato::integrate {
namespace {

std::string counted(Index count, const char* what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

/// A law at the limit that a reaction sets; null: there is none.
const model::MechanismLaw* slipping_under_reaction(system::MechanismEquations& equations, const system::State& state) {
  const auto& laws = equations.mechanism().model().laws;
  equations.go_to(state, model::Side::right);
  for (const model::MechanismLaw& law : laws)
    if (law.reaction.presses() && equations.law_answer(static_cast<std::size_t>(law.index)).by_normal != 0.0)
      return &law;
  return nullptr;
}

/// A contact at its limit: its tangent has no symmetry, and another one where it comes back; null: there is none.
const model::MechanismContact* slipping_contact(system::MechanismEquations& equations, const system::State& state) {
  equations.go_to(state, model::Side::right);
  for (const model::MechanismContact& contact : equations.mechanism().model().contacts) {
    const model::BlockAnswer answer = equations.contact_answer(static_cast<std::size_t>(contact.index));
    const Index normal = contact.law->size() - 1;
    for (Index i = 0; i < normal; ++i)
      if (answer.by_u[i][normal] != 0.0) return &contact;
  }
  return nullptr;
}

}  // namespace

std::string MechanismKind::summary() const {
  const model::Mechanism& model = mechanism_.model();
  const auto rows = [&](int joint) { return joint < 0 ? 0 : model.joints[static_cast<std::size_t>(joint)]->rows(); };
  Index constraints = mechanism_.constraint_count(), of_drives = 0;
  for (const auto& lock : model.locks) constraints -= rows(lock.joint);
  for (const auto& friction : model.frictions) constraints -= rows(friction.sticking_joint);
  for (const auto& drive : model.drives) of_drives += rows(drive.joint);
  const auto equations = mechanism_.equations();
  system::State without_locks = mechanism_.start();
  std::fill(without_locks.phase.begin(), without_locks.phase.end(), model::lock_open);
  const auto redundant = static_cast<Index>(make_consistent(*equations, without_locks).redundant.size());
  const Index left = mechanism_.size() - (constraints - redundant);
  const Index stops =
      std::count_if(model.locks.begin(), model.locks.end(), [](const auto& lock) { return lock.is_stop_part; });
  std::string of_locks = counted(static_cast<Index>(model.locks.size()) - stops, "lock");
  if (stops > 0) of_locks += ", " + counted(stops, "stop");
  return fmt::format("{}, {} ({} of drives, {} redundant), {} left, {}", counted(mechanism_.size(), "coordinate"),
                     counted(constraints, "constraint"), of_drives, redundant,
                     left == 1 ? "1 degree of freedom" : fmt::format("{} degrees of freedom", left), of_locks);
}

std::vector<NonlinearPart> MechanismKind::nonlinear_parts() const {
  const model::Mechanism& model = mechanism_.model();
  std::vector<NonlinearPart> parts;
  for (const auto& law : model.laws)
    parts.push_back({law.normal.formula || law.normal.depends_on_motion() || law.reaction.presses()
                         ? NonlinearPart::Family::pressed_slider
                         : NonlinearPart::Family::law,
                     law.kind, law.name, law.depends_on_time(), false, model::why_no_steady_response(*law.law)});
  for (const auto& contact : model.contacts)
    parts.push_back({NonlinearPart::Family::contact, "contact", contact.name, false, false,
                     model::why_no_steady_response(*contact.law)});
  for (const auto& friction : model.frictions)
    parts.push_back({NonlinearPart::Family::joint_friction, "friction", friction.label()});
  for (const auto& lock : model.locks)
    parts.push_back({lock.is_stop_part ? NonlinearPart::Family::stop : NonlinearPart::Family::lock,
                     lock.is_stop_part ? "stop" : "lock", lock.name, false, lock.is_spring()});
  return parts;
}

void MechanismKind::for_each_time_law(const std::function<void(const model::TimeLaw&)>& show) const {
  const model::Mechanism& model = mechanism_.model();
  for (const auto& force : model.forces) show(force.law);
  for (const auto& law : model.following_laws) show(law);
  for (const auto& formula : model.joint_formulas) show(model::FormulaLaw{formula});
  for (const auto& law : model.laws) {
    if (const numerics::Formula* formula = law.law->formula_of_time()) show(model::FormulaLaw{*formula});
    if (law.normal.formula) show(model::FormulaLaw{*law.normal.formula});
  }
  for (const auto& drive : model.drives) {
    if (const auto* table = std::get_if<model::TableLaw>(&drive.law)) show(*table);
    if (const auto* formula = std::get_if<numerics::Formula>(&drive.law))
      for (const int order : {0, 2}) show(model::FormulaDerivative{*formula, order});
  }
}

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
  if (found.is_found && !equations.matrix().is_symmetric() && mechanism_.size() <= most &&
      !slipping_under_reaction(equations, result.state) && !slipping_contact(equations, result.state))
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
      if (result.state.phase[i] != model::lock_open && !locks[i].is_stop_part) result.holding.push_back(locks[i].name);
  }
  result.statistics = {{"iterations", std::to_string(found.iterations)},
                       {"load_steps", std::to_string(found.load_steps)},
                       {"residual", fmt::format("{:.2e}", found.residual)},
                       {"stable", result.is_stable ? "yes" : "no"}};
  return result;
}

Index MechanismKind::mode_count(const ModesRequest& request) const {
  constexpr Index default_count = 20, largest = 3000;
  if (mechanism_.size() > largest)
    throw InvalidInput(request.where,
                       fmt::format("{}modes of a mechanism are found for up to {} coordinates, and it has {}; divide "
                                   "its beams into fewer elements",
                                   request.title, largest, mechanism_.size()));
  const auto& wanted = request.description.count;
  if (!wanted) return default_count;
  const double count = model::evaluate(*wanted, request.parameters, request.title + "count");
  if (!(count >= 1.0) || count != std::floor(count) || !(count <= static_cast<double>(largest)))
    throw InvalidInput(
        wanted->where.line > 0 ? wanted->where : request.where,
        fmt::format("{}count must be a whole number from 1 to {}, got {}", request.title, largest, count));
  return static_cast<Index>(count);
}

system::State MechanismKind::held_still(const system::State& given, std::vector<std::string>& warnings) const {
  system::State state = given;
  std::fill(state.rubbing.begin(), state.rubbing.end(), model::friction_free);
  const system::State free = state;
  system::MechanismEquations equations(mechanism_);
  if (!find_acceleration_at_rest(equations, state, model::Side::right)) return free;
  Vector force(mechanism_.size()), gap(mechanism_.constraint_count()), product(mechanism_.size());
  equations.go_to(state, model::Side::right);
  equations.residual(force, gap);
  mechanism_.times_mass(state.acceleration, product);
  constexpr double share = 1e-6, round_off = 1e-9;
  Index place = 0;
  const double most = state.acceleration.size() > 0 ? state.acceleration.cwiseAbs().maxCoeff(&place) : 0.0;
  if (product.norm() > share * force.norm() && most > round_off) {
    const bool moves = given.v.size() > 0 && given.v.cwiseAbs().maxCoeff() > standstill;
    warnings.push_back(fmt::format("the configuration is no equilibrium: \"{}\" accelerates by {:.4g} {}{}",
                                   mechanism_.coordinates()[static_cast<std::size_t>(place)], most,
                                   mechanism_.is_rotation(place) ? "rad/s2" : "m/s2",
                                   moves ? "" : "; about = \"static\" finds one"));
  }
  return state;
}

FreeMotions MechanismKind::free_motions(const system::State& state, Index /*limit*/, Index count) const {
  system::MechanismEquations equations(mechanism_);
  if (const model::MechanismLaw* law = slipping_under_reaction(equations, state))
    throw InvalidInput(
        fmt::format("the {} \"{}\" is at the limit that a reaction sets, which small motions change: "
                    "modes do not take that; give it a normal_load in numbers",
                    law->kind, law->name));
  if (const model::MechanismContact* contact = slipping_contact(equations, state))
    throw InvalidInput(
        fmt::format("the contact \"{}\" is at its limit of friction, from which it may slip on or come back: modes of "
                    "mechanisms do not take that; give it a larger friction_coefficient, or none",
                    contact->name));
  return modes_about(equations, state, count);
}

std::vector<std::string> MechanismKind::drives() const {
  std::vector<std::string> names;
  for (const auto& drive : mechanism_.model().drives) names.push_back(drive.name);
  return names;
}

}  // namespace rubato::integrate
