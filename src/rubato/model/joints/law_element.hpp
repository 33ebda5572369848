#pragma once

#include <rubato/model/joints/lock.hpp>
#include <rubato/model/joints/number_difference.hpp>
#include <rubato/model/joints/plane_coordinate.hpp>
#include <rubato/model/joints/space_coordinate.hpp>
#include <rubato/model/laws/law.hpp>
#include <rubato/model/model.hpp>

#include <memory>
#include <string>
#include <variant>

namespace rubato::model {

/// Where a law acts in a mechanism: on the coordinate that a joint leaves free, or between two coordinates of nodes.
using LawCoordinate = std::variant<PlaneCoordinate, SpaceCoordinate, NumberDifference>;

/// The reaction of a joint that presses on a law: the norm of some of its multipliers.
struct PressingReaction {
  int joint = -1;        ///< among the mechanism's joints; -1: none presses
  int rows = 0;          ///< so many of its rows press, from the first on
  Index multiplier = 0;  ///< of the first, among those of all joints

  bool presses() const { return joint >= 0; }
  double force(const Motion& motion) const;  ///< [N]
};

/// A law of a mechanism. On a joint -force acts on the second part; between two coordinates -force acts on the first.
struct MechanismLaw {
  std::string name;
  std::string kind;  ///< its table in the study file
  LawCoordinate u;
  std::shared_ptr<const Law> law;
  Index index = 0;                                         ///< among the laws of its mechanism
  Index memory = 0;                                        ///< where its memory begins in that of a state
  std::size_t element = 0;                                 ///< of the elements of the mechanism
  NormalForce normal = {};                                 ///< of a law that takes one; its stop is a lock
  std::shared_ptr<const MechanismLaw> pressing = nullptr;  ///< the law whose force presses, instead
  std::shared_ptr<const Lock> stop = nullptr;              ///< the stop whose force presses, instead
  PressingReaction reaction = {};                          ///< the reaction that presses, instead

  bool is_angle() const {
    return std::visit([](const auto& of) { return of.is_angle(); }, u);
  }
  /// Whether u is the length of a strut.
  bool is_length() const {
    const auto* in_plane = std::get_if<PlaneCoordinate>(&u);
    const auto* in_space = std::get_if<SpaceCoordinate>(&u);
    return (in_plane && in_plane->kind == PlaneCoordinate::Kind::length) ||
           (in_space && in_space->kind == SpaceCoordinate::Kind::length);
  }
  double displacement(const Motion& motion) const {
    return std::visit([&](const auto& of) { return of.value(motion.q); }, u);
  }
  double rate(const Motion& motion) const {
    return std::visit([&](const auto& of) { return of.rate(motion); }, u);
  }
  /// Whether it, or what presses on it, follows t by itself.
  bool depends_on_time() const {
    return law->depends_on_time() || normal.formula || (pressing && pressing->depends_on_time());
  }

  /// What the law sees: in a step, from where that begins, and else at rest there.
  LawPoint point(const Motion& motion) const;
  /// Its force there, with its slopes. In a step its memory is left in motion.laws.next.
  LawAnswer answer(const Motion& motion) const;

 private:
  double normal_force(const Motion& motion) const;
};

/// What a stop of a mechanism presses with [N]: its force, with its slopes by s and s'; while it is open less than
/// nothing, how far its ends are apart as a force of its spring.
LawAnswer pressing_force(const Lock& stop, Index index, const Motion& motion);

/// The forces of a law on the nodes.
std::unique_ptr<Element> make_law_element(const MechanismLaw& law);

/// The same of a law on which presses what follows the motion, another law or a stop: its force depends on the
/// coordinates of all of them, and its tangent is not symmetric.
std::unique_ptr<Element> make_pressed_law_element(const MechanismLaw& law);

}  // namespace rubato::model
