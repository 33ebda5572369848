#pragma once

#include <rubato/integrate/balance.hpp>
#include <rubato/system/system.hpp>

#include <array>
#include <span>
#include <vector>

namespace rubato::analysis {

/// The weight of the value at times[i] in the polynomial through the values at all of them, at t (Lagrange).
double lagrange_weight(std::span<const double> times, std::size_t i, double t);

/// States between the ends of an accepted step.
///
/// Methods of order one and two: configuration, velocity, acceleration and multipliers of equilibrium each by the
/// polynomial through the last four ends of steps (error h^4 in each; fewer after the start, a jump of the loads or a
/// lock; of accelerations and multipliers also after a kink of a load or a drive, which they have themselves). Where
/// the system is not flat the polynomial is that of the travel from the start of the step. It stays within 1.7 times
/// its data: an unconditionally stable method may step over the periods of fast modes, whose velocities a Hermite
/// polynomial would multiply by the step. What loads and drives do beyond that polynomial is added to accelerations and
/// multipliers by the equations of motion: steps follow the motion, and where it is small loads swing within a step.
/// Methods of higher order follow every mode that they are stable for: in a flat system they have the quintic through
/// displacement, velocity and acceleration at both ends (error h^6, h^5), and the acceleration of equilibrium there.
/// Sliders: the return map from the start of the step. Stops: at its displacement and velocity. Constraints hold at the
/// ends; between them to the error of the interpolation.
class StepInterpolation {
 public:
  /// @param balance  of that system; must outlive this
  /// @param order    of the method
  /// @param kinks    times at which steps end since a load, a drive or a law may have a kink there, rising [s]
  StepInterpolation(const system::System& system, integrate::Balance& balance, int order,
                    std::vector<double> kinks = {});

  /// Takes an accepted step; every step of the march must be given.
  void take(const system::State& before, const system::State& after);
  /// The state at t in [before.t, after.t], with acceleration and multipliers.
  void at(double t, system::State& state);

 private:
  /// An end of a step.
  struct Knot {
    system::State state;
    model::Side side = model::Side::left;  ///< which limit of the loads its acceleration takes
    bool is_balanced = false;              ///< acceleration and multipliers are found when they are asked for
  };
  static constexpr std::size_t most_knots = 4;

  Knot& knot(std::size_t age) { return knots_[(newest_ + most_knots - age) % most_knots]; }
  void add(const system::State& state, model::Side side);
  bool goes_on(const system::State& before);
  /// How many of the knots do not lie too many turns away.
  std::size_t usable();
  void through_knots(std::size_t count, double t, system::State& state);
  void through_ends(double t, system::State& state);

  const system::System& system_;
  integrate::Balance& balance_;
  bool is_quintic_;
  std::array<Knot, most_knots> knots_;
  std::vector<double> kinks_;
  std::size_t newest_ = 0, count_ = 0;
  std::size_t since_kink_ = 0;  // how many knots, the one at the kink among them
  Vector last_acceleration_;    // as the march left it at the end of the last step
  Vector travel_, part_;
};

}  // namespace rubato::analysis
