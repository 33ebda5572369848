#pragma once

#include <rubato/analysis/samples/key_numbers.hpp>
#include <rubato/analysis/sweep.hpp>
#include <rubato/model/description.hpp>

#include <map>
#include <string>
#include <vector>

namespace rubato::analysis {

/// Engine orders across the natural frequencies over a speed.
struct CampbellPlan {
  std::vector<double> orders;  ///< positive, multiples of the speed
  std::size_t speed = 0;       ///< among the swept parameters
  std::string unit;            ///< of the speed: "rad/s", "Hz", "rpm"
  double factor = 1.0;         ///< angular frequency over speed [rad/s]
};

/// Throws InvalidInput for orders that are not positive, a speed that is not swept or is negative, and random samples.
CampbellPlan plan_campbell(const model::SweptDescription& swept, const Sweep& sweep,
                           const numerics::Parameters& parameters, const std::string& title, const Location& where);

/// Where an engine order meets a natural frequency: n Omega = omega.
///
/// Between neighbouring speeds omega^2 is taken as linear in Omega^2, which is exact where the stiffness grows with the
/// square of the speed (Southwell's formula); else the error is of second order in the distance of the speeds.
struct Crossing {
  std::vector<double> parameters;  ///< the swept ones, that of the speed at the crossing
  double order = 0.0;
  std::size_t mode = 0;                         ///< among the labels
  double frequency = 0.0, damping_ratio = 0.0;  ///< [Hz], [-]
};

/// Finds the crossings of a sweep of modes.
class Campbell {
 public:
  Campbell(const CampbellPlan& plan, const Sweep& sweep) : plan_(plan), sweep_(sweep) {}

  /// Takes the frequencies [Hz] and damping ratios of a sample.
  void take(long number, std::span<const double> frequencies, std::span<const double> damping_ratios);
  /// By the other parameters as they came, then by order, mode and speed.
  std::vector<Crossing> crossings() const;
  /// The table `crossings`.
  /// @param modes  the labels
  void write(const std::string& name, const std::vector<std::string>& modes, results::Sink& sink) const;
  /// The crossings in a few lines.
  std::vector<std::string> findings(const std::vector<std::string>& modes) const;

 private:
  struct Point {
    double speed;
    std::vector<double> frequencies, damping_ratios;
  };
  void add_between(const Point& low, const Point& high, const std::vector<double>& parameters, double order,
                   std::size_t mode, bool is_last, std::vector<Crossing>& crossings) const;

  const CampbellPlan& plan_;
  const Sweep& sweep_;
  std::vector<std::vector<double>> keys_;  ///< values of the other parameters, in the order in which they came
  std::vector<std::vector<Point>> lines_;  ///< of each
};

}  // namespace rubato::analysis
