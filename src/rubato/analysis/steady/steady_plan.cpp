#include <rubato/analysis/steady/steady_model.hpp>
#include <rubato/analysis/steady/steady_plan.hpp>
#include <rubato/model/finite_elements/finite_elements.hpp>
#include <rubato/model/finite_elements/reduction.hpp>
#include <rubato/model/load_laws.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <numbers>
#include <utility>

namespace rubato::analysis {
namespace {

using Role = ParameterDependence::Role;

Location place(const Location& wanted, const Location& otherwise) { return wanted.line > 0 ? wanted : otherwise; }

std::string quoted(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += fmt::format("{}\"{}\"", text.empty() ? "" : ", ", name);
  return text;
}

}  // namespace

void require_harmonic_loads(const StudyInput& input, const Location& where, const std::string& title) {
  const auto laws = model::load_laws(input.study.model);
  for (const auto& load : laws) {
    if (std::holds_alternative<model::HarmonicDescription>(*load.law)) continue;
    const auto* formula = std::get_if<model::TimeFormulaDescription>(load.law);
    if (formula && model::is_constant(*formula, input.parameters)) continue;
    throw InvalidInput(place(load.where, where),
                       fmt::format("{}{} is {}: a steady response needs harmonic loads (amplitude, angular_frequency, "
                                   "phase); write it as a sum of them, or run a transient",
                                   title, load.part, formula ? "a formula of t" : "a table"));
  }
  if (laws.empty())
    throw InvalidInput(where, title + "nothing drives the model; add a [[force]] with amplitude and angular_frequency");
}

std::size_t excitation_parameter(const NamedParameter& wanted, const VariedParameters& varied, const StudyInput& input,
                                 const std::string& title, const Location& where) {
  std::vector<std::string> known;
  for (const auto& parameter : input.parameters) known.push_back(parameter.first);
  const ParameterDependence dependence(input.study, input.parameters, varied.places);
  const auto is_varied = [&](std::size_t i) {
    return std::find(varied.places.begin(), varied.places.end(), i) != varied.places.end();
  };
  std::size_t chosen = known.size();
  const Location at = place(wanted.where, where);
  if (!wanted.name.empty()) {
    const auto found = std::find(known.begin(), known.end(), wanted.name);
    if (found == known.end())
      throw InvalidInput(at, fmt::format("{}excitation names \"{}\", which is no parameter{}", title, wanted.name,
                                         suggestion(wanted.name, known)));
    chosen = static_cast<std::size_t>(found - known.begin());
  } else {
    std::vector<std::string> candidates, free;
    for (const std::size_t i : dependence.in_frequencies()) {
      candidates.push_back(known[i]);
      if (is_varied(i)) continue;
      free.push_back(known[i]);
      chosen = i;
    }
    if (candidates.empty())
      throw InvalidInput(where, title +
                                    "no parameter drives the forces: write angular_frequency = \"Omega\" in the "
                                    "[[force]], and Omega = ... in [parameters]");
    if (free.size() > 1)
      throw InvalidInput(where, fmt::format("{}several parameters stand in the frequencies of the forces ({}); say "
                                            "which one takes the frequencies: excitation = \"{}\"",
                                            title, quoted(free), free.front()));
    if (free.empty()) chosen = dependence.in_frequencies().front();
  }
  for (std::size_t i = 0; i < varied.places.size(); ++i)
    if (varied.places[i] == chosen)
      throw InvalidInput(varied.where[i], fmt::format("{}the parameter \"{}\" takes the frequencies and cannot be "
                                                      "swept at once; give its values as angular_frequency",
                                                      title, known[chosen]));
  if (!dependence.reaches(chosen, Role::frequency))
    throw InvalidInput(at, fmt::format("{}no force has a frequency that depends on the parameter \"{}\"; write "
                                       "angular_frequency = \"{}\" in the [[force]]",
                                       title, known[chosen], known[chosen]));
  return chosen;
}

void Possibility::require() const {
  if (is_possible_ || !fault_) return;
  throw InvalidInput(place(fault_->where(), where_), title_ + fault_->message());
}

ParameterDependence dependence_of(const StudyInput& input, std::vector<std::size_t> varied) {
  for (std::size_t i = 0; i < input.parameters.size(); ++i)
    if (std::any_of(input.overrides.begin(), input.overrides.end(),
                    [&](const auto& setting) { return setting.first == input.parameters[i].first; }))
      varied.push_back(i);
  return ParameterDependence(input.study, input.parameters, varied);
}

void warn_of_reduction(const StudyInput& input, double highest, std::vector<std::string>& warnings) {
  const auto& elements = input.study.model.finite_elements;
  if (!elements || !elements->reduction) return;
  std::string told = model::beyond_estimates(*elements->reduction, highest / (2.0 * std::numbers::pi));
  if (!told.empty()) warnings.push_back(std::move(told));
}

std::vector<std::string> warn_of_settings(const StudyInput& input,
                                          const std::vector<std::pair<std::size_t, std::string>>& varied) {
  std::vector<std::string> warnings;
  for (const auto& [place, source] : varied) {
    const std::string& name = input.parameters[place].first;
    const auto is_it = [&](const auto& setting) { return setting.first == name; };
    const auto setting = std::find_if(input.overrides.begin(), input.overrides.end(), is_it);
    if (setting == input.overrides.end()) continue;
    warnings.push_back(
        fmt::format("--set {}={:.6g} does not change the model of this analysis: {} gives \"{}\" its "
                    "values; change them in the study",
                    name, setting->second, source, name));
  }
  return warnings;
}

void require_effect(const ParameterDependence& dependence, std::size_t parameter, const NamedParameter& named,
                    const std::vector<std::string>& columns, const std::string& kind, const std::string& title) {
  if (!dependence.reaches_anything(parameter))
    throw InvalidInput(named.where, fmt::format("{}nothing in the model depends on the {} \"{}\"; use it there, or "
                                                "leave it out of the {}",
                                                title, kind, named.name, kind == "parameter" ? "analysis" : "sweep"));
  if (std::find(columns.begin(), columns.end(), named.name) != columns.end())
    throw InvalidInput(named.where, fmt::format("{}the {} \"{}\" would head a column of results that has another "
                                                "meaning; rename it",
                                                title, kind, named.name));
}

void require_about(const std::optional<Location>& about_equilibrium, const StudyInput& input, const Location& where,
                   const std::string& title) {
  if (!input.kind.is_constrained()) {
    if (about_equilibrium)
      throw InvalidInput(*about_equilibrium,
                         title +
                             "about = \"static\" is of mechanisms; a structure answers as it is, and its static loads "
                             "are among those of the response: leave it out");
    return;
  }
  if (!about_equilibrium)
    throw InvalidInput(where, title +
                                  "a mechanism (bodies, joints, geometrically exact beams) answers harmonic loads by "
                                  "small motions about its static equilibrium: add about = \"static\", or run a "
                                  "transient");
  refuse_beyond_small_motions(input, where, title);
}

std::function<bool(std::size_t)> model_dependence(const StudyInput& input, const ParameterDependence& dependence,
                                                  std::vector<std::size_t> varied) {
  if (!input.kind.is_constrained())
    return [&](std::size_t parameter) { return dependence.reaches(parameter, Role::structure); };
  auto still = std::make_shared<const model::StudyDescription>(without_harmonic_loads(input.study));
  const StudyInput at_rest{*still, input.overrides, input.parameters, input.kind};
  return [still, of_rest = dependence_of(at_rest, std::move(varied))](std::size_t parameter) {
    return of_rest.reaches_model(parameter);
  };
}

}  // namespace rubato::analysis
