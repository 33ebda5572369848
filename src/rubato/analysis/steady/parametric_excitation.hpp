#pragma once

#include <rubato/analysis/parameter_dependence.hpp>
#include <rubato/analysis/study_input.hpp>
#include <rubato/model/load_laws.hpp>
#include <rubato/numerics/formula.hpp>
#include <rubato/system/assembled_model.hpp>
#include <rubato/system/excitation.hpp>

#include <optional>
#include <span>
#include <vector>

namespace rubato::analysis {

/// A study's structure for given values of all parameters, with its loads. Negative normal loads count as zero. Throws
/// InvalidInput.
system::AssembledModel build_structure(const model::StudyDescription& study, const numerics::Parameters& values);

/// What drives a study's structure while parameters vary: the excitation at any values of some line parameters and of
/// one point parameter (the excitation frequency), without building the model again. What does not follow the point
/// parameter is evaluated once a line.
class ParametricExcitation {
 public:
  /// A slider whose normal load came out negative, and counts as zero.
  struct NegativeLoad {
    std::size_t slider;
    double load;  ///< [N]
  };

  /// @param line  places of the line parameters among all   @param point  that of the point parameter
  ParametricExcitation(const StudyInput& input, const ParameterDependence& dependence, std::vector<std::size_t> line,
                       std::size_t point);

  /// Begins a line. The structure is that of these values; it is looked at only here.
  void take_line(std::span<const double> values, const system::AssembledModel& structure);
  /// Writes the excitation at a point of the line into `out`, which must be the same object for all points of a line.
  /// Throws InvalidInput for values that cannot be: not finite, negative frequencies, and no common period unless that
  /// is allowed: then `out` has the limits alone.
  void take_point(double value, system::Excitation& out);
  void allow_no_period() { needs_period_ = false; }
  /// Whether the loads at the last point have a common period.
  bool has_period() const { return has_period_; }
  /// A time that holds the slowest ups and downs of loads without a common period, several times over [s].
  double window() const;

  /// All parameters at values of the line and of the point, for building a structure.
  const numerics::Parameters& parameters_at(std::span<const double> line, double point);
  /// Sliders with negative normal loads at the last point.
  const std::vector<NegativeLoad>& negative_loads() const { return negative_loads_; }

 private:
  /// A number or a formula of the parameters, and whether it follows the point parameter.
  struct Value {
    const model::Quantity* quantity = nullptr;
    std::optional<numerics::Formula> formula;
    bool follows_point = false;
    double now = 0.0;
  };
  /// A law that loads follow: which ones, and where they act, the structure knows.
  struct Law {
    Value amplitude, frequency, phase;
    double frequency_factor = 1.0;
    int derivative = 0;     ///< of the law, by which loads act
    bool scales = false;    ///< loads change with its frequency: they follow derivatives of it
    std::string part = {};  ///< for messages

    model::HarmonicLaw now;  ///< without the derivative
    int order = 0;           ///< over the fundamental; 0: static
  };
  struct Limit {
    Value coefficient, load;
    std::string part;
  };

  Value value_of(const model::Quantity& quantity);
  Law law_of(const model::LoadLaw& law);
  void evaluate(Value& value, const std::string& part, const char* key) const;
  void refresh_parameters();
  bool refresh_laws();
  void refresh_limits(system::Excitation& out);
  bool orders_hold() const;
  void find_orders();
  void fill(system::Excitation& out) const;

  const StudyInput& input_;
  const ParameterDependence& dependence_;
  std::vector<std::size_t> line_, followers_;
  std::size_t point_;
  std::vector<std::string> names_;
  std::vector<double> values_;                                       ///< of all parameters
  std::vector<std::pair<std::size_t, numerics::Formula>> formulas_;  ///< of parameters, in order
  numerics::Parameters named_;
  std::vector<Law> laws_;  ///< in the order of model::load_laws
  std::vector<Limit> limits_;
  std::vector<NegativeLoad> negative_loads_;
  const system::AssembledModel* structure_ = nullptr;
  bool is_new_line_ = true, needs_period_ = true, has_period_ = true;
};

}  // namespace rubato::analysis
