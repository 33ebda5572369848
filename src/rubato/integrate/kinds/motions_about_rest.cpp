#include <rubato/integrate/kinds/mechanism_kind.hpp>
#include <rubato/integrate/kinds/motions_about_rest.hpp>
#include <rubato/model/build_mechanism.hpp>
#include <rubato/system/mechanism_equations.hpp>

namespace rubato::integrate {

MotionsAboutRest motions_about_rest(const model::ModelDescription& model, const numerics::Parameters& parameters) {
  const system::Mechanism mechanism(model::build_mechanism(model, parameters));
  const MechanismKind kind(mechanism);
  MotionsAboutRest about;
  about.coordinates = mechanism.coordinates();
  about.is_rotation = mechanism.model().is_rotation;
  about.starts_at_rest = mechanism.start().v.isZero(0.0) && mechanism.model().start_rates.empty();
  const system::State start = kind.static_start(Location{}, about.told);
  about.found = kind.find_equilibrium(start, {});
  if (about.found.outcome != EquilibriumOutcome::found || !about.found.is_stable) return about;
  system::MechanismEquations equations(mechanism);
  about.motions = small_motions(equations, about.found.state);
  return about;
}

}  // namespace rubato::integrate
