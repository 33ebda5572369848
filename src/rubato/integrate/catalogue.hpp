#pragma once

#include <rubato/integrate/method.hpp>

#include <string>
#include <vector>

namespace rubato::integrate {

/// A parameter that a method takes in the study file.
struct MethodParameter {
  std::string name;        ///< "alpha", "beta", "gamma", "rho_inf", "theta"
  double default_value;    ///< NaN: must be given
  std::string range;       ///< for people: "[-1/3, 0]"
  std::string convention;  ///< sign convention, in a sentence
};

/// What the catalogue says of a method.
struct MethodInfo {
  std::string name;
  int order = 0;  ///< of displacement and velocity on smooth problems; 0: exact
  bool is_explicit = false;
  std::string stability;  ///< "omega h <= 2", "unconditional", "no stable step without damping", ...
  std::string formula;    ///< one step, in the letters of the documentation; several lines
  std::string source;     ///< author, year, equation
  std::vector<MethodParameter> parameters;
};

/// All methods, in the order of the documentation.
const std::vector<MethodInfo>& catalogue();

/// The entry of a name; throws InvalidInput with the nearest name.
const MethodInfo& find_method(const std::string& name);

/// The method of a name with given parameters (those not given have their defaults). Throws InvalidInput for an unknown
/// name or parameter, a missing one, or a value out of its range; the message names the method, the parameter and the
/// range.
Method make_method(const std::string& name, const std::vector<std::pair<std::string, double>>& parameters = {});

}  // namespace rubato::integrate
