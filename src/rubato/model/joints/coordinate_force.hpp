#pragma once

#include <rubato/model/bodies/element.hpp>
#include <rubato/model/laws/law.hpp>

#include <algorithm>
#include <string>
#include <utility>

// Private to the joints: forces on a coordinate s, in the plane and in space.
namespace rubato::model {

/// A force on s, turned into forces on the nodes.
/// @tparam Coordinate  has tangent_size, value, slope, curvature and rate, as PlaneCoordinate has
template <class Coordinate>
class CoordinateForce : public Element {
 protected:
  static constexpr int k = Coordinate::tangent_size;

 public:
  CoordinateForce(std::string name, const Coordinate& s) : Element(std::move(name)), s_(s) { places_ = s.places(); }

  void force(const Motion& motion, double* force) const override {
    std::fill(force, force + k, 0.0);
    if (!is_at_work(motion)) return;
    double slope[k];
    s_.slope(motion.q, slope);
    const double applied = answer(motion, s_.value(motion.q), s_.rate(motion), false).force;
    for (int i = 0; i < k; ++i) force[i] = -applied * slope[i];
  }

  void tangent(const Motion& motion, double stiffness, double damping, double* force, double* tangent) const override {
    std::fill(force, force + k, 0.0);
    std::fill(tangent, tangent + k * k, 0.0);
    if (!is_at_work(motion)) return;
    double slope[k], rate_slope[k];
    s_.slope(motion.q, slope);
    const LawAnswer applied = answer(motion, s_.value(motion.q), s_.rate(motion), true);
    if (!s_.has_constant_slope()) {
      s_.curvature(motion.q, 1.0, tangent);
      for (int i = 0; i < k; ++i) {  // ds'/dq = v curvature
        rate_slope[i] = 0.0;
        for (int j = 0; j < k; ++j) rate_slope[i] += motion.v[places_[std::size_t(j)]] * tangent[j * k + i];
      }
      for (int i = 0; i < k * k; ++i) tangent[i] *= -stiffness * applied.force;
    } else {
      std::fill(rate_slope, rate_slope + k, 0.0);
    }
    for (int i = 0; i < k; ++i) {
      force[i] = -applied.force * slope[i];
      for (int j = 0; j < k; ++j)
        tangent[i * k + j] -= slope[i] * ((stiffness * applied.by_u + damping * applied.by_rate) * slope[j] +
                                          stiffness * applied.by_rate * rate_slope[j]);
    }
  }

  bool has_symmetric_tangent() const override {
    return s_.has_constant_slope() || (Coordinate::has_symmetric_curvature && !depends_on_rate());
  }

 protected:
  /// What acts on s [N] or [N m], in its direction, and its slopes by s and s' where they are asked for.
  virtual LawAnswer answer(const Motion& motion, double s, double rate, bool with_slopes) const = 0;
  virtual bool depends_on_rate() const = 0;
  virtual bool is_at_work(const Motion&) const { return true; }

  Coordinate s_;
};

}  // namespace rubato::model
