#pragma once

#include <rubato/analysis/parameter_dependence.hpp>
#include <rubato/analysis/study_input.hpp>

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

// What the plans of steady responses have in common. Messages begin with `title`.
namespace rubato::analysis {

/// A parameter as a description names it; empty: none is named.
struct NamedParameter {
  std::string name;
  Location where;
};

/// Parameters that an analysis varies: their places among all, and where they are named.
struct VariedParameters {
  std::vector<std::size_t> places;
  std::vector<Location> where;
};

/// Throws InvalidInput unless all loads are harmonic or static, and there is one: what does not repeat has no steady
/// response.
void require_harmonic_loads(const StudyInput& input, const Location& where, const std::string& title);

/// The place of the parameter that takes the frequencies: the one that is wanted, or the only one that stands in the
/// frequencies of the loads and is not varied otherwise. Throws InvalidInput where there is none, or several.
std::size_t excitation_parameter(const NamedParameter& wanted, const VariedParameters& varied, const StudyInput& input,
                                 const std::string& title, const Location& where);

/// The dependence where some parameters are given values: those that are varied, and those of --set.
ParameterDependence dependence_of(const StudyInput& input, std::vector<std::size_t> varied);

/// Adds a warning where a response goes beyond the frequencies that a [reduction] is judged by.
/// @param highest  [rad/s]
void warn_of_reduction(const StudyInput& input, double highest, std::vector<std::string>& warnings);

/// A warning for every parameter of --set to which an analysis gives values of its own: what is set does nothing there.
/// @param varied  places of parameters, and what gives them their values: "its sweep"
std::vector<std::string> warn_of_settings(const StudyInput& input,
                                          const std::vector<std::pair<std::size_t, std::string>>& varied);

/// Throws InvalidInput for a varied parameter on which nothing depends, or whose name another column of results has.
/// @param kind  what it is called: "swept parameter"
void require_effect(const ParameterDependence& dependence, std::size_t parameter, const NamedParameter& named,
                    const std::vector<std::string>& columns, const std::string& kind, const std::string& title);

/// Throws InvalidInput unless a mechanism is asked for about its static equilibrium, and a structure as it is.
/// @param about_equilibrium  where that was asked for
void require_about(const std::optional<Location>& about_equilibrium, const StudyInput& input, const Location& where,
                   const std::string& title);

/// Whether what is assembled depends on a parameter: of a mechanism all that its equilibrium does. It refers to the
/// dependence.
/// @param varied  places of the parameters that take other values
std::function<bool(std::size_t)> model_dependence(const StudyInput& input, const ParameterDependence& dependence,
                                                  std::vector<std::size_t> varied);

/// Whether any of some points of a plan can be made. Where none can, the first says why.
class Possibility {
 public:
  Possibility(std::string title, Location where) : title_(std::move(title)), where_(std::move(where)) {}
  template <typename Make>
  void attempt(Make&& make) {
    try {
      make();
      is_possible_ = true;
    } catch (const InvalidInput& fault) {
      if (!fault_) fault_ = fault;
    }
  }
  /// Throws InvalidInput, at the place of the first fault or at the analysis, unless an attempt was successful.
  void require() const;

 private:
  std::string title_;
  Location where_;
  std::optional<InvalidInput> fault_;
  bool is_possible_ = false;
};

}  // namespace rubato::analysis
