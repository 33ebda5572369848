#include <rubato/integrate/estimators/damping_memory.hpp>

#include <rubato/integrate/adaptive_march.hpp>
#include <rubato/integrate/catalogue.hpp>

#include "support/free_vibration.hpp"
#include "support/models.hpp"
#include "support/random_model.hpp"

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include <cmath>
#include <complex>
#include <functional>
#include <numbers>

namespace rubato::integrate {
namespace {

/// The free motion of a structure whose damping does not couple its modes.
class DampedVibration {
 public:
  explicit DampedVibration(const system::LocallyNonlinear& system) {
    const Matrix mass(system.mass());
    const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> modes(Matrix(system.stiffness()), mass);
    shapes_ = modes.eigenvectors();
    stiffness_ = modes.eigenvalues();
    damping_ = (shapes_.transpose() * system.damping() * shapes_).diagonal();
    q_ = shapes_.transpose() * mass * system.start().q;
    v_ = shapes_.transpose() * mass * system.start().v;
  }

  /// The roots of s^2 + c s + k, the slow one without cancellation: x = ((v - s2 q) e^(s1 t) - (v - s1 q) e^(s2 t))/(s1
  /// - s2)
  Vector at(double t) const {
    Vector x(q_.size());
    for (Index i = 0; i < q_.size(); ++i) {
      const double c = damping_[i], k = stiffness_[i];
      const std::complex<double> fast = -0.5 * (c + std::sqrt(std::complex<double>(c * c - 4.0 * k))), slow = k / fast;
      x[i] =
          (((v_[i] - fast * q_[i]) * std::exp(slow * t) - (v_[i] - slow * q_[i]) * std::exp(fast * t)) / (slow - fast))
              .real();
    }
    return shapes_ * x;
  }

