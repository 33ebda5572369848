#include <rubato/model/bodies/following_force.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace rubato::model {
namespace {

class FollowingForce final : public Element {
 public:
  FollowingForce(std::string name, const PlanePoint& point, std::size_t axis, TimeLaw law)
      : Element(std::move(name)), angle_(point.node.q + 2), law_(std::move(law)) {
    places_.assign(point.node.place.begin(), point.node.place.end());
    direction_ = axis == 0 ? std::array<double, 2>{1.0, 0.0} : std::array<double, 2>{0.0, 1.0};
    // Point and direction turn together: the moment about the node depends on t alone.
    lever_ = point.offset[0] * direction_[1] - point.offset[1] * direction_[0];
  }
  std::unique_ptr<Element> clone() const override { return std::make_unique<FollowingForce>(*this); }

  void force(const Motion& motion, double* force) const override {
    const double size = value(law_, motion.t, motion.side);
    const double c = std::cos(motion.q[angle_]), s = std::sin(motion.q[angle_]);
    force[0] = -size * (c * direction_[0] - s * direction_[1]);
    force[1] = -size * (s * direction_[0] + c * direction_[1]);
    force[2] = -size * lever_;
  }
  void tangent(const Motion& motion, double stiffness, double, double* out, double* tangent) const override {
    force(motion, out);
    std::fill(tangent, tangent + 9, 0.0);
    tangent[2] = -stiffness * out[1];  // d/dangle turns the force by a right angle
    tangent[5] = stiffness * out[0];
  }
  bool has_symmetric_tangent() const override { return false; }
  Role role() const override { return Role::load; }

 private:
  Index angle_;
  std::array<double, 2> direction_{};
  double lever_ = 0.0;  // [m]
  TimeLaw law_;
};

}  // namespace

std::unique_ptr<Element> make_following_force(std::string name, const PlanePoint& point, std::size_t axis,
                                              TimeLaw law) {
  return std::make_unique<FollowingForce>(std::move(name), point, axis, std::move(law));
}

}  // namespace rubato::model
