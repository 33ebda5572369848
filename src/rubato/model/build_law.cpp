#include <rubato/model/build_law.hpp>

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace rubato::model {

TimeLaw build_law(const TimeLawDescription& description, const numerics::Parameters& parameters,
                  const std::string& part) {
  const auto number = [&](const Quantity& quantity, const std::string& what) {
    return evaluate(quantity, parameters, what);
  };
  const auto at_least_zero = [&](const Quantity& quantity, const std::string& what) {
    const double value = number(quantity, what);
    if (!(value >= 0.0))
      throw InvalidInput(quantity.where, fmt::format("{} must not be negative, got {}", what, value));
    return value;
  };
  if (const auto* harmonic = std::get_if<HarmonicDescription>(&description)) {
    const std::string key = harmonic->frequency_in_hertz ? "frequency" : "angular_frequency";
    const double factor = harmonic->frequency_in_hertz ? 2.0 * std::numbers::pi : 1.0;
    return HarmonicLaw{number(harmonic->amplitude, part + ": amplitude"),
                       factor * at_least_zero(harmonic->angular_frequency, part + ": " + key),
                       number(harmonic->phase, part + ": phase")};
  }
  if (const auto* formula = std::get_if<TimeFormulaDescription>(&description)) {
    try {
      FormulaLaw formula_law{numerics::Expression(formula->formula.expression, parameters, true)};
      const double start = formula_law.formula(0.0);
      if (!std::isfinite(start))
        throw InvalidInput(fmt::format("\"{}\" is {} at t = 0; give a formula that is finite at all times",
                                       formula->formula.expression, std::isnan(start) ? std::abs(start) : start));
      return formula_law;
    } catch (const InvalidInput& fault) {
      throw InvalidInput(formula->formula.where, part + ": " + fault.message());
    }
  }
  const auto& table = std::get<TableDescription>(description);
  TableLaw values;
  values.times = table.times;
  values.values = table.values;
  values.source = table.file;
  if (table.beyond == TableDescription::Beyond::zero) values.beyond = TableLaw::Beyond::zero;
  if (table.beyond == TableDescription::Beyond::hold) values.beyond = TableLaw::Beyond::hold;
  return values;
}

}  // namespace rubato::model
