#include <rubato/model/joints/space_joints.hpp>
#include <rubato/model/joints/space_slopes.hpp>

#include <cmath>
#include <numbers>
#include <utility>

namespace rubato::model {
namespace {

using numerics::Matrix3;
using numerics::Vector3;

constexpr int k = 12;

/// Couples the turns of a screw to its displacement: value of `along` minus lead/(2 pi) times the angle.
struct Thread {
  std::size_t along;  // row
  TurnAngle angle;
  double lead;
  double lead_a_radian() const { return lead / (2.0 * std::numbers::pi); }
};

class SpaceJoint final : public Joint {
 public:
  SpaceJoint(std::string name, const SpacePoint& first, const SpacePoint& second)
      : Joint(std::move(name)), first_(first), second_(second) {
    places_.assign(first.node.place.begin(), first.node.place.end());
    places_.insert(places_.end(), second.node.place.begin(), second.node.place.end());
  }
  std::unique_ptr<Joint> clone() const override { return std::make_unique<SpaceJoint>(*this); }

  void add(const char* row_name, const SpaceRow& row) {
    row_names_.emplace_back(row_name);
    rows_.push_back(row);
  }
  void add_thread(const Vector3& along, const TurnAngle& angle, double lead) {
    add("thread", BodyGap{along});
    threads_.push_back({rows_.size() - 1, angle, lead});
  }

  void constraint(const Motion& motion, double* g, double* jacobian) const override {
    write(pair_of(motion.q, first_, second_), g, jacobian);
  }
  void curvature(const Motion& motion, const double* multiplier, double* curvature) const override {
    bend(pair_of(motion.q, first_, second_), multiplier, curvature);
  }
  void linearise(const Motion& motion, const double* multiplier, double* g, double* jacobian,
                 double* curvature) const override {
    const SpacePair pair = pair_of(motion.q, first_, second_);
    write(pair, g, jacobian);
    bend(pair, multiplier, curvature);
  }
  void second_rate(const Motion& motion, double* out) const override {
    const SpacePair pair = pair_of(motion.q, first_, second_);
    Vector12 v;
    for (int i = 0; i < k; ++i) v[i] = motion.v[places_[static_cast<std::size_t>(i)]];
    double slope[k * k];
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      SlopeSum sum(slope);
      sum.setZero();
      add_row_slope(i, pair, 1.0, sum);
      out[i] = v.dot(sum * v);
    }
  }
  bool has_symmetric_curvature() const override { return false; }
  JointPattern pattern() const override {
    JointPattern pattern{std::vector<char>(rows_.size() * k, 0), std::vector<char>(k * k, 0)};
    const auto add = [&](std::size_t row, const SpacePattern& of_row) {
      for (std::size_t i = 0; i < k; ++i) {
        if (of_row.gradient[i]) pattern.jacobian[row * k + i] = 1;
        for (std::size_t j = 0; j < k; ++j)
          if (of_row.slope[i][j]) pattern.curvature[i * k + j] = 1;
      }
    };
    for (std::size_t i = 0; i < rows_.size(); ++i) add(i, pattern_of(rows_[i], first_, second_));
    for (const Thread& thread : threads_) add(thread.along, pattern_of(thread.angle, first_, second_));
    return pattern;
  }

 private:
  void write(const SpacePair& pair, double* g, double* jacobian) const {
    SpaceValue value;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      evaluate(rows_[i], pair, value, SpaceDetail::gradient);
      for (const Thread& thread : threads_)
        if (thread.along == i) subtract_turns(thread, pair, value);
      g[i] = value.value;
      Eigen::Map<Vector12>(jacobian + i * k) = value.gradient;
    }
  }
  void bend(const SpacePair& pair, const double* multiplier, double* curvature) const {
    SlopeSum sum(curvature);
    sum.setZero();
    Vector3 along = Vector3::Zero();  // gaps in the world are one: they are linear in their direction
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      if (const auto* gap = std::get_if<WorldGap>(&rows_[i]))
        along += multiplier[i] * gap->along;
      else
        add_row_slope(i, pair, multiplier[i], sum);
    }
    if (!along.isZero(0.0)) add_slope(WorldGap{along}, pair, 1.0, sum);
  }

  void add_row_slope(std::size_t i, const SpacePair& pair, double weight, SlopeSum& sum) const {
    add_slope(rows_[i], pair, weight, sum);
    for (const Thread& thread : threads_)
      if (thread.along == i) add_slope(thread.angle, pair, -weight * thread.lead_a_radian(), sum);
  }
  /// The angle is known up to whole turns, which the displacement tells.
  static void subtract_turns(const Thread& thread, const SpacePair& pair, SpaceValue& value) {
    SpaceValue angle;
    evaluate(thread.angle, pair, angle, SpaceDetail::gradient);
    const double turn = 2.0 * std::numbers::pi, lead = thread.lead_a_radian();
    const double turns = std::round((value.value / lead - angle.value) / turn);
    value.value -= lead * (angle.value + turn * turns);
    value.gradient -= lead * angle.gradient;
  }

  SpacePoint first_, second_;
  std::vector<SpaceRow> rows_;
  std::vector<Thread> threads_;
};

