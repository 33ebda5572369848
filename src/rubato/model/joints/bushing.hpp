#pragma once

#include <rubato/model/bodies/element.hpp>
#include <rubato/model/joints/free_coordinate.hpp>

#include <memory>
#include <string>
#include <vector>

namespace rubato::model {

/// How a frame of the second of two nodes in space has turned against one of the first: the rotation vector theta,
/// exp(theta) = F1^T F2, in both frames alike [rad]; |theta| < pi.
struct RelativeTurn {
  SpaceNode first, second;
  numerics::Matrix3 axes1, axes2;  ///< of the frames, in the axes of the nodes

  std::vector<Index> places() const;  ///< the rotations of both nodes [6]
  numerics::Vector3 value(const double* q) const;
  numerics::Vector3 rate(const Motion& motion) const;  ///< d theta/dt [rad/s]
};

/// An elastic mount between two nodes, whose axes turn with the first. With the displacements u of its point on the
/// second node and the rotation theta, the force -k u - c u' along each axis acts on the second, and the moment that
/// follows from the energy theta K theta/2 and from the dissipation theta' C theta'/2.
struct Bushing {
  std::string name;
  std::vector<FreeCoordinate> s;   ///< the displacements along its axes, and in the plane the angle
  std::vector<RelativeTurn> turn;  ///< in space, one
  std::vector<double> stiffness;   ///< x, y, rz, or x, y, z, rx, ry, rz [N/m], [N m/rad]
  std::vector<double> damping;     ///< likewise [N s/m], [N m s/rad]

  /// What it does to the second node, by its own axes: forces, then moments. @param values  [3] or [6]
  void forces(const Motion& motion, double* values) const;
};

/// The moments of a RelativeTurn: of the energy theta K theta/2, K diagonal. Beyond 3 rad they are no numbers.
/// @param stiffness  [N m/rad]
std::unique_ptr<Element> make_turn_spring(std::string name, const RelativeTurn& turn,
                                          const numerics::Vector3& stiffness);

/// The moments that do the work -theta' C theta', C diagonal. @param damping  [N m s/rad]
std::unique_ptr<Element> make_turn_damper(std::string name, const RelativeTurn& turn, const numerics::Vector3& damping);

}  // namespace rubato::model
