#include <rubato/model/joints/bushing.hpp>
#include <rubato/numerics/rotations.hpp>

#include <support/space_differences.hpp>

#include <gtest/gtest.h>

#include <array>

namespace rubato {
namespace {

using model::RelativeTurn;
using numerics::Matrix3;
using numerics::Vector3;
using testing::SpaceMotion;

const Vector3 stiffness(3.0, 0.7, 1.9), damping(0.4, 1.3, 0.2);

/// Between two nodes whose frames lie askew in them.
RelativeTurn turn() {
  return {testing::free_space_node(0), testing::free_space_node(1),
          numerics::rotation_of({0.3, -0.8, 0.5}).toRotationMatrix(),
          numerics::rotation_of({-0.2, 0.4, 1.1}).toRotationMatrix()};
}

TEST(Bushings, MakeMomentsWithConsistentTangents) {
  const auto spring = model::make_turn_spring("s", turn(), stiffness);
  const auto damper = model::make_turn_damper("d", turn(), damping);
  for (const unsigned seed : {1u, 2u, 3u, 4u, 5u}) {
    const SpaceMotion at(2, seed, 0.5);
    testing::expect_consistent_tangent(*spring, at, 10.0);
    testing::expect_force_of_energy(*spring, at, 10.0);
    testing::expect_consistent_tangent(*damper, at, 10.0);
    testing::expect_consistent_damping(*damper, at, 10.0);
  }
}

TEST(Bushings, DissipateTheWorkOfTheirDampers) {
  const RelativeTurn of = turn();
  const auto damper = model::make_turn_damper("d", of, damping);
  const SpaceMotion at(2, 7u, 0.5);
  const model::Motion motion = at.motion();
  std::array<double, 6> force;
  damper->force(motion, force.data());
  double power = 0.0;
  for (std::size_t i = 0; i < 6; ++i) power += force[i] * motion.v[damper->places()[i]];
  const Vector3 rate = of.rate(motion);
  EXPECT_NEAR(power, rate.dot(damping.cwiseProduct(rate)), 1e-12 * power);
}

// Both nodes turned together: the same moments in the axes of the nodes.
TEST(Bushings, AreIndifferentToATurnOfBothParts) {
  const auto spring = model::make_turn_spring("s", turn(), stiffness);
  const SpaceMotion at(2, 3u, 0.5);
  SpaceMotion moved = at;
  moved.move_all(numerics::rotation_of({1.3, -2.0, 0.7}), {0.4, 2.0, -1.0});
  const model::Motion motion = at.motion(), other = moved.motion();
  std::array<double, 6> force, again;
  spring->force(motion, force.data());
  spring->force(other, again.data());
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(again[i], force[i], 1e-13);
  EXPECT_NEAR(spring->stored_energy(other), spring->stored_energy(motion), 1e-13);
}

}  // namespace
}  // namespace rubato
