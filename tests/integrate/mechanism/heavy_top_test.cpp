#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/constrained/consistent_start.hpp>
#include <rubato/integrate/constrained/constrained_stepper.hpp>
#include <rubato/integrate/driver.hpp>
#include <rubato/model/joints/space_joints.hpp>
#include <rubato/system/mechanism_equations.hpp>

#include <support/heavy_top.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace rubato {
namespace {

using numerics::Matrix3;
using numerics::Rotation;
using numerics::Vector3;

using testing::Top;

constexpr double mass = testing::top_mass, gravity = testing::top_gravity;
const Vector3 arm = testing::top_arm, spin = testing::top_spin, inertia = testing::top_inertia;

system::Mechanism heavy_top() {
  model::Mechanism top(3);
  top.gravity = {0.0, 0.0, -gravity};
  const Index body = top.add_space_node("top", arm, Rotation::Identity());
  top.add_space_body(body, mass, inertia.asDiagonal());
  auto& node = top.nodes[std::size_t(body)];
  const Vector3 velocity = spin.cross(arm);
  for (Index i = 0; i < 3; ++i) {
    node.velocity[std::size_t(i)] = velocity[i];
    node.velocity[std::size_t(i + 3)] = spin[i];
  }
  top.joints.push_back(model::make_space_joint(model::SpaceJointKind::spherical, "foot",
                                               {{top.space_node(0), Vector3::Zero()}, Matrix3::Identity()},
                                               {{top.space_node(body), -arm}, Matrix3::Identity()}));
  return system::Mechanism(std::move(top));
}

struct Errors {
  double position, turn, velocity, omega, reaction, gap;
};

Errors errors_at(double h, double end, const Top& exact) {
  const system::Mechanism mechanism = heavy_top();
  const auto method = integrate::make_method("generalized_alpha", {{"rho_inf", 0.9}});
  const auto stepper = integrate::make_stepper(method, mechanism);
  system::MechanismEquations equations(mechanism);
  const auto start = integrate::make_consistent(equations, mechanism.start());
  EXPECT_TRUE(start.is_consistent);
  EXPECT_EQ(start.most_moved, -1);
  EXPECT_EQ(start.most_changed, -1);
  system::State state = start.state;
  const auto& alpha = std::get<integrate::GeneralizedAlpha>(method.formula);
  integrate::shift_acceleration(equations, state, (alpha.alpha_m - alpha.alpha_f) * h);
  EXPECT_EQ(integrate::march(*stepper, state, h, end).end, integrate::MarchEnd::reached);
  equations.go_to(state, model::Side::left);
  Vector force(6), gap(3);
  equations.residual(force, gap);
  const Rotation turn(state.q[10], state.q[11], state.q[12], state.q[13]);
  EXPECT_NEAR(turn.norm(), 1.0, 1e-15);
  return {(state.q.segment<3>(7) - exact.position()).norm(),
          numerics::vector_of(exact.turn.conjugate() * turn).norm(),
          (state.v.head<3>() - exact.turn * exact.omega.cross(arm)).norm(),
          (state.v.tail<3>() - exact.omega).norm(),
          (state.multiplier - exact.reaction()).norm(),
          gap.norm()};
}

TEST(HeavyTop, StartsWithTheReactionOfItsJoint) {
  const system::Mechanism mechanism = heavy_top();
  system::MechanismEquations equations(mechanism);
  const auto start = integrate::make_consistent(equations, mechanism.start());
  ASSERT_TRUE(start.is_consistent);
  Top exact;
  exact.go(0.0, 1e-5);
  EXPECT_LT((start.state.multiplier - exact.reaction()).norm(), 1e-10 * exact.reaction().norm());
  EXPECT_LT((start.state.acceleration.tail<3>() - exact.rate).norm(), 1e-10 * exact.rate.norm());
}

TEST(HeavyTop, ConvergesWithSecondOrderInMotionAndReaction) {
  Top exact;
  const double end = 0.2;
  exact.go(end, 1e-5);
  const Errors coarse = errors_at(1e-3, end, exact), fine = errors_at(5e-4, end, exact);
  const auto order = [](double a, double b) { return std::log2(a / b); };
  EXPECT_NEAR(order(coarse.position, fine.position), 2.0, 0.2);
  EXPECT_NEAR(order(coarse.turn, fine.turn), 2.0, 0.2);
  EXPECT_NEAR(order(coarse.velocity, fine.velocity), 2.0, 0.2);
  EXPECT_NEAR(order(coarse.omega, fine.omega), 2.0, 0.2);
  EXPECT_NEAR(order(coarse.reaction, fine.reaction), 2.0, 0.3);
  EXPECT_LT(fine.position, 1e-2);
  EXPECT_LT(fine.gap, 1e-12);
}

}  // namespace
}  // namespace rubato
