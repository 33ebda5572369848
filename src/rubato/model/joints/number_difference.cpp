#include <rubato/model/joints/coordinate_law.hpp>
#include <rubato/model/joints/number_difference.hpp>

#include <utility>

namespace rubato::model {

std::unique_ptr<Element> make_joint_spring(std::string name, const NumberDifference& s, double stiffness, double rest,
                                           const AtLock& when) {
  return std::make_unique<Spring<NumberDifference>>(std::move(name), s, stiffness, rest, when);
}

std::unique_ptr<Element> make_joint_damper(std::string name, const NumberDifference& s, double damping,
                                           const AtLock& when) {
  return std::make_unique<Damper<NumberDifference>>(std::move(name), s, damping, when);
}

std::unique_ptr<Joint> make_lock_joint(std::string name, const NumberDifference& s, double at, int lock) {
  return std::make_unique<LockJoint<NumberDifference>>(std::move(name), s, at, lock);
}

}  // namespace rubato::model
