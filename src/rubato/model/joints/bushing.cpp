#include <rubato/model/joints/bushing.hpp>
#include <rubato/numerics/rotations.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <limits>
#include <utility>

namespace rubato::model {
namespace {

using numerics::inverse_tangent_of;
using numerics::Matrix3;
using numerics::skew;
using numerics::slope_of_transposed_inverse_tangent;
using numerics::Vector3;
using Matrix36 = Eigen::Matrix<double, 3, 6>;

/// A RelativeTurn at a moment. By the increments w1, w2 of both nodes about their own axes
///
///   d theta = J delta,   delta = A2^T w2 - Q^T A1^T w1,   Q = exp(theta),   J = inverse_tangent_of(theta)
struct Turned {
  Vector3 theta, rate, spin;  // spin: delta of the velocities
  Matrix3 relative, inverse;  // Q, J
  Matrix36 delta;
  Vector3 spin1;  // of the first, in its frame turned back: Q^T A1^T w1

  Turned(const RelativeTurn& turn, const Motion& motion) {
    const Matrix3 one = turn.first.rotation(motion.q).toRotationMatrix() * turn.axes1;
    const Matrix3 two = turn.second.rotation(motion.q).toRotationMatrix() * turn.axes2;
    relative = one.transpose() * two;
    theta = numerics::vector_of(numerics::Rotation(relative));
    inverse = inverse_tangent_of(theta);
    delta << -relative.transpose() * turn.axes1.transpose(), turn.axes2.transpose();
    if (!motion.v) return;
    Eigen::Matrix<double, 6, 1> v;
    for (std::size_t i = 0; i < 3; ++i) {
      v[static_cast<Index>(i)] = motion.v[turn.first.place[3 + i]];
      v[static_cast<Index>(i) + 3] = motion.v[turn.second.place[3 + i]];
    }
    spin = delta * v;
    spin1 = -delta.leftCols<3>() * v.head<3>();
    rate = inverse * spin;
  }
};

class TurnMoment : public Element {
 public:
  TurnMoment(std::string name, const RelativeTurn& turn, const Vector3& factor)
      : Element(std::move(name)), turn_(turn), factor_(factor) {
    places_ = turn.places();
  }
  std::string domain() const override { return ", whose parts have turned by more than 3 rad against each other,"; }
  bool has_symmetric_tangent() const override { return false; }

  void force(const Motion& motion, double* force) const override {
    const Turned now(turn_, motion);
    write(now, now.inverse.transpose() * moment(now), force);
  }

  void tangent(const Motion& motion, double stiffness, double damping, double* force, double* tangent) const override {
    const Turned now(turn_, motion);
    const Vector3 m = moment(now), p = now.inverse.transpose() * m;
    write(now, p, force);
    const Matrix36 by_q = now.inverse * now.delta;  // of theta; of theta' by v the same
    const Matrix36 change = stiffness * slope_of_transposed_inverse_tangent(now.theta, m) * by_q +
                            now.inverse.transpose() * moment_slope(now, by_q, stiffness, damping);
    Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> out(tangent);
    out.topRows<3>() = -turn_.axes1 * now.relative * (change - stiffness * skew(p) * now.delta);
    out.bottomRows<3>() = turn_.axes2 * change;
  }

 protected:
  virtual Vector3 moment(const Turned& now) const = 0;
  virtual Matrix36 moment_slope(const Turned& now, const Matrix36& by_q, double stiffness, double damping) const = 0;

  RelativeTurn turn_;
  Vector3 factor_;

 private:
  void write(const Turned& now, const Vector3& p, double* force) const {
    Eigen::Map<Eigen::Matrix<double, 6, 1>> out(force);
    out << -turn_.axes1 * (now.relative * p), turn_.axes2 * p;
    constexpr double most = 3.0;  // the rotation vector jumps at pi
    if (!(now.theta.norm() <= most)) out.setConstant(std::numeric_limits<double>::quiet_NaN());
  }
};

class TurnSpring final : public TurnMoment {
 public:
  using TurnMoment::TurnMoment;
  std::unique_ptr<Element> clone() const override { return std::make_unique<TurnSpring>(*this); }
  double stored_energy(const Motion& motion) const override {
    const Vector3 theta = turn_.value(motion.q);
    return 0.5 * theta.dot(factor_.cwiseProduct(theta));
  }

 private:
  Vector3 moment(const Turned& now) const override { return factor_.cwiseProduct(now.theta); }
  Matrix36 moment_slope(const Turned&, const Matrix36& by_q, double stiffness, double) const override {
    return stiffness * factor_.asDiagonal() * by_q;
  }
};

class TurnDamper final : public TurnMoment {
 public:
  using TurnMoment::TurnMoment;
  std::unique_ptr<Element> clone() const override { return std::make_unique<TurnDamper>(*this); }
  Role role() const override { return Role::damper; }

 private:
  Vector3 moment(const Turned& now) const override { return factor_.cwiseProduct(now.rate); }
  /// d(J spin)/dtheta: J(theta) is the transpose of J(-theta). The spin changes as the first frame seems to turn back.
  Matrix36 moment_slope(const Turned& now, const Matrix36& by_q, double stiffness, double damping) const override {
    const Matrix36 of_rate =
        -slope_of_transposed_inverse_tangent(-now.theta, now.spin) * by_q - now.inverse * skew(now.spin1) * now.delta;
    return factor_.asDiagonal() * (stiffness * of_rate + damping * by_q);
  }
};

}  // namespace

std::vector<Index> RelativeTurn::places() const {
  std::vector<Index> all(first.place.begin() + 3, first.place.end());
  all.insert(all.end(), second.place.begin() + 3, second.place.end());
  return all;
}

Vector3 RelativeTurn::value(const double* q) const {
  Motion motion;
  motion.q = q;
  return Turned(*this, motion).theta;
}

Vector3 RelativeTurn::rate(const Motion& motion) const { return Turned(*this, motion).rate; }

void Bushing::forces(const Motion& motion, double* values) const {
  for (std::size_t i = 0; i < s.size(); ++i)
    values[i] = -stiffness[i] * s[i].value(motion.q) - damping[i] * s[i].rate(motion);
  for (const RelativeTurn& of : turn) {
    const Turned now(of, motion);
    Vector3 moment;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto axis = static_cast<Index>(i);
      moment[axis] = -stiffness[3 + i] * now.theta[axis] - damping[3 + i] * now.rate[axis];
    }
    // p is in the axes of the second, of which those of the first are turned back by theta.
    const Vector3 applied = now.relative * (now.inverse.transpose() * moment);
    for (std::size_t i = 0; i < 3; ++i) values[3 + i] = applied[static_cast<Index>(i)];
  }
}

std::unique_ptr<Element> make_turn_spring(std::string name, const RelativeTurn& turn, const Vector3& stiffness) {
  return std::make_unique<TurnSpring>(std::move(name), turn, stiffness);
}

std::unique_ptr<Element> make_turn_damper(std::string name, const RelativeTurn& turn, const Vector3& damping) {
  return std::make_unique<TurnDamper>(std::move(name), turn, damping);
}

}  // namespace rubato::model
