#pragma once

#include <rubato/core/error.hpp>
#include <rubato/model/joints/coordinate_force.hpp>
#include <rubato/model/joints/joint.hpp>
#include <rubato/model/joints/plane_coordinate.hpp>
#include <rubato/numerics/formula.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

// Private to the joints: forces on, and locks of, the coordinate s that a joint leaves free, in the plane and in space.
// A coordinate has tangent_size, value, slope, curvature and rate, as PlaneCoordinate has.
namespace rubato::model {

/// A force on s by a law of (s, s', t) without a memory.
template <class Coordinate>
class CoordinateLaw : public CoordinateForce<Coordinate> {
  using Base = CoordinateForce<Coordinate>;

 public:
  CoordinateLaw(std::string name, const Coordinate& s, const AtLock& when) : Base(std::move(name), s), when_(when) {}

 protected:
  virtual double law(double s, double rate, double t) const = 0;
  virtual void law_slopes(double s, double rate, double t, double& by_s, double& by_rate) const = 0;
  /// Of a law that switches with time: just before or after, as the side says.
  virtual double time_of(const Motion& motion) const { return motion.t; }

  bool is_at_work(const Motion& motion) const override { return when_.is_at_work(motion); }
  LawAnswer answer(const Motion& motion, double s, double rate, bool with_slopes) const override {
    const double t = time_of(motion);
    LawAnswer result{law(s, rate, t), 0.0, 0.0};
    if (with_slopes) law_slopes(s, rate, t, result.by_u, result.by_rate);
    return result;
  }

  AtLock when_;
};

template <class Coordinate>
class Spring final : public CoordinateLaw<Coordinate> {
  using Base = CoordinateLaw<Coordinate>;
  using Base::s_, Base::when_;

 public:
  Spring(std::string name, const Coordinate& s, double stiffness, double rest, const AtLock& when)
      : Base(std::move(name), s, when), stiffness_(stiffness), rest_(rest) {}
  std::unique_ptr<Element> clone() const override { return std::make_unique<Spring>(*this); }
  double stored_energy(const Motion& motion) const override {
    if (!when_.is_at_work(motion)) return 0.0;
    const double stretch = s_.value(motion.q) - rest_;
    return 0.5 * stiffness_ * stretch * stretch;
  }

 private:
  double law(double s, double, double) const override { return -stiffness_ * (s - rest_); }
  void law_slopes(double, double, double, double& by_s, double&) const override { by_s = -stiffness_; }
  bool depends_on_rate() const override { return false; }

  double stiffness_, rest_;
};

template <class Coordinate>
class Damper final : public CoordinateLaw<Coordinate> {
  using Base = CoordinateLaw<Coordinate>;
  using Base::s_, Base::when_;

 public:
  Damper(std::string name, const Coordinate& s, double damping, const AtLock& when)
      : Base(std::move(name), s, when), damping_(damping) {}
  std::unique_ptr<Element> clone() const override { return std::make_unique<Damper>(*this); }
  Element::Role role() const override { return Element::Role::damper; }

 private:
  double law(double, double rate, double) const override { return -damping_ * rate; }
  void law_slopes(double, double, double, double&, double& by_rate) const override { by_rate = -damping_; }
  bool depends_on_rate() const override { return true; }

  double damping_;
};

/// The force that a table over s gives; elastic.
template <class Coordinate>
class TabulatedLaw final : public CoordinateLaw<Coordinate> {
  using Base = CoordinateLaw<Coordinate>;
  using Base::s_, Base::when_;

 public:
  TabulatedLaw(std::string name, const Coordinate& s, CoordinateTable table, const AtLock& when)
      : Base(std::move(name), s, when), table_(std::move(table)) {}
  std::unique_ptr<Element> clone() const override { return std::make_unique<TabulatedLaw>(*this); }
  bool has_kinks() const override { return true; }
  std::string domain() const override {
    return fmt::format(", whose table reaches from {} to {},", table_.at.front(), table_.at.back());
  }
  double stored_energy(const Motion& motion) const override {
    return when_.is_at_work(motion) ? table_(s_.value(motion.q)).potential : 0.0;
  }

 private:
  double law(double s, double, double) const override { return table_(s).force; }
  void law_slopes(double s, double, double, double& by_s, double&) const override { by_s = table_(s).slope; }
  bool depends_on_rate() const override { return false; }

