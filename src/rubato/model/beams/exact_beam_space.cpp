#include <rubato/model/beams/beam_forces.hpp>
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

/// How a beam is strained, and by what forces of its section the nodes are moved.
class SpaceBeamElement : public Element, public BeamForces {
 public:
  SpaceBeamElement(std::string name, const SpaceNode& first, const SpaceNode& second, const double* q,
                   const Matrix3& axes1, const Matrix3& axes2, const SpaceBeamSection& section)
      : Element(std::move(name)), section_(section), first_(first), second_(second) {
    places_.assign(first.place.begin(), first.place.end());
    places_.insert(places_.end(), second.place.begin(), second.place.end());
    section1_ = first.rotation(q).conjugate() * Rotation(axes1);
    section2_ = second.rotation(q).conjugate() * Rotation(axes2);
    length_ = (second.position(q) - first.position(q)).norm();
    const State now = at(q);
    strain0_ = now.strain;
    turn0_ = now.turn;
  }
  bool has_symmetric_tangent() const override { return false; }

 protected:
  struct State {
    Vector3 turn;    // psi
    Matrix3 mean;    // R
    Vector3 strain;  // Gamma
  };
  /// Derivatives by the increments of both nodes.
  struct Slopes {
    Rows strain, turn, mean;  // of Gamma, of psi, and the increment of R in its own axes
  };
  /// Force n and moment m of the section, in its axes.
  struct Stress {
    Vector3 n, m;
  };

  State at(const double* q) const {
    const Rotation one = first_.rotation(q) * section1_, two = second_.rotation(q) * section2_;
    State now;
    now.turn = numerics::vector_of(one.conjugate() * two);
    now.mean = (one * numerics::rotation_of(0.5 * now.turn)).toRotationMatrix();
    now.strain = now.mean.transpose() * (second_.position(q) - first_.position(q)) / length_;
    return now;
  }

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

  Local forces(const Stress& stress, const Slopes& slopes) const {
    return length_ * slopes.strain.transpose() * stress.n + slopes.turn.transpose() * stress.m;
  }
  static void write(const Stress& stress, double* forces) {
    Eigen::Map<Vector3> n(forces), m(forces + 3);
    n = stress.n;
    m = stress.m;
  }
  Tangent material_tangent(const Rows& strain, const Rows& turn, const Slopes& slopes) const {
    return length_ * slopes.strain.transpose() * section_.force.asDiagonal() * strain +
           slopes.turn.transpose() * (section_.moment / length_).asDiagonal() * turn;
  }

  /// What the forces n and m change by because their directions and levers do.
  void add_geometric(const State& now, const Slopes& slopes, const Stress& stress, Tangent& sum) const {
    const auto& [n, m] = stress;
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

  SpaceBeamSection section_;
  Rotation section1_, section2_;  // of the sections in the axes of their nodes
  double length_ = 0.0;
  Vector3 strain0_, turn0_;

 private:
  SpaceNode first_, second_;
};

class ExactBeamSpace final : public SpaceBeamElement {
 public:
  using SpaceBeamElement::SpaceBeamElement;
  std::unique_ptr<Element> clone() const override { return std::make_unique<ExactBeamSpace>(*this); }

  void force(const Motion& motion, double* force) const override {
    const State now = at(motion.q);
    Eigen::Map<Local>(force, k) = forces(stress(now), slopes_at(now));
  }

  void tangent(const Motion& motion, double stiffness, double, double* force, double* tangent) const override {
    const State now = at(motion.q);
    const Slopes slopes = slopes_at(now);
    const Stress elastic = stress(now);
    Eigen::Map<Local>(force, k) = forces(elastic, slopes);
    Tangent sum = material_tangent(slopes.strain, slopes.turn, slopes);
    add_geometric(now, slopes, elastic, sum);
    Eigen::Map<Tangent>(tangent, k, k) = stiffness * sum;
  }

  double stored_energy(const Motion& motion) const override {
    const State now = at(motion.q);
    const Vector3 strain = now.strain - strain0_, curvature = (now.turn - turn0_) / length_;
    return 0.5 * length_ *
           (strain.dot(section_.force.cwiseProduct(strain)) + curvature.dot(section_.moment.cwiseProduct(curvature)));
  }

  void section_forces(const Motion& motion, double* forces) const override { write(stress(at(motion.q)), forces); }

