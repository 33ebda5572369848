#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/constrained/consistent_start.hpp>
#include <rubato/integrate/constrained/constrained_stepper.hpp>
#include <rubato/model/joints/plane_coordinate.hpp>
#include <rubato/model/joints/plane_joints.hpp>
#include <rubato/model/joints/space_joints.hpp>
#include <rubato/system/mechanism_equations.hpp>

#include <support/double_pendulum.hpp>
#include <support/heavy_top.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace rubato {
namespace {

/// A bar of 1 kg and 1 m that falls from the level and meets a wall below, where a stiff force by a formula of the
/// angle begins with a kink.
model::Mechanism bar_against_a_wall() {
  model::Mechanism m(2);
  const Index bar = m.add_node("bar", {0.5, 0.0, 0.0});
  m.add_mass(bar, 1.0, 1.0 / 12.0);
  m.joints.push_back(model::make_plane_revolute("pin", m.plane_point(0, 0.0, 0.0), m.plane_point(bar, 0.0, 0.0)));
  const model::PlaneCoordinate turn{
      model::PlaneCoordinate::Kind::angle, {m.plane_point(0, 0.0, 0.0), m.plane_point(bar, 0.0, 0.0), {}}, 0.0};
  m.elements.push_back(model::make_joint_drive("wall", turn, "angle < -1 ? -1e5*(angle + 1) : 0", {}));
  m.gravity = {0.0, -9.81, 0.0};
  m.reference = 1.0;
  return m;
}

model::Mechanism heavy_top() {
  using testing::top_arm;
  model::Mechanism m(3);
  m.gravity = {0.0, 0.0, -testing::top_gravity};
  const Index body = m.add_space_node("top", top_arm, numerics::Rotation::Identity());
  m.add_space_body(body, testing::top_mass, testing::top_inertia.asDiagonal());
  const numerics::Vector3 velocity = testing::top_spin.cross(top_arm);
  for (Index i = 0; i < 3; ++i) {
    m.nodes[std::size_t(body)].velocity[std::size_t(i)] = velocity[i];
    m.nodes[std::size_t(body)].velocity[std::size_t(i + 3)] = testing::top_spin[i];
  }
  m.joints.push_back(
      model::make_space_joint(model::SpaceJointKind::spherical, "foot",
                              {{m.space_node(0), numerics::Vector3::Zero()}, numerics::Matrix3::Identity()},
                              {{m.space_node(body), -top_arm}, numerics::Matrix3::Identity()}));
  m.reference = std::sqrt(testing::top_mass);
  return m;
}

struct Distances {
  double largest = 0.0;  // in the mass norm, of steps' ends from those of steps iterated to round-off
  double way = 0.0;      // of the largest step
};

/// Marches with equal steps and makes each of them a second time, from the same state, iterated a thousand times
/// further.
Distances distances(const system::Mechanism& mechanism, double h, int steps) {
  const auto method = integrate::make_method("generalized_alpha", {{"rho_inf", 0.9}});
  const auto stepper = integrate::make_stepper(method, mechanism);
  integrate::NewtonPlan further;
  further.tolerance = 1e-13;
  const auto exact_stepper = integrate::make_stepper(method, mechanism, further);
  system::MechanismEquations equations(mechanism);
  system::State state = integrate::make_consistent(equations, mechanism.start()).state;
  integrate::shift_acceleration(equations, state, stepper->shift() * h);
  system::State next = state, exact = state;
  Vector apart(mechanism.size()), product(mechanism.size());
  const auto distance = [&](const system::State& a, const system::State& b) {
    mechanism.difference(a.q, b.q, apart);
    mechanism.times_mass(apart, product);
    return std::sqrt(apart.dot(product));
  };
  Distances result;
  for (int i = 0; i < steps; ++i) {
    const double t1 = h * (i + 1);
    EXPECT_EQ(stepper->attempt(state, h, t1, next).outcome, integrate::StepOutcome::accepted) << i;
    EXPECT_EQ(exact_stepper->attempt(state, h, t1, exact).outcome, integrate::StepOutcome::accepted) << i;
    result.largest = std::max(result.largest, distance(exact, next));
    result.way = std::max(result.way, distance(state, next));
    std::swap(state, next);
  }
  return result;
}

// NewtonPlan promises 1e-10 of the mechanism's size for each step.
void expect_within_tolerance(const system::Mechanism& mechanism, double h, int steps) {
  const Distances found = distances(mechanism, h, steps);
  EXPECT_GT(found.way, 1e-4 * mechanism.reference());
  EXPECT_LE(found.largest, 1e-10 * mechanism.reference());
}

TEST(NewtonStart, EndsStepsOfAPendulumWithinTheTolerance) {
  // In the shortest steps the first correction is below the tolerance, and the only one.
  expect_within_tolerance(system::Mechanism(testing::double_pendulum()), 5e-4, 2000);
  expect_within_tolerance(system::Mechanism(testing::double_pendulum()), 2e-3, 600);
  expect_within_tolerance(system::Mechanism(testing::double_pendulum()), 2e-2, 60);
}

// It turns by 0.15 rad in the longer step, and Newton's matrix leaves out half of that.
TEST(NewtonStart, EndsStepsOfAFastTopWithinTheTolerance) {
  expect_within_tolerance(system::Mechanism(heavy_top()), 1e-4, 600);
  expect_within_tolerance(system::Mechanism(heavy_top()), 1e-3, 200);
}

TEST(NewtonStart, EndsStepsAcrossAKinkOfAForceWithinTheTolerance) {
  expect_within_tolerance(system::Mechanism(bar_against_a_wall()), 1e-3, 700);
}

}  // namespace
}  // namespace rubato
