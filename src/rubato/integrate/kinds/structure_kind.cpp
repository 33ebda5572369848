#include <rubato/core/stopping_aside.hpp>
#include <rubato/integrate/equilibrium/static_equilibrium.hpp>
#include <rubato/integrate/kinds/structure_kind.hpp>
#include <rubato/model/laws/only_transient.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rubato::integrate {
namespace {

EquilibriumOutcome outcome_of(const StaticEquilibrium& found) {
  switch (found.outcome) {
    case StaticOutcome::found:
      return found.state.q.allFinite() ? EquilibriumOutcome::found : EquilibriumOutcome::not_finite;
    case StaticOutcome::mechanism:
      return EquilibriumOutcome::floats;
    case StaticOutcome::gives_way:
      return EquilibriumOutcome::gives_way;
    case StaticOutcome::gives_way_on_the_way:
      return EquilibriumOutcome::gives_way_on_the_way;
    case StaticOutcome::not_settled:
      break;
  }
  return EquilibriumOutcome::contacts_unsettled;
}

std::vector<std::string> slipping(const system::State& state, const system::LocallyNonlinear& system) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < system.sliders().size(); ++i) {
    const double u = system.relative_displacement(static_cast<Index>(i), state.q);
    if (std::abs(system.sliders()[i].stiffness * u) > system.sliders()[i].limit)
      names.push_back(system.sliders()[i].name);
  }
  return names;
}

std::string counted(Index count, const char* what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

}  // namespace

std::string StructureKind::summary() const {
  const auto laws_that_slip =
      std::count_if(system_.laws().begin(), system_.laws().end(),
                    [](const model::LawBetween& law) { return law.law->sticking_stiffness() > 0.0; });
  return fmt::format("{}, {}{}{}", counted(system_.size(), "coordinate"),
                     counted(system_.slider_count() + laws_that_slip, "slider"),
                     system_.stop_count() > 0 ? ", " + counted(system_.stop_count(), "stop") : "",
                     system_.block_count() > 0 ? ", " + counted(system_.block_count(), "contact") : "");
}

std::vector<NonlinearPart> StructureKind::nonlinear_parts() const {
  std::vector<NonlinearPart> parts;
  for (const auto& slider : system_.sliders()) parts.push_back({NonlinearPart::Family::slider, "slider", slider.name});
  for (const auto& stop : system_.stops()) parts.push_back({NonlinearPart::Family::stop, "stop", stop.name});
  for (const auto& law : system_.laws()) {
    const bool is_pressed = law.law->takes_normal() && (law.normal.formula || law.normal.depends_on_motion());
    parts.push_back({is_pressed ? NonlinearPart::Family::pressed_slider : NonlinearPart::Family::law, law.kind,
                     law.name, law.law->depends_on_time() || law.normal.formula, false,
                     model::why_no_steady_response(*law.law)});
  }
  for (const auto& block : system_.blocks())
    parts.push_back({NonlinearPart::Family::contact, block.kind, block.name, block.law->sliding_velocity() != 0.0,
                     false, model::why_no_steady_response(*block.law)});
  return parts;
}

void StructureKind::for_each_time_law(const std::function<void(const model::TimeLaw&)>& show) const {
  for (const auto& term : system_.loads().terms()) show(term.law);
  for (const auto& law : system_.laws()) {
    if (const numerics::Formula* formula = law.law->formula_of_time()) show(model::FormulaLaw{*formula});
    if (law.normal.formula) show(model::FormulaLaw{*law.normal.formula});
  }
}

std::optional<HarmonicOscillator> StructureKind::oscillator() const {
  const auto& terms = system_.loads().terms();
  const auto* load = terms.size() == 1 ? std::get_if<model::HarmonicLaw>(&terms.front().law) : nullptr;
  if (!load || system_.size() != 1 || system_.contact_count() > 0) return std::nullopt;
  if (system_.start().q[0] != 0.0 || system_.start().v[0] != 0.0) return std::nullopt;
  double weight = 0.0;
  for (const double w : terms.front().weights) weight += w;
  return HarmonicOscillator{system_.mass().coeff(0, 0), system_.damping().coeff(0, 0), system_.stiffness().coeff(0, 0),
                            weight * load->amplitude,   load->angular_frequency,       load->phase};
}

