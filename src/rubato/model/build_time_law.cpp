#include <rubato/model/build_parts.hpp>
#include <rubato/model/load_laws.hpp>

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace rubato::model {
namespace {

struct Building {
  const numerics::Parameters& parameters;
  const std::string& part;

  TimeLaw operator()(const HarmonicDescription& harmonic) const {
    const std::string key = harmonic.frequency_in_hertz ? "frequency" : "angular_frequency";
    const double factor = harmonic.frequency_in_hertz ? 2.0 * std::numbers::pi : 1.0;
    return HarmonicLaw{evaluate(harmonic.amplitude, parameters, part + ": amplitude"),
                       factor * at_least_zero(harmonic.angular_frequency, parameters, part + ": " + key),
                       evaluate(harmonic.phase, parameters, part + ": phase")};
  }

  TimeLaw operator()(const TimeFormulaDescription& formula) const {
    const std::string& text = formula.formula.expression;
    if (is_constant(formula, parameters))
      return HarmonicLaw{evaluate(formula.formula, parameters, part + ": expression"), 0.0, 0.0};
    try {
      FormulaLaw law{numerics::Formula(text, parameters, true)};
      const double start = law.formula(0.0);
      if (!std::isfinite(start))
        throw InvalidInput(fmt::format("\"{}\" is {} at t = 0; give a formula that is finite at all times", text,
                                       std::isnan(start) ? std::abs(start) : start));
      return law;
    } catch (const InvalidInput& fault) {
      throw InvalidInput(formula.formula.where, part + ": " + fault.message());
    }
  }

  TimeLaw operator()(const TableDescription& table) const {
    TableLaw law;
    law.times = table.times;
    law.values = table.values;
    law.source = table.file;
    if (table.beyond == TableDescription::Beyond::zero) law.beyond = TableLaw::Beyond::zero;
    if (table.beyond == TableDescription::Beyond::hold) law.beyond = TableLaw::Beyond::hold;
    return law;
  }
};

}  // namespace

TimeLaw build_time_law(const TimeLawDescription& description, const numerics::Parameters& parameters,
                       const std::string& part) {
  return std::visit(Building{parameters, part}, description);
}

double at_least_zero(const Quantity& quantity, const numerics::Parameters& parameters, const std::string& what,
                     const std::string& remedy) {
  const double value = evaluate(quantity, parameters, what);
  if (!(value >= 0.0))
    throw InvalidInput(quantity.where, fmt::format("{} must not be negative, got {}{}", what, value, remedy));
  return value;
}

}  // namespace rubato::model
