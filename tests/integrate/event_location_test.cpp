#include <rubato/integrate/adaptive_march.hpp>
#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/exact/exact_flow.hpp>
#include <rubato/integrate/structure_timeline.hpp>

#include "support/adaptive_run.hpp"
#include "support/models.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace rubato::integrate {
namespace {

/// The exact flow of a system: its transitions, and its states at given times.
struct Truth final : ExactVisitor {
  Truth(const system::LocallyNonlinear& system, double end, const std::vector<double>& samples = {}) {
    ExactFlow flow(system);
    system::State state = system.start();
    EXPECT_EQ(flow.advance(state, end, samples, *this).end, ExactEnd::reached);
  }
  bool sample(const system::State& state, const ExactWork&) override {
    states.push_back(state);
    return true;
  }
  bool transition(const system::State&, const Transition& transition, const ExactWork&) override {
    transitions.push_back(transition);
    return true;
  }
  std::vector<system::State> states;
  std::vector<Transition> transitions;
};

class Slider : public ::testing::TestWithParam<std::string> {};

// The flow between transitions is analytic and its transitions are found to round-off; a march of relative error e
// meets them with an error of about e.
TEST_P(Slider, ChangesItsStateAtTheEndsOfSteps) {
  const double end = 30.0;
  const auto system = testing::single_mass(0.15);
  const Truth truth(system, end);
  ASSERT_GT(truth.transitions.size(), 15u);
  const testing::AdaptiveRun marched = testing::run_adaptively(system, GetParam(), 1e-7, end);
  EXPECT_EQ(marched.report.events, static_cast<long>(truth.transitions.size()));
  for (const Transition& transition : truth.transitions) EXPECT_LT(marched.distance(transition.t), 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Methods, Slider,
                         ::testing::Values("generalized_alpha", "hht", "average_acceleration", "bogacki_shampine",
                                           "dormand_prince"),
                         [](const auto& info) { return info.param; });

double largest_error(const testing::AdaptiveRun& run, const system::LocallyNonlinear& system, double end) {
  std::vector<double> times;
  for (const auto& state : run.states) times.push_back(state.t);
  const Truth truth(system, end, times);
  double largest = 0.0;
  for (std::size_t i = 0; i < times.size(); ++i)
    largest = std::max(largest, (run.states[i].q - truth.states[i].q).norm());
  return largest;
}

using Case = std::tuple<std::string, bool>;
class Location : public ::testing::TestWithParam<Case> {};

// Without location the controller of an embedded pair finds a transition by rejecting steps until one is small enough;
// with it hardly a step is rejected, and the error is that of a smooth motion. A method of second order errs as much by
// the smooth motion: there it is enough that location costs no accuracy for the same number of steps.
TEST_P(Location, CostsNoAccuracyAndSparesThePairsRejections) {
  const auto& [method, has_two_sliders] = GetParam();
  const double end = 30.0;
  const auto system = has_two_sliders ? testing::damper_model(10.0, 7.7, -8.0) : testing::single_mass(0.15);
  for (const double tolerance : {1e-3, 1e-4}) {
    const testing::AdaptiveRun without = testing::run_adaptively(system, method, tolerance, end, false),
                               with = testing::run_adaptively(system, method, tolerance, end);
    EXPECT_EQ(without.report.events, 0);
    EXPECT_GT(with.report.events, 30);
    EXPECT_EQ(with.report.restarts, with.report.events);
    if (method == "generalized_alpha") {
      const auto effort = [&](const testing::AdaptiveRun& run) {
        return largest_error(run, system, end) * std::pow(static_cast<double>(run.report.march.steps), 2);
      };
      EXPECT_LE(with.report.rejected, std::max(2l, without.report.rejected + 1)) << tolerance;
      EXPECT_LT(effort(with), 1.2 * effort(without)) << tolerance;
    } else {
      EXPECT_LT(with.report.rejected, std::max(2l, without.report.rejected / 5)) << tolerance;
      EXPECT_LT(largest_error(with, system, end), 1.2 * largest_error(without, system, end)) << tolerance;
    }
    EXPECT_LT(with.report.event_tries, 12 * with.report.events);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Methods, Location,
    ::testing::Combine(::testing::Values("generalized_alpha", "bogacki_shampine", "dormand_prince"), ::testing::Bool()),
    [](const auto& info) { return std::get<0>(info.param) + (std::get<1>(info.param) ? "_two" : "_one"); });

/// Keeps the bits of every start of a try.
class Starts final : public Stepper {
 public:
  explicit Starts(std::unique_ptr<Stepper> inner) : inner_(std::move(inner)) {}
  StepReport attempt(const system::State& from, double h, double t1, system::State& to) override {
    all.push_back(from);
    return inner_->attempt(from, h, t1, to);
  }
  void step_changes(system::State& state, double ratio) override { inner_->step_changes(state, ratio); }
  double shift() const override { return inner_->shift(); }
  std::vector<system::State> all;

 private:
  std::unique_ptr<Stepper> inner_;
};

bool same_bits(const Vector& a, const Vector& b) { return std::equal(a.begin(), a.end(), b.begin(), b.end()); }

TEST(EventTry, LeavesNoTrace) {
  const auto system = testing::damper_model(10.0, 7.7, -8.0);
  const Method method = make_method("generalized_alpha");
  Starts stepper(make_stepper(method, system));
  const auto estimator = make_estimator(LocalError{1e-3}, method, system, stepper, 20.0);
  StepPlan plan;
  plan.locate_events = true;
  testing::AdaptiveRun watched;
  system::State state = consistent_start(system, system.start());
  const AdaptiveReport report = march(stepper, *estimator, plan, system, state, 20.0, &watched, &watched);
  ASSERT_GT(report.event_tries, 100);
  std::size_t last = 0, start = 0;
  bool is_prepared_alike = true;
  for (std::size_t i = 0; i < watched.tries.size(); ++i) {
    const StepTry& tried = watched.tries[i];
    ASSERT_EQ(tried.t, watched.states[last].t);
    ASSERT_TRUE(same_bits(stepper.all[start].q, watched.states[last].q));
    ASSERT_TRUE(same_bits(stepper.all[start].v, watched.states[last].v));
    ASSERT_TRUE(same_bits(stepper.all[start].slider_force, watched.states[last].slider_force));
    // Tries from one state with one length must have started from the same auxiliary acceleration, too.
    if (i > 0 && watched.tries[i - 1].t == tried.t && watched.tries[i - 1].step == tried.step)
      is_prepared_alike &=
          same_bits(stepper.all[start].auxiliary_acceleration, stepper.all[start - 1].auxiliary_acceleration);
    ++start;
    if (tried.outcome == TryOutcome::accepted) ++last;
  }
  EXPECT_TRUE(is_prepared_alike);
  EXPECT_EQ(start, stepper.all.size());
}

/// Transitions that accumulate at t = 1, each half as far from it as the one before.
struct Accumulation final : Timeline {
  explicit Accumulation(const system::LocallyNonlinear& s) : structure(s, 1e-12) {}
  static double time(Index k) { return 1.0 - std::ldexp(1.0, -static_cast<int>(k)); }

  std::vector<double> breakpoints(double from, double to) const override { return structure.breakpoints(from, to); }
  bool jumps_at(double t) override { return structure.jumps_at(t); }
  bool restart(system::State& state) override { return structure.restart(state); }
  Passage pass(const system::State&, system::State&, double) override { return Passage::continues; }
  double resolution() const override { return 1e-12; }
  Crossing first_crossing(const system::State& from, const system::State& to, double least, integrate::Look) override {
    for (Index k = 1; k < 60; ++k) {
      const double share = (time(k) - from.t) / (to.t - from.t);
      if (time(k) > from.t && share >= least && time(k) <= to.t) return {k, share};
    }
    return {};
  }
  GuardValue guard(Index k, const system::State&, const system::State& to) override { return {time(k) - to.t, -1.0}; }

  StructureTimeline structure;
};

// Steps of about h pass over what lies within 1e-6 h of their starts: of the transitions 2^-k apart, no more than
// 1 + log2(1/(1e-6 h)) can be located.
TEST(Accumulation, OfTransitionsIsPassed) {
  const auto system = testing::single_mass();
  const Method method = make_method("generalized_alpha");
  const auto stepper = make_stepper(method, system);
  const auto estimator = make_estimator(LocalError{1e-3}, method, system, *stepper, 2.0);
  StepPlan plan;
  plan.controller = FixedStep{};
  plan.first = 0.05;
  plan.locate_events = true;
  Accumulation timeline(system);
  system::State state = consistent_start(system, system.start());
  const AdaptiveReport report = march(*stepper, *estimator, plan, timeline, state, 2.0);
  EXPECT_EQ(report.march.end, MarchEnd::reached);
  EXPECT_EQ(state.t, 2.0);
  EXPECT_GT(report.events, 15);
  EXPECT_LE(report.events, 26);
}

}  // namespace
}  // namespace rubato::integrate
