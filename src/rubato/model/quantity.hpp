#pragma once

#include <rubato/core/error.hpp>
#include <rubato/numerics/formula.hpp>

#include <string>
#include <utility>

namespace rubato::model {

/// A number or, where `expression` is not empty, a formula of the parameters.
struct Quantity {
  double value = 0.0;
  std::string expression;
  Location where;

  Quantity() = default;
  Quantity(double number) : value(number) {}  // implicit: descriptions written in C++ read like the file
  Quantity(std::string formula) : expression(std::move(formula)) {}
  Quantity(const char* formula) : expression(formula) {}
};

/// The value of a quantity. Throws InvalidInput, at its place, for a faulty formula or a non-finite value; `what` names
/// the key in the message.
double evaluate(const Quantity& quantity, const numerics::Parameters& parameters, const std::string& what);

}  // namespace rubato::model
