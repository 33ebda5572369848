#include <rubato/integrate/adaptive_march.hpp>
#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/exact/exact_flow.hpp>

#include "support/laws.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

// Steps of pairs of Runge-Kutta methods end where a law with a memory goes on by another formula.
namespace rubato::integrate {
namespace {

struct Steps final : Observer {
  bool accepted(const system::State& before, const system::State& after) override {
    if (states.empty()) states.push_back(before);
    states.push_back(after);
    return true;
  }
  std::vector<system::State> states;
};

std::vector<system::State> run(const system::LocallyNonlinear& system, const std::string& name, double tolerance,
                               double end) {
  const Method method = make_method(name);
  const auto stepper = make_stepper(method, system);
  const auto estimator =
      make_estimator(default_estimator(method, tolerance, system.stop_count() > 0), method, system, *stepper, end);
  StepPlan plan;
  plan.locate_events = true;
  plan.largest = end / 50.0;
  Steps steps;
  system::State state = consistent_start(system, system.start());
  EXPECT_EQ(march(*stepper, *estimator, plan, system, state, end, &steps).march.end, MarchEnd::reached);
  return steps.states;
}

class LawGuards : public ::testing::TestWithParam<std::string> {};

// A slider, whose motion and transitions the exact flow knows.
TEST_P(LawGuards, EndStepsWhereASlipBeginsAndEnds) {
  struct Truth final : ExactVisitor {
    bool sample(const system::State&, const ExactWork&) override { return true; }
    bool transition(const system::State&, const Transition& transition, const ExactWork&) override {
      times.push_back(transition.t);
      return true;
    }
    std::vector<double> times;
  } truth;
  const double end = 30.0, tolerance = 1e-7;
  const auto slider = testing::single_mass(0.15);
  ExactFlow flow(slider);
  system::State exact = slider.start();
  ASSERT_EQ(flow.advance(exact, end, {}, truth).end, ExactEnd::reached);
  const auto law = testing::single_mass_on(std::make_shared<testing::JenkinsLaw>(1.0, 0.15));
  const auto states = run(law, GetParam(), tolerance, end);
  EXPECT_NEAR(states.back().q[0], exact.q[0], 20.0 * tolerance);
  ASSERT_GT(truth.times.size(), 30u);
  for (const double t : truth.times) {
    double nearest = HUGE_VAL;
    for (const auto& state : states) nearest = std::min(nearest, std::abs(state.t - t));
    EXPECT_LT(nearest, 100.0 * tolerance) << "transition at " << t << " s";
  }
}

// The tolerance is kept since no step goes across a turn of the motion, or a zero of z.
TEST_P(LawGuards, KeepTheToleranceOfABoucWenElement) {
  const double end = 20.0;
  for (const double n : {1.0, 1.5, 2.0}) {
    const auto system = testing::bouc_wen_mass(n, 0.85);
    const auto truth = run(system, "dormand_prince", 1e-12, end);
    for (const double tolerance : {1e-4, 1e-6, 1e-8}) {
      const auto states = run(system, GetParam(), tolerance, end);
      EXPECT_NEAR(states.back().q[0], truth.back().q[0], 20.0 * tolerance) << "n = " << n;
      for (std::size_t i = 1; i < states.size(); ++i)
        EXPECT_GT(states[i - 1].v[0] * states[i].v[0], -1e-9) << "a turn within the step that ends at " << states[i].t;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Pairs, LawGuards, ::testing::Values("bogacki_shampine", "dormand_prince"),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace rubato::integrate
