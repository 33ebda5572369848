#pragma once

#include <rubato/analysis/parameter_dependence.hpp>
#include <rubato/analysis/steady/negative_stiffness.hpp>
#include <rubato/analysis/steady/steady_model.hpp>
#include <rubato/analysis/study_input.hpp>
#include <rubato/analysis/sweep.hpp>
#include <rubato/analysis/transient_plan.hpp>
#include <rubato/steady/steady_route.hpp>
#include <rubato/steady/steady_solver.hpp>

#include <memory>
#include <string>
#include <vector>

namespace rubato::analysis {

/// A damper curve with all its values: what the description says, evaluated and found possible.
struct DamperCurvePlan {
  using Objective = model::DamperCurveDescription::Objective;

  std::string parameter;           ///< its name
  std::size_t place = 0;           ///< among all parameters
  std::vector<double> values;      ///< of it, rising
  double from = 0.0, to = 0.0;     ///< of the excitation [rad/s]
  int samples = 17;                ///< of the scan for peaks, besides the natural frequencies
  std::size_t excitation = 0;      ///< the place of the parameter that takes the frequencies
  double excitation_factor = 1.0;  ///< its value over the frequency: 1/(2 pi) for one in hertz
  Sweep sweep;                     ///< of the other parameters: a curve a line
  ParameterDependence dependence;
  Objective objective = Objective::amplitude;
  bool has_optimum = true;  ///< whether it is wanted, and there are values to look between
  std::vector<Observed> observed = {};
  steady::SteadyRequest request = {};  ///< of a mechanism that at the values of the study
  steady::SteadyRoute route = {};      ///< periodic or harmonic balance
  std::string chosen_for = {};         ///< why that route, where none was asked for
  double highest = 0.0;                ///< frequency of the loads [rad/s]
  double noise = 1e-13;                ///< of the objective of one discretisation, relative

  std::shared_ptr<const SteadyModel> about = nullptr;  ///< of a mechanism: at the values of the study

  bool structure_follows_parameter = false, structure_follows_frequency = false;
  bool limits_follow_parameter = false;  ///< the linear limits
  std::vector<bool> is_structural = {};  ///< of each swept parameter: whether it changes the structure

  bool is_in_hertz = false;                ///< the study gives the frequencies so, and the report shows them so
  std::vector<std::string> warnings = {};  ///< of what is asked for, before anything is solved

  /// What is solved, at the values of the study.
  const auto& system(const StudyInput& input) const { return about ? about->system() : input.structure(); }
  /// Whether responses are truncated, and have an error that is told.
  bool is_truncated() const { return route.kind == steady::SteadyRoute::Kind::harmonic_balance; }
  double points() const { return static_cast<double>(sweep.lines()) * static_cast<double>(values.size()); }
  /// +1 where the lowest objective is best, -1 where the highest is.
  double sign() const { return objective == Objective::amplitude ? 1.0 : -1.0; }
  NegativeStiffness negative_stiffness = {};  ///< of structures, at the ends of what is swept
};

/// Evaluates a description and checks that it can run. Throws InvalidInput.
DamperCurvePlan plan_damper_curve(const std::string& name, const Location& where,
                                  const model::DamperCurveDescription& description, const StudyInput& input);

}  // namespace rubato::analysis
