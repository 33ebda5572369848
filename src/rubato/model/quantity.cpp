#include <rubato/model/description.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rubato::model {

double evaluate(const Quantity& quantity, const numerics::Parameters& parameters, const std::string& what) {
  double value = quantity.value;
  if (!quantity.expression.empty()) {
    try {
      value = numerics::Formula(quantity.expression, parameters)();
    } catch (const InvalidInput& fault) {
      throw InvalidInput(quantity.where, what + ": " + fault.message());
    }
  }
  if (!std::isfinite(value)) {
    const std::string source = quantity.expression.empty() ? "" : fmt::format(" (from \"{}\")", quantity.expression);
    throw InvalidInput(quantity.where, fmt::format("{} is {}{}; give a finite number", what,
                                                   std::isnan(value) ? std::abs(value) : value, source));
  }
  return value;
}

numerics::Parameters evaluate_parameters(const std::vector<ParameterDescription>& parameters,
                                         const numerics::Parameters& overrides) {
  for (const auto& override_ : overrides) {
    const auto same = [&](const ParameterDescription& p) { return p.name == override_.first; };
    if (std::any_of(parameters.begin(), parameters.end(), same)) continue;
    std::vector<std::string> known;
    for (const auto& parameter : parameters) known.push_back(parameter.name);
    const std::string hint = known.empty() ? "; the study has no [parameters]" : suggestion(override_.first, known);
    throw InvalidInput(fmt::format("--set {}: no such parameter{}", override_.first, hint));
  }
  numerics::Parameters values;
  for (const auto& parameter : parameters) {
    const auto same = [&](const auto& o) { return o.first == parameter.name; };
    const auto chosen = std::find_if(overrides.begin(), overrides.end(), same);
    const Quantity quantity = chosen == overrides.end() ? parameter.value : Quantity(chosen->second);
    values.emplace_back(parameter.name, evaluate(quantity, values, "parameter \"" + parameter.name + "\""));
  }
  return values;
}

}  // namespace rubato::model
