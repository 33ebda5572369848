#include <rubato/integrate/adaptive_march.hpp>
#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/exact/exact_flow.hpp>

#include "support/adaptive_run.hpp"
#include "support/laws.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

// Steps of pairs of Runge-Kutta methods end where a law with a memory goes on by another formula.
namespace rubato::integrate {
namespace {

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
  const auto marched = testing::run_adaptively(law, GetParam(), tolerance, end);
  EXPECT_NEAR(marched.end().q[0], exact.q[0], 20.0 * tolerance);
  ASSERT_GT(truth.times.size(), 30u);
  for (const double t : truth.times) EXPECT_LT(marched.distance(t), 100.0 * tolerance) << "transition at " << t << " s";
}

// The tolerance is kept since no step goes across a turn of the motion, or a zero of z.
TEST_P(LawGuards, KeepTheToleranceOfABoucWenElement) {
  const double end = 20.0;
  for (const double n : {1.0, 1.5, 2.0}) {
    const auto system = testing::bouc_wen_mass(n, 0.85);
    const auto truth = testing::run_adaptively(system, "dormand_prince", 1e-12, end);
    for (const double tolerance : {1e-4, 1e-6, 1e-8}) {
      const auto states = testing::run_adaptively(system, GetParam(), tolerance, end).states;
      EXPECT_NEAR(states.back().q[0], truth.end().q[0], 20.0 * tolerance) << "n = " << n;
      for (std::size_t i = 1; i < states.size(); ++i)
        EXPECT_GT(states[i - 1].v[0] * states[i].v[0], -1e-9) << "a turn within the step that ends at " << states[i].t;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Pairs, LawGuards, ::testing::Values("bogacki_shampine", "dormand_prince"),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace rubato::integrate
