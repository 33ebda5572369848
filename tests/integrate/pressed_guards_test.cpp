#include <rubato/integrate/contact_events.hpp>
#include <rubato/integrate/exact/exact_flow.hpp>
#include <rubato/integrate/structure_timeline.hpp>

#include "support/adaptive_run.hpp"
#include "support/models.hpp"
#include "support/pressed.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

// Automatic steps end where sliders under a load that changes slip, stick, open and close.
namespace rubato::integrate {
namespace {

using testing::rubbed_mu;

/// How often a march that ended its steps at transitions saw each of them.
Events events_of(const testing::AdaptiveRun& run, const system::LocallyNonlinear& system) {
  StructureTimeline timeline(system, relative_resolution * (run.end().t - run.states.front().t));
  ContactEvents events(system, run.states.front(), &timeline);
  for (std::size_t i = 1; i < run.states.size(); ++i) events.accepted(run.states[i - 1], run.states[i]);
  return events.events();
}

class PressedGuards : public ::testing::TestWithParam<std::string> {};

struct Truth final : ExactVisitor {
  bool sample(const system::State&, const ExactWork&) override { return true; }
  bool transition(const system::State&, const Transition& transition, const ExactWork&) override {
    times.push_back(transition.t);
    return true;
  }
  std::vector<double> times;
};

// Under a load that stays the same it is the slider that the exact flow knows.
TEST_P(PressedGuards, AreThoseOfASliderUnderAConstantLoad) {
  const double end = 30.0, tolerance = 1e-7;
  const auto slider = testing::single_mass(0.15);
  Truth truth;
  ExactFlow flow(slider);
  system::State exact = slider.start();
  ASSERT_EQ(flow.advance(exact, end, {}, truth).end, ExactEnd::reached);
  ASSERT_GT(truth.times.size(), 30u);
  const auto pressed = testing::rubbed_mass("0.3 + 0*t", 1.0, 1.0, 1.0, {testing::harmonic(0, 1.0, 2.0)});
  const auto run = testing::run_adaptively(pressed, GetParam(), tolerance, end);
  for (const double t : truth.times) EXPECT_LT(run.distance(t), 100.0 * tolerance) << "transition at " << t << " s";
  EXPECT_NEAR(run.end().q[0], exact.q[0], 20.0 * tolerance);
  EXPECT_EQ(run.report.events, static_cast<long>(truth.times.size()));
  // A transition from slip to slip in the other direction is two.
  const Events events = events_of(run, pressed);
  EXPECT_EQ(events.all.size(), truth.times.size());
  for (std::size_t i = 0; i < std::min(events.all.size(), truth.times.size()); ++i)
    EXPECT_NEAR(events.all[i].t, truth.times[i], 100.0 * tolerance);
}

// A mass slides under N = 3 t, which is nothing at first: v = v0 - mu 1.5 t^2. It sticks where the limit grows as fast
// as the force of a slider that stuck would: kT v = 3 mu. From there on it swings on the slider.
TEST_P(PressedGuards, TellWhenASlidingMassSticks) {
  const double v0 = 0.5, slider = 40.0, end = 1.5;
  const auto system = testing::rubbed_mass("3*t", 0.0, 0.0, slider, {}, v0);
  const double stop = std::sqrt((v0 - 3.0 * rubbed_mu / slider) / (1.5 * rubbed_mu));
  const auto run = testing::run_adaptively(system, GetParam(), 1e-9, end);
  EXPECT_LT(run.distance(stop), 1e-8);
  const Events events = events_of(run, system);
  ASSERT_GE(events.all.size(), 1u);
  EXPECT_EQ(events.all.back().change, Change::sticks);
  EXPECT_NEAR(events.all.back().t, stop, 1e-8);
  const double frequency = std::sqrt(slider), v = 3.0 * rubbed_mu / slider, force = 3.0 * rubbed_mu * stop;
  const double swung = v * std::cos(frequency * (end - stop)) - force / frequency * std::sin(frequency * (end - stop));
  EXPECT_NEAR(run.end().v[0], swung, 1e-7);
}

// N = 1 + 1.4 cos(w t + .8) passes zero twice in a period, whatever the mass does.
TEST_P(PressedGuards, EndStepsWhereTheLoadPassesZero) {
  const double w = 1.1, end = 40.0;
  const auto system = testing::rubbed_mass("1 + 1.4*cos(1.1*t + 0.8)", 1.0, 0.05, 1.0, {testing::harmonic(0, 1.0, w)});
  const auto run = testing::run_adaptively(system, GetParam(), 1e-5, end);
  const double zero = std::acos(-1.0 / 1.4);
  long zeros = 0, told = 0;
  for (int i = 0; i < 10; ++i)
    for (const double phase : {zero, 2.0 * std::numbers::pi - zero}) {
      const double t = (phase + 2.0 * std::numbers::pi * i - 0.8) / w;
      if (t <= 0.0 || t >= end) continue;
      ++zeros;
      EXPECT_LT(run.distance(t), 1e-9) << t;
    }
  for (const Event& event : events_of(run, system).all)
    told += event.change == Change::opens || event.change == Change::closes;
  EXPECT_EQ(told, zeros);
}

INSTANTIATE_TEST_SUITE_P(Methods, PressedGuards,
                         ::testing::Values("generalized_alpha", "bogacki_shampine", "dormand_prince"),
                         [](const auto& info) { return info.param; });

// Pressed by a stop that opens and closes, to the digits of the exact piecewise linear flow (as NormalForces has them).
TEST(PairsWithPressedSliders, KeepTheTolerance) {
  for (const bool stop_is_law : {false, true})
    for (const char* method : {"bogacki_shampine", "dormand_prince"})
      for (const double tolerance : {1e-5, 1e-7, 1e-9}) {
        SCOPED_TRACE(std::string(method) + (stop_is_law ? ", a law presses, " : ", a stop presses, ") +
                     std::to_string(std::log10(tolerance)));
        const auto run = testing::run_adaptively(testing::coupled(1.5, stop_is_law), method, tolerance, 50.0);
        EXPECT_NEAR(run.end().q[0], -1.2699636324, 50.0 * tolerance + 1e-10);
        EXPECT_NEAR(run.end().q[1], -1.0231479574, 50.0 * tolerance + 1e-10);
        EXPECT_NEAR(run.end().v[0], 0.2091093392, 50.0 * tolerance + 1e-10);
      }
}

}  // namespace
}  // namespace rubato::integrate
