#include <rubato/model/bodies/following_force.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace rubato::model {
namespace {

using numerics::skew;
using numerics::Vector3;

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

class SpaceFollowingForce final : public Element {
 public:
  SpaceFollowingForce(std::string name, const SpacePoint& point, std::size_t axis, TimeLaw law)
      : Element(std::move(name)),
        node_(point.node),
        axis_(static_cast<Index>(axis)),
        lever_(point.offset.cross(Vector3::Unit(axis_))),
        law_(std::move(law)) {
    places_.assign(point.node.place.begin(), point.node.place.end());
  }
  std::unique_ptr<Element> clone() const override { return std::make_unique<SpaceFollowingForce>(*this); }

  void force(const Motion& motion, double* force) const override {
    const double size = value(law_, motion.t, motion.side);
    Eigen::Map<Eigen::Matrix<double, 6, 1>> out(force);
    out << -size * node_.rotation(motion.q).toRotationMatrix().col(axis_), -size * lever_;
  }
  void tangent(const Motion& motion, double stiffness, double, double* out, double* tangent) const override {
    force(motion, out);
    Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> slope(tangent);
    slope.setZero();
    // R' = R (I + skew(d)) for a body increment d: the direction changes by R (d x e).
    const double size = value(law_, motion.t, motion.side);
    slope.block<3, 3>(0, 3) =
        stiffness * size * node_.rotation(motion.q).toRotationMatrix() * skew(Vector3::Unit(axis_));
  }
  bool has_symmetric_tangent() const override { return false; }
  Role role() const override { return Role::load; }

 private:
  SpaceNode node_;
  Index axis_;
  Vector3 lever_;  // [m]
  TimeLaw law_;
};

class FixedMoment final : public Element {
 public:
  FixedMoment(std::string name, const SpaceNode& node, std::size_t axis, TimeLaw law)
      : Element(std::move(name)), node_(node), axis_(static_cast<Index>(axis)), law_(std::move(law)) {
    places_.assign(node.place.begin() + 3, node.place.end());
  }
  std::unique_ptr<Element> clone() const override { return std::make_unique<FixedMoment>(*this); }

  void force(const Motion& motion, double* force) const override {
    Eigen::Map<Vector3> out(force);
    out = -in_body(motion);
  }
  void tangent(const Motion& motion, double stiffness, double, double* out, double* tangent) const override {
    force(motion, out);
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> slope(tangent);
    slope = -stiffness * skew(in_body(motion));  // of R^T e by a body increment d: (R^T e) x d
  }
  bool has_symmetric_tangent() const override { return false; }
  Role role() const override { return Role::load; }

 private:
  Vector3 in_body(const Motion& motion) const {
    const double size = value(law_, motion.t, motion.side);
    return size * node_.rotation(motion.q).toRotationMatrix().row(axis_).transpose();
  }

  SpaceNode node_;
  Index axis_;
  TimeLaw law_;
};

}  // namespace

std::unique_ptr<Element> make_following_force(std::string name, const SpacePoint& point, std::size_t axis,
                                              TimeLaw law) {
  return std::make_unique<SpaceFollowingForce>(std::move(name), point, axis, std::move(law));
}

std::unique_ptr<Element> make_fixed_moment(std::string name, const SpaceNode& node, std::size_t axis, TimeLaw law) {
  return std::make_unique<FixedMoment>(std::move(name), node, axis, std::move(law));
}

std::unique_ptr<Element> make_following_force(std::string name, const PlanePoint& point, std::size_t axis,
                                              TimeLaw law) {
  return std::make_unique<FollowingForce>(std::move(name), point, axis, std::move(law));
}

}  // namespace rubato::model