 private:
  Matrix shapes_;
  Vector stiffness_, damping_, q_, v_;
};

system::LocallyNonlinear damped(const Matrix& mass, const Matrix& damping, const Matrix& stiffness, const Vector& q,
                                const Vector& v) {
  const auto undamped = testing::released(mass, stiffness, q, v);
  system::LocallyNonlinear::Parts parts;
  parts.mass = undamped.mass();
  parts.damping = testing::sparse(damping);
  parts.stiffness = undamped.stiffness();
  parts.start = undamped.start();
  parts.coordinates = undamped.coordinates();
  return system::LocallyNonlinear(std::move(parts));
}

TEST(DampingMemory, OfAModeIsTheTimeInWhichItsErrorsAreForgotten) {
  Matrix mass = Matrix::Identity(4, 4), stiffness = Matrix::Zero(4, 4), damping = stiffness;
  stiffness.diagonal() << 100.0, 100.0, 100.0, 1.0;
  damping.diagonal() << 0.0, 0.2, 200.0, 0.0;  // none, one percent, ten times the critical one
  const auto system = damped(mass, damping, stiffness, Vector::Ones(4), Vector::Zero(4));
  constexpr double duration = 1e3;
  DampingMemory memory(system, duration);
  const auto time_of = [&](Index mode) { return std::sqrt(memory.squared(Vector::Unit(4, mode))); };
  EXPECT_NEAR(time_of(0), duration, 1e-9 * duration);
  EXPECT_NEAR(time_of(1), 10.0, 0.2);  // 2/c
  EXPECT_NEAR(time_of(2), 2.0, 0.02);  // c/k
  EXPECT_NEAR(time_of(3), duration, 1e-9 * duration);
  // What does not creep: a velocity of an overdamped mode is forgotten in 2/c.
  EXPECT_NEAR(std::sqrt(memory.decaying_squared(Vector::Unit(4, 2))), 0.01, 1e-4);
  // A motion of the first mode and a hundred times as much of the third is remembered by the first.
  EXPECT_NEAR(std::sqrt(memory.squared(Vector::Unit(4, 0) + 100.0 * Vector::Unit(4, 2))), duration, 0.03 * duration);
}

double error_over_tolerance(const system::LocallyNonlinear& system, const char* method, double tolerance, double end) {
  const DampedVibration truth(system);
  const std::function<Vector(double)> exact = [&](double t) { return truth.at(t); };
  testing::LargestError<std::function<Vector(double)>> errors(system, exact);
  const Method chosen = make_method(method);
  const auto stepper = make_stepper(chosen, system);
  const auto estimator =
      make_estimator(default_estimator(chosen, tolerance, system.stop_count() > 0), chosen, system, *stepper, end);
  StepPlan plan;
  plan.largest = end / 50.0;
  system::State state = consistent_start(system, system.start());
  EXPECT_EQ(march(*stepper, *estimator, plan, system, state, end, &errors).march.end, MarchEnd::reached);
  return errors.relative() / tolerance;
}

// A stiff mode of half the critical damping dies within a millisecond. Its share of the acceleration, which the method
// forgets slowly, made x^T C x as if all errors were forgotten as fast: 55, 62 and 169 steps, and errors of 1.06, 1.00
// and 0.27 of the response.
TEST(AutomaticSteps, SeeASlowResponseBesideAStiffModeThatIsDamped) {
  Matrix mass = Matrix::Zero(2, 2), stiffness = mass;
  mass.diagonal() << 1.0, 0.1;
  stiffness << 100.0 + 1e7, -1e7, -1e7, 1e7;
  const auto system = damped(mass, 1e-4 * stiffness, stiffness, Vector::Ones(2), Vector::Zero(2));
  for (const char* method : {"generalized_alpha", "hht", "average_acceleration", "wilson_theta"})
    for (const double tolerance : {1e-2, 1e-3, 1e-4})
      EXPECT_LT(error_over_tolerance(system, method, tolerance, 3.5), 10.0) << method << " at " << tolerance;
}

/// Unit masses on springs and dashpots of their own.
struct OwnModes {
  Vector omega, ratio, q, v;
  system::LocallyNonlinear system() const {
    const Matrix stiffness = omega.cwiseAbs2().asDiagonal();
    const Matrix damping = (2.0 * ratio.cwiseProduct(omega)).asDiagonal();
    return damped(Matrix::Identity(omega.size(), omega.size()), damping, stiffness, q, v);
  }
};

// A method of first order loses velocity in proportion to q'''. That of an overdamped mode, which dies within a second,
// is faster than that of the response by orders: the errors were divided by its frequency while the response made most
// of them, and were 13 and 14 tolerances (released), 6.5 and 11 (thrown) at 1e-3 and 1e-4.
TEST(AutomaticSteps, OfFirstOrderSeeASlowResponseBesideOneThatDies) {
  const OwnModes released{Vector{{0.2286, 0.63, 2.568}}, Vector{{0.2625, 0.7236, 2.95}},
                          Vector{{-2.956, -0.01666, -0.104}}, Vector::Zero(3)};
  const OwnModes thrown{Vector{{0.135, 0.8057}}, Vector{{0.02843, 14.04}}, Vector::Zero(2), Vector{{-3.928, -4.641}}};
  for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
    EXPECT_LT(error_over_tolerance(released.system(), "backward_difference", tolerance, 35.6), 8.0) << tolerance;
    EXPECT_LT(error_over_tolerance(thrown.system(), "backward_difference", tolerance, 31.3), 8.0) << tolerance;
  }
}

// Chains of two to ten masses, their springs over ten decades, damped by a share of the stiffness, of the mass, or mode
// by mode, from a thousandth to thirty times the critical damping, let go or thrown.
TEST(AutomaticSteps, MeetTheirToleranceOnModelsOfAnyDamping) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    testing::RandomNumbers random(seed);
    const Index n = 2 + random.below(9);
    Matrix mass = Matrix::Zero(n, n), stiffness = mass, damping = mass;
    const double ratio = random.decades(1.0, 1e10);
    for (Index i = 0; i < n; ++i) {
      mass(i, i) = random.decades(1.0, 1e2);
      const double k = random.decades(1.0, i == 0 ? 1e2 : ratio);
      stiffness(i, i) += k;
      if (i == 0) continue;
      stiffness(i - 1, i - 1) += k;
      stiffness(i, i - 1) = stiffness(i - 1, i) = -k;
    }
    const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> modes(stiffness, mass);
    const Vector omega = modes.eigenvalues().cwiseMax(0.0).cwiseSqrt();
    switch (random.below(3)) {
      case 0:
        damping = 2.0 * random.decades(1e-2, 30.0) / omega[n - 1] * stiffness;
        break;
      case 1:
        damping = 2.0 * random.decades(1e-2, 3.0) * omega[0] * mass;
        break;
      default: {
        Vector of_mode(n);
        for (Index i = 0; i < n; ++i) of_mode[i] = 2.0 * omega[i] * random.decades(1e-3, 30.0);
        const Matrix on_modes = mass * modes.eigenvectors();
        damping = on_modes * of_mode.asDiagonal() * on_modes.transpose();
      }
    }
    Vector q = Vector::Zero(n), v = q;
    if (random.chance(0.6)) q.setOnes();
    if (q.squaredNorm() == 0.0) v[n - 1] = 1.0;
    const auto system = damped(mass, damping, stiffness, q, v);
    const double end = 2.0 * std::numbers::pi / omega[0] * random.decades(0.5, 5.0);
    for (const double tolerance : {1e-2, 1e-3})
      EXPECT_LT(error_over_tolerance(system, "generalized_alpha", tolerance, end), 10.0) << seed << " at " << tolerance;
  }
}

}  // namespace
}  // namespace rubato::integrate
