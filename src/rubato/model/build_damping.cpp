#include <rubato/model/build_parts.hpp>

#include <fmt/format.h>

#include <cmath>

namespace rubato::model {
namespace {

ModalDampingRatios build_modal(const ModalDamping& modal, Index n, const numerics::Parameters& parameters) {
  ModalDampingRatios ratios;
  for (const Quantity& ratio : modal.ratios) ratios.ratios.push_back(at_least_zero(ratio, parameters, "modal_ratio"));
  if (modal.modes) {
    const double modes = evaluate(*modal.modes, parameters, "modes");
    if (!(modes >= 1.0 && modes <= static_cast<double>(n)) || modes != std::floor(modes))
      throw InvalidInput(modal.modes->where,
                         fmt::format("modes must be a whole number from 1 to {}, got {}", n, modes));
    ratios.modes = static_cast<Index>(modes);
  }
  const Index damped = ratios.modes < 0 ? n : ratios.modes;
  const auto given = static_cast<Index>(ratios.ratios.size());
  if (given != 1 && given != damped)
    throw InvalidInput(modal.where, fmt::format("modal_ratio lists {} ratios for {} modes; give one for all, or one a "
                                                "mode",
                                                given, damped));
  return ratios;
}

}  // namespace

Damping build_damping(const DampingDescription& description, Index n, const numerics::Parameters& parameters) {
  if (const auto* modal = std::get_if<ModalDamping>(&description)) return build_modal(*modal, n, parameters);
  if (const auto* rayleigh = std::get_if<RayleighDamping>(&description))
    return RayleighCoefficients{at_least_zero(rayleigh->mass, parameters, "rayleigh: mass"),
                                at_least_zero(rayleigh->stiffness, parameters, "rayleigh: stiffness")};
  return {};
}

Location where_of(const DampingDescription& description) {
  if (const auto* modal = std::get_if<ModalDamping>(&description)) return modal->where;
  if (const auto* rayleigh = std::get_if<RayleighDamping>(&description)) return rayleigh->where;
  return {};
}

}  // namespace rubato::model
