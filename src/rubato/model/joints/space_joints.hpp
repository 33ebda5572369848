#pragma once

#include <rubato/model/joints/joint.hpp>
#include <rubato/model/joints/space_rows.hpp>

#include <array>
#include <memory>
#include <string>

// Joints between two nodes in space. Local coordinates are x, y, z and the body axes of the first node and then of the
// second. Rows "x", "y", "z" are forces [N] along the axes of the world or, where the second point may slide, of the
// first frame; rows "moment_..." are moments [N m].
namespace rubato::model {

/// Axes at a point that move with a node; the third is that of the joint.
struct SpaceFrame {
  SpacePoint point;
  numerics::Matrix3 axes = numerics::Matrix3::Identity();  ///< columns, in the axes of the node
};

/// The frame of a node that stands at a point of the world, with its third axis along `axis` and the first two at right
/// angles in an arbitrary but reproducible way; the same in the world for every node.
/// @param q     all numbers of all nodes at the moment of assembly
/// @param axis  not of length zero
SpaceFrame frame_at(const SpaceNode& node, const double* q, const numerics::Vector3& at, const numerics::Vector3& axis);

/// The angle by which the second frame has turned about the third axis of both, right-handed.
TurnAngle turn_of(const SpaceFrame& first, const SpaceFrame& second);

/// The angles of a universal joint about its pins, the first axis of the first frame and the second axis of the second:
/// that of the cross in the first part, and that of the second part on the cross, right-handed.
std::array<TurnAngle, 2> turns_of_cross(const SpaceFrame& first, const SpaceFrame& second);

enum class SpaceJointKind {
  rigid,        ///< nothing moves
  revolute,     ///< turns about the third axis
  prismatic,    ///< slides along it
  cylindrical,  ///< both
  spherical,    ///< turns about the point
  universal,    ///< turns about the first axis of the first frame and the second axis of the second
  planar,       ///< slides across the third axis, and turns about it
};
/// @param name  of the joint
std::unique_ptr<Joint> make_space_joint(SpaceJointKind kind, std::string name, const SpaceFrame& first,
                                        const SpaceFrame& second);

/// Turns about the third axis and moves along it by `lead` a turn [m], right-handed; a negative lead is a left-handed
/// screw. The turns are counted from the displacement.
constexpr int screw_thread_row = 4;  ///< the force along the axis that the thread carries
std::unique_ptr<Joint> make_space_screw(std::string name, const SpaceFrame& first, const SpaceFrame& second,
                                        double lead);

/// The points keep their distance: row "tension" [N]. length > 0.
std::unique_ptr<Joint> make_space_distance(std::string name, const SpacePoint& first, const SpacePoint& second,
                                           double length);

}  // namespace rubato::model
