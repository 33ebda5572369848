#pragma once

#include <rubato/model/joints/plane_coordinate.hpp>
#include <rubato/model/joints/space_coordinate.hpp>
#include <rubato/model/laws/block_law.hpp>

#include <array>
#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace rubato::model {

/// One of the numbers of a contact in a mechanism: how far a point of one part has gone along a direction of a plane
/// that moves and turns with the other,
///
///   u = sign (s - zero) - radius (angle of the part - angle of the plane)
///
/// s along the direction; the last term in the plane only, of a disk that rolls. Its rate is that of the slip between
/// the material of both parts where they touch.
struct ContactNumber {
  std::variant<PlaneCoordinate, SpaceCoordinate> s;  ///< a displacement; its first node has the plane
  double sign = 1.0;
  double radius = 0.0;  ///< [m]

  static constexpr std::size_t most_places = SpaceCoordinate::tangent_size;
  std::vector<Index> places() const;
  double value(const double* q) const;                                      ///< [m]
  double rate(const Motion& motion) const;                                  ///< [m/s]
  void slope(const double* q, double* slope) const;                         ///< du/dq [k]
  void curvature(const double* q, double factor, double* curvature) const;  ///< factor d2u/dq2 [k x k]
};

/// A contact with separation in a mechanism: a point or a disk of the first part against a plane of the second. What
/// the law says acts along the plane and across it.
struct MechanismContact {
  std::string name;
  std::vector<ContactNumber> numbers;  ///< those along the plane, then that across it, positive where the ends near
  std::shared_ptr<const BlockLaw> law;
  Index index = 0;          ///< among the contacts of its mechanism
  Index memory = 0;         ///< where its memory begins in that of a state
  std::size_t element = 0;  ///< of the elements of the mechanism

  /// What the law sees where the motion is.
  BlockPoint point(const Motion& motion) const;
  /// Its forces there, with their slopes: in a step, from where that begins, and else at rest there. In a step its
  /// memory is left in motion.laws.next.
  BlockAnswer answer(const Motion& motion) const;
};

/// The forces of a contact on the nodes.
std::unique_ptr<Element> make_contact_element(const MechanismContact& contact);

}  // namespace rubato::model
