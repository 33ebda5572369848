#pragma once

#include <rubato/model/joints/joint.hpp>
#include <rubato/model/time_law.hpp>
#include <rubato/numerics/formula.hpp>

#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace rubato::model {

/// How a coordinate moves with time [rad] or [m]: a formula, or a table whose pieces are straight.
using MotionLaw = std::variant<numerics::Formula, TableLaw>;

/// The law and its derivatives at t. Those of a table are the slope of the piece on that side, and zero.
numerics::TimeDerivatives derivatives(const MotionLaw& law, double t, Side side);

/// A joint's coordinate that moves as a law says: a drive.
struct PrescribedMotion {
  std::string name;  ///< of the joint
  MotionLaw law;
  int joint = -1;  ///< the constraint that drives it, among the mechanism's
};

/// The constraint s(q) - law(t) = 0 on a joint's coordinate s: row "drive_moment" [N m] of an angle, "drive_force" [N]
/// of a displacement. The multiplier is what the drive does against a growing s.
/// @tparam Coordinate  has places, value, slope, curvature and rate, as PlaneCoordinate has
template <class Coordinate>
class PrescribedJoint final : public Joint {
 public:
  PrescribedJoint(std::string name, Coordinate s, MotionLaw law)
      : Joint(std::move(name)), s_(std::move(s)), law_(std::move(law)) {
    places_ = s_.places();
    row_names_ = {s_.kind == Coordinate::Kind::angle ? "drive_moment" : "drive_force"};
    curvature_.resize(places_.size() * places_.size());
  }
  std::unique_ptr<Joint> clone() const override { return std::make_unique<PrescribedJoint>(*this); }

  void constraint(const Motion& motion, double* g, double* jacobian) const override {
    g[0] = s_.value(motion.q) - derivatives(law_, motion.t, motion.side).value;
    s_.slope(motion.q, jacobian);
  }
  void curvature(const Motion& motion, const double* multiplier, double* curvature) const override {
    s_.curvature(motion.q, multiplier[0], curvature);
  }
  void rate(const Motion& motion, double* out) const override {
    out[0] = -derivatives(law_, motion.t, motion.side).rate;
  }
  void second_rate(const Motion& motion, double* out) const override {
    s_.curvature(motion.q, 1.0, curvature_.data());
    const std::size_t k = places_.size();
    out[0] = -derivatives(law_, motion.t, motion.side).second_rate;
    for (std::size_t i = 0; i < k; ++i)
      for (std::size_t j = 0; j < k; ++j) out[0] += motion.v[places_[i]] * curvature_[i * k + j] * motion.v[places_[j]];
  }
  bool has_symmetric_curvature() const override { return Coordinate::has_symmetric_curvature; }

 private:
  Coordinate s_;
  MotionLaw law_;
  mutable std::vector<double> curvature_;
};

}  // namespace rubato::model
