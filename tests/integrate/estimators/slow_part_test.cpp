#include <rubato/integrate/adaptive_march.hpp>
#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/estimators/slow_part.hpp>

#include "support/free_vibration.hpp"
#include "support/models.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace rubato::integrate {
namespace {

// Backward Euler errs by about cut h/2 = 5e-4 in each pole.
TEST(SlowPart, LetsSlowMotionsPassAndHoldsFastOnesByTheThirdPower) {
  const double cut = 1.0;
  for (const double omega : {0.1, 1.0, 10.0}) {
    SlowPart part(1);
    const double h = 1e-3 / std::max(1.0, omega);
    double value = 0.0, rate = 0.0;
    const auto steps = static_cast<long>(40.0 / h);
    for (long i = 1; i <= steps; ++i) {
      const double phase = omega * static_cast<double>(i) * h;
      part.look(Vector::Constant(1, h * std::sin(phase)), h, cut);
      part.accept();
      if (static_cast<double>(i) * h < 20.0) continue;  // the start is forgotten
      value = std::max(value, std::abs(part.value()[0]));
      rate = std::max(rate, std::abs(part.rate()[0]));
    }
    const double gain = std::pow(1.0 + omega * omega, -1.5);
    EXPECT_NEAR(value / gain, 1.0, 0.01) << omega;
    EXPECT_NEAR(rate / (omega * gain), 1.0, 0.01) << omega;
  }
}

TEST(SlowPart, CountsAStartInFullAndLooksWithoutATrace) {
  SlowPart part(2);
  const Vector x = Vector::LinSpaced(2, 1.0, 2.0);
  part.look(0.1 * x, 0.1, 1e-3);
  EXPECT_TRUE(part.value().isApprox(x, 1e-15));
  part.accept();
  part.look(-5.0 * x, 0.1, 1.0);  // a try that is thrown away
  part.look(0.1 * x, 0.1, 1e-3);
  EXPECT_TRUE(part.value().isApprox(x, 1e-15));
  EXPECT_NEAR(part.rate().norm(), 0.0, 1e-15);
}

/// A slow oscillator of amplitude one beside a fast one.
system::LocallyNonlinear slow_and_fast(double frequency, double amplitude) {
  const Matrix mass = Matrix::Identity(2, 2);
  Matrix stiffness = mass;
  stiffness(1, 1) = frequency * frequency;
  Vector q(2);
  q << 1.0, amplitude;
  return testing::released(mass, stiffness, q, Vector::Zero(2));
}

struct Outcome {
  double error;
  long steps;
};

Outcome march_of(const system::LocallyNonlinear& system, double tolerance) {
  const testing::FreeVibration truth(system);
  const std::function<Vector(double)> exact = [&](double t) { return truth.at(t); };
  testing::LargestError<std::function<Vector(double)>> errors(system, exact);
  const Method method = make_method("generalized_alpha");
  const auto stepper = make_stepper(method, system);
  constexpr double end = 60.0;
  const auto estimator = make_estimator(LocalError{tolerance}, method, system, *stepper, end);
  system::State state = consistent_start(system, system.start());
  const AdaptiveReport report = march(*stepper, *estimator, {}, system, state, end, &errors);
  EXPECT_EQ(report.march.end, MarchEnd::reached);
  return {errors.relative(), report.march.steps};
}

// The phase error of a mode grows over the whole march, but it can make the error no larger than twice the amplitude.
// Following a mode of 1000 rad/s through 60 s would take 1000 times the steps of the slow one.
TEST(PhaseError, OfAFastModeBelowTheToleranceTakesNoSteps) {
  const double tolerance = 1e-3;
  const Outcome slow = march_of(slow_and_fast(1000.0, 0.0), tolerance),
                both = march_of(slow_and_fast(1000.0, 1e-5), tolerance);
  EXPECT_LT(both.steps, 1.5 * static_cast<double>(slow.steps));
  EXPECT_LT(both.error, tolerance);
}

TEST(PhaseError, OfAFastModeAboveTheToleranceIsFollowed) {
  const double tolerance = 1e-2;
  const Outcome both = march_of(slow_and_fast(50.0, 0.1), tolerance);
  EXPECT_LT(both.error, 10.0 * tolerance);
  EXPECT_GT(both.steps, 30 * march_of(slow_and_fast(50.0, 0.0), tolerance).steps);
}

}  // namespace
}  // namespace rubato::integrate
