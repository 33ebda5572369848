#include <rubato/model/joints/plane_joints.hpp>
#include <rubato/model/joints/plane_length.hpp>
#include <rubato/model/joints/plane_projection.hpp>

#include <algorithm>
#include <cassert>
#include <utility>

namespace rubato::model {
namespace {

constexpr int k = 6;  // x, y, angle of either node

class PlaneJoint : public Joint {
 public:
  PlaneJoint(std::string name, const PlanePoint& first, const PlanePoint& second)
      : Joint(std::move(name)), first_(first), second_(second) {
    places_.assign(first.node.place.begin(), first.node.place.end());
    places_.insert(places_.end(), second.node.place.begin(), second.node.place.end());
  }

 protected:
  double angle_between(const double* q) const { return q[second_.node.q + 2] - q[first_.node.q + 2]; }
  double speed(const Motion& motion, int local) const { return motion.v[places_[static_cast<std::size_t>(local)]]; }

  /// v^T H v
  double along_velocity(const Motion& motion, const double* h) const {
    double sum = 0.0;
    for (int i = 0; i < k; ++i)
      for (int j = 0; j < k; ++j) sum += speed(motion, i) * h[i * k + j] * speed(motion, j);
    return sum;
  }

  PlanePoint first_, second_;
};

class Revolute : public PlaneJoint {
 public:
  Revolute(std::string name, const PlanePoint& first, const PlanePoint& second)
      : PlaneJoint(std::move(name), first, second) {
    row_names_ = {"x", "y"};
  }
  std::unique_ptr<Joint> clone() const override { return std::make_unique<Revolute>(*this); }

  void constraint(const Motion& motion, double* g, double* jacobian) const override {
    write(first_.at(motion.q), second_.at(motion.q), g, jacobian);
  }
  void curvature(const Motion& motion, const double* multiplier, double* curvature) const override {
    bend(first_.at(motion.q), second_.at(motion.q), multiplier, curvature);
  }
  void linearise(const Motion& motion, const double* multiplier, double* g, double* jacobian,
                 double* curvature) const override {
    const auto a = first_.at(motion.q), b = second_.at(motion.q);
    write(a, b, g, jacobian);
    bend(a, b, multiplier, curvature);
  }
  JointPattern pattern() const override {
    JointPattern pattern{{1, 0, 1, 1, 0, 1, 0, 1, 1, 0, 1, 1}, std::vector<char>(k * k, 0)};
    pattern.curvature[2 * k + 2] = pattern.curvature[5 * k + 5] = 1;
    return pattern;
  }
  void second_rate(const Motion& motion, double* out) const override {
    const auto a = first_.at(motion.q), b = second_.at(motion.q);
    const double w1 = speed(motion, 2), w2 = speed(motion, 5);
    out[0] = a.arm_x * w1 * w1 - b.arm_x * w2 * w2;
    out[1] = a.arm_y * w1 * w1 - b.arm_y * w2 * w2;
  }

 private:
  static void write(const PlanePoint::Now& a, const PlanePoint::Now& b, double* g, double* jacobian) {
    g[0] = b.x - a.x;
    g[1] = b.y - a.y;
    double* const x = jacobian;  // entry by entry: rows made elsewhere and copied wait for their parts to be stored
    double* const y = jacobian + k;
    x[0] = -1.0, x[1] = 0.0, x[2] = a.arm_y, x[3] = 1.0, x[4] = 0.0, x[5] = -b.arm_y;
    y[0] = 0.0, y[1] = -1.0, y[2] = -a.arm_x, y[3] = 0.0, y[4] = 1.0, y[5] = b.arm_x;
  }
  static void bend(const PlanePoint::Now& a, const PlanePoint::Now& b, const double* multiplier, double* curvature) {
    std::fill(curvature, curvature + k * k, 0.0);
    curvature[2 * k + 2] = a.arm_x * multiplier[0] + a.arm_y * multiplier[1];
    curvature[5 * k + 5] = -(b.arm_x * multiplier[0] + b.arm_y * multiplier[1]);
  }
};

class Rigid final : public Revolute {
 public:
  Rigid(std::string name, const PlanePoint& first, const PlanePoint& second, double angle)
      : Revolute(std::move(name), first, second), angle_(angle) {
    row_names_ = {"x", "y", "moment"};
  }
  std::unique_ptr<Joint> clone() const override { return std::make_unique<Rigid>(*this); }

  void constraint(const Motion& motion, double* g, double* jacobian) const override {
    Revolute::constraint(motion, g, jacobian);
    add_angle(motion, g, jacobian);
  }
  void linearise(const Motion& motion, const double* multiplier, double* g, double* jacobian,
                 double* curvature) const override {
    Revolute::linearise(motion, multiplier, g, jacobian, curvature);
    add_angle(motion, g, jacobian);
  }
  JointPattern pattern() const override {
    JointPattern pattern = Revolute::pattern();
    pattern.jacobian.insert(pattern.jacobian.end(), {0, 0, 1, 0, 0, 1});
    return pattern;
  }
  void second_rate(const Motion& motion, double* out) const override {
    Revolute::second_rate(motion, out);
    out[2] = 0.0;
  }

