#include <rubato/model/build_parts.hpp>
#include <rubato/model/friction_coefficient.hpp>
#include <rubato/model/laws/jenkins.hpp>
#include <rubato/model/laws/speed_slider.hpp>

#include <fmt/format.h>

#include <array>
#include <cctype>
#include <cmath>

namespace rubato::model {
namespace {

bool is_of_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

numerics::Formula formula_of_rate(const Quantity& coefficient, const numerics::Parameters& parameters,
                                  const std::string& part) {
  try {
    return {coefficient.expression, parameters, false, {"rate"}};
  } catch (const InvalidInput& error) {
    throw InvalidInput(coefficient.where, fmt::format("{}: friction_coefficient: {}", part, error.message()));
  }
}

void require_friction(const numerics::Formula& mu, double rate, const Quantity& coefficient, const std::string& part) {
  const double value = mu(0.0, std::array{rate});
  if (value >= 0.0 && std::isfinite(value)) return;
  throw InvalidInput(
      coefficient.where,
      fmt::format("{}: friction_coefficient is {:.6g} at a rate of {:.6g} m/s (from \"{}\"), and must not "
                  "be negative at any; write it with max(0, ...), or let it end at a constant",
                  part, value, rate, coefficient.expression));
}

}  // namespace

bool names(const std::string& formula, const std::string& name) {
  for (std::size_t at = formula.find(name); at != std::string::npos; at = formula.find(name, at + 1)) {
    const std::size_t end = at + name.size();
    const bool begins = at == 0 || !(is_of_name(formula[at - 1]) || formula[at - 1] == '.');
    if (begins && (end == formula.size() || !is_of_name(formula[end]))) return true;
  }
  return false;
}

std::shared_ptr<const Law> build_slider_law(const SliderDescription& slider, double stiffness,
                                            const numerics::Parameters& parameters, const std::string& part) {
  const Quantity& coefficient = slider.friction_coefficient;
  if (!depends_on_rate(coefficient))
    return make_jenkins(stiffness, at_least_zero(coefficient, parameters, part + ": friction_coefficient"));
  numerics::Formula mu = formula_of_rate(coefficient, parameters, part);
  require_friction(mu, 0.0, coefficient, part);
  constexpr double slowest = 1e-6, fastest = 1e3;  // [m/s]
  for (double rate = slowest; rate < fastest; rate *= 1.5)
    for (const double side : {1.0, -1.0}) require_friction(mu, side * rate, coefficient, part);
  return make_speed_slider(stiffness, std::move(mu));
}

}  // namespace rubato::model
