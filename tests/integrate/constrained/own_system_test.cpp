#include <rubato/core/error.hpp>
#include <rubato/integrate/adaptive_march.hpp>
#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/constrained/consistent_start.hpp>
#include <rubato/integrate/constrained/constrained_space.hpp>
#include <rubato/integrate/constrained/constrained_stepper.hpp>
#include <rubato/integrate/constrained/guard_timeline.hpp>
#include <rubato/model/joints/plane_joints.hpp>
#include <rubato/system/constrained_equations.hpp>
#include <rubato/system/mechanism.hpp>
#include <rubato/system/own_system.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

// Equations of motion that a user writes by hand, marched by the same methods as mechanisms.
namespace rubato::integrate {
namespace {

using Parameters = std::vector<std::pair<std::string, double>>;
using system::Passage;
using system::State;

constexpr double weighs = 2.0, gravity = 9.81;

/// A bob on a string of 1 m, let go from the horizontal; it may hit a wall, and the string may be cut.
struct Pendulum : system::OwnSystem {
  explicit Pendulum(std::vector<int> phase = {})
      : OwnSystem({"x", "y"}, weighs * Matrix::Identity(2, 2).sparseView(), Eigen::Vector2d(1.0, 0.0), Vector::Zero(2),
                  {"string"}, std::move(phase)) {}
  void force(const State&, model::Side, Vector& f) const override { f << 0.0, weighs * gravity; }
  void constraint(const State& at, Vector& g) const override { g << 0.5 * (at.q.squaredNorm() - 1.0); }
  void jacobian(const State& at, Matrix& G) const override { G = at.q.transpose(); }
};

/// The same in its angle, by rk4 with 2e5 steps.
struct Exact {
  double angle = 0.5 * M_PI, rate = 0.0;
  explicit Exact(double end) {
    constexpr int steps = 200000;
    const double h = end / steps;
    const auto pull = [](double a) { return -gravity * std::sin(a); };
    for (int i = 0; i < steps; ++i) {
      const double k1 = rate, l1 = pull(angle), k2 = rate + 0.5 * h * l1, l2 = pull(angle + 0.5 * h * k1);
      const double k3 = rate + 0.5 * h * l2, l3 = pull(angle + 0.5 * h * k2);
      const double k4 = rate + h * l3, l4 = pull(angle + h * k3);
      angle += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
      rate += h / 6.0 * (l1 + 2.0 * l2 + 2.0 * l3 + l4);
    }
  }
  double error(const State& state) const {
    return std::hypot(state.q[0] - std::sin(angle), state.q[1] + std::cos(angle));
  }
  /// of the multiplier, which is the pull of the string over its length
  double error_of_pull(const State& state) const {
    return std::abs(state.multiplier[0] - weighs * (rate * rate + gravity * std::cos(angle)));
  }
};

State marched(const system::OwnSystem& system, const Method& method, double h, double end, bool projects = false) {
  NewtonPlan plan;
  plan.projects_velocities = projects;
  const auto stepper = make_stepper(method, system, plan);
  const auto equations = system.equations();
  State state = make_consistent(*equations, system.start()).state;
  shift_acceleration(*equations, state, stepper->shift() * h);
  EXPECT_EQ(march(*stepper, state, h, end).end, MarchEnd::reached) << method.name;
  EXPECT_TRUE(find_acceleration(*equations, state, model::Side::left));
  return state;
}

void expect_order(const Method& method, double order, bool projects) {
  const Pendulum pendulum;
  const double end = 2.0;
  static const Exact exact(end);
  const State coarse = marched(pendulum, method, 2e-3, end, projects);
  const State fine = marched(pendulum, method, 1e-3, end, projects);
  EXPECT_GT(exact.error(coarse) / exact.error(fine), 0.9 * std::pow(2.0, order)) << method.name;
  EXPECT_GT(exact.error_of_pull(coarse) / exact.error_of_pull(fine), 0.9 * std::pow(2.0, order)) << method.name;
  EXPECT_LT(exact.error(fine), order == 2 ? 2e-4 : 2e-3) << method.name;
}

TEST(OwnSystem, IsMarchedByEveryMethodThatDampsItsConstraints) {
  const std::vector<std::pair<std::string, Parameters>> second = {{"hht", {{"alpha", -0.1}}},
                                                                  {"wbz", {{"rho_inf", 0.5}}},
                                                                  {"generalized_alpha", {{"rho_inf", 0.9}}},
                                                                  {"generalized_alpha", {{"rho_inf", 0.0}}}};
  const std::vector<std::pair<std::string, Parameters>> first = {{"galerkin", {}},
                                                                 {"backward_difference", {}},
                                                                 {"damped_newmark", {}},
                                                                 {"newmark", {{"beta", 0.4}, {"gamma", 0.6}}}};
  for (const bool projects : {false, true}) {
    for (const auto& [name, parameters] : second) expect_order(make_method(name, parameters), 2, projects);
    for (const auto& [name, parameters] : first) expect_order(make_method(name, parameters), 1, projects);
  }
}

TEST(OwnSystem, IsMarchedByAMethodThatDoesNotDampOnlyWithProjectedVelocities) {
  const Pendulum pendulum;
  const std::vector<std::pair<std::string, Parameters>> methods = {{"average_acceleration", {}},
                                                                   {"hht", {{"alpha", 0.0}}},
                                                                   {"generalized_alpha", {{"rho_inf", 1.0}}},
                                                                   {"newmark", {{"beta", 0.3}, {"gamma", 0.5}}}};
  for (const auto& [name, parameters] : methods) {
    const Method method = make_method(name, parameters);
    try {
      (void)make_stepper(method, pendulum);
      FAIL() << name;
    } catch (const InvalidInput& fault) {
      EXPECT_THAT(fault.message(), ::testing::HasSubstr("project_velocities = true"));
    }
    expect_order(method, 2, true);
  }
}

TEST(OwnSystem, IsNotMarchedByMethodsThatSolveNothingOrGrow) {
  const Pendulum pendulum;
  NewtonPlan projects;
  projects.projects_velocities = true;
  for (const char* name :
       {"central_difference", "rk4", "exponential", "exact", "wilson_theta", "linear_acceleration", "fox_goodwin"})
    EXPECT_THROW((void)make_stepper(make_method(name), pendulum, projects), InvalidInput) << name;
}

TEST(OwnSystem, MovesAsTheMechanismThatItIs) {
  model::Mechanism link(2);
  link.gravity = {0.0, -gravity, 0.0};
  const Index bob = link.add_node("bob", {1.0, 0.0, 0.0}, {true, true, false});
  link.add_mass(bob, weighs);
  link.joints.push_back(
      model::make_plane_distance("link", link.plane_point(0, 0.0, 0.0), link.plane_point(bob, 1.0, 0.0), 1.0));
  const system::Mechanism mechanism(std::move(link));
  const Method method = make_method("generalized_alpha", {{"rho_inf", 0.8}});
  const Pendulum pendulum;
  const State own = marched(pendulum, method, 5e-3, 2.0);
  const auto stepper = make_stepper(method, mechanism);
  const auto equations = mechanism.equations();
  State state = make_consistent(*equations, mechanism.start()).state;
  shift_acceleration(*equations, state, stepper->shift() * 5e-3);
  EXPECT_EQ(march(*stepper, state, 5e-3, 2.0).end, MarchEnd::reached);
  EXPECT_LT((state.v - own.v).norm(), 1e-8);
}

struct Automatic {
  State state;
  AdaptiveReport report;
  std::vector<GuardEvent> events;
};

Automatic march_automatically(const system::OwnSystem& system, const Controller& controller, const EstimatorKind& kind,
                              double tolerance, double end) {
  const Method method = make_method("generalized_alpha", {{"rho_inf", 0.8}});
  NewtonPlan newton;
  newton.projects_velocities = true;
  const auto stepper = make_stepper(method, system, newton);
  const auto equations = system.equations();
  Automatic run;
  run.state = make_consistent(*equations, system.start()).state;
  const auto estimator = make_estimator(kind, std::get<GeneralizedAlpha>(method.formula),
                                        make_error_space(system, run.state, tolerance), run.state, end);
  StepPlan plan;
  plan.controller = controller;
  plan.first = 1e-3;
  plan.locate_events = true;
  GuardTimeline timeline(system, 1e-12 * end);
  run.report = march(*stepper, *estimator, plan, timeline, run.state, end);
  EXPECT_EQ(run.report.march.end, MarchEnd::reached);
  run.events = timeline.events();
  return run;
}

TEST(OwnSystem, IsMarchedWithEveryControllerAndEstimator) {
  const Pendulum pendulum;
  const double end = 2.0;
  const Exact exact(end);
  for (const Controller& controller : {Controller{FixedStep{}}, Controller{CardonaCassano{}}, Controller{PiControl{}}})
    for (const bool is_local : {false, true}) {
      const double tolerance = 1e-4;
      const EstimatorKind kind =
          is_local ? EstimatorKind{LocalError{tolerance}} : EstimatorKind{InertiaJump{tolerance, std::sqrt(weighs)}};
      const Automatic run = march_automatically(pendulum, controller, kind, tolerance, end);
      EXPECT_LT(exact.error(run.state), 10.0 * tolerance) << name_of(controller) << ", " << name_of(kind);
      EXPECT_GT(exact.error(run.state), 1e-3 * tolerance) << name_of(controller) << ", " << name_of(kind);
    }
}

/// Comes back from a wall below its hinge.
struct AgainstAWall final : Pendulum {
  Index guard_count() const override { return 1; }
  GuardValue guard(Index, const State& at) const override { return {at.q[0], at.v[0]}; }
  Passage pass(Index, State& at) const override {
    at.v[0] *= -0.8;
    return Passage::restarts;
  }
};

TEST(OwnSystem, EndsItsStepsAtItsGuards) {
  const AgainstAWall pendulum;
  const Automatic run = march_automatically(pendulum, PiControl{}, LocalError{1e-6}, 1e-6, 3.0);
  // K(sin(amplitude/2)) sqrt(l/g) is a quarter of a swing; each impact leaves 0.64 of the height.
  const auto quarter = [](double height) { return std::comp_ellint_1(std::sqrt(0.5 * height)) / std::sqrt(gravity); };
  ASSERT_EQ(run.events.size(), 3U);
  double height = 1.0, expected = quarter(height);
  for (const GuardEvent& event : run.events) {
    EXPECT_NEAR(event.t, expected, 5e-6);
    EXPECT_NEAR(event.energy_lost, 0.36 * weighs * gravity * height, 1e-4);
    height *= 0.64;
    expected += 2.0 * quarter(height);
  }
}

/// Its string is cut at the lowest point.
struct Cut final : Pendulum {
  Cut() : Pendulum({1}) {}
  bool is_active(Index, const State& at) const override { return at.phase[0] == 1; }
  Index guard_count() const override { return 1; }
  GuardValue guard(Index, const State& at) const override {
    return at.phase[0] == 1 ? GuardValue{at.q[0], at.v[0]} : GuardValue{1.0, 0.0};
  }
  Passage pass(Index, State& at) const override {
    at.phase[0] = 0;
    return Passage::restarts;
  }
};

TEST(OwnSystem, LetsGoOfAConstraintOnAnotherBranch) {
  const double end = 1.0;
  const Automatic run = march_automatically(Cut(), PiControl{}, LocalError{1e-7}, 1e-7, end);
  ASSERT_EQ(run.events.size(), 1U);
  const double flight = end - std::comp_ellint_1(std::sqrt(0.5)) / std::sqrt(gravity);
  EXPECT_NEAR(run.state.q[0], -std::sqrt(2.0 * gravity) * flight, 1e-5);
  EXPECT_NEAR(run.state.q[1], -1.0 - 0.5 * gravity * flight * flight, 1e-5);
  EXPECT_EQ(run.state.multiplier[0], 0.0);
}

/// A mass between a stiffening spring, a damper and a slide that is driven as sin 3 t.
struct Driven final : system::OwnSystem {
  Driven()
      : OwnSystem({"mass", "slide"}, Matrix::Identity(2, 2).sparseView(), Vector::Zero(2), Eigen::Vector2d(0.0, 3.0),
                  {"drive"}) {}
  void force(const State& at, model::Side, Vector& f) const override {
    const double u = at.q[0] - at.q[1], pull = 40.0 * u + 300.0 * u * u * u + 0.5 * (at.v[0] - at.v[1]);
    f << pull, -pull;
  }
  std::vector<Index> driven_rows() const override { return {0}; }
  void constraint(const State& at, Vector& g) const override { g << at.q[1] - std::sin(3.0 * at.t); }
  void jacobian(const State&, Matrix& G) const override { G << 0.0, 1.0; }
  void constraint_time_rate(const State& at, Vector& rate) const override { rate << -3.0 * std::cos(3.0 * at.t); }
  void second_rate(const State& at, Vector& rate) const override { rate << 9.0 * std::sin(3.0 * at.t); }
};

/// The mass alone, the slide put in: what the drive pulls with is the force of the second less its inertia.
struct Alone final : system::OwnSystem {
  Alone() : OwnSystem({"mass"}, Matrix::Identity(1, 1).sparseView(), Vector::Zero(1), Vector::Zero(1)) {}
  static double pull(const State& at) {
    const double u = at.q[0] - std::sin(3.0 * at.t), rate = at.v[0] - 3.0 * std::cos(3.0 * at.t);
    return 40.0 * u + 300.0 * u * u * u + 0.5 * rate;
  }
  void force(const State& at, model::Side, Vector& f) const override { f << pull(at); }
};

TEST(OwnSystem, FollowsAConstraintThatTimeDrives) {
  const Method method = make_method("generalized_alpha", {{"rho_inf", 0.5}});
  double last = 0.0;
  for (const double h : {2e-3, 1e-3}) {
    const State driven = marched(Driven(), method, h, 1.0), alone = marched(Alone(), method, h, 1.0);
    const double error = std::abs(driven.q[0] - alone.q[0]);
    EXPECT_LT(error, 1e-4);
    EXPECT_NEAR(driven.q[1], std::sin(3.0), 1e-9);
    EXPECT_NEAR(driven.multiplier[0], Alone::pull(alone) + 9.0 * std::sin(3.0), 1e-2);
    if (last > 0.0) {
      EXPECT_GT(last / error, 3.5);
    }
    last = error;
  }
}

/// With slopes that are written.
struct Written final : Pendulum {
  void force_slopes(const State&, model::Side, Matrix& stiffness, Matrix& damping) const override {
    stiffness.setZero();
    damping.setZero();
  }
  void curvature(const State&, const Vector& multiplier, Matrix& stiffness) const override {
    stiffness = multiplier[0] * Matrix::Identity(2, 2);
  }
  void second_rate(const State& at, Vector& rate) const override { rate << at.v.squaredNorm(); }
};

TEST(OwnSystem, FindsSlopesThatAreNotWritten) {
  const Method method = make_method("hht", {{"alpha", -0.1}});
  const State found = marched(Pendulum(), method, 5e-3, 2.0), written = marched(Written(), method, 5e-3, 2.0);
  EXPECT_LT((found.q - written.q).norm(), 1e-8);
  EXPECT_LT((found.multiplier - written.multiplier).norm(), 1e-6);
}

/// A ball on a floor: each bounce leaves a quarter of the height, and they end at 3 sqrt(2 h/g) after a finite time.
struct Ball final : system::OwnSystem {
  Ball() : OwnSystem({"height"}, Matrix::Identity(1, 1).sparseView(), Vector::Ones(1), Vector::Zero(1)) {}
  void force(const State&, model::Side, Vector& f) const override { f << gravity; }
  Index guard_count() const override { return 1; }
  GuardValue guard(Index, const State& at) const override { return {at.q[0], at.v[0]}; }
  Passage pass(Index, State& at) const override {
    at.v[0] *= -0.5;
    return Passage::restarts;
  }
};

// Below the resolution of times a bounce was passed over, and the ball fell through the floor.
TEST(OwnSystem, DoesNotFallThroughWhereBouncesEnd) {
  const Ball ball;
  const Method method = make_method("generalized_alpha", {{"rho_inf", 0.8}});
  const auto stepper = make_stepper(method, ball);
  const auto equations = ball.equations();
  State state = make_consistent(*equations, ball.start()).state;
  const auto estimator = make_estimator(LocalError{1e-6}, std::get<GeneralizedAlpha>(method.formula),
                                        make_error_space(ball, state, 1e-6), state, 3.0);
  StepPlan plan;
  plan.locate_events = true;
  GuardTimeline timeline(ball, 3e-12);
  const auto report = march(*stepper, *estimator, plan, timeline, state, 3.0);
  EXPECT_EQ(report.march.end, MarchEnd::failed);
  EXPECT_NEAR(state.t, 3.0 * std::sqrt(2.0 / gravity), 1e-3);  // bounces of a millisecond are below a step
  EXPECT_NEAR(state.q[0], 0.0, 1e-5);
}

TEST(OwnSystem, RefusesWhatIsNoNumberAndNoMass) {
  struct Blind final : Pendulum {
    Index guard_count() const override { return 1; }
    GuardValue guard(Index, const State&) const override { return {std::nan(""), 0.0}; }
  };
  EXPECT_THROW((void)march_automatically(Blind(), PiControl{}, LocalError{1e-4}, 1e-4, 1.0), InvalidInput);
  struct Of final : system::OwnSystem {
    explicit Of(const Matrix& mass) : OwnSystem({"x", "y"}, mass.sparseView(), Vector::Zero(2), Vector::Zero(2)) {}
    void force(const State&, model::Side, Vector& f) const override { f = Vector::Zero(3); }
  };
  EXPECT_THROW(Of((Matrix(2, 2) << 1.0, 2.0, 2.0, 1.0).finished()), InvalidInput);
  EXPECT_THROW(Of((Matrix(2, 2) << 2.0, 1.0, 0.0, 1.0).finished()), InvalidInput);
  const Of sound(Matrix::Identity(2, 2));
  const auto equations = sound.equations();
  EXPECT_THROW((void)make_consistent(*equations, sound.start()), InvalidInput);  // three forces
}

TEST(OwnSystem, MeasuresErrorsByTheSizeOfItsStart) {
  struct Small final : system::OwnSystem {
    Small() : OwnSystem({"x"}, Matrix::Identity(1, 1).sparseView(), Vector::Constant(1, 1e-6), Vector::Zero(1)) {}
    void force(const State& at, model::Side, Vector& f) const override { f << 4.0 * at.q[0]; }
  };
  const Automatic run = march_automatically(Small(), PiControl{}, LocalError{1e-5}, 1e-5, 3.0);
  EXPECT_NEAR(run.state.q[0] / 1e-6, std::cos(6.0), 1e-4);
}

TEST(OwnSystem, SaysWhatMustBeWritten) {
  struct Nothing final : system::OwnSystem {
    Nothing() : OwnSystem({"x"}, Matrix::Identity(1, 1).sparseView(), Vector::Zero(1), Vector::Zero(1), {"row"}) {}
    void force(const State&, model::Side, Vector& f) const override { f.setZero(); }
  };
  const Nothing nothing;
  const auto equations = nothing.equations();
  EXPECT_THROW((void)make_consistent(*equations, nothing.start()), InvalidInput);
  struct Massless final : system::OwnSystem {
    Massless() : OwnSystem({"x"}, SparseMatrix(1, 1), Vector::Zero(1), Vector::Zero(1)) {}
    void force(const State&, model::Side, Vector& f) const override { f.setZero(); }
  };
  EXPECT_THROW(Massless(), InvalidInput);
}

}  // namespace
}  // namespace rubato::integrate
