#include "commands.hpp"

#include <rubato/core/error.hpp>
#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/stability.hpp>

#include <fmt/format.h>

#include <charconv>
#include <cmath>

namespace rubato::app {
namespace {

using integrate::MethodInfo;

bool has_curves(const integrate::Method& method) { return !std::holds_alternative<integrate::Exact>(method.formula); }

bool needs_parameters(const MethodInfo& info) {
  for (const auto& parameter : info.parameters)
    if (std::isnan(parameter.default_value)) return true;
  return false;
}

std::string radius_text(const MethodInfo& info) {
  if (needs_parameters(info)) return "by parameters";
  const double radius = integrate::spectral_radius_at_infinity(integrate::make_method(info.name));
  if (std::isinf(radius)) return "grows";
  return radius < 1e-4 ? "0" : fmt::format("{:.4g}", radius);  // the round-off of a double eigenvalue at 0
}

std::string optional_number(const std::optional<double>& value, const char* missing) {
  return value ? fmt::format("{:.6e}", *value) : missing;
}

constexpr int points_a_decade = 20;

// omega h from 0.01 to 100.
std::vector<double> ladder(int per_decade) {
  std::vector<double> values;
  for (int i = 0; i <= 4 * per_decade; ++i)
    values.push_back(std::pow(10.0, -2.0 + static_cast<double>(i) / per_decade));
  return values;
}

}  // namespace

int list_methods() {
  fmt::print("{:<22}{:<7}{:<10}{:<16}{}\n", "method", "order", "kind", "radius at inf", "stability (undamped mode)");
  for (const MethodInfo& info : integrate::catalogue())
    fmt::print("{:<22}{:<7}{:<10}{:<16}{}\n", info.name, info.order == 0 ? "exact" : std::to_string(info.order),
               info.order == 0    ? "events"
               : info.is_explicit ? "explicit"
                                  : "implicit",
               radius_text(info), info.stability);
  fmt::print("\n`rubato methods NAME` shows the formula, its source and what the method does to period and damping.\n");
  return exit_done;
}

int show_method(const std::string& name, const std::vector<std::string>& parameters, bool csv) {
  const MethodInfo& info = integrate::find_method(name);
  std::vector<std::pair<std::string, double>> values;
  for (const std::string& text : parameters) {
    const std::size_t equals = text.find('=');
    double value = 0.0;
    const char* const end = text.data() + text.size();
    if (equals == std::string::npos || std::from_chars(text.data() + equals + 1, end, value).ptr != end)
      throw InvalidInput(fmt::format("--set {}: write PARAM=NUMBER, such as --set rho_inf=0.8", text));
    values.emplace_back(text.substr(0, equals), value);
  }
  const bool lacks_values = needs_parameters(info) && values.empty();
  if (csv || !lacks_values) (void)integrate::make_method(name, values);  // says what is wrong before anything is shown
  if (!csv) {
    fmt::print("{}\n\n{}\n\n", info.name, info.formula);
    fmt::print("order      {}\n", info.order == 0 ? "exact" : std::to_string(info.order));
    fmt::print("kind       {}\n", info.order == 0 ? "events" : info.is_explicit ? "explicit" : "implicit");
    fmt::print("stability  {}\n", info.stability);
    fmt::print("source     {}\n", info.source);
    for (const auto& parameter : info.parameters)
      fmt::print("parameter  {} in {}{}: {}\n", parameter.name, parameter.range,
                 std::isnan(parameter.default_value) ? "" : fmt::format(", default {}", parameter.default_value),
                 parameter.convention);
    if (lacks_values) {
      fmt::print("\nGive the parameters for its curves: rubato methods {}", name);
      for (const auto& parameter : info.parameters) fmt::print(" --set {}=VALUE", parameter.name);
      fmt::print("\n");
      return exit_done;
    }
  }
  const integrate::Method method = integrate::make_method(name, values);
  if (!has_curves(method)) return exit_done;
  if (csv)
    fmt::print("omega_h,spectral_radius,period_elongation,numerical_damping\n");
  else
    fmt::print("\n{:>10}{:>18}{:>20}{:>20}\n", "omega h", "spectral radius", "period elongation", "numerical damping");
  for (const double x : ladder(csv ? points_a_decade : 5)) {
    const integrate::ModeResponse mode = integrate::mode_response(method, x);
    if (csv)
      fmt::print("{},{},{},{}\n", x, mode.spectral_radius,
                 mode.period_elongation ? fmt::format("{}", *mode.period_elongation) : "",
                 mode.numerical_damping ? fmt::format("{}", *mode.numerical_damping) : "");
    else
      fmt::print("{:>10.4g}{:>18.6f}{:>20}{:>20}\n", x, mode.spectral_radius,
                 optional_number(mode.period_elongation, "-"), optional_number(mode.numerical_damping, "-"));
  }
  return exit_done;
}

}  // namespace rubato::app
