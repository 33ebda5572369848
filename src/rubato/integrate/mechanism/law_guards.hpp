#pragma once

#include <rubato/integrate/cubic_path.hpp>
#include <rubato/integrate/timeline.hpp>
#include <rubato/system/mechanism_equations.hpp>

#include <vector>

namespace rubato::integrate {

/// The guards of the laws of a mechanism within a step, with what presses on them. What laws see goes as the cubic
/// through displacement and velocity of both ends. A workspace.
class LawGuards {
 public:
  /// @param resolution  [s]: at rest is who would be so within this time
  LawGuards(const model::Mechanism& mechanism, Index size, double resolution);

  /// The law whose guard vanishes first, not before a share of the step; -1: none.
  Crossing first_crossing(const system::State& from, const system::State& to, double least);
  /// The largest model::LawResolution::unresolved() of the laws in a step.
  double unresolved(const system::State& from, const system::State& to);
  /// Of a law, at the end of a step.
  GuardValue guard(Index law, const system::State& from, const system::State& to);
  /// The contact whose ends meet or part first, not before a share of the step; -1: none.
  Crossing first_touch(const system::State& from, const system::State& to, double least);
  /// What is left to that at the end of a step.
  GuardValue touch(Index contact, const system::State& from, const system::State& to);
  /// Whether the ends of a contact with a dashpot, which pushes at once, meet at the end of a step.
  bool hits_a_dashpot(const system::State& from, const system::State& to);
  /// Whether a step began at the instant at which they do.
  bool stood_at_change(Index contact, const system::State& from, const system::State& to);
  /// How a law that sticks goes on at the end of a step that may have ended at a transition, or went on at its start.
  model::Law::Contact contact(Index law, const system::State& before, const system::State& after, bool at_end);

 private:
  using Place = CubicPath::Place;
  struct Pressing {
    double value, rate, second_rate;
  };
  void follow(const system::State& from, const system::State& to);
  template <class Coordinate>
  Place place(const Coordinate& u, double share) const;
  model::LawPoint at(const model::MechanismLaw& law, double share);
  model::LawPoint going_on(const model::MechanismLaw& law, double share, double moment);
  Pressing pressing(const model::MechanismLaw& law, double share, model::Side side);
  Pressing of_stop(const model::Lock& stop, bool is_engaged, const Place& place) const;
  Pressing of_reaction(const model::PressingReaction& reaction, double share) const;
  Pressing of_law(const model::MechanismLaw& law, double share, model::Side side);
  double value(const model::MechanismLaw& law, double share);
  /// What presses the ends of a contact together over a step, as a depth: negative while they are apart, and where the
  /// dashpot would pull.
  struct Pressed {
    CubicPath depth;
    double delay;  ///< cn/kn [s]
    GuardValue at(double share) const;
  };
  Pressed pressed(const model::MechanismContact& contact) const;
  /// 1 of one that begins a step pressed, -1 of one that begins it open.
  double side(const Pressed& pressed) const;
  /// Above zero until it changes. Ends that meet do so a moment late: at the end of the step they are pressed.
  GuardValue until_change(const Pressed& pressed, double sign, double share) const;

  const model::Mechanism& mechanism_;
  double resolution_;
  const system::State *from_ = nullptr, *to_ = nullptr;
  model::Motion start_, end_;
  std::vector<double> start_velocity_, end_velocity_;  // after a zero
  std::vector<double> next_;                           // memory of laws at a place
};

}  // namespace rubato::integrate