std::vector<model::Held> StructureKind::held_displacements(const StaticRequest& request) const {
  const model::StaticDescription& description = request.description;
  if (!description.displacements) return system_.held_displacements();
  std::vector<std::string> known;
  for (const auto& held : system_.held_displacements())
    known.push_back(system_.coordinates()[static_cast<std::size_t>(held.coordinate)]);
  std::vector<model::Held> chosen;
  for (const auto& wanted : *description.displacements) {
    const auto found = std::find(known.begin(), known.end(), wanted.first);
    if (found == known.end())
      throw InvalidInput(wanted.where,
                         fmt::format("{}displacements names \"{}\", of which there is no [[displacement]]{}",
                                     request.title, wanted.first, suggestion(wanted.first, known)));
    chosen.push_back(system_.held_displacements()[static_cast<std::size_t>(found - known.begin())]);
  }
  return chosen;
}

Equilibrium StructureKind::find_equilibrium(const system::State& /*start*/, std::span<const model::Held> held) const {
  StaticEquilibrium found = integrate::find_equilibrium(system_, held);
  const auto name = [&](Index i) { return system_.coordinates()[static_cast<std::size_t>(i)]; };
  Equilibrium result;
  result.outcome = outcome_of(found);
  result.reached = found.reached;
  result.rounding = found.rounding;
  result.is_stable = found.is_stable;
  for (const Index i : found.moving) result.moving.push_back(name(i));
  if (found.outcome == StaticOutcome::gives_way) result.changing = slipping(found.state, system_);
  if (result.outcome == EquilibriumOutcome::found)
    for (std::size_t i = 0; i < held.size(); ++i)
      result.reactions.push_back(
          {name(held[i].coordinate), system_.is_rotation(held[i].coordinate), found.reaction[static_cast<Index>(i)]});
  result.statistics = {{"factorisations", std::to_string(found.factorisations)}};
  result.state = std::move(found.state);
  return result;
}

Index StructureKind::mode_count(const ModesRequest& request) const {
  constexpr Index default_count = 20;
  constexpr Index largest_dense = 3000;  // all modes of it take minutes
  const model::ModesDescription& description = request.description;
  const Index n = system_.size();
  if (description.about_equilibrium || description.about_reached)
    throw InvalidInput(description.about_reached ? description.about_reached->where : *description.about_equilibrium,
                       request.title +
                           "\"about\" is for mechanisms; the modes of a structure are those of its linear model, "
                           "whatever the loads and the motion");
  if (!description.count) return std::min(n, default_count);
  const Location& place = description.count->where.line > 0 ? description.count->where : request.where;
  const double count = model::evaluate(*description.count, request.parameters, request.title + "count");
  if (!(count >= 1.0) || count != std::floor(count))
    throw InvalidInput(place,
                       fmt::format("{}count must be a whole number of at least 1, got {}", request.title, count));
  if (!(count <= static_cast<double>(n)))
    throw InvalidInput(place, fmt::format("{}count is {}, but a model of {} coordinate{} has {} mode{}", request.title,
                                          count, n, n == 1 ? "" : "s", n, n == 1 ? "" : "s"));
  if (n > largest_dense && numerics::is_dense_eigenproblem(n, static_cast<Index>(count)))
    throw InvalidInput(place, fmt::format("{}count is {}; of a model of {} coordinates ask for at most a third of the "
                                          "modes, {}",
                                          request.title, count, n, n / 3));
  return static_cast<Index>(count);
}

FreeMotions StructureKind::free_motions(const system::State& /*state*/, Index limit, Index count) const {
  FreeMotions motions;
  motions.freedoms = system_.size();
  // Aside: the dense solvers in it cannot be asked to stop.
  motions.found =
      stoppable_aside([stiffness = limit == 0 ? system_.free_stiffness() : system_.stuck_stiffness(),
                       damping = limit == 0 ? system_.free_damping() : system_.stuck_damping(), mass = system_.mass(),
                       count] { return numerics::lowest_damped_modes(stiffness, damping, mass, count); });
  return motions;
}

}  // namespace rubato::integrate
