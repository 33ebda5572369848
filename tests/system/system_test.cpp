#include <rubato/system/locally_nonlinear.hpp>
#include <rubato/system/mechanism.hpp>

#include "support/models.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace rubato::system {
namespace {

Mechanism free_body() {
  model::Mechanism model(3);
  const Index body = model.add_space_node("body", numerics::Vector3(1.0, 2.0, 3.0), numerics::Rotation::Identity());
  model.add_space_body(body, 2.0, numerics::Vector3(1.0, 2.0, 2.5).asDiagonal());
  return Mechanism(std::move(model));
}

/// What difference() says of a motion dq from q.
Vector seen(const System& system, const Vector& q, const Vector& dq) {
  Vector to, back(system.size());
  system.retract(q, dq, to);
  system.difference(q, to, back);
  return back;
}

TEST(System, TellsTheMotionBetweenTwoConfigurations) {
  const LocallyNonlinear structure = testing::damper_model();
  const Mechanism mechanism = free_body();
  for (const auto& [system, q] : {std::pair<const System*, Vector>{&structure, structure.start().q},
                                  std::pair<const System*, Vector>{&mechanism, mechanism.start().q}}) {
    const Vector dq = Vector::LinSpaced(system->size(), -0.3, 0.9);
    EXPECT_LT((seen(*system, q, dq) - dq).norm(), 1e-14);
  }
}

// Interpolation between ends of steps relies on it: a wheel that turns by more in three steps is followed over fewer.
TEST(System, TellsTurnsInSpaceBelowHalfATurnOnly) {
  const Mechanism mechanism = free_body();
  Vector dq = Vector::Zero(6);
  dq[5] = mechanism.largest_turn();
  ASSERT_TRUE(mechanism.is_rotation(5));
  EXPECT_NEAR(seen(mechanism, mechanism.start().q, dq)[5], dq[5], 1e-14);
  dq[5] = 4.0;
  EXPECT_NEAR(seen(mechanism, mechanism.start().q, dq)[5], 4.0 - 2.0 * std::numbers::pi, 1e-14);
}

TEST(System, TellsAnyTurnOfAStructure) {
  const LocallyNonlinear structure = testing::damper_model();
  EXPECT_TRUE(structure.is_flat());
  EXPECT_TRUE(std::isinf(structure.largest_turn()));
}

}  // namespace
}  // namespace rubato::system
