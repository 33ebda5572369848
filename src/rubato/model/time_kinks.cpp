#include <rubato/model/time_kinks.hpp>

#include <algorithm>
#include <iterator>

namespace rubato::model {

std::vector<double> with_eighths(const std::vector<double>& switches) {
  constexpr int parts = 8;
  std::vector<double> times;
  for (std::size_t i = 0; i < switches.size(); ++i) {
    if (i > 0)
      for (int part = 1; part < parts; ++part)
        times.push_back(switches[i - 1] + (switches[i] - switches[i - 1]) * part / parts);
    times.push_back(switches[i]);
  }
  return times;
}

Kinks kinks(const TimeLaw& law, double from, double to) {
  Kinks result;
  const auto take = [&](const std::vector<double>& rows) {
    std::copy_if(rows.begin(), rows.end(), std::back_inserter(result.rows),
                 [&](double t) { return t > from && t < to; });
  };
  if (const auto* table = std::get_if<TableLaw>(&law)) take(table->times);
  if (const auto* spline = std::get_if<SplineLaw>(&law)) take(spline->times);
  if (const auto* formula = std::get_if<FormulaLaw>(&law))
    result.switches = with_eighths(formula->formula.switches(from, to));
  if (const auto* derivative = std::get_if<FormulaDerivative>(&law))
    result.switches = with_eighths(derivative->formula.switches(from, to));
  return result;
}

}  // namespace rubato::model
