#pragma once

#include <rubato/system/mechanism_equations.hpp>

#include <array>
#include <vector>

namespace rubato::analysis {

/// States of a mechanism between the ends of an accepted step: travel from the start of the step, velocity,
/// acceleration and multipliers of equilibrium each by the polynomial through the last four ends of steps (error h^4;
/// fewer after the start, a jump of the loads or a lock; of accelerations and multipliers also after a kink of a load
/// or a drive, which they have themselves). It stays within 1.7 times its data, as StepInterpolation does for
/// structures, where steps pass over fast modes of beams. Constraints hold at the ends; between them to its error.
class MechanismInterpolation {
 public:
  /// @param kinks  times at which steps end since a load, a drive or a law may have a kink there, rising [s]
  MechanismInterpolation(const system::Mechanism& mechanism, std::vector<double> kinks);

  /// Takes an accepted step; every step of the march must be given.
  void take(const system::State& before, const system::State& after);
  /// The state at t in [before.t, after.t], with acceleration and multipliers.
  void at(double t, system::State& state);

 private:
  struct Knot {
    system::State state;
    model::Side side = model::Side::left;
    bool is_balanced = false;  ///< acceleration and multipliers are found when they are asked for
  };
  static constexpr std::size_t most_knots = 4;

  Knot& knot(std::size_t age) { return knots_[(newest_ + most_knots - age) % most_knots]; }
  void add(const system::State& state, model::Side side);
  /// How many of the knots do not lie too many turns away.
  std::size_t usable();

  const system::Mechanism& mechanism_;
  system::MechanismEquations equations_;
  std::array<Knot, most_knots> knots_;
  std::vector<double> kinks_;
  std::size_t newest_ = 0, count_ = 0;
  std::size_t since_kink_ = 0;  // how many knots, the one at the kink among them
  Vector last_acceleration_;    // as the march left it at the end of the last step
  Vector travel_, part_;
};

}  // namespace rubato::analysis
