#include <rubato/model/beams/exact_beam_space.hpp>

#include <cmath>
#include <utility>

namespace rubato::model {
namespace {

using numerics::Matrix3;
using numerics::Rotation;
using numerics::skew;
using numerics::Vector3;

constexpr int k = 12;
using Rows = Eigen::Matrix<double, 3, k>;
using Local = Eigen::Matrix<double, k, 1>;
using Tangent = Eigen::Matrix<double, k, k, Eigen::RowMajor>;

// Where the increments of the two nodes begin.
constexpr int x1 = 0, r1 = 3, x2 = 6, r2 = 9;

/// tan(a/4)/(2 a) and its derivative over a.
struct QuarterTangent {
  double share, slope;
};
QuarterTangent quarter_tangent(double a) {
  const double s = a * a;
  if (a < 0.05)  // tan x = x + x^3/3 + 2 x^5/15 + 17 x^7/315 with x = a/4
    return {0.125 + s * (1.0 / 384 + s * (1.0 / 15360 + s * 17.0 / 10321920)),
            1.0 / 192 + s * (1.0 / 3840 + s * 17.0 / 1720320)};
  const double tangent = std::tan(0.25 * a), share = 0.5 * tangent / a;
  return {share, (0.125 * (1.0 + tangent * tangent) - share) / s};
}

class ExactBeamSpace final : public Element {
 public:
  ExactBeamSpace(std::string name, const SpaceNode& first, const SpaceNode& second, const double* q,
                 const Matrix3& axes1, const Matrix3& axes2, const SpaceBeamSection& section)
      : Element(std::move(name)), first_(first), second_(second), section_(section) {
    places_.assign(first.place.begin(), first.place.end());
    places_.insert(places_.end(), second.place.begin(), second.place.end());
    section1_ = first.rotation(q).conjugate() * Rotation(axes1);
    section2_ = second.rotation(q).conjugate() * Rotation(axes2);
    length_ = (second.position(q) - first.position(q)).norm();
    const State now = at(q);
    strain0_ = now.strain;
    turn0_ = now.turn;
  }
  std::unique_ptr<Element> clone() const override { return std::make_unique<ExactBeamSpace>(*this); }

  void force(const Motion& motion, double* force) const override {
    const State now = at(motion.q);
    const Slopes slopes = slopes_at(now);
    Eigen::Map<Local> sum_of_forces(force);
    sum_of_forces = length_ * slopes.strain.transpose() * force_of(now) + slopes.turn.transpose() * moment_of(now);
  }

  void tangent(const Motion& motion, double stiffness, double damping, double* force, double* tangent) const override {
    (void)damping;
    const State now = at(motion.q);
    const Slopes slopes = slopes_at(now);
    const Vector3 n = force_of(now), m = moment_of(now);
    Eigen::Map<Local> sum_of_forces(force);
    sum_of_forces = length_ * slopes.strain.transpose() * n + slopes.turn.transpose() * m;
    Eigen::Map<Tangent> sum(tangent);
    sum = length_ * slopes.strain.transpose() * section_.force.asDiagonal() * slopes.strain +
          slopes.turn.transpose() * (section_.moment / length_).asDiagonal() * slopes.turn;
    add_geometric(now, slopes, n, m, sum);
    sum *= stiffness;
  }
  bool has_symmetric_tangent() const override { return false; }

  double stored_energy(const Motion& motion) const override {
    const State now = at(motion.q);
    const Vector3 strain = now.strain - strain0_, curvature = (now.turn - turn0_) / length_;
    return 0.5 * length_ *
           (strain.dot(section_.force.cwiseProduct(strain)) + curvature.dot(section_.moment.cwiseProduct(curvature)));
  }

 private:
  struct State {
    Vector3 turn;    // psi
    Matrix3 mean;    // R
    Vector3 strain;  // Gamma
  };
  /// Derivatives by the increments of both nodes.
  struct Slopes {
    Rows strain, turn, mean;  // of Gamma, of psi, and the increment of R in its own axes
  };

