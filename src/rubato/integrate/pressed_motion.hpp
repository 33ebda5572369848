#pragma once

#include <rubato/integrate/cubic_path.hpp>
#include <rubato/model/laws/law.hpp>
#include <rubato/system/locally_nonlinear.hpp>

#include <vector>

namespace rubato::integrate {

/// What laws that are pressed see on the way from one state to another, with the rate of what presses. Displacements
/// follow the cubic through displacement and velocity of both ends. A workspace.
class PressedMotion {
 public:
  explicit PressedMotion(const system::LocallyNonlinear& system) : system_(system), next_(system.start().memory) {}

  /// At a share of the step; 0 is its start.
  model::LawPoint at(Index law, const system::State& from, const system::State& to, double share);
  /// The same place as it goes on from there, with the rates that are reached a moment later [s]: of what rests they
  /// say how it goes on.
  model::LawPoint going_on(Index law, const system::State& from, const system::State& to, double share, double moment);

 private:
  using Place = CubicPath::Place;
  struct Pressing {
    double value, rate, second_rate;
  };
  Place place(Index contact, const system::State& from, const system::State& to, double share) const;
  static model::Side side_at(double share) { return share > 0.0 ? model::Side::left : model::Side::right; }
  static model::LawPoint point_of(const Place& place, const Pressing& pressing, double t, model::Side side);
  Pressing pressing(Index law, const system::State& from, const system::State& to, double share, model::Side side);
  Pressing of_formula(const model::NormalForce& normal, double t, model::Side side) const;
  Pressing of_stop(Index stop, const Place& place) const;
  Pressing of_law(Index law, const system::State& from, const system::State& to, double share, model::Side side);

  const system::LocallyNonlinear& system_;
  Vector next_;  // memory of laws at the place
};

}  // namespace rubato::integrate
