#pragma once

#include <rubato/analysis/parameter_dependence.hpp>
#include <rubato/analysis/steady/negative_stiffness.hpp>
#include <rubato/analysis/steady/steady_model.hpp>
#include <rubato/analysis/study_input.hpp>
#include <rubato/analysis/sweep.hpp>
#include <rubato/analysis/transient_plan.hpp>
#include <rubato/steady/steady_route.hpp>

#include <memory>
#include <string>
#include <vector>

namespace rubato::analysis {

/// A frequency response with all its values: what the description says, evaluated and found possible.
struct FrequencyResponsePlan {
  /// A point of a line: which frequency, and which way the sweep goes.
  struct Step {
    std::size_t frequency;
    bool is_downwards;
  };

  std::vector<double> frequencies;  ///< rising [rad/s]
  std::size_t excitation = 0;       ///< the place of the parameter that takes them
  double excitation_factor = 1.0;   ///< its value over the frequency: 1/(2 pi) for one in hertz
  Sweep sweep;
  ParameterDependence dependence;
  std::vector<Step> steps = {};  ///< of every line, in the order in which they are solved

  steady::SteadyRoute route = {};
  steady::SteadyStart start = steady::SteadyStart::unloaded;
  bool has_both_directions = false;
  std::vector<Observed> observed = {};
  steady::SteadyRequest request = {};
  bool shows_first_parts = false;  ///< the real and the imaginary part of the first harmonic

  std::vector<bool> waveform_at = {};  ///< of each frequency
  int waveform_points = 0;             ///< 0: none are kept

  bool structure_follows_point = false;
  bool has_other_fundamental = false;    ///< the loads repeat with another frequency (engine orders)
  std::vector<bool> is_structural = {};  ///< of each swept parameter: whether it changes the structure
  std::vector<bool> is_linear = {};      ///< whether it changes the linear limits
  std::vector<bool> divides_lanes = {};  ///< whether lines of different values cannot be solved side by side

  std::shared_ptr<const SteadyModel> about = nullptr;  ///< of a mechanism: at the values of the study, its first point

  bool is_in_hertz = false;                ///< the study gives the frequencies so, and the report shows them so
  std::vector<std::string> warnings = {};  ///< of what is asked for, before anything is solved

  /// What is solved, at the values of the study.
  const auto& system(const StudyInput& input) const { return about ? about->system() : input.structure(); }
  /// Whether loads without a common period are marched: what settles is that of a structure.
  bool may_lack_period(const StudyInput& input) const {
    return route.kind == steady::SteadyRoute::Kind::time_marching && !input.kind.is_constrained();
  }
  double points() const { return static_cast<double>(sweep.lines()) * static_cast<double>(steps.size()); }
  /// How many points are solved one after another: all of a line where each depends on the one before, else a number
  /// that bounds what is kept in memory. What is solved apart begins afresh, whatever the number of threads.
  std::size_t steps_a_piece() const;
  NegativeStiffness negative_stiffness = {};  ///< of structures, at the ends of what is swept
};

/// Evaluates a description and checks that it can run. Throws InvalidInput.
FrequencyResponsePlan plan_frequency_response(const std::string& name, const Location& where,
                                              const model::FrequencyResponseDescription& description,
                                              const StudyInput& input);

}  // namespace rubato::analysis