  State at(const double* q) const {
    const Rotation one = first_.rotation(q) * section1_, two = second_.rotation(q) * section2_;
    State now;
    now.turn = numerics::vector_of(one.conjugate() * two);
    now.mean = (one * numerics::rotation_of(0.5 * now.turn)).toRotationMatrix();
    now.strain = now.mean.transpose() * (second_.position(q) - first_.position(q)) / length_;
    return now;
  }
  Vector3 force_of(const State& now) const { return section_.force.cwiseProduct(now.strain - strain0_); }
  Vector3 moment_of(const State& now) const { return section_.moment.cwiseProduct(now.turn - turn0_) / length_; }

  Slopes slopes_at(const State& now) const {
    const Matrix3 to1 = section1_.conjugate().toRotationMatrix(), to2 = section2_.conjugate().toRotationMatrix();
    const Matrix3 inverse = numerics::inverse_tangent_of(now.turn);
    const Matrix3 share = quarter_tangent(now.turn.norm()).share * skew(now.turn);
    Slopes slopes;
    slopes.turn << Matrix3::Zero(), -inverse.transpose() * to1, Matrix3::Zero(), inverse * to2;
    slopes.mean << Matrix3::Zero(), (0.5 * Matrix3::Identity() - share) * to1, Matrix3::Zero(),
        (0.5 * Matrix3::Identity() + share) * to2;
    slopes.strain = skew(now.strain) * slopes.mean;
    slopes.strain.block<3, 3>(0, x1) -= now.mean.transpose() / length_;
    slopes.strain.block<3, 3>(0, x2) += now.mean.transpose() / length_;
    return slopes;
  }

  /// What the forces n and m change by because their directions and levers do.
  void add_geometric(const State& now, const Slopes& slopes, const Vector3& n, const Vector3& m,
                     Eigen::Map<Tangent>& sum) const {
    // Forces on positions: -+ R n.
    const Rows turned = -now.mean * skew(n) * slopes.mean;
    sum.middleRows<3>(x1) -= turned;
    sum.middleRows<3>(x2) += turned;
    // Moments by n: A^T w with w = L n x Gamma, whose change by n is in the material part.
    const Vector3 w = length_ * n.cross(now.strain);
    const Rows lever = length_ * skew(n) * slopes.strain;
    const auto [share, slope] = quarter_tangent(now.turn.norm());
    // A2^T w = w/2 - share psi x w,  A1^T w = w/2 + share psi x w
    const Matrix3 bend = slope * now.turn.cross(w) * now.turn.transpose() - share * skew(w);
    const Rows half = 0.5 * lever, other = share * skew(now.turn) * lever + bend * slopes.turn;
    // Moments by m: inverse^T m on the second end, -inverse m on the first, which is the former at -psi.
    const Rows second = numerics::slope_of_transposed_inverse_tangent(now.turn, m) * slopes.turn;
    const Rows first = numerics::slope_of_transposed_inverse_tangent(-now.turn, m) * slopes.turn;
    sum.middleRows<3>(r1) += section1_.toRotationMatrix() * (half + other + first);
    sum.middleRows<3>(r2) += section2_.toRotationMatrix() * (half - other + second);
  }

  SpaceNode first_, second_;
  SpaceBeamSection section_;
  Rotation section1_, section2_;  // of the sections in the axes of their nodes
  double length_ = 0.0;
  Vector3 strain0_, turn0_;
};

}  // namespace

std::unique_ptr<Element> make_exact_beam_space(std::string name, const SpaceNode& first, const SpaceNode& second,
                                               const double* q, const Matrix3& axes1, const Matrix3& axes2,
                                               const SpaceBeamSection& section) {
  return std::make_unique<ExactBeamSpace>(std::move(name), first, second, q, axes1, axes2, section);
}

}  // namespace rubato::model
