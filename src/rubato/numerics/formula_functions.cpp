#include <rubato/numerics/formula_functions.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>

namespace rubato::numerics {
namespace {

using D = TimeDerivatives;

constexpr Parity even{true, false}, odd{false, true}, neither{};

const std::array<FormulaFunction, 18> functions{{
    {"sin", [](double x) { return std::sin(x); },
     [](double x) {
       return D{std::sin(x), std::cos(x), -std::sin(x)};
     },
     series::sin, odd},
    {"cos", [](double x) { return std::cos(x); },
     [](double x) {
       return D{std::cos(x), -std::sin(x), -std::cos(x)};
     },
     series::cos, even},
    {"tan", [](double x) { return std::tan(x); },
     [](double x) {
       const double f = std::tan(x), first = 1.0 + f * f;
       return D{f, first, 2.0 * f * first};
     },
     series::tan, odd},
    {"asin", [](double x) { return std::asin(x); },
     [](double x) {
       const double first = 1.0 / std::sqrt(1.0 - x * x);
       return D{std::asin(x), first, x * first * first * first};
     },
     series::asin, odd},
    {"acos", [](double x) { return std::acos(x); },
     [](double x) {
       const double first = -1.0 / std::sqrt(1.0 - x * x);
       return D{std::acos(x), first, x * first * first * first};
     },
     series::acos, neither},
    {"atan", [](double x) { return std::atan(x); },
     [](double x) {
       const double first = 1.0 / (1.0 + x * x);
       return D{std::atan(x), first, -2.0 * x * first * first};
     },
     series::atan, odd},
    {"sinh", [](double x) { return std::sinh(x); },
     [](double x) {
       return D{std::sinh(x), std::cosh(x), std::sinh(x)};
     },
     series::sinh, odd},
    {"cosh", [](double x) { return std::cosh(x); },
     [](double x) {
       return D{std::cosh(x), std::sinh(x), std::cosh(x)};
     },
     series::cosh, even},
    {"tanh", [](double x) { return std::tanh(x); },
     [](double x) {
       const double f = std::tanh(x), first = 1.0 - f * f;
       return D{f, first, -2.0 * f * first};
     },
     series::tanh, odd},
    {"asinh", [](double x) { return std::asinh(x); },
     [](double x) {
       const double first = 1.0 / std::sqrt(x * x + 1.0);
       return D{std::asinh(x), first, -x * first * first * first};
     },
     series::asinh, odd},
    {"acosh", [](double x) { return std::acosh(x); },
     [](double x) {
       const double first = 1.0 / std::sqrt(x * x - 1.0);
       return D{std::acosh(x), first, -x * first * first * first};
     },
     series::acosh, neither},
    {"atanh", [](double x) { return std::atanh(x); },
     [](double x) {
       const double first = 1.0 / (1.0 - x * x);
       return D{std::atanh(x), first, 2.0 * x * first * first};
     },
     series::atanh, odd},
    {"log2", [](double x) { return std::log2(x); },
     [](double x) {
       return D{std::log2(x), std::numbers::log2e / x, -std::numbers::log2e / (x * x)};
     },
     series::log2, neither},
    {"log10", [](double x) { return std::log10(x); },
     [](double x) {
       return D{std::log10(x), std::numbers::log10e / x, -std::numbers::log10e / (x * x)};
     },
     series::log10, neither},
    {"log", [](double x) { return std::log(x); },
     [](double x) {
       return D{std::log(x), 1.0 / x, -1.0 / (x * x)};
     },
     series::log, neither},
    {"ln", [](double x) { return std::log(x); },
     [](double x) {
       return D{std::log(x), 1.0 / x, -1.0 / (x * x)};
     },
     series::log, neither},
    {"exp", [](double x) { return std::exp(x); },
     [](double x) {
       return D{std::exp(x), std::exp(x), std::exp(x)};
     },
     series::exp, neither},
    {"sqrt", [](double x) { return std::sqrt(x); },
     [](double x) {
       const double f = std::sqrt(x);
       return D{f, 0.5 / f, -0.25 / (f * x)};
     },
     series::sqrt, neither},
}};

}  // namespace

const std::array<FormulaFunction, 18>& formula_functions() { return functions; }

bool is_function(const std::string& name) {
  static constexpr std::array<std::string_view, 8> with_nodes{"abs", "sign", "rint", "atan2",
                                                              "min", "max",  "sum",  "avg"};
  return std::find(with_nodes.begin(), with_nodes.end(), name) != with_nodes.end() ||
         std::any_of(functions.begin(), functions.end(), [&](const auto& one) { return name == one.name; });
}

}  // namespace rubato::numerics