 private:
  Stress stress(const State& now) const {
    return {section_.force.cwiseProduct(now.strain - strain0_),
            section_.moment.cwiseProduct(now.turn - turn0_) / length_};
  }
};

/// The section holds its stiffnesses times the retardation time.
class ViscousBeamSpace final : public SpaceBeamElement {
 public:
  using SpaceBeamElement::SpaceBeamElement;
  std::unique_ptr<Element> clone() const override { return std::make_unique<ViscousBeamSpace>(*this); }
  Role role() const override { return Role::damper; }

  void force(const Motion& motion, double* force) const override {
    const Slopes slopes = slopes_at(at(motion.q));
    Eigen::Map<Local>(force, k) = forces(stress(slopes, velocities(motion)), slopes);
  }

  void tangent(const Motion& motion, double stiffness, double damping, double* force, double* tangent) const override {
    const State now = at(motion.q);
    const Slopes slopes = slopes_at(now);
    const Local v = velocities(motion);
    const Stress viscous = stress(slopes, v);
    Eigen::Map<Local>(force, k) = forces(viscous, slopes);
    Tangent geometric = material_tangent(strain_rate_slope(now, slopes, v), turn_rate_slope(now, slopes, v), slopes);
    add_geometric(now, slopes, viscous, geometric);
    Eigen::Map<Tangent>(tangent, k, k) =
        stiffness * geometric + damping * material_tangent(slopes.strain, slopes.turn, slopes);
  }

  void section_forces(const Motion& motion, double* forces) const override {
    write(stress(slopes_at(at(motion.q)), velocities(motion)), forces);
  }

 private:
  Local velocities(const Motion& motion) const {
    Local v;
    for (std::size_t i = 0; i < k; ++i) v[static_cast<Index>(i)] = motion.v[places_[i]];
    return v;
  }
  Stress stress(const Slopes& slopes, const Local& v) const {
    return {section_.force.cwiseProduct(slopes.strain * v), section_.moment.cwiseProduct(slopes.turn * v) / length_};
  }

  /// d(Gamma')/dq with Gamma' = Gamma x w + R^T (x2' - x1')/L, where w = A1 w1 + A2 w2 is the rate of R in its own
  /// axes.
  Rows strain_rate_slope(const State& now, const Slopes& slopes, const Local& v) const {
    const Vector3 difference = section2_.conjugate() * v.segment<3>(r2) - section1_.conjugate() * v.segment<3>(r1);
    const auto [share, slope] = quarter_tangent(now.turn.norm());
    const Rows rate_slope =
        (slope * now.turn.cross(difference) * now.turn.transpose() - share * skew(difference)) * slopes.turn;
    const Vector3 across = now.mean.transpose() * (v.segment<3>(x2) - v.segment<3>(x1)) / length_;
    return -skew(slopes.mean * v) * slopes.strain + skew(now.strain) * rate_slope + skew(across) * slopes.mean;
  }
  /// d(psi')/dq with psi' = inverse w2 - inverse^T w1.
  Rows turn_rate_slope(const State& now, const Slopes& slopes, const Local& v) const {
    const Vector3 one = section1_.conjugate() * v.segment<3>(r1), two = section2_.conjugate() * v.segment<3>(r2);
    return -(numerics::slope_of_transposed_inverse_tangent(now.turn, one) +
             numerics::slope_of_transposed_inverse_tangent(-now.turn, two)) *
           slopes.turn;
  }
};

}  // namespace

std::unique_ptr<Element> make_exact_beam_space(std::string name, const SpaceNode& first, const SpaceNode& second,
                                               const double* q, const Matrix3& axes1, const Matrix3& axes2,
                                               const SpaceBeamSection& section) {
  return std::make_unique<ExactBeamSpace>(std::move(name), first, second, q, axes1, axes2, section);
}

std::unique_ptr<Element> make_viscous_beam_space(std::string name, const SpaceNode& first, const SpaceNode& second,
                                                 const double* q, const Matrix3& axes1, const Matrix3& axes2,
                                                 const SpaceBeamSection& section, double retardation_time) {
  return std::make_unique<ViscousBeamSpace>(
      std::move(name), first, second, q, axes1, axes2,
      SpaceBeamSection{section.force * retardation_time, section.moment * retardation_time});
}

}  // namespace rubato::model
