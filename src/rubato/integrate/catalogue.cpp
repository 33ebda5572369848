#include <rubato/core/error.hpp>
#include <rubato/integrate/catalogue.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

namespace rubato::integrate {
namespace {

using Values = std::map<std::string, double>;

const char* const runge_kutta_source = "Kutta 1901; Hairer, Norsett and Wanner 1993, II.1";
const char* const newmark_formula =
    "M a1 + C v1 + K q1 + B fc1 = f(t1)\n"
    "q1 = q0 + h v0 + h^2 ((1/2 - beta) a0 + beta a1)\n"
    "v1 = v0 + h ((1 - gamma) a0 + gamma a1)";

struct Entry {
  MethodInfo info;
  std::function<Method(const std::string&, const Values&)> make;
};

Entry runge_kutta(std::string name, std::string stability, std::string formula, std::string source,
                  numerics::ButcherTableau tableau) {
  MethodInfo info{std::move(name),    tableau.order,     true, std::move(stability),
                  std::move(formula), std::move(source), {}};
  return {std::move(info), [tableau](const std::string& n, const Values&) { return Method{n, RungeKutta{tableau}}; }};
}

Entry newmark_member(std::string name, int order, std::string stability, double beta, double gamma,
                     std::string source) {
  MethodInfo info{std::move(name),
                  order,
                  beta == 0.0,
                  std::move(stability),
                  fmt::format("{}\nbeta = {}, gamma = {}", newmark_formula, beta, gamma),
                  std::move(source),
                  {}};
  return {std::move(info), [=](const std::string& n, const Values&) {
            return Method{n, GeneralizedAlpha{0.0, 0.0, beta, gamma}};
          }};
}

Method hht(const std::string& name, const Values& p) {
  const double alpha = p.at("alpha");
  return {name, GeneralizedAlpha{0.0, -alpha, 0.25 * (1.0 - alpha) * (1.0 - alpha), 0.5 - alpha}};
}

Method wbz(const std::string& name, const Values& p) {
  const double alpha_m = (p.at("rho_inf") - 1.0) / (p.at("rho_inf") + 1.0);
  return {name, GeneralizedAlpha{alpha_m, 0.0, 0.25 * (1.0 - alpha_m) * (1.0 - alpha_m), 0.5 - alpha_m}};
}

Method generalized_alpha(const std::string& name, const Values& p) {
  const double rho = p.at("rho_inf");
  const double alpha_m = (2.0 * rho - 1.0) / (rho + 1.0), alpha_f = rho / (rho + 1.0);
  const double sum = 1.0 - alpha_m + alpha_f;
  return {name, GeneralizedAlpha{alpha_m, alpha_f, 0.25 * sum * sum, 0.5 - alpha_m + alpha_f}};
}

std::vector<Entry> make_entries() {
  const double required = std::numeric_limits<double>::quiet_NaN();
  const std::string rk2_limit = "no stable step for an undamped mode";
  std::vector<Entry> all;
  all.push_back(
      runge_kutta("explicit_euler", rk2_limit, "y1 = y0 + h F(t0, y0)", "Euler 1768", numerics::explicit_euler()));
  all.push_back(runge_kutta("heun", rk2_limit, "k1 = F(t0, y0), k2 = F(t0 + h, y0 + h k1)\ny1 = y0 + h/2 (k1 + k2)",
                            "Heun 1900", numerics::heun()));
  all.push_back(runge_kutta("midpoint", rk2_limit, "k1 = F(t0, y0), k2 = F(t0 + h/2, y0 + h/2 k1)\ny1 = y0 + h k2",
                            "Runge 1895", numerics::midpoint()));
  all.push_back(runge_kutta("ralston", rk2_limit,
                            "k1 = F(t0, y0), k2 = F(t0 + 3/4 h, y0 + 3/4 h k1)\ny1 = y0 + h (1/3 k1 + 2/3 k2)",
                            "Ralston 1962", numerics::ralston()));
  all.push_back(runge_kutta("rk3", "omega h <= 1.7321",
                            "k1 = F(t0, y0), k2 = F(t0 + h/2, y0 + h/2 k1)\nk3 = F(t0 + h, y0 - h k1 + 2 h k2)\n"
                            "y1 = y0 + h (k1 + 4 k2 + k3)/6",
                            runge_kutta_source, numerics::rk3()));
  all.push_back(runge_kutta("rk4", "omega h <= 2.8284",
                            "k1 = F(t0, y0), k2 = F(t0 + h/2, y0 + h/2 k1)\n"
                            "k3 = F(t0 + h/2, y0 + h/2 k2), k4 = F(t0 + h, y0 + h k3)\n"
                            "y1 = y0 + h (k1 + 2 k2 + 2 k3 + k4)/6",
                            runge_kutta_source, numerics::rk4()));
  all.push_back(runge_kutta("bogacki_shampine", "omega h <= 1.7321",
                            "k1 = F(t0, y0), k2 = F(t0 + h/2, y0 + h/2 k1), k3 = F(t0 + 3/4 h, y0 + 3/4 h k2)\n"
                            "y1 = y0 + h (2 k1 + 3 k2 + 4 k3)/9",
                            "Bogacki and Shampine 1989", numerics::bogacki_shampine()));
  all.push_back(runge_kutta("dormand_prince", "omega h <= 0.9972",
                            "six stages of the 5(4) pair; y1 of order 5, the order 4 solution estimates the error",
                            "Dormand and Prince 1980, table 2", numerics::dormand_prince()));
  const std::string newmark_source = "Newmark 1959; Hughes 1987, 9.1";
  all.push_back(newmark_member("central_difference", 2, "omega h <= 2", 0.0, 0.5, newmark_source));
  all.push_back(newmark_member("fox_goodwin", 2, "omega h <= 2.4495", 1.0 / 12.0, 0.5,
                               "Fox and Goodwin 1949; order 4 in displacement for an undamped linear structure"));
  all.push_back(newmark_member("linear_acceleration", 2, "omega h <= 3.4641", 1.0 / 6.0, 0.5, newmark_source));
  all.push_back(newmark_member("average_acceleration", 2, "unconditional", 0.25, 0.5,
                               newmark_source + "; the trapezoidal rule, constant mean acceleration"));
  all.push_back(newmark_member("galerkin", 1, "unconditional", 0.8, 1.5, "Zienkiewicz 1977 (beta2 = 2 beta = 8/5)"));
  all.push_back(
      newmark_member("backward_difference", 1, "unconditional", 1.0, 1.5, "Zienkiewicz 1977 (beta2 = 2 beta = 2)"));
  all.push_back(newmark_member("damped_newmark", 1, "unconditional", 0.3025, 0.6,
                               newmark_source + "; gamma > 1/2 adds damping and loses an order"));
  all.push_back({{"newmark",
                  2,
                  false,
                  "unconditional if 2 beta >= gamma >= 1/2, else omega h <= 1/sqrt(gamma/2 - beta)",
                  newmark_formula,
                  newmark_source + "; order 2 for gamma = 1/2, else 1",
                  {{"beta", required, "[0, 10]", "weight of the new acceleration in the displacement (not 2 beta)"},
                   {"gamma", required, "[1/2, 10]",
                    "weight of the new acceleration in the velocity; above 1/2 it damps, with order 1"}}},
                 [](const std::string& n, const Values& p) {
                   return Method{n, GeneralizedAlpha{0.0, 0.0, p.at("beta"), p.at("gamma")}};
                 }});
  all.push_back({{"wilson_theta",
                  2,
                  false,
                  "unconditional for theta >= 1.3660",
                  "linear acceleration over theta h, with the load f0 + theta (f1 - f0):\n"
                  "a1 = a0 + (a_theta - a0)/theta\n"
                  "v1 = v0 + h (a0 + a1)/2,   q1 = q0 + h v0 + h^2 (2 a0 + a1)/6",
                  "Wilson, Farhoomand and Bathe 1973",
                  {{"theta", 1.4, "[1, 5]", "length of the extended step over h; 1 is linear acceleration"}}},
                 [](const std::string& n, const Values& p) {
                   return Method{n, WilsonTheta{p.at("theta")}};
                 }});
  const std::string alpha_formula =
      "(1 - alpha_m) M A1 + alpha_m M A0 + (1 - alpha_f) F1 + alpha_f F0 = 0,   F = C v + K q + B fc - f(t)\n"
      "q1 = q0 + h v0 + h^2 ((1/2 - beta) A0 + beta A1),   v1 = v0 + h ((1 - gamma) A0 + gamma A1)\n";
  all.push_back({{"hht",
                  2,
                  false,
                  "unconditional",
                  "M A1 + (1 + alpha) F1 - alpha F0 = 0,   F = C v + K q + B fc - f(t)\n"
                  "q1, v1 as Newmark with beta = (1 - alpha)^2/4, gamma = 1/2 - alpha",
                  "Hilber, Hughes and Taylor 1977",
                  {{"alpha", -0.05, "[-1/3, 0]", "alpha <= 0; more negative damps more; 0 is average acceleration"}}},
                 hht});
  all.push_back(
      {{"wbz",
        2,
        false,
        "unconditional",
        alpha_formula + "alpha_f = 0, alpha_m = (rho_inf - 1)/(rho_inf + 1), beta = (1 - alpha_m)^2/4, "
                        "gamma = 1/2 - alpha_m",
        "Wood, Bossak and Zienkiewicz 1981",
        {{"rho_inf", 0.9, "[0, 1]", "spectral radius at infinite omega h: 1 keeps, 0 removes what is too fast"}}},
       wbz});
  all.push_back(
      {{"generalized_alpha",
        2,
        false,
        "unconditional",
        alpha_formula + "alpha_m = (2 rho_inf - 1)/(rho_inf + 1), alpha_f = rho_inf/(rho_inf + 1), "
                        "beta = (1 - alpha_m + alpha_f)^2/4, gamma = 1/2 - alpha_m + alpha_f",
        "Chung and Hulbert 1993; forces weighted as in Arnold and Bruels 2007",
        {{"rho_inf", 0.9, "[0, 1]", "spectral radius at infinite omega h: 1 keeps, 0 removes what is too fast"}}},
       generalized_alpha});
  all.push_back({{"exponential",
                  2,
                  false,
                  "unconditional",
                  "y1 = exp(A h) y0 + integral over the step of exp(A (h - s)) b(s) ds,   y = (q, v)\n"
                  "harmonic loads exactly, other loads and slider forces linear in time",
                  "Hochbruck and Ostermann 2010; exact for linear structures under harmonic loads",
                  {}},
                 [](const std::string& n, const Values&) {
                   return Method{n, Exponential{}};
                 }});
  all.push_back({{"exact",
                  0,
                  false,
                  "no step",
                  "analytic pieces between located transitions of the sliders",
                  "piecewise linear structures under harmonic, constant and tabulated loads",
                  {}},
                 [](const std::string& n, const Values&) {
                   return Method{n, Exact{}};
                 }});
  return all;
}

const std::vector<Entry>& entries() {
  static const std::vector<Entry> all = make_entries();
  return all;
}

const Entry& find_entry(const std::string& name) {
  const auto& all = entries();
  const auto found = std::find_if(all.begin(), all.end(), [&](const Entry& entry) { return entry.info.name == name; });
  if (found != all.end()) return *found;
  std::vector<std::string> known;
  for (const Entry& entry : all) known.push_back(entry.info.name);
  const std::string nearest = nearest_name(name, known);
  throw InvalidInput(fmt::format("unknown method \"{}\"{} `rubato methods` lists them", name,
                                 nearest.empty() ? ";" : fmt::format("; did you mean \"{}\"?", nearest)));
}

/// With its parameters, as a study has it; numbers of those without a default are an example.
std::string spelling_of(const MethodInfo& info) {
  std::string text = fmt::format("{{ name = \"{}\"", info.name);
  for (const MethodParameter& parameter : info.parameters) {
    const double example = parameter.name == "beta" ? 0.25 : 0.5;  // average acceleration
    const double value = std::isnan(parameter.default_value) ? example : parameter.default_value;
    text += fmt::format(", {} = {}", parameter.name, value);
  }
  return text + " }";
}

struct Range {
  double low, high;
};

Range range_of(const std::string& method, const std::string& parameter) {
  if (method == "newmark") return parameter == "beta" ? Range{0.0, 10.0} : Range{0.5, 10.0};
  if (method == "wilson_theta") return {1.0, 5.0};
  if (method == "hht") return {-1.0 / 3.0 - 1e-12, 0.0};  // -0.3333 and -1/3 as they are typed
  return {0.0, 1.0};
}

}  // namespace

const std::vector<MethodInfo>& catalogue() {
  static const std::vector<MethodInfo> infos = [] {
    std::vector<MethodInfo> list;
    for (const Entry& entry : entries()) list.push_back(entry.info);
    return list;
  }();
  return infos;
}

const MethodInfo& find_method(const std::string& name) { return find_entry(name).info; }

Method make_method(const std::string& name, const std::vector<std::pair<std::string, double>>& parameters) {
  const Entry& entry = find_entry(name);
  std::vector<std::string> known;
  Values values;
  for (const MethodParameter& parameter : entry.info.parameters) {
    known.push_back(parameter.name);
    values[parameter.name] = parameter.default_value;
  }
  for (const auto& [key, value] : parameters) {
    const auto place = values.find(key);
    if (place == values.end())
      throw InvalidInput(
          known.empty() ? fmt::format("method \"{}\" takes no parameters, got \"{}\"", name, key)
                        : fmt::format("method \"{}\" has no parameter \"{}\"{}", name, key, suggestion(key, known)));
    place->second = value;
  }
  for (const MethodParameter& parameter : entry.info.parameters) {
    const double value = values.at(parameter.name);
    const bool given = std::any_of(parameters.begin(), parameters.end(),
                                   [&](const auto& pair) { return pair.first == parameter.name; });
    if (!given && std::isnan(value))
      throw InvalidInput(fmt::format("method \"{}\" needs the parameter \"{}\" in {}; write method = {}", name,
                                     parameter.name, parameter.range, spelling_of(entry.info)));
    const Range range = range_of(name, parameter.name);
    if (!(value >= range.low && value <= range.high))
      throw InvalidInput(
          fmt::format("method \"{}\": {} must lie in {}, got {}", name, parameter.name, parameter.range, value));
  }
  return entry.make(name, values);
}

}  // namespace rubato::integrate
