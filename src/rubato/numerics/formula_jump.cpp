#include <rubato/numerics/formula_jump.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace rubato::numerics {

std::optional<double> first_jump(const Formula& formula, int order, double from, double to) {
  constexpr double round_off = 1e-9;
  constexpr int points = 8;
  const auto derivative = [&](const TimeDerivatives& all) {
    return order == 0 ? all.value : order == 1 ? all.rate : all.second_rate;
  };
  const std::vector<double> switches = formula.switches(from, to);
  double size = 0.0, start = from;
  const auto measure = [&](double end) {
    for (int i = 0; i <= points; ++i) {
      const double t = start + (end - start) * i / points;
      const double value =
          derivative(i < points ? formula.derivatives_from_right(t) : formula.derivatives_from_left(t));
      if (std::isfinite(value)) size = std::max(size, std::abs(value));
    }
    start = end;
  };
  for (const double t : switches) measure(t);
  measure(to);
  for (const double t : switches)
    if (std::abs(derivative(formula.derivatives_from_right(t)) - derivative(formula.derivatives_from_left(t))) >
        round_off * size)
      return t;
  return std::nullopt;
}

}  // namespace rubato::numerics
