#pragma once

#include <rubato/system/locally_nonlinear.hpp>

#include <array>
#include <span>

namespace rubato::analysis {

/// The weight of the value at times[i] in the polynomial through the values at all of them, at t (Lagrange).
double lagrange_weight(std::span<const double> times, std::size_t i, double t);

/// States between the ends of an accepted step.
///
/// Methods of order one and two: displacement, velocity and acceleration of equilibrium each by the polynomial through
/// the last four steps (error h^4 in each; fewer after the start and after a jump of the loads). It stays within 1.7
/// times its data: an unconditionally stable method may step over the periods of fast modes, whose velocities a Hermite
/// polynomial would multiply by the step. Methods of higher order follow every mode that they are stable for: they have
/// the quintic through displacement, velocity and acceleration at both ends (error h^6, h^5, h^4).
/// Sliders: the return map from the start of the step. Stops: at its displacement and velocity.
class StepInterpolation {
 public:
  /// @param order  of the method
  StepInterpolation(const system::LocallyNonlinear& system, int order);

  /// Takes an accepted step; every step of the march must be given.
  void take(const system::State& before, const system::State& after);
  /// The state at t in [before.t, after.t] and its acceleration [n].
  void at(double t, system::State& state, Vector& acceleration);

 private:
  /// An end of a step.
  struct Knot {
    system::State state;
    model::Side side = model::Side::left;  ///< which limit of the loads its acceleration takes
    bool has_acceleration = false;         ///< it is found when it is asked for
    Vector acceleration;
  };
  static constexpr std::size_t most_knots = 4;

  Knot& knot(std::size_t age) { return knots_[(newest_ + most_knots - age) % most_knots]; }
  void add(const system::State& state, model::Side side);
  bool jumps_at(double t);
  void through_knots(double t, system::State& state, Vector& acceleration);
  void through_ends(double t, system::State& state, Vector& acceleration);

  const system::LocallyNonlinear& system_;
  system::EquilibriumAcceleration equilibrium_;
  system::Loads loads_;
  Vector left_, right_;
  bool is_quintic_;
  std::array<Knot, most_knots> knots_;
  std::size_t newest_ = 0, count_ = 0;
};

}  // namespace rubato::analysis
