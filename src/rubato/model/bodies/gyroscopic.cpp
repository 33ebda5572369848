#include <rubato/model/bodies/gyroscopic.hpp>

#include <utility>

namespace rubato::model {
namespace {

using numerics::Matrix3;
using numerics::Vector3;

class GyroscopicMoment final : public Element {
 public:
  GyroscopicMoment(std::string name, const SpaceNode& node, const Matrix3& inertia)
      : Element(std::move(name)), inertia_(inertia) {
    places_.assign(node.place.begin() + 3, node.place.end());
  }
  std::unique_ptr<Element> clone() const override { return std::make_unique<GyroscopicMoment>(*this); }

  void force(const Motion& motion, double* force) const override {
    const Vector3 omega = turning(motion);
    Eigen::Map<Vector3> moment(force);
    moment = omega.cross(inertia_ * omega);
  }
  void tangent(const Motion& motion, double stiffness, double damping, double* force, double* tangent) const override {
    (void)stiffness;
    GyroscopicMoment::force(motion, force);
    const Vector3 omega = turning(motion);
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> slope(tangent);
    slope = damping * (numerics::skew(omega) * inertia_ - numerics::skew(inertia_ * omega));
  }
  bool has_symmetric_tangent() const override { return false; }

 private:
  Vector3 turning(const Motion& motion) const {
    return {motion.v[places_[0]], motion.v[places_[1]], motion.v[places_[2]]};
  }

  Matrix3 inertia_;
};

}  // namespace

std::unique_ptr<Element> make_gyroscopic_moment(std::string name, const SpaceNode& node, const Matrix3& inertia) {
  return std::make_unique<GyroscopicMoment>(std::move(name), node, inertia);
}

}  // namespace rubato::model
