#include <rubato/model/mechanism_drawing.hpp>

#include <algorithm>
#include <iterator>

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
  const auto latches =
      std::count_if(joint.locks.begin(), joint.locks.end(), [](const LockDescription& lock) { return lock.is_latch; });
  if (joint.locks.empty()) return Limit::none;
  if (latches == 0) return Limit::stop;
  return latches == std::ssize(joint.locks) ? Limit::latch : Limit::both;
}

}  // namespace

DrawnJoint drawn_joint(const JointDescription& joint, const DrawnPoint& first, const DrawnPoint& second,
                       const std::array<double, 3>& axis) {
  return {joint.name, joint.type, first, second, axis, law_of(joint), limit_of(joint)};
}

}  // namespace rubato::model
