#pragma once

#include <rubato/integrate/adaptive_march.hpp>
#include <rubato/integrate/catalogue.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

// A structure marched with automatic steps from its start, with every step that was tried.
namespace rubato::testing {

struct AdaptiveRun final : integrate::Observer, integrate::TryLog {
  bool accepted(const system::State& before, const system::State& after) override {
    if (states.empty()) states.push_back(before);
    states.push_back(after);
    return true;
  }
  void tried(const integrate::StepTry& step_try) override { tries.push_back(step_try); }
  const system::State& end() const { return states.back(); }
  /// The start or end of a step that is nearest to a time.
  double nearest(double t) const {
    const auto is_nearer = [t](const auto& a, const auto& b) { return std::abs(a.t - t) < std::abs(b.t - t); };
    return std::min_element(states.begin(), states.end(), is_nearer)->t;
  }
  double distance(double t) const { return std::abs(nearest(t) - t); }

  std::vector<system::State> states;  ///< the start, and the end of each accepted step
  std::vector<integrate::StepTry> tries;
  integrate::AdaptiveReport report;
};

/// With the method's own estimator, and steps of a fiftieth of the march at most.
inline AdaptiveRun run_adaptively(const system::LocallyNonlinear& system, const std::string& name, double tolerance,
                                  double end, bool locate = true) {
  const integrate::Method method = integrate::make_method(name);
  const auto stepper = make_stepper(method, system);
  const auto estimator =
      make_estimator(default_estimator(method, tolerance, system.stop_count() + system.block_count() > 0), method,
                     system, *stepper, end);
  integrate::StepPlan plan;
  plan.locate_events = locate;
  plan.largest = end / 50.0;
  AdaptiveRun run;
  system::State state = integrate::consistent_start(system, system.start());
  run.report = march(*stepper, *estimator, plan, system, state, end, &run, &run);
  EXPECT_EQ(run.report.march.end, integrate::MarchEnd::reached);
  return run;
}

}  // namespace rubato::testing
