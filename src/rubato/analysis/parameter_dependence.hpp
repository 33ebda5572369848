#pragma once

#include <rubato/model/description.hpp>
#include <rubato/model/fields/key.hpp>

#include <array>
#include <string>
#include <vector>

namespace rubato::analysis {

/// Which quantities of a model change when a parameter changes, directly or through parameters that depend on it.
class ParameterDependence {
 public:
  using Role = model::Role;

  /// @param values  of all parameters, in the order of the study
  /// @param fixed   places of parameters that keep the value given to them, whatever their formula
  /// Throws InvalidInput for a faulty formula.
  ParameterDependence(const model::StudyDescription& study, const numerics::Parameters& values,
                      const std::vector<std::size_t>& fixed);

  bool reaches(std::size_t parameter, Role role) const;
  bool reaches_anything(std::size_t parameter) const;
  /// The same, and what a steady response does not have: the start, what acts in static states only.
  bool reaches_model(std::size_t parameter) const;
  /// The parameters whose formulas follow a parameter, in the order of the study, without itself.
  std::vector<std::size_t> followers(std::size_t parameter) const;
  /// Whether a formula changes with a parameter.
  bool follows(const model::Quantity& quantity, std::size_t parameter) const;
  /// Whether a parameter has a formula that still holds.
  bool has_formula(std::size_t parameter) const;

  /// The parameters that stand in the frequency of a harmonic load.
  std::vector<std::size_t> in_frequencies() const;
  /// Whether a parameter stands in no `angular_frequency`, but in a `frequency` [Hz].
  bool is_in_hertz(std::size_t parameter) const;

 private:
  std::vector<bool> reached_by(std::size_t parameter) const;
  std::vector<std::size_t> used(const model::Quantity& quantity, bool of_time = false) const;

  const model::StudyDescription& study_;
  const numerics::Parameters& values_;
  std::vector<std::vector<std::size_t>> formula_uses_;  ///< of each parameter; empty where it is fixed
  std::array<std::vector<bool>, 4> role_uses_;          ///< by role, whether each parameter stands in such a quantity
  std::vector<bool> model_uses_;                        ///< whether each parameter stands in any quantity of the model
  std::vector<bool> in_angular_frequency_, in_frequency_;
};

}  // namespace rubato::analysis
