#include <rubato/integrate/adaptive_march.hpp>
#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/constrained/consistent_start.hpp>
#include <rubato/integrate/constrained/constrained_space.hpp>
#include <rubato/integrate/constrained/constrained_stepper.hpp>
#include <rubato/integrate/kinds/mechanism_start_state.hpp>
#include <rubato/integrate/mechanism/mechanism_timeline.hpp>
#include <rubato/io/read_study.hpp>
#include <rubato/model/build_mechanism.hpp>
#include <rubato/system/mechanism_equations.hpp>

#include <support/locking_bars.hpp>

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <variant>

// The equations of a march, lent to its stepper, error measure and timeline: nobody finds in them what another left.
namespace rubato {
namespace {

using namespace integrate;

struct Ended {
  system::State state;
  AdaptiveReport report;
};

Ended ended(const system::Mechanism& mechanism, double tolerance, double end, bool are_lent) {
  const auto method = make_method("generalized_alpha", {{"rho_inf", 0.8}});
  NewtonPlan newton;
  newton.projects_velocities = true;
  newton.avoids_singular_ends = true;
  system::MechanismEquations equations(mechanism);
  Ended result;
  std::vector<std::string> warnings;
  result.state = assembled_start({}, mechanism, warnings);
  settle_start({}, mechanism, end, result.state);
  const system::State start = result.state;
  const auto stepper = are_lent ? make_stepper(method, equations, newton) : make_stepper(method, mechanism, newton);
  auto space = are_lent ? make_error_space(equations, start, tolerance) : make_error_space(mechanism, start, tolerance);
  const auto estimator =
      make_estimator(LocalError{tolerance}, std::get<GeneralizedAlpha>(method.formula), std::move(space), start, end);
  StepPlan plan;
  plan.smallest = 1e-12 * end;
  plan.largest = 0.02 * end;
  plan.locate_events = true;
  MechanismTimeline own(mechanism, 1e-12 * end), lent(equations, 1e-12 * end);
  result.report = march(*stepper, *estimator, plan, are_lent ? lent : own, result.state, end);
  EXPECT_EQ(result.report.march.end, MarchEnd::reached);
  EXPECT_GT(result.report.events, 0);
  return result;
}

void expect_same_bits(const system::Mechanism& mechanism, double tolerance, double end) {
  const Ended own = ended(mechanism, tolerance, end, false), lent = ended(mechanism, tolerance, end, true);
  EXPECT_EQ(lent.report.march.steps, own.report.march.steps);
  EXPECT_EQ(lent.report.factorisations, own.report.factorisations);
  EXPECT_EQ(lent.state.q, own.state.q);
  EXPECT_EQ(lent.state.v, own.state.v);
  EXPECT_EQ(lent.state.multiplier, own.state.multiplier);
  EXPECT_EQ(lent.state.rubbing, own.state.rubbing);
}

/// A bar whose pin rubs by what it carries.
system::Mechanism rubbing_bar() {
  const auto study = io::read_study_text(R"toml(
[[body]]
name = "bar"
position = [0.5, 0.0]
mass = 1.0
inertia = 0.1
[[joint]]
name = "pin"
type = "revolute"
between = ["ground", "bar"]
at = [0.0, 0.0]
friction = { coefficient = 0.4, normal_load = "reaction", radius = 0.1 }
[gravity]
acceleration = [0.0, -9.81]
[[analysis]]
name = "swing"
type = "transient"
step = { tolerance = 1e-4 }
duration = 5.0
)toml",
                                         "study.toml");
  return system::Mechanism(model::build_mechanism(study.model, {}));
}

TEST(LentEquations, LeaveAMarchThatLocksItsBits) {
  expect_same_bits(system::Mechanism(testing::locking_bars(testing::LockingLaw::latch, 2).mechanism), 1e-4, 1.6);
}

// The step lets the friction follow more than the multipliers: no one else may.
TEST(LentEquations, LeaveFrictionThatFollowsReactionsItsBits) { expect_same_bits(rubbing_bar(), 1e-4, 5.0); }

TEST(LentEquations, HaveNoLagOfReactionsAfterATryThatFailed) {
  const system::Mechanism mechanism = rubbing_bar();
  system::MechanismEquations equations(mechanism);
  NewtonPlan newton;
  newton.projects_velocities = true;
  const auto stepper = make_stepper(make_method("generalized_alpha", {{"rho_inf", 0.8}}), equations, newton);
  std::vector<std::string> warnings;
  system::State state = assembled_start({}, mechanism, warnings), to = state;
  const Vector multiplier = Vector::Ones(mechanism.constraint_count());
  equations.go_to(state, model::Side::right);
  const double limit = equations.friction_limit(0, multiplier);
  state.reaction_lag = 5.0 * multiplier;
  constexpr double endless = 1e200;
  EXPECT_NE(stepper->attempt(state, endless, endless, to).outcome, StepOutcome::accepted);
  equations.go_to(state, model::Side::right);
  EXPECT_EQ(equations.friction_limit(0, multiplier), limit);
}

}  // namespace
}  // namespace rubato
