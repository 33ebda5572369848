#pragma once

#include <rubato/model/joints/number_difference.hpp>
#include <rubato/model/joints/plane_coordinate.hpp>
#include <rubato/model/joints/space_coordinate.hpp>
#include <rubato/model/laws/law.hpp>

#include <memory>
#include <string>
#include <variant>

namespace rubato::model {

/// Where a law acts in a mechanism: on the coordinate that a joint leaves free, or between two coordinates of nodes.
using LawCoordinate = std::variant<PlaneCoordinate, SpaceCoordinate, NumberDifference>;

/// A law of a mechanism. On a joint -force acts on the second part; between two coordinates -force acts on the first.
struct MechanismLaw {
  std::string name;
  std::string kind;  ///< its table in the study file
  LawCoordinate u;
  std::shared_ptr<const Law> law;
  Index index = 0;          ///< among the laws of its mechanism
  Index memory = 0;         ///< where its memory begins in that of a state
  std::size_t element = 0;  ///< of the elements of the mechanism

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
  /// What the law sees.
  LawPoint point(const Motion& motion) const {
    return std::visit(
        [&](const auto& of) {
          return LawPoint{of.value(motion.q), of.rate(motion), motion.t, motion.side};
        },
        u);
  }
};

/// The forces of a law on the nodes.
std::unique_ptr<Element> make_law_element(const MechanismLaw& law);

}  // namespace rubato::model
