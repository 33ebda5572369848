#include <rubato/integrate/estimators/load_scale.hpp>

#include <rubato/integrate/adaptive_march.hpp>
#include <rubato/integrate/catalogue.hpp>

#include "support/laws.hpp"
#include "support/models.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace rubato::integrate {
namespace {

constexpr double start = 25.0, end = 50.0;

/// One kilogram on one newton a metre under a rectangular pulse of one newton second.
system::LocallyNonlinear oscillator_under(double width) {
  system::LocallyNonlinear::Parts parts;
  parts.mass = parts.stiffness = testing::sparse(Matrix::Identity(1, 1));
  parts.damping = SparseMatrix(1, 1);
  model::TableLaw pulse;
  pulse.times = {0.0, start, start, start + width, start + width, end};
  pulse.values = {0.0, 0.0, 1.0 / width, 1.0 / width, 0.0, 0.0};
  parts.loads = system::Loads({system::LoadTerm{{0}, {1.0}, pulse}});
  parts.coordinates = {"mass"};
  return system::LocallyNonlinear(std::move(parts));
}

// A pulse much shorter than the period brings the impulse over m omega, not the force over k: one metre here, however
// large the force is. The response of the oscillator to a long one is the static one, at most doubled.
TEST(SizeUnderLoads, OfAShortPulseIsWhatItsImpulseBrings) {
  for (const double width : {1e-1, 1e-2, 1e-4}) EXPECT_NEAR(size_under_loads(oscillator_under(width), end), 1.0, 2e-3);
  EXPECT_NEAR(size_under_loads(oscillator_under(20.0), end), 0.05, 1e-4);
}

// x = F (1 - cos t) from the start of the pulse, less the same from its end.
TEST(LocalError, IsMeasuredByWhatAShortPulseBringsAndNotByItsForce) {
  for (const double width : {1e-1, 1e-2, 1e-3, 1e-4})
    for (const double tolerance : {1e-2, 1e-3}) {
      const auto system = oscillator_under(width);
      const Method method = make_method("generalized_alpha");
      const auto stepper = make_stepper(method, system);
      const auto estimator =
          make_estimator(default_estimator(method, tolerance, system.stop_count() > 0), method, system, *stepper, end);
      StepPlan plan;
      plan.largest = 1.0;
      struct Largest final : Observer {
        bool accepted(const system::State&, const system::State& after) override {
          const auto swing = [&](double from) { return after.t > from ? 1.0 - std::cos(after.t - from) : 0.0; };
          error = std::max(error, std::abs(after.q[0] - (swing(start) - swing(start + width)) / width));
          return true;
        }
        double width = 0.0, error = 0.0;
      } largest;
      largest.width = width;
      system::State state = consistent_start(system, system.start());
      const AdaptiveReport report = march(*stepper, *estimator, plan, system, state, end, &largest);
      ASSERT_EQ(report.march.end, MarchEnd::reached);
      EXPECT_LT(largest.error, tolerance) << width;
    }
}

// F/(k - m w^2) of a load far above resonance, and the free motion that its start sets off, as large.
TEST(LocalError, IsNotMeasuredByTheStaticDisplacementOfAFastLoad) {
  constexpr double omega = 40.0, force = 1600.0, last = 6.0;
  system::LocallyNonlinear::Parts parts;
  parts.mass = parts.stiffness = testing::sparse(Matrix::Identity(1, 1));
  parts.damping = SparseMatrix(1, 1);
  parts.loads = system::Loads({testing::harmonic(0, force, omega)});
  parts.coordinates = {"mass"};
  const system::LocallyNonlinear system(std::move(parts));
  const Method method = make_method("generalized_alpha");
  const auto stepper = make_stepper(method, system);
  const auto estimator =
      make_estimator(default_estimator(method, 1e-2, system.stop_count() > 0), method, system, *stepper, last);
  system::State state = consistent_start(system, system.start());
  StepPlan plan;
  plan.largest = 1.0;
  ASSERT_EQ(march(*stepper, *estimator, plan, system, state, last).march.end, MarchEnd::reached);
  EXPECT_NEAR(state.q[0], force / (1.0 - omega * omega) * (std::cos(omega * last) - std::cos(last)), 1e-2);
}

// The force that a law brings along promises the response that it promises as a load.
TEST(SizeUnderLoads, CountsWhatALawOfTimeDoesAtRest) {
  const auto promised = [](bool by_law) {
    system::LocallyNonlinear::Parts parts;
    parts.mass = testing::sparse(Matrix::Identity(1, 1));
    parts.stiffness = testing::sparse((by_law ? 1.0 : 5.0) * Matrix::Identity(1, 1));
    parts.damping = SparseMatrix(1, 1);
    const std::string force = "3*sin(2*t) + (t > 7 ? 1 : 0)";
    if (by_law)
      parts.laws.push_back({"law", "law", 0, ground, testing::spring("4*u - (" + force + ")")});
    else
      parts.loads =
          system::Loads({system::LoadTerm{{0}, {1.0}, model::FormulaLaw{numerics::Formula(force, {}, true)}}});
    parts.coordinates = {"mass"};
    return size_under_loads(system::LocallyNonlinear(std::move(parts)), 30.0);
  };
  EXPECT_GT(promised(false), 0.5);
  EXPECT_NEAR(promised(true), promised(false), 1e-12);
}

}  // namespace
}  // namespace rubato::integrate