  CoordinateTable table_;
};

template <class Coordinate>
class Drive final : public CoordinateLaw<Coordinate> {
  using Base = CoordinateLaw<Coordinate>;
  using Base::s_, Base::when_;

 public:
  Drive(std::string name, const Coordinate& s, std::string formula, const numerics::Parameters& parameters,
        const AtLock& when)
      : Base(std::move(name), s, when), formula_(std::move(formula), parameters, true, {s.name(), "rate"}) {
    uses_ = {formula_.uses(0), formula_.uses(1)};
    is_constant_ = !uses_[0] && !uses_[1] && !formula_.uses_time();
    if (is_constant_) constant_ = formula_();
  }
  std::unique_ptr<Element> clone() const override { return std::make_unique<Drive>(*this); }
  bool has_kinks() const override { return true; }  // as far as is known
  Element::Role role() const override { return Element::Role::load; }

 private:
  double time_of(const Motion& motion) const override {
    constexpr double at_switch = 16.0 * std::numeric_limits<double>::epsilon();  // to which a step meets its time
    return formula_.has_switches() ? motion.t * (motion.side == Side::left ? 1.0 - at_switch : 1.0 + at_switch)
                                   : motion.t;
  }
  double law(double s, double rate, double t) const override {
    return is_constant_ ? constant_ : formula_(t, std::array{s, rate});
  }
  // Exact, since modes are made of them: nothing tells how short a difference would have to be. Where the formula has
  // no finite slope (s sqrt(abs(s)) at zero, whose terms are 0 times infinity) it is one: steps of the cube root of
  // round-off.
  void law_slopes(double s, double rate, double t, double& by_s, double& by_rate) const override {
    constexpr double relative = 6e-6;
    const std::array<double, 2> at{s, rate};
    const auto slope = [&](std::size_t i) {
      const double exact = formula_.with_slope(i, t, at).slope;
      if (std::isfinite(exact)) return exact;
      const double step = relative * (1.0 + std::abs(at[i]));
      const double ds = i == 0 ? step : 0.0, dr = i == 1 ? step : 0.0;
      return (law(s + ds, rate + dr, t) - law(s - ds, rate - dr, t)) / (2.0 * step);
    };
    if (uses_[0]) by_s = slope(0);
    if (uses_[1]) by_rate = slope(1);
  }
  bool depends_on_rate() const override { return uses_[1]; }

  numerics::Formula formula_;   // of s, rate and t
  std::array<bool, 2> uses_{};  // s, rate
  bool is_constant_ = false;
  double constant_ = 0.0;
};

template <class Coordinate>
class LockJoint final : public Joint {
  static constexpr int k = Coordinate::tangent_size;

 public:
  LockJoint(std::string name, const Coordinate& s, double at, int lock)
      : Joint(std::move(name)), s_(s), at_(at), lock_(lock) {
    places_ = s.places();
    row_names_ = {s.is_angle() ? "lock_moment" : "lock_force"};
  }
  std::unique_ptr<Joint> clone() const override { return std::make_unique<LockJoint>(*this); }

  void constraint(const Motion& motion, double* g, double* jacobian) const override {
    std::fill(jacobian, jacobian + k, 0.0);
    g[0] = 0.0;
    if (!is_active(motion)) return;
    g[0] = s_.value(motion.q) - at_;
    s_.slope(motion.q, jacobian);
  }
  void curvature(const Motion& motion, const double* multiplier, double* curvature) const override {
    s_.curvature(motion.q, is_active(motion) ? multiplier[0] : 0.0, curvature);
  }
  void second_rate(const Motion& motion, double* out) const override {
    double h[k * k];
    s_.curvature(motion.q, is_active(motion) ? 1.0 : 0.0, h);
    out[0] = 0.0;
    for (int i = 0; i < k; ++i)
      for (int j = 0; j < k; ++j)
        out[0] += motion.v[places_[std::size_t(i)]] * h[i * k + j] * motion.v[places_[std::size_t(j)]];
  }
  bool is_active(const Motion& motion) const override { return motion.phase[lock_] != 0; }
  bool has_symmetric_curvature() const override { return Coordinate::has_symmetric_curvature; }

 private:
  Coordinate s_;
  double at_;
  int lock_;
};

}  // namespace rubato::model
