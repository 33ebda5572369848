#include <rubato/model/mechanism_drawing.hpp>

namespace rubato::model {
namespace {

DrawnJoint::Law law_of(const JointDescription& joint) {
  using Law = DrawnJoint::Law;
  if (joint.motion) return Law::drive;
  if (joint.stiffness || joint.drive_table) return Law::spring;  // a table is elastic
  if (joint.drive) return Law::force;
  return joint.damping ? Law::damper : Law::none;
}

DrawnJoint::Limit limit_of(const JointDescription& joint) {
  using Limit = DrawnJoint::Limit;
  if (!joint.lock) return Limit::none;
  return joint.lock->is_latch ? Limit::latch : Limit::stop;
}

}  // namespace

DrawnJoint drawn_joint(const JointDescription& joint, const DrawnPoint& first, const DrawnPoint& second,
                       const std::array<double, 3>& axis) {
  return {joint.name, joint.type, first, second, axis, law_of(joint), limit_of(joint)};
}

}  // namespace rubato::model
