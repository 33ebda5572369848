#pragma once

#include <rubato/analysis/parameter_dependence.hpp>
#include <rubato/analysis/study_input.hpp>

#include <string>
#include <vector>

// What the plans of steady responses have in common. Messages begin with `title`.
namespace rubato::analysis {

/// A parameter as a description names it; empty: none is named.
struct NamedParameter {
  std::string name;
  Location where;
};

/// Parameters that an analysis varies: their places among all, and where they are named.
struct VariedParameters {
  std::vector<std::size_t> places;
  std::vector<Location> where;
};

/// Throws InvalidInput unless all loads are harmonic, and there is one: what does not repeat has no steady response.
void require_harmonic_loads(const model::ModelDescription& model, const Location& where, const std::string& title);

/// The place of the parameter that takes the frequencies: the one that is wanted, or the only one that stands in the
/// frequencies of the loads and is not varied otherwise. Throws InvalidInput where there is none, or several.
std::size_t excitation_parameter(const NamedParameter& wanted, const VariedParameters& varied, const StudyInput& input,
                                 const std::string& title, const Location& where);

/// The dependence where some parameters are given values: those that are varied, and those of --set.
ParameterDependence dependence_of(const StudyInput& input, std::vector<std::size_t> varied);

/// Throws InvalidInput for a varied parameter on which nothing depends, or whose name another column of results has.
/// @param kind  what it is called: "swept parameter"
void require_effect(const ParameterDependence& dependence, std::size_t parameter, const NamedParameter& named,
                    const std::vector<std::string>& columns, const std::string& kind, const std::string& title);

}  // namespace rubato::analysis