void add_point(SpaceJoint& joint) {
  joint.add("x", WorldGap{Vector3::UnitX()});
  joint.add("y", WorldGap{Vector3::UnitY()});
  joint.add("z", WorldGap{Vector3::UnitZ()});
}

/// The second point stays on the third axis of the first frame.
void add_line(SpaceJoint& joint, const SpaceFrame& first) {
  joint.add("x", BodyGap{first.axes.col(0)});
  joint.add("y", BodyGap{first.axes.col(1)});
}

void add_parallel_axes(SpaceJoint& joint, const SpaceFrame& first, const SpaceFrame& second) {
  joint.add("moment_x", Alignment{first.axes.col(1), second.axes.col(2)});
  joint.add("moment_y", Alignment{first.axes.col(0), second.axes.col(2)});
}

void add_no_turn(SpaceJoint& joint, const SpaceFrame& first, const SpaceFrame& second) {
  add_parallel_axes(joint, first, second);
  joint.add("moment_z", Alignment{first.axes.col(0), second.axes.col(1)});
}

}  // namespace

SpaceFrame frame_at(const SpaceNode& node, const double* q, const Vector3& at, const Vector3& axis) {
  const Vector3 z = axis.normalized();
  // The axis of the world that is farthest from z gives the first direction.
  Index farthest = 0;
  z.cwiseAbs().minCoeff(&farthest);
  const Vector3 x = (Vector3::Unit(farthest) - z[farthest] * z).normalized();
  Matrix3 axes;
  axes << x, z.cross(x), z;
  const Matrix3 back = node.rotation(q).toRotationMatrix().transpose();
  return {{node, back * (at - node.position(q))}, back * axes};
}

TurnAngle turn_of(const SpaceFrame& first, const SpaceFrame& second) {
  const Vector3 start = second.axes.col(0);
  return {{first.axes.col(0), start}, {first.axes.col(1), start}};
}

std::array<TurnAngle, 2> turns_of_cross(const SpaceFrame& first, const SpaceFrame& second) {
  const Vector3 pin1 = first.axes.col(0), pin2 = second.axes.col(1);
  const TurnAngle of_cross{{first.axes.col(1), pin2}, {first.axes.col(2), pin2}};
  const TurnAngle on_cross{{pin1, second.axes.col(0)}, {pin1, second.axes.col(2)}};
  return {of_cross, on_cross};
}

std::unique_ptr<Joint> make_space_joint(SpaceJointKind kind, std::string name, const SpaceFrame& first,
                                        const SpaceFrame& second) {
  auto joint = std::make_unique<SpaceJoint>(std::move(name), first.point, second.point);
  switch (kind) {
    case SpaceJointKind::rigid:
      add_point(*joint);
      add_no_turn(*joint, first, second);
      break;
    case SpaceJointKind::revolute:
      add_point(*joint);
      add_parallel_axes(*joint, first, second);
      break;
    case SpaceJointKind::prismatic:
      add_line(*joint, first);
      add_no_turn(*joint, first, second);
      break;
    case SpaceJointKind::cylindrical:
      add_line(*joint, first);
      add_parallel_axes(*joint, first, second);
      break;
    case SpaceJointKind::spherical:
      add_point(*joint);
      break;
    case SpaceJointKind::universal:
      add_point(*joint);
      joint->add("moment_z", Alignment{first.axes.col(0), second.axes.col(1)});
      break;
    case SpaceJointKind::planar:
      joint->add("z", BodyGap{first.axes.col(2)});
      add_parallel_axes(*joint, first, second);
      break;
  }
  return joint;
}

std::unique_ptr<Joint> make_space_screw(std::string name, const SpaceFrame& first, const SpaceFrame& second,
                                        double lead) {
  auto joint = std::make_unique<SpaceJoint>(std::move(name), first.point, second.point);
  add_line(*joint, first);
  add_parallel_axes(*joint, first, second);
  joint->add_thread(first.axes.col(2), turn_of(first, second), lead);
  return joint;
}

std::unique_ptr<Joint> make_space_distance(std::string name, const SpacePoint& first, const SpacePoint& second,
                                           double length) {
  auto joint = std::make_unique<SpaceJoint>(std::move(name), first, second);
  joint->add("tension", DistanceGap{length});
  return joint;
}

}  // namespace rubato::model