 private:
  void add_angle(const Motion& motion, double* g, double* jacobian) const {
    g[2] = angle_between(motion.q) - angle_;
    const double row[k] = {0.0, 0.0, -1.0, 0.0, 0.0, 1.0};
    std::copy(row, row + k, jacobian + 2 * k);
  }

  double angle_;
};

class Prismatic final : public PlaneJoint {
 public:
  Prismatic(std::string name, const PlanePoint& first, const PlanePoint& second, const std::array<double, 2>& axis,
            double angle, bool holds_angle)
      : PlaneJoint(std::move(name), first, second), across_{first, second, {-axis[1], axis[0]}}, angle_(angle) {
    row_names_ = holds_angle ? std::vector<std::string>{"normal", "moment"} : std::vector<std::string>{"normal"};
  }
  std::unique_ptr<Joint> clone() const override { return std::make_unique<Prismatic>(*this); }

  void constraint(const Motion& motion, double* g, double* jacobian) const override {
    const auto now = across_.at(motion.q);
    g[0] = now.value();
    PlaneProjection::slope(now, jacobian);
    if (rows() == 1) return;
    g[1] = angle_between(motion.q) - angle_;
    const double angle_row[k] = {0.0, 0.0, -1.0, 0.0, 0.0, 1.0};
    std::copy(angle_row, angle_row + k, jacobian + k);
  }
  void curvature(const Motion& motion, const double* multiplier, double* curvature) const override {
    PlaneProjection::curvature(across_.at(motion.q), multiplier[0], curvature);
  }
  void second_rate(const Motion& motion, double* out) const override {
    double h[k * k];
    PlaneProjection::curvature(across_.at(motion.q), 1.0, h);
    out[0] = along_velocity(motion, h);
    if (rows() > 1) out[1] = 0.0;
  }

 private:
  PlaneProjection across_;
  double angle_;
};

class Distance final : public PlaneJoint {
 public:
  Distance(std::string name, const PlanePoint& first, const PlanePoint& second, double length)
      : PlaneJoint(std::move(name), first, second), length_(length), inverse_(1.0 / length) {
    assert(length > 0.0);
    row_names_ = {"tension"};
  }
  std::unique_ptr<Joint> clone() const override { return std::make_unique<Distance>(*this); }

  void constraint(const Motion& motion, double* g, double* jacobian) const override {
    write({first_, second_, motion.q}, g, jacobian);
  }
  void curvature(const Motion& motion, const double* multiplier, double* curvature) const override {
    PlaneLength(first_, second_, motion.q).half_square_curvature(multiplier[0] * inverse_, curvature);
  }
  void linearise(const Motion& motion, const double* multiplier, double* g, double* jacobian,
                 double* curvature) const override {
    const PlaneLength now(first_, second_, motion.q);
    write(now, g, jacobian);
    now.half_square_curvature(multiplier[0] * inverse_, curvature);
  }
  void second_rate(const Motion& motion, double* out) const override {
    double h[k * k];
    PlaneLength(first_, second_, motion.q).half_square_curvature(inverse_, h);
    out[0] = along_velocity(motion, h);
  }

 private:
  void write(const PlaneLength& now, double* g, double* jacobian) const {
    const double dx = now.dx(), dy = now.dy();
    g[0] = 0.5 * (dx * dx * inverse_ + dy * dy * inverse_ - length_);
    now.half_square_slope(inverse_, jacobian);
  }

  double length_, inverse_;
};

}  // namespace

std::unique_ptr<Joint> make_plane_revolute(std::string name, const PlanePoint& first, const PlanePoint& second) {
  return std::make_unique<Revolute>(std::move(name), first, second);
}

std::unique_ptr<Joint> make_plane_rigid(std::string name, const PlanePoint& first, const PlanePoint& second,
                                        double angle) {
  return std::make_unique<Rigid>(std::move(name), first, second, angle);
}

std::unique_ptr<Joint> make_plane_prismatic(std::string name, const PlanePoint& first, const PlanePoint& second,
                                            const std::array<double, 2>& axis, double angle, bool holds_angle) {
  return std::make_unique<Prismatic>(std::move(name), first, second, axis, angle, holds_angle);
}

std::unique_ptr<Joint> make_plane_distance(std::string name, const PlanePoint& first, const PlanePoint& second,
                                           double length) {
  return std::make_unique<Distance>(std::move(name), first, second, length);
}

}  // namespace rubato::model
