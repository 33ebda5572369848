#include <rubato/integrate/catalogue.hpp>
#include <rubato/report/json.hpp>
#include <rubato/report/theory_json.hpp>

#include <algorithm>
#include <cmath>
#include <variant>

#include <fmt/format.h>

namespace rubato::report {
namespace {

/// r_k = b^T A^(k-1) 1, [stages + 1], without the zeros at the end (a last stage that serves the estimator alone).
std::vector<double> stability_function(const numerics::ButcherTableau& tableau) {
  const auto stages = static_cast<std::size_t>(tableau.stages);
  std::vector<double> out{1.0}, powers(stages, 1.0);
  for (std::size_t k = 0; k < stages; ++k) {
    double r = 0.0;
    for (std::size_t i = 0; i < stages; ++i) r += tableau.b[i] * powers[i];
    out.push_back(r);
    std::vector<double> next(stages, 0.0);
    for (std::size_t i = 0; i < stages; ++i) {
      for (std::size_t j = 0; j < i; ++j) next[i] += tableau.a[i][j] * powers[j];
    }
    powers = next;
  }
  while (out.size() > 1 && std::abs(out.back()) < 1e-15) out.pop_back();
  return out;
}

struct Entry {
  std::vector<std::string> names;
  std::vector<double> numbers;
};

/// Adds to the entry with the same numbers (to round-off), or makes one.
void add(std::vector<Entry>& entries, const std::string& name, const std::vector<double>& numbers) {
  const auto is_same = [&](const Entry& entry) {
    return std::equal(entry.numbers.begin(), entry.numbers.end(), numbers.begin(), numbers.end(),
                      [](double a, double b) { return std::abs(a - b) < 1e-14; });
  };
  const auto found = std::find_if(entries.begin(), entries.end(), is_same);
  if (found != entries.end()) {
    found->names.push_back(name);
  } else {
    entries.push_back({{name}, numbers});
  }
}

}  // namespace

std::string theory_json() {
  std::vector<Entry> runge_kutta, newmark;
  for (const integrate::MethodInfo& info : integrate::catalogue()) {
    const bool needs_numbers = std::any_of(info.parameters.begin(), info.parameters.end(),
                                           [](const auto& parameter) { return std::isnan(parameter.default_value); });
    if (needs_numbers) continue;
    const integrate::Method method = integrate::make_method(info.name);
    if (const auto* explicit_method = std::get_if<integrate::RungeKutta>(&method.formula)) {
      add(runge_kutta, info.name, stability_function(explicit_method->tableau));
    } else if (const auto* alpha = std::get_if<integrate::GeneralizedAlpha>(&method.formula)) {
      if (alpha->alpha_m == 0.0 && alpha->alpha_f == 0.0) add(newmark, info.name, {alpha->beta, alpha->gamma});
    }
  }
  std::string functions, points;
  for (const Entry& entry : runge_kutta) {
    functions += fmt::format(R"({}{{"names":{},"coefficients":{}}})", functions.empty() ? "" : ",",
                             json_strings(entry.names), json_numbers(entry.numbers, 17));
  }
  for (const Entry& entry : newmark) {
    points += fmt::format(R"({}{{"names":{},"beta":{},"gamma":{}}})", points.empty() ? "" : ",",
                          json_strings(entry.names), json_number(entry.numbers[0]), json_number(entry.numbers[1]));
  }
  return fmt::format(R"({{"runge_kutta":[{}],"newmark":[{}]}})", functions, points);
}

}  // namespace rubato::report
